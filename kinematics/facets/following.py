"""One assembly mode while the actuated joints move on a straight line, by its arc length.

A mechanism hands in its closure equations F(state, joints) = 0, as many as its state has freedoms
(`Closure`); states may be of any kind, steps of them are small vectors. In state and λ, how far
the joints have come along the line, the configurations are a curve. It is followed by steps
along its tangent and Newton's method across it (Allgower & Georg, Introduction to Numerical
Continuation Methods, 2003, ch. 6), through folds, where λ turns back and two assembly modes merge.

A step is taken only if it is certain enough: Newton's method converges at once and moves the
point little, the tangent hardly turns, and the determinant of the equations with the tangent as
their last row keeps its sign, which it does along any regular curve, but not from one branch to
another that crosses it or nearly does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from kinematics.answers.solutions import Fold, Followed, Posture, Stop
from kinematics.arrays import Array, finite
from kinematics.errors import InputError

S = TypeVar("S")

_LONGEST = 0.1  # a step
_FIRST = 0.02
_SHORTEST = 1e-9
_DRIFT = 0.1  # of a step: the largest correction
_CONTRACTS = 0.25  # largest ratio of the second correction to the first
_TURN = 0.98  # least cosine between the tangents before and after a step
_MOST_STEPS = 5000
_ROUNDS = 8
_BEFORE = 1e-6  # part of the way by which a motion stops before a singularity
_LEVEL = 1e-9  # dλ along the unit tangent that is none: the start stands in a fold
_STILL = 1e-14  # a way of this part of the joints is none
SLACK = 1e-9  # mm or rad by which a wanted joint may lie beyond its stroke


class Linear(NamedTuple):
    """Closure equations at a state, and their derivatives.

    Attributes:
        residual: (n,) in the unit of the steps.
        by_state: (n, n) by the components of a step.
        by_joints: (n, J) by the joints.
        error: the largest violation, mm.
    """

    residual: Array
    by_state: Array
    by_joints: Array
    error: float


class Closure(Protocol[S]):
    """What a mechanism hands in. Steps have no unit: 1 is a characteristic length or a radian."""

    @property
    def joint_unit(self) -> float:
        """What counts as a step of 1 in joint space: a length, mm, or 1 rad."""
        ...

    @property
    def tolerance(self) -> float:
        """mm of ``error`` below which the equations hold but for rounding."""
        ...

    def linear(self, state: S, joints: Array) -> Linear:
        """The equations at a state with joints (J,)."""
        ...

    def moved(self, state: S, step: Array) -> S:
        """The state a step (n,) away; to the first order in it the steps are a chart."""
        ...


# --- along the curve -----------------------------------------------------------------------


@dataclass(frozen=True, eq=False, slots=True)
class Place(Generic[S]):
    """A place on the curve: ``tangent`` (n + 1,) has length one, its last is dλ."""

    state: S
    along: float
    tangent: Array
    side: float

    @property
    def slope(self) -> float:
        """dλ along the tangent; changes its sign at a fold."""
        return float(self.tangent[-1])


@dataclass(frozen=True, eq=False, slots=True)
class Line(Generic[S]):
    """The joints ``start`` + λ ``direction``, λ in steps: (J,) each."""

    closure: Closure[S]
    start: Array
    direction: Array

    def joints(self, along: float) -> Array:
        joints: Array = self.start + along * self.direction
        return joints

    def linear(self, state: S, along: float) -> tuple[Array, Array, float]:
        """Residual (n,), derivatives (n, n + 1) by state and λ, and the error, mm."""
        at = self.closure.linear(state, self.joints(along))
        whole = np.column_stack([at.by_state, at.by_joints @ self.direction])
        return at.residual, whole, at.error

    def correct(
        self, state: S, along: float, border: Array, limit: float = np.inf
    ) -> tuple[S, float] | None:
        """Newton's method, square with border · step = 0; None where it fails or leaves."""
        first, total = np.inf, 0.0
        for turn in range(_ROUNDS):
            residual, whole, error = self.linear(state, along)
            step = _solve(whole, border, np.append(-residual, 0.0))
            if step is None:
                return None
            size = float(np.linalg.norm(step))
            total += size
            if total > limit or (turn == 1 and size > max(_CONTRACTS * first, 1e-12)):
                return None
            first = size if turn == 0 else first
            state, along = self.closure.moved(state, step[:-1]), along + float(step[-1])
            if error <= self.closure.tolerance and size < 1e-9:
                return state, along
        _, _, error = self.linear(state, along)
        return (state, along) if error <= self.closure.tolerance else None

    def place(self, state: S, along: float, like: Array) -> Place[S] | None:
        """The place there; its tangent points as ``like`` does."""
        _, whole, _ = self.linear(state, along)
        tangent = _solve(whole, like, np.append(np.zeros(len(like) - 1), 1.0))
        if tangent is None:
            return None
        tangent = tangent / np.linalg.norm(tangent)
        side = float(np.sign(np.linalg.det(np.vstack([whole, tangent]))))
        return Place(state, along, tangent, side)

    def first(self, state: S) -> Place[S] | None:
        """The place where λ = 0, with λ growing; None in a singularity."""
        _, whole, _ = self.linear(state, 0.0)
        if not np.isfinite(whole).all():
            return None
        _, sizes, vectors = np.linalg.svd(whole)
        if sizes[-1] <= 1e-12 * sizes[0] or abs(vectors[-1, -1]) <= _LEVEL:
            return None
        return self.place(state, 0.0, vectors[-1] * np.sign(vectors[-1, -1]))

    def ahead(self, here: Place[S], step: float) -> Place[S] | None:
        """The place a step further; None where that is not certain enough."""
        guess = self.closure.moved(here.state, step * here.tangent[:-1])
        along = here.along + step * here.slope
        found = self.correct(guess, along, here.tangent, _DRIFT * abs(step))
        if found is None:
            return None
        there = self.place(*found, here.tangent)
        if there is None or there.side != here.side or there.tangent @ here.tangent < _TURN:
            return None
        return there


