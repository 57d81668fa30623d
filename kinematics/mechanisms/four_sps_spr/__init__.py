"""The 4-SPS + 1-SPR parallel mechanism (5 DOF) of Wang et al. (2017)."""

from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign, Limb
from kinematics.mechanisms.four_sps_spr.mechanism import MECHANISM

__all__ = ["MECHANISM", "FourSPSSPRDesign", "Limb"]
