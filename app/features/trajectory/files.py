"""Samples of trajectories as CSV, in people's units; points are read by `kinematics.trajectories`.

Lengths mm, angles degrees, times s; forces N, torques N·mm.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from math import degrees, isfinite

from kinematics.answers.motion import WrenchName
from kinematics.mechanism import Coordinate
from kinematics.trajectories import Trajectory
from kinematics.trajectories.points import LARGEST, MOST, Points, read_points

__all__ = ["LARGEST", "MOST", "Points", "read_points", "trajectory_csv"]


def columns_of(
    found: Trajectory, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> dict[str, list[float]]:
    """The samples by column: time, pose, joints, their rates and accelerations, forces, and how
    near a singularity is. NaN and infinity stay.
    """
    columns: dict[str, list[float]] = {"t": found.times.tolist()}
    for n, axis in enumerate(axes):
        columns[axis.json_key] = _outer(found.poses[:, n].tolist(), axis)
    for n, joint in enumerate(joints):
        columns[joint.json_key] = _outer(found.joints[:, n].tolist(), joint)
    for what, values in (
        ("per_s", found.joint_rates),
        ("per_s2", found.joint_accelerations),
    ):
        for n, joint in enumerate(joints):
            columns[f"{joint.json_key}_{what}"] = _outer(values[:, n].tolist(), joint)
    for n, key in enumerate(force_keys(found.names, joints)):
        columns[key] = found.forces[:, n].tolist()
    columns["within_stroke"] = [float(ok) for ok in found.reachable.tolist()]
    columns["determinant"] = found.determinant.tolist()
    columns["conditioning"] = found.conditioning.tolist()
    columns["singularity_mm"] = found.distance.tolist()
    return columns


def force_keys(names: Sequence[WrenchName], joints: Sequence[Coordinate]) -> list[str]:
    """What the columns of forces are called: "force_actuation1_Nmm", "force_constraint3"."""
    turning = {joint.limb: joint.unit == "rad" for joint in joints}
    keys = []
    for name in names:
        unit = "_Nmm" if turning.get(name.limb, False) else "_N"
        unit = unit if name.kind == "actuation" else ""
        keys.append(f"force_{name.kind}{name.limb or ''}{unit}")
    return keys


def trajectory_csv(
    found: Trajectory, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> str:
    """One row a sample; empty where there is no number, "inf" where there is no singularity."""
    columns = columns_of(found, axes, joints)
    written = io.StringIO()
    rows = csv.writer(written, lineterminator="\n")
    rows.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        rows.writerow(["" if value != value else _plain(value) for value in row])
    return written.getvalue()


def _plain(value: float) -> float | int:
    return int(value) if isfinite(value) and value == int(value) and abs(value) < 1e15 else value


def _outer(values: Sequence[float], axis: Coordinate) -> list[float]:
    return [degrees(v) if axis.unit == "rad" else float(v) for v in values]