def _solve(whole: Array, border: Array, right: Array) -> Array | None:
    try:
        answer = np.asarray(np.linalg.solve(np.vstack([whole, border]), right), dtype=float)
    except np.linalg.LinAlgError:
        return None
    return answer if np.isfinite(answer).all() else None


@dataclass(frozen=True, eq=False, slots=True)
class Reached(Generic[S]):
    """Where following a line led.

    Attributes:
        state: there.
        along: λ there, in steps.
        stop: "target", "singularity" or "stalled".
        visited: the states on the way, the first and the last among them.
        undetermined: it stands in a singularity from the first.
    """

    state: S
    along: float
    stop: Stop
    visited: tuple[S, ...]
    undetermined: bool = False


def along_line(line: Line[S], state: S, way: float) -> Reached[S]:
    """From λ = 0 to λ = ``way``, or to shortly before a singularity."""
    here = line.first(state)
    if here is None:
        return Reached(state, 0.0, "singularity", (state,), undetermined=True)
    visited, step = [state], _FIRST
    for _ in range(_MOST_STEPS):
        there = line.ahead(here, step)
        if there is None:
            step *= 0.4
            if step < _SHORTEST:
                return Reached(here.state, here.along, "singularity", tuple(visited))
            continue
        if there.slope <= 0.0:
            fold, before = _fold(line, here, step)
            if fold.along < way or before.along < way:
                before = _shortly_before(line, before, fold.along - _BEFORE * way)
                visited.append(before.state)
                return Reached(before.state, before.along, "singularity", tuple(visited))
            there = before
        if there.along >= way:
            end = _at_level(line, here, there, way)
            if end is not None:
                return Reached(end, way, "target", (*visited, end))
            step *= 0.4
            if step < _SHORTEST:
                return Reached(here.state, here.along, "singularity", tuple(visited))
            continue
        visited.append(there.state)
        here, step = there, min(_LONGEST, 1.6 * step)
    return Reached(here.state, here.along, "stalled", tuple(visited))


def _fold(line: Line[S], here: Place[S], step: float) -> tuple[Place[S], Place[S]]:
    """Where λ turns back within a step, and the last place before of which that is certain."""
    low, high = 0.0, step
    before = top = here
    for _ in range(60):
        middle = 0.5 * (low + high)
        there = line.ahead(here, middle)
        if there is None:  # cannot be: a longer step was taken
            break
        top = there if there.along > top.along else top
        if there.slope > 0.0:
            low, before = middle, there
        else:
            high = middle
        if high - low <= 1e-13 * step:
            break
    return top, before


