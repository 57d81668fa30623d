"""Local forward kinematics of the 5-RPUR: polish a guess, or follow the current assembly mode.

Unknowns are (X, y, Z, φ, θ) and w_i, with X, Z the position of O' and w_i the z' coordinate of
B_i in the base frame turned by R_y(−θ). With a_i, b_i the x', z' coordinates of A_i, each limb is
two quadrics (from Tale Masouleh et al., Meccanica 46 (2011), eqs. 3-6):

    F1: (X + s'_ix − a_i)² + (w_i − b_i)² = ρ_i²        P_i² + p_i² = ρ_i²
    F2: (y + C s'_iy − S s'_iz − r_iy)² + (Z + S s'_iy + C s'_iz − w_i)² = l_i²
                                                         Y_i² + q_i² = l_i²

The combination q_i dF1 + p_i dF2 is free of dw_i, so every Newton step and every tangent is one
small linear solve. In this form a limb may pass v_i ∥ e1 (q_i = 0) smoothly, where its working
mode σ_i = sign q_i changes by itself; only parallel singularities stop a motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cbrt, cos, inf, isfinite, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kinematics.errors import InputError
from kinematics.five_rpur.design import LIMBS, SUBSCRIPTS, FiveRPURDesign
from kinematics.five_rpur.inverse import (
    STROKE_SLACK,
    joint_points,
    posture,
    wrap_angle,
)
from kinematics.solutions import Followed, Posture, Stop
from kinematics.spatial import Array, finite

_TOLERANCE = 1e-11  # mm, of the closure equations while tracking; ends are polished further
_SINGULAR = 1e-12  # of the largest possible value, for a determinant that is only rounding
_BEFORE = 1e-6  # part of the way by which a motion stops before a singularity

# Step control; steps are in units of the link length and of a radian.
_FIRST, _LONGEST, _SHORTEST = 0.1, 0.25, 1e-9
_LEAVES = 0.1  # largest correction, as a part of the step: more might be another branch
_CONTRACTS = 0.25  # largest ratio of the second Newton step to the first
_TURNS = 0.95  # smallest cosine between the tangents at both ends of a step
_MOST_STEPS = 2000
_MOST_ROUNDS = 60  # of a search within one step

_TARGET: Stop = "target"
_LAMBDA = 5  # the last unknown: how far along the line in joint space, mm
_LAMBDA_FIXED = np.eye(6)[_LAMBDA]


def polish(
    design: FiveRPURDesign, pose: Sequence[float] | ArrayLike, mode: str, joints: ArrayLike
) -> Posture | None:
    """The posture with the given lengths that Newton's method reaches from a guess.

    Args:
        pose: the guess, (x, y, z, φ, θ) in mm and rad.
        mode: the working mode in which B_i start; where a limb cannot close at the guess, its
            link starts along e1. The solution's mode is what it came out as.
        joints: ρ_1 … ρ_5, mm.

    Returns:
        None where Newton's method does not converge: at a parallel singularity, or from too far.

    Raises:
        InputError: not five finite numbers, or five signs.
    """
    rho = finite(joints, name="the joints", last=LIMBS)
    line = _Line.of(design, rho, np.zeros(LIMBS))
    found = _correct(line, _start(design, pose, mode), _LAMBDA_FIXED, rounds=40)
    return None if found is None else _as_posture(line, _polished(line, found.point), mode)


def follow(design: FiveRPURDesign, start: Posture, joints: ArrayLike) -> Followed:
    """Move the actuators on a straight line to ``joints``, the platform on its assembly mode.

    Wanted lengths beyond a stroke are cut off at its end; a limb that is beyond its stroke
    already may stay there or come back, but not go further. The motion stops just before a
    parallel singularity (a fold, where two assembly modes merge, or a crossing of branches).
    It never jumps to another branch: a step that Newton's method corrects by more than a tenth
    of its length is taken again, shorter.

    Args:
        start: the posture now; pose and working mode count, its lengths follow from them.
        joints: ρ_1 … ρ_5 wanted, mm.

    Returns:
        The posture reached and what stopped it; ``text`` also tells which limbs passed into
        another working mode. ``fraction`` is measured in joint space.

    Raises:
        InputError: not five finite numbers.
    """
    wanted = finite(joints, name="the joints", last=LIMBS)
    if wanted.shape != (LIMBS,):
        raise InputError("one set of 5 joints can be followed at a time")
    first = _start(design, start.pose, start.mode)
    rho = _lengths(design, first)
    if not (start.closes and np.isfinite(rho).all()):
        return _not_closed(design, start)
    low = np.minimum(design.stroke[:, 0], rho)
    high = np.maximum(design.stroke[:, 1], rho)
    aim = np.clip(wanted, low, high)
    beyond = np.abs(wanted - aim)
    blocked = int(beyond.argmax()) if beyond.max() > STROKE_SLACK else None
    way = float(np.linalg.norm(aim - rho))
    share = 1.0 if blocked is None else way / float(np.linalg.norm(wanted - rho))
    if way <= 1e-14 * float(np.abs(rho).max()):
        moved, stop, fraction, events, undetermined = start, _TARGET, 1.0, list[int](), False
    else:
        line = _Line.of(design, rho, (aim - rho) / way)
        end = _track(line, first, way)
        stop, events, undetermined = end.stop, end.events, end.undetermined
        moved = start if end.point is first else _as_posture(line, end.point, start.mode)
        fraction = 1.0 if stop == "target" else float(end.point.u[_LAMBDA]) / way
    text, limb = "", None
    if undetermined:
        text = _UNDETERMINED
    elif stop == "singularity":
        text = _singularity_text(aim - rho, moved, fraction * share)
    elif stop == "stalled":
        text = f"could not be followed further than {100 * fraction * share:.3g} % of the way"
    elif blocked is not None:
        stop, limb = "stroke", blocked + 1
        text = _stroke_text(design, blocked, float(wanted[blocked]))
    text = "; ".join(part for part in (_events_text(start.mode, moved.mode, events), text) if part)
    return Followed(moved, stop, text, fraction * share, limb)


# --- what is said --------------------------------------------------------------------------


def _not_closed(design: FiveRPURDesign, start: Posture) -> Followed:
    here = posture(design, start.pose, start.mode)
    limbs = [str(i + 1) for i, rho in enumerate(here.joints) if not np.isfinite(rho)]
    which = f"limb {limbs[0]}" if len(limbs) == 1 else f"limbs {', '.join(limbs)}"
    text = (
        f"{which} cannot close at this pose, so there is no assembly mode to follow; "
        "move the platform to a pose that the machine can hold"
    )
    return Followed(here, "stalled", text, 0.0)


_UNDETERMINED = (
    "the machine stands in a parallel singularity, where its actuators do not determine how it "
    "moves; move the platform out of it first"
)


def _singularity_text(move: Array, reached: Posture, fraction: float) -> str:
    moving = np.flatnonzero(np.abs(move) > STROKE_SLACK)
    if len(moving) == 1:
        i = int(moving[0])
        where = "beyond" if move[i] > 0 else "below"
        return (
            f"stopped at a parallel singularity: ρ{SUBSCRIPTS[i]} cannot go {where} "
            f"{reached.joints[i]:.1f} mm on this assembly mode"
        )
    return f"stopped at a parallel singularity after {100 * fraction:.3g} % of the way"


def _stroke_text(design: FiveRPURDesign, i: int, wanted: float) -> str:
    low, high = design.limbs[i].stroke
    name, end = ("max", high) if wanted > high else ("min", low)
    return f"limb {i + 1} is at the end of its stroke (ρ{SUBSCRIPTS[i]} {name} = {end:g} mm)"


def _events_text(before: str, after: str, events: Sequence[int]) -> str:
    parts = []
    for i in dict.fromkeys(events):
        if before[i] != after[i]:
            parts.append(f"limb {i + 1} passed into working mode {_shown(after[i])}")
        else:
            other = "-" if before[i] == "+" else "+"
            parts.append(f"limb {i + 1} passed into working mode {_shown(other)} and back")
    return "; ".join(parts)


def _shown(sign: str) -> str:
    return "+" if sign == "+" else "−"


# --- the line, the equations, one Newton correction -----------------------------------------


class _Point(NamedTuple):
    """(X, y, Z, φ, θ, λ) and w, in mm and rad."""

    u: Array
    w: Array


@dataclass(frozen=True, slots=True)
class _Line:
    """The joints rho + λ direction of a design, with what the equations need at hand."""

    design: FiveRPURDesign
    rho: Array
    direction: Array
    limbs: tuple[tuple[float, ...], ...]  # numbers, as five limbs are too few for array calls
    length: float
    scale: Array
    tolerance: float

    @classmethod
    def of(cls, design: FiveRPURDesign, rho: Array, direction: Array) -> _Line:
        length = float(design.link.mean())
        size = max(float(np.abs(v).max()) for v in (design.base, design.platform, rho))
        # The last factor makes the rows of one order, without the poles of 1/ρ.
        rows = 1.0 / (design.link * np.maximum(rho, design.link))
        columns = (design.base, design.platform, design.link, rho, direction, rows)
        return cls(
            design=design,
            rho=rho,
            direction=direction,
            limbs=tuple(tuple(limb) for limb in np.column_stack(columns).tolist()),
            length=length,
            scale=np.array([length, length, length, 1.0, 1.0, length]),
            tolerance=max(_TOLERANCE, 256 * float(np.finfo(float).eps) * size),
        )


class _Linear(NamedTuple):
    """The equations at a point: matrix · du = −residual, dw = constant + slope · du."""

    matrix: Array  # (5, 6), scaled: du in units of the link length and of a radian
    residual: Array  # (5,)
    constant: Array  # (5,) mm
    slope: Array  # (5, 6) mm
    q: tuple[float, ...]
    error: float  # mm, of the closure equations


def _linear(line: _Line, point: _Point) -> _Linear:
    x, y, z, phi, theta, along = point.u.tolist()
    c, s, cf, sf = cos(theta), sin(theta), cos(phi), sin(phi)
    unit = line.length
    matrix, residual, constant, slope, heights = [], [], [], [], []
    error = 0.0
    for (rx, ry, rz, sx, sy, sz, link, rho_0, dr, row), w in zip(
        line.limbs, point.w.tolist(), strict=True
    ):
        a, b = rx * c - rz * s, rx * s + rz * c
        my, mz = cf * sy - sf * sz, sf * sy + cf * sz
        rho = rho_0 + along * dr
        big_p, p = x + sx - a, w - b
        big_y, q = y + my - ry, z + mz - w
        r1 = 0.5 * (big_p * big_p + p * p - rho * rho)
        r2 = 0.5 * (big_y * big_y + q * q - link * link)
        error = max(error, abs(r1) / max(abs(rho), 1e-9), abs(r2) / link)
        # dF1 = P dX + turn dθ − ρ dρ + p dw,  dF2 = Y dy + q dZ + tilt dφ − q dw
        turn, tilt, drho = big_p * b - p * a, q * my - big_y * mz, rho * dr * unit
        qr, pr = q * row, p * row
        matrix.append(
            (qr * big_p * unit, pr * big_y * unit, pr * q * unit, pr * tilt, qr * turn, -qr * drho)
        )
        residual.append(qr * r1 + pr * r2)
        if abs(p) >= abs(q):  # dw from the equation with the larger pivot
            pivot = p or 1e-300
            constant.append(-r1 / pivot)
            slope.append((-big_p * unit / pivot, 0.0, 0.0, 0.0, -turn / pivot, drho / pivot))
        else:
            constant.append(r2 / q)
            slope.append((0.0, big_y * unit / q, unit, tilt / q, 0.0, 0.0))
        heights.append(q)
    return _Linear(
        np.array(matrix),
        np.array(residual),
        np.array(constant),
        np.array(slope),
        tuple(heights),
        error,
    )


class _Corrected(NamedTuple):
    point: _Point
    linear: _Linear  # at the point
    moved: float  # how far from the guess, scaled


def _correct(
    line: _Line, guess: _Point, border: Array, *, rounds: int = 6, strict: bool = False
) -> _Corrected | None:
    """Newton's method on the equations and border · (u − guess) = 0; None if it fails."""
    point, moved, before = guess, 0.0, inf
    for turn in range(rounds):
        linear = _linear(line, point)
        if linear.error <= line.tolerance:
            return _Corrected(point, linear, moved)
        step = _newton_step(line, linear, border)
        if step is None or (strict and turn == 1 and step.size > _CONTRACTS * before):
            return None
        point = _Point(point.u + step.du, point.w + step.dw)
        moved, before = moved + step.size, step.size
    return None


