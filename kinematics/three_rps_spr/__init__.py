"""The 3-RPS and 3-SPR parallel mechanisms, compared by Nayak et al. (2017)."""

from kinematics.three_rps_spr.design import TripodDesign
from kinematics.three_rps_spr.mechanism import THREE_RPS, THREE_SPR

__all__ = ["THREE_RPS", "THREE_SPR", "TripodDesign"]
