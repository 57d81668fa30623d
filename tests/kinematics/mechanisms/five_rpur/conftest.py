"""What the tests of sections and volumes share: the kernel, compiled once."""

from __future__ import annotations

from importlib.util import find_spec

import pytest

from kinematics.mechanisms.five_rpur.slicing import acceleration, cutter


@pytest.fixture(scope="session")
def compiled() -> None:
    """Sections by the compiled kernel; in plain Python they are as right, but slow."""
    assert cutter.prepare() or find_spec("numba") is None
    assert acceleration.is_compiled() or find_spec("numba") is None