class _Step(NamedTuple):
    du: Array  # mm and rad
    dw: Array  # mm
    size: float  # scaled


def _newton_step(line: _Line, linear: _Linear, border: Array) -> _Step | None:
    system, right = np.empty((6, 6)), np.zeros(6)
    system[:5], system[5], right[:5] = linear.matrix, border, -linear.residual
    try:
        du = np.linalg.solve(system, right)
    except np.linalg.LinAlgError:
        return None
    dw = linear.constant + linear.slope @ du
    size = sqrt(float(du @ du + dw @ dw / line.length**2))
    return _Step(line.scale * du, dw, size) if isfinite(size) else None


def _polished(line: _Line, point: _Point) -> _Point:
    """A few more Newton steps at fixed lengths, down to rounding."""
    best, error = point, inf
    for _ in range(4):
        linear = _linear(line, point)
        if linear.error >= error:
            break
        best, error = point, linear.error
        step = _newton_step(line, linear, _LAMBDA_FIXED)
        if step is None:
            break
        point = _Point(point.u + step.du, point.w + step.dw)
    return best


# --- along the line ------------------------------------------------------------------------


class _Place(NamedTuple):
    """A point on the path, its unit tangent (scaled), dw along it, the normalised determinant."""

    point: _Point
    tangent: Array
    elbow: Array
    determinant: float
    q: tuple[float, ...]


