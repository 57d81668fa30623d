"""A machine at one posture: what most questions are asked of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Generic

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.circles import OrientationCircle
from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.coordinates import Coordinate, Joints, Pose, filled
from kinematics.answers.drawings import Drawing
from kinematics.answers.modes import Mode
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.singularities import AT, Event, ModeChange, Singularity
from kinematics.answers.solutions import Followed, Posture, Reason
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.faceted import Faceted
from kinematics.mechanism import D

Rates = Sequence[float] | Mapping[str, float] | Array
"""One number for each coordinate in their order, or by name; what is not named is zero."""


class Configuration(Generic[D]):
    """A machine at one pose in one mode, within reach or not; made by `Machine.at`.

    Attributes:
        machine: of which it is.
        posture: pose, mode, joints, reasons and margins as plain values.

    Example:
        >>> import kinematics as kin
        >>> here = kin.open("five-bar").at((100, 600), "+-")
        >>> here.reachable, here.nearest_singularity.kind
        (True, 'parallel')
    """

    def __init__(self, machine: Faceted[D], posture: Posture) -> None:
        self.machine = machine
        self.posture = posture

    def __repr__(self) -> str:
        mode = f", {self.mode.named}" if self.mode else ""
        why = "" if self.reachable else f": {self.reasons[0].text}"
        return f"<{self.machine.title} at {self.pose}{mode}{why}>"

    # --- what it is

    @property
    def pose(self) -> Pose:
        """Mm and rad."""
        return Pose(self.posture.pose, self.machine.coordinates)

    @property
    def mode(self) -> Mode:
        """The mode that it stands in."""
        return self.machine.mechanism.mode(self.posture.mode)

    @property
    def joints(self) -> Joints:
        """Actuated joints, mm or rad; NaN where a limb cannot close."""
        return Joints(self.posture.joints, self.machine.joints)

    @property
    def reachable(self) -> bool:
        """Every limb closes, and nothing is beyond a bound."""
        return self.posture.reachable

    @property
    def reasons(self) -> tuple[Reason, ...]:
        """Why it is not reachable: which bound, by how much, in words; empty where it is."""
        return self.posture.reasons

    @property
    def transform(self) -> Array:
        """(4, 4) from platform to base coordinates, mm."""
        return self.machine.transform(self.posture.pose, self.posture.mode)

    def drawing(self) -> Drawing:
        """Bars, bodies and marks, mm, base frame."""
        return self.machine.drawing(self.posture)

    def to_dict(self) -> dict[str, Any]:
        """As the command line's JSON has a solution of ``ik``; angles in degrees."""
        joints = [axis.outer(v) for v, axis in zip(self.joints, self.machine.joints, strict=True)]
        return {
            "pose": self.pose.to_dict(),
            **self.mode.entry,
            "joints": [v if v == v else None for v in joints],
            "within_stroke": self.reachable,
            "reasons": [reason.text for reason in self.reasons],
            "transform": self.transform.tolist(),
        }

    # --- how it moves, and what it bears

    def velocity(
        self,
        *,
        pose_rates: Rates | None = None,
        joint_rates: Rates | None = None,
        pose_accelerations: Rates | None = None,
        joint_accelerations: Rates | None = None,
    ) -> Motion:
        """Rates and accelerations of platform and actuators, from either of them.

        Args:
            pose_rates: (P,) mm/s and rad/s, or by name; or else
            joint_rates: (J,) mm/s or rad/s.
            pose_accelerations, joint_accelerations: mm/s² and rad/s²; zero if not given.

        Raises:
            InputError: both kinds of rates, or none; not finite numbers, or not as many as needed.
        """
        facet, at, mode = self.machine.motion, self.posture.pose, self.posture.mode
        if (pose_rates is None) == (joint_rates is None):
            raise InputError("a velocity takes either pose_rates=… or joint_rates=…")
        if pose_rates is not None:
            if joint_accelerations is not None:
                raise InputError("with pose_rates the accelerations are pose_accelerations=…")
            axes = self.machine.coordinates
            rates, more = _ordered(pose_rates, axes), _ordered(pose_accelerations, axes)
            return facet.inverse(at, mode, np.asarray(rates), more)
        if pose_accelerations is not None:
            raise InputError("with joint_rates the accelerations are joint_accelerations=…")
        axes = self.machine.joints
        rates, more = _ordered(joint_rates, axes), _ordered(joint_accelerations, axes)
        return facet.forward(at, mode, np.asarray(rates), more)

    def forces(self, load: ArrayLike) -> Statics:
        """What holds a load (6,) [F, T about O′] on the platform, N and N·mm, base frame.

        Raises:
            InputError: not six finite numbers.
        """
        return self.machine.statics.forces(self.posture.pose, self.posture.mode, load)

    def wrenches(self) -> WrenchSystem:
        """The unit wrenches that actuators and constraints can exert on the platform."""
        return self.machine.statics.wrenches(self.posture.pose, self.posture.mode)

    def measure(self, key: str, load: Sequence[float] | None = None) -> float:
        """One of the machine's measures, see ``machine.measures.specs``; NaN where it cannot close.

        Raises:
            InputError: there is no such measure, or it needs a load.
        """
        found = self.machine.measures(self.posture.pose, self.posture.mode, key, load)
        return float(found)

    # --- what is near

    def singularities(self, tolerance: float = AT) -> tuple[Singularity, ...]:
        """The singularities that it is in, with their causes, to a tolerance of `measure`."""
        return self.machine.singularities.at(self.posture, tolerance)

    @cached_property
    def _clearances(self) -> tuple[Clearance, ...]:
        return self.machine.clearances.of(self.posture)

    def clearances(self) -> tuple[Clearance, ...]:
        """How far the platform may move until something happens; the nearest first, mm."""
        return self._clearances

    @property
    def nearest_singularity(self) -> Clearance | None:
        """The nearest singularity in which the platform is not held; None where there is none."""
        lost = (way for way in self._clearances if way.kind in ("parallel", "constraint"))
        return next(lost, None)

    def nearest_pose(self) -> Remedy:
        """The ways out of a pose that cannot be held: another pose, mode or design."""
        return self.machine.clearances.nearest_pose(self.posture)

    def mode_change(self, wanted: str = "") -> ModeChange | None:
        """Where the mode may be changed without taking the machine apart; None where nowhere."""
        return self.machine.singularities.mode_change(self.posture, wanted)

    def circles(self) -> tuple[OrientationCircle, ...]:
        """The largest circles of orientations about its own; () where a machine has none."""
        facet = self.machine.circles
        return () if facet is None else facet.about(self.posture.pose, self.posture.mode)

    # --- moving on

    def follow(self, joints: Rates) -> Configuration[D]:
        """Where this assembly mode is with other joints, or where it ends on the way; by name some.

        `following` of the machine says also why.

        Raises:
            InputError: not J finite numbers, or no such joint.
        """
        return Configuration(self.machine, self.followed(joints).posture)

    def followed(self, joints: Rates) -> Followed:
        """The same with what stopped it and why: from here on a straight line in joint space."""
        if isinstance(joints, Mapping):
            joints = filled(self.posture.joints, self.machine.joints, joints)
        return self.machine.following.follow(self.posture, finite(joints, name="the joints"))

    def driven(self, poses: ArrayLike) -> Followed:
        """Through poses (N, P), as the machine is driven, up to what would stop it.

        Raises:
            InputError: no poses, or not P finite numbers each.
        """
        return self.machine.paths.drive(self.posture, poses)

    def passed(self, pose: Sequence[float]) -> tuple[Event, ...]:
        """What a straight move to a pose passes on its way, in order."""
        there = self.machine.posture(pose, self.posture.mode)
        return self.machine.paths.passed(self.posture, there)


def _ordered(given: Rates | None, axes: tuple[Coordinate, ...]) -> list[float] | Array | None:
    """Numbers in the order of the coordinates."""
    if given is None or not isinstance(given, Mapping):
        return None if given is None else finite(given, name="rates")
    return filled([0.0] * len(axes), axes, given)
