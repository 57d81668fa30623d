"""What a trajectory of a review is: plain values, what makes them sound, and the path they mean.

Lengths in mm, angles in rad, times in s; nothing here knows viser.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, Self

from app.language import tr
from app.review import content as session
from app.review.changes import Change, Taken
from app.review.state import Review, Slice
from kinematics.answers.trajectories import Playback
from kinematics.errors import InputError
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate
from kinematics.trajectories import LAWS, Limits, Path, TimeLaw, drawn, law, line, trapezoidal
from kinematics.trajectories.fits import HIGHEST
from kinematics.trajectories.points import PACE, through

Pose = tuple[float, ...]
Through = Literal["spline", "lines"]

PLAYBACKS: tuple[Playback, ...] = ("once", "loop", "swing")
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)
STRAIGHT, POINTS, FILE, STROKE = "straight", "points", "file", "stroke"
OWN = (STRAIGHT, POINTS, FILE, STROKE)  # ways of one's own; all others are the mechanism's
PLOTS = ("main", "all", "joints", "rates", "accelerations", "forces", "distance")
MOST_POINTS = 2000  # that a session keeps of one path
MOST_SAMPLES = 2001  # on the page; the command line takes more
TRIMMED = 300  # points of a stroke that are kept
_ENDS, _LISTS = ("start", "end"), ("points", "file", "stroke")
_TURNING = ("rates", "accelerations")  # limits that are of angles where a joint turns
# What serves a machine whatever its coordinates are.
_LASTING = ("on", "law", "playback", "pace", "halt", "samples", "degree", "plot", "through")


@dataclass(frozen=True)
class Plan(Slice):
    """A trajectory: where it runs, when, what is asked of it and how it is shown.

    Attributes:
        on: it is computed and shown.
        way: one of `OWN`, or the name of one of the mechanism's.
        start, end: of the straight way; () until they are chosen.
        points: way points.
        file, file_name, times: the points of a file, what it was called, and when each of them is
            to be passed, () where it does not say.
        file_open: the coordinate that the file left open, by its key; "" for none.
        through, blend: how points are joined, see `polyline`.
        plane: the two pose coordinates of a stroke, by their keys; "" for the first two.
        stroke: what was drawn by hand.
        smooth: mm by which that may be smoothed.
        law: one of `LAWS`; "" is the way's own, else quintic.
        duration: s; 0 is the way's own, else at `PACE`.
        speed, acceleration: what a trapezoidal law keeps to along the path, mm/s and mm/s².
        samples: how many times are computed.
        rates, accelerations, forces: limits of the actuators; () where there are none.
        playback, pace: how it is played, and how fast.
        halt: playing stops at singularities, as no machine is driven across one.
        degree: of the polynomials that are fitted to the joints; 0 for none.
        plot: what the plots show, one of `PLOTS`.
    """

    filed_as: ClassVar[str] = "trajectory"
    LOOKS: ClassVar[frozenset[str]] = frozenset(("on",))
    on: bool = False
    way: str = STRAIGHT
    start: Pose = ()
    end: Pose = ()
    points: tuple[Pose, ...] = ()
    file: tuple[Pose, ...] = ()
    file_name: str = ""
    times: tuple[float, ...] = ()
    file_open: str = ""
    through: Through = "spline"
    blend: float = 0.0
    plane: tuple[str, str] = ("", "")
    stroke: tuple[Pose, ...] = ()
    smooth: float = 2.0
    law: str = ""
    duration: float = 0.0
    speed: float = PACE
    acceleration: float = 400.0
    samples: int = 101
    rates: tuple[float, ...] = ()
    accelerations: tuple[float, ...] = ()
    forces: tuple[float, ...] = ()
    playback: Playback = "loop"
    pace: float = 1.0
    halt: bool = True
    degree: int = 0
    plot: str = "main"

    @property
    def limits(self) -> Limits:
        """As the library takes them."""
        return Limits(self.rates or None, self.accelerations or None, self.forces or None)

    @classmethod
    def fresh(cls, review: Review) -> Self:
        """The machine's own first trajectory, else one from its home."""
        named = review.machine.paths.named()
        return cls(way=named[0].name if named else STRAIGHT, start=review.machine.home.pose)

    def carried(self, before: Review, review: Review) -> Self:
        """All of it, if the other design has the same coordinates."""
        fresh = review[type(self)]
        kept = replace(fresh, **{name: getattr(self, name) for name in _LASTING})
        if not set(self.plane) <= {"", *(c.key for c in review.machine.coordinates)}:
            return kept
        known = {*OWN, *(each.name for each in review.machine.paths.named())}
        try:
            return (self if self.way in known else replace(self, way=fresh.way)).checked(review)
        except InputError:
            return kept

    def checked(self, review: Review) -> Self:
        machine = review.machine
        named = [each.name for each in machine.paths.named()]
        keys = [c.key for c in machine.coordinates]
        for name, known, what in (
            (self.way, (*OWN, *named), tr("trajectory.a_way")),
            (self.through, ("spline", "lines"), tr("trajectory.a_joining")),
            (self.law, ("", *LAWS), tr("trajectory.a_law")),
            (self.playback, PLAYBACKS, tr("trajectory.a_playback")),
            (self.plot, PLOTS, tr("trajectory.a_plot")),
        ):
            session.listed(name, known, tr("typing.one_of", what=what))
        _check_points(self, len(keys))
        if self.file_open not in ("", *keys):
            raise InputError(tr("trajectory.left_open", key=self.file_open))
        if not set(self.plane) <= {"", *keys}:
            raise InputError(tr("trajectory.stroke_of", keys=", ".join(keys)))
        if self.plane != ("", "") and ("" in self.plane or self.plane[0] == self.plane[1]):
            raise InputError(tr("trajectory.stroke_two"))
        for value, low, high, what in (
            (self.blend, 0.0, 1e6, tr("trajectory.a_blend")),
            (self.smooth, 0.0, 1e3, tr("trajectory.a_smoothing")),
            (self.duration, 0.0, 1e6, tr("trajectory.a_duration")),
            (self.speed, 1e-6, 1e9, tr("trajectory.a_speed")),
            (self.acceleration, 1e-6, 1e12, tr("trajectory.an_acceleration")),
            (self.pace, SPEEDS[0], SPEEDS[-1], tr("trajectory.a_pace")),
            (self.samples, 2, MOST_SAMPLES, tr("trajectory.a_count")),
            (self.degree, 0, HIGHEST, tr("trajectory.a_degree")),
        ):
            if not (math.isfinite(value) and low <= value <= high):
                raise InputError(tr("typing.between", what=what, low=low, high=high, value=value))
        if 0.0 < self.duration < 1e-6:
            raise InputError(tr("trajectory.too_short"))
        count = len(machine.joints)
        for what in ("rates", "accelerations", "forces"):
            values: tuple[float, ...] = getattr(self, what)
            fit = len(values) == count and all(math.isfinite(v) and v > 0.0 for v in values)
            if values and not fit:
                raise InputError(tr("trajectory.limits_of", what=what, count=count))
        return self

    # --- in a session file: a pose is one line of numbers, so that paths stay short

    def write(self, name: str, review: Review) -> Any:
        value, axes = getattr(self, name), review.machine.coordinates
        if name in _ENDS:
            return _written(value, axes)
        if name in _LISTS:
            return [_written(pose, axes) for pose in value]
        if name == "times":
            return " ".join(map(repr, value))
        if name in _TURNING:
            joints = review.machine.joints
            return [c.outer(v) for c, v in zip(joints, value, strict=False)]
        return value

    @classmethod
    def taken(cls, name: str, value: Any, review: Review, what: str) -> Any:
        axes, joints = review.machine.coordinates, review.machine.joints
        if name in _ENDS:
            return _pose(value, axes, what)
        if name in _LISTS and isinstance(value, list):
            return tuple(_pose(each, axes, what) for each in value)
        if name == "times":
            return _numbers(value, what)
        if name == "plane":
            if not isinstance(value, list) or [type(key) for key in value] != [str, str]:
                raise InputError(tr("session.wrong_kind", what=what))
            return tuple(value)
        value = super().taken(name, value, review, what)
        if name in _TURNING and isinstance(value, tuple) and len(value) == len(joints):
            return tuple(c.inner(v) for c, v in zip(joints, value, strict=True))
        return value


