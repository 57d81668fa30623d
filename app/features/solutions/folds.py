"""Where the present assembly mode ends: the nearest fold in both directions of every actuator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.features.solutions.atlas import Known, joint_text, pose_text
from app.review.modes import page_mode
from app.review.state import Review
from kinematics.answers.solutions import Fold, Posture
from kinematics.machine import machine_of
from kinematics.mechanism import Design

SAME = 1e-3  # mm and rad: a partner this near to a known solution is that solution


@dataclass(frozen=True, eq=False, slots=True)
class Ahead:
    """One actuator driven alone to one end of its stroke, and the fold on the way, if any.

    Attributes:
        index: the actuator, from 0.
        start: where it stands, mm or rad.
        end: the end of its stroke.
        fold: where the assembly mode ends before that.
    """

    index: int
    start: float
    end: float
    fold: Fold | None

    @property
    def goal(self) -> float:
        """How far the actuator can go on this assembly mode."""
        return self.end if self.fold is None else self.fold.joints[self.index]

    @property
    def longer(self) -> bool:
        """The direction: towards the upper end."""
        return self.end > self.start


def look_ahead(design: Design, posture: Posture) -> tuple[Ahead, ...]:
    """Both directions of every actuator that has somewhere to go."""
    machine = machine_of(design)
    found = []
    for index, axis in enumerate(machine.joints):
        start = posture.joints[index]
        for end, sign in ((axis.lower, -1), (axis.upper, 1)):
            if sign * (end - start) > 0:
                joints = (*posture.joints[:index], end, *posture.joints[index + 1 :])
                fold = machine.following.fold_ahead(posture, joints)
                found.append(Ahead(index, start, end, fold))
    return tuple(found)


def nearest_first(ahead: Sequence[Ahead], driven: int | None) -> list[Ahead]:
    """Those with a fold: of the actuator that was last driven before the others, then nearest."""
    folds = [(a.index != driven, a.fold.distance, n) for n, a in enumerate(ahead) if a.fold]
    return [ahead[n] for *_, n in sorted(folds)]


def title(review: Review, ahead: Ahead) -> str:
    """ "ρ₃ +33.7 mm": short enough for a menu."""
    axis = review.machine.joints[ahead.index]
    way = joint_text(axis, ahead.goal - ahead.start)
    return f"{axis.symbol} {way if way.startswith('−') else f'+{way}'}"


def words(review: Review, ahead: Ahead, known: Known | None) -> str:
    """What happens there, in one or two sentences."""
    fold = ahead.fold
    if fold is None:
        return ""
    axis = review.machine.joints[ahead.index]
    change = "Raising" if ahead.longer else "Lowering"
    text = (
        f"{change} {axis.symbol} by {joint_text(axis, abs(ahead.goal - ahead.start))}, to "
        f"{joint_text(axis, ahead.goal)}, ends this assembly mode at {pose_text(review, fold.pose)}"
    )
    if fold.mode != review.mode:
        text += f" (by then in mode {page_mode(fold.mode)})"
    if fold.partner is None:
        return f"{text}. The branch that it merges with does not reach back to these lengths."
    of_this = known is not None and known.is_of(review)  # else of the machine before
    other = partner(known, fold.partner) if of_this else None
    name = "a solution" if other is None else f"solution #{other}"
    return f"{text}. There it merges with {name} (mode {page_mode(fold.partner.mode)})."


def partner(known: Known | None, posture: Posture) -> int | None:
    """The identity of the known solution that a posture is; None if it is none of them."""
    if known is None or not len(known.solutions):
        return None
    off = np.abs(known.solutions.poses - posture.pose).max(axis=1)
    nearest = int(off.argmin())
    same = off[nearest] < SAME and known.solutions.modes[nearest] == posture.mode
    return known.solutions.identities[nearest] if same else None
