"""The largest ball and box: of the present mode first, and it is said of which mode they are."""

from __future__ import annotations

import json
import re
from collections.abc import Callable

import numpy as np
import pytest

from app.features.move.state import Flip, Move, Place
from app.features.workspace.compute import Built, Solids, build, piece_around, wishes
from app.features.workspace.html import report_html
from app.features.workspace.state import ChooseModes
from app.review.changes import change
from app.review.state import new_review
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.app import seats
from tests.conftest import Finished

Run = Callable[..., Finished]
MACHINE = machine_of(load_design("rpur-table1"))


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(seats, "INLINE", (*seats.INLINE, "measures"))
    with seats.seat() as opened:
        yield opened


def _corners(text: str) -> np.ndarray:
    """The corners of the box that a page tells of."""
    sides, _, rest = text.partition("Box: ")[2].partition(" mm about ")
    size = np.array([float(v) for v in sides.split(" × ")])
    middle = [float(v) for v in rest.partition(" mm,")[0].replace("−", "-").split(", ")]
    signs = np.stack(np.meshgrid(*[[-1, 1]] * 3), axis=-1).reshape(-1, 3)
    return np.array(middle) + 0.499 * signs * size


def _reached(points: np.ndarray, mode: str) -> bool:
    poses = np.concatenate([points, np.zeros((len(points), 2))], axis=1)
    return all(MACHINE.at(pose, mode).reachable for pose in poses.tolist())


def test_the_page_asks_for_the_present_mode_and_says_so(page: seats.Seat) -> None:
    home = page.review.mode
    page.press("Largest box")
    own = page.text()
    assert "mode +−+−+" in own.partition("Box: ")[2][:120]
    assert _reached(_corners(own), home)
    page.put("Modes together", True)
    page.press("Largest box")
    both = page.text()
    assert "all working modes together" in both.partition("Box: ")[2][:140]
    assert not _reached(_corners(both), home)
    page.put("Modes together", False)
    page.press("Largest box")
    page.do(Flip("+-+--"))
    assert "Box: " not in page.text()  # it was of another mode


def test_the_command_tells_of_the_home_mode_first(here: Run) -> None:
    done = here("volume", "rpur-table1", "--usable")
    text = done.stdout
    assert text.index("working mode +-+-+, which") < text.index("all working modes together")
    answer = json.loads(here("volume", "rpur-table1", "--usable", "--json").stdout)
    own = answer["home_mode"]
    assert own["mode"] == MACHINE.home.mode
    assert 0.0 < own["box"]["volume_mm3"] < answer["box"]["volume_mm3"]
    low, high = np.array(own["box"]["low_mm"]), np.array(own["box"]["high_mm"])
    corners = low + np.array(list(np.ndindex(2, 2, 2))) * (high - low) * 0.999
    assert _reached(corners, own["mode"])
    alone = json.loads(
        here("volume", "rpur-table1", "--modes", "home", "--usable", "--json").stdout
    )
    assert alone["box"] == own["box"]
    assert "home_mode" not in alone


def test_a_position_that_only_other_modes_reach_is_no_contradiction() -> None:
    home = new_review(load_design("rpur-table1"))
    other = next(m for m in MACHINE.modes if not MACHINE.at(home.pose, m).reachable)
    there, _ = change(home, Flip(other))
    there, _ = change(there, ChooseModes("all"))
    said = report_html(there, Solids((), {}, {}, None), None)
    assert "O′ inside" in said
    assert "but not in mode" in said
    assert "but not" not in report_html(home, Solids((), {}, {}, None), None)
    alone, _ = change(home, Flip(other))
    assert "O′ outside" in report_html(alone, Solids((), {}, {}, None), None)


def test_the_piece_of_the_machine_is_told_at_any_orientation() -> None:
    turned, _ = change(new_review(load_design("rpur-table1")), Move(4, 0.25))
    (wish,) = wishes(turned)
    built = Built(wish, "normal", build(wish.requests["normal"]))
    rng = np.random.default_rng(1)
    poses = np.tile(turned.pose, (200_000, 1))
    poses[:, :3] = rng.uniform(-500.0, 550.0, (len(poses), 3))
    told = set()
    for pose in poses[MACHINE.inverse.inside(poses, (turned.mode,))][:40].tolist():
        there, _ = change(turned, Place(tuple(pose)))
        html = report_html(there, Solids((wish,), {"workspace": built}, {}, None), None)
        (row,) = re.findall(r"<tr aria-current>.*?</tr>", html) or [""]
        here = piece_around(there, built)
        assert ("the machine is here" in row) == (here is not None)
        if here is not None:
            own = built.wish.placement[:3, :3].T @ np.array(pose[:3])  # built about the y axis
            low, high = built.solid.pieces[here].bounds
            assert (np.array(low) <= own).all()
            assert (own <= np.array(high)).all()
            told.add(re.sub(r"<[^>]*>", "", row)[0])
    assert told == {"1", "2"}
    before = report_html(turned, Solids((wish,), {}, {"workspace": built}, None), None)
    assert "the machine is here" not in before  # where it is in a solid of before is not told
