"""Small parts of regions and their files: how far an edge gets, and which colour a layer has."""

from __future__ import annotations

import numpy as np
import pytest
from ezdxf.colors import aci2rgb

from kinematics.mechanisms.five_bar import workspace
from kinematics.plane import arcs
from kinematics.plane.files import _nearest_index
from tests.kinematics.mechanisms.five_bar.conftest import UNLIKE


def test_an_edge_gets_as_far_as_its_farthest_point() -> None:
    for loop in workspace.loops(UNLIKE, ("+-",)):
        for edge in loop:
            points = np.array([edge.point(s) for s in np.linspace(0.0, 1.0, 40)])
            far = np.hypot(*(points - edge.first).T).max()
            assert arcs.extent(edge) == pytest.approx(far, rel=0.05)


def test_a_colour_that_is_numbered_has_its_number_and_each_is_used_once() -> None:
    for index in (1, 3, 5, 30, 212):
        assert tuple(aci2rgb(_nearest_index(aci2rgb(index), ()))) == tuple(aci2rgb(index))
    used: set[int] = set()
    for _ in range(5):
        used.add(_nearest_index(aci2rgb(1), used))
    assert len(used) == 5
    away = [sum((a - b) ** 2 for a, b in zip(aci2rgb(n), aci2rgb(1), strict=True)) for n in used]
    others = [
        sum((a - b) ** 2 for a, b in zip(aci2rgb(n), aci2rgb(1), strict=True))
        for n in range(1, 250)
        if n != 7 and n not in used
    ]
    assert max(away) <= min(others)
