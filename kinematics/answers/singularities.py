"""Where control is lost, and what a move of the pose meets: plain results.

Serial (type 1): a limb is at the end of its reach and its two solutions meet. Parallel (type 2):
the wrenches no longer hold the platform with all actuators locked. Constraint: the constraint
wrenches alone are dependent. Lengths mm, angles rad.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinematics.answers.solutions import Posture

SingularityKind = Literal["serial", "parallel", "constraint", "self-motion", "architectural"]


AT = 1e-6
"""A measure below this is a singularity to within the numbers that people type."""


NEAR = 2e-2
"""A measure below this is near enough to be told to someone who drags the platform about."""


@dataclass(frozen=True, slots=True)
class Singularity:
    """One way in which the machine has lost control at a posture.

    Attributes:
        kind: which.
        limbs: those whose wrenches take part, from 1.
        cause: the geometry in the field's words, as "the lines of limbs 1, 2 and 4 lie in a plane
            and meet in a point".
        text: one sentence for the user: what is lost.
        measure: how exactly it holds: 0 at the singularity (smallest singular value of the wrench
            matrix with unit rows and moments by the characteristic length, or its like).
        motion: d(pose) of the motion that is free, of unit length with angles times the
            characteristic length; None where none is (serial).
        twist: (6,) the same as [ω, v], None likewise.
    """

    kind: SingularityKind
    limbs: tuple[int, ...]
    cause: str
    text: str
    measure: float
    motion: tuple[float, ...] | None = None
    twist: tuple[float, ...] | None = None


@dataclass(frozen=True, slots=True)
class ModeChange:
    """The way to the place where a machine can change its operation or working mode.

    Attributes:
        at: the nearest such posture found, in the present mode; its own where it stands in it.
        other: the same configuration in the other mode, from which that one can be gone on with.
        here: the machine stands in it: the mode may be changed now.
        turn: rad, by how much the platform has to turn until there; 0 where it is there.
        blocked: on the straight way there a parallel singularity or an end of a stroke is met.
        text: one sentence for the user.
    """

    at: Posture
    other: Posture
    here: bool
    turn: float
    blocked: bool
    text: str


EventKind = Literal["parallel", "serial", "stroke"]


@dataclass(frozen=True, slots=True)
class Event:
    """Something that a move of the pose, in one mode, passes on its way.

    Attributes:
        kind: a parallel or a serial singularity; an end of a limb's stroke.
        fraction: of the way, 0 to 1.
        pose: there.
        limb: from 1; None of parallel singularities.
        text: one sentence for the user, in the past tense.
        stops: a machine driven along the way would have to stop there; not so where a singularity
            is only passed nearby, or a limb comes back within its bounds.
    """

    kind: EventKind
    fraction: float
    pose: tuple[float, ...]
    limb: int | None
    text: str
    stops: bool


@dataclass(frozen=True, slots=True)
class Measure:
    """A number that tells how well a posture is held: "conditioning", "manipulability", …

    ``better`` says which way is good; ``limits`` are its least and largest value where it has such.
    """

    key: str
    title: str
    unit: str
    better: Literal["high", "low"]
    limits: tuple[float | None, float | None] = (None, None)
    needs_load: bool = False
