"""What is proven of pieces of curve: bounds that hold, one curve and no other, turns counted."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.designs.files import load_design
from kinematics.facets.inverse import posture
from kinematics.homotopy.continuation import ahead
from kinematics.homotopy.curve import LAMBDA, Curve, Middle, Piece, Place
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from tests.kinematics.mechanisms.five_rpur.asked import inverse_jacobian
from tests.kinematics.mechanisms.five_rpur.machines import following, forward, preset
from tests.kinematics.references import read

FOLDS: dict[str, Any] = read("rpur_folds.json")


@cache
def solutions(name: str, seed: int) -> tuple[FiveRPURDesign, tuple[Posture, ...]]:
    """All assembly modes (of a simplified design those with each arrangement in one mode)."""
    design = preset(name)
    assert isinstance(design, FiveRPURDesign)
    rng = np.random.default_rng(seed)
    found = forward(design, rng.uniform(260, 390, 5))[0]
    while len(found) < 10:
        found = forward(design, rng.uniform(260, 390, 5))[0]
    assert found.complete
    pairs = zip(found.poses.tolist(), found.modes, strict=True)
    return design, tuple(posture(design, tuple(pose), mode) for pose, mode in pairs)


class Line(NamedTuple):
    """Joints ``now`` + λ ``direction``, λ in mm / unit, and the curve of configurations there."""

    curve: Curve
    first: Array
    design: FiveRPURDesign
    unit: float
    now: Array
    direction: Array


def line_through(design: FiveRPURDesign, at: Posture, direction: Array) -> Line:
    facet = following(design)
    direction = direction / np.linalg.norm(direction)
    first, now = facet._start(at)
    curve, point = facet._curve(at.mode, first, now, direction)
    return Line(curve, point, design, facet.unit, now, direction)


def place_of(line: Line, at: Posture) -> Place:
    """Where a posture with the line's first joints is, towards larger λ."""
    here = line.curve.first(np.append(following(line.design).unknowns(at.pose, at.mode), 0.0))
    assert here is not None
    return here


def step(line: Line, here: Place, size: float) -> Place | None:
    found = line.curve.correct(ahead(here, size, None), here.tangent, strict=True)
    return None if found is None else line.curve.place(*found, here.tangent)


def pieces(count: int) -> list[tuple[Line, Place, Place, Piece]]:
    """Proven pieces of random curves, of lengths from 0.003 to 0.3."""
    rng = np.random.default_rng(1)
    found: list[tuple[Line, Place, Place, Piece]] = []
    names = ("rpur-a1a2", "rpur-mpa3", "rpur-a3a3")
    while len(found) < count:
        design, postures = solutions(names[len(found) % 3], seed=4)
        at = postures[rng.integers(len(postures))]
        line = line_through(design, at, rng.normal(size=5))
        here = place_of(line, at)
        there = step(line, here, float(0.3 * 0.01 ** rng.uniform()))
        if there is not None:
            piece = line.curve.piece(here, there)
            if piece is not None:
                found.append((line, here, there, piece))
    return found


# --- the bounds ----------------------------------------------------------------------------

COUNT = 13  # X, y, Z, cos φ, sin φ, cos θ, sin θ, w_i, λ


def equations(line: Line, x: Array) -> Array:
    """F1 and F2 limb by limb, halved, in units of the link length, as the papers have them.

    Before them the circles of cosines and sines. At real or complex x (13, n).
    """
    design, unit = line.design, line.unit
    cf, sf, c, s = x[3:7]
    rows = [0.5 * (cf**2 + sf**2 - 1.0), 0.5 * (c**2 + s**2 - 1.0)]
    for i in range(5):
        rx, ry, rz = design.base[i] / unit
        sx, sy, sz = design.platform[i] / unit
        rho = line.now[i] / unit + x[12] * line.direction[i]
        across, up = x[0] + sx - rx * c + rz * s, x[7 + i] - rx * s - rz * c
        side = x[1] + cf * sy - sf * sz - ry
        over = x[2] + sf * sy + cf * sz - x[7 + i]
        rows.append(0.5 * (across**2 + up**2 - rho**2))
        rows.append(0.5 * (side**2 + over**2 - (design.link[i] / unit) ** 2))
    return np.array(rows)


def jacobians(line: Line, x: Array) -> Array:
    """(n, 12, 13) at x (13, n), exact but for rounding by the complex step."""
    tiny = 1e-30
    columns = [equations(line, x + 1j * tiny * e[:, None]).imag / tiny for e in np.eye(COUNT)]
    return np.stack(columns, axis=-1).transpose(1, 0, 2)