@dataclass(frozen=True)
class SetPlan(Change):
    """Set some things of the trajectory, by name; values are of the kinds that `Plan` has."""

    values: tuple[tuple[str, Any], ...]
    gesture: str = ""

    def apply(self, review: Review) -> Taken:
        return review.having(replace(review[Plan], **dict(self.values)).checked(review)), ""


def set_plan(name: str, value: Any) -> SetPlan:
    """Set one thing of the trajectory."""
    return SetPlan(((name, value),))


def step_plan(name: str, value: Any) -> SetPlan:
    """Set one thing of it, as a step of typing it."""
    return SetPlan(((name, value),), gesture=f"plan {name}")


def _written(pose: Pose, axes: Sequence[Coordinate]) -> str:
    return " ".join(repr(c.outer(v)) for c, v in zip(axes, pose, strict=False))


def _pose(text: Any, axes: Sequence[Coordinate], what: str) -> Pose:
    values = _numbers(text, what)
    if values and len(values) != len(axes):
        raise InputError(tr("session.pose", what=what, count=len(axes), got=len(values)))
    return tuple(c.inner(v) for c, v in zip(axes, values, strict=False))


def _numbers(text: Any, what: str) -> tuple[float, ...]:
    if not isinstance(text, str):
        raise InputError(tr("session.wrong_kind", what=what))
    try:
        return tuple(map(float, text.split()))
    except ValueError:
        raise InputError(tr("session.numbers", what=what)) from None


