"""Any change at any time on any mechanism: taken, or refused in a sentence; kept in a file."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.features.design.state import EditDesign, UseDesign
from app.features.map.state import Chart, SetChart, Span
from app.features.move.state import Drive, Flip, GiveWay, GoHome, Move, Place, Visit
from app.features.section import compute as slicer
from app.features.section.state import MoveCut, SetCut
from app.features.singularities.compute import OTHER, beside, counterpart, spot_of
from app.features.singularities.state import Control, SetControl
from app.features.solutions.state import SetAtlas
from app.features.workspace import compute as regions
from app.features.workspace.state import ChooseModes, Fade, Flat, SetFlat, Show
from app.review import session
from app.review import view as compute
from app.review.changes import Change, change
from app.review.history import History
from app.review.state import Review, new_review
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import Design

MACHINES = ("rpur-table1", "five-bar", "rps-3", "spr-3", "sps-spr")

_design = cache(load_design)


def _all(what: str) -> list[Any]:
    """The keys of something that any of the machines has."""
    found: list[Any] = []
    for name in MACHINES:
        review = new_review(_design(name))
        kind, design = review.machine, review.design
        found += {
            "measures": [m.key for m in machine_of(design).measures.specs],
            "charts": [s.key for s in machine_of(design).singularities.loci],
            "flats": [s.key for s in machine_of(design).region_specs],
            "solids": [s.key for s in machine_of(design).solid_specs],
            "modes": [*kind.modes],
            "paths": [f.path for f in machine_of(design).fields],
            "ways": [c.key for c in machine_of(design).coordinates],
        }[what]
    return list(dict.fromkeys(found))


_anything = st.one_of(
    st.floats(-700.0, 700.0),
    st.floats(-4.0, 4.0),
    st.sampled_from([0.0, math.pi, -math.pi, math.pi / 2, 1e9, -1e-300, math.nan, math.inf]),
)
_poses = st.lists(_anything, min_size=2, max_size=6).map(tuple)
_numbers = st.lists(_anything, max_size=6).map(tuple)

CHANGES: st.SearchStrategy[Change] = st.one_of(
    st.builds(Move, st.integers(0, 5), _anything),
    st.builds(Place, _poses),
    st.builds(Drive, st.integers(0, 4), _anything),
    st.builds(Flip, st.sampled_from(_all("modes"))),
    st.builds(Visit, _poses, st.sampled_from(_all("modes"))),
    st.just(GoHome()),
    st.builds(UseDesign, st.sampled_from([_design(name) for name in MACHINES])),
    st.builds(UseDesign, st.sampled_from([_design(name) for name in MACHINES])),
    st.builds(
        EditDesign,
        st.tuples(
            st.tuples(
                st.sampled_from(_all("paths")),
                st.one_of(st.floats(-500.0, 500.0), st.sampled_from([0.0, math.nan])),
            )
        ),
    ),
    st.builds(Show, st.sampled_from(_all("solids")), st.booleans()),
    st.builds(Fade, st.just(("workspace", "aspects")), st.floats(-0.5, 1.5)),
    st.builds(ChooseModes, st.sampled_from(["all", "current", *[(m,) for m in _all("modes")]])),
    st.builds(SetAtlas, st.just("modes"), st.sampled_from(["", "same", "?????", "1", "+?", "x"])),
    st.builds(SetCut, st.just("on"), st.booleans()),
    st.builds(MoveCut, _anything),
    st.builds(
        SetChart,
        st.builds(
            Chart,
            st.sampled_from(["volume", "pieces", "x"]),
            st.builds(Span, _anything, _anything, st.integers(-1, 100)),
        ),
    ),
    st.builds(SetControl, st.just("shade"), st.sampled_from(["", *_all("measures")])),
    st.builds(SetControl, st.just("chart"), st.sampled_from(["", *_all("charts")])),
    st.builds(SetControl, st.just("compare"), st.booleans()),
    st.builds(SetControl, st.sampled_from(["ratios", "load", "rates", "accelerations"]), _numbers),
    st.builds(SetFlat, st.just("key"), st.sampled_from(_all("flats"))),
    st.builds(GiveWay, st.sampled_from(["", *_all("ways")])),
)


@settings(max_examples=120)
@given(st.sampled_from(MACHINES), st.lists(CHANGES, min_size=1, max_size=12))
def test_changes_are_taken_or_refused_in_words_and_undone(name: str, steps: list[Change]) -> None:
    start = new_review(_design(name))
    history = History(start)
    for n, step in enumerate(steps):
        before = history
        try:
            history, note = history.apply(step, 10.0 * n)
        except InputError:
            assert before is history
            continue
        assert "\n" not in note
        review = history.present
        assert len(review.pose) == len(review.machine.coordinates)
        assert all(map(math.isfinite, review.pose))
        assert review.mode in review.machine.modes
    review = history.present
    # Whatever it has come to, it can be shown and written down.
    view = compute.view(review)
    assert view.status.text
    assert len(view.joints) == len(review.machine.joints)
    assert regions.wish(review) is None or review.machine.region_specs
    if review.machine.section_spec is not None:
        assert slicer.wish(review).region.design == review.design
    assert spot_of(review).posture.reasons == view.posture.reasons
    other = counterpart(review)
    assert (other is None) == (beside(review) is None)
    _assert_kept(review)
    for _ in history.past:
        history = history.undo()
    assert history.present == start


def _assert_kept(review: Review) -> None:
    """A session file gives back what it was made of."""
    axes = review.machine.coordinates
    if any(not c.lower <= v <= c.upper for c, v in zip(axes, review.pose, strict=True)):
        return  # a visit next to the sliders' range is brought into it
    text = session.to_text(review)
    again = session.from_text(text, origin="x")
    assert again.pose == pytest.approx(review.pose, rel=1e-12, abs=1e-12)
    assert replace(again, pose=review.pose).having(review[Chart]) == review
    for name in ("first", "second"):
        span, kept = getattr(again[Chart], name), getattr(review[Chart], name)
        assert (span.low, span.high) == pytest.approx((kept.low, kept.high), abs=1e-12)
    assert again[Chart].quantity == review[Chart].quantity


def _busy(name: str) -> Review:
    """A review in which everything that the mechanism offers is set to something else."""
    review = new_review(_design(name))
    design = review.design
    axes = machine_of(design).coordinates
    control = Control(
        wrenches=True,
        clearances=True,
        locus=False,
        chart=machine_of(design).singularities.loci[-1].key,
        shade=machine_of(design).measures.specs[0].key,
        compare=True,
        ratios=(0.5, 2.0),
        load=(1.0, -2.5, 30.0, 0.0, 100.0, -7.0),
        forces=True,
        arrow=True,
        rates=tuple(0.5 * n for n in range(len(axes))),
        accelerations=tuple(-0.25 * n for n in range(len(axes))),
    )
    flats = machine_of(design).region_specs
    dependent = machine_of(design).dependent
    flat = Flat(False, flats[-1].key if flats else "workspace", False)
    way = axes[dependent[-1]].key if dependent else ""
    return replace(review, gives_way=way).having(control, flat)


@pytest.mark.parametrize("name", MACHINES)
def test_every_setting_survives_in_a_file(name: str) -> None:
    _assert_kept(_busy(name))


@pytest.mark.parametrize("one", MACHINES)
@pytest.mark.parametrize("other", MACHINES)
def test_another_mechanism_takes_over_what_it_has_too(one: str, other: str) -> None:
    before = _busy(one)
    after, _ = change(before, UseDesign(_design(other)))
    design = after.design
    kept, had = after[Control], before[Control]
    assert kept.shade == (
        had.shade if had.shade in [m.key for m in machine_of(design).measures.specs] else ""
    )
    charts = [s.key for s in machine_of(design).singularities.loci]
    assert kept.chart == (had.chart if had.chart in charts else "")
    same = len(machine_of(design).coordinates) == len(had.rates)
    assert kept.rates == (had.rates if same else ())
    assert kept.accelerations == (had.accelerations if same else ())
    for name in ("wrenches", "clearances", "locus", "compare", "ratios", "load", "forces", "arrow"):
        assert getattr(kept, name) == getattr(had, name)
    assert (after[Flat].on, after[Flat].locus) == (False, False)
    flats = [s.key for s in machine_of(design).region_specs]
    assert not flats or after[Flat].key == (
        before[Flat].key if before[Flat].key in flats else "workspace"
    )
    assert after.gives_way == (before.gives_way if machine_of(design).dependent else "")
    assert after.posture.reachable
    _assert_kept(after)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ({"control": []}, "'control' is not of the right kind"),
        ({"control": {"forces": 1}}, "control: forces is not of the right kind"),
        ({"control": {"load": [0, 0, "much", 0, 0, 0]}}, "control: load must be a finite number"),
        ({"control": {"load": [1, 2, 3]}}, "a load is six numbers within"),
        ({"control": {"rates": [1, 2]}}, "rates are 6 numbers within"),
        ({"control": {"chart": "orientation"}}, "a chart of loci is one of plane"),
        ({"control": {"shade": "transmission"}}, "colour shows conditioning"),
        ({"control": {"ratios": [0.5, -1]}}, "a ratio is a positive number"),
        ({"regions": 3}, "'regions' is not of the right kind"),
        ({"regions": {"key": "aspects"}}, "regions are workspace, not 'aspects'"),
        ({"regions": {"on": "no"}}, "regions: on is not of the right kind"),
        ({"gives_way": ["x"]}, "'gives_way' is not of the right kind"),
        ({"gives_way": "phi"}, "what gives way is one of x, y, z, alpha, beta, gamma"),
    ],
)
def test_broken_settings_are_told(edit: dict, message: str) -> None:
    import json

    content = json.loads(session.to_text(_busy("sps-spr"))) | edit
    with pytest.raises(InputError, match=message) as caught:
        session.from_text(json.dumps(content), origin="a.json")
    assert str(caught.value).startswith("a.json: ")


@pytest.mark.parametrize("name", MACHINES)
def test_older_sessions_still_open(name: str) -> None:
    import json

    review = _busy(name)
    content = json.loads(session.to_text(review))
    for key in ("control", "regions", "gives_way"):
        del content[key]
    again = session.from_text(json.dumps(content), origin="x")
    fresh = new_review(review.design)
    assert (again[Control], again[Flat], again.gives_way) == (fresh[Control], fresh[Flat], "")


def test_a_mode_that_is_none_is_told_in_the_mechanisms_words() -> None:
    import json

    for name, message in (
        ("rps-3", "operation mode is one of '1', '2'"),
        ("five-bar", "working mode is one of"),
    ):
        content = json.loads(session.to_text(new_review(_design(name)))) | {"working_mode": "x"}
        with pytest.raises(InputError, match=message):
            session.from_text(json.dumps(content), origin="x")


def test_changes_that_come_late_for_another_mechanism_are_refused_in_words() -> None:
    review = new_review(_design("five-bar"))
    rpur = new_review(_design("rpur-table1"))
    for late in (
        Move(4, 0.1),
        Drive(3, 300.0),
        Place(rpur.pose),
        Visit(rpur.pose, "++"),
        Flip(rpur.mode),
        ChooseModes((rpur.mode,)),
        EditDesign(((("limb", 0, "link"), 160.0),)),
        SetControl("chart", "orientation"),
    ):
        with pytest.raises(InputError):
            change(review, late)


def test_one_coordinate_gives_way_to_the_one_that_is_moved() -> None:
    review = new_review(_design("sps-spr"))
    review, _ = change(review, GiveWay("y"))
    moved, note = change(review, Move(4, 0.2))
    assert note == ""
    assert [n for n in range(6) if moved.pose[n] != review.pose[n]] == [1, 4]
    assert moved.posture.residual < 1e-9
    # It cannot give way to itself: another one does.
    itself, _ = change(moved, Move(1, moved.pose[1] + 5.0))
    assert itself.pose[1] == moved.pose[1] + 5.0
    assert itself.posture.residual < 1e-9
    with pytest.raises(InputError, match="gives way is one of"):
        change(review, GiveWay("rho1"))


def _home(design: Design) -> Review:
    return new_review(design)


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_the_counterpart_stands_beside_at_the_same_coordinates(name: str) -> None:
    review, _ = change(_home(_design(name)), SetControl("compare", True))
    moved, _ = change(review, Place((review.pose[0] * 0.98, 0.3, 1.0)))
    view = compute.view(moved)
    there = beside(moved)
    assert there is not None
    kind = replace(moved, design=there.design).machine
    assert kind.kind != moved.machine.kind
    assert there.posture == machine_of(there.design).inverse.posture(moved.pose, moved.mode)
    true = machine_of(there.design).drawing(there.posture)
    for bar, own in zip(there.drawing.bars, true.bars, strict=True):
        assert bar.start == pytest.approx(tuple(own.start + there.offset))
        assert bar.limb == (None if own.limb is None else own.limb + OTHER)
    at = machine_of(there.design).transform(there.posture.pose, there.posture.mode)
    for body, own_body in zip(there.drawing.bodies, true.bodies, strict=True):
        assert body.frame == "base"
        for point, own_point in zip(body.points, own_body.points, strict=True):
            placed = own_point if own_body.frame == "base" else (at @ [*own_point, 1.0])[:3]
            assert point == pytest.approx(tuple(placed + there.offset))
    names = {bar.name for bar in view.drawing.bars} | {b.name for b in view.drawing.bodies}
    others = {bar.name for bar in there.drawing.bars} | {b.name for b in there.drawing.bodies}
    assert not names & others
    # Far enough not to stand in each other.
    reach = max(p[0] for bar in view.drawing.bars for p in (bar.start, bar.end))
    near = min(p[0] for bar in there.drawing.bars for p in (bar.start, bar.end))
    assert near > reach
