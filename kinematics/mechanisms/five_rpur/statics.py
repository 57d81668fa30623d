"""The six wrenches of the 5-RPUR: what actuators and the constraint couple hold.

With the prismatic joint locked, limb i transmits a force through B_i along
f_i = (û_i × e1) × (v̂_i × e2), û = (B − A)/ρ, v̂ = (C − B)/l. In the base frame turned by
R_y(−θ), with (X, Y, Z) = C − A, p = Z − σh and q = σh, it is −(qX, pY, pq)/(ρ l) and
f·û = −q/l. All limbs together impose one more wrench, a couple along e1 × e2. e1 and e2 are always
normal to each other, so it never vanishes: the 5-RPUR has no constraint singularity.

Parallel (type 2) singularities: the six wrenches are dependent. Serial (type 1): q = 0 (the two
working modes of a limb meet) or ρ = 0; there f·û is 0, or there is no f.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Wrenches, WrenchName
from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.design import LIMBS, SUBSCRIPTS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import LINK_SLACK, signs

NAMES: tuple[WrenchName, ...] = (
    *(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS)),
    WrenchName("constraint", None, "M"),
)
_NO_LINE = 1e-13  # |(û × e1) × (v̂ × e2)| of two planes that are one but for rounding


def wrenches(design: FiveRPURDesign, placement: Array, mode: str | ArrayLike) -> Wrenches:
    """The five unit forces and the unit couple, see `Mechanism.wrenches`; points are B_i and O′.

    Args:
        mode: a working mode as "+-+++", or signs ±1 (..., 5).

    Returns:
        NaN for limbs that cannot close, have ρ = 0, or transmit a whole pencil of forces: link
        along e1 and actuator along e2.
    """
    turn = placement[..., :3, :3]
    cos, sin = turn[..., 0, 0, None], -turn[..., 2, 0, None]  # of θ
    (rx, ry, rz), (sx, sy, sz) = design.base.T, design.platform.T
    cos_phi, sin_phi = turn[..., 1, 1, None], -turn[..., 1, 2, None]
    px, py, pz = (placement[..., k, 3, None] for k in range(3))
    dx, dz = px - rx, pz - rz
    x = dx * cos - dz * sin + sx
    y = py - ry + sy * cos_phi - sz * sin_phi
    z = dx * sin + dz * cos + sy * sin_phi + sz * cos_phi
    square = (design.link - y) * (design.link + y)
    # At the reach there is a wrench, but no derivative of it.
    edge = np.nan if np.iscomplexobj(square) else 0.0
    closes = np.abs(y.real) <= design.link * (1.0 + LINK_SLACK)
    square = np.where(closes, np.where(square.real > 0.0, square, edge), np.nan)
    q = signs(mode) * np.sqrt(square)
    p = z - q
    rho = np.sqrt(x * x + p * p)
    fx, fy, fz = q * x, p * y, p * q  # of −f ρ l
    size = np.sqrt(fx * fx + fy * fy + fz * fz)
    size = np.where(size.real > _NO_LINE * (rho * design.link).real, size, np.nan)
    force = np.stack([fx * cos + fz * sin, fy, fz * cos - fx * sin], axis=-1) / -size[..., None]
    b = np.stack([rx + cos * x + sin * p, ry + 0.0 * p, rz - sin * x + cos * p], axis=-1)
    origin = np.broadcast_to(placement[..., None, :3, 3], (*size.shape[:-1], 1, 3))
    rows = np.zeros((*size.shape[:-1], LIMBS + 1, 6), dtype=force.dtype)
    rows[..., :LIMBS, :3] = force
    rows[..., :LIMBS, 3:] = np.cross(b - origin, force)
    rows[..., LIMBS, 3], rows[..., LIMBS, 5] = -sin[..., 0], -cos[..., 0]
    return Wrenches(rows, -q * rho / size, np.concatenate([b, origin], axis=-2))