class _End(NamedTuple):
    point: _Point
    stop: Stop
    events: list[int]  # limbs whose q changed sign, in order
    undetermined: bool = False  # the path begins in a singularity


def _place(point: _Point, linear: _Linear, along: Array | None) -> _Place | None:
    """The tangent continues ``along``; without that it leads to larger λ."""
    if along is None:
        tangent: Array = np.linalg.svd(linear.matrix)[2][-1]
        tangent = tangent if tangent[_LAMBDA] >= 0 else -tangent
    else:
        try:
            tangent = np.linalg.solve(np.vstack([linear.matrix, along]), _LAMBDA_FIXED)
        except np.linalg.LinAlgError:
            return None
        tangent = tangent / sqrt(float(tangent @ tangent))
    elbow = linear.slope @ tangent
    if not isfinite(float(tangent.sum() + elbow.sum())):
        return None
    square = linear.matrix[:, :5]
    norms = float(np.sqrt((square * square).sum(axis=1)).prod())
    determinant = float(np.linalg.det(square)) / norms if norms > 0.0 else 0.0
    return _Place(point, tangent, elbow, determinant, linear.q)


def _ahead(line: _Line, here: _Place, step: float, last: tuple[_Place, float] | None) -> _Point:
    """A step along the tangent, bent as the path was bent over the step before."""
    du, dw = step * here.tangent, step * here.elbow
    if last is not None:
        place, length = last
        bend = 0.5 * step * step / length
        du = du + bend * (here.tangent - place.tangent)
        dw = dw + bend * (here.elbow - place.elbow)
    return _Point(here.point.u + line.scale * du, here.point.w + dw)


