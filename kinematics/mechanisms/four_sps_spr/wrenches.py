"""The six wrenches of the 4-SPS + 1-SPR: five legs and the constraint; conditioning; statics.

Leg i pushes along n_i through B_i; the SPR limb also exerts a force along its revolute axis n6
through A_5. With r_i = R b_i and r_6 = A_5 − p the matrix G has the rows (n_iᵀ, (r_i × n_i)ᵀ) and
(n6ᵀ, (r_6 × n6)ᵀ) (Wang et al. 2017, eq. 10; eq. 9 prints the last cross product the wrong way
round). G times (v; ω) is (l̇_1 … l̇_5, 0), and forces that hold a load are −G⁻ᵀ (F; T) (eq. 16).

Singular means det G = 0: with all legs locked the platform can still move. A constraint
singularity proper there is none: the one constraint is a unit force, and never vanishes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics, WrenchName, WrenchSystem
from kinematics.arrays import Array, finite
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, SUBSCRIPTS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import CONSTRAINT_SLACK, POSE, rotation, violation
from kinematics.screws.wrenches import determinant, equilibrium

WRENCHES = LIMBS + 1
NAMES = (
    *(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS)),
    WrenchName("constraint", SPR + 1, "Fτ"),
)
SINGULAR = 1e-12
"""Smallest singular value of G (moments by the characteristic length), relative to the largest,
below which nothing is determined but rounding."""


class Legs(NamedTuple):
    """The vectors that everything else is made of, at poses (...,), base frame, mm.

    Attributes:
        arm: (..., 6, 3) r_i, and r_6 = A_5 − p.
        unit: (..., 6, 3) n_i, and n6; NaN of a leg without length.
        length: (..., 5) l_i.
    """

    arm: Array
    unit: Array
    length: Array


def legs(design: FourSPSSPRDesign, poses: ArrayLike) -> Legs:
    """Arms, directions and lengths at poses (..., 6), whether the constraint holds or not."""
    p = finite(poses, name="a pose", last=POSE)
    r = rotation(p)
    origin = p[..., None, :3]
    arms = design.platform @ r.swapaxes(-1, -2)
    vectors = origin + arms - design.base
    lengths = np.sqrt((vectors * vectors).sum(axis=-1))
    with np.errstate(invalid="ignore", divide="ignore"):
        units = vectors / lengths[..., None]
    axis = (r @ design.axis)[..., None, :]
    sixth = design.base[SPR] - origin
    return Legs(
        np.concatenate([arms, sixth], axis=-2), np.concatenate([units, axis], axis=-2), lengths
    )


def matrix(at: Legs) -> Array:
    """G, (..., 6, 6): rows [n, r × n], which are forces of length one and moments about p, mm."""
    g: Array = np.concatenate([at.unit, np.cross(at.arm, at.unit)], axis=-1)
    return g


def scaled(g: Array, length: float) -> Array:
    """G with its moments divided by a length, mm: all entries are plain numbers."""
    answer: Array = g / np.array([1.0, 1.0, 1.0, length, length, length])
    return answer


def closes(design: FourSPSSPRDesign, poses: ArrayLike) -> np.ndarray:
    """(...,) the constraint holds, so that the machine can be assembled."""
    held: np.ndarray = np.abs(violation(design, poses)) <= CONSTRAINT_SLACK
    return held


def singular_values(g: Array) -> Array:
    """(..., 6) of matrices, largest first; zeros where there are no numbers."""
    sound = np.asarray(np.isfinite(g).all(axis=(-1, -2)))
    values = np.linalg.svd(np.where(sound[..., None, None], g, 0.0), compute_uv=False)
    return np.asarray(values)


def solve(g: Array, right: Array) -> Array:
    """Solutions (..., 6) of G x = right; NaN where G is singular to within rounding."""
    sizes = singular_values(g)
    regular = sizes[..., -1] > SINGULAR * np.maximum(sizes[..., 0], 1e-300)
    safe = np.where(regular[..., None, None], g, np.eye(g.shape[-1]))
    solved = np.linalg.solve(safe, right[..., None])[..., 0]
    return np.asarray(np.where(regular[..., None], solved, np.nan))


def wrench_system(design: FourSPSSPRDesign, poses: ArrayLike) -> WrenchSystem:
    """The wrenches at poses (..., 6), see `WrenchSystem`; NaN where a pose does not close."""
    p = finite(poses, name="a pose", last=POSE)
    at = legs(design, p)
    g = matrix(at)
    held = closes(design, p)
    rows = np.where(held[..., None, None], g, np.nan)
    return WrenchSystem(
        NAMES, rows, p[..., None, :3] + at.arm, np.asarray(determinant(rows, design.length))
    )


def statics(design: FourSPSSPRDesign, poses: ArrayLike, loads: ArrayLike) -> Statics:
    """Forces of the legs and of the constraint that hold a load.

    Args:
        poses: (..., 6) mm and rad.
        loads: (..., 6) [F, T about p] on the platform, N and N·mm, base frame.

    Returns:
        Forces (..., 6), N: a leg's is positive where it pushes the platform, in compression.
    """
    system = wrench_system(design, poses)
    return equilibrium(NAMES, system.rows, loads, design.length)


def condition(design: FourSPSSPRDesign, poses: ArrayLike) -> Array:
    """Condition number of G with moments by the characteristic length, (...,); infinite where
    singular, NaN where a pose does not close."""
    p = finite(poses, name="a pose", last=POSE)
    sizes = singular_values(scaled(matrix(legs(design, p)), design.length))
    regular = sizes[..., -1] > SINGULAR * np.maximum(sizes[..., 0], 1e-300)
    number = np.where(regular, sizes[..., 0] / np.where(regular, sizes[..., -1], 1.0), np.inf)
    return np.asarray(np.where(closes(design, p), number, np.nan))
