"""What is near a person's pointer: the handle, and the ghost that is filled and named."""

from __future__ import annotations

import numpy as np
import pytest

from app.features.solutions.part import SolutionsPart
from app.features.solutions.state import SetAtlas
from app.scene.camera import ISOMETRIC, axes_of
from app.scene.pointer import Pointer, on_screen
from tests.app.seats import Browser, Seat, seat


def test_points_are_where_the_picture_has_them() -> None:
    points = np.random.default_rng(1).uniform(-300.0, 300.0, (50, 3))
    client = Browser(points)
    at, depth = on_screen(client.camera, points)
    assert (depth > 0.0).all()
    # The frame fills 84 % of the tighter side, and is in the middle of it.
    low, high = at.min(axis=0), at.max(axis=0)
    size = (high - low) / (800.0, 600.0)
    assert size.max() == pytest.approx(0.84, abs=1e-6)
    assert (low + high)[int(size.argmax())] == pytest.approx((800.0, 600.0)[int(size.argmax())])
    # To the right on the screen is to the right; up is less.
    right, up, _ = axes_of(ISOMETRIC)
    pair, _ = on_screen(client.camera, np.array([[0.0, 0.0, 0.0], right, up]))
    assert pair[1, 0] > pair[0, 0]
    assert pair[2, 1] < pair[0, 1]
    pointer = Pointer(client, 1, (float(at[3, 0]), float(at[3, 1])))
    assert int(pointer.distances(points).argmin()) == 3
    behind = client.camera.position + 100.0 * (client.camera.position - points.mean(axis=0))
    assert np.isinf(pointer.distances(behind[None]))[0]
    assert np.isinf(Pointer(client, 1, None).distances(points)).all()


def test_the_handle_is_there_on_the_first_tab_and_near_the_pointer() -> None:
    with seat("rps-3") as page:
        handle, place = page.page.scene.handle, page.page.shown().platform[:3, 3]
        assert handle.visible
        client = Browser(place + 300.0 * np.concatenate([np.eye(3), -np.eye(3)]))
        at = on_screen(client.camera, place[None])[0][0]
        for tab, spot, seen in (
            (3, None, False),
            (3, (float(at[0]) + 3.0, float(at[1])), True),
            (3, (2.0, 2.0), False),
            (0, None, True),
            (4, (2.0, 2.0), False),
        ):
            page.page.point(Pointer(client, tab, spot))
            page.settle()
            assert handle.visible == seen
        page.page.scene.held = True  # a hand that has it keeps it
        page.page.point(Pointer(client, 2, None))
        page.settle()
        assert handle.visible


def _draw(page: Seat) -> None:
    """Have the solutions drawn without the pause that they take."""
    page.settle()
    part = page.page.part(SolutionsPart)
    part._from = 0.0
    page.ask(part.redraw)


def _named(page: Seat) -> str:
    node = page.node("/labels/nearest")
    return str(node.text) if node.visible else ""


def test_the_ghost_under_the_pointer_is_filled_and_named() -> None:
    with seat("rps-3") as page:
        page.do(SetAtlas("ghosts", True))
        _draw(page)
        owners, places = page.page.part(SolutionsPart)._ghosts.spots
        assert len(owners) > 2
        nearest = _named(page)
        assert nearest
        client = Browser(places)
        spots, _ = on_screen(client.camera, places)
        apart = np.linalg.norm(spots[:, None] - spots, axis=-1) + 1e9 * np.eye(len(spots))
        chosen = next(n for n in np.argsort(-apart.min(axis=1)) if f"#{owners[n]} " not in nearest)
        x, y = spots[chosen]
        page.page.point(Pointer(client, 1, (float(x), float(y))))
        _draw(page)
        assert _named(page).startswith(f"#{owners[chosen]} ")
        page.page.point(Pointer(client, 1, None))
        _draw(page)
        assert _named(page) == nearest
