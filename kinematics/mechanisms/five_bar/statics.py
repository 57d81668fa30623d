"""The forces that the five-bar's limbs exert on P, the torques behind them, and conditioning.

A θ̇ = B ṗ (Sosa-López et al. 2017, eqs. 20 to 22): row i of B is the distal link P − B_i, and A is
diagonal with a_i = r_1 (P − B_i)·e⊥(θ_i). Torques that hold a force F at P: τ = −A B^{−T} F.

det A is r_1 r_1' times y² c_1 c_2 − x y (c_1 s_2 + s_1 c_2) + y r_3 (c_1 s_2 − s_1 c_2) +
(x² − r_3²) s_1 s_2 (eq. 24 is misprinted): zero at serial singularities; det B (eq. 25) is zero at
parallel ones. Lengths mm, angles rad. Everything takes batches.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics as Forces
from kinematics.answers.motion import Wrenches, WrenchName
from kinematics.arrays import Array, finite
from kinematics.facets.statics import StaticsFacet
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import elbows, joints_of

SINGULAR = 1e-12
"""|sin| of an angle between links below which they are in line."""

NAMES = tuple(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS))
TORQUES = tuple(WrenchName("actuation", i + 1, f"τ{SUBSCRIPTS[i]}") for i in range(LIMBS))


def jacobians(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> tuple[Array, Array]:
    """The diagonal of A (..., 2) mm² and B (..., 2, 2) mm (eqs. 21 and 22)."""
    p, q = np.asarray(poses, dtype=float), np.asarray(joints, dtype=float)
    b = p[..., None, :] - elbows(design, q)
    a = design.proximal * (b[..., 1] * np.cos(q) - b[..., 0] * np.sin(q))
    return a, b


def sines(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> tuple[Array, Array]:
    """det A and det B without their lengths.

    Returns:
        (..., 2): the sine of the angle from each proximal link to its distal one; and (...): that
        of the angle from distal link 1 to distal link 2.
    """
    a, b = jacobians(design, poses, joints)
    unit = b / design.distal[:, None]
    return a / (design.proximal * design.distal), _cross(unit[..., 0, :], unit[..., 1, :])


def condition(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> Array:
    """The condition number of J = A⁻¹B, (...): 1 at best, infinite at any singularity."""
    a, b = jacobians(design, poses, joints)
    s1, s2 = a[..., 0], a[..., 1]
    # Of the matrix adj(A) B, which is J times det A: no division that a singularity forbids.
    rows = np.stack([s2[..., None] * b[..., 0, :], s1[..., None] * b[..., 1, :]], axis=-2)
    norm2 = (rows**2).sum(axis=(-1, -2))
    det = np.abs(_cross(rows[..., 0, :], rows[..., 1, :]))
    small = det <= SINGULAR * norm2
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.maximum(norm2 / (2.0 * det), 1.0)  # (κ + 1/κ)/2
        answer = ratio + np.sqrt((ratio - 1.0) * (ratio + 1.0))
    return np.where(np.isnan(det), np.nan, np.where(small, np.inf, answer))


def wrenches(design: FiveBarDesign, placement: Array, mode: str) -> Wrenches:
    """Unit forces along the distal links, from B_i to P, see `Mechanism.wrenches`.

    The other four, which no load in the plane asks for, hold P in its plane and the frame at P,
    which does not turn.
    """
    p = placement[..., :2, 3]
    a, b = jacobians(design, p, joints_of(design, p, mode))
    rows = np.zeros((*p.shape[:-1], 6, 6))
    rows[..., :LIMBS, :2] = b / design.distal[:, None]
    rows[..., LIMBS:, LIMBS:] = np.eye(4)
    open_ones = np.isnan(b).any(axis=-1)
    rows[..., :LIMBS, :][open_ones] = np.nan
    point = np.broadcast_to(placement[..., None, :3, 3], (*p.shape[:-1], 6, 3)).copy()
    point[..., :LIMBS, :][open_ones] = np.nan
    return Wrenches(rows, a / design.distal, point)


class Statics(StaticsFacet[FiveBarDesign]):
    """Torques at the cranks."""

    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Forces:
        """Torques (..., 2) N·mm of the actuators that hold loads [F, T] (..., 6) at P.

        F_z, T_x and T_y are borne by the hinges. A moment T_z about the hinge P cannot be held: it
        stays in the residual.
        """
        load = finite(loads, name="a load", last=6)
        found = super().forces(poses, mode, load * np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]))
        force = np.hypot(load[..., 0], load[..., 1])
        moment = np.abs(load[..., 5]) / self.mechanism.length
        size = np.maximum(force, moment)
        left = np.maximum(found.residual * force, moment) / np.where(size > 0.0, size, 1.0)
        return Forces(TORQUES, found.forces, left)


def _cross(u: Array, v: Array) -> Array:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