def _track(line: _Line, first: _Point, way: float) -> _End:
    """Follow the path from λ = 0 to λ = way by its arc length, so that folds are regular."""
    events: list[int] = []
    here = _place(first, _linear(line, first), None)
    if here is None or abs(here.determinant) < _SINGULAR or here.tangent[_LAMBDA] <= 0.0:
        return _End(first, "singularity", events, undetermined=True)
    step, last = _FIRST, None
    for _ in range(_MOST_STEPS):
        rest = (way - float(here.point.u[_LAMBDA])) / (line.length * here.tangent[_LAMBDA])
        final = rest <= step
        step = min(step, rest)
        border = _LAMBDA_FIXED if final else here.tangent
        guess = _ahead(line, here, step, last)
        if final:
            guess.u[_LAMBDA] = way
        found = _correct(line, guess, border, strict=True)
        there = None
        if found is not None and found.moved <= _LEAVES * step + line.tolerance:
            there = _place(found.point, found.linear, here.tangent)
        if found is None or there is None or there.tangent @ here.tangent < _TURNS:
            step *= 0.4
            if step < _SHORTEST:
                break
            continue
        if there.determinant * here.determinant <= 0:
            return _stop_in(line, here, there, way, events)
        if not final and there.point.u[_LAMBDA] >= way:
            near = _search(line, here, there, lambda p: way - float(p.point.u[_LAMBDA]))
            return _target(line, here, near, way, events)
        _note(events, here, there)
        if final:
            return _End(_polished(line, there.point), "target", events)
        last = (here, step)
        here = there
        # The correction grows with the cube of the step.
        step = min(_LONGEST, step * min(2.0, cbrt(0.3 * _LEAVES * step / max(found.moved, 1e-12))))
    return _End(_polished(line, here.point), "stalled", events)


def _note(events: list[int], before: _Place, after: _Place) -> None:
    events += [i for i, (q, r) in enumerate(zip(before.q, after.q, strict=True)) if q * r < 0]


def _target(line: _Line, here: _Place, near: _Place, way: float, events: list[int]) -> _End:
    """Close the last gap to λ = way from a place next to it."""
    guess = _Point(near.point.u.copy(), near.point.w)
    guess.u[_LAMBDA] = way
    found = _correct(line, guess, _LAMBDA_FIXED, strict=True)
    point = near.point if found is None else found.point
    there = _place(point, _linear(line, point), here.tangent)
    if there is not None:
        _note(events, here, there)
    return _End(_polished(line, point), "target", events)


