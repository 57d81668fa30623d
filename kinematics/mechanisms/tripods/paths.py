"""What a move of a 3-RPS or 3-SPR meets: Z, θ and φ (the shorter way round) change evenly.

Limb lengths and the polynomial P of parallel singularities (see `polynomial`) are smooth; those of
a 3-SPR are multiplied by cos² θ: at a tilt of 90° there is no finite position.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.paths import PathsFacet
from kinematics.facets.segments import ROUNDING, Segment
from kinematics.mechanisms.tripods import polynomial, posing
from kinematics.mechanisms.tripods.design import LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import offsets

_MEETING = 1e-6  # rad from 180°: the tilt at which the operation modes meet


class Paths(PathsFacet[TripodDesign]):
    """Limbs have no reach."""

    @property
    def reach_limbs(self) -> tuple[int, ...]:
        return ()

    def passed(self, before: Posture, after: Posture, through: ArrayLike = ()) -> tuple[Event, ...]:
        meet = all(abs(posture.pose[1] - np.pi) <= _MEETING for posture in (before, after))
        if before.mode != after.mode and meet:
            return ()
        return super().passed(before, after, through)

    def breaks(self, move: Segment) -> Sequence[float]:
        if self.design.revolute_on_base or not move.change[1]:
            return ()
        s = (0.5 * np.pi - move.start[1]) / move.change[1]
        return (float(s),) if 0.0 < s < 1.0 else ()

    def ranges(self, poses: Array, mode: str) -> Array:
        h, k = self.design.revolute_radius, mode_sign(mode) * self.design.spherical_radius
        z, tilt, azimuth = (poses[:, n] for n in range(posing.POSE))
        factor, lift = np.ones(len(poses)), z
        if not self.design.revolute_on_base:
            factor = np.cos(tilt)
            lift = self.design.base_radius * np.sin(0.5 * tilt) ** 2 * np.sin(tilt)
            lift = lift * np.sin(3.0 * azimuth) - z
        level = posing.reduce_poses(self.design, poses, mode)._replace(v=np.zeros(len(poses)))
        outward, upward = offsets(h, k, level)
        upward = lift[:, None] + factor[:, None] * upward
        square = (factor[:, None] * outward) ** 2 + upward**2
        low, high = self.design.stroke
        by = factor[:, None] ** 2
        both = np.stack([square - by * low**2, by * high**2 - square], axis=-1)
        return both.reshape(len(poses), 2 * LIMBS)

    def determinant(self, poses: Array, mode: str) -> tuple[Array, Array]:
        z, tilt, azimuth = (poses[:, n] for n in range(posing.POSE))
        k = mode_sign(mode) * self.design.platform_radius
        terms = polynomial.in_w(self.design.mechanism, self.design.base_radius, k, z, tilt)
        terms = terms * np.sin(3.0 * azimuth)[:, None] ** np.arange(4)
        return terms.sum(axis=-1), ROUNDING * np.abs(terms).sum(axis=-1)
