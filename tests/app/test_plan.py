"""The trajectory of a review: what is taken, what is refused, and that a file keeps it."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.features.design.state import UseDesign
from app.features.trajectory.state import (
    MOST_POINTS,
    Plan,
    SetPlan,
    missing,
    path_of,
    plane_of,
    trimmed,
)
from app.review import session
from app.review.changes import change
from app.review.history import History
from app.review.state import Review, new_review
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of


@pytest.fixture(scope="module")
def rpur() -> Review:
    return new_review(load_design("rpur-table1"))


@pytest.fixture(scope="module")
def bar() -> Review:
    return new_review(load_design("five-bar"))


def _set(review: Review, **values: Any) -> Review:
    return change(review, SetPlan(tuple(values.items())))[0]


def test_a_fresh_plan_is_the_machines_own_or_begins_at_home(rpur: Review, bar: Review) -> None:
    assert bar[Plan].way == "line"
    assert not missing(bar[Plan])
    assert rpur[Plan].way == "straight"
    assert rpur[Plan].start == rpur.pose
    assert "To here" in missing(rpur[Plan])
    assert not rpur[Plan].on


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"way": "round"}, "a way is one of straight"),
        ({"law": "cosine"}, "a time law is one of linear"),
        ({"plot": "mass"}, "a plot is one of"),
        ({"playback": "back"}, "a playback"),
        ({"end": (1.0, 2.0)}, "5 finite numbers"),
        ({"points": ((0.0,) * 5, (np.nan,) * 5)}, "5 finite numbers"),
        ({"points": ((0.0,) * 5,) * (MOST_POINTS + 1)}, "the command line takes more"),
        ({"plane": ("x", "x")}, "two different"),
        ({"plane": ("x", "w")}, "a stroke lies in two of x"),
        ({"duration": -1.0}, "a duration"),
        ({"duration": 1e-9}, "at least 1e-6"),
        ({"samples": 1}, "how many samples"),
        ({"pace": 0.2}, "the pace of a playback lies within 0.25 … 4"),
        ({"pace": 5.0}, "the pace of a playback lies within 0.25 … 4"),
        ({"degree": 99}, "the degree"),
        ({"rates": (1.0, 2.0)}, "5 positive numbers"),
        ({"forces": (1.0, 1.0, 1.0, 1.0, 0.0)}, "5 positive numbers"),
        ({"file": ((0.0,) * 5,), "times": (0.0, 1.0)}, "a time for each"),
        ({"file": ((0.0,) * 5,) * 2, "times": (1.0, 1.0)}, "increase"),
        ({"file_open": "w"}, "is none"),
    ],
)
def test_each_fault_is_named(rpur: Review, values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        _set(rpur, **values)


def test_each_way_makes_its_path(rpur: Review) -> None:
    design = rpur.design
    home = np.array(rpur.pose)
    along = np.array([1.0, 0.5, 0.0, 0.0, 0.0])
    poses = tuple(tuple((home + d * along).tolist()) for d in (0.0, 10.0, 25.0))
    plan = replace(rpur[Plan], end=poses[2])
    path, law = path_of(plan, machine_of(design))
    assert path.length == pytest.approx(np.hypot(25.0, 12.5))
    assert (law.kind, law.duration) == ("quintic", 1.0)
    path, law = path_of(
        replace(plan, law="trapezoidal", speed=5.0, acceleration=10.0), machine_of(design)
    )
    assert path.length / law.duration / (1.0 - law.ramp) == pytest.approx(5.0)
    way = replace(plan, way="points", points=poses, through="lines", law="linear", duration=3.0)
    path, law = path_of(way, machine_of(design))
    assert law.duration == 3.0
    np.testing.assert_allclose(path.at([1.0])[0][0], poses[2], atol=1e-9)
    timed = replace(plan, way="file", file=poses, times=(1.0, 2.0, 5.0))
    path, law = path_of(timed, machine_of(design))
    assert (law.kind, law.duration) == ("linear", 4.0)
    np.testing.assert_allclose(path.at([0.25])[0][0], poses[1], atol=1e-9)
    with pytest.raises(InputError, match="Draw the path"):
        path_of(replace(plan, way="stroke"), machine_of(design))


def test_typing_is_one_step_of_undo_and_buttons_are_one_each(rpur: Review) -> None:
    history = History(rpur)
    for n, duration in enumerate((1.0, 12.0, 12.5)):
        typed = SetPlan((("duration", duration),), gesture="plan ['duration']")
        history, _ = history.apply(typed, 0.1 * n)
    assert len(history.past) == 1
    for n in range(2):
        points = (*history.present[Plan].points, tuple(v + n for v in rpur.pose))
        history, _ = history.apply(SetPlan((("points", points),)), 0.4 + 0.1 * n)
    assert len(history.past) == 3
    assert history.undo().present[Plan].points == (rpur.pose,)


@pytest.mark.parametrize("name", ["rpur-table2", "five-bar", "sps-spr", "rps-3"])
def test_a_plan_goes_with_another_machine_as_far_as_it_can(name: str, rpur: Review) -> None:
    before = _set(rpur, on=True, law="cubic", points=(rpur.pose, rpur.pose), rates=(5.0,) * 5)
    design = load_design(name)
    after, _ = change(before, UseDesign(design))
    same = design.mechanism == rpur.design.mechanism
    assert after[Plan].on
    assert after[Plan].law == "cubic"
    assert bool(after[Plan].points) == same
    assert bool(after[Plan].rates) == same
    assert after[Plan].way in (Plan.fresh(after).way, rpur[Plan].way)


def test_a_named_way_does_not_go_to_a_machine_without_it(bar: Review) -> None:
    after, _ = change(bar, UseDesign(load_design("rps-3")))
    assert after[Plan] == Plan.fresh(after)


def test_a_plane_is_two_coordinates(rpur: Review) -> None:
    axes = rpur.machine.coordinates
    assert plane_of(rpur[Plan], axes) == (0, 1)
    assert plane_of(replace(rpur[Plan], plane=("theta", "y")), axes) == (4, 1)


def test_long_strokes_are_thinned_out_and_keep_their_ends() -> None:
    points = [(float(n), 0.0) for n in range(1234)]
    kept = trimmed(points)
    assert len(kept) == 300
    assert (kept[0], kept[-1]) == (points[0], points[-1])
    assert trimmed(points[:7]) == tuple(points[:7])


# --- in a session file ---------------------------------------------------------------------


def _full(review: Review) -> Review:
    pose = review.pose
    size = len(review.machine.joints)
    other = tuple(v + 0.1 for v in pose)
    axes = review.machine.coordinates
    return _set(
        review,
        on=True,
        way="file",
        end=other,
        points=(pose, other),
        file=(other, pose, other),
        file_name="a “b”.csv",
        times=(0.0, 0.1, 2.5),
        through="lines",
        blend=3.0,
        plane=(axes[1].key, axes[0].key),
        stroke=(pose, other, pose),
        smooth=1.5,
        law="trapezoidal",
        duration=2.25,
        samples=77,
        rates=(0.3,) * size,
        accelerations=(0.7,) * size,
        forces=(9.0,) * size,
        playback="swing",
        pace=0.25,
        degree=7,
        plot="forces",
    )


@pytest.mark.parametrize("name", ["rpur-table1", "five-bar", "sps-spr", "rps-3", "spr-3"])
def test_a_session_keeps_all_of_it(name: str) -> None:
    review = _full(new_review(load_design(name)))
    again = session.from_text(session.to_text(review), origin="x")[Plan]
    for field in ("start", "end", "points", "file", "stroke", "rates", "accelerations"):
        kept, had = getattr(again, field), getattr(review[Plan], field)
        np.testing.assert_allclose(np.array(kept), np.array(had), atol=1e-12)
        again = replace(again, **{field: had})
    assert again == review[Plan]


def test_sessions_from_before_there_were_trajectories_still_open(bar: Review) -> None:
    content = json.loads(session.to_text(bar))
    del content["trajectory"]
    assert session.from_text(json.dumps(content), origin="x")[Plan] == bar[Plan]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], "'trajectory' is not of the right kind"),
        ({"on": 1}, "trajectory: on is not of the right kind"),
        ({"samples": 5.5}, "trajectory: samples is not of the right kind"),
        ({"duration": "long"}, "duration must be a finite number"),
        ({"start": [1, 2]}, "start is not of the right kind"),
        ({"start": "1 2 3"}, "a pose has 2 numbers, got 3"),
        ({"start": "1 b"}, "not numbers"),
        ({"points": "1 2"}, "points is not of the right kind"),
        ({"points": ["1 nan", "2 3"]}, "finite numbers"),
        ({"plane": ["x"]}, "plane is not of the right kind"),
        ({"plane": ["x", 3]}, "plane is not of the right kind"),
        ({"rates": [1.0]}, "2 positive numbers"),
        ({"rates": [1.0, 2.0, 3.0]}, "2 positive numbers"),
        ({"rates": ["a", 2.0]}, "finite number"),
        ({"law": "cosine"}, "a time law"),
    ],
)
def test_broken_trajectories(bar: Review, given: object, message: str) -> None:
    content = json.loads(session.to_text(bar)) | {"trajectory": given}
    with pytest.raises(InputError, match=message) as caught:
        session.from_text(json.dumps(content), origin="a.json")
    assert str(caught.value).startswith("a.json: ")


def test_the_largest_path_fits_into_a_session_file(rpur: Review) -> None:
    rng = np.random.default_rng(1)
    home = np.array(rpur.pose)
    poses = tuple(tuple((home + rng.normal(size=5)).tolist()) for _ in range(MOST_POINTS))
    times = tuple((np.arange(MOST_POINTS) / 7.0).tolist())
    review = _set(rpur, points=poses, file=poses, times=times, stroke=poses[:300])
    assert len(session.to_text(review)) < session.MAX_BYTES


def test_the_default_plan_is_sound_nowhere_but_without_a_machine() -> None:
    assert Plan().start == ()
    assert machine_of(load_design("five-bar")).paths.named()[0].name == "line"
