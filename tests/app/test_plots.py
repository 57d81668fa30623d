"""Plots as text: where things stand, what a pointer is told, and that no text breaks out."""

from __future__ import annotations

import html
import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.features.map import plot as maps
from app.features.map.compute import chart_request, of
from app.features.map.state import Chart, Colours, Span, refined
from app.features.section.html import profile
from app.review.state import new_review
from app.scene import palette
from app.widgets.axes import STEPS, TURN, Axes, Bounds, Figure, Look, scales, ticks
from app.widgets.plots import behind, drawing
from app.widgets.svg import LOST, RULE, document
from kinematics.answers.sections import Quantity, SectionSpec, Volume
from kinematics.designs.files import load_design
from kinematics.facets.map_sweeps import Map, map_request

SPEC = SectionSpec("Section at x′", "x′", ("y′", "z′"), "Fig. 17")
VOLUME = Quantity("volume", "Volume", "mm³")


@given(
    st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(2, 9), st.sampled_from((STEPS, TURN))
)
def test_ticks_are_round_within_the_ends_and_not_too_many(
    low: float, span: float, most: int, steps: tuple[float, ...]
) -> None:
    found = ticks(low, low + span, most, steps)
    assert len(found) <= most + 1
    slack = 1e-6 * span + 1e-9
    assert all(low - slack <= t <= low + span + slack for t in found)
    if len(found) > 1:
        step = found[1] - found[0]
        mantissas = [step / s for s in steps]
        powers = [abs(math.log10(m) - round(math.log10(m))) for m in mantissas]
        assert min(powers) < 1e-6


def test_ticks_of_an_angle_are_those_of_a_protractor() -> None:
    assert ticks(-92.5, 92.5, 7, TURN) == pytest.approx([-90, -60, -30, 0, 30, 60, 90])


def test_a_place_in_the_plot_and_back() -> None:
    axes = Axes(400, 300, 50, 20, 30, 40, (-10.0, 30.0), (5.0, 9.0))
    assert axes.px(-10.0, 5.0) == (50.0, 260.0)
    assert axes.px(30.0, 9.0) == (370.0, 20.0)
    assert axes.px(10.0, 7.0) == (210.0, 140.0)


def test_no_text_breaks_out_of_the_drawing() -> None:
    nasty = "\"><script>alert(1)</script>|'&"
    axes = Axes(100, 80, 20, 20, 5, 20, (0.0, 1.0), (0.0, 1.0))
    figure = Figure(
        axes,
        scales(axes, nasty, nasty, [0.5], [0.5]),
        [nasty],
        [""],
        [""],
        nasty,
        nasty,
        lambda: ((nasty,), ((nasty,),)),
        title=nasty,
        unit=nasty,
    )
    text = drawing(figure)
    assert "<script" not in text
    svg = ElementTree.fromstring(text)
    assert svg.get("data-columns") == nasty.replace("|", "/")
    assert svg.get("data-idle") == nasty
    assert svg.get("aria-label") == nasty
    table = ElementTree.fromstring(behind(figure))
    assert [cell.text for cell in table.iter("td")] == [nasty]


def _map(values: np.ndarray, quantity: str = "volume") -> Map:
    design = load_design("rpur-table1")
    n, m = values.shape
    request = map_request(
        design,
        np.radians(np.linspace(-10, 10, n)),
        np.radians(np.linspace(0, 30, m)),
        quantities=(quantity,),
    )
    return Map(request, values[None], 0.001 * values[None], np.isfinite(values))


def test_what_the_map_tells_of_a_cell_is_its_value() -> None:
    values = np.array([[1e6, 2e6, np.nan], [3e6, 4e6, 0.0]])
    figure = maps.figure(_map(values), stale=False)
    told = [
        figure.columns[i] + figure.rows[j] + figure.tips[3 * i + j]
        for i in range(2)
        for j in range(3)
    ]
    assert told[0] == "φ −10.0°, θ 0.0°: 1.000 ± 0.001 dm³"
    assert told[2] == "φ −10.0°, θ 30.0°: not computed yet"
    assert told[4].startswith("φ 10.0°, θ 15.0°: 4.000 ± 0.004")
    # Cells of equal size fill the box about their points.
    assert figure.axes.x == pytest.approx((-20.0, 20.0))
    assert figure.axes.y == pytest.approx((-7.5, 37.5))


