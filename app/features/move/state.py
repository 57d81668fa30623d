"""Where the machine stands: by its pose, by its actuators, in which mode."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from app.language import tr
from app.review.changes import Change, Taken
from app.review.state import Review
from app.review.units import joint_text, place_text, within
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate


@dataclass(frozen=True)
class Move(Change):
    """Set one pose coordinate."""

    index: int
    value: float

    @property
    def gesture(self) -> str:
        return f"move {self.index}"

    def apply(self, review: Review) -> Taken:
        axis = _nth(review.machine.coordinates, self.index)
        value, note = within(axis, self.value, beyond=1.0)  # out of reach, and told why
        pose = (*review.pose[: self.index], value, *review.pose[self.index + 1 :])
        return replace(review, pose=completed(review, pose, self.index)), note


@dataclass(frozen=True)
class Place(Change):
    """Set the whole pose, as when the platform is dragged."""

    pose: tuple[float, ...]
    gesture: str = "place"
    held: int = 0

    def apply(self, review: Review) -> Taken:
        coordinates = review.machine.coordinates
        if len(self.pose) != len(coordinates):
            raise InputError(tr("move.pose_of", count=len(coordinates)))
        taken = [within(c, v) for c, v in zip(coordinates, self.pose, strict=True)]
        notes = " ".join(note for _, note in taken if note)
        pose = completed(review, tuple(value for value, _ in taken))
        return replace(review, pose=pose), notes


@dataclass(frozen=True)
class Drive(Change):
    """Set one actuated joint; the platform follows along its assembly mode."""

    index: int
    value: float

    @property
    def gesture(self) -> str:
        return f"drive {self.index}"

    def title(self, before: Review, after: Review) -> str:
        joint = after.machine.joints[self.index]
        return tr("move.driven", joint=joint.symbol, value=joint_text(joint, self.value))

    def apply(self, review: Review) -> Taken:
        value, note = within(_nth(review.machine.joints, self.index), self.value)
        posture = review.posture
        if not posture.closes:
            limbs = [r.limb for r in posture.reasons if r.bound == "link"]
            what = tr("move.limb_open", limb=limbs[0]) if limbs else tr("move.it_is_open")
            raise InputError(tr("move.not_assembled", what=what))
        joints = (*posture.joints[: self.index], value, *posture.joints[self.index + 1 :])
        followed = review.machine.following.follow(posture, joints)
        reached = replace(review, pose=followed.posture.pose, mode=followed.posture.mode)
        return reached, followed.text or followed.warning or note


@dataclass(frozen=True)
class Flip(Change):
    """Put the whole machine into another mode: at once where limbs can be put over, else where
    the modes meet.
    """

    mode: str

    def apply(self, review: Review) -> Taken:
        machine = review.machine
        if self.mode not in machine.modes:
            raise InputError(tr("move.no_mode", noun=machine.mode_noun, mode=self.mode))
        way = machine.singularities.mode_change(review.posture, self.mode)
        if way is None or self.mode == review.mode:
            return replace(review, mode=self.mode), ""
        if not way.here:
            raise InputError(way.text)
        return replace(review, pose=way.other.pose, mode=way.other.mode), ""


@dataclass(frozen=True)
class Visit(Change):
    """Put the machine into another assembly mode: a pose and a working mode, taken as they are."""

    pose: tuple[float, ...]
    mode: str

    def title(self, before: Review, after: Review) -> str:
        return tr("move.visited", place=place_text(after.machine.coordinates, after.pose))

    def apply(self, review: Review) -> Taken:
        # Not kept within the sliders' range: a solution next to it would be none.
        known = self.mode in review.machine.modes and len(self.pose) == len(review.pose)
        if not known or not all(map(math.isfinite, self.pose)):
            raise InputError(tr("move.no_solution"))
        return replace(review, pose=tuple(self.pose), mode=self.mode), ""


@dataclass(frozen=True)
class GoHome(Change):
    """Back to the design's home posture."""

    def title(self, before: Review, after: Review) -> str:
        return tr("move.at_home")

    def apply(self, review: Review) -> Taken:
        home = review.machine.home
        return replace(review, pose=home.pose, mode=home.mode), ""


@dataclass(frozen=True)
class GiveWay(Change):
    """Which pose coordinate follows from the others; "" leaves that to the mechanism."""

    key: str

    def apply(self, review: Review) -> Taken:
        return review.giving_way(self.key), ""


def completed(
    review: Review, pose: tuple[float, ...], moved: int | None = None
) -> tuple[float, ...]:
    """The pose with the coordinate that follows from the others."""
    return review.machine.complete_pose(pose, review.mode, moved, review.dependent)


def _nth(coordinates: tuple[Coordinate, ...], index: int) -> Coordinate:
    """The coordinate that a slider moves; another design may have come in between."""
    if not 0 <= index < len(coordinates):
        raise InputError(tr("move.too_few", count=len(coordinates)))
    return coordinates[index]
