"""Colours are told apart by everybody, and text is read on either page: computed, not looked at."""

from __future__ import annotations

import re
from itertools import combinations, product

import numpy as np
import pytest

from app.scene import palette
from app.scene.palette import DARK, LIGHT, LIMBS, Scheme
from app.widgets.texts import tone

# Machado, Oliveira & Fernandes (2009), severity 1, on linear light.
SIGHTS = {
    "full": np.eye(3),
    "no red": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "no green": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "no blue": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
_WHITE = np.array([0.95047, 1.0, 1.08883])
ONE_COLOUR = 10.0  # CIE76; what is nearer is taken for one


def _light(code: str) -> np.ndarray:
    parts = np.array(palette.rgb(code)) / 255.0
    linear: np.ndarray = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return linear


def _lab(light: np.ndarray) -> np.ndarray:
    share = _XYZ @ light / _WHITE
    f = np.where(share > 216 / 24389, np.cbrt(share), (24389 / 27 * share + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def _distance(one: str, two: str) -> float:
    """CIE76, of the four kinds of colour sight the least; to whole numbers, as designed."""
    seen = [[_lab(np.clip(s @ _light(c), 0, 1)) for c in (one, two)] for s in SIGHTS.values()]
    return float(round(min(np.linalg.norm(a - b) for a, b in seen)))


def _contrast(one: str, two: str) -> float:
    """WCAG 2."""
    low, high = sorted(float(_XYZ[1] @ _light(code)) for code in (one, two))
    return (high + 0.05) / (low + 0.05)


def _from_limbs(code: str) -> float:
    return min(_distance(code, limb) for limb in LIMBS)


def test_the_measure_knows_colours_that_are_taken_for_one() -> None:
    assert _distance("#8397AD", "#7C8FA8") == 3  # workspace and ghosts of former pages
    assert _distance("#8397AD", LIMBS[3]) == 6
    assert _distance("#A3937B", LIMBS[2]) == 4
    assert _contrast("#000000", "#FFFFFF") == pytest.approx(21.0)


def test_limbs_are_told_apart() -> None:
    assert min(_distance(a, b) for a, b in combinations(LIMBS, 2)) >= ONE_COLOUR


def test_on_a_light_page_everything_is_as_far_apart_as_designed() -> None:
    assert _from_limbs(LIGHT.workspace) >= 15
    assert _from_limbs(LIGHT.ghost) >= 30
    assert _distance(LIGHT.ghost, LIGHT.workspace) >= 15
    assert min(map(_from_limbs, LIGHT.aspects[-1])) >= 17
    assert min(map(_from_limbs, LIGHT.aspects[1])) >= 14
    assert _distance(LIGHT.aspects[1][0], LIGHT.aspects[-1][0]) >= 50
    assert min(_distance(a, b) for a, b in product(LIGHT.aspects[1], LIGHT.aspects[-1])) >= 40
    assert _distance(LIGHT.ink, LIGHT.counterpart) >= 45
    assert _distance(LIGHT.beyond, LIMBS[1]) >= 18


def test_on_a_dark_page_nothing_is_taken_for_another() -> None:
    assert _from_limbs(DARK.workspace) >= ONE_COLOUR
    assert _from_limbs(DARK.ghost) >= 15
    assert _distance(DARK.ghost, DARK.workspace) >= 15
    assert min(map(_from_limbs, (*DARK.aspects[1], *DARK.aspects[-1]))) >= ONE_COLOUR
    assert min(_distance(a, b) for a, b in product(DARK.aspects[1], DARK.aspects[-1])) >= 19
    assert _from_limbs(DARK.beyond) >= 15
    assert _distance(DARK.ink, DARK.counterpart) >= 30


@pytest.mark.parametrize("of", [LIGHT, DARK], ids=["light", "dark"])
def test_text_is_read_and_lines_are_seen(of: Scheme) -> None:
    for text in (of.ink, of.quiet, of.good, of.near, of.bad):
        assert _contrast(text, of.panel) >= 4.5, text
    for line in (of.beyond, of.workspace, of.ghost, of.edge):
        assert _contrast(line, of.panel) >= 3.0, line


def test_joints_are_seen_on_either_page() -> None:
    for of, ground in ((LIGHT, "#FFFFFF"), (DARK, "#141414")):
        assert _contrast(of.joint, ground) >= 3.0


def test_tones_of_text_are_those_of_the_scheme() -> None:
    found = {level: re.search(r"#\w+", tone(level)) for level in ("good", "near", "bad", "quiet")}
    for level, code in found.items():
        assert code is not None
        assert code[0] == getattr(LIGHT, level)
