"""The largest ball and box: inside by inverse kinematics, touching, and known in closed form."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from kinematics.answers.sections import Box, Sphere
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inscribed.growing import concave_program
from kinematics.mechanisms.five_rpur.inscribed.largest import box, sphere
from kinematics.mechanisms.five_rpur.inscribed.region import Region
from tests.conftest import rarely
from tests.kinematics.mechanisms.five_rpur.machines import preset

ZERO = (0.0, 0.0, 0.0)
TABLES = ("rpur-table1", "rpur-table1-icee", "rpur-table2")


def alike(link: float, low: float, high: float, base=ZERO) -> FiveRPURDesign:
    """Five limbs at one place: the workspace is one limb's vertex space."""
    limb = Limb(tuple(base), ZERO, link, (low, high))
    return FiveRPURDesign((limb, limb, limb, limb, limb))


def random_design(rng) -> FiveRPURDesign:
    limbs = []
    for _ in range(5):
        low = rng.uniform(0, 300) if rng.random() < 0.9 else 0.0
        limbs.append(
            Limb(
                tuple(rng.uniform(-100, 100, 3)),
                tuple(rng.uniform(-60, 60, 3)),
                rng.uniform(80, 250),
                (low, low + rng.uniform(30, 250)),
            )
        )
    return FiveRPURDesign(tuple(limbs))


def random_case(seed: int):
    rng = np.random.default_rng(seed)
    design = preset(TABLES[seed % 3]) if rng.random() < 0.4 else random_design(rng)
    phi, theta = rng.uniform(-1.5, 1.5, 2)
    modes = None
    if rng.random() < 0.6:
        modes = tuple(rng.choice(inverse.MODES, rng.integers(1, 5), replace=False).tolist())
    return design, float(phi), float(theta), modes


def case_with_room(seed: int):
    return next(case for n in range(100) if sphere(*(case := random_case(seed + 1000 * n))))


def inside(design, phi, theta, modes, points):
    angles = np.broadcast_to([phi, theta], (len(points), 2))
    return inverse.inside(design, np.column_stack([points, angles]), modes)


def directions(count: int, seed: int = 0) -> np.ndarray:
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def nearest_outside(case, ball: Sphere) -> float:
    """How far one gets from a ball's surface to the nearest points outside, found by search."""

    def beyond(direction: np.ndarray) -> np.ndarray:
        """The distance from the centre, along directions (N, 3), of the first point outside."""
        ahead = ball.radius + np.linspace(0.0, 1.0, 60) ** 2 * max(0.2 * ball.radius, 1.0)
        points = ball.center + direction[:, None] * ahead[:, None]
        out = ~inside(*case, points.reshape(-1, 3)).reshape(len(direction), -1)
        return np.where(out.any(axis=1), ahead[out.argmax(axis=1)], np.inf)

    way = directions(4000)
    wide = 0.2
    for turn in range(6):
        reached = beyond(way)
        best = way[np.argsort(reached)[:20]]
        way = np.concatenate([best, *(best + wide * directions(20, turn + k) for k in range(100))])
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        wide *= 0.4
    return float(beyond(best).min() - ball.radius)


def check_ball(case, ball: Sphere) -> None:
    assert ball.radius > 0.0
    assert not ball.center.flags.writeable
    safe = ball.radius - ball.error
    assert inside(*case, ball.center + safe * directions(20000)).all()
    rng = np.random.default_rng(1)
    within = ball.center + safe * directions(20000, 2) * np.cbrt(rng.random((20000, 1)))
    assert inside(*case, within).all()


def check_box(case, found: Box) -> None:
    assert found.volume > 0.0
    assert not found.low.flags.writeable
    low, high = found.low + found.error, found.high - found.error
    rng = np.random.default_rng(1)
    share = rng.random((30000, 3))
    on = rng.integers(0, 3, 20000)  # the first 20000 on faces, half of those on edges
    share[np.arange(20000), on] = rng.integers(0, 2, 20000)
    share[np.arange(10000), (on[:10000] + 1) % 3] = rng.integers(0, 2, 10000)
    share[:8] = list(product((0.0, 1.0), repeat=3))
    assert inside(*case, low + share * (high - low)).all()


