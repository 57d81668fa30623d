"""Trajectories as text, in people's units: samples as CSV, and polynomials of time.

Points are read by `kinematics.trajectories`. Lengths mm, angles degrees, times s; forces N, torques
N·mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from kinematics.answers.motion import WrenchName
from kinematics.mechanism import Coordinate
from kinematics.storage import csv_text
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
    for tail, values, named in (
        ("", found.poses, axes),
        ("", found.joints, joints),
        ("_per_s", found.joint_rates, joints),
        ("_per_s2", found.joint_accelerations, joints),
    ):
        for n, axis in enumerate(named):
            columns[axis.json_key + tail] = [axis.outer(v) for v in values[:, n].tolist()]
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
    rows = zip(*columns.values(), strict=True)
    told = (["" if value != value else _plain(value) for value in row] for row in rows)
    return csv_text([columns, *told])


def _plain(value: float) -> float | int:
    return int(value) if isfinite(value) and value == int(value) and abs(value) < 1e15 else value


def polynomial(coefficients: Sequence[float], digits: int = 4) -> str:
    """ "0.5t^2 - 1.2t + 3" of coefficients from t⁰ upwards."""
    terms = [_term(value, power, digits) for power, value in enumerate(coefficients)]
    return " ".join(reversed(terms)).removeprefix("+ ")


def _term(value: float, power: int, digits: int) -> str:
    sign = "-" if value < 0 else "+"
    factor = {0: "", 1: "t"}.get(power, f"t^{power}")
    return f"{sign} {abs(value):.{digits}g}{factor}"