def _shortly_before(line: Line[S], before: Place[S], level: float) -> Place[S]:
    """A place at ``level`` or lower, behind ``before``, from which the motion can go on."""
    if before.along <= level:
        return before
    # Near a fold λ falls with the square of the way back.
    near, back = 0.0, 1e-7
    found: Place[S] | None = None
    while back < _LONGEST:
        there = line.ahead(before, -back)
        if there is None:
            break
        if there.along <= level:
            found = there
            break
        near, back = back, 1.5 * back
    for _ in range(30):
        if found is None or level - found.along <= 1e-3 * (before.along - level):
            break
        middle = 0.5 * (near + back)
        there = line.ahead(before, -middle)
        if there is None:
            break
        if there.along <= level:
            found, back = there, middle
        else:
            near = middle
    return before if found is None else found


def _at_level(line: Line[S], here: Place[S], there: Place[S], level: float) -> S | None:
    """The state at λ = ``level``, between two places; None if that is not certain."""
    fixed = np.zeros_like(here.tangent)
    fixed[-1] = 1.0
    span = there.along - here.along
    part = (level - here.along) / span if span > 0.0 else 0.0
    # From whichever end is nearer, along its tangent to the level.
    near = there if part > 0.5 else here
    if near.slope <= 0.0:
        return None
    step = (level - near.along) / near.slope
    guess = line.closure.moved(near.state, step * near.tangent[:-1])
    found = line.correct(guess, level, fixed, max(0.5 * abs(step), 1e-9))
    if found is None:
        return None
    end = line.place(*found, near.tangent)
    if end is None or end.side != near.side or end.tangent @ near.tangent < _TURN:
        return None
    return end.state


@dataclass(frozen=True, eq=False, slots=True)
class Turn(Generic[S]):
    """Where λ turns back, and the state on the other branch where it is 0 again, if that is."""

    along: float
    state: S
    partner: S | None


def turn_on_line(line: Line[S], state: S, way: float) -> Turn[S] | None:
    """The first fold on the line up to λ = ``way``; None where there is none."""
    here = line.first(state)
    if here is None:
        return None
    step = _FIRST
    top: Place[S] | None = None
    for _ in range(_MOST_STEPS):
        there = line.ahead(here, step)
        if there is None:
            step *= 0.4
            if step < _SHORTEST:
                break
            continue
        if top is None and there.slope <= 0.0:
            top, _ = _fold(line, here, step)
        elif top is not None and there.slope > 0.0:
            break  # the other branch turns again before it is back
        if top is None and there.along >= way:
            return None
        if top is not None and top.along > way:
            return None
        if top is not None and there.along <= 0.0:
            return Turn(top.along, top.state, _at_level_back(line, there))
        here, step = there, min(_LONGEST, 1.6 * step)
    if top is None:
        top = here if step < _SHORTEST else None
    return None if top is None else Turn(top.along, top.state, None)


def _at_level_back(line: Line[S], there: Place[S]) -> S | None:
    """The state at λ = 0 next to a place that has just passed it on the way back."""
    fixed = np.zeros_like(there.tangent)
    fixed[-1] = 1.0
    step = -there.along / there.slope
    guess = line.closure.moved(there.state, step * there.tangent[:-1])
    found = line.correct(guess, 0.0, fixed, max(0.5 * abs(step), 1e-9))
    return None if found is None else found[0]


# --- what mechanisms answer with -----------------------------------------------------------


