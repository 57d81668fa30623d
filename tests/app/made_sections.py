"""Sections whose every number is known beforehand, for tests of pictures and files."""

from __future__ import annotations

from functools import partial
from math import acos, pi, sin, sqrt

import numpy as np

from kinematics.answers.sections import BOUNDS, Construction, Section, SectionSpec

SPEC = SectionSpec("Section at x′", "x′", ("y′", "z′"), "Fig. 17")
MAX, LINK = BOUNDS.index("rho_max"), BOUNDS.index("link")

# start, end, limb, bound, center, radius, sweep; a line has no center
Edge = tuple[
    tuple[float, float],
    tuple[float, float],
    int,
    int,
    tuple[float, float] | None,
    float,
    float,
]


def _same(construction: Construction) -> Construction:
    return construction


def made(
    loops: list[list[Edge]],
    areas: list[float],
    pieces: list[int],
    construction: Construction | None = None,
) -> Section:
    """A section of these edges; what is integrated over it is filled in from ``areas``."""
    edges = [edge for loop in loops for edge in loop]
    lengths = [
        abs(turn) * radius if center else float(np.hypot(*np.subtract(end, start)))
        for start, end, _, _, center, radius, turn in edges
    ]
    nan = (np.nan, np.nan)
    return Section(
        at=25.0,
        start=np.array([e[0] for e in edges], dtype=float).reshape(-1, 2),
        end=np.array([e[1] for e in edges], dtype=float).reshape(-1, 2),
        limb=np.array([e[2] for e in edges], dtype=np.int64),
        bound=np.array([e[3] for e in edges], dtype=np.int64),
        center=np.array([e[4] or nan for e in edges], dtype=float).reshape(-1, 2),
        radius=np.array([e[5] if e[4] else np.inf for e in edges], dtype=float),
        sweep=np.array([e[6] for e in edges], dtype=float),
        loop_start=np.array([0, *np.cumsum([len(loop) for loop in loops])], dtype=np.int64),
        loop_area=np.array(areas, dtype=float),
        loop_piece=np.array(pieces, dtype=np.int64),
        area=float(sum(areas)),
        perimeter=float(sum(lengths)),
        centroid=np.array([1.0, 2.0] if edges else nan),
        second_moments=np.array([3.0, 4.0, 5.0] if edges else 3 * [np.nan]),
        construct=partial(_same, construction or circles([], [])),
    )


def circles(center: list[tuple[float, float]], radius: list[float]) -> Construction:
    """Circles of limbs 1, 2, … and the lines of limb 1 at ±90."""
    return Construction(
        center=np.array(center, dtype=float).reshape(-1, 2),
        radius=np.array(radius, dtype=float),
        circle_limb=np.arange(1, len(radius) + 1),
        circle_bound=np.full(len(radius), MAX),
        line=np.array([[[v, -50.0], [v, 50.0]] for v in (-90.0, 90.0)]) if radius else _none(),
        line_limb=np.ones(2 if radius else 0, dtype=np.int64),
    )


def _none() -> np.ndarray:
    return np.zeros((0, 2, 2))


def whole_circle(
    limb: int, center: tuple[float, float], radius: float, *, hole: bool = False
) -> list[Edge]:
    """Two half arcs, counter-clockwise, or clockwise around a hole."""
    right, left = (center[0] + radius, center[1]), (center[0] - radius, center[1])
    turn = -pi if hole else pi
    return [
        (right, left, limb, MAX, center, radius, turn),
        (left, right, limb, MAX, center, radius, turn),
    ]


def rectangle(limb: int, low: tuple[float, float], high: tuple[float, float]) -> list[Edge]:
    """Four lines, counter-clockwise."""
    corners = [low, (high[0], low[1]), high, (low[0], high[1])]
    ends = [*corners[1:], corners[0]]
    return [(a, b, limb, LINK, None, 0.0, 0.0) for a, b in zip(corners, ends, strict=True)]


RING = made(
    [whole_circle(1, (0, 0), 100.0), whole_circle(2, (10, 0), 40.0, hole=True)],
    [pi * 100**2, -pi * 40**2],
    [0, 0],
    circles([(0, 0), (10, 0)], [100.0, 40.0]),
)
"""A disc with a round hole."""

_HALF = acos(30 / 50)
LENS = made(
    [
        [
            ((0, -40), (0, 40), 1, MAX, (-30, 0), 50.0, 2 * _HALF),
            ((0, 40), (0, -40), 2, MAX, (30, 0), 50.0, 2 * _HALF),
        ]
    ],
    [2 * (50**2 * _HALF - 30 * sqrt(50**2 - 30**2))],
    [0],
    circles([(-30, 0), (30, 0)], [50.0, 50.0]),
)
"""Two discs' intersection."""

TWO = made(
    [rectangle(3, (0, 0), (20, 10)), whole_circle(4, (60, 5), 5.0)],
    [200.0, pi * 25],
    [0, 1],
)
"""A rectangle, and a disc beside it."""

EMPTY = made([], [], [], circles([(-80, 0), (80, 0)], [50.0, 50.0]))
"""Two discs that do not meet."""


def area_by_edge(start: complex, end: complex, turn: float) -> float:
    """What an edge adds to the area by Green's theorem; ``turn`` is 0 of a line."""
    triangle = (start.conjugate() * end).imag / 2
    if turn == 0.0:
        return triangle
    radius = abs(end - start) / 2 / abs(sin(turn / 2))
    return triangle + radius**2 / 2 * (turn - sin(turn))
