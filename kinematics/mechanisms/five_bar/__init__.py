"""The planar five-bar (5R) of Sosa-López, Arias-Montiel and Lugo-González (2017)."""

from kinematics.mechanisms.five_bar.design import FiveBarDesign, Limb
from kinematics.mechanisms.five_bar.mechanism import MECHANISM

__all__ = ["MECHANISM", "FiveBarDesign", "Limb"]
