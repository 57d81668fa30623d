"""How well a posture of the 4-SPS + 1-SPR is held."""

from __future__ import annotations

from numpy.typing import ArrayLike

from kinematics.answers.singularities import Measure
from kinematics.arrays import Array
from kinematics.facets.measures import CONDITIONING, MANIPULABILITY, MeasuresFacet
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.statics import condition


class Measures(MeasuresFacet[FourSPSSPRDesign]):
    """Indices of all six wrenches, the constraint's among them, and the largest forces."""

    specs = (
        CONDITIONING,
        MANIPULABILITY,
        Measure("force", "Largest leg force", "N", "low", (0.0, None), needs_load=True),
        Measure("constraint_force", "Constraint force", "N", "low", (0.0, None), needs_load=True),
    )

    def condition(self, poses: ArrayLike, mode: str = "", length: float | None = None) -> Array:
        """That of G (...), see `statics.condition`; NaN where a pose does not close."""
        return condition(self._at(poses, mode).rows, length or self.mechanism.length)
