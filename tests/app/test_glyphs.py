"""Rows of the list of solutions: what they draw and say."""

from __future__ import annotations

import math
import re
from dataclasses import replace

from app.features.solutions.compute import NONE_YET, Row
from app.features.solutions.html import filter_html, row_html, strokes_html, table_html, ticks
from app.scene.palette import LIMBS
from kinematics.mechanism import Coordinate

AXES = (
    Coordinate("x", "x", "mm", -100.0, 100.0),
    Coordinate("y", "y", "mm", -100.0, 100.0),
    Coordinate("z", "z", "mm", 0.0, 200.0),
    Coordinate("phi", "φ", "rad", -math.pi, math.pi),
)
ROW = Row(
    identity=12,
    index=3,
    pose=(50.0, -100.0, 200.0, math.pi / 2),
    mode="+-",
    distance=45.25,
    height=200.0,
    condition=12.345,
    remark="",
    within_stroke=True,
    here=False,
    new=False,
)


def _text(markup: str) -> str:
    return " ".join(re.sub(r"<[^>]*>", " ", markup).split())


def _said(row: Row, axes: tuple[Coordinate, ...] = AXES) -> str:
    """What a row says to who does not see it."""
    found = re.search(r'aria-label="([^"]*)"', row_html(row, axes))
    assert found is not None
    return found[1]


def test_a_row_says_where_and_how_far() -> None:
    assert _text(row_html(ROW, AXES)) == "50.0 −100.0 200.0 90.0 45.2 12.3"
    said = _said(ROW)
    assert said.startswith("Go to solution #12, mode +−: ")
    assert "x 50.0 y −100.0 z 200.0 mm φ 90.0°" in said
    assert "45.2 mm away, condition 12.3" in said
    assert "beyond" not in said
    assert 'data-send="go 12"' in row_html(ROW, AXES)


def test_what_is_particular_is_said() -> None:
    present = replace(ROW, here=True, condition=math.inf)
    assert _said(present).startswith("The present solution #12")
    assert "condition singular" in _said(present)
    assert "away" not in _said(present)
    assert "aria-current" in row_html(present, AXES)
    assert _text(row_html(present, AXES)).split()[4] == "here"
    odd = replace(ROW, new=True, within_stroke=False, remark="a <b>")
    assert _text(row_html(odd, AXES)).endswith("new out ×2")
    assert "beyond stroke" in _said(odd)
    assert "a &lt;b&gt;" in row_html(odd, AXES)
    assert "a <b>" not in row_html(odd, AXES)


def test_ticks_show_the_sides_of_the_limbs() -> None:
    ends = re.findall(r'd="M([\d.]+) 9V(\d+)"[^>]*stroke="(#\w+)"', ticks("+-"))
    assert [(end, color) for _, end, color in ends] == [("1", LIMBS[0]), ("17", LIMBS[1])]
    assert float(ends[0][0]) < float(ends[1][0])


def test_mechanisms_without_signs_or_places() -> None:
    tilted = (Coordinate("tilt", "ψ", "rad", -1.0, 1.0),)
    row = replace(ROW, mode="2", pose=(0.3,))
    assert ">2</text>" in ticks("2")
    assert "stroke" not in ticks("2")
    assert "mm" not in _said(replace(row, mode="", here=True), tilted).split("#12")[1]


def test_the_table_tells_what_it_is_sorted_by_and_what_the_filter_leaves() -> None:
    listed = replace(NONE_YET, rows=(ROW,), counts={"": 3, "mode": 2, "new": 0, "merging": 1})
    table = table_html(listed, 40, AXES, "distance", signs=True)
    assert _text(table.partition("</thead>")[0]) == "mode x y z φ Δ ▴ cond."
    assert re.findall(r'data-send="sort (\w+)"', table) == [
        "mode",
        "height",
        "distance",
        "condition",
    ]
    assert table_html(replace(listed, rows=()), 40, AXES, "distance", signs=True) == ""
    switch = filter_html(listed, "merging", signs=True)
    assert _text(switch) == "All 3 This mode 2 New 0 Merging 1"
    assert re.findall(r'data-send="only (\w*)" aria-pressed="true"', switch) == ["merging"]
    assert "This mode" not in filter_html(listed, "", signs=False)


def test_strokes_show_where_an_actuator_may_go() -> None:
    rho = Coordinate("rho3", "ρ₃", "mm", 250.0, 400.0, limb=3)
    drawn = strokes_html([(rho, 325.0, 295.0, None)])
    assert _text(drawn) == "ρ₃ −30.0 free"
    assert "left:30.0%;width:70.0%" in drawn  # from the fold to the end of the stroke
    assert "left:50.0%" in drawn  # here
