"""Sections as pictures, read back from the SVG."""

from __future__ import annotations

import re
from dataclasses import replace
from math import cos, hypot, pi, sin, tau
from xml.etree import ElementTree

import numpy as np
import pytest

from app.features.section.plot import (
    PAPER,
    Bounds,
    Picture,
    Shade,
    section_figure,
    section_svg,
)
from app.scene.painting import scale
from app.scene.palette import BEYOND, limb_color
from kinematics.answers.sections import Section
from tests.app.made_sections import (
    EMPTY,
    LENS,
    RING,
    SPEC,
    TWO,
    area_by_edge,
    circles,
    made,
    whole_circle,
)

SECTIONS = {"ring": RING, "lens": LENS, "two": TWO, "empty": EMPTY}
SVG = "{http://www.w3.org/2000/svg}"
NUMBER = r"-?[\d.]+"


def drawn(section: Section, **options: object) -> ElementTree.Element:
    options = {"width": 640, "height": 480, **options}
    return ElementTree.fromstring(section_svg(section, SPEC, **options))  # type: ignore[arg-type]


def paths(picture: ElementTree.Element, kind: str) -> list[ElementTree.Element]:
    return [p for p in picture.iter(f"{SVG}path") if kind in p.get("class", "").split()]


def ticks(picture: ElementTree.Element) -> tuple[list[tuple[float, float]], ...]:
    """(mm, px) of the ticks of both axes, as a reader of the picture sees them."""
    found: tuple[list[tuple[float, float]], ...] = ([], [])
    for text in picture.iter(f"{SVG}text"):
        if re.fullmatch(r"−?[\d.]+", text.text or ""):
            value = float((text.text or "").replace("−", "-"))
            if text.get("text-anchor") == "middle":
                found[0].append((value, float(text.get("x", ""))))
            else:
                found[1].append((value, float(text.get("y", "")) - 0.35 * 11))
    return found


def at_ticks(axis: list[tuple[float, float]], value: float) -> float:
    """Where a reader of the picture finds a value between its ticks, px."""
    (first, start), *_, (last, end) = axis
    return start + (value - first) / (last - first) * (end - start)


def path_area(path: str, scale: float) -> float:
    """mm² inside a path of M, L, A and Z, holes taken off; screens turn the other way."""
    area = 0.0
    here = first = 0j
    for word, rest in re.findall(r"([MLAZ])([^MLAZ]*)", path):
        numbers = [float(n) for n in re.findall(NUMBER, rest)]
        if word == "Z":
            area += area_by_edge(here, first, 0.0)
            continue
        there = complex(numbers[-2], -numbers[-1])
        if word == "M":
            first = there
        elif word == "L":
            area += area_by_edge(here, there, 0.0)
        else:
            radius, large, clockwise = numbers[0], numbers[3], numbers[4]
            assert large == 0
            turn = 2 * np.arcsin(min(1.0, abs(there - here) / 2 / radius))
            area += area_by_edge(here, there, -turn if clockwise else turn)
        here = there
    return area / scale**2


@pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)
def test_a_picture_is_true_to_scale_and_encloses_the_area(section: Section) -> None:
    picture = drawn(section)
    (u0, *_, u1), (v0, *_, v1) = ticks(picture)
    across = (u1[1] - u0[1]) / (u1[0] - u0[0])
    up = (v0[1] - v1[1]) / (v1[0] - v0[0])
    assert across == pytest.approx(up, rel=2e-3)
    region = paths(picture, "region")
    if not section.loops:
        assert not region
        return
    assert region[0].get("fill-rule") == "evenodd"
    assert path_area(region[0].get("d", ""), across) == pytest.approx(section.area, rel=3e-3)


def test_a_picture_shows_every_kept_edge_in_its_limbs_colour() -> None:
    for section in (RING, LENS, TWO):
        kept = paths(drawn(section), "edge")
        assert {p.get("stroke") for p in kept} == {limb_color(n) for n in section.limb.tolist()}
    dashes = {
        p.get("class", "").split()[-1]: p.get("stroke-dasharray") for p in paths(drawn(TWO), "edge")
    }
    assert dashes["rho_max"] is None
    assert dashes["link"] is not None


