"""Drawings close: the bars of a limb touch each other, links keep their length."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from kinematics.answers.drawings import Bar, Drawing, round_plate
from tests.conformance.machines import PRESETS, held, machine

LOOSE = ("rail", "stop")


def distance(one: Bar, other: Bar) -> float:
    """Between the axes of two bars, to a hundredth of their lengths, mm."""
    share = np.linspace(0.0, 1.0, 201)[:, None]
    a = np.array(one.start) + share * np.subtract(one.end, one.start)
    b = np.array(other.start) + share * np.subtract(other.end, other.start)
    return float(np.linalg.norm(a[:, None] - b[None], axis=2).min())


def bars_of(drawing: Drawing, limb: int) -> list[Bar]:
    return [bar for bar in drawing.bars if bar.limb == limb and bar.role not in LOOSE]


@pytest.mark.parametrize("name", PRESETS)
def test_the_bars_of_a_limb_hang_together(name: str) -> None:
    m = machine(name)
    drawing = m.drawing(held(name)[1])
    for limb in {joint.limb for joint in m.joints}:
        bars = bars_of(drawing, limb or 0)
        assert len(bars) >= 2
        groups = [{n} for n in range(len(bars))]
        for a, b in combinations(range(len(bars)), 2):
            room = bars[a].radius + bars[b].radius + 0.02 * drawing.size
            if distance(bars[a], bars[b]) <= room:
                one = next(g for g in groups if a in g)
                other = next(g for g in groups if b in g)
                if one is not other:
                    groups.remove(other)
                    one |= other
        assert len(groups) == 1, [bars[next(iter(g))].name for g in groups]


@pytest.mark.parametrize("name", PRESETS)
def test_nothing_is_short_and_links_are_rigid(name: str) -> None:
    m = machine(name)
    lengths = []
    for posture in held(name)[:3]:
        drawing = m.drawing(posture)
        assert not [bar for bar in drawing.bars if bar.role == "gap"]
        assert len({bar.name for bar in drawing.bars}) == len(drawing.bars)
        places = np.array([place for bar in drawing.bars for place in (bar.start, bar.end)])
        assert np.isfinite(places).all()
        assert {body.frame for body in drawing.bodies} >= {"platform"}
        links = [bar for bar in drawing.bars if bar.role == "link"]
        lengths.append([np.linalg.norm(np.subtract(bar.end, bar.start)) for bar in links])
    assert np.ptp(np.array(lengths), axis=0).max(initial=0.0) < 1e-9 * m.length


@pytest.mark.parametrize("name", PRESETS)
def test_what_cannot_be_held_is_drawn_all_the_same(name: str) -> None:
    m = machine(name)
    far = [2.0 * axis.upper for axis in m.coordinates]
    drawing = m.drawing(m.posture(far, m.home.mode))
    places = np.array([place for bar in drawing.bars for place in (bar.start, bar.end)])
    assert np.isfinite(places).all()


def test_a_round_plate_has_its_corners_evenly_once_around() -> None:
    rim = np.array(round_plate(np.array([30.0, -20.0]), 50.0, 7.0, 24))
    assert rim.shape == (24, 3)
    sides = np.linalg.norm(np.roll(rim, -1, axis=0) - rim, axis=1)
    np.testing.assert_allclose(sides, 100.0 * np.sin(np.pi / 24), rtol=1e-12)
    np.testing.assert_allclose(rim.mean(axis=0), [30.0, -20.0, 7.0], atol=1e-12)
    x, y = rim[:, 0], rim[:, 1]
    area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert area == pytest.approx(12 * 50.0**2 * np.sin(np.pi / 12))
