"""Motion of the five-bar along its assembly mode while the joints turn, and the fold ahead."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.solutions import Fold, Followed, Posture, Stop
from kinematics.arrays import Array, finite
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS, FiveBarDesign
from kinematics.mechanisms.five_bar.forward import both_points
from kinematics.mechanisms.five_bar.inverse import (
    RANGE_SLACK,
    elbows,
    mode_of,
    normal_angles,
    posture,
)
from kinematics.mechanisms.five_bar.joints_line import Crossing, first_crossing
from kinematics.mechanisms.five_bar.paths import warning

_BEFORE = 1e-6  # part of the way by which a motion stops before a singularity


def follow(design: FiveBarDesign, start: Posture, joints: Sequence[float]) -> Followed:
    """Turn the actuators on a straight line to ``joints`` (2,) rad, P on its assembly mode.

    A joint that turns freely takes the shorter way round; one with a range stays within it. P keeps
    the side of the line B_1 B_2 on which it is, so nothing is traced: the first parallel
    singularity on the way is found by intervals that prove the rest free (see
    `joints_line.first_crossing`), and the motion stops a millionth of the way before it. Serial
    singularities are passed: there a limb changes its working mode.

    Raises:
        InputError: not two finite numbers.
    """
    wanted = finite(joints, name="the joints", last=LIMBS)
    if not start.closes:
        text = "the machine is not assembled here; bring P back within the reach of both limbs"
        return Followed(start, "stalled", text, 0.0)
    q = np.array(start.joints)
    aim, blocked = _aim(design, q, wanted)
    side = _side(design, start)
    crossing = first_crossing(design, q.tolist(), aim.tolist())
    if side == 0 or (crossing is not None and crossing.fraction == 0.0):
        text = "P stands in a parallel singularity, so the joints do not determine where it goes"
        return Followed(start, "singularity", text, 0.0)
    way = float(np.abs(_difference(design, q, wanted)).sum())
    share = float(np.abs(aim - q).sum()) / way if way > 0.0 else 1.0
    fraction = 1.0 if crossing is None else max(0.0, crossing.fraction - _BEFORE)
    at = q + fraction * (aim - q)
    point = both_points(design, at)[0 if side > 0 else 1]
    if not np.isfinite(point).all():  # rounding at the very fold
        return Followed(start, "singularity", _singular_text(start, crossing), 0.0)
    moved = posture(design, point, mode_of(design, point, at)[0], known=at)
    stop: Stop = "target"
    text, limb = _events_text(start.mode, moved.mode), None
    if crossing is not None:
        stop, text = "singularity", _joined(text, _singular_text(start, crossing))
    elif blocked is not None:
        stop, limb = "stroke", blocked + 1
        text = _joined(text, _range_text(design, blocked, float(wanted[blocked])))
    return Followed(moved, stop, text, fraction * share, limb, warning(design, moved))


def fold_ahead(design: FiveBarDesign, start: Posture, joints: Sequence[float]) -> Fold | None:
    """The parallel singularity on the straight line to ``joints`` (2,) rad, if there is one.

    The line is not cut off at the ends of ranges. The partner is the other assembly mode: with two
    of them, it is who both merge with. ``distance`` is in joint space, rad.
    """
    wanted = finite(joints, name="the joints", last=LIMBS)
    if not start.closes or _side(design, start) == 0:
        return None
    q = np.array(start.joints)
    crossing = first_crossing(design, q.tolist(), wanted.tolist())
    if crossing is None or crossing.fraction == 0.0:
        return None
    other = both_points(design, q)[1 if _side(design, start) > 0 else 0]
    partner = posture(design, other, mode_of(design, other, q)[0], known=q)
    there = normal_angles(design, crossing.joints)
    return Fold(
        distance=crossing.fraction * float(np.linalg.norm(wanted - q)),
        joints=(float(there[0]), float(there[1])),
        pose=(float(crossing.point[0]), float(crossing.point[1])),
        mode=mode_of(design, crossing.point, crossing.joints)[0],
        partner=partner,
    )


def _difference(design: FiveBarDesign, q: Array, wanted: Array) -> Array:
    """How far each joint is to turn, rad: the shorter way round where it is free."""
    free = ~np.isfinite(design.joint_range[:, 0])
    turn = wanted - q
    shorter = turn - 2 * np.pi * np.round(turn / (2 * np.pi))
    return np.where(free, shorter, turn)


def _aim(design: FiveBarDesign, q: Array, wanted: Array) -> tuple[Array, int | None]:
    """Where the joints go, within their ranges, and which one is held back most."""
    # A joint that is beyond its range already may stay or come back, but not go further.
    low = np.minimum(design.joint_range[:, 0], q)
    high = np.maximum(design.joint_range[:, 1], q)
    target = q + _difference(design, q, wanted)
    aim = np.clip(target, low, high)
    beyond = np.abs(target - aim)
    return aim, int(beyond.argmax()) if beyond.max() > RANGE_SLACK else None


def _side(design: FiveBarDesign, start: Posture) -> int:
    """On which side of B_1 B_2 P is: 1 left, -1 right, 0 in a parallel singularity."""
    one, two = np.array(start.pose) - elbows(design, start.joints)
    sine = (one[0] * two[1] - one[1] * two[0]) / float(np.prod(design.distal))
    return 0 if abs(sine) < 1e-12 else (1 if sine > 0.0 else -1)


def _events_text(before: str, after: str) -> str:
    """Which limbs passed into another working mode."""
    changed = [n + 1 for n, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    if not changed:
        return ""
    who = "limb 1 and limb 2" if len(changed) > 1 else f"limb {changed[0]}"
    return f"{who} passed a serial singularity into working mode {after.replace('-', '−')}"


def _singular_text(start: Posture, crossing: Crossing | None) -> str:
    if crossing is None:
        return "stopped at a parallel singularity"
    line = "B₁, P and B₂ come into line" if crossing.extended else "the distal links fold together"
    q = np.degrees(crossing.joints)
    return (
        f"stopped before a parallel singularity at θ₁ = {q[0]:.2f}°, θ₂ = {q[1]:.2f}°, where {line}"
    )


def _range_text(design: FiveBarDesign, i: int, wanted: float) -> str:
    end = design.joint_range[i][int(wanted > design.joint_range[i][1])]
    return f"θ{SUBSCRIPTS[i]} stopped at the end of its range, {np.degrees(end):g}°"


def _joined(*parts: str) -> str:
    return "; ".join(filter(None, parts))