def plane_of(plan: Plan, axes: Sequence[Coordinate]) -> tuple[int, int]:
    """The two coordinates in whose plane a stroke is drawn."""
    keys = [c.key for c in axes]
    first, second = (keys.index(k) if k in keys else n for n, k in enumerate(plan.plane))
    return first, second


def _check_points(plan: Plan, size: int) -> None:
    groups = ([plan.start], [plan.end], plan.points, plan.file, plan.stroke)
    ends = [tuple(p for p in group if p) for group in groups[:2]]
    for points in (*ends, *groups[2:]):
        if len(points) > MOST_POINTS:
            raise InputError(tr("trajectory.too_many", most=MOST_POINTS, count=len(points)))
        if any(len(p) != size or not all(map(math.isfinite, p)) for p in points):
            raise InputError(tr("trajectory.point_of", count=size))
    if plan.times and len(plan.times) != len(plan.file):
        raise InputError(tr("trajectory.times_all"))
    if any(not math.isfinite(t) for t in plan.times):
        raise InputError(tr("trajectory.times_finite"))
    if any(b <= a for a, b in zip(plan.times, plan.times[1:], strict=False)):
        raise InputError(tr("trajectory.times_order"))


# --- what a plan means ---------------------------------------------------------------------


def missing(plan: Plan) -> str:
    """What a person still has to do until there is a path; "" when nothing."""
    match plan.way:
        case "straight" if not plan.start or not plan.end:
            return tr("trajectory.put_start" if not plan.start else "trajectory.put_end")
        case "points" if len(plan.points) < 2:
            return tr("trajectory.add_points")
        case "file" if not plan.file:
            return tr("trajectory.open_file")
        case "stroke" if not plan.stroke:
            return tr("trajectory.draw_path")
    return ""


def path_of(plan: Plan, machine: Machine[Any]) -> tuple[Path, TimeLaw]:
    """The path of a plan, and its time law.

    Raises:
        InputError: something is missing, or the points make no path.
    """
    if missing(plan):
        raise InputError(missing(plan))
    length = machine.length
    scale = [length if c.unit == "rad" else 1.0 for c in machine.coordinates]
    named = next((t for t in machine.paths.named() if t.name == plan.way), None)
    if named is not None:
        return named.path, _law(plan, named.path, named.law)
    if plan.way == STRAIGHT:
        path: Path = line(plan.start, plan.end, scale)
    elif plan.way == STROKE:
        path = drawn(plan.stroke, scale, plan.smooth)
    else:
        points, times = (plan.points, ()) if plan.way == POINTS else (plan.file, plan.times)
        straight = plan.through == "lines"
        path, own = through(points, scale, times, straight=straight, blend=plan.blend)
        return path, _law(plan, path, own)
    return path, _law(plan, path, law("quintic", max(1.0, path.length / PACE)))


def _law(plan: Plan, path: Path, own: TimeLaw) -> TimeLaw:
    machine = plan.law or own.kind
    if plan.law == "trapezoidal":
        return trapezoidal(path.length, plan.speed, plan.acceleration)
    duration = plan.duration or own.duration
    return law(machine, duration, ramp=own.ramp)


def trimmed(points: Sequence[Pose]) -> tuple[Pose, ...]:
    """A stroke with no more points than are kept, evenly left out."""
    if len(points) <= TRIMMED:
        return tuple(points)
    step = (len(points) - 1) / (TRIMMED - 1)
    return tuple(points[round(n * step)] for n in range(TRIMMED))
