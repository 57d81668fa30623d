"""Where the coordinates of the pose can go, in a process of its own."""

from __future__ import annotations

from app.jobs.answers import Asked, Question
from app.review.state import Review
from kinematics.arrays import Array
from kinematics.facets.reach import reach
from kinematics.machine import machine_of
from kinematics.mechanism import Design

REST = 0.08  # s; while the hand moves faster, what was known stays


def spans(
    design: Design, pose: tuple[float, ...], mode: str, dependent: int | None
) -> tuple[Array, ...]:
    """See `kinematics.facets.reach`."""
    return reach(machine_of(design).inverse, pose, mode, dependent)


REACH = Question("work.pose_reach", "reach", spans, REST)


def reach_asked(review: Review) -> Asked[tuple[Array, ...]]:
    """The question about a review's pose."""
    request = review.design, review.pose, review.mode, review.dependent
    return REACH(request, *request)