def bent(line: Line, x: Array, along: Array) -> Array:
    """d²F twice along (n, 13) at x (13, n): (n, 12)."""
    small = 1e-5
    on, back = jacobians(line, x + small * along.T), jacobians(line, x - small * along.T)
    answer: Array = np.einsum("nij,nj->ni", on - back, along) / (2 * small)
    return answer


def middle_of(line: Line, piece: Piece) -> Middle:
    middle = line.curve.middle(piece.here.point + 0.5 * piece.chord, piece.border)
    assert middle is not None
    return middle


def test_the_bounds_hold_where_they_must() -> None:
    """Of the equations on the chord, of the Jacobian near it and of the tangents there."""
    rng = np.random.default_rng(2)
    closest = 0.0
    for line, here, there, piece in pieces(20):
        middle = middle_of(line, piece)
        along = middle.bend @ piece.chord
        spread = 0.5 * np.abs(along) + middle.size @ piece.radius
        missing = 0.125 * np.abs(along @ piece.chord) + middle.weight @ middle.error
        # Points of the tube, its corners too.
        part = rng.uniform(0, 1, 40)
        part[:2] = 0.0, 1.0
        chord = piece.here.point[:, None] + part * piece.chord[:, None]
        off = rng.choice([-1.0, 1.0, 0.3], (COUNT, 40)) * piece.radius[:, None]
        jacobian = np.concatenate(
            [jacobians(line, chord + off), np.broadcast_to(0.0, (40, 1, COUNT))], axis=1
        )
        jacobian[:, 12] = piece.border
        excess = np.abs(middle.inverse @ jacobian - np.eye(COUNT))
        assert (excess <= spread * (1 + 1e-9) + 1e-12).all()
        closest = max(closest, float((excess / np.maximum(spread, 1e-12)).max()))
        value = np.abs(middle.inverse[:, :12] @ equations(line, chord))
        assert (value <= missing[:, None] * (1 + 1e-9) + 1e-14).all()
        assert (missing + spread @ piece.radius < piece.radius).all()
        # d²F along the tangents, here by differences of exact Jacobians.
        tangents = np.linalg.solve(jacobian, np.eye(COUNT)[12][:, None])[..., 0]
        centre = np.broadcast_to(piece.here.point[:, None] + 0.5 * piece.chord[:, None], off.shape)
        gap = np.abs(bent(line, chord + off, tangents) - bent(line, centre, tangents))
        assert (gap <= 1e-7).all()
        assert here.slope * there.slope > 0 or piece.turns != 0
    assert closest > 0.3  # bounds that are far too wide would prove little


# --- one curve, and no other -----------------------------------------------------------------


def test_a_piece_holds_all_of_the_curve_between_its_ends() -> None:
    """Fine steps from one end arrive at the other, always within the radius; turns as counted."""
    counted: dict[int | None, int] = {0: 0, 1: 0, None: 0}
    for line, here, there, piece in pieces(45):
        at, turns, count = here, 0, 40
        size = float(np.linalg.norm(piece.chord)) / count
        for n in range(1, count + 1):
            guess = ahead(at, size, None)
            found = line.curve.correct(_in_plane(guess, piece, n / count), piece.border)
            assert found is not None
            after = line.curve.place(*found, at.tangent)
            assert after is not None
            assert piece.holds(after.point)
            turns += at.slope * after.slope < 0
            at = after
        gap = np.abs(at.point - there.point)
        assert gap.max() < 1e-9
        assert piece.turns in (None, turns)
        counted[piece.turns] += 1
    assert counted[0] > 20


def _in_plane(guess: Array, piece: Piece, part: float) -> Array:
    """The guess moved along the chord into the plane at a part of it."""
    size = float(piece.chord @ piece.border)
    offset = float((guess - piece.here.point) @ piece.border)
    return guess + (part * size - offset) / size * piece.chord


def test_whoever_starts_within_the_radius_ends_on_the_piece() -> None:
    """Each plane across holds one solution: Newton's method with A fixed finds it from anywhere."""
    rng = np.random.default_rng(3)
    for line, _, _, piece in pieces(9):
        middle = middle_of(line, piece)
        for part in (0.0, 0.3, 1.0):
            chord = piece.here.point + part * piece.chord
            x = chord[:, None] + rng.choice([-1.0, 1.0, 0.5], (COUNT, 12)) * piece.radius[:, None]
            before, rounding = np.inf, 1e-13 / float(piece.radius.min())
            for _ in range(60):
                across = piece.border @ (x - chord[:, None])
                x = x - middle.inverse @ np.vstack([equations(line, x), across])
                assert (np.abs(x - chord[:, None]) <= piece.radius[:, None]).all()
                spread = float((np.abs(x - x[:, :1]) / piece.radius[:, None]).max())
                assert spread <= max(before * (piece.effort + 1e-6), rounding)
                before = spread
            assert before <= rounding


