"""The six wrenches of the 3-RPS and 3-SPR as Plücker lines.

Limb i exerts a force along A_i B_i (its actuator) and a force through its spherical joint along the
axis of its revolute joint (its constraint). Where the six are dependent the platform cannot be
held: actuation singularities are P = 0 (see `polynomial`), constraint singularities x0 = x3 = 0.
The determinant of the unnormed wrenches is ± 6.75 x h³ P, where x is x0 (mode 2) or x3 (mode 1).
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.motion import Wrenches, WrenchName
from kinematics.arrays import Array
from kinematics.mechanisms.tripods.design import LIMBS, RADIAL, SUBSCRIPTS, TANGENT, TripodDesign
from kinematics.mechanisms.tripods.limbs import placed

NAMES: tuple[WrenchName, ...] = (
    *(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS)),
    *(WrenchName("constraint", i + 1, f"C{SUBSCRIPTS[i]}") for i in range(LIMBS)),
)


def wrenches(design: TripodDesign, placement: Array) -> Wrenches:
    """Unit forces, see `Mechanism.wrenches`; an actuator's is NaN where A_i and B_i coincide."""
    centre = placement[..., None, :3, 3]
    b = placed(placement, design.platform_radius * RADIAL)
    a = np.broadcast_to(design.base_radius * RADIAL, b.shape)
    along = b - a
    length = np.sqrt((along * along).sum(axis=-1, keepdims=True))
    force = along / np.where(length.real > 0.0, length, np.nan)
    axis = np.broadcast_to(TANGENT, b.shape)
    if not design.revolute_on_base:  # it turns with the platform
        axis = TANGENT @ placement[..., :3, :3].swapaxes(-1, -2)
    through = b if design.revolute_on_base else a
    point = np.concatenate([b, through], axis=-2)
    forces = np.concatenate([force, axis], axis=-2)
    rows = np.concatenate([forces, np.cross(point - centre, forces)], axis=-1)
    return Wrenches(rows, np.ones(b.shape[:-1]), point)