def test_cells_cover_the_box_and_an_empty_workspace_has_no_colour() -> None:
    rng = np.random.default_rng(3)
    values = rng.uniform(1e6, 2e7, (7, 5))
    values[2, 3] = 0.0
    axes = maps.figure(_map(values), stale=False).axes
    paths = maps._cells(axes, values / values.max())
    covered = 0.0
    for part in html.unescape(paths).split("M")[1:]:
        wide, high = part.split("h")[1].split("v")
        covered += float(wide) * float(high)
    wide, high = axes.inner
    assert covered == pytest.approx(wide * high * 34 / 35, rel=2e-3)


def test_a_map_where_little_is_known_shows_the_nearest() -> None:
    values = np.full((5, 5), np.nan)
    values[0, 0] = values[4, 4] = 1e7
    content = maps.figure(_map(values), stale=False).content
    assert content.count("shape-rendering") == 1  # one shade everywhere
    blank = maps.figure(_map(np.full((5, 5), np.nan)), stale=False)
    assert "shape-rendering" not in blank.content
    assert set(blank.tips) == {"not computed yet"}


@pytest.mark.parametrize(
    ("quantity", "value", "error", "text"),
    [
        (VOLUME, 24_501_399.0, 20.0, "24.50140 ± 0.00002 dm³"),
        (Quantity("pieces", "Number of pieces", ""), 4.0, 0.0, "4"),
        (Quantity("sphere", "Largest sphere", "mm"), 69.9234, 0.012, "69.92 ± 0.02 mm"),
        (Quantity("stroke", "Stroke", "%"), 87.5, 0.0, "87.5 %"),
    ],
)
def test_values_carry_unit_and_error(
    quantity: Quantity, value: float, error: float, text: str
) -> None:
    assert maps.told(quantity, value, error) == text


def test_the_profile_of_a_prism_is_a_box() -> None:
    at = np.linspace(-50.0, 50.0, 41)
    volume = Volume(
        value=2e6,
        error=1.0,
        centroid=np.zeros(3),
        pieces=(2e6,),
        at=at,
        area=np.full(41, 2e4),
        events=np.array([-50.0, 0.0, 50.0]),
        sections=41,
    )
    figure = profile(volume, SPEC)
    assert figure is not None
    assert figure.axes.x == (-50.0, 50.0)
    assert set(figure.tips) == {"200 cm²"}
    assert figure.columns[0].startswith("x′ = −49.")
    assert len(figure.columns) == len(figure.tips)
    nothing = Volume(0.0, 0.0, np.full(3, np.nan), (), np.empty(0), np.empty(0), np.empty(0), 3)
    assert profile(nothing, SPEC) is None


def test_the_map_of_a_review_runs_over_its_spans() -> None:
    review = new_review(load_design("rpur-table1"))
    chart = Chart("pieces", Span(-0.5, 0.5, 3), Span(0.0, 1.0, 5))
    asked = chart_request(review.having(chart))
    assert asked.first == pytest.approx((-0.5, 0.0, 0.5))
    assert asked.second == pytest.approx((0.0, 0.25, 0.5, 0.75, 1.0))
    assert [q.key for q in asked.quantities] == ["pieces"]
    assert of(asked, review)
    assert not of(asked, new_review(load_design("rpur-table2")))


def test_a_map_names_its_extremes_and_its_colours_run_between_them() -> None:
    values = np.array([[2.2e7, 2.3e7, 0.0], [2.25e7, 2.45e7, 2.4e7]])
    found = _map(values)
    pose = new_review(load_design("rpur-table1")).pose  # φ and θ are none
    table = ElementTree.fromstring(maps.extremes_html(found, pose))
    heads, *rows = [["".join(cell.itertext()) for cell in row] for row in table.iter("tr")]
    assert heads == ["", "dm³", "±", "φ (°)", "θ (°)"]
    assert rows == [
        ["○ largest", "24.5", "0.02", "10.0", "15.0"],
        ["× smallest", "22", "0.02", "−10.0", "0.0"],
        ["+ here", "22", "0.02", "−10.0", "0.0"],
        ["mean of the map", "23.2", "", "", ""],
    ]
    drawn = ElementTree.fromstring(f"<svg>{maps.figure(found, stale=False).content}</svg>")
    texts = {t.text: t for t in drawn.iter("text")}
    named = ("max 24.5 at 10°, 15°", "min 22 at −10°, 0°")
    assert set(named) <= set(texts)
    fills = [p.get("fill") for p in drawn.iter("path") if p.get("shape-rendering")]
    assert {palette.ramp_color(0.0), palette.ramp_color(1.0)} <= set(fills)
    axes = maps.figure(found, stale=False).axes
    scale = [t for t in texts.values() if float(t.get("x", 0)) > axes.width - axes.right + 14]
    assert [float(t.text or 0) for t in scale] == [22.0, 22.5, 23.0, 23.5, 24.0, 24.5]
    assert all(0 < float(texts[name].get("y", 0)) < axes.height for name in named)
    assert maps.extremes_html(_map(np.zeros((2, 2))), (0.0,) * 3 + (9.0, 9.0)) == ""