def test_what_made_the_section_is_faint_and_can_be_left_out() -> None:
    assert len(paths(drawn(RING), "made")) == 2 + 2
    assert not paths(drawn(RING, faint=False), "made")
    assert len(paths(drawn(EMPTY), "made")) == 2 + 2


def test_a_huge_circle_is_drawn_only_where_it_is_seen() -> None:
    radius = 1e6
    there = circles([(radius, 0), (3 * radius, 0)], [radius, radius])
    tiny = made([whole_circle(1, (0, 0), 1.0)], [pi], [0], there)
    (seen, _, _) = paths(drawn(tiny), "made")  # beside both lines
    for x, y in re.findall(rf"({NUMBER}) ({NUMBER})(?=A|$)", seen.get("d", "")):
        assert hypot(float(x), float(y)) < 1e5


def test_the_mark_stands_where_the_point_is() -> None:
    (cross,) = paths(drawn(RING, mark=(50.0, -50.0)), "mark")
    x, y = map(float, re.findall(rf"M({NUMBER}) ({NUMBER})h", cross.get("d", ""))[0])
    across, up = ticks(drawn(RING))
    assert x + 6 == pytest.approx(at_ticks(across, 50.0), abs=0.02)
    assert y == pytest.approx(at_ticks(up, -50.0), abs=0.02)


def test_bounds_keep_a_picture_still() -> None:
    still = ((-200.0, 200.0), (-150.0, 150.0))
    assert ticks(drawn(RING, bounds=still)) == ticks(drawn(TWO, bounds=still))


def test_an_empty_section_says_so() -> None:
    texts = [text.text for text in drawn(EMPTY).iter(f"{SVG}text")]
    assert "The section is empty here." in texts
    nothing = made([], [], [])
    assert drawn(nothing).tag == f"{SVG}svg"


def test_titles_are_text_and_inline_pictures_carry_no_header() -> None:
    picture = drawn(RING, title="<b> & 'x'")
    assert "<b> & 'x'" in [text.text for text in picture.iter(f"{SVG}text")]
    inline = section_figure(Picture(RING, SPEC)).content
    assert ElementTree.fromstring(f"<g>{inline}</g>").tag == "g"
    assert "id=" not in inline


def test_an_arc_runs_through_its_middle() -> None:
    """Nearly a whole turn: the flags of one SVG arc could not tell it from nearly nothing."""
    gap = 0.02
    start, end = (cos(gap) * 50, sin(gap) * 50), (cos(gap) * 50, -sin(gap) * 50)
    turn = tau - 2 * gap
    area = (turn + sin(2 * gap)) * 50**2 / 2
    loop = [(start, end, 1, 1, (0.0, 0.0), 50.0, turn), (end, start, 2, 2, None, 0.0, 0.0)]
    section = made([loop], [area], [0])
    picture = drawn(section)
    (u0, *_, u1), _ = ticks(picture)
    scale = (u1[1] - u0[1]) / (u1[0] - u0[0])
    (region,) = paths(picture, "region")
    assert path_area(region.get("d", ""), scale) == pytest.approx(area, rel=3e-3)


# --- where control is lost, and a measure by colour ---------------------------------------


CURVES = [np.array([[-300.0, -300.0], [0.0, 0.0], [300.0, 250.0]]), np.array([[0, 0], [50, 10]])]


def _shade(values: np.ndarray, bounds: Bounds = ((-100.0, 100.0), (-80.0, 80.0))) -> Shade:
    steps = scale(values, high=True, limits=(None, None))
    assert steps is not None
    return Shade(values, bounds, steps)


def _clip(picture: ElementTree.Element) -> ElementTree.Element:
    """The nested picture: what it holds ends at its box."""
    (inner,) = picture.findall(f"{SVG}svg")
    assert inner.get("viewBox") == " ".join(inner.get(n, "") for n in ("x", "y", "width", "height"))
    assert inner.get("overflow") in (None, "hidden")
    return inner


@pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)
def test_lost_control_and_shade_are_drawn_and_clipped(section: Section) -> None:
    values = np.add.outer(np.linspace(0, 1, 8), np.linspace(0, 1, 10))
    values[2, 3] = np.nan
    picture = drawn(section, curves=CURVES, shade=_shade(values))
    inner = _clip(picture)
    lost = paths(picture, "lost")
    assert len(lost) == 2
    assert {p.get("stroke") for p in lost} == {BEYOND}
    assert set(lost) <= set(inner)
    shaded = paths(picture, "shade")
    assert set(shaded) <= set(inner)
    assert bool(shaded) == bool(section.loops)
    # Neighbours of one colour in a row are one rectangle; all but the one that is none are there.
    sizes = [re.findall(rf"h({NUMBER})v({NUMBER})", p.get("d", "")) for p in shaded]
    widths = [float(w) - 0.3 for each in sizes for w, _ in each]
    if section.loops:
        cells = sum(round(w / min(widths)) for w in widths)
        assert cells == 79
        assert sum(widths) == pytest.approx(79 * min(widths), rel=1e-2)
    assert "nan" not in ElementTree.tostring(picture, encoding="unicode")


def test_curves_go_through_their_points() -> None:
    picture = drawn(RING, curves=CURVES)
    _, lost = paths(picture, "lost")
    places = [
        tuple(map(float, p)) for p in re.findall(rf"({NUMBER}) ({NUMBER})", lost.get("d", ""))
    ]
    across, up = ticks(picture)
    assert places[0] == pytest.approx((at_ticks(across, 0.0), at_ticks(up, 0.0)), abs=0.02)
    assert places[1][0] == pytest.approx(at_ticks(across, 50.0), abs=0.02)


def test_a_shade_covers_the_section_and_paper_all_the_rest() -> None:
    values = np.tile(np.linspace(0.0, 1.0, 10), (4, 1))
    picture = drawn(RING, shade=_shade(values, ((-100.0, 100.0), (-100.0, 100.0))))
    (u0, *_, u1), _ = ticks(picture)
    scale_ = (u1[1] - u0[1]) / (u1[0] - u0[0])
    (paper,) = paths(picture, "paper")
    assert paper.get("fill") == PAPER
    assert paper.get("fill-rule") == "evenodd"
    outer, *loops = re.findall(r"M[^M]*", paper.get("d", ""))
    assert outer.endswith("z")
    assert path_area("".join(loops), scale_) == pytest.approx(RING.area, rel=3e-3)
    # Columns of equal value have one colour each, from little to much.
    shaded = paths(picture, "shade")
    colors = [p.get("fill") for p in shaded]
    assert len(set(colors)) == len(colors)
    firsts = [float(re.findall(rf"M({NUMBER})", p.get("d", ""))[0]) for p in shaded]
    assert firsts == sorted(firsts)
    # The picture is upright: the first row of values is the lowest.
    upright = np.zeros((6, 2))
    upright[0] = 1.0
    top = paths(drawn(RING, shade=_shade(upright)), "shade")[-1]
    heights = [float(y) for y in re.findall(rf"M{NUMBER} ({NUMBER})", top.get("d", ""))]
    rest = paths(drawn(RING, shade=_shade(upright)), "shade")[0]
    others = [float(y) for y in re.findall(rf"M{NUMBER} ({NUMBER})", rest.get("d", ""))]
    assert min(heights) > max(others)


def test_what_the_mode_does_not_have_is_region_without_a_shade_and_its_curves_are_faint() -> None:
    values = np.tile(np.linspace(0.0, 1.0, 10), (4, 1))
    shade = replace(_shade(values), part=RING)
    picture = drawn(RING, shade=shade, curves=CURVES[:1], beyond=CURVES[1:])
    (paper,), (region,) = paths(picture, "paper"), paths(picture, "region")
    inner = list(_clip(picture))
    assert inner.index(region) == inner.index(paper) + 1
    # The region without its part: both, by the even-odd rule.
    assert region.get("d", "").endswith(re.sub(r"^M[^M]*", "", paper.get("d", "")))
    assert region.get("fill-rule") == "evenodd"
    (lost,), (faint,) = paths(picture, "lost"), paths(picture, "lost-beyond")
    assert float(faint.get("stroke-width", "")) < float(lost.get("stroke-width", ""))
    assert float(faint.get("stroke-opacity", "1")) < 0.5
