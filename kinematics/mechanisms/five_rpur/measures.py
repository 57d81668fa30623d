"""How well a posture of the 5-RPUR is held."""

from __future__ import annotations

from kinematics.facets.measures import (
    CONDITIONING,
    FORCE,
    MANIPULABILITY,
    TRANSMISSION,
    MeasuresFacet,
)
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign


class Measures(MeasuresFacet[FiveRPURDesign]):
    """The indices that vanish at singularities, and the largest force."""

    specs = (
        CONDITIONING,
        MANIPULABILITY,
        TRANSMISSION,
        FORCE,
    )
