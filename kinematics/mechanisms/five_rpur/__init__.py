"""The 5-RPUR (3T2R) parallel mechanism of Tale Masouleh et al., Meccanica 46 (2011)."""

from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.mechanism import MECHANISM

__all__ = ["MECHANISM", "FiveRPURDesign", "Limb"]
