"""Following assembly modes of the tripods: the closure equations of an operation mode as quadrics.

Unknowns are the reduced pose (x0, x1, x2, v) and x1² − x2², 2 x1 x2, x0², x0 x1 and x0 x2: neither
the level platform nor a tilt of 180° is special to them, and a 3-SPR passes 90°. Within an
operation mode the equations are regular at x0 = 0, where the other mode is met: there the machine
may go on in either, so a motion stops.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.following import ClosureFollowing
from kinematics.facets.inverse import posture
from kinematics.homotopy.quadrics import Quadrics, square, unknowns
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import AZIMUTHS, LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.posing import Reduced

_COUNT = 9
MEETING = 1e-9
"""|x0| below which a pose belongs to both operation modes."""


class Following(ClosureFollowing[TripodDesign]):
    """Besides, a motion stops in the constraint singularity at a tilt of 180°, exactly there,
    since the operation mode may change in it. From there it goes on in the mode of its start.
    """

    edge = 0  # x0

    @property
    def unit(self) -> float:
        return self.design.spherical_radius

    def closure(self, mode: str) -> Quadrics:
        h = self.design.revolute_radius / self.unit
        return _closure(h, mode_sign(mode))

    def unknowns(self, pose: Sequence[float], mode: str) -> Array:
        x0, x1, x2, v = posing.reduce_poses(self.design, posing.read_poses(pose), mode)
        products = x1 * x1 - x2 * x2, 2.0 * x1 * x2, x0 * x0, x0 * x1, x0 * x2
        return np.array([x0, x1, x2, v / self.unit, *products], dtype=float)

    def posture(self, unknowns: Array, joints: Array, pose: Sequence[float], mode: str) -> Posture:
        x = np.where(np.abs(unknowns[:3]) <= MEETING * np.eye(3)[0], 0.0, unknowns[:3])
        reduced = Reduced(x[0], x[1], x[2], self.unit * unknowns[3])
        found = posing.to_poses(self.design, reduced, mode).tolist()
        return posture(self.design, tuple(found), mode, known=joints)

    def edge_text(self, start: Posture) -> str:
        other = "1" if start.mode == "2" else "2"
        return (
            "stopped at a constraint singularity, at a tilt of 180°: from here the machine may go "
            f"on in operation mode {start.mode} or {other}"
        )


@lru_cache(maxsize=64)
def _closure(h: float, k: float) -> Quadrics:
    """In units of the spherical joints' circumradius: see `limbs`."""
    x0, x1, x2, v, even, odd, level, up1, up2, *lengths = unknowns(_COUNT + LIMBS)
    equations = [
        0.5 * (square(x0) + square(x1) + square(x2) - 1.0),
        square(x1) - square(x2) - even,
        2.0 * x1.by(x2) - odd,
        square(x0) - level,
        x0.by(x1) - up1,
        x0.by(x2) - up2,
    ]
    for azimuth, length in zip(AZIMUTHS, lengths, strict=True):
        c, s = float(np.cos(azimuth)), float(np.sin(azimuth))
        outward = k * (2.0 * c * even - 2.0 * s * odd + level) - h
        upward = v + 2.0 * k * (s * up1 - c * up2)
        equations.append(0.5 * (square(outward) + square(upward) - square(length)))
    return Quadrics.of(equations)
