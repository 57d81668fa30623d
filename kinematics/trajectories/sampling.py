"""From a path, a time law and a machine to what its actuators have to do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from kinematics.answers.motion import WrenchName
from kinematics.answers.trajectories import Limits, Path, Quantity, TimeLaw, Trajectory
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.faceted import Faceted
from kinematics.trajectories.along import Along, joints_along, moved
from kinematics.trajectories.between import close
from kinematics.trajectories.constrained import constrained
from kinematics.trajectories.events import events_of
from kinematics.trajectories.laws import LONGEST, SHORTEST

MOST_SAMPLES = 100_000
_STILL = 1e-12  # of the path's mean speed: a rate that is rounding
CHORDS = 2048  # by which the way of the platform's origin is measured, at least
NEAR = 0.03  # of the characteristic length: a singularity nearer than this is told


def trajectory(
    machine: Faceted[Any],
    path: Path,
    law: TimeLaw,
    mode: str,
    *,
    samples: int = 101,
    load: Sequence[float] | None = None,
    limits: Limits | None = None,
    distances: bool = True,
    near: float | None = None,
    dependent: int | None = None,
) -> Trajectory:
    """Joints, rates, accelerations and forces along a path in one working mode, and what is wrong.

    Args:
        samples: at even times; places where something happens are found in between them.
        load: [F, T] (6,) N and N·mm on the platform, base frame; None: no forces.
        limits: of the actuators.
        distances: ask the mechanism for the distance to singularities at every sample.
        near: mm to a singularity from which on it is told; None: 3 % of the characteristic length.
        dependent: of a mechanism with a dependent coordinate, the one that gives way to the others;
            None: the one that the mechanism would choose.

    Raises:
        InputError: no such mode, less than two samples, or a load or limits of the wrong size.
    """
    if mode not in machine.modes:
        raise InputError(f"there is no mode {mode!r}; known are {', '.join(machine.modes)}")
    if not 2 <= samples <= MOST_SAMPLES:
        raise InputError(f"a trajectory takes 2 to {MOST_SAMPLES} samples, got {samples}")
    limits = _checked(limits or Limits(), len(machine.joints))
    times = np.linspace(0.0, law.duration, samples)
    path = constrained(path, machine, mode, dependent)
    shares, poses, rates, accelerations = moved(path, law, times)
    along = Along(machine, path, law, mode)
    joints, reachable = joints_along(machine, poses, mode)
    found = machine.motion.inverse(poses, mode, rates, accelerations)
    names: tuple[WrenchName, ...] = ()
    forces = np.zeros((samples, 0))
    held_load: tuple[float, ...] | None = None
    if load is not None:
        held_load = tuple(finite(load, name="the load", last=6).tolist())
        held = machine.statics.forces(poses, mode, np.array(held_load))
        names, forces = held.names, held.forces
    determinant = machine.statics.wrenches(poses, mode).determinant
    keys = {measure.key for measure in machine.measures.specs}
    conditioning = np.full(samples, np.nan)
    if "conditioning" in keys:
        conditioning = np.asarray(machine.measures(poses, mode, "conditioning"))
    distance = np.full(samples, np.nan)
    if distances:
        distance = np.array(
            [
                along.distance(pose) if ok else np.nan
                for pose, ok in zip(poses, reachable, strict=True)
            ]
        )
    result = Trajectory(
        mode=mode,
        times=times,
        shares=shares,
        poses=poses,
        pose_rates=np.where(np.isnan(rates), found.pose_rates, rates),
        pose_accelerations=np.where(
            np.isnan(accelerations), found.pose_accelerations, accelerations
        ),
        joints=joints,
        joint_rates=np.array(found.joint_rates),
        joint_accelerations=np.array(found.joint_accelerations),
        reachable=reachable,
        names=names,
        forces=np.array(forces),
        determinant=np.array(determinant),
        conditioning=np.array(conditioning),
        distance=distance,
        events=(),
        length=path.length,
        travel=_travel(machine, path, mode),
        close=close(along, times, held_load, limits),
        load=held_load,
    )
    limit = NEAR * machine.length if near is None else near
    return replace(result, events=events_of(along, result, limits, limit))


def _travel(machine: Faceted[Any], path: Path, mode: str) -> float:
    """mm that the platform's origin travels: by chords between knots, and by half as many."""
    marks = np.unique(np.concatenate([[0.0], path.knots, [1.0]]))
    count = 2 * max(1, CHORDS // (2 * len(marks)))
    shares = marks[:-1, None] + np.diff(marks)[:, None] * np.linspace(0.0, 1.0, count + 1)
    poses = path.at(shares.ravel())[0]
    places = machine.transform(poses, mode)[:, :3, 3].reshape(*shares.shape, 3)
    fine, half = (
        float(np.linalg.norm(np.diff(chosen, axis=1), axis=2).sum())
        for chosen in (places, places[:, ::2])
    )
    return (4.0 * fine - half) / 3.0  # chords of a smooth curve are short by the square of theirs


def duration_within(found: Trajectory, limits: Limits) -> float:
    """The shortest duration, s, in which the same path and law keep the rates and accelerations.

    Rates go with 1/T and accelerations with 1/T²; what counts is the largest on the way, not of the
    samples. A start or an end at speed, as of constant velocity, is not counted.

    Raises:
        InputError: no duration helps, because the path leaves the workspace, meets a singularity or
            has a corner that is passed at speed; or nothing that is limited moves.
    """
    factor = 0.0
    pairs: tuple[tuple[Quantity, Array, tuple[float, ...] | None, float], ...] = (
        ("rate", found.joint_rates, limits.rates, 1.0),
        ("acceleration", found.joint_accelerations, limits.accelerations, 0.5),
    )
    for what, values, allowed, power in pairs:
        if allowed is None:
            continue
        if what == "acceleration" and len(found.close.corners):
            raise InputError(
                f"the path has a sharp corner that is passed at speed (t = "
                f"{found.close.corners[0]:.4g} s): no duration keeps limits of accelerations; "
                "round the corners, or join the points by a spline"
            )
        most, _ = found.largest(what)
        if not (np.isfinite(values).all() and np.isfinite(most).all()):
            raise InputError(
                "the trajectory leaves the workspace or meets a singularity: no "
                "duration keeps the limits"
            )
        factor = max(factor, float((most / np.array(allowed)).max()) ** power)
    least = _STILL * found.length / found.duration
    if (found.largest("rate")[0] <= least).all():
        raise InputError("no actuator moves on this path, so that any duration keeps the limits")
    if factor * found.duration > LONGEST:
        raise InputError(f"the limits are so low that it would take more than {LONGEST:.0e} s")
    return max(factor * found.duration, SHORTEST)


def _checked(limits: Limits, joints: int) -> Limits:
    for name in ("rates", "accelerations", "forces"):
        values = getattr(limits, name)
        if values is None:
            continue
        array = finite(values, name=f"the limits of {name}")
        if array.shape != (joints,) or (array <= 0.0).any():
            raise InputError(f"the limits of {name} must be {joints} positive numbers")
    return limits
