"""The page works for every kind: home, drag, drive, undo."""

from __future__ import annotations

import numpy as np
import pytest

from tests.app.seats import seat
from tests.conformance.machines import ONE_EACH, machine


@pytest.mark.parametrize("name", ONE_EACH)
def test_home_drag_drive_undo(name: str) -> None:
    m = machine(name)
    with seat(name) as page:
        home = page.review
        assert home.pose == m.home.pose
        assert "Reachable" in page.text()
        handle = page.node("/handle")
        place = np.add(handle.position, (2.0, 1.0, 1.0))
        for phase in ("start", "update", "end"):
            page.drag("/handle", place.tolist(), phase)
        dragged = page.review
        assert dragged.pose != home.pose
        assert dragged.posture.closes
        axis = m.joints[0]
        label = f"{axis.symbol} ({'mm' if axis.unit == 'mm' else '°'})"
        page.put(label, page.widget(label).value - 1.0)
        driven = page.review
        assert driven.pose != dragged.pose
        assert driven.posture.joints[1:] == pytest.approx(dragged.posture.joints[1:], abs=1e-6)
        page.press("Undo")
        assert page.review == dragged
        page.press("Undo")
        assert page.review == home
        page.press("Home position")
        assert page.review.pose == home.pose
        assert not page.told
