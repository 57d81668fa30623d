"""Where control is lost, how far that is, and why a pose cannot be reached: plain results.

Serial (type 1): a limb is at the end of its reach and its two solutions meet. Parallel (type 2):
the wrenches no longer hold the platform with all actuators locked. Constraint: the constraint
wrenches alone are dependent. Lengths mm, angles rad, base frame. Arrays are read-only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinematics.answers.sections import Ints
from kinematics.answers.solutions import Posture
from kinematics.screws.spatial import Array, Frozen

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


ClearanceKind = Literal["parallel", "constraint", "boundary", "stroke", "mode"]


@dataclass(frozen=True, slots=True)
class Clearance:
    """How far the platform may move, at its orientation, until something happens.

    Attributes:
        kind: a parallel or constraint singularity; the boundary of the workspace; an end of a
            limb's stroke; the change of a limb's working mode (its serial singularity).
        distance: mm; negative where it has happened: so far is the way back.
        point: (x, y, z) of O′ there.
        text: one sentence for the user.
        limb: from 1, of strokes, modes and the boundary.
        bound: "rho_min", "rho_max" or "link", likewise.
        error: mm, an estimate from above of the error of ``distance``.
        angle: rad, where the way is a turn; ``distance`` is then about that of the platform's
            joints.
        along: the only line that the orientation leaves, as "along z"; "" where all ways count.
    """

    kind: ClearanceKind
    distance: float
    point: tuple[float, float, float]
    text: str
    limb: int | None = None
    bound: str = ""
    error: float = 0.0
    angle: float | None = None
    along: str = ""


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


CircleLimit = Literal["parallel", "constraint", "stroke"]


@dataclass(frozen=True, slots=True)
class OrientationCircle:
    """The largest circle of orientations about one, at a fixed position, that one limit leaves.

    Attributes:
        limit: which.
        radius: rad, the angle by which the platform can turn from the centre in every direction;
            π where nothing is met.
        contacts: (tilt, azimuth) of the orientations that are met first, rad; none at π.
        limb: from 1, whose stroke ends; None for singularities.
        bound: "rho_min" or "rho_max", likewise.
        barred: within the circle there are orientations without any position at this altitude.
        error: rad, an estimate from above of the error of ``radius``.
        text: one sentence for the user.
    """

    limit: CircleLimit
    radius: float
    contacts: tuple[tuple[float, float], ...]
    text: str
    limb: int | None = None
    bound: str = ""
    barred: bool = False
    error: float = 0.0


@dataclass(frozen=True, eq=False)
class MicrTable(Frozen):
    """Maximum inscribed circle radii (MICR) about the level platform, of many machines.

    Attributes:
        modes: M operation modes.
        radius: (M, ...) rad; NaN where no tilt is singular.
        contact: (M, ...) the azimuth that is met first, rad, one of those that symmetry makes.
        barred: (M, ...) the circle holds tilts without any position at this altitude.
        printed: (M, ...) degrees, what the method of the mechanism's paper prints of it.
        note: why that is another number; "" where there is no such paper.
    """

    modes: tuple[str, ...]
    radius: Array
    contact: Array
    barred: np.ndarray
    printed: Array
    note: str


@dataclass(frozen=True, eq=False)
class ProfileCurve(Frozen):
    """One curve of a `Profile`: ``title`` and ``mode`` say of what, ``own`` whether of the very
    machine; ``radius`` (N,) rad, π where nothing is met.
    """

    title: str
    mode: str
    own: bool
    radius: Array


@dataclass(frozen=True, eq=False)
class Profile(Frozen):
    """Radii of circles of orientations, rad, against a ratio of lengths.

    Attributes:
        title, across, up: what it is, and what its axes are called.
        x: (N,) the ratio.
        at: where the machine stands.
    """

    title: str
    across: str
    up: str
    x: Array
    curves: tuple[ProfileCurve, ...]
    at: float
    figure: str = ""


@dataclass(frozen=True, slots=True)
class DesignChange:
    """A change of one number of the design; ``path`` as in `mechanism.DesignField`."""

    path: tuple[str | int, ...]
    label: str
    before: float
    after: float
    text: str


@dataclass(frozen=True, slots=True)
class Remedy:
    """The ways out of a pose that cannot be held.

    Attributes:
        nearest: the nearest posture that can be held, at the same orientation and mode if there is
            one; None where there is none.
        distance: mm from the pose to there, by the position of O′ alone.
        changes: for each way, the smallest changes of the design that together would allow the
            pose, one of each limb at fault; the way with the smallest sum first. Empty where none
            would.
        text: one sentence for the user.
        modes: other modes in which the very pose can be held.
        error: mm, an estimate from above of how much nearer another posture may be; infinite where
            the nearest was searched for and not proven.
    """

    nearest: Posture | None
    distance: float
    changes: tuple[tuple[DesignChange, ...], ...]
    text: str
    modes: tuple[str, ...] = ()
    error: float = 0.0


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
class LocusSpec:
    """A chart of singularity loci that a mechanism can draw: two coordinates, all else held.

    ``axes`` are symbols. A polar chart's are radius and azimuth (rad). The chart "section" is in
    the plane of `mechanism.SectionSpec` that stands at ``at``.
    """

    key: str
    title: str
    axes: tuple[str, str]
    units: tuple[Literal["mm", "rad"], Literal["mm", "rad"]]
    polar: bool = False
    figure: str = ""


@dataclass(frozen=True, eq=False)
class LocusCurves(Frozen):
    """Curves of a `LocusSpec` chart, in its two coordinates.

    Attributes:
        points: (N, 2) mm or rad, all curves one after another.
        start: (C + 1,) curve c is points[start[c]:start[c + 1]]; closed if its ends are equal.
        kinds: of each curve.
        limb: (C,) whose serial singularity it is, from 1; 0 of others.
        residual: (N,) what the defining function leaves at each point, as a distance in the
            chart's first unit (|f| / |grad f|).
        bounds: (2, 2) lowest and highest of both coordinates that were searched.
        barriers: radii of a polar chart at which there is no posture at all.
    """

    points: Array
    start: Ints
    kinds: tuple[SingularityKind, ...]
    limb: Ints
    residual: Array
    bounds: Array
    barriers: tuple[float, ...] = ()

    def lost(self) -> list[Array]:
        """The curves (K, 2) each where the platform is not held: all but serial singularities."""
        return [
            self.points[self.start[c] : self.start[c + 1]]
            for c, kind in enumerate(self.kinds)
            if kind != "serial"
        ]


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
