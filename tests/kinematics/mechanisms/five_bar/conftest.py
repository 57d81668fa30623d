"""What the tests of the five-bar share: the paper's machine, others, and the reference in mm."""

from __future__ import annotations

import json
from typing import Any

import pytest

from kinematics.mechanisms.five_bar.design import FiveBarDesign, Limb
from tests.conftest import ROOT

PAPER = FiveBarDesign((Limb(480.0, 480.0), Limb(480.0, 480.0)), 240.0)
UNLIKE = FiveBarDesign((Limb(300.0, 480.0), Limb(400.0, 250.0)), 240.0)
SHORT = FiveBarDesign((Limb(350.0, 300.0), Limb(320.0, 410.0)), 250.0)
APART = FiveBarDesign((Limb(400.0, 100.0), Limb(100.0, 420.0)), 240.0)
RANGED = FiveBarDesign((Limb(300.0, 480.0, (-30.0, 200.0)), Limb(400.0, 250.0)), 240.0)
BOTH = FiveBarDesign(
    (Limb(480.0, 480.0, (-30.0, 210.0)), Limb(480.0, 480.0, (-30.0, 210.0))), 240.0
)
EQUAL = FiveBarDesign((Limb(240.0, 240.0), Limb(240.0, 240.0)), 240.0)  # change points
EMPTY = FiveBarDesign((Limb(100.0, 100.0), Limb(100.0, 100.0)), 240.0)

MACHINES = {
    "paper": PAPER,
    "unlike": UNLIKE,
    "short": SHORT,
    "apart": APART,
    "ranged": RANGED,
    "both": BOTH,
    "equal": EQUAL,
}


@pytest.fixture(scope="session")
def reference() -> dict[str, Any]:
    """`tests/reference/five_bar.json`: cm and rad."""
    found: dict[str, Any] = json.loads((ROOT / "tests/reference/five_bar.json").read_text())
    return found
