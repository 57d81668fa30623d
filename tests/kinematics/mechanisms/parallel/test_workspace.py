"""Workspaces as solids: volumes against others, the stated error, and what is inside."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kinematics as kin
from kinematics.facets.solids import Resolution
from tests.kinematics.mechanisms.parallel.machines import case, machine


def gough() -> tuple[kin.Machine[Any], float]:
    one = case("volume_gough_level")
    limb = {"type": "UPS", **{key: one[key] for key in ("base", "platform", "stroke")}}
    return machine([{**limb, "base_cone": one["base_cone_deg"]}], [0, 0, 420]), one["volume"]


def delta() -> tuple[kin.Machine[Any], float]:
    one = case("volume_delta")
    limb = {
        "type": "delta",
        "base": [0, -one["base_radius"], 0],
        "axis": [1, 0, 0],
        "zero": [0, -1, 0],
        "platform": [0, -one["platform_radius"], 0],
        "crank": one["crank"],
        "rod": one["rod"],
        "mode": "-",
        "range": one["range_deg"],
        "parallelogram": one["parallelogram_deg"],
        "repeat": 3,
    }
    return machine([limb], [0, 0, -300]), one["volume"]


@pytest.mark.parametrize(
    ("made", "resolution", "within"),
    [
        (delta, "preview", 6e-3),
        pytest.param(gough, "preview", 6e-3, marks=pytest.mark.slow),
        pytest.param(delta, "normal", 5e-4, marks=pytest.mark.slow),
        pytest.param(gough, "normal", 5e-4, marks=pytest.mark.slow),
    ],
)
def test_volumes_are_within_the_error_that_is_stated(
    made: Any, resolution: Resolution, within: float
) -> None:
    m, volume = made()
    built = m.workspace(m.home.mode or None).solid(resolution).built
    assert built.watertight
    assert len(built.pieces) == 1
    assert abs(built.volume - volume) < built.volume_error < within * volume


@pytest.mark.parametrize("name", ["rpr-3", "upu-3"])
def test_a_solid_holds_what_can_be_held(name: str) -> None:
    """Its share of a box is that of poses drawn at random, angles drawn as lengths."""
    m = kin.open(name)
    space = m.workspace(m.home.mode or None)
    built = space.solid("preview").built
    bounds = np.array([piece.bounds for piece in built.pieces])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    points = np.random.default_rng(0).uniform(low, high, (60_000, 3))
    share = float(space.contains(points).mean())
    box = float(np.prod(high - low))
    spread = box * np.sqrt(share * (1.0 - share) / len(points))
    assert abs(built.volume - share * box) < built.volume_error + 4.0 * spread
    assert m.solids is not None
    home = m.solids.point("workspace", m.home.pose, m.home.mode)
    assert space.contains(home)
    assert m.solids.poses("workspace", m.home.pose, m.home.mode, home[None])[0] == pytest.approx(
        np.array(m.home.pose)
    )


def test_machines_whose_parasitic_motion_is_searched_for_have_no_solid() -> None:
    limb = {
        "type": "RPUR",
        "base": [[-55, 30, 50], [245, 30, 50], [20, 205, 0], [200, 180, 0], [0, 0, 0]],
        "platform": [[-50, 0, 0], [50, 0, 0], [0, 50, 0], [0, 50, -50], [0, -50, -50]],
        "base_axis": [0, 1, 0],
        "platform_axis": [1, 0, 0],
        "link": 150,
        "stroke": [250, 400],
    }
    m = machine([limb], [80, 90, 400], turn=[5, 8, 0])
    assert m.solids is not None  # its ψ never changes
    tilted = {**limb, "link": 300, "base_axis": [0.1, 1, 0.3], "platform_axis": [1, 0.2, 0.4]}
    other = machine(
        [tilted], [80, 90, 400], turn=[5, 8, 0], coordinates=["x", "y", "z", "theta", "psi"]
    )
    assert other.solids is None
