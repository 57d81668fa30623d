"""What a lane of its own computes of the solutions: all of them, or the folds ahead of a posture.

A general design takes from a tenth of a second to more than one, too long for the page's loop.
"""

from __future__ import annotations

from dataclasses import dataclass

from app.features.solutions.folds import look_ahead
from app.jobs.lane import Job
from kinematics.answers.solutions import ForwardSolutions, Posture, Refreshed
from kinematics.machine import machine_of
from kinematics.mechanism import Design

REST = 0.15  # s without a new wish before work on it begins


@dataclass(frozen=True, eq=False, slots=True)
class Wish:
    """Solutions to find, or folds to look for; no two wishes are the same work.

    Attributes:
        before: a set to go on from, None to find all from scratch.
        posture: look for the folds ahead of it; None to find solutions.
    """

    design: Design
    joints: tuple[float, ...]
    mixed: bool = False
    before: ForwardSolutions | None = None
    posture: Posture | None = None


def job(wish: Wish) -> Job:
    """What a lane has to do for a wish, once the hand rests.

    It returns `Refreshed`, in which from scratch all solutions count as having been there before;
    of folds it returns all `Ahead`.
    """
    if wish.posture is not None:
        return Job(wish, "the folds ahead", look_ahead, (wish.design, wish.posture), REST)
    arguments = (wish.design, wish.joints, wish.mixed, wish.before)
    return Job(wish, "all solutions", solve, arguments, REST)


def solve(
    design: Design, joints: tuple[float, ...], mixed: bool, before: ForwardSolutions | None
) -> Refreshed:
    """All solutions at these joints, gone on from ``before`` if there is such a set."""
    machine = machine_of(design)
    if before is not None:
        return machine.forward.refresh(before, joints)
    (found,) = machine.forward([joints], mixed_modes=mixed)
    return Refreshed(found, (), ())