def follow(
    closure: Closure[S],
    start: Posture,
    state: S,
    joints: Sequence[float],
    *,
    strokes: Array,
    symbols: Sequence[str],
    posture: Callable[[S, Array], Posture],
    unit: str = "mm",
    scale: float = 1.0,
    events: Callable[[Sequence[S]], str] = lambda _: "",
) -> Followed:
    """Move the joints on a straight line to ``joints``, the platform on its assembly mode.

    Wanted joints beyond a stroke are cut off at its end; a joint that is beyond its stroke
    already may stay there or come back, but not go further. The motion stops just before a
    singularity, by a millionth of the way, and never jumps to another assembly mode.

    Args:
        start: the posture now, which closes.
        state: the same as the closure equations take it.
        joints: J wanted, mm or rad.
        strokes: (J, 2) lowest and highest; infinite where there is no end.
        symbols: of the joints, as "ρ₁".
        posture: the posture of a state with its joints (J,).
        unit: of the joints as people read them, and ``scale`` what they are multiplied by.
        events: what happened on the way, from the states visited; "" if nothing.

    Raises:
        InputError: not J finite numbers.
    """
    now = np.array(start.joints)
    wanted = finite(joints, name="the joints", last=len(now))
    if wanted.shape != now.shape:
        raise InputError(f"one set of {len(now)} joints can be followed at a time")
    low, high = np.minimum(strokes[:, 0], now), np.maximum(strokes[:, 1], now)
    aim = np.clip(wanted, low, high)
    beyond = np.abs(wanted - aim)
    blocked = int(beyond.argmax()) if beyond.max() > SLACK else None
    way = float(np.linalg.norm(aim - now))
    whole = float(np.linalg.norm(wanted - now))
    share = 1.0 if blocked is None else way / whole
    moved, part, happened, stop = start, 1.0, "", _TARGET
    text, limb = "", None
    if way > _STILL * max(float(np.abs(now).max()), closure.joint_unit):
        line = Line(closure, now, (aim - now) * (closure.joint_unit / way))
        end = along_line(line, state, way / closure.joint_unit)
        stop = end.stop
        if len(end.visited) > 1 or stop == "target":
            there = aim if stop == "target" else line.joints(end.along)
            moved = posture(end.state, there)
        part = 1.0 if stop == "target" else end.along * closure.joint_unit / way
        happened = events(end.visited)
        if end.undetermined:
            text = _UNDETERMINED
        elif stop == "singularity":
            text = stopped_text(aim - now, moved, part * share, symbols, unit, scale)
        elif stop == "stalled":
            text = f"could not be followed further than {100 * part * share:.3g} % of the way"
    if stop == "target" and blocked is not None:
        stop, limb = "stroke", blocked + 1
        ends = low[blocked], high[blocked]
        text = stroke_text(limb, symbols[blocked], wanted[blocked], ends, unit, scale)
    return Followed(moved, stop, "; ".join(filter(None, (happened, text))), part * share, limb)


def fold_ahead(
    closure: Closure[S],
    start: Posture,
    state: S,
    joints: Sequence[float],
    *,
    posture: Callable[[S, Array], Posture],
) -> Fold | None:
    """The singularity at which the assembly mode ends on the line to ``joints``, and its partner.

    The line is not cut off at stroke ends. None where the way is free, and where the posture
    stands in a singularity.

    Raises:
        InputError: not J finite numbers.
    """
    now = np.array(start.joints)
    wanted = finite(joints, name="the joints", last=len(now))
    if wanted.shape != now.shape:
        raise InputError(f"one set of {len(now)} joints can be followed at a time")
    way = float(np.linalg.norm(wanted - now))
    if not way > _STILL * max(float(np.abs(now).max()), closure.joint_unit):
        return None
    line = Line(closure, now, (wanted - now) * (closure.joint_unit / way))
    found = turn_on_line(line, state, way / closure.joint_unit)
    if found is None:
        return None
    there = posture(found.state, line.joints(found.along))
    partner = None if found.partner is None else posture(found.partner, now)
    return Fold(
        distance=found.along * closure.joint_unit,
        joints=tuple(line.joints(found.along).tolist()),
        pose=there.pose,
        mode=there.mode,
        partner=partner,
    )


_TARGET: Stop = "target"
_UNDETERMINED = (
    "the machine stands in a singularity, where its actuators do not determine how it moves; "
    "move the platform out of it first"
)


def stroke_text(
    limb: int,
    symbol: str,
    wanted: float,
    stroke: Sequence[float],
    unit: str = "mm",
    scale: float = 1.0,
) -> str:
    """Said where a limb (from 1) is held at the end of its stroke though more was ``wanted``."""
    name, end = ("max", stroke[1]) if wanted > stroke[1] else ("min", stroke[0])
    return f"limb {limb} is at the end of its stroke ({symbol} {name} = {scale * end:g} {unit})"


def stopped_text(
    move: Array,
    reached: Posture,
    fraction: float,
    symbols: Sequence[str],
    unit: str = "mm",
    scale: float = 1.0,
) -> str:
    """Said where a fold stops a motion: of a single joint what it cannot pass."""
    moving = np.flatnonzero(np.abs(move) > SLACK)
    if len(moving) == 1:
        i = int(moving[0])
        where = "beyond" if move[i] > 0 else "below"
        return (
            f"stopped at a parallel singularity: {symbols[i]} cannot go {where} "
            f"{scale * reached.joints[i]:.1f} {unit} on this assembly mode"
        )
    return f"stopped at a parallel singularity after {100 * fraction:.3g} % of the way"
