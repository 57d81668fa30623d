"""Forward kinematics of the 5-RPUR next to a known posture: polish a guess, follow one assembly
mode while the actuators move, and see the fold ahead at which it ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.solutions import Fold, Followed, Posture, Stop
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.following import stopped_text, stroke_text
from kinematics.mechanisms.five_rpur.continuation.curve import (
    LAMBDA_FIXED,
    Line,
    Place,
    Point,
    as_posture,
    correct,
    lengths,
    polished,
    start_point,
)
from kinematics.mechanisms.five_rpur.continuation.tracing import (
    Reached,
    Tracer,
    at_level,
    first_place,
    search,
)
from kinematics.mechanisms.five_rpur.design import JOINT_SYMBOLS, LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import STROKE_SLACK, posture

_BEFORE = 1e-6  # part of the way by which a motion stops before a singularity
_ROOM = 1e-4  # a step, scaled, to be proven where a motion stops before a crossing: to leave again
_STILL = 1e-14  # a way of this part of the lengths is none
_MOST_PIECES = 2000

_TARGET: Stop = "target"


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
    line = Line.of(design, rho, np.zeros(LIMBS))
    found = correct(line, start_point(design, pose, mode), LAMBDA_FIXED, rounds=40)
    return None if found is None else as_posture(line, polished(line, found.point), mode)


def follow(design: FiveRPURDesign, start: Posture, joints: ArrayLike) -> Followed:
    """Move the actuators on a straight line to ``joints``, the platform on its assembly mode.

    Wanted lengths beyond a stroke are cut off at its end; a limb that is beyond its stroke
    already may stay there or come back, but not go further. The motion stops just before a
    parallel singularity: by a millionth of the way before a fold, where two assembly modes merge,
    and by some µm, from where it can be left again, before a crossing of branches.

    It never jumps to another branch. What is proven of every step, but for rounding (see
    `continuation.certificate`): one curve of configurations joins its ends, no other is
    near, and the lengths move one way only along it, so that no singularity lies in between.
    Steps below about 15 µm (1e-4 of a link's length, 1e-4 rad) need not show the last: two folds
    closer together than that may be passed.

    Args:
        start: the posture now; pose and working mode count, its lengths follow from them.
        joints: ρ_1 … ρ_5 wanted, mm.

    Returns:
        The posture reached and what stopped it; ``text`` also tells which limbs passed into
        another working mode. ``fraction`` is measured in joint space.

    Raises:
        InputError: not five finite numbers.
    """
    wanted = _one_target(joints)
    first = start_point(design, start.pose, start.mode)
    rho = lengths(design, first)
    if not (start.closes and np.isfinite(rho).all()):
        return _not_closed(design, start)
    low = np.minimum(design.stroke[:, 0], rho)
    high = np.maximum(design.stroke[:, 1], rho)
    aim = np.clip(wanted, low, high)
    beyond = np.abs(wanted - aim)
    blocked = int(beyond.argmax()) if beyond.max() > STROKE_SLACK else None
    way = float(np.linalg.norm(aim - rho))
    share = 1.0 if blocked is None else way / float(np.linalg.norm(wanted - rho))
    if way <= _STILL * float(np.abs(rho).max()):
        moved, stop, fraction, events, undetermined = start, _TARGET, 1.0, list[int](), False
    else:
        line = Line.of(design, rho, (aim - rho) / way)
        end = _move(line, first, way)
        stop, events, undetermined = end.stop, end.events, end.undetermined
        moved = start if end.point is first else as_posture(line, end.point, start.mode)
        fraction = 1.0 if stop == "target" else end.point.along / way
    text, limb = "", None
    if undetermined:
        text = _UNDETERMINED
    elif stop == "singularity":
        text = stopped_text(aim - rho, moved, fraction * share, JOINT_SYMBOLS)
    elif stop == "stalled":
        text = f"could not be followed further than {100 * fraction * share:.3g} % of the way"
    elif blocked is not None:
        stop, limb = "stroke", blocked + 1
        stroke = design.limbs[blocked].stroke
        text = stroke_text(limb, JOINT_SYMBOLS[blocked], float(wanted[blocked]), stroke)
    text = "; ".join(part for part in (_events_text(start.mode, moved.mode, events), text) if part)
    return Followed(moved, stop, text, fraction * share, limb)


def fold_ahead(design: FiveRPURDesign, start: Posture, joints: ArrayLike) -> Fold | None:
    """The parallel singularity at which the assembly mode ends on the line to ``joints``.

    The line is not cut off at stroke ends, unlike that of `follow`. The curve is followed by
    proven steps as there, through the fold and on, down to the lengths at the start: whoever
    is there is the partner.

    Args:
        start: the posture now, regular; pose and working mode count.
        joints: ρ_1 … ρ_5 where the line ends, mm, not negative.

    Returns:
        The fold, its pose exact to about 1e-7 mm. It has no partner where the other branch turns
        again before it is back, and where branches cross instead: then it is the last place up
        to which steps can be proven, some µm before. None where the way to ``joints`` is free,
        and for a posture that does not close or stands in a singularity.

    Raises:
        InputError: not five finite numbers, none negative.
    """
    wanted = _one_target(joints)
    if (wanted < 0.0).any():
        limb = int((wanted < 0.0).argmax())
        raise InputError(
            f"the joints must not be negative, got {JOINT_SYMBOLS[limb]} = {wanted[limb]:g} mm"
        )
    first = start_point(design, start.pose, start.mode)
    rho = lengths(design, first)
    way = float(np.linalg.norm(wanted - rho))
    if not start.closes or way <= _STILL * float(np.abs(rho).max()):
        return None
    line = Line.of(design, rho, (wanted - rho) / way)
    here = first_place(line, first)
    if here is None:
        return None
    tracer = Tracer(line, here)
    piece = _piece_to(tracer, way)
    if piece is None:
        return _as_fold(line, start, tracer.here, None)
    if not piece.turned:
        return None
    top = search(line, piece, lambda p: p.slope)
    if top.point.along >= way:
        return None
    if piece.there.point.along <= 0.0:
        return _as_fold(line, start, top, at_level(line, piece._replace(here=top), 0.0))
    back = _piece_to(tracer, 0.0)
    return _as_fold(line, start, top, None if back is None else _meets(line, back, 0.0))


def _one_target(joints: ArrayLike) -> Array:
    wanted = finite(joints, name="the joints", last=LIMBS)
    if wanted.shape != (LIMBS,):
        raise InputError("one set of 5 joints can be followed at a time")
    return wanted


# --- along the curve -----------------------------------------------------------------------


class _End(NamedTuple):
    point: Point
    stop: Stop
    events: list[int]  # limbs whose q changed sign, in order
    undetermined: bool = False  # the path begins in a singularity


def _move(line: Line, first: Point, way: float) -> _End:
    """Follow the curve from λ = 0 to λ = way, or to shortly before where λ turns back."""
    events: list[int] = []
    here = first_place(line, first)
    if here is None:
        return _End(first, "singularity", events, undetermined=True)
    tracer = Tracer(line, here)
    safe, so_far = here, 0
    for _ in range(_MOST_PIECES):
        piece = tracer.advance(way)
        if piece is None:
            return _End(polished(line, safe.point), "singularity", events[:so_far])
        if piece.piece.length > _ROOM:
            safe, so_far = piece.here, len(events)
        met = _meets(line, piece, way)
        if met is not None:
            _note(events, piece.here, met)
            return _End(polished(line, met.point), "target", events)
        if piece.turned:
            stopped = _before_turn(line, piece, _BEFORE * way)
            _note(events, piece.here, stopped)
            return _End(polished(line, stopped.point), "singularity", events)
        _note(events, piece.here, piece.there)
    return _End(polished(line, tracer.here.point), "stalled", events)


def _piece_to(tracer: Tracer, level: float) -> Reached | None:
    """The piece on which λ = ``level`` is passed or λ turns back; None where the trace ends."""
    below = tracer.here.point.along < level
    for _ in range(_MOST_PIECES):
        piece = tracer.advance(level)
        if piece is None or piece.exact or piece.turned:
            return piece
        if (piece.there.point.along < level) != below:
            return piece
    return piece


def _meets(line: Line, piece: Reached, level: float) -> Place | None:
    """Where λ = ``level`` first on a piece; None if it turns back before or does not get there."""
    if piece.exact:
        return piece.there
    below = piece.here.point.along < level
    if piece.turned:
        piece = piece._replace(there=search(line, piece, lambda p: p.slope))
    if (piece.there.point.along < level) == below:
        return None
    return at_level(line, piece, level)


def _before_turn(line: Line, piece: Reached, gap: float) -> Place:
    """A place where λ is ``gap`` below where it turns back on a piece; ``here`` if that is less."""
    edge = search(line, piece, lambda p: p.slope)
    top = edge.point.along
    if top - piece.here.point.along <= gap:
        return piece.here

    def rest(at: Place) -> float:  # nearly straight in arc length, unlike λ itself
        return float(np.sqrt(max(top - at.point.along, 0.0)) - np.sqrt(gap))

    enough = 0.1 * float(np.sqrt(gap))
    before = search(line, piece._replace(there=edge), rest, enough=enough)
    # The gap may be below what rounding resolves.
    return before if before.slope * piece.here.slope > 0.0 else piece.here


def _note(events: list[int], before: Place, after: Place) -> None:
    events += [i for i, (q, r) in enumerate(zip(before.q, after.q, strict=True)) if q * r < 0]


def _as_fold(line: Line, start: Posture, at: Place, partner: Place | None) -> Fold:
    there = as_posture(line, at.point, start.mode)
    along = at.point.along
    return Fold(
        distance=along,
        joints=tuple(line.joints(along).tolist()),
        pose=there.pose,
        mode=there.mode,
        partner=None
        if partner is None
        else as_posture(line, polished(line, partner.point), there.mode),
    )


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
