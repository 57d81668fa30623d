"""Exact sections: the edges' geometry, which side is inside by inverse kinematics, and moments."""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from kinematics.answers.sections import BOUNDS, Section
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter
from kinematics.mechanisms.five_rpur.slicing.events import events
from kinematics.screws.spatial import rotation_y
from tests.kinematics.mechanisms.five_rpur.machines import preset, section, section_range, sections

pytestmark = pytest.mark.usefixtures("compiled")

ZERO = (0.0, 0.0, 0.0)
RHO_MIN, RHO_MAX, LINK = range(3)
TABLES = ("rpur-table1", "rpur-table1-icee", "rpur-table2")
NODES, WEIGHTS = np.polynomial.legendre.leggauss(32)
ROUNDING = 1e-9  # of the machine's size


def machine(*limbs: tuple) -> FiveRPURDesign:
    """Limbs of (w', l, ρ_min, ρ_max): at φ = θ = 0 with the platform points in its origin."""
    return FiveRPURDesign(
        tuple(Limb(tuple(map(float, w)), ZERO, float(li), (a, b)) for w, li, a, b in limbs)
    )


def size_of(design: FiveRPURDesign) -> float:
    return float((design.link + design.stroke[:, 1]).max())


def poses_of(at: float, points: np.ndarray, phi: float, theta: float) -> np.ndarray:
    """Poses (N, 5) of points (N, 2) of the section."""
    turned = np.column_stack([np.full(len(points), at), points])
    angles = np.broadcast_to([phi, theta], (len(points), 2))
    return np.concatenate([turned @ rotation_y(theta).T, angles], axis=1)


def held(design: FiveRPURDesign, poses: np.ndarray, modes) -> np.ndarray:
    """Whether some wanted mode has all lengths within the strokes, not a hair beyond."""
    lengths = inverse.limb_lengths(design, poses)
    ok = (lengths >= design.stroke[:, :1]) & (lengths <= design.stroke[:, 1:])  # NaN: False
    wanted = inverse.MODES if modes is None else modes
    by_mode = [ok[:, range(5), [int(sign == "-") for sign in mode]].all(axis=1) for mode in wanted]
    return np.any(by_mode, axis=0) if by_mode else np.zeros(len(poses), bool)


# --- the judge: what holds of every section ----------------------------------------------------


