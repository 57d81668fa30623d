"""What a move of a 3-RPS or 3-SPR meets: Z, θ and φ (the shorter way round) change evenly.

At a tilt of 90° a 3-SPR has no finite position.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Posture
from kinematics.facets.paths import PathsFacet
from kinematics.facets.segments import Segment
from kinematics.mechanisms.tripods.design import TripodDesign

_MEETING = 1e-6  # rad from 180°: the tilt at which the operation modes meet


class Paths(PathsFacet[TripodDesign]):
    """Limbs have no reach."""

    reach_limbs = ()

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
