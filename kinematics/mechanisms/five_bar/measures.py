"""How well a configuration of the five-bar is controlled."""

from __future__ import annotations

from dataclasses import replace

from numpy.typing import ArrayLike

from kinematics.answers.singularities import Measure
from kinematics.arrays import Array, finite
from kinematics.facets.measures import CONDITIONING, MANIPULABILITY, TRANSMISSION, MeasuresFacet
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import joints_of
from kinematics.mechanisms.five_bar.statics import condition


class Measures(MeasuresFacet[FiveBarDesign]):
    """Sines of angles between links: manipulability is that between the distal links."""

    specs = (
        replace(CONDITIONING, title="Conditioning of the Jacobian, 1/κ"),
        MANIPULABILITY,
        TRANSMISSION,
        Measure("force", "Largest actuator torque", "N·mm", "low", (0.0, None), needs_load=True),
    )

    def condition(self, poses: ArrayLike, mode: str, length: float | None = None) -> Array:
        """That of J (...), in closed form; P does not turn, so that no length counts."""
        p = finite(poses, name="a pose", last=2)
        return condition(self.design, p, joints_of(self.design, p, mode))
