"""`bohemia ik` and `bohemia fk`."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from math import degrees, isfinite, isnan, pi, remainder
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, command, progress
from app.terminal.options import DESIGN, POSE, Modes, flag, modes, option
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.terminal.poses import Given, Place
    from kinematics.answers.coordinates import Coordinate
    from kinematics.answers.solutions import ForwardSolutions, Posture, Reason
    from kinematics.machine import Machine

_NUDGE = 1e-9  # of the characteristic length: how far beside a pose joints are compared
_APART = 0.1  # rad; a limb at the end of its reach turns by far less


@command("ik")
def ik(
    machine: Machine[Any] = DESIGN,
    pose: Given = POSE,
    modes: Modes = modes("--mode", "--modes"),
) -> Answer:
    """Inverse kinematics: every working or operation mode of a pose."""
    axes, joints, noun = machine.coordinates, machine.joints, machine.mode_noun
    asked = machine.modes if modes is None else modes
    places = _places(pose, asked)
    closing = [place for place in places if place.posture.closes]
    nearest = min(places, key=lambda place: _miss(place.posture))
    free = [_free(machine, place.posture) for place in closing]
    others = _other_poses(pose, nearest)
    held = sum(place.posture.reachable for place in closing)
    reasons = [] if held else [reason.text for reason in nearest.posture.reasons]
    able = [] if held else _holding(pose, [mode for mode in machine.modes if mode not in asked])
    solutions = [
        {
            **place.entries,
            "joints": tables.outer(place.posture.joints, joints),
            "within_stroke": place.posture.reachable,
            "reasons": [reason.text for reason in place.posture.reasons],
            "free_joints": [joints[k].key for k in loose],
            "residual": place.posture.residual,
            "transform": machine.transform(place.pose, place.mode).tolist(),
        }
        for place, loose in zip(closing, free, strict=True)
    ]
    data = {
        "pose": nearest.entries["pose"],
        "transform": machine.transform(nearest.pose, nearest.mode).tolist(),
        "reachable": held > 0,
        "reasons": reasons,
        **tables.modes_entry(modes),
        "reachable_in_other_modes": able,
        "warnings": _warnings(machine, closing, free),
        "other_poses": [tables.named(other, axes) for other in others],
        "solutions": solutions,
    }
    lines = [nearest.pose_text, ""]
    if closing:
        rows = [
            [place.mode, *map(tables.fixed, solution["joints"], joints), within]
            for place, solution, within in zip(
                closing, solutions, map(_within, closing, free), strict=True
            )
        ]
        header = ["mode", *tables.headings(joints), "within its stroke"]
        own = slice(None if noun else 1, None)
        lines += [tables.table(header[own], [row[own] for row in rows]), ""]
    if held:
        lines.append(f"Reachable in {held} of {len(closing)} {noun}s." if noun else "Reachable.")
    else:
        several = closing and noun and len(asked) > 1
        where = f" The nearest {noun} is {nearest.mode}:" if several else ""
        nor = "" if able or modes is None else ", nor in any other"
        lines.append(f"Not reachable{_asked_text(modes, noun)}{nor}.{where}")
        lines += [f"  {text}" for text in reasons]
    if able:
        lines.append(f"Reachable in {tables.modes_text(able, noun)}.")
    for other in others:
        there = tables.with_units(tables.outer(other, axes), axes)
        lines.append(f"The constraint holds as well at {there}; what is nearest to 0 was taken.")
    return Answer(data, lines)


def _places(pose: Given, modes: Sequence[str]) -> list[Place]:
    """The pose in each mode that has it; a coordinate that was left out may depend on the mode."""
    places, refusals = [], []
    for mode in modes:
        try:
            places.append(pose.place(mode))
        except InputError as error:
            refusals.append(error)
    if not places:
        raise refusals[0]
    return places


def _holding(pose: Given, modes: Sequence[str]) -> list[str]:
    """Those of some modes in which the pose is within reach."""
    found = []
    for mode in modes:
        with suppress(InputError):  # the mode has no such pose
            found += [mode] if pose.place(mode).posture.reachable else []
    return found


def _asked_text(modes: Modes, noun: str) -> str:
    """ " in any working mode"; of modes that were asked for, in these."""
    if not noun or modes is None:
        return f" in any {noun}" if noun else ""
    return f" in {'' if len(modes) == 1 else 'any of the '}{tables.modes_text(modes, noun)}"


def _miss(posture: Posture) -> tuple[int, float]:
    """How badly a pose is missed: by limbs that cannot close, then by mm beyond a bound."""
    unclosed = sum(not isfinite(joint) for joint in posture.joints)
    return unclosed, max((reason.amount for reason in posture.reasons), default=0.0)


def _free(machine: Machine[Any], posture: Posture) -> list[int]:
    """The angles that a pose leaves free: beside it they are now these, now those."""
    import numpy as np

    turning = [k for k, joint in enumerate(machine.joints) if joint.unit == "rad"]
    if not turning:
        return []
    lengths = [1.0 if axis.unit == "rad" else machine.length for axis in machine.coordinates]
    away = np.diag(lengths) * _NUDGE
    answer = machine.inverse(np.array(posture.pose) + np.concatenate([away, -away]))
    beside = answer.joints[:, answer.modes.index(posture.mode)]
    apart = np.abs(np.angle(np.exp(1j * (beside - np.array(posture.joints)))))
    return [k for k in turning if float(np.nan_to_num(apart)[:, k].max()) > _APART]


def _warnings(
    machine: Machine[Any], closing: Sequence[Place], free: Sequence[Sequence[int]]
) -> list[str]:
    """One sentence for each joint that is free somewhere, with the reason."""
    told: dict[int, str] = {}
    for place, loose in zip(closing, free, strict=True):
        for k in (k for k in loose if k not in told):
            joint, lost = machine.joints[k], machine.singularities.at(place.posture)
            why = [f": {each.text}" for each in lost if joint.limb in each.limbs]
            told[k] = f"at this pose {joint.symbol} is free, what is shown is one of its values"
            told[k] += "".join(why[:1])
    return list(told.values())


def _other_poses(pose: Given, taken: Place) -> list[tuple[float, ...]]:
    """The poses that the constraint allows besides the one taken, where an angle was left out."""
    machine = pose.machine
    axes = machine.coordinates
    left = next((n for n in machine.dependent if isnan(pose.typed.get(axes[n].key, 0.0))), None)
    if left is None or axes[left].unit != "rad":
        return []
    found: list[tuple[float, ...]] = []
    for turn in (pi, 2.0 * pi / 3.0, -2.0 * pi / 3.0):  # the value nearest to there
        start = [value + turn * (n == left) for n, value in enumerate(taken.pose)]
        other = machine.complete_pose(start, taken.mode, None, left)
        known = (taken.pose, *found)
        if all(abs(remainder(other[left] - each[left], 2.0 * pi)) > 1e-9 for each in known):
            found.append(other)
    return found


def _within(place: Place, loose: Sequence[int]) -> str:
    """ "yes", or why not, short enough for a table, and what is free: "ρ₃ 40.3 too long"."""
    told = [_beyond(reason, place.machine.joints) for reason in place.posture.reasons] or ["yes"]
    return ", ".join([*told, *(f"{place.machine.joints[k].symbol} is free" for k in loose)])


def _beyond(reason: Reason, joints: Sequence[Coordinate]) -> str:
    low, turned = reason.bound == "rho_min", reason.unit == "rad"
    amount = degrees(reason.amount) if turned else reason.amount
    size = f"{amount:.1f}" if amount >= 0.05 else f"{amount:.1g}"  # not zero
    joint = next((each for each in joints if each.limb == reason.limb), None)
    side = f"{'°' * turned} {'below' if low else 'beyond'} its range"
    if not turned and not (joint and joint.signed):
        side = f" too {'short' if low else 'long'}"
    return f"{joint.symbol if joint else f'limb {reason.limb}'} {size}{side}"


@command("fk")
def fk(
    machine: Machine[Any] = DESIGN,
    joints: list[float] = option(
        "q1,q2,...", "actuated joints, mm (angles: degrees)", values.of_joints, required=True
    ),
    within_stroke: bool = flag("only solutions within the strokes"),
    mixed_modes: bool = flag(
        "of a design with merged U joints: also the solutions that it would have if they were not "
        "merged; of any other design all modes are answered anyway"
    ),
) -> Answer:
    """Forward kinematics: every assembly mode of given actuators.

    JSON has no infinity: a condition of null is a singularity, a gap_mm of null an only solution.
    """
    actuators, axes = machine.joints, machine.coordinates
    inner = tables.inner(joints, actuators)
    with progress("All assembly modes"):
        (found,) = machine.forward([inner], mixed_modes=mixed_modes)
    shown = sorted(
        (n for n in range(len(found)) if found.within_stroke[n] or not within_stroke),
        key=lambda n: (not found.within_stroke[n], found.modes[n], *found.poses[n]),
    )
    transforms = machine.transform(found.poses, found.modes).tolist()
    numbers = ("residual", "condition", "determinant", "multiplicity", "gap_mm", "within_stroke")
    data = {
        "joints": joints,
        "solutions": [
            {
                **tables.record(found, *numbers, at=n, identity="identities"),
                "pose": tables.named(found.poses[n], axes),
                **tables.mode_entry(machine, found.modes[n]),
                "joints": joints,
                "transform": transforms[n],
            }
            for n in shown
        ],
        "real_count": len(found),
        **tables.record(found, "complex_count", "expected_count", "complete", "method", "notes"),
        "seconds": found.seconds,
        "warnings": [
            _beyond_stroke(value, axis)
            for value, axis in zip(inner, actuators, strict=True)
            if not (axis.free or axis.lower <= value <= axis.upper)
        ],
        "self_motions": [
            {
                "pose": tables.named(motion.pose, axes),
                **tables.mode_entry(machine, motion.mode),
                "direction": tables.named(motion.direction, axes),
                "text": motion.text,
            }
            for motion in found.self_motions
        ],
    }
    head = f"Joints {tables.with_units(joints, actuators)}"
    return Answer(data, [head, "", *_solution_lines(found, shown, axes)])


def _beyond_stroke(value: float, axis: Coordinate) -> str:
    shown, low, high = tables.outer([value, axis.lower, axis.upper], [axis] * 3)
    mark = "°" if axis.unit == "rad" else " mm"
    return f"{axis.symbol} = {shown:g}{mark} is outside its stroke, {low:g} to {high:g}{mark}"


def _solution_lines(
    found: ForwardSolutions, shown: Sequence[int], axes: Sequence[Coordinate]
) -> list[str]:
    """Solutions ``shown`` (indices, in this order) as a table, and what is known of the set."""
    moded = [1] if any(found.modes) else []
    header = ["#", *("mode" for _ in moded), *tables.headings(axes, "°")]
    rows = [
        [
            str(found.identities[n]),
            *(found.modes[n] for _ in moded),
            *map(tables.fixed, tables.outer(found.poses[n], axes), axes),
            tables.condition_text(float(found.condition[n])),
            "yes" if found.within_stroke[n] else "no",
            tables.remark(int(found.multiplicity[n]), float(found.gap[n])),
        ]
        for n in shown
    ]
    table = tables.table([*header, "condition", "within strokes", "remark"], rows)
    lines = [*([table, ""] if shown else []), *found.notes]
    if len(shown) < len(found):
        lines.append(f"{len(shown)} of {len(found)} real solutions are within the strokes.")
    count, seconds = tables.real_of_complex(found), tables.seconds_text(found.seconds)
    return [*lines, f"{count} ({tables.known(found)}); {found.method}; {seconds}"]