def test_the_range_of_the_colours_can_be_chosen() -> None:
    found = _map(np.array([[1e7, 2e7], [3e7, 4e7]]))

    def fills(**chosen: float) -> list[str | None]:
        content = maps.figure(found, stale=False, colours=Colours(**chosen)).content
        drawn = ElementTree.fromstring(f"<svg>{content}</svg>")
        return [p.get("fill") for p in drawn.iter("path") if p.get("shape-rendering")]

    assert palette.ramp_color(0.0) in fills()
    assert palette.ramp_color(0.0) not in fills(low=0.0)
    assert palette.ramp_color(1.0) not in fills(high=6e7)
    # What is beyond the range has the colour of its end.
    assert fills(low=2e7, high=3e7) == [palette.ramp_color(0.0), palette.ramp_color(1.0)]


def test_contours_run_where_the_values_are_round() -> None:
    values = np.add.outer(np.linspace(1e7, 3e7, 9), np.zeros(7))  # 0.4 dm³ a degree along φ
    figure = maps.figure(_map(values), stale=False, colours=Colours(step=5e6))
    drawn = ElementTree.fromstring(f"<svg>{figure.content}</svg>")
    (lines,) = [p for p in drawn.iter("path") if p.get("class") == "contour"]
    places = {round(float(x)) for x in re.findall(r"([\d.]+) [\d.]+", lines.get("d", ""))}
    wanted = {round(figure.axes.px(phi, 0.0)[0]) for phi in (-10.0, -5.0, 0.0, 5.0, 10.0)}
    assert places <= wanted
    assert {round(figure.axes.px(phi, 0.0)[0]) for phi in (-5.0, 0.0, 5.0)} <= places
    assert lines.get("stroke") == "#FFFFFF"
    plain = maps.figure(_map(values), stale=False, colours=Colours(contours=False)).content
    assert "contour" not in plain


def test_cells_without_a_workspace_are_hatched_and_only_these() -> None:
    values = np.full((4, 3), 1e7)
    values[1, 2] = 0.0
    figure = maps.figure(_map(values), stale=False)
    drawn = ElementTree.fromstring(f"<svg>{figure.content}</svg>")
    (lines,) = [p for p in drawn.iter("path") if p.get("class") == "empty"]
    places = np.array(re.findall(r"([\d.]+) ([\d.]+)", lines.get("d", "")), dtype=float)
    x0, x1 = (figure.axes.px(phi, 0.0)[0] for phi in (-20.0 / 3.0, 0.0))
    y0, y1 = (figure.axes.px(0.0, theta)[1] for theta in (37.5, 22.5))
    assert len(places) > 6
    assert (places[:, 0] >= x0 - 0.1).all()
    assert (places[:, 0] <= x1 + 0.1).all()
    assert (places[:, 1] >= y0 - 0.1).all()
    assert (places[:, 1] <= y1 + 0.1).all()


def test_a_map_about_the_maximum_is_finer() -> None:
    chart = Chart("volume", Span(-1.0, 1.0, 11), Span(0.0, 1.0, 5))
    fine = refined(chart, (0.2, 0.5))
    assert (fine.first.low, fine.first.high) == pytest.approx((-0.2, 0.6))
    assert (fine.second.low, fine.second.high) == pytest.approx((0.0, 1.0))
    assert (fine.first.count, fine.second.count) == (11, 9)


def test_a_map_of_one_value_has_one_colour() -> None:
    drawn = maps.figure(_map(np.full((3, 2), 5.0), "pieces"), stale=False).content
    assert drawn.count("shape-rendering") == 1
    assert "max 5" in drawn


# --- one family of plots


