"""The six wrenches of the 5-RPUR as Plücker lines, and what actuators and couple hold.

Each limb pushes along one line through B_i, and all limbs together exert one couple along e1 × e2
(see `five_rpur.velocity`). e1 and e2 are always normal to each other, so the couple
never vanishes: the 5-RPUR has no constraint singularity.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics, WrenchName, WrenchSystem
from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.design import LIMBS, SUBSCRIPTS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import joint_points
from kinematics.mechanisms.five_rpur.velocity import characteristic_length, wrenches
from kinematics.screws.wrenches import determinant, equilibrium

NAMES: tuple[WrenchName, ...] = (
    *(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS)),
    WrenchName("constraint", None, "M"),
)


def wrench_system(design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike) -> WrenchSystem:
    """The five unit forces and the unit couple.

    Args:
        poses: (..., 5) mm and rad.
        modes: a working mode as "+-+++", or signs ±1 (..., 5).

    Returns:
        NaN for limbs that cannot close, have ρ = 0, or transmit a whole pencil of forces: link
        along e1 and actuator along e2.
    """
    rows, _, points = _lines(design, poses, modes)
    return WrenchSystem(NAMES, rows, points, determinant(rows, characteristic_length(design)))


def statics(
    design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike, loads: ArrayLike
) -> Statics:
    """Actuator forces and the constraint couple that hold a load (..., 6), N and N·mm at O'.

    A limb in a serial singularity (q = 0) needs no actuator force: its joints carry the line.

    Raises:
        InputError: not finite numbers, or not six in a load.
    """
    rows, transmission, _ = _lines(design, poses, modes)
    gain = np.concatenate([transmission, np.ones((*transmission.shape[:-1], 1))], axis=-1)
    return equilibrium(NAMES, rows, loads, characteristic_length(design), gain)


def _lines(
    design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike
) -> tuple[Array, Array, Array]:
    """Unit wrenches (..., 6, 6), f·û of the unit forces (..., 5), and points (..., 6, 3)."""
    w = wrenches(design, poses, modes)
    _, b, _ = joint_points(design, poses, modes)
    size = np.linalg.norm(w.force, axis=-1)
    size = np.where(size > _NO_LINE, size, np.nan)
    rows = np.zeros((*size.shape[:-1], LIMBS + 1, 6))
    rows[..., :LIMBS, :3] = w.force / size[..., None]
    rows[..., :LIMBS, 3:] = w.moment / size[..., None]
    rows[..., LIMBS, 3:] = w.couple
    origin = np.broadcast_to(np.asarray(poses, dtype=float)[..., None, :3], (*b.shape[:-2], 1, 3))
    return rows, w.transmission / size, np.concatenate([b, origin], axis=-2)


_NO_LINE = 1e-13  # |(û × e1) × (v̂ × e2)| of two planes that are one but for rounding
