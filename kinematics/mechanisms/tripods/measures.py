"""How well a posture of a 3-RPS or 3-SPR is held, and how far its platform strays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import Measure
from kinematics.arrays import Array
from kinematics.facets.measures import CONDITIONING, MeasuresFacet
from kinematics.mechanisms.tripods.design import TripodDesign

_LEAST = "Smallest singular value of the unit wrenches"


class Measures(MeasuresFacet[TripodDesign]):
    """Moments are divided by the platform's circumradius h2."""

    specs = (
        replace(CONDITIONING, title="Conditioning 1/κ"),
        Measure("singular_value", _LEAST, "", "high", (0.0, None)),
        Measure(
            "largest_force", "Largest actuator force", "N", "low", (0.0, None), needs_load=True
        ),
        Measure(
            "constraint_force", "Largest constraint force", "N", "low", (0.0, None), needs_load=True
        ),
        Measure("parasitic", "Parasitic motion √(X² + Y²)", "mm", "low", (0.0, None)),
    )
    largest_force = MeasuresFacet.force

    def parasitic(self, poses: ArrayLike, mode: str) -> Array:
        """√(X² + Y²) of O′, mm, which follow from Z, θ and φ; NaN where there is no position."""
        place = self.mechanism.placement(poses, mode)[..., :3, 3]
        return np.asarray(np.hypot(place[..., 0], place[..., 1]))
