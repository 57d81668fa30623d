"""The 3-RPS and 3-SPR parallel mechanisms, compared by Nayak et al. (2017)."""

from __future__ import annotations

KINDS = {"three_rps": "ThreeRPS", "three_spr": "ThreeSPR"}
"""The class of each kind, in `mechanism`."""
