"""The 4-SPS + 1-SPR parallel mechanism (5 DOF) of Wang et al. (2017)."""

from __future__ import annotations

KINDS = {"four_sps_spr": "FourSPSSPR"}
"""The class of each kind, in `mechanism`."""
