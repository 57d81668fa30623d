"""Every variety of lines, built on purpose, under random motions and scales."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.arrays import Array
from kinematics.screws.lines import Circuit, geometry
from kinematics.screws.varieties import Screw, screw, variety

Rng = np.random.Generator
TOLERANCE = 1e-6


def unit(rng: Rng, count: int | None = None) -> Array:
    vectors = rng.normal(size=(3,) if count is None else (count, 3))
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def lines(points: Any, directions: Any) -> Array:
    points, directions = np.broadcast_arrays(
        np.asarray(points, float), np.asarray(directions, float)
    )
    directions = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return np.concatenate([directions, np.cross(points, directions)], axis=-1)


def couples(directions: Any) -> Array:
    directions = np.asarray(directions, float)
    return np.concatenate([np.zeros_like(directions), directions], axis=-1)


def turned(rng: Rng) -> Array:
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


def moved(rows: Array, rotation: Array, shift: Array, size: float) -> Array:
    """The same lines after x → size R x + shift."""
    force = rows[:, :3] @ rotation.T
    moment = size * rows[:, 3:] @ rotation.T + np.cross(shift, force)
    # A couple has no scale of its own.
    still = np.linalg.norm(rows[:, :3], axis=1) == 0.0
    moment[still] /= size
    return np.concatenate([force, moment], axis=1)


def frame(rng: Rng) -> tuple[Array, Array, Array]:
    q = turned(rng)
    return q[:, 0], q[:, 1], q[:, 2]


# --- constructions: rows, and the kind that they must be ------------------------------------


def same_line(rng: Rng) -> Array:
    p, d = rng.normal(size=3), unit(rng)
    return lines([p, p + 2.0 * d], [d, -d])


def same_couple(rng: Rng) -> Array:
    d = unit(rng)
    return couples([d, -2.0 * d])


def pencil(rng: Rng) -> Array:
    u, v, _ = frame(rng)
    angles = np.array([0.1, 1.0, 2.2])[:, None]
    return lines(rng.normal(size=3), np.cos(angles) * u + np.sin(angles) * v)


def parallel_pencil(rng: Rng) -> Array:
    u, v, _ = frame(rng)
    return lines(rng.normal(size=3) + np.array([[0.0], [1.0], [2.5]]) * v, u)


def two_parallels_and_their_couple(rng: Rng) -> Array:
    u, v, w = frame(rng)
    return np.concatenate([lines([0.0 * v, 1.3 * v], u), couples([w])])


def three_couples(rng: Rng) -> Array:
    u, v, _ = frame(rng)
    return couples([u, v, u - 0.7 * v])


def bundle(rng: Rng) -> Array:
    return lines(rng.normal(size=3), unit(rng, 4))


def parallel_bundle(rng: Rng) -> Array:
    u, v, w = frame(rng)
    places = np.array([[0, 0], [1, 0], [0.3, 1.1], [-0.8, 0.6]])
    return lines(places @ np.array([v, w]), u)


def plane(rng: Rng) -> Array:
    u, v, _ = frame(rng)
    angles = np.array([0.1, 0.9, 1.7, 2.6])[:, None]
    at = rng.normal(size=3) + np.array([[0.0], [1.0], [-0.7], [0.4]]) * u
    return lines(at, np.cos(angles) * u + np.sin(angles) * v)


def plane_with_its_couple(rng: Rng) -> Array:
    u, v, w = frame(rng)
    at = np.array([[0.0], [1.0], [-0.7]]) * u
    angles = np.array([0.3, 1.2, 2.4])[:, None]
    return np.concatenate([lines(at, np.cos(angles) * u + np.sin(angles) * v), couples([w])])


def all_couples(rng: Rng) -> Array:
    return couples(unit(rng, 4))


def two_pencils(rng: Rng) -> Array:
    u, v, w = frame(rng)
    other = np.cos(0.8) * v + np.sin(0.8) * w
    near = [np.cos(a) * u + np.sin(a) * v for a in (0.6, 1.9)]
    far = [np.cos(a) * u + np.sin(a) * other for a in (0.8, 2.3)]
    p = rng.normal(size=3)
    return lines([p, p, p + 1.5 * u, p + 1.5 * u], [*near, *far])


def regulus(rng: Rng) -> Array:
    angles = np.array([0.0, 1.3, 2.4, 4.1])
    a, b, c = 1.0, 0.7, 1.4
    points = np.stack([a * np.cos(angles), b * np.sin(angles), 0 * angles], axis=1)
    directions = np.stack([-a * np.sin(angles), b * np.cos(angles), c + 0 * angles], axis=1)
    return lines(points, directions)


def paraboloid(rng: Rng) -> Array:
    # z = x y: through (t, 0, 0) along (0, 1, t).
    t = np.array([-1.0, 0.2, 0.9, 1.7])
    return lines(np.stack([t, 0 * t, 0 * t], axis=1), np.stack([0 * t, 1 + 0 * t, t], axis=1))


def _meeting(rng: Rng, first: tuple[Array, Array], second: tuple[Array, Array]) -> Array:
    """Five lines that meet two."""
    a = first[0] + rng.uniform(-2, 2, (5, 1)) * first[1]
    b = second[0] + rng.uniform(-2, 2, (5, 1)) * second[1]
    return lines(a, b - a)


def hyperbolic(rng: Rng) -> Array:
    return _meeting(rng, (np.zeros(3), unit(rng)), (2.0 * unit(rng), unit(rng)))


def hyperbolic_at_infinity(rng: Rng) -> Array:
    u, v, w = frame(rng)
    angles = np.array([0.2, 0.9, 1.6, 2.2, 2.9])[:, None]
    at = np.array([[0.0], [1.0], [-1.2], [0.4], [2.2]]) * (w + 0.4 * u)
    return lines(at, np.cos(angles) * u + np.sin(angles) * v)


def elliptic(rng: Rng) -> Array:
    # Tangents of helices of one pitch about one axis, at each radius its own slope.
    at = np.array([[0.5, 0.1], [-0.7, 0.9], [0.2, -1.3], [1.5, 0.8], [-0.4, -0.6]])
    x, y = at.T
    return lines(np.stack([x, y, 0 * x], axis=1), np.stack([-y, x, 1.1 + 0 * x], axis=1))


def parabolic(rng: Rng) -> Array:
    # At each point of an axis the pencil in a plane that turns with the point.
    t = np.array([-1.0, -0.3, 0.4, 0.9, 1.6])
    turn = np.arctan(t)  # projective between points and planes
    across = np.stack([0 * t, np.cos(turn), np.sin(turn)], axis=1)
    slant = np.array([0.7, 1.2, 2.0, 1.5, 0.9])[:, None]
    directions = np.cos(slant) * [1.0, 0.0, 0.0] + np.sin(slant) * across
    return lines(np.stack([t, 0 * t, 0 * t], axis=1), directions)


def degenerate(rng: Rng) -> Array:
    u, v, w = frame(rng)
    p = rng.normal(size=3)
    in_plane = lines([p + 0.5 * u, p - 0.8 * v, p + v], [u + 0.3 * v, u - 0.9 * v, 0.4 * u + v])
    through = lines([p, p], [u + v + w, 0.3 * u - v + 2 * w])
    return np.concatenate([in_plane, through])


def special(rng: Rng) -> Array:
    p, d = rng.normal(size=3), unit(rng)
    return lines(p + np.linspace(-2, 2, 6)[:, None] * d, unit(rng, 6))


def special_at_infinity(rng: Rng) -> Array:
    u, v, _ = frame(rng)
    angles = np.array([0.1, 0.7, 1.3, 1.8, 2.4, 3.0])[:, None]
    return lines(rng.normal(size=(6, 3)), np.cos(angles) * u + np.sin(angles) * v)


def general(rng: Rng) -> Array:
    pitch, points = 0.8, rng.normal(size=(6, 3))
    # Normal to the velocity field of the screw: h e + e × p.
    field = pitch * np.array([0.0, 0.0, 1.0]) + np.cross([0.0, 0.0, 1.0], points)
    return lines(points, np.cross(field, unit(rng, 6)))


KINDS: list[tuple[Callable[[Rng], Array], str]] = [
    (same_line, "line"),
    (same_couple, "couple"),
    (pencil, "pencil"),
    (parallel_pencil, "parallel pencil"),
    (two_parallels_and_their_couple, "parallel pencil"),
    (three_couples, "couples"),
    (bundle, "bundle"),
    (parallel_bundle, "parallel bundle"),
    (plane, "plane"),
    (plane_with_its_couple, "plane"),
    (all_couples, "all couples"),
    (two_pencils, "two pencils"),
    (regulus, "regulus"),
    (paraboloid, "paraboloid"),
    (hyperbolic, "hyperbolic congruence"),
    (hyperbolic_at_infinity, "hyperbolic congruence"),
    (elliptic, "elliptic congruence"),
    (parabolic, "parabolic congruence"),
    (degenerate, "degenerate congruence"),
    (special, "special complex"),
    (special_at_infinity, "special complex"),
    (general, "general complex"),
]


def reciprocal(rows: Array, axis: Screw) -> Array:
    """Work of rows [F, T about 0] on the twist about a screw."""
    e = np.array(axis.direction)
    if axis.point is None:
        return rows[:, :3] @ e
    v = np.cross(axis.point, e) + axis.pitch * e
    return rows[:, :3] @ v + rows[:, 3:] @ e


def checked(rows: Array, found: Circuit, size: float) -> None:
    """What the variety says is true of every row."""
    v = found.variety
    sizes = np.linalg.norm(rows[:, :3], axis=1)
    real = rows[sizes > 0.0]
    slack = 1e-6 * size
    if v.kind in ("pencil", "bundle"):
        assert v.point is not None
        np.testing.assert_allclose(np.cross(v.point, real[:, :3]), real[:, 3:], atol=slack)
    if v.normal is not None and v.kind != "degenerate congruence":
        normal = np.array(v.normal)
        np.testing.assert_allclose(real[:, :3] @ normal, 0.0, atol=1e-6)
        if v.point is not None:
            about = real[:, 3:] - np.cross(v.point, real[:, :3])
            np.testing.assert_allclose(np.cross(about, normal), 0.0, atol=slack)
    if v.direction is not None and len(real) and v.kind != "degenerate congruence":
        np.testing.assert_allclose(np.cross(real[:, :3], v.direction), 0.0, atol=1e-6)
    if v.kind == "degenerate congruence":
        assert v.point is not None
        assert v.normal is not None
        through = np.linalg.norm(np.cross(v.point, real[:, :3]) - real[:, 3:], axis=1)
        about = real[:, 3:] - np.cross(v.point, real[:, :3])
        within = (
            np.abs(real[:, :3] @ v.normal)
            + np.linalg.norm(np.cross(about, v.normal), axis=1) / size
        )
        assert (np.minimum(through / size, within) < 1e-5).all()
    wanted = {"hyperbolic congruence": 2, "parabolic congruence": 1, "two pencils": 1}
    wanted |= {"special complex": 1, "general complex": 1}
    assert len(v.axes) == wanted.get(v.kind, 0)
    for axis in v.axes:
        np.testing.assert_allclose(reciprocal(rows, axis), 0.0, atol=2e-5 * size)
        if v.kind != "general complex":
            assert axis.pitch in (0.0, np.inf)


@pytest.mark.parametrize(("construct", "kind"), KINDS)
def test_every_variety_is_named_wherever_it_stands(
    construct: Callable[[Rng], Array], kind: str
) -> None:
    for seed in range(12):
        rng = np.random.default_rng(seed)
        size = float(10.0 ** rng.uniform(-1, 3))
        here = construct(rng)
        rows = moved(here, turned(rng), size * rng.normal(size=3), size)
        found = geometry(rows, size, TOLERANCE)
        assert len(found.circuits) == 1, (seed, found)
        (circuit,) = found.circuits
        assert circuit.members == tuple(range(len(rows))), seed
        assert circuit.variety.kind == kind, (seed, circuit)
        assert circuit.measure < 1e-12
        assert found.rank == len(rows) - 1
        checked(rows, circuit, size)
        assert len(found.twists) == 6 - found.rank
        for twist in found.twists:
            work = rows[:, :3] @ np.array(twist[3:]) + rows[:, 3:] @ np.array(twist[:3])
            np.testing.assert_allclose(work, 0.0, atol=1e-9)


@pytest.mark.parametrize(("construct", "kind"), KINDS)
def test_a_variety_among_other_lines_is_found_and_belongs_to_no_other(
    construct: Callable[[Rng], Array], kind: str
) -> None:
    for seed in range(6):
        rng = np.random.default_rng(100 + seed)
        special_rows = construct(rng)
        count = len(special_rows)
        others = lines(rng.normal(size=(6 - count, 3)), unit(rng, 6 - count))
        order = rng.permutation(6)
        rows = np.concatenate([special_rows, others])[order]
        rows *= rng.uniform(0.2, 5.0, (6, 1))  # sizes and signs of wrenches mean nothing
        found = geometry(rows, 1.0, TOLERANCE)
        (circuit,) = found.circuits
        assert {int(order[n]) for n in circuit.members} == set(range(count))
        assert circuit.variety.kind == kind
        cancelled = np.array(circuit.weights) @ (
            rows[list(circuit.members)]
            / np.linalg.norm(rows[list(circuit.members)], axis=1, keepdims=True)
        )
        np.testing.assert_allclose(cancelled, 0.0, atol=1e-12)


@pytest.mark.parametrize(("construct", "kind"), KINDS)
def test_a_variety_that_is_missed_by_little_keeps_its_name(
    construct: Callable[[Rng], Array], kind: str
) -> None:
    for seed in range(6):
        rng = np.random.default_rng(200 + seed)
        rows = construct(rng)
        noise = rng.normal(size=rows.shape) * 1e-8
        noise[np.linalg.norm(rows[:, :3], axis=1) == 0.0] = 0.0
        found = geometry(rows + noise, 1.0, TOLERANCE)
        assert [circuit.variety.kind for circuit in found.circuits] == [kind]


def test_three_lines_that_are_nearly_dependent_are_nearly_a_pencil() -> None:
    """Whatever is left over: lines have no other way to be dependent in threes."""
    for seed in range(40):
        rng = np.random.default_rng(300 + seed)
        rows = pencil(rng) if seed % 2 else parallel_pencil(rng)
        size = 10.0 ** rng.uniform(-4, -1.5)
        about = np.cross(rows[:, :3], rows[:, 3:]) + size * rng.normal(size=(3, 3))
        tilted = lines(about, rows[:, :3] + size * rng.normal(size=(3, 3)))
        others = lines(rng.normal(size=(3, 3)), unit(rng, 3))
        found = geometry(np.concatenate([tilted, others]), 1.0, 0.1)
        for circuit in found.circuits:
            if circuit.members == (0, 1, 2):
                assert "pencil" in circuit.variety.kind


def test_independent_lines_have_no_circuit_and_no_free_twist() -> None:
    for seed in range(50):
        rng = np.random.default_rng(seed)
        found = geometry(lines(rng.normal(size=(6, 3)), unit(rng, 6)), 1.0, TOLERANCE)
        assert found.rank == 6
        assert found.circuits == found.twists == found.screws == ()


def test_two_dependences_at_a_time() -> None:
    rng = np.random.default_rng(7)
    u, _, w = np.eye(3)
    rows = np.concatenate([pencil(rng), bundle(rng)[:1], lines([u, u], [w, -w])])
    found = geometry(rows, 1.0, TOLERANCE)
    assert found.rank == 4
    kinds = {circuit.members: circuit.variety.kind for circuit in found.circuits}
    assert kinds == {(4, 5): "line", (0, 1, 2): "pencil"}
    assert len(found.twists) == 2


def test_a_wrench_that_vanishes_is_a_circuit_by_itself() -> None:
    rng = np.random.default_rng(8)
    rows = lines(rng.normal(size=(6, 3)), unit(rng, 6))
    rows[3] = 0.0
    (circuit,) = geometry(rows, 1.0, TOLERANCE).circuits
    assert circuit.members == (3,)
    assert circuit.variety.kind == "zero"


def test_more_than_six_wrenches_are_always_dependent() -> None:
    rng = np.random.default_rng(9)
    found = geometry(lines(rng.normal(size=(8, 3)), unit(rng, 8)), 1.0, TOLERANCE)
    assert found.rank == 6
    assert [len(circuit.members) for circuit in found.circuits] == [7, 7]
    assert {circuit.variety.kind for circuit in found.circuits} == {"space"}


def test_wrenches_with_a_pitch_are_no_lines() -> None:
    rng = np.random.default_rng(10)
    basis = rng.normal(size=(2, 6))
    rows = np.array([basis[0], basis[1], basis[0] + basis[1]])
    assert variety(rows, 1.0).kind == "screws"


def test_the_reference_point_changes_no_answer_but_the_numbers_of_moments() -> None:
    rng = np.random.default_rng(11)
    for construct, _ in KINDS:
        rows = construct(rng)
        shift = np.array([0.4, -0.3, 0.6])
        about = rows.copy()
        about[:, 3:] -= np.cross(shift, rows[:, :3])
        here, there = geometry(rows, 1.0, TOLERANCE), geometry(about, 1.0, TOLERANCE, shift)
        assert here.circuits[0].variety.kind == there.circuits[0].variety.kind
        a, b = here.circuits[0].variety, there.circuits[0].variety
        if a.kind in ("pencil", "bundle"):
            np.testing.assert_allclose(a.point, b.point, atol=1e-8)


# --- screws --------------------------------------------------------------------------------


@given(
    st.integers(0, 10_000),
    st.sampled_from([0.0, 12.3, -0.4]),
)
def test_a_screw_gives_its_axis_and_pitch_back(seed: int, pitch: float) -> None:
    rng = np.random.default_rng(seed)
    e, place, about = unit(rng), 50.0 * rng.normal(size=3), 50.0 * rng.normal(size=3)
    v = np.cross(place - about, e) + pitch * e
    found = screw(rng.uniform(0.1, 3.0) * np.concatenate([e, v]), 20.0, about)
    np.testing.assert_allclose(np.cross(found.direction, e), 0.0, atol=1e-12)
    assert found.point is not None
    np.testing.assert_allclose(np.cross(found.point - place, e), 0.0, atol=1e-9)
    assert abs((found.point - about) @ e) < 1e-9  # the nearest point to the reference
    assert found.pitch == pytest.approx(pitch, abs=1e-9)


def test_a_translation_has_no_point() -> None:
    found = screw([0.0, 0.0, 0.0, 0.0, -3.0, 0.0], 10.0, np.zeros(3))
    assert found == Screw((0.0, 1.0, 0.0), None, np.inf)
    assert found.translation
