"""`bohemia ik` and `bohemia fk`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from math import isfinite, isnan, pi, remainder
from typing import TYPE_CHECKING, Any

from app.terminal import common, tables
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.answers.solutions import Posture
    from kinematics.machine import Machine


def register(command: common.AddCommand) -> None:
    ik = command("ik", _ik, "Inverse kinematics: every working or operation mode of a pose.")
    common.add_design(ik)
    common.add_pose(ik)
    common.add_mode(ik, "all")
    common.add_json(ik)

    fk = command("fk", _fk, "Forward kinematics: every assembly mode of given actuators.")
    fk.epilog = (
        "JSON has no infinity: a condition of null is a singularity, a gap_mm of null an only "
        "solution."
    )
    common.add_design(fk)
    fk.add_argument(
        "--joints", required=True, metavar="rho1,...", help="actuated joints, mm (angles: degrees)"
    )
    fk.add_argument(
        "--within-stroke", action="store_true", help="only solutions within the strokes"
    )
    fk.add_argument(
        "--mixed-modes",
        action="store_true",
        help="for simplified designs: also solutions in which the two limbs of an arrangement "
        "stand in different working modes, which takes longer",
    )
    common.add_json(fk)


def _ik(arguments: argparse.Namespace) -> None:
    machine = common.load(arguments.design)
    design = machine.design
    axes = machine.coordinates
    typed = common.open_numbers("--pose", arguments.pose, axes)
    modes: tuple[str, ...] = machine.modes
    if arguments.mode is not None:
        modes = (common.chosen_mode(arguments.mode, machine),)
    postures = _postures(machine, typed, modes)
    closing = [posture for posture in postures if posture.closes]
    reachable = any(posture.reachable for posture in postures)
    nearest = min(postures, key=_miss)
    reasons = [] if reachable else [reason.text for reason in nearest.reasons]
    common.warn(machine)
    joints = machine.joints
    given = not any(isnan(value) for value in typed)
    free = [_free(machine, posture) for posture in closing]
    warnings = _warnings(machine, closing, free)
    for text in warnings:
        print(f"bohemia: warning: {text}", file=sys.stderr)

    others = [] if given else _other_poses(machine, typed, nearest)

    def transform(posture: Posture) -> list[list[float]]:
        placed: list[list[float]] = machine.transform(posture.pose, posture.mode).tolist()
        return placed

    if not arguments.json:
        shown = typed if given else tables.outer(nearest.pose, axes)
        common.print_head(design, f"Pose {tables.with_units(shown, axes)}")
        noun = machine.mode_noun
        print(tables.inverse_text(closing, nearest, joints, reachable, noun, free))
        for other in others:
            where = tables.with_units(tables.outer(other, axes), axes)
            print(f"The constraint holds as well at {where}; what is nearest to 0 was taken.")
        return

    def pose(posture: Posture) -> dict[str, float]:
        values = typed if given else tables.outer(posture.pose, axes)
        return dict(zip(map(tables.key, axes), values, strict=True))

    common.print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            "pose": pose(nearest),
            "transform": transform(nearest),
            "reachable": reachable,
            "reasons": reasons,
            "warnings": warnings,
            "other_poses": [
                dict(zip(map(tables.key, axes), tables.outer(other, axes), strict=True))
                for other in others
            ],
            "solutions": [
                {
                    **common.mode_entry(machine, posture.mode),
                    "pose": pose(posture),
                    "joints": tables.outer(posture.joints, joints),
                    "within_stroke": posture.reachable,
                    "reasons": [reason.text for reason in posture.reasons],
                    "free_joints": [joints[k].key for k in loose],
                    "residual": posture.residual,
                    "transform": transform(posture),
                }
                for posture, loose in zip(closing, free, strict=True)
            ],
        }
    )


_NUDGE = 1e-9  # of the characteristic length: how far beside a pose joints are compared
_APART = 0.1  # rad; a limb at the end of its reach turns by far less


def _free(machine: Machine[Any], posture: Posture) -> list[int]:
    """The angles that a pose leaves free: beside it they are now these, now those."""
    import numpy as np

    joints = machine.joints
    turning = [k for k, joint in enumerate(joints) if joint.unit == "rad"]
    if not turning:
        return []
    length = machine.length
    steps = [_NUDGE * (1.0 if axis.unit == "rad" else length) for axis in machine.coordinates]
    away = np.diag(steps)
    answer = machine.inverse(np.array(posture.pose) + np.concatenate([away, -away]))
    beside = answer.joints[:, answer.modes.index(posture.mode)]
    apart = np.abs(np.angle(np.exp(1j * (beside - np.array(posture.joints)))))
    apart = np.where(np.isfinite(apart), apart, 0.0)
    return [k for k in turning if float(apart[:, k].max()) > _APART]


def _warnings(
    machine: Machine[Any],
    closing: Sequence[Posture],
    free: Sequence[Sequence[int]],
) -> list[str]:
    """One sentence for each joint that is free somewhere, with the reason."""
    joints = machine.joints
    told: dict[int, str] = {}
    for posture, loose in zip(closing, free, strict=True):
        for k in loose:
            if k in told:
                continue
            lost = machine.singularities.at(posture)
            why = [each.text for each in lost if joints[k].limb in each.limbs]
            told[k] = f"at this pose {joints[k].symbol} is free, what is shown is one of its values"
            told[k] += f": {why[0]}" if why else ""
    return list(told.values())


def _postures(machine: Machine[Any], typed: Sequence[float], modes: Sequence[str]) -> list[Posture]:
    """The pose in each mode that has it; a coordinate that was left out may depend on the mode."""
    axes = machine.coordinates
    pose = [tables.inner(value, axis) for value, axis in zip(typed, axes, strict=True)]
    if not any(isnan(value) for value in typed):
        return [machine.inverse.posture(pose, mode) for mode in modes]
    postures, refusals = [], []
    for mode in modes:
        try:
            postures.append(machine.inverse.posture(machine.complete_pose(pose, mode), mode))
        except InputError as error:
            refusals.append(error)
    if not postures:
        raise refusals[0]
    return postures


def _other_poses(
    machine: Machine[Any], typed: Sequence[float], taken: Posture
) -> list[tuple[float, ...]]:
    """The poses that the constraint allows besides the one taken, where an angle was left out."""
    axes = machine.coordinates
    left = next(n for n, value in enumerate(typed) if isnan(value))
    if axes[left].unit != "rad" or left not in machine.dependent:
        return []
    found: list[tuple[float, ...]] = []
    for turn in (pi, 2.0 * pi / 3.0, -2.0 * pi / 3.0):  # the value nearest to there
        pose = list(taken.pose)
        pose[left] += turn
        other = machine.complete_pose(pose, taken.mode, None, left)
        known = (taken.pose, *found)
        if all(abs(remainder(other[left] - each[left], 2.0 * pi)) > 1e-9 for each in known):
            found.append(other)
    return found


def _miss(posture: Posture) -> tuple[int, float]:
    """How badly a pose is missed: by limbs that cannot close, then by mm beyond a bound."""
    unclosed = sum(not isfinite(joint) for joint in posture.joints)
    return unclosed, max((reason.amount for reason in posture.reasons), default=0.0)


def _fk(arguments: argparse.Namespace) -> None:
    machine = common.load(arguments.design)
    design = machine.design
    actuators = machine.joints
    typed = common.numbers("--joints", arguments.joints, actuators)
    joints = [tables.inner(value, axis) for value, axis in zip(typed, actuators, strict=True)]
    with common.progress("All assembly modes"):
        (found,) = machine.forward([joints], mixed_modes=arguments.mixed_modes)
    common.warn(machine)
    for value, axis in zip(joints, actuators, strict=True):
        if not axis.lower <= value <= axis.upper:
            print(f"bohemia: warning: {tables.beyond_stroke(value, axis)}", file=sys.stderr)
    axes = machine.coordinates
    order = machine.modes.index
    shown = sorted(
        (n for n in range(len(found)) if found.within_stroke[n] or not arguments.within_stroke),
        key=lambda n: (not found.within_stroke[n], order(found.modes[n]), *found.poses[n]),
    )
    if not arguments.json:
        common.print_head(design, f"Joints {tables.with_units(typed, actuators)}")
        print(tables.forward_text(found, shown, axes))
        return
    transforms = machine.transform(found.poses, found.modes).tolist()

    def pose(values: Sequence[float]) -> dict[str, float]:
        return dict(zip(map(tables.key, axes), tables.outer(values, axes), strict=True))

    common.print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            "joints": typed,
            "solutions": [
                {
                    "identity": found.identities[n],
                    "pose": pose(found.poses[n]),
                    **common.mode_entry(machine, found.modes[n]),
                    "joints": typed,
                    "within_stroke": bool(found.within_stroke[n]),
                    "residual": float(found.residual[n]),
                    "condition": common.finite(found.condition[n]),
                    "determinant": common.finite(found.determinant[n]),
                    "multiplicity": int(found.multiplicity[n]),
                    "gap_mm": common.finite(found.gap[n]),
                    "transform": transforms[n],
                }
                for n in shown
            ],
            "real_count": len(found),
            "complex_count": found.complex_count,
            "expected_count": found.expected_count,
            "complete": found.complete,
            "method": found.method,
            "seconds": found.seconds,
            "notes": found.notes,
            "self_motions": [
                {
                    "pose": pose(motion.pose),
                    **common.mode_entry(machine, motion.mode),
                    "direction": pose(motion.direction),
                    "text": motion.text,
                }
                for motion in found.self_motions
            ],
        }
    )
