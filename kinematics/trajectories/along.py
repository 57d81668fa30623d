"""A machine on its path: where it is at any time, and what its actuators do there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan
from typing import Any

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.answers.trajectories import Path, TimeLaw
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.faceted import Faceted


@dataclass(frozen=True, eq=False)
class Along:
    """A machine on its path: what it is at any time."""

    machine: Faceted[Any]
    path: Path
    law: TimeLaw
    mode: str

    def pose(self, time: float) -> tuple[float, ...]:
        """At a time, s."""
        s, _, _ = self.law.at([time])
        return tuple(float(v) for v in self.path.at(s)[0][0])

    def posture(self, time: float) -> Posture:
        """At a time, s."""
        return self.machine.inverse.posture(self.pose(time), self.mode)

    def room(self, time: float) -> float:
        """How far from its nearest limit, relative to a characteristic length or rad; negative
        beyond it, and infinite where a dependent coordinate has no value.
        """
        try:
            pose = self.pose(time)
        except InputError:
            return -inf
        return self.room_of(pose)

    def room_of(self, pose: Sequence[float]) -> float:
        """The same of a pose."""
        posture = self.machine.inverse.posture(pose, self.mode)
        length = self.machine.length
        least = min(
            (m.amount / (length if m.unit == "mm" else 1.0) for m in posture.margins), default=inf
        )
        return least if posture.reachable else min(least, -1e-15)

    def determinant(self, time: float) -> float:
        """Of the wrenches, at a time, s."""
        system = self.machine.statics.wrenches([self.pose(time)], self.mode)
        return float(system.determinant[0])

    def distance(self, pose: Sequence[float]) -> float:
        """mm to the nearest parallel or constraint singularity; inf: none; NaN: not known."""
        posture = self.machine.inverse.posture(tuple(map(float, pose)), self.mode)
        if not posture.reachable:
            return nan
        found = self.machine.clearances.of(posture)
        return min((c.distance for c in found if c.kind in ("parallel", "constraint")), default=inf)

    def joints(self, times: Array) -> tuple[Array, np.ndarray]:
        """Joints (N, J), angles without leaps of a turn, and which poses can be held, at times."""
        _, poses, _, _ = moved(self.path, self.law, times)
        return joints_along(self.machine, poses, self.mode)

    def asked(self, times: Array, load: Sequence[float] | None) -> tuple[Array, Array, Array]:
        """Rates and accelerations of the joints (N, J), and the forces (N, R) that hold a load, at
        times (N,); NaN where the path or the machine has none.
        """
        joints = len(self.machine.joints)
        try:
            _, poses, rates, accelerations = moved(self.path, self.law, times)
        except InputError:  # somewhere a dependent coordinate has no value
            if len(times) == 1:
                home, statics = self.machine.home, self.machine.statics
                wrenches = (
                    0 if load is None else len(statics.wrenches([home.pose], home.mode).names)
                )
                return (
                    np.full((1, joints), nan),
                    np.full((1, joints), nan),
                    np.full((1, wrenches), nan),
                )
            half = len(times) // 2
            parts = (self.asked(times[:half], load), self.asked(times[half:], load))
            a, b, c = (np.concatenate(pair) for pair in zip(*parts, strict=True))
            return a, b, c
        found = self.machine.motion.inverse(poses, self.mode, rates, accelerations)
        forces = np.zeros((len(times), 0))
        if load is not None:
            forces = self.machine.statics.forces(poses, self.mode, np.array(load)).forces
        return found.joint_rates, found.joint_accelerations, forces


def moved(path: Path, law: TimeLaw, times: Array) -> tuple[Array, Array, Array, Array]:
    """Shares (N,), poses, their rates and accelerations (N, P) at times (N,)."""
    s, ds, dds = law.at(times)
    points, first, second = path.at(s)
    rates = first * ds[:, None]
    accelerations = second * (ds**2)[:, None] + first * dds[:, None]
    return s, points, rates, accelerations


def joints_along(machine: Faceted[Any], poses: Array, mode: str) -> tuple[Array, np.ndarray]:
    """Joints (N, J) in one mode, angles without leaps of a turn, and which poses can be held."""
    answer = machine.inverse(poses)
    n = answer.modes.index(mode)
    joints = np.array(answer.joints[:, n])
    reachable = np.array(answer.within_stroke[:, n])
    for k, coordinate in enumerate(machine.joints):
        if coordinate.unit == "rad":
            ok = np.isfinite(joints[:, k])
            joints[ok, k] = np.unwrap(joints[ok, k])
    return joints, reachable
