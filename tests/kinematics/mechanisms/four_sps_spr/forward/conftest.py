from __future__ import annotations

import pytest

from kinematics.mechanisms.four_sps_spr.forward import roots


@pytest.fixture(autouse=True)
def own_start_sets() -> None:
    """Made anew in each test: what other tests have asked for does not decide what is found."""
    roots._own._sets.clear()