def along(s: Section, k: int, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points on edge k, and the derivatives there, from its centre, radius and sweep alone."""
    share = np.asarray(share, dtype=float)[:, None]
    if not s.is_arc[k]:
        way = s.end[k] - s.start[k]
        return s.start[k] + share * way, np.broadcast_to(way, (len(share), 2))
    first = s.start[k] - s.center[k]
    angle = np.arctan2(first[1], first[0]) + s.sweep[k] * share
    out = s.radius[k] * np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    return s.center[k] + out, s.sweep[k] * np.stack([-out[:, 1], out[:, 0]], axis=1)


def moments_of(s: Section, edges) -> np.ndarray:
    """1, v, w, v², w², vw over the region, (v, w) from the centroid, by quadrature along edges."""
    total = np.zeros(6)
    for k in edges:
        points, way = along(s, k, 0.5 + 0.5 * NODES)
        v, w = (points - s.centroid).T
        dv, dw = 0.5 * WEIGHTS * way.T
        total += [
            (v * dw).sum(),
            (v * v * dw).sum() / 2,
            -(w * w * dv).sum() / 2,
            (v**3 * dw).sum() / 3,
            -(w**3 * dv).sum() / 3,
            (v * v * w * dw).sum() / 2,
        ]
    return total


def check(design: FiveRPURDesign, phi, theta, at, modes=None) -> Section:
    s = section(design, phi, theta, at, modes)
    size = size_of(design)
    check_loops(s, ROUNDING * size)
    if len(s.start):
        check_curves(design, offset_points(design, phi, theta), s, ROUNDING * size)
        check_sides(design, phi, theta, modes, s)
    check_moments(s, size)
    check_points(design, phi, theta, modes, s)
    return s


def check_loops(s: Section, tolerance: float) -> None:
    assert s.loop_start[0] == 0
    assert s.loop_start[-1] == len(s.start) == len(s.end) == len(s.limb) == len(s.sweep)
    for first, last in pairwise(s.loop_start):
        assert last - first >= 2
        np.testing.assert_array_equal(np.roll(s.end[first:last], 1, axis=0), s.start[first:last])
    assert (np.abs(s.end - s.start).max(axis=1, initial=0.0) > 0.0).all()  # no edge is a point
    assert s.loops == len(s.loop_area) == len(s.loop_piece)
    assert set(s.loop_piece.tolist()) == set(range(s.pieces))
    for piece in range(s.pieces):
        assert s.loop_area[s.loop_piece == piece].sum() >= -(tolerance**2)
    for value in vars(s).values():
        assert not isinstance(value, np.ndarray) or not value.flags.writeable


def check_curves(design: FiveRPURDesign, w: np.ndarray, s: Section, tolerance: float) -> None:
    """Every edge lies on a circle or a line of its limb, from its start to its end."""
    assert set(s.limb.tolist()) <= {1, 2, 3, 4, 5}
    i, arc = s.limb - 1, s.is_arc
    np.testing.assert_array_equal(arc, s.bound != LINK)
    assert s.bound[~arc].tolist() == [BOUNDS.index("link")] * (~arc).sum()
    # Lines: y' = w'_iy ± l_i.
    assert (s.sweep[~arc] == 0.0).all()
    assert np.isnan(s.center[~arc]).all()
    np.testing.assert_array_equal(s.start[~arc, 0], s.end[~arc, 0])
    reach = np.abs(s.start[~arc, 0] - w[i[~arc], 1])
    np.testing.assert_allclose(reach, design.link[i[~arc]], rtol=0, atol=tolerance)
    # Arcs: radius l_i about (w'_iy, w'_iz ± S(ρ, x' − w'_ix)).
    i = i[arc]
    rho = design.stroke[i, s.bound[arc]]
    x = s.at - w[i, 0]
    np.testing.assert_array_equal(s.radius[arc], design.link[i])
    np.testing.assert_allclose(s.center[arc, 0], w[i, 1], rtol=0, atol=tolerance)
    # Squares, for S may be the root of what is nothing but rounding.
    square = (s.center[arc, 1] - w[i, 2]) ** 2
    size = tolerance / ROUNDING
    wanted = np.maximum((rho - x) * (rho + x), 0.0)
    np.testing.assert_allclose(square, wanted, rtol=0, atol=1e-11 * size**2)
    for points in (s.start[arc], s.end[arc]):
        away = np.hypot(*(points - s.center[arc]).T)
        np.testing.assert_allclose(away, s.radius[arc], rtol=0, atol=tolerance)
    for k in np.flatnonzero(arc):
        assert 0.0 < abs(s.sweep[k]) < 2.0 * np.pi
        np.testing.assert_allclose(along(s, k, [1.0])[0][0], s.end[k], rtol=0, atol=tolerance)


def check_sides(design: FiveRPURDesign, phi, theta, modes, s: Section) -> None:
    """Inside by inverse kinematics to the left of every edge, outside to its right.

    Left out are edges that are hardly longer than the step aside, and those that have another
    curve within some steps: films of the region, or of air.
    """
    step = max(1e-8 * size_of(design), 1e-8)
    arc = s.is_arc
    radius = np.where(arc, s.radius, 0.0)
    length = np.where(arc, np.abs(s.sweep) * radius, np.hypot(*(s.end - s.start).T))
    middles, ways = zip(*(along(s, k, [0.4871]) for k in range(len(s.start))), strict=True)
    middle, way = np.concatenate(middles), np.concatenate(ways)
    left = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.hypot(*way.T)[:, None]
    centers, walls = np.column_stack([s.center, s.radius])[arc], s.start[~arc, 0]
    circles = np.unique(centers, axis=0)
    away = np.hypot(*(middle[:, None] - circles[:, :2]).transpose(2, 0, 1)) - circles[:, 2]
    away = np.column_stack([away, middle[:, :1] - np.unique(walls)])
    judged = (length > 100 * step) & ((np.abs(away) < 3 * step).sum(axis=1) == 1)
    for side in (1.0, -1.0):
        beside = poses_of(s.at, middle[judged] + side * step * left[judged], phi, theta)
        assert (held(design, beside, modes) == (side > 0)).all()
    # What bounds the edge is at that end of its stroke there.
    lengths = inverse.limb_lengths(design, poses_of(s.at, middle, phi, theta))
    for k in np.flatnonzero(judged & arc):
        i = s.limb[k] - 1
        nearest = np.nanmin(np.abs(lengths[k, i] - design.stroke[i, s.bound[k]]))
        assert nearest <= 1e-7 * size_of(design)


def check_moments(s: Section, size: float) -> None:
    scale = size ** np.array([2, 3, 3, 4, 4, 4]) * 1e-11
    assert s.loop_area.sum() == pytest.approx(s.area, abs=scale[0])
    if not s.loops:
        assert s.area == 0.0
        assert s.perimeter == 0.0
        assert np.isnan(s.centroid).all()
        assert (s.second_moments == 0.0).all()
        return
    if s.area == 0.0:  # a film
        return
    expected = [s.area, 0.0, 0.0, *s.second_moments]
    assert (np.abs(moments_of(s, range(len(s.start))) - expected) <= scale).all()
    for area, edges in zip(s.loop_area, pairwise(s.loop_start), strict=True):
        assert moments_of(s, range(*edges))[0] == pytest.approx(area, abs=scale[0])
    speeds = [
        np.hypot(*along(s, k, 0.5 + 0.5 * NODES)[1].T) @ WEIGHTS / 2 for k in range(len(s.end))
    ]
    assert s.perimeter == pytest.approx(sum(speeds), rel=1e-9)


def check_points(design: FiveRPURDesign, phi, theta, modes, s: Section) -> None:
    """Random points: inside by inverse kinematics if and only if inside the loops."""
    size = size_of(design)
    corners = s.start if s.loops else offset_points(design, phi, theta)[:, 1:]
    low, high = corners.min(axis=0), corners.max(axis=0)
    spread = 0.2 * (high - low) + 0.02 * size
    points = np.random.default_rng(5).uniform(low - spread, high + spread, (300, 2))
    # Chords of size/200 leave their arcs by no more than 1e-3 of the size.
    lines = [s.polyline(n, size / 200) for n in range(s.loops)]
    crossed, near = np.zeros(len(points), int), np.full(len(points), np.inf)
    for start in lines:
        way = np.roll(start, -1, axis=0) - start
        from_start = points[:, None] - start
        passes = (from_start[..., 1] < 0) != (from_start[..., 1] < way[:, 1])
        share = from_start[..., 1] / np.where(way[:, 1] == 0.0, 1.0, way[:, 1])
        crossed += (passes & (start[:, 0] + share * way[:, 0] > points[:, :1])).sum(axis=1)
        square = np.maximum((way * way).sum(axis=1), 1e-300)
        share = np.clip((from_start * way).sum(axis=-1) / square, 0.0, 1.0)
        apart = np.hypot(*(from_start - share[..., None] * way).transpose(2, 0, 1))
        near = np.minimum(near, apart.min(axis=1))
    clear = near > 2e-3 * size
    inside = inverse.inside(design, poses_of(s.at, points, phi, theta), modes)
    np.testing.assert_array_equal(inside[clear], (crossed % 2 == 1)[clear])


# --- any machine ---------------------------------------------------------------------------------


def random_design(rng: np.random.Generator) -> FiveRPURDesign:
    limbs = []
    for _ in range(5):
        low = rng.uniform(0, 300) if rng.random() < 0.8 else 0.0
        limbs.append(
            Limb(
                tuple(rng.uniform(-80, 80, 3).tolist()),
                tuple(rng.uniform(-60, 60, 3).tolist()),
                rng.uniform(80, 250),
                (low, low + rng.uniform(30, 250)),
            )
        )
    return FiveRPURDesign(tuple(limbs))


def some_modes(rng: np.random.Generator) -> tuple[str, ...] | None:
    if rng.random() < 0.5:
        return None
    return tuple(rng.choice(inverse.MODES, rng.integers(1, 9), replace=False).tolist())


@pytest.mark.parametrize("seed", range(16))
def test_any_machine(seed):
    rng = np.random.default_rng(seed)
    design = preset(TABLES[seed % 3]) if seed % 2 else random_design(rng)
    phi, theta = rng.uniform(-1.2, 1.2, 2).tolist()
    modes = some_modes(rng)
    found = section_range(design, phi, theta, modes)
    assert found is not None
    low, high = found
    seen = [check(design, phi, theta, x, modes) for x in rng.uniform(low, high, 3).tolist()]
    for s, again in zip(
        seen, sections(design, phi, theta, [s.at for s in seen], modes), strict=True
    ):
        np.testing.assert_array_equal(s.end, again.end)
    for beyond in (low - 1e-6, high + 1e-6, low - 1e9):
        assert check(design, phi, theta, beyond, modes).loops == 0


@pytest.mark.parametrize("seed", range(8))
def test_next_to_every_event(seed):
    """Arcs that shrink to a point, circles that touch: at the event, a hair before and after."""
    rng = np.random.default_rng(seed)
    design, phi, theta, modes = preset(TABLES[seed % 3]), 0.0, 0.0, some_modes(rng)
    if seed % 2:
        design, (phi, theta) = random_design(rng), rng.uniform(-1.2, 1.2, 2).tolist()
    cutter = Cutter(design, phi, theta, modes)
    places = events(cutter.limbs, cutter.signs, cutter.size)
    for event in rng.choice(places, min(5, len(places)), replace=False).tolist():
        areas = [
            check(design, phi, theta, event + step * cutter.size, modes).area
            for step in (-1e-12, 0.0, 1e-12)
        ]
        # S is no steeper than a root: of 1e-12 of the size, 1e-6 of it.
        assert np.ptp(areas) <= 2e-5 * cutter.size**2


STROKES = ((0.0, 100.0), (0.0, 200.0), (100.0, 250.0), (150.0, 250.0), (250.0, 400.0))


@st.composite
def lattices(draw) -> tuple[FiveRPURDesign, tuple[str, ...] | None, float]:
    """Round numbers with 3-4-5 triangles among them: shared points, touching circles, and all
    that but for a hair."""
    step = draw(st.sampled_from((30.0, 50.0, 75.0, 150.0)))
    hair = draw(st.sampled_from((0.0, 0.0, 1e-13, 1e-11, 1e-9, 1e-7)))
    limbs = []
    for n in range(5):
        w = [step * draw(st.integers(-2, 2)) + hair * (n - 2) for _ in range(3)]
        if draw(st.booleans()):
            w = [hair * n, 0.0, 0.0]
        link = draw(st.sampled_from((50.0, 100.0, 150.0, 150.0, 200.0)))
        limbs.append((w, link, *draw(st.sampled_from(STROKES))))
    chosen = draw(st.none() | st.sets(st.sampled_from(inverse.MODES), min_size=1, max_size=6))
    at = draw(st.sampled_from((0.0, 25.0, 50.0, 70.0, 80.0, 90.0, 120.0, 150.0, 200.0, 240.0)))
    return machine(*limbs), None if chosen is None else tuple(sorted(chosen)), at


@settings(max_examples=30)
@given(lattices())
def test_near_the_degenerate(case):
    design, modes, at = case
    for angles in ((0.0, 0.0), (np.pi / 2, np.pi)):
        check(design, *angles, at, modes)


# --- known sections ------------------------------------------------------------------------------


def alike(link: float, low: float, high: float) -> FiveRPURDesign:
    return machine(*[(ZERO, link, low, high)] * 5)


def S(rho: float, x: float) -> float:
    return float(np.sqrt(max((rho - x) * (rho + x), 0.0)))


@pytest.mark.parametrize("x", [0.0, 100.0, 249.9, 250.0, 300.0, 399.0, -399.99999])
def test_one_vertex_space(x):
    """Half a vertex space is sheared: its area is 4 l (S(ρ_max) − S(ρ_min)), its moments alike."""
    half = check(alike(150.0, 250.0, 400.0), 0.0, 0.0, x, ("+++++",))
    s, t = S(250.0, x), S(400.0, x)
    assert half.area == pytest.approx(600.0 * (t - s), rel=1e-12)
    np.testing.assert_allclose(half.centroid, [0.0, np.pi / 4 * 150.0], atol=1e-9)
    # About z' = h(y') every column is symmetrical, ∫h² dy' = 4 l³/3.
    across = 4 * 150.0 * (t**3 - s**3) / 3 + 2 * (t - s) * 4 * 150.0**3 / 3
    across -= half.area * half.centroid[1] ** 2
    along_y = 2 * (t - s) * 2 * 150.0**3 / 3
    np.testing.assert_allclose(half.second_moments, [along_y, across, 0.0], rtol=1e-9, atol=1e-3)
    assert half.pieces == (2 if s > 0.0 else 1)
    other = check(alike(150.0, 250.0, 400.0), 0.0, 0.0, x, ("-----",))
    assert other.area == pytest.approx(half.area, rel=1e-12)
    np.testing.assert_allclose(other.centroid, half.centroid * [1, -1], atol=1e-9)
    both = check(alike(150.0, 250.0, 400.0), 0.0, 0.0, x)
    assert both.area <= half.area + other.area


def test_holes_are_clockwise_and_belong_to_a_piece():
    s = check(alike(150.0, 0.0, 100.0), 0.0, 0.0, 0.0)  # H1: |z'| < h − S(ρ_max)
    assert s.pieces == 1
    assert sorted(np.sign(s.loop_area)) == [-1, 1]
    a = np.sqrt(150.0**2 - 100.0**2)
    under = a * 100.0 + 150.0**2 * np.arcsin(a / 150.0)  # ∫h from −a to a
    assert s.loop_area.min() == pytest.approx(-2 * (under - 2 * a * 100.0), rel=1e-12)
    hole = int(s.loop_area.argmin())
    edges = slice(s.loop_start[hole], s.loop_start[hole + 1])
    assert (s.bound[edges] == RHO_MAX).all()
    assert (s.sweep[edges] < 0.0).all() or (s.sweep[edges] > 0.0).all()


def test_a_whole_circle_is_two_halves():
    """The upper arcs of one limb end what the lower ones of another begin, about one centre."""
    tall = ((0.0, 0.0, 400.0), 100.0, 0.0, 200.0)
    s = check(machine((ZERO, 100.0, 0.0, 200.0), tall, *[(ZERO, 100.0, 0.0, 900.0)] * 3), 0, 0, 0)
    assert s.loops == 1
    assert s.area == pytest.approx(np.pi * 100.0**2, rel=1e-12)
    assert s.perimeter == pytest.approx(2 * np.pi * 100.0, rel=1e-12)
    np.testing.assert_allclose(s.center, [[0.0, 200.0]] * 2, atol=1e-9)
    np.testing.assert_allclose(s.sweep, [np.pi] * 2)
    assert set(s.limb) == {1, 2}
    quarter = np.pi / 4 * 100.0**4
    np.testing.assert_allclose(s.second_moments, [quarter, quarter, 0.0], rtol=1e-12, atol=1e-3)


def test_dozens_of_loops():
    """Strokes that begin near 0 cut the region along ten arcs, which cross each other."""
    rows = (
        (42, -31, 205, 46, 168),
        (-57, 20, 165, 2, 134),
        (-47, -79, 164, 2, 109),
        (-62, -33, 202, 2, 178),
        (79, 48, 231, 2, 183),
    )
    s = check(machine(*[((0, y, z), li, low, high) for y, z, li, low, high in rows]), 0, 0, 0.0)
    assert s.loops >= 30
    assert s.pieces >= 24
    pieces = [s.loop_area[s.loop_piece == n] for n in range(s.pieces)]
    assert all((areas > 0.0).sum() == 1 for areas in pieces)  # one outer loop each
    assert len(s.start) > 100


TOUCHING = {
    # (w', l, ρ_min, ρ_max) of the limbs that matter; the others hold everything.
    "from outside, one above the other": [
        (ZERO, 150, 250, 400),
        ((0, 0, -150), 150, 250, 400),
        -392.9058411375427,
    ],
    "from outside, at 3-4-5": [(ZERO, 150, 250, 400), ((0, 180, 240), 150, 250, 400), 0.0],
    "from inside": [(ZERO, 150, 250, 400), ((0, 30, 40), 100, 250, 400), 0.0],
    "coincident": [(ZERO, 150, 250, 400), ((0, 0, 0), 150, 100, 400), 0.0],
    "coincident, of two bounds": [(ZERO, 150, 250, 400), ((0, 0, 150), 150, 250, 250 + 150), 0.0],
    "equal centres, other radii": [(ZERO, 150, 250, 400), (ZERO, 120, 250, 400), 50.0],
    "equal radii, apart by a hair": [(ZERO, 150, 250, 400), ((0, 1e-12, 0), 150, 250, 400), 50.0],
    "apart along x' alone": [(ZERO, 150, 250, 400), ((500, 0, 0), 150, 250, 400), 250.0],
    "inside the other's hole": [(ZERO, 150, 100, 250), (ZERO, 150, 250, 400), 10.0],
    "no stroke to speak of": [(ZERO, 150, 250, 250 + 1e-6), ((10, 20, 30), 150, 100, 400), 50.0],
    "two strokes of a thousandth": [
        (ZERO, 150, 250, 250.001),
        ((10, 20, 30), 150, 200, 200.001),
        50.0,
    ],
    "ρ_min of a thousandth": [(ZERO, 150, 1e-3, 400), ((10, 20, 30), 150, 0, 400), 0.0],
    "ends of links in line": [(ZERO, 150, 250, 400), ((0, 30, 0), 120, 0, 400), 0.0],
    "reach each other in a point": [(ZERO, 150, 250, 400), ((0, 300, 0), 150, 250, 400), 0.0],
}


@pytest.mark.parametrize("kind", TOUCHING)
def test_touching_and_coincident_circles(kind):
    *limbs, at = TOUCHING[kind]
    for order in (limbs, limbs[::-1]):
        rest = [(ZERO, 900.0, 0.0, 3000.0)] * (5 - len(order))
        for modes in (None, ("+++++",), ("+-+++", "-++++", "--+++")):
            check(machine(*order, *rest), 0.0, 0.0, float(at), modes)


def test_the_middle_of_a_touching_pair_is_not_lost():
    """A region that narrows to a point in the middle, where rounding parts the circles."""
    *limbs, at = TOUCHING["from outside, one above the other"]
    s = section(machine(*limbs, *[limbs[0]] * 3), 0.0, 0.0, at)
    t = 150.0 * np.sqrt(3) / 2  # where h = 75 = S(ρ_max), as good as
    under = (t * 75.0 + 150.0**2 * np.pi / 3) / 2  # ∫h from 0 to t
    disc, middle = np.pi * 150.0**2, 4 * (150.0 * t - under)
    assert s.area == pytest.approx(disc - 4 * under + middle, rel=1e-6)


def test_the_same_limb_twice_changes_nothing():
    one, two = ((10, 20, 30), 150, 250, 400), ((60, -20, 0), 120, 200, 350)
    for at in (0.0, 37.0, 210.0):
        some = section(machine(one, two, two, one, one), 0, 0, at)
        more = section(machine(two, two, one, one, two), 0, 0, at)
        assert some.area == pytest.approx(more.area, rel=1e-13)
        assert some.loops == more.loops
        np.testing.assert_allclose(some.second_moments, more.second_moments, rtol=1e-11)


@pytest.mark.parametrize("power", [-17, -3, 12, 20])
def test_the_size_does_not_matter(power):
    """By a power of two every length is scaled without rounding: the same section, to the bit."""
    factor = 2.0**power
    design = preset("rpur-table1")

    def scaled(limb: Limb) -> Limb:
        base, platform = (tuple(factor * v for v in p) for p in (limb.base, limb.platform))
        return Limb(base, platform, factor * limb.link, tuple(factor * v for v in limb.stroke))

    small = FiveRPURDesign(tuple(scaled(limb) for limb in design.limbs))
    for at in (-150.0, 50.0, 200.0):
        here, there = section(design, 0.3, 0.0, at), check(small, 0.3, 0.0, factor * at)
        np.testing.assert_array_equal(there.end, factor * here.end)
        np.testing.assert_array_equal(there.sweep, here.sweep)
        assert there.area == factor**2 * here.area
        np.testing.assert_array_equal(there.second_moments, factor**4 * here.second_moments)


@pytest.mark.parametrize("size", [1e-3, 1e6])
def test_micrometres_and_kilometres(size):
    w = np.array([[0, 0, 0], [1, 0, 0.3], [0, 0.5, 0], [0.7, 0.4, 0.1], [0.2, 0.2, 0.2]]) * size
    design = machine(*[(p, 1.5 * size, 2.5 * size, 4.0 * size) for p in w])
    for at in (-1.0, 0.0, 0.4, 1.0, 2.6):
        assert check(design, 0.0, 0.0, at * size).area > 0.1 * size**2


# --- modes, pieces, frames -----------------------------------------------------------------------


def test_modes_are_a_union():
    design = preset("rpur-table1")
    for at in (20.0, 150.0):
        whole = section(design, 0.0, 0.0, at)
        listed = section(design, 0.0, 0.0, at, inverse.MODES[::-1])
        np.testing.assert_array_equal(whole.end, listed.end)
        single = {m: section(design, 0.0, 0.0, at, (m,)).area for m in inverse.MODES}
        assert max(single.values()) <= whole.area <= sum(single.values())
        for pair in list(combinations(inverse.MODES, 2))[::37]:
            both = check(design, 0.0, 0.0, at, pair)
            least, most = max(single[m] for m in pair), sum(single[m] for m in pair)
            assert least - 1e-6 <= both.area <= most + 1e-6
    assert check(design, 0.0, 0.0, 20.0, ()).loops == 0
    assert section_range(design, 0.0, 0.0, ()) is None


@pytest.mark.parametrize(("name", "at"), [("rpur-table1", 50.0), ("rpur-table2", 20.0)])
def test_pieces_by_flooding_a_grid(name, at):
    design = preset(name)
    s = check(design, 0.0, 0.0, at)
    outline = np.concatenate([s.polyline(n, 1.0) for n in range(s.loops)])
    low, high = outline.min(axis=0) - 5.0, outline.max(axis=0) + 5.0
    y, z = np.meshgrid(*(np.linspace(a, b, 700) for a, b in zip(low, high, strict=True)))
    points = np.stack([y.ravel(), z.ravel()], axis=1)
    inside = inverse.inside(design, poses_of(at, points, 0.0, 0.0)).reshape(y.shape)
    flooded, _ = ndimage.label(inside)
    cell = (y[0, 1] - y[0, 0]) * (z[1, 0] - z[0, 0])
    counts = np.bincount(flooded.ravel())[1:]
    areas = np.sort(counts[counts > 10] * cell)  # less are tips that the grid cuts off
    pieces = np.sort([s.loop_area[s.loop_piece == p].sum() for p in range(s.pieces)])
    assert len(areas) == s.pieces > 1
    np.testing.assert_allclose(areas, pieces, rtol=0.02)


def test_the_construction_holds_every_edge():
    design = preset("rpur-table1")
    s = section(design, 0.2, 0.1, 60.0)
    made_by = s.construction
    circles = {
        (*center, radius, limb, bound)
        for center, radius, limb, bound in zip(
            made_by.center.tolist(),
            made_by.radius.tolist(),
            made_by.circle_limb.tolist(),
            made_by.circle_bound.tolist(),
            strict=True,
        )
        for center in [tuple(center)]
    }
    for k in np.flatnonzero(s.is_arc):
        assert (*s.center[k].tolist(), s.radius[k], s.limb[k], s.bound[k]) in circles
    for k in np.flatnonzero(~s.is_arc):
        lines = made_by.line[made_by.line_limb == s.limb[k]]
        spans = [
            (low[1], high[1])
            for low, high in lines
            if low[0] == pytest.approx(s.start[k, 0], abs=1e-9)
        ]
        low, high = min(v for span in spans for v in span), max(v for span in spans for v in span)
        assert low - 1e-9 <= s.start[k, 1] <= high + 1e-9
        assert low - 1e-9 <= s.end[k, 1] <= high + 1e-9
    # Two circles for each end of a stroke that reaches the plane.
    apart = np.abs(60.0 - offset_points(design, 0.2, 0.1)[:, 0])
    for bound in (RHO_MIN, RHO_MAX):
        assert (made_by.circle_bound == bound).sum() == 2 * (apart < design.stroke[:, bound]).sum()


def test_edge_points_follow_the_edges():
    s = section(preset("rpur-table2"), 0.2, 0.1, 60.0)
    for k in range(len(s.start)):
        points = s.edge_points(k, 1.0)
        np.testing.assert_array_equal(points[[0, -1]], [s.start[k], s.end[k]])
        if s.is_arc[k]:
            away = np.hypot(*(points - s.center[k]).T)
            np.testing.assert_allclose(away, s.radius[k], rtol=1e-12)
            assert np.hypot(*np.diff(points, axis=0).T).max() <= 1.0 + 1e-9
    area = 0.0
    for n in range(s.loops):
        line = s.polyline(n, 0.5)
        after = np.roll(line, -1, axis=0)
        area += 0.5 * float((line[:, 0] * after[:, 1] - line[:, 1] * after[:, 0]).sum())
    assert area == pytest.approx(s.area, rel=1e-5)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ((np.nan, 0.0, 0.0), "phi"),
        ((0.0, np.inf, 0.0), "theta"),
        ((0.0, 0.0, np.nan), "at"),
        ((0.0, 0.0, "here"), "at"),
        ((0.0, 0.0, 0.0, ["+-++"]), "5 signs"),
        ((0.0, 0.0, 0.0, ["+-++0"]), "5 signs"),
        ((0.0, 0.0, 0.0, ["+-+++-"]), "5 signs"),
    ],
)
def test_bad_input_is_told_in_a_sentence(arguments, named):
    with pytest.raises(InputError, match=named) as told:
        section(preset("rpur-table1"), *arguments)
    assert "\n" not in str(told.value)
