"""Rows of the list of solutions: what they draw and say."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest

from app.features.solutions.compute import Row
from app.features.solutions.html import glyph, key_text, row_html, strokes_html
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


def test_a_row_says_where_and_how_far() -> None:
    text = _text(row_html(ROW, AXES))
    assert text.startswith("Go to solution #12, mode +−: ")
    assert "x 50.0 y −100.0 z 200.0 mm φ 90.0°" in text
    assert "45.2 mm away condition 12.3" in text
    assert "beyond" not in text


def test_what_is_particular_is_said() -> None:
    text = _text(row_html(replace(ROW, here=True, condition=math.inf), AXES))
    assert "The present solution #12" in text
    assert "condition singular" in text
    assert "away" not in text
    text = _text(row_html(replace(ROW, new=True, within_stroke=False, remark="a <b>"), AXES))
    assert " new " in text
    assert "beyond stroke" in text
    assert "a &lt;b&gt;" in row_html(replace(ROW, remark="a <b>"), AXES)


def test_ticks_dials_and_dot() -> None:
    drawn = glyph(ROW, AXES)
    ends = re.findall(r'class="t l(\d)" d="M[\d.]+ 13V(\d+)"', drawn)
    assert ends == [("1", "3"), ("2", "23")]  # limb 1 up, limb 2 down
    (circle,) = re.findall(r'<circle class="a" cx="([\d.]+)" cy="13"', drawn)
    (x, y) = re.findall(r'class="h" d="M[\d.]+ 13L([\d.]+) ([\d.]+)"', drawn)[0]
    assert (float(x) - float(circle), float(y) - 13) == pytest.approx((10.0, 0.0))  # a quarter turn
    (left,) = re.findall(r'<rect class="a" x="([\d.]+)" y="2" width="22"', drawn)
    (dot,) = re.findall(r'<circle class="d" cx="([\d.]+)" cy="([\d.]+)"', drawn)
    assert float(dot[0]) - float(left) == pytest.approx(0.75 * 22, abs=0.06)
    assert float(dot[1]) == pytest.approx(24.0)
    assert re.search(r'class="h" d="M[\d.]+ 2.0h6"', drawn)  # at the top of the level


def test_mechanisms_without_signs_or_places() -> None:
    tilted = (Coordinate("tilt", "ψ", "rad", -1.0, 1.0),)
    row = replace(ROW, mode="2", pose=(0.3,))
    drawn = glyph(row, tilted)
    assert '<text class="d"' in drawn
    assert "<rect" not in drawn
    assert "mm" not in _text(row_html(replace(row, mode="", here=True), tilted)).split("#12")[1]
    assert key_text(tilted, 0) == "dials: ψ"
    assert key_text(AXES, 2) == "ticks: side of limbs 1–2 · dials: φ · map: x, y · level: z"


def test_strokes_show_where_an_actuator_may_go() -> None:
    rho = Coordinate("rho3", "ρ₃", "mm", 250.0, 400.0, limb=3)
    drawn = strokes_html([(rho, 325.0, 295.0, None)])
    assert _text(drawn) == "ρ₃ −30.0 free"
    assert "left:30.0%;width:70.0%" in drawn  # from the fold to the end of the stroke
    assert "left:50.0%" in drawn  # here
