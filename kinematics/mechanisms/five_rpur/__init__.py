"""The 5-RPUR (3T2R) parallel mechanism of Tale Masouleh et al., Meccanica 46 (2011)."""

from __future__ import annotations

KINDS = {"five_rpur": "FiveRPUR"}
"""The class of each kind, in `mechanism`."""
