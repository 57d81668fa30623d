"""What the page says of control: true to the numbers, and harmless whatever the text is."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from app.features.singularities import compute
from app.features.singularities import html as told
from app.features.singularities.compute import Controlled, Here, Logged, counterpart, spot_of
from app.features.singularities.state import SetControl
from app.features.workspace.compute import Solids
from app.features.workspace.state import Shown, Workspace
from app.review.changes import change
from app.review.state import new_review
from app.scene import painting, palette
from kinematics.answers.circles import OrientationCircle
from kinematics.answers.clearances import Clearance, DesignChange, Remedy
from kinematics.answers.motion import Statics
from kinematics.answers.sections import Sphere
from kinematics.answers.singularities import Measure, Singularity
from kinematics.designs.files import load_design

EVIL = "<script>alert('1' & \"2\")</script>"
MACHINES = ("rpur-table1", "five-bar", "rps-3", "spr-3", "sps-spr")


@cache
def _here(name: str, load: tuple[float, ...] = (10.0, -20.0, -100.0, 0.0, 0.0, 50.0)) -> Here:
    review, _ = change(new_review(load_design(name)), SetControl("load", load))
    return compute.look(spot_of(review))


def _controlled(here: Here | None, **more: Any) -> Controlled:
    nothing = Controlled(here)
    return replace(nothing, **more)


def _parsed(html: str) -> ElementTree.Element:
    """As a browser reads it; XML is the stricter of both."""
    return ElementTree.fromstring(f"<div>{html.replace('<br>', '<br/>')}</div>")


def _text(html: str) -> str:
    return " ".join("".join(_parsed(html).itertext()).split())


def _harmless(html: str) -> None:
    assert "<script" not in html
    assert "alert" in "".join(_parsed(html).itertext())


def test_whatever_is_told_is_text_and_nothing_else() -> None:
    here = _here("rpur-table1")
    posture = here.place.posture
    singular = Singularity("parallel", (1,), EVIL, EVIL, 0.0)
    way = Clearance("stroke", 1.0, (0.0, 0.0, 0.0), EVIL, 1, "rho_min")
    better = DesignChange(("x",), EVIL, 1.0, 2.0, EVIL)
    circle = OrientationCircle("parallel", 0.5, (), EVIL)
    measure = Measure("m", EVIL, EVIL, "high", (0.0, 1.0))
    remedy = Remedy(posture, 1.0, ((better,),), EVIL)
    assert here.statics is not None
    names = tuple(replace(name, symbol=EVIL) for name in here.statics.names)
    evil = replace(
        here,
        singular=(singular,),
        clearances=(way,),
        circles=(circle,),
        measures=((measure, 0.5),),
        statics=Statics(names, here.statics.forces, here.statics.residual),
    )
    steps = painting.scale(np.arange(5.0), high=True, limits=(None, None))
    assert steps is not None
    other = replace(evil, measures=((measure, 0.25),))
    for html in (
        told.here_html(_controlled(evil)),
        told.here_html(_controlled(evil, trouble=EVIL)),
        told.measures_html(evil),
        told.clearances_html(evil).replace('title="', "").replace('"><td', "<td"),
        told.ways_html(remedy),
        told.forces_html(evil),
        told.circles_html(evil),
        told.comparison_html(evil, other),
        told.legend_html(measure, steps),
        told.log_html((Logged(0.0, EVIL, "stop"),)),
    ):
        assert "<script" not in html
        assert "alert(" in html
    _harmless(told.here_html(_controlled(evil)))
    _harmless(told.forces_html(evil))
    _harmless(told.comparison_html(evil, other))
    # In an attribute as well.
    titles = [each.get("title") for each in _parsed(told.clearances_html(evil)).iter("span")]
    assert EVIL in titles


@pytest.mark.parametrize("name", MACHINES)
def test_forces_are_those_of_the_statics_in_their_units(name: str) -> None:
    here = _here(name)
    assert here.statics is not None
    html = told.forces_html(here)
    rows = list(_parsed(html).iter("tr"))
    values = np.asarray(here.statics.forces)
    assert len(rows) == len(values)
    rotary = name == "five-bar"
    for row, symbol, value, unit in zip(
        rows, here.statics.names, values.tolist(), here.force_units, strict=True
    ):
        words = " ".join(" ".join(row.itertext()).split())
        assert words == f"{symbol.symbol} {value:.4g} {unit}".replace("-", "−")
        if symbol.kind == "actuation":
            assert unit == ("N·mm" if rotary else "N")
        bar = row[2][0][0].get("style", "")
        assert f"left:{50.0 if value >= 0 else 0.0:.1f}%" in bar or value < 0
        assert "−" not in bar  # minus signs are for numbers, not for style sheets
    assert "−align" not in html
    assert "−nums" not in html
    assert ("pushes" in html) == (not rotary)


@pytest.mark.parametrize("name", MACHINES)
def test_what_limbs_exert_holds_what_can_be_held(name: str) -> None:
    here = _here(name)
    assert here.wrenches is not None
    assert here.statics is not None
    rows, load = np.asarray(here.wrenches.rows), np.array(here.place.load)
    left = here.exerted @ rows + load
    assert rows @ left == pytest.approx(np.zeros(len(rows)), abs=1e-6)
    if len(rows) == 6:
        assert left == pytest.approx(np.zeros(6), abs=1e-6)
    if name in ("rps-3", "spr-3", "sps-spr"):  # limbs that are their own actuators
        assert here.exerted == pytest.approx(np.asarray(here.statics.forces), abs=1e-8)


def test_where_nothing_holds_the_load_that_is_told() -> None:
    here = _here("rpur-table1")
    assert here.statics is not None
    nowhere = Statics(here.statics.names, np.full(6, np.nan), np.array(np.nan))
    lost = replace(here, statics=nowhere)
    assert "No finite forces" in told.forces_html(lost)
    assert np.isnan(lost.exerted).all()
    assert told.forces_html(None) == told.forces_html(replace(here, statics=None)) == ""
    assert replace(here, wrenches=None).exerted.size == 0


def test_out_of_reach_and_singular_are_told_apart_from_held() -> None:
    here = _here("rps-3")
    assert "The platform is held" in told.here_html(_controlled(here))
    assert "Looking" in told.here_html(_controlled(None))
    away = replace(here, remedy=Remedy(None, math.nan, (), "none"))
    assert "out of reach" in told.here_html(_controlled(away))
    open_ = replace(here, wrenches=None)
    assert "do not close" in told.here_html(_controlled(open_))
    for measure, words in ((0.0, "In a parallel"), (1e-3, "Near a parallel")):
        near = replace(here, singular=(Singularity("parallel", (1,), "cause", "text", measure),))
        html = told.here_html(_controlled(near))
        assert words in html
        assert "is held" not in html
        assert palette.BEYOND in html


def test_measures_without_a_value_are_left_out_and_bars_stay_in_their_box() -> None:
    here = _here("rps-3")
    bounded = Measure("b", "Bounded", "", "high", (0.0, 1.0))
    rows = ((bounded, 7.0), (bounded, -3.0), (bounded, math.nan))
    html = told.measures_html(replace(here, measures=rows))
    assert html.count("Bounded") == 2
    assert "width:100.0%" in html
    assert "width:0.0%" in html


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_the_comparison_marks_the_better_machine(name: str) -> None:
    review, _ = change(new_review(load_design(name)), SetControl("compare", True))
    other = counterpart(review)
    assert other is not None
    one, two = compute.look(spot_of(review)), compute.look(other)
    html = told.comparison_html(one, two)
    rows = list(_parsed(html).iter("tr"))
    assert [h.text for h in rows[0]][1:] == (
        ["3-RPS", "3-SPR"] if name == "rps-3" else ["3-SPR", "3-RPS"]
    )
    known = {m.title: (m, a, b) for (m, a), (_, b) in zip(one.measures, two.measures, strict=True)}
    assert len(rows) > 2
    for row in rows[1:]:
        title, *cells = row
        bold = ["font-weight:600" in cell.get("style", "") for cell in cells]
        assert bold.count(True) == 1
        if title.text in known:
            measure, a, b = known[title.text]
            assert bold[0] == (a > b if measure.better == "high" else a < b)
    radii = [
        next(math.degrees(c.radius) for c in h.circles if c.limit == "parallel") for h in (one, two)
    ]
    assert f"Circle to a singularity {radii[0]:.3f}° {radii[1]:.3f}°".replace(" ", "") in _text(
        html
    ).replace(" ", "")
    assert told.comparison_html(one, None) == ""


def test_the_log_is_in_order_and_bounded() -> None:
    lines = tuple(Logged(float(n), f"event {n}.", "stop") for n in range(50))
    text = _text(told.log_html(lines))
    assert text.index("event 0.") < text.index(f"event {told.LINES - 1}.")
    assert f"event {told.LINES}." not in text
    assert "Nothing yet" in told.log_html(())


def test_ways_to_change_the_design_are_numbered_as_the_list_offers_them() -> None:
    changes = tuple(
        (DesignChange(("x",), "l", 1.0, 2.0, f"way {n}"),) for n in range(told.WAYS + 3)
    )
    text = _text(told.ways_html(Remedy(None, math.nan, changes, "")))
    assert f"{told.WAYS} way {told.WAYS - 1}".replace(" ", "") in text.replace(" ", "")
    assert f"way {told.WAYS}" not in text
    assert told.ways_html(Remedy(None, math.nan, (), "")) == ""


def test_nothing_known_is_nothing_said() -> None:
    assert told.clearances_html(None) == told.circles_html(None) == ""
    assert told.circles_html(_here("rpur-table1")) == ""


class Hashed(SimpleNamespace):
    """Known by what it is, as the solid that it stands for."""

    __hash__ = object.__hash__


def test_pieces_say_in_which_the_platform_is() -> None:
    review = new_review(load_design("rps-3"))
    shown = review.having(replace(review[Workspace], solids=(Shown("aspects", 0.5),)))
    pieces = tuple(
        SimpleNamespace(volume=v, sign=s, volume_error=None)
        for v, s in ((3e6, 1), (2e6, -1), *[(1e3, 0)] * 12)
    )
    solid = Hashed(
        pieces=pieces,
        piece_of=np.zeros(1),
        piece_at=lambda point: 11,
        volume=5e6,
        volume_error=1e3,
        locus_residual=1e-6,
        locus_unplaced=34,
        note="",
    )
    placed = SimpleNamespace(placement=np.eye(4), spec=SimpleNamespace(key="aspects"))
    built = SimpleNamespace(solid=solid, wish=placed, resolution="normal")
    html = told.pieces_html(shown, Solids((), {"aspects": built}, {}, None))  # type: ignore[dict-item]
    text = _text(html)
    assert "12" in text
    assert "the machine is here" in text
    assert "exact to 1e-06 mm but for 34 vertices at its rim" in text
    assert "At normal resolution; pieces thinner than a cell may be missed." in text
    assert text.count("dm³") + text.count("cm³") == told.LISTED + 2
    assert f"and {len(pieces) - told.LISTED - 1} smaller ones" in text
    solid.pieces = ()
    empty = told.pieces_html(shown, Solids((), {"aspects": built}, {}, None))  # type: ignore[dict-item]
    assert "empty" in empty
    assert told.pieces_html(review, Solids((), {}, {}, None)) == ""


def test_a_ball_is_a_sphere() -> None:
    place = _here("rpur-table1").place
    (ball,) = compute.ball(place, True)
    assert isinstance(ball, Sphere)
    at = place.machine.transform(place.pose, place.mode)[:3, 3]
    assert ball.center == pytest.approx(at)
    nearest = _here("rpur-table1").nearest("parallel", "constraint")
    assert nearest is not None
    assert ball.radius == pytest.approx(nearest.distance, abs=0.05)
