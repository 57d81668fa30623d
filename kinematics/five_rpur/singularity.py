"""Which singularities a posture of the 5-RPUR is in, and why."""

from __future__ import annotations

from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.singularities import AT, Singularity
from kinematics.solutions import Posture


def singularities(
    design: FiveRPURDesign, posture: Posture, tolerance: float = AT
) -> tuple[Singularity, ...]:
    """Placeholder until the causes are in."""
    return ()