# --- against inverse kinematics ------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_all_of_the_ball_is_inside_and_no_grid_point_has_more_room(seed):
    case = random_case(seed)
    ball = sphere(*case)
    grid = Region.at(*case).bounds
    if grid is None:
        assert ball is None
        return
    low, high = grid
    nodes = low + (high - low) * np.random.default_rng(seed).random((40000, 3))
    nodes = nodes[inside(*case, nodes)]
    if ball is None:
        assert not len(nodes)
        return
    check_ball(case, ball)
    # No point inside is the centre of a larger ball.
    for node in nodes[:: max(1, len(nodes) // 100)]:
        larger = 1.002 * ball.radius + 1e-6
        assert not inside(*case, node + larger * directions(2000)).all()


@pytest.mark.parametrize("seed", range(20, 22))
def test_what_lies_just_beyond_a_ball_is_outside(seed):
    case = case_with_room(seed)
    ball = sphere(*case)
    assert ball is not None
    assert nearest_outside(case, ball) < 2e-3 * ball.radius
    about = sphere(*case, center=ball.center + 0.3 * ball.radius * directions(1, seed)[0])
    assert about is not None
    assert 0.7 * ball.radius - 1e-6 <= about.radius <= ball.radius + ball.error
    check_ball(case, about)
    assert nearest_outside(case, about) < 2e-3 * about.radius


@pytest.mark.parametrize("seed", [40, *map(rarely, (41, 42))])
def test_all_of_the_box_is_inside_and_it_cannot_grow(seed):
    case = case_with_room(seed)
    found = box(*case)
    assert found is not None
    check_box(case, found)
    ball = sphere(*case)
    assert ball is not None
    assert found.volume >= 0.99 * (2.0 * ball.radius / 3.0**0.5) ** 3
    # No face can move out, and no change of all six at random gives a larger box.
    size = found.high - found.low
    rng = np.random.default_rng(seed)
    share = np.concatenate([rng.random((20000, 3)), list(product((0.0, 1.0), repeat=3))])
    for axis, side in product(range(3), range(2)):
        moved = share.copy()
        moved[:, axis] = side + (0.02 if side else -0.02) * rng.random(len(share))
        assert not inside(*case, found.low + moved * size).all()
    edges = np.sort(rng.random((3000, 3)), axis=0)
    edges[np.arange(3000), rng.integers(0, 3, 3000)] = rng.integers(0, 2, 3000)
    edges = np.concatenate([edges, share[-8:], rng.random((3000, 3))])
    for _ in range(100):
        low = found.low - 0.05 * size * rng.normal(size=3)
        high = found.high + 0.05 * size * rng.normal(size=3)
        if np.prod(high - low) > 1.01 * found.volume:
            # What few points do not tell, many do.
            many = inside(*case, low + edges * (high - low)).all() and inside(
                *case, low + rng.random((1_000_000, 3)) * (high - low)
            )
            assert not np.all(many)


@pytest.mark.slow
def test_a_box_about_a_centre_is_centred_there_and_the_largest_such():
    case = (preset("rpur-table1"), -0.3, 0.5, None)
    anywhere = box(*case)
    assert anywhere is not None
    middle = 0.5 * (anywhere.low + anywhere.high)
    centred = box(*case, center=middle)
    assert centred is not None
    np.testing.assert_allclose(0.5 * (centred.low + centred.high), middle, atol=1e-9)
    assert centred.volume == pytest.approx(anywhere.volume, rel=1e-4)
    beside = box(*case, center=middle + 5.0)
    assert beside is not None
    check_box(case, beside)
    assert beside.volume < anywhere.volume


# --- what is known in closed form ----------------------------------------------------------------


@pytest.mark.parametrize("theta", [0.0, 0.6])
def test_a_short_thick_tube_about_the_middle_of_one_limb(theta):
    """In mode +, a ball about (ρ, 0, l) in x'y'z' on the circle of B at y = 0, midway between
    both ends of the stroke: nothing is nearer than the ends while links are long."""
    design, modes = alike(400.0, 300.0, 340.0), ("+++++",)
    turn = np.array([np.cos(theta), 0.0, -np.sin(theta)])
    lean = np.array([np.sin(theta), 0.0, np.cos(theta)])
    ball = sphere(design, 0.0, theta, modes, 320.0 * turn + 400.0 * lean)
    assert ball is not None
    assert ball.radius == pytest.approx(20.0, abs=1e-7)
    best = sphere(design, 0.0, theta, modes)
    assert best is not None
    # No ball is thicker than the stroke is long; along the tube the room hardly changes.
    assert best.radius == pytest.approx(20.0, rel=1e-3)
    assert best.radius <= 20.0 + best.error


def test_a_ball_between_the_flat_ends():
    """A short link and a long stroke: |y| <= l alone bounds a ball beside the base."""
    design = alike(30.0, 100.0, 500.0, base=(1.0, 2.0, 3.0))
    ball = sphere(design, 0.2, 0.0)
    assert ball is not None
    assert ball.radius == pytest.approx(30.0, abs=1e-6)
    assert ball.center[1] == pytest.approx(2.0, abs=1e-5)
    about = sphere(design, 0.2, 0.0, None, (301.0, 12.0, 3.0))
    assert about is not None
    assert about.radius == pytest.approx(20.0, abs=1e-9)


def test_a_ball_in_the_notch_of_the_two_halves():
    """ρ_min = 0 and a ball at the base: both halves are sheared discs that meet in the plane
    z = 0 where h >= 0; the nearest point of the complement is found on the curve x² + h² = ρ²."""
    link, high = 100.0, 120.0
    ball = sphere(alike(link, 0.0, high), 0.0, 0.0, None, ZERO)
    assert ball is not None
    y = np.linspace(-link, link, 2_000_001)
    x = np.sqrt(high**2 - (link**2 - y**2))
    assert ball.radius == pytest.approx(np.sqrt(x**2 + y**2).min(), abs=1e-7)


def test_one_mode_by_brute_force_over_the_surfaces():
    """With one mode the room is the least distance to any limb's tubes and flat ends."""
    design, phi, theta, mode = preset("rpur-table1"), -0.3, 0.5, "+-+++"
    rng = np.random.default_rng(4)
    bounds = Region.at(design, phi, theta, (mode,)).bounds
    assert bounds is not None
    points = rng.uniform(*bounds, (20000, 3))
    points = points[inside(design, phi, theta, (mode,), points)][:12]
    turn = inverse.transform([0.0, 0.0, 0.0, phi, theta])[:3, :3]
    lean = np.array([np.sin(theta), np.cos(theta)])
    for point in points:
        nearest = []
        for i, limb in enumerate(design.limbs):
            x, y, z = point - (design.base[i] - turn @ design.platform[i])
            sign = 1.0 if mode[i] == "+" else -1.0
            for radius in limb.stroke:
                low, high = 0.0, np.pi
                for _ in range(2):
                    beta = np.linspace(low, high, 40_001)
                    shift = sign * limb.link * np.sin(beta)
                    apart = np.hypot(x - shift * lean[0], z - shift * lean[1])
                    far = np.hypot(y - limb.link * np.cos(beta), apart - radius)
                    low, high = beta[[max(far.argmin() - 2, 0), min(far.argmin() + 2, 40_000)]]
                nearest.append(far.min())
            nearest.append(limb.link - abs(y))
        ball = sphere(design, phi, theta, (mode,), point)
        assert ball is not None
        assert ball.radius == pytest.approx(min(nearest), abs=1e-6)


def test_a_box_in_a_tube_of_long_links():
    """Of a single flat end a box knows its height: both faces touch |y| = l where links are
    short and the stroke is long."""
    found = box(alike(10.0, 100.0, 900.0), 0.0, 0.0)
    assert found is not None
    # In a plane the rectangle stands beside the inner circle; both shift by no more than l.
    half = np.linspace(1.0, 889.0, 100_001)

    def largest(low, high):
        return (2.0 * half * (np.sqrt(np.maximum(high**2 - half**2, 0.0)) - low)).max()

    assert 0.9 * 20.0 * largest(100.0, 900.0) < found.volume < 20.0 * largest(90.0, 910.0)
    assert found.low[1] == pytest.approx(-10.0, abs=0.5)
    assert found.high[1] == pytest.approx(10.0, abs=0.5)


# --- invariance ----------------------------------------------------------------------------------


def moved(design: FiveRPURDesign, shift=(0.0, 0.0, 0.0), mirror=(1.0, 1.0, 1.0)) -> FiveRPURDesign:
    limbs = [
        Limb(
            tuple(np.array(limb.base) * mirror + shift),
            tuple(np.array(limb.platform) * mirror),
            limb.link,
            limb.stroke,
        )
        for limb in design.limbs
    ]
    return FiveRPURDesign(tuple(limbs))


@pytest.mark.parametrize("modes", [None, ("+-+++", "--+-+")])
def test_a_machine_moved_or_mirrored_has_the_same_room(modes):
    design, phi, theta = preset("rpur-table2"), 0.4, -0.3
    ball = sphere(design, phi, theta, modes)
    assert ball is not None
    point = ball.center + np.array([3.0, -2.0, 4.0])
    room = sphere(design, phi, theta, modes, point)
    assert room is not None
    assert room.radius > 0.0
    shift = np.array([100.0, -200.0, 50.0])
    same = sphere(moved(design, shift), phi, theta, modes, point + shift)
    assert same is not None
    assert same.radius == pytest.approx(room.radius, abs=1e-6)
    # Mirrored in y = 0 φ changes its sign, in x = 0 θ does, and modes stay; in z = 0 both angles
    # and all modes do.
    for mirror, angles, flips in (
        ((1.0, -1.0, 1.0), (-phi, theta), False),
        ((-1.0, 1.0, 1.0), (phi, -theta), False),
        ((1.0, 1.0, -1.0), (-phi, -theta), True),
    ):
        swap = str.maketrans("+-", "-+")
        other = modes if modes is None or not flips else tuple(m.translate(swap) for m in modes)
        same = sphere(moved(design, mirror=mirror), *angles, other, point * mirror)
        assert same is not None
        assert same.radius == pytest.approx(room.radius, abs=1e-6)
        best = sphere(moved(design, mirror=mirror), *angles, other)
        assert best is not None
        assert best.radius == pytest.approx(ball.radius, rel=1e-6)


def test_all_modes_by_name_are_the_whole_and_more_modes_are_more_room():
    design, phi, theta = preset("rpur-table1"), 0.3, 0.2
    whole, named = sphere(design, phi, theta), sphere(design, phi, theta, inverse.MODES)
    assert whole is not None
    assert named is not None
    assert named.radius == pytest.approx(whole.radius, abs=1e-9)
    before = 0.0
    for count in (1, 2, 4, 8, 16, 32):
        room = sphere(design, phi, theta, inverse.MODES[:count], whole.center)
        assert room is not None
        assert room.radius >= before - 1e-9
        before = room.radius
    assert before == pytest.approx(whole.radius, abs=1e-6)


# --- edges of the permitted ----------------------------------------------------------------------


def test_a_centre_outside_has_no_room_and_an_empty_workspace_nothing():
    design = preset("rpur-table1")
    ball, found = (f(design, 0.0, 0.0, None, ZERO) for f in (sphere, box))
    assert ball is not None
    assert ball.radius == 0.0
    assert found is not None
    assert found.volume == 0.0
    np.testing.assert_array_equal(found.low, 0.0)
    apart = FiveRPURDesign(
        tuple(Limb((0.0, 300.0 * i, 0.0), ZERO, 100.0, (10.0, 90.0)) for i in range(5))
    )
    for empty in ((apart, 0.0, 0.0, None), (design, 0.0, 0.0, ())):
        assert sphere(*empty) is None
        assert box(*empty) is None


def test_bad_input_is_told():
    design = preset("rpur-table1")
    for f in (sphere, box):
        with pytest.raises(InputError, match="the centre must have 3 numbers"):
            f(design, 0.0, 0.0, None, (1.0, 2.0))
        with pytest.raises(InputError, match="finite"):
            f(design, 0.0, 0.0, None, (1.0, 2.0, float("nan")))
        with pytest.raises(InputError, match="working mode"):
            f(design, 0.0, 0.0, ("++",))
        with pytest.raises(InputError, match="finite"):
            f(design, float("inf"), 0.0)


@pytest.mark.parametrize("stroke", [5.0, 0.1, 1e-3])
def test_short_strokes_leave_thin_regions_that_are_found(stroke):
    """The five lengths are those of one pose, and hardly more: a tiny region about it."""
    design = preset("rpur-table1")
    pose = np.array([-33.0, 87.0, 226.0, -0.3, 0.5])
    lengths = inverse.limb_lengths(design, pose)[:, 0]
    limbs = [
        Limb(limb.base, limb.platform, limb.link, (length - stroke / 2, length + stroke / 2))
        for limb, length in zip(design.limbs, lengths.tolist(), strict=True)
    ]
    thin = FiveRPURDesign(tuple(limbs))
    case = (thin, -0.3, 0.5, ("+++++",))
    about = sphere(*case, center=pose[:3])
    ball = sphere(*case)
    assert about is not None
    assert ball is not None
    assert 0.0 < about.radius <= ball.radius + ball.error <= stroke / 2 + 2 * ball.error
    check_ball(case, ball)
    found = box(*case)
    assert found is not None
    check_box(case, found)


@settings(max_examples=5, deadline=None)
@given(
    st.floats(0.001, 1000.0),
    st.one_of(st.just(0.0), st.floats(0.0, 1000.0)),
    st.floats(1e-3, 500.0),
    st.floats(-3.2, 3.2),
)
# Two samples along the tube are one but for a rounding, with the nearest point before both.
@example(400.90044264860956, 18.265384859539328, 0.5, -1.6203393749366766)
@pytest.mark.slow
def test_one_vertex_space_of_any_measures(link, low, stroke, theta):
    case = (alike(link, low, low + stroke), 0.0, theta, ("+++++",))
    ball = sphere(*case)
    assert ball is not None
    assert 0.0 < ball.radius <= min(link, max(stroke / 2, low + stroke if low == 0 else 0)) + 1e-5
    check_ball(case, ball)


@pytest.mark.parametrize(
    ("link", "stroke", "theta"),
    [
        # Tubes thinner than the distance of samples along them: no corner met any.
        rarely(865.812356820165, (0.0, 1.5982055049244648), 0.5369187750447773),
        (20.999646774490966, (0.0, 0.0038366784985954688), -1.2217580952934313),
        # Shells so thin that the box is met next to its faces across y only.
        (331.29789685502885, (899.2536748095519, 900.0501128730754), 2.2064471195209956),
        rarely(991.7671470703186, (12.447068331030152, 12.541457991391443), -0.9276659976657977),
    ],
)
def test_boxes_in_thin_vertex_spaces(link, stroke, theta):
    case = (alike(link, *stroke), 0.0, theta, ("+++++",))
    ball = sphere(*case)
    assert ball is not None
    rng = np.random.default_rng(4)
    near = ball.center + 0.5 * ball.radius * directions(3, 5) * rng.random((3, 1))
    for center in (ball.center, *near):
        found = box(*case, center=center)
        assert found is not None
        check_box(case, found)
    check_box(case, box(*case))


@pytest.mark.slow
def test_through_the_mechanism():
    sections = machine_of(preset("rpur-table1")).sections
    assert sections is not None
    pose = (0.0, 0.0, 0.0, -0.3, 0.5)
    ball, found = sections.ball(pose, None), sections.box(pose, None)
    assert ball is not None
    assert found is not None
    assert ball.radius > 60.0
    assert found.volume > 900_000.0


# --- the program behind the steps ----------------------------------------------------------------


def test_a_concave_program_meets_the_conditions_of_its_optimum():
    rng = np.random.default_rng(3)
    for _ in range(20):
        rows, room = rng.normal(size=(12, 4)), rng.uniform(0.01, 0.5, 12)
        half = rng.normal(size=(4, 4))
        slope, curvature = rng.normal(size=4), -half @ half.T
        x, weight = concave_program(rows, room, slope, curvature)
        assert (rows @ x + room > -1e-8).all()
        assert (np.abs(x) <= 1.0 + 1e-8).all()
        assert (weight >= 0.0).all()
        assert (weight * (rows @ x + room) < 1e-8).all()
        # Multipliers of the rows leave of the slope only what the bounds of x hold.
        left = slope + curvature @ x + weight @ rows
        held = np.abs(x) > 1.0 - 1e-6
        np.testing.assert_allclose(left[~held], 0.0, atol=1e-6)
        assert (left[held] * x[held] >= -1e-6).all()