def _stop_in(line: _Line, here: _Place, there: _Place, way: float, events: list[int]) -> _End:
    """Between two places the determinant changes its sign: stop just before, or at the target."""
    start = here.determinant
    edge = _search(line, here, there, lambda p: p.determinant / start)
    top = float(edge.point.u[_LAMBDA])
    if top >= way:
        near = _search(line, here, edge, lambda p: way - p.point.u[_LAMBDA])
        return _target(line, here, near, way, events)
    gap = _BEFORE * way
    if top - here.point.u[_LAMBDA] <= gap:
        return _End(here.point, "singularity", events)

    def rest(place: _Place) -> float:  # nearly straight in arc length, unlike λ itself
        return float(np.sqrt(max(top - place.point.u[_LAMBDA], 0.0)) - np.sqrt(gap))

    before = _search(line, here, edge, rest, enough=0.1 * float(np.sqrt(gap)))
    if before.determinant * start <= 0:  # the gap is below what rounding resolves
        before = here
    _note(events, here, before)
    return _End(_polished(line, before.point), "singularity", events)


def _search(
    line: _Line,
    here: _Place,
    there: _Place,
    value: Callable[[_Place], float],
    enough: float = 0.0,
) -> _Place:
    """A place between the two where ``value``, which changes its sign, vanishes.

    The Illinois method over the way along here's tangent.
    """
    far = float((there.point.u - here.point.u) @ (here.tangent / line.scale))
    low, high = (0.0, here, value(here)), (far, there, value(there))
    last = far
    for _ in range(_MOST_ROUNDS):
        (s0, p0, v0), (s1, p1, v1) = low, high
        if v0 == v1:
            break
        s = s0 + (s1 - s0) * v0 / (v0 - v1)
        part = (s - s0) / (s1 - s0)
        guess = _Point(
            p0.point.u + part * (p1.point.u - p0.point.u),
            p0.point.w + part * (p1.point.w - p0.point.w),
        )
        found = _correct(line, guess, here.tangent)
        place = None if found is None else _place(found.point, found.linear, here.tangent)
        if place is None:
            break
        v = value(place)
        if abs(v) <= enough or abs(s - last) <= 1e-10 * far:
            return place
        last = s
        # The end that stays is weighed down, or the search would creep towards it.
        if (v > 0) == (low[2] > 0):
            low, high = (s, place, v), (s1, p1, 0.5 * v1)
        else:
            low, high = (s0, p0, 0.5 * v0), (s, place, v)
    return low[1]


# --- between points and postures -----------------------------------------------------------


def _start(design: FiveRPURDesign, pose: object, mode: str) -> _Point:
    """The point of a pose; B_i as the working mode says, with its link along e1 if it must."""
    values = finite(pose, name="a pose", last=5)
    if values.shape != (5,):
        raise InputError("one pose of 5 numbers (x, y, z, φ, θ) is needed")
    x, y, z, phi, theta = values.tolist()
    _, elbow, tip = joint_points(design, values, mode)
    c, s = cos(theta), sin(theta)
    w = elbow[:, 0] * s + elbow[:, 2] * c
    w = np.where(np.isfinite(w), w, tip[:, 0] * s + tip[:, 2] * c)
    return _Point(np.array([x * c - z * s, y, x * s + z * c, phi, theta, 0.0]), w)


def _lengths(design: FiveRPURDesign, point: _Point) -> Array:
    """ρ of a point (F1)."""
    x, theta = float(point.u[0]), float(point.u[4])
    c, s = cos(theta), sin(theta)
    a = design.base[:, 0] * c - design.base[:, 2] * s
    b = design.base[:, 0] * s + design.base[:, 2] * c
    lengths: Array = np.hypot(x + design.platform[:, 0] - a, point.w - b)
    return lengths


def _as_posture(line: _Line, point: _Point, mode: str) -> Posture:
    """The posture of a point; its working mode is sign q, where q = 0 the one before."""
    x, y, z, phi, theta, along = point.u.tolist()
    c, s = cos(theta), sin(theta)
    phi, theta = wrap_angle([phi, theta]).tolist()
    q = _linear(line, point).q
    mode = "".join(
        old if v == 0.0 else "+" if v > 0 else "-" for v, old in zip(q, mode, strict=True)
    )
    pose = (x * c + z * s, y, z * c - x * s, phi, theta)
    return posture(line.design, pose, mode, known=line.rho + along * line.direction)
