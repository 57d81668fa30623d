"""The 3-RPS and 3-SPR parallel mechanisms, compared by Nayak et al. (2017)."""

from kinematics.mechanisms.tripods.design import TripodDesign
from kinematics.mechanisms.tripods.mechanism import THREE_RPS, THREE_SPR

__all__ = ["THREE_RPS", "THREE_SPR", "TripodDesign"]