@pytest.mark.parametrize(("name", "seed"), [("rpur-a1a2", 4), ("rpur-a3a3", 4), ("rpur-a2a2", 1)])
def test_different_assembly_modes_are_never_joined(name: str, seed: int) -> None:
    design, postures = solutions(name, seed)
    assert len(postures) >= 10
    rng = np.random.default_rng(5)
    line = line_through(design, postures[0], rng.normal(size=5))
    places = [place_of(line, p) for p in postures]
    for n, one in enumerate(places):
        for two in places[n + 1 :]:
            assert line.curve.piece(one, two) is None


@pytest.mark.parametrize("gap", [1.0, 1e-2, 1e-4, 1e-6])
def test_two_modes_next_to_their_fold_are_told_apart(gap: float) -> None:
    """On a line along the surface of folds, ``gap`` mm off it, they come near but never meet."""
    design, one, two, normal = beside_the_fold(gap)
    direction = np.random.default_rng(6).normal(size=5)
    direction -= normal * (normal @ direction)
    line = line_through(design, one, direction)
    curve = line.curve
    here, other = place_of(line, one), place_of(line, two)
    size = float(np.linalg.norm(other.point - here.point))
    assert 0.02 < size / np.sqrt(gap) < 0.5
    for sign in (1.0, -1.0):
        turned = Place(other.point, sign * other.tangent)
        back = Place(here.point, sign * here.tangent)
        assert curve.piece(here, turned) is None
        assert curve.piece(back, other) is None
    # And each goes its own way: a much shorter step is proven.
    for start in (here, other):
        after = step(line, start, 0.02 * size)
        assert after is not None
        assert curve.piece(start, after) is not None


@cache
def beside_the_fold(gap: float) -> tuple[FiveRPURDesign, Posture, Posture, Array]:
    """The reference fold's two modes, ``gap`` mm from the fold's surface, and its normal."""
    design = load_design("rpur-table1")
    assert isinstance(design, FiveRPURDesign)
    one, two, three, four, five = (replace(limb, stroke=(1.0, 2e3)) for limb in design.limbs)
    design = replace(design, limbs=(one, two, three, four, five))
    fold = FOLDS["folds"][0]
    rho, drho = np.array(FOLDS["rho0"]), np.array(FOLDS["drho"])
    start = next(
        p
        for p in (
            posture(design, tuple(pose), mode)
            for pose, mode in _near_the_fold(design, rho + (fold["t"] - 1.0) * drho)
        )
        if (f := following(design).fold_ahead(p, rho + (fold["t"] + 1.0) * drho)) is not None
        and np.abs(np.subtract(f.joints, fold["rho_fold"])).max() < 1e-6
    )
    normal = _normal(design, start, fold)
    inwards = normal if normal @ drho < 0 else -normal
    wanted = np.array(fold["rho_fold"]) + gap * inwards
    reached = following(design).follow(start, wanted)
    assert reached.stop == "target"
    ahead_of = following(design).fold_ahead(
        reached.posture, wanted - 2 * gap * inwards - 1e-3 * inwards
    )
    assert ahead_of is not None
    assert ahead_of.partner is not None
    return design, reached.posture, ahead_of.partner, normal


def _near_the_fold(design: FiveRPURDesign, rho: Array) -> list[tuple[list[float], str]]:
    found = forward(design, rho)[0]
    return list(zip(found.poses.tolist(), found.modes, strict=True))


def _normal(design: FiveRPURDesign, start: Posture, fold: dict[str, Any]) -> Array:
    """Of the surface of folds in joint space: J5's left null vector at the fold."""
    length = design.length
    jacobian = inverse_jacobian(design, fold["pose_fold"], start.mode)
    answer: Array = np.linalg.svd(jacobian / [1, 1, 1, length, length])[0][:, -1]
    return answer


def test_a_fold_within_a_piece_is_counted() -> None:
    """Along the line that hits the fold, both modes lie on one curve that turns once."""
    design, one, two, normal = beside_the_fold(1e-4)
    toward = np.array(FOLDS["folds"][0]["rho_fold"]) - one.joints
    line = line_through(design, one, toward)
    here, other = place_of(line, one), place_of(line, two)
    assert here.point[LAMBDA] == other.point[LAMBDA] == 0.0
    turned = Place(other.point, -other.tangent)
    piece = line.curve.piece(here, turned)
    assert piece is not None
    assert piece.turns == 1
    assert abs(toward @ normal) == pytest.approx(1e-4, rel=1e-3)
