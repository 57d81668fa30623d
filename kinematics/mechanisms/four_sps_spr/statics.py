"""The six wrenches of the 4-SPS + 1-SPR: five legs and the constraint.

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

from kinematics.answers.motion import Wrenches, WrenchName
from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, SUBSCRIPTS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import transform
from kinematics.screws.wrenches import RANK, scale

NAMES = (
    *(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS)),
    WrenchName("constraint", SPR + 1, "Fτ"),
)


class Legs(NamedTuple):
    """The vectors that everything else is made of, at placements (..., 4, 4), base frame, mm.

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
    return _legs(design, transform(poses))


def _legs(design: FourSPSSPRDesign, placement: Array) -> Legs:
    r, origin = placement[..., :3, :3], placement[..., None, :3, 3]
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
    return np.asarray(np.concatenate([at.unit, np.cross(at.arm, at.unit)], axis=-1))


def sizes(g: Array, length: float) -> Array:
    """The singular values (..., 6) of G with its moments divided by a length, mm, largest first;
    zeros where there are no numbers."""
    sound = np.asarray(np.isfinite(g).all(axis=(-1, -2)))[..., None, None]
    return np.asarray(np.linalg.svd(np.where(sound, g / scale(length), 0.0), compute_uv=False))


def condition(g: Array, length: float) -> Array:
    """The condition number (...) of G, moments by a length, mm; infinite where singular, NaN where
    there are no numbers."""
    values = sizes(g, length)
    regular = values[..., -1] > RANK * np.maximum(values[..., 0], 1e-300)
    number = np.where(regular, values[..., 0] / np.where(regular, values[..., -1], 1.0), np.inf)
    return np.where(np.isfinite(g).all(axis=(-1, -2)), number, np.nan)


def wrenches(design: FourSPSSPRDesign, placement: Array) -> Wrenches:
    """The rows of G, see `Mechanism.wrenches`; points are B_i and A_5."""
    at = _legs(design, placement)
    return Wrenches(matrix(at), np.ones_like(at.length), placement[..., None, :3, 3] + at.arm)
