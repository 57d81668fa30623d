"""`bohemia ik` and `bohemia fk`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from math import isfinite, isnan
from typing import TYPE_CHECKING

from app import tables
from app.commands import common
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.mechanism import Design, Mechanism
    from kinematics.solutions import Posture


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
    design, mechanism = common.load(arguments.design)
    axes = mechanism.pose_coordinates(design)
    typed = common.open_numbers("--pose", arguments.pose, axes)
    modes = mechanism.modes
    if arguments.mode is not None:
        modes = (common.chosen_mode(arguments.mode, design, mechanism),)
    postures = _postures(design, mechanism, typed, modes)
    closing = [posture for posture in postures if posture.closes]
    reachable = any(posture.reachable for posture in postures)
    nearest = min(postures, key=_miss)
    reasons = [] if reachable else [reason.text for reason in nearest.reasons]
    common.warn(design, mechanism)
    joints = mechanism.joint_coordinates(design)
    given = not any(isnan(value) for value in typed)

    def transform(posture: Posture) -> list[list[float]]:
        placed: list[list[float]] = mechanism.transform(design, posture.pose, posture.mode).tolist()
        return placed

    if not arguments.json:
        shown = typed if given else tables.outer(nearest.pose, axes)
        common.print_head(design, f"Pose {tables.with_units(shown, axes)}")
        noun = mechanism.mode_noun
        print(tables.inverse_text(closing, nearest, joints, reachable, noun))
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
            "solutions": [
                {
                    **common.mode_entry(mechanism, posture.mode),
                    "pose": pose(posture),
                    "joints": tables.outer(posture.joints, joints),
                    "within_stroke": posture.reachable,
                    "reasons": [reason.text for reason in posture.reasons],
                    "residual": posture.residual,
                    "transform": transform(posture),
                }
                for posture in closing
            ],
        }
    )


def _postures(
    design: Design, mechanism: Mechanism, typed: Sequence[float], modes: Sequence[str]
) -> list[Posture]:
    """The pose in each mode that has it; a coordinate that was left out may depend on the mode."""
    axes = mechanism.pose_coordinates(design)
    pose = [tables.inner(value, axis) for value, axis in zip(typed, axes, strict=True)]
    if not any(isnan(value) for value in typed):
        return [mechanism.posture(design, pose, mode) for mode in modes]
    postures, refusals = [], []
    for mode in modes:
        try:
            postures.append(
                mechanism.posture(design, mechanism.complete_pose(design, pose, mode), mode)
            )
        except InputError as error:
            refusals.append(error)
    if not postures:
        raise refusals[0]
    return postures


def _miss(posture: Posture) -> tuple[int, float]:
    """How badly a pose is missed: by limbs that cannot close, then by mm beyond a bound."""
    unclosed = sum(not isfinite(joint) for joint in posture.joints)
    return unclosed, max((reason.amount for reason in posture.reasons), default=0.0)


def _fk(arguments: argparse.Namespace) -> None:
    design, mechanism = common.load(arguments.design)
    actuators = mechanism.joint_coordinates(design)
    typed = common.numbers("--joints", arguments.joints, actuators)
    joints = [tables.inner(value, axis) for value, axis in zip(typed, actuators, strict=True)]
    with common.progress("All assembly modes"):
        (found,) = mechanism.forward(design, [joints], mixed_modes=arguments.mixed_modes)
    common.warn(design, mechanism)
    for value, axis in zip(joints, actuators, strict=True):
        if not axis.lower <= value <= axis.upper:
            print(f"bohemia: warning: {tables.beyond_stroke(value, axis)}", file=sys.stderr)
    axes = mechanism.pose_coordinates(design)
    order = mechanism.modes.index
    shown = sorted(
        (n for n in range(len(found)) if found.within_stroke[n] or not arguments.within_stroke),
        key=lambda n: (not found.within_stroke[n], order(found.modes[n]), *found.poses[n]),
    )
    if not arguments.json:
        common.print_head(design, f"Joints {tables.with_units(typed, actuators)}")
        print(tables.forward_text(found, shown, axes))
        return
    transforms = mechanism.transform(design, found.poses, found.modes).tolist()

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
                    **common.mode_entry(mechanism, found.modes[n]),
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
                    **common.mode_entry(mechanism, motion.mode),
                    "direction": pose(motion.direction),
                    "text": motion.text,
                }
                for motion in found.self_motions
            ],
        }
    )
