"""Any parallel mechanism of one platform, described by its limbs."""

from __future__ import annotations

KINDS = {"parallel": "Parallel"}
"""The class of each kind, in `mechanism`."""