def _area(part: Bounds | None = None) -> Figure:
    at = np.linspace(-50.0, 50.0, 41)
    area = 2e4 + 1e4 * np.cos(at / 20.0)
    volume = Volume(
        2e6, 1.0, np.zeros(3), (2e6,), at, area, events=np.array([-50.0, 0.0, 50.0]), sections=41
    )
    found = profile(volume, SPEC, Look(part=part))
    assert found is not None
    return found


def test_a_zoom_shows_a_part_to_the_same_ticks_and_never_more_than_the_whole() -> None:
    whole = _area()
    assert whole.axes.whole is None
    part = _area(((-20.0, 10.0), (-math.inf, math.inf)))
    assert part.axes.x == pytest.approx((-20.0, 10.0))
    assert part.axes.y == whole.axes.y
    assert part.axes.whole == (whole.axes.x, whole.axes.y)
    # What is told of a place is the same, to the width of a pixel.
    told = part.columns[len(part.columns) // 2]
    assert told.startswith("x′ = −5")
    beyond = _area(((30.0, 90.0), (-math.inf, math.inf)))
    assert beyond.axes.x == pytest.approx((-10.0, 50.0))  # as much, moved to where something is
    assert _area(((-900.0, 900.0), (-math.inf, math.inf))).axes.x == whole.axes.x
    tiny = _area(((3.0, 3.0), (-math.inf, math.inf))).axes.x
    assert tiny[0] < tiny[1]


def test_a_zoomed_map_tells_of_the_cells_that_it_shows() -> None:
    values = np.linspace(1e7, 2e7, 20).reshape(5, 4)
    whole = maps.figure(_map(values), stale=False)
    look = Look(part=((0.0, 12.0), (0.0, 20.0)))
    part = maps.figure(_map(values), look, stale=False)
    assert part.span == (whole.axes.x, whole.axes.y)
    assert part.axes.x == (0.0, 12.0)
    assert part.tips == whole.tips
    # The cells stand where the axes say: the right edge of the middle column is at 2.5°.
    edges = re.findall(r"M([-\d.]+) [-\d.]+h([-\d.]+)v", part.content)
    ends = {round(float(x) + float(wide), 1) for x, wide in edges}
    assert round(part.axes.px(2.5, 0.0)[0], 1) in ends


def test_the_numbers_behind_a_plot_are_those_of_the_plot() -> None:
    heads, rows = _area().table()
    assert heads == ("x′ (mm)", "area (cm²)")
    assert len(rows) == 25
    assert [row[0] for row in (rows[0], rows[-1])] == ["−50.0", "50.0"]
    assert float(rows[12][1]) == pytest.approx(300.0, abs=0.5)
    values = np.linspace(1e7, 2e7, 20).reshape(5, 4)
    heads, rows = maps.figure(_map(values), stale=False).table()
    assert heads == ("θ (°) \\ φ (°), dm³", "−10.0", "−5.0", "0.0", "5.0", "10.0")
    assert [row[0] for row in rows] == ["30.0", "20.0", "10.0", "0.0"]
    assert rows[-1][1:] == tuple(f"{v * 1e-6:.4g}" for v in values[:, 0])


def test_axes_are_left_and_below_only_with_hair_lines_and_true_minus() -> None:
    figure = _area()
    root = ElementTree.fromstring(f"<svg>{figure.content}</svg>")
    (corner,) = [p for p in root.iter("path") if p.get("class") == "axes"]
    low = figure.axes.top + figure.axes.inner[1]
    assert corner.get("d", "").startswith(
        f"M{figure.axes.left:g} {figure.axes.top:g}V{low:g}H{figure.axes.width - 12:g}"
    )
    (lines,) = [p for p in root.iter("path") if p.get("class") == "grid"]
    assert lines.get("stroke") == RULE
    shown = [t.text or "" for t in root.iter("text")]
    assert "−40" in shown
    assert not any(text.startswith("-") for text in shown)
    assert len([t for t in root.iter("text") if t.get("text-anchor") == "middle"]) <= 6 + 2
    assert "max 300 at 0 mm" in shown


def test_a_file_has_the_light_colours_and_no_variables() -> None:
    drawn = document((10.0, 10.0), f'<g fill="{LOST}" stroke="{RULE}"/>', paper="#FFFFFF")
    assert "var(" not in drawn
    assert 'fill="#D55E00" stroke="#DDE2E8"' in drawn
