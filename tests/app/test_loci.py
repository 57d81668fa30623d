"""Singular curves as plots: units there and back, what is drawn, what is told."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.features.singularities import plot
from app.scene import palette
from app.widgets.svg import LOST
from kinematics.answers.circles import OrientationCircle, Profile, ProfileCurve
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.designs.files import load_design
from kinematics.machine import machine_of

PLAIN = LocusSpec("p", "Plain <b>", ("φ", "y"), ("rad", "mm"))
POLAR = LocusSpec("o", "Polar", ("θ", "φ"), ("rad", "rad"), polar=True)


def _curves(*runs: np.ndarray, bounds: np.ndarray, kinds: tuple[str, ...] = ()) -> LocusCurves:
    start = np.cumsum([0, *map(len, runs)])
    points = np.concatenate([*runs, np.empty((0, 2))])
    return LocusCurves(
        points=points,
        start=start,
        kinds=kinds or ("parallel",) * len(runs),  # type: ignore[arg-type]
        limb=np.array(
            [n if k == "serial" else 0 for n, k in enumerate(kinds or runs)], dtype=np.int64
        )
        if kinds
        else np.zeros(len(runs), dtype=np.int64),
        residual=np.zeros(len(points)),
        bounds=bounds,
    )


CIRCLE_OF = np.stack([np.full(50, 0.7), np.linspace(-math.pi, math.pi, 50)], axis=1)
TILTS = np.array([[0.0, 1.2], [-math.pi, math.pi]])


def _svg(content: str) -> ElementTree.Element:
    return ElementTree.fromstring(f"<svg>{content}</svg>")


@given(
    st.floats(-math.pi, math.pi),
    st.floats(-900.0, 900.0),
    st.floats(1e-6, math.pi),
    st.floats(-3.1415, 3.1415),
)
def test_the_pages_units_and_back(phi: float, y: float, tilt: float, azimuth: float) -> None:
    x, up = plot.in_units(PLAIN, np.array([phi, y])).tolist()
    assert (x, up) == pytest.approx((math.degrees(phi), y))
    assert plot.from_units(PLAIN, x, up) == pytest.approx((phi, y), abs=1e-12)
    x, up = plot.in_units(POLAR, np.array([tilt, azimuth])).tolist()
    assert math.hypot(x, up) == pytest.approx(math.degrees(tilt))
    assert plot.from_units(POLAR, x, up) == pytest.approx((tilt, azimuth), abs=1e-9)


@given(st.floats(-180, 180), st.floats(-180, 180))
def test_a_place_in_a_polar_plot_and_back(x: float, y: float) -> None:
    again = plot.in_units(POLAR, np.array(plot.from_units(POLAR, x, y)))
    assert again == pytest.approx((x, y), abs=1e-9)


def test_units_of_many_points_are_those_of_each() -> None:
    points = np.random.default_rng(1).uniform(0.1, 1.0, (3, 4, 2))
    for spec in (PLAIN, POLAR):
        together = plot.in_units(spec, points)
        assert together.shape == points.shape
        for n in np.ndindex(3, 4):
            assert together[n] == pytest.approx(plot.in_units(spec, points[n]))


def test_a_polar_chart_is_round_and_its_circles_are_to_scale() -> None:
    curves = _curves(CIRCLE_OF, bounds=TILTS)
    circle = OrientationCircle("parallel", 0.7, ((0.7, 0.0), (0.7, math.pi / 2)), "text")
    drawn = plot.figure(POLAR, curves, circle)
    assert drawn.axes.x == drawn.axes.y
    assert drawn.axes.inner[0] == drawn.axes.inner[1]  # the same scale across and up
    root = _svg(drawn.content)
    (curve,) = [p for p in root.iter("path") if p.get("class") == "locus parallel"]
    assert curve.get("stroke") == LOST
    places = np.array(re.findall(r"([\d.]+) ([\d.]+)", curve.get("d", "")), dtype=float)
    middle = np.array(drawn.axes.px(0.0, 0.0))
    radii = np.linalg.norm(places - middle, axis=1)
    (micr,) = [c for c in root.iter("circle") if c.get("class") == "micr"]
    assert radii == pytest.approx(np.full(len(radii), float(micr.get("r", ""))), abs=0.15)
    assert (float(micr.get("cx", "")), float(micr.get("cy", ""))) == pytest.approx(middle)
    dots = [c for c in root.iter("circle") if c.get("fill") == LOST]
    assert len(dots) == 2
    for dot in dots:
        at = np.array([float(dot.get("cx", "")), float(dot.get("cy", ""))])
        assert np.linalg.norm(at - middle) == pytest.approx(float(micr.get("r", "")), abs=0.15)


def test_what_is_told_under_the_pointer_is_where_it_points() -> None:
    drawn = plot.figure(PLAIN, _curves(bounds=np.array([[-1.0, 1.0], [100.0, 300.0]])))
    assert len(drawn.tips) == len(drawn.columns) * len(drawn.rows)
    first, last = drawn.columns[0], drawn.columns[-1]
    assert first.startswith("φ = −56.7°")
    assert last.startswith("φ = 56.7°")
    assert drawn.rows[0].endswith("mm")
    assert "y = 101.1 mm" in drawn.rows[0]
    assert drawn.axes.y == (100.0, 300.0)
    assert not list(_svg(drawn.content).iter("g"))  # no rings


def test_a_chart_that_leads_nowhere_does_not_invite() -> None:
    curves = _curves(bounds=np.array([[-1.0, 1.0], [100.0, 300.0]]))
    assert "point to go there" in plot.figure(PLAIN, curves).idle
    assert "point" not in plot.figure(PLAIN, curves, leads=False).idle


def test_serial_curves_are_dashed_in_their_limbs_colour() -> None:
    run = np.array([[0.0, 150.0], [0.5, 250.0]])
    bounds = np.array([[-1.0, 1.0], [100.0, 300.0]])
    root = _svg(
        plot.figure(PLAIN, _curves(run, run, bounds=bounds, kinds=("parallel", "serial"))).content
    )
    lost, serial = (p for p in root.iter("path") if "locus" in p.get("class", ""))
    assert (lost.get("stroke"), lost.get("stroke-dasharray")) == (LOST, None)
    assert serial.get("stroke") == palette.limb_color(1)
    assert serial.get("stroke-dasharray")


def test_long_curves_are_thinned_but_keep_their_ends() -> None:
    run = np.stack([np.linspace(-1, 1, 50_000), np.linspace(100, 300, 50_000)], axis=1)
    curves = _curves(run, bounds=np.array([[-1.0, 1.0], [100.0, 300.0]]))
    drawn = plot.figure(PLAIN, curves)
    (path,) = [p for p in _svg(drawn.content).iter("path") if "locus" in p.get("class", "")]
    places = np.array(re.findall(r"([\d.]+) ([\d.]+)", path.get("d", "")), dtype=float)
    assert len(places) < 2 * plot.MOST
    for place, point in ((places[0], run[0]), (places[-1], run[-1])):
        assert place == pytest.approx(
            drawn.axes.px(*plot.in_units(PLAIN, point).tolist()), abs=0.06
        )


def test_the_cross_is_where_the_machine_is_and_only_inside() -> None:
    axes = plot.figure(POLAR, _curves(bounds=TILTS)).axes
    cross = _svg(plot.mark(POLAR, axes, (0.3, 1.0)))
    u, v = axes.px(*plot.in_units(POLAR, np.array([0.3, 1.0])).tolist())
    assert cross[0].get("d") == f"M{u - 7:.1f} {v:.1f}h14M{u:.1f} {v - 7:.1f}v14"
    assert plot.mark(POLAR, axes, (2.0, 0.0)) == ""


def _profile(name: str, x: np.ndarray, *radii: float) -> Profile:
    curves = [
        ProfileCurve(name, mode, own, np.full(len(x), r))
        for r, mode, own in zip(radii, ("1", "2", "2"), (True, True, False), strict=False)
    ]
    return Profile("MICR", "Z/h₁", "radius", x, tuple(curves), 1.5, "Fig. 4")


def test_profiles_of_two_machines_are_told_apart_and_escaped() -> None:
    x = np.linspace(0.0, 3.0, 40)
    one, two = _profile("<one>", x, 0.3, 0.4, 0.5), _profile("two", x, 0.2, 0.1)
    drawn = plot.profile_figure([("A&B", one), ("C", two)])
    (curves,) = _svg(drawn.content).findall("svg")
    paths = [p for p in curves.iter("path") if p.get("fill") == "none"]
    assert [p.get("stroke") for p in paths] == 3 * [plot.MACHINES[0]] + 2 * [plot.MACHINES[1]]
    titles = [t.text for t in _svg(drawn.content).iter("title")]
    assert titles[0] == "A&B, mode 1, <one>"
    assert len(drawn.columns) == len(drawn.tips)
    assert "A&B 17.2° (mode 1)" in drawn.columns[-1]
    assert drawn.axes.y[1] == pytest.approx(1.05 * math.degrees(0.5))
    line = _svg(plot.profile_mark(drawn.axes, 1.5))[0].get("d", "")
    assert line.startswith(f"M{drawn.axes.px(1.5, 0.0)[0]:.1f} ")
    assert plot.profile_mark(drawn.axes, 3.5) == ""


@pytest.mark.parametrize("name", ["rpur-table1", "five-bar", "rps-3", "spr-3", "sps-spr"])
def test_the_curves_of_every_machine_make_a_sound_picture(name: str) -> None:
    design = load_design(name)
    home = machine_of(design).home
    for spec in machine_of(design).singularities.loci:
        at = 0.0 if spec.key == "section" else None
        curves = machine_of(design).singularities.locus(spec.key, home.pose, home.mode, at)
        circles = machine_of(design).circles
        circle = None if circles is None else next(iter(circles.about(home.pose, home.mode)), None)
        drawn = plot.figure(spec, curves, circle)
        root = _svg(drawn.content)
        paths = [p for p in root.iter("path") if "locus" in p.get("class", "")]
        assert len(paths) == len(curves.kinds)
        assert "nan" not in drawn.content
        # The curves stand in a picture of their own, which clips them.
        (clip,) = root.findall("svg")
        assert clip.get("viewBox")
        assert set(paths) <= set(clip.iter("path"))


@pytest.mark.parametrize("by", [1e-3, 1.0, 1e3])
def test_a_chart_of_places_is_a_file_of_true_size(by: float) -> None:
    spec = LocusSpec("place", "Plane", ("x", "y"), ("mm", "mm"))
    turn = np.linspace(0.0, 2 * math.pi, 60)
    run = by * (np.stack([np.cos(turn), np.sin(turn)], axis=1) * 50.0 + [30.0, -20.0])
    bounds = by * np.array([[-20.0, 80.0], [-70.0, 30.0]])
    root = ElementTree.fromstring(plot.chart_svg(spec, _curves(run, bounds=bounds), title="a"))
    wide = float(root.get("width", "").removesuffix("mm"))
    assert list(map(float, root.get("viewBox", "").split()))[2] == wide
    assert 100.0 * by < wide < 300.0 * by
    svg = "{http://www.w3.org/2000/svg}"
    drawn = [p.get("d", "") for p in root.iter(f"{svg}path") if p.get("d", "").count("L") == 59]
    assert len(drawn) == 1
    found = np.array(re.findall(r"-?[\d.]+", drawn[0]), dtype=float).reshape(-1, 2)
    assert found * [1.0, -1.0] == pytest.approx(run, abs=1e-5 * wide)


def test_a_chart_of_angles_stays_a_figure() -> None:
    root = ElementTree.fromstring(plot.chart_svg(POLAR, _curves(CIRCLE_OF, bounds=TILTS)))
    assert not root.get("width", "").endswith("mm")
