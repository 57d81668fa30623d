"""From a path, a time law and a machine to what its actuators have to do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinematics.errors import InputError
from kinematics.mechanism import Design, Mechanism
from kinematics.motion import WrenchName
from kinematics.spatial import Array, finite
from kinematics.trajectories.constrained import constrained
from kinematics.trajectories.events import Along, events_of
from kinematics.trajectories.laws import Law
from kinematics.trajectories.paths import Path
from kinematics.trajectories.results import Limits, Trajectory

MOST_SAMPLES = 100_000
NEAR = 0.03  # of the characteristic length: a singularity nearer than this is told


def trajectory(
    mechanism: Mechanism,
    design: Design,
    path: Path,
    law: Law,
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
    if mode not in mechanism.modes:
        raise InputError(f"there is no mode {mode!r}; known are {', '.join(mechanism.modes)}")
    if not 2 <= samples <= MOST_SAMPLES:
        raise InputError(f"a trajectory takes 2 to {MOST_SAMPLES} samples, got {samples}")
    limits = _checked(limits or Limits(), len(mechanism.joint_coordinates(design)))
    times = np.linspace(0.0, law.duration, samples)
    path = constrained(path, mechanism, design, mode, dependent)
    shares, poses, rates, accelerations = moved(path, law, times)
    along = Along(mechanism, design, path, law, mode)
    joints, reachable = joints_along(mechanism, design, poses, mode)
    found = mechanism.inverse_motion(design, poses, mode, rates, accelerations)
    names: tuple[WrenchName, ...] = ()
    forces = np.zeros((samples, 0))
    if load is not None:
        held = mechanism.statics(design, poses, mode, finite(load, name="the load", last=6))
        names, forces = held.names, held.forces
    determinant = mechanism.wrench_system(design, poses, mode).determinant
    keys = {measure.key for measure in mechanism.measures(design)}
    conditioning = np.full(samples, np.nan)
    if "conditioning" in keys:
        conditioning = np.asarray(mechanism.measure(design, poses, mode, "conditioning"))
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
    )
    limit = NEAR * mechanism.characteristic_length(design) if near is None else near
    return replace(result, events=events_of(along, result, limits, limit))


def moved(path: Path, law: Law, times: Array) -> tuple[Array, Array, Array, Array]:
    """Shares (N,), poses, their rates and accelerations (N, P) at times (N,)."""
    s, ds, dds = law.at(times)
    points, first, second = path.at(s)
    rates = first * ds[:, None]
    accelerations = second * (ds**2)[:, None] + first * dds[:, None]
    return s, points, rates, accelerations


def joints_along(
    mechanism: Mechanism, design: Design, poses: Array, mode: str
) -> tuple[Array, np.ndarray]:
    """Joints (N, J) in one mode, angles without leaps of a turn, and which poses can be held."""
    answer = mechanism.inverse(design, poses)
    n = answer.modes.index(mode)
    joints = np.array(answer.joints[:, n])
    reachable = np.array(answer.within_stroke[:, n])
    for k, coordinate in enumerate(mechanism.joint_coordinates(design)):
        if coordinate.unit == "rad":
            ok = np.isfinite(joints[:, k])
            joints[ok, k] = np.unwrap(joints[ok, k])
    return joints, reachable


def duration_within(found: Trajectory, limits: Limits) -> float:
    """The shortest duration, s, in which the same path and law keep the rates and accelerations.

    Rates go with 1/T and accelerations with 1/T²; between samples a little more may be asked for.

    Raises:
        InputError: somewhere there are no rates, so that no duration helps.
    """
    factor = 0.0
    pairs = (
        (found.joint_rates, limits.rates, 1.0),
        (found.joint_accelerations, limits.accelerations, 0.5),
    )
    for values, allowed, power in pairs:
        if allowed is None:
            continue
        if not np.isfinite(values).all():
            raise InputError(
                "the trajectory leaves the workspace or meets a singularity: no "
                "duration keeps the limits"
            )
        worst = float((np.abs(values).max(axis=0) / np.array(allowed)).max())
        factor = max(factor, worst**power)
    return factor * found.duration


def _checked(limits: Limits, joints: int) -> Limits:
    for name in ("rates", "accelerations", "forces"):
        values = getattr(limits, name)
        if values is None:
            continue
        array = finite(values, name=f"the limits of {name}")
        if array.shape != (joints,) or (array <= 0.0).any():
            raise InputError(f"the limits of {name} must be {joints} positive numbers")
    return limits
