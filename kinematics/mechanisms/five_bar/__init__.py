"""The planar five-bar (5R) of Sosa-López, Arias-Montiel and Lugo-González (2017)."""

from __future__ import annotations

KINDS = {"five_bar": "FiveBar"}
"""The class of each kind, in `mechanism`."""
