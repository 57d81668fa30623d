"""`bohemia ik` and `bohemia fk`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING

from app import tables
from app.commands import common

if TYPE_CHECKING:
    from kinematics.solutions import Posture


def register(command: common.AddCommand) -> None:
    ik = command("ik", _ik, "Inverse kinematics: every working mode of a pose.")
    common.add_design(ik)
    ik.add_argument("--pose", required=True, metavar="x,y,z,phi,theta", help="mm and degrees")
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
    typed = common.numbers("--pose", arguments.pose, axes)
    pose = [tables.inner(value, axis) for value, axis in zip(typed, axes, strict=True)]
    postures = [mechanism.posture(design, pose, mode) for mode in mechanism.modes]
    closing = [posture for posture in postures if posture.closes]
    reachable = any(posture.reachable for posture in postures)
    nearest = min(postures, key=_miss)
    reasons = [] if reachable else [reason.text for reason in nearest.reasons]
    common.warn(design, mechanism)
    joints = mechanism.joint_coordinates(design)

    def transform(posture: Posture) -> list[list[float]]:
        placed: list[list[float]] = mechanism.transform(design, pose, posture.mode).tolist()
        return placed

    if not arguments.json:
        common.print_head(design, f"Pose {tables.with_units(typed, axes)}")
        print(tables.inverse_text(closing, nearest, joints, reachable))
        return
    common.print_json(
        {
            "design": design.name,
            "mechanism": design.mechanism,
            "pose": {tables.key(axis): value for axis, value in zip(axes, typed, strict=True)},
            "transform": transform(nearest),
            "reachable": reachable,
            "reasons": reasons,
            "solutions": [
                {
                    "working_mode": posture.mode,
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
                    "working_mode": found.modes[n],
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
                    "working_mode": motion.mode,
                    "direction": pose(motion.direction),
                    "text": motion.text,
                }
                for motion in found.self_motions
            ],
        }
    )
