"""What is computed of control in a process of its own: pure functions and plain results."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.features.singularities.state import Control
from app.jobs.answers import Question
from app.review.state import Review
from app.review.view import Beside, joint_rows
from app.scene.palette import LIMBS
from kinematics.answers.circles import OrientationCircle, Profile
from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.drawings import Body
from kinematics.answers.loci import LocusCurves
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.sections import Sphere
from kinematics.answers.singularities import NEAR, Event, Measure, Singularity
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.machine import Machine, machine_of, required
from kinematics.mechanism import Design

SLACK = 0.02  # of a stroke: facets of a solid lie a little beside its true surface


OTHER = 4 * len(LIMBS)  # limbs of a counterpart are counted from here, in the same colours
APART = 3.4  # of the machine's size: how far it stands away


@dataclass(frozen=True, slots=True)
class Place:
    """A posture, the load that it is to hold ([F, T] at O′, N and N·mm), and how it moves."""

    design: Design
    pose: tuple[float, ...]
    mode: str
    load: tuple[float, ...]
    rates: tuple[float, ...] = ()
    accelerations: tuple[float, ...] = ()

    @property
    def machine(self) -> Machine[Any]:
        return machine_of(self.design)

    @property
    def posture(self) -> Posture:
        return self.machine.inverse.posture(self.pose, self.mode)


@dataclass(frozen=True, eq=False, slots=True)
class Here:
    """What is known of control at a place.

    Attributes:
        singular: the ways in which control is lost; none as a rule.
        measures: each with its value; NaN where it has none.
        wrenches, statics: at this one posture; None where the machine does not close.
        clearances: sorted, the nearest first.
        remedy: the ways out; None where the pose can be held.
        motion: at the rates that are asked for; None where there are none.
        circles: of orientations, one for each limit; none where a mechanism has none.
    """

    place: Place
    singular: tuple[Singularity, ...]
    measures: tuple[tuple[Measure, float], ...]
    wrenches: WrenchSystem | None
    statics: Statics | None
    clearances: tuple[Clearance, ...]
    remedy: Remedy | None
    circles: tuple[OrientationCircle, ...]
    motion: Motion | None

    @property
    def force_units(self) -> tuple[str, ...]:
        """The units of `statics`, one for each: N, or N·mm of couples and of rotary actuators."""
        if self.wrenches is None:
            return ()
        joints = self.place.machine.joints
        turns = [
            joints[n].unit == "rad" if name.kind == "actuation" else not np.any(row[:3])
            for n, (name, row) in enumerate(
                zip(self.wrenches.names, self.wrenches.rows, strict=True)
            )
        ]
        return tuple("N·mm" if turn else "N" for turn in turns)

    @property
    def exerted(self) -> Array:
        """(R,) by how much of each row of `wrenches` the limbs hold the load; NaN if they do not.

        That is what acts on the platform; an actuator of which the line is not the limb's own feels
        another force (`statics`).
        """
        if self.wrenches is None or self.statics is None:
            return np.empty(0)
        rows = np.asarray(self.wrenches.rows)
        if not (np.isfinite(rows).all() and np.isfinite(self.statics.forces).all()):
            return np.full(len(rows), np.nan)
        found: Array = np.linalg.lstsq(rows.T, -np.array(self.place.load), rcond=None)[0]
        return found

    def nearest(self, *kinds: str) -> Clearance | None:
        """The nearest of what is of one of these kinds."""
        return next((c for c in self.clearances if c.kind in kinds), None)


def spot_of(review: Review) -> Place:
    """Where the machine stands, with its load."""
    control = review[Control]
    return Place(
        review.design, review.pose, review.mode, control.load, control.rates, control.accelerations
    )


def counterpart(review: Review) -> Place | None:
    """The counterpart at the same coordinates, where it is to be compared with."""
    others = review.machine.counterparts if review[Control].compare else ()
    return next((replace(spot_of(review), design=other) for other in others), None)


def look(place: Place) -> Here:
    """What is known of control at a place."""
    machine, posture = place.machine, place.posture
    closes = posture.closes
    measures = tuple((m, _value(place, m) if closes else math.nan) for m in machine.measures.specs)
    return Here(
        place,
        machine.singularities.at(posture, NEAR) if closes else (),
        measures,
        machine.statics.wrenches(place.pose, place.mode) if closes else None,
        machine.statics.forces(place.pose, place.mode, place.load) if closes else None,
        machine.clearances.of(posture),
        None if posture.reachable else machine.clearances.nearest_pose(posture),
        () if machine.circles is None else machine.circles.about(place.pose, place.mode),
        _motion(place) if closes and place.rates else None,
    )


def _motion(place: Place) -> Motion | None:
    """At the rates asked for; where the mechanism has a constraint one of them gives way to it."""
    machine = place.machine
    dependent = machine.dependent
    rates, gains = np.array(place.rates), np.array(place.accelerations or (0.0,) * len(place.rates))
    for n in dependent[::-1] or (None,):
        wanted, gained = rates.copy(), gains.copy()
        if n is not None:
            wanted[n] = gained[n] = np.nan
        try:
            return machine.motion.inverse(place.pose, place.mode, wanted, gained)
        except InputError:  # that one does not follow from the others here
            continue
    return None


def _value(place: Place, measure: Measure) -> float:
    load = place.load if measure.needs_load else None
    value = place.machine.measures(place.pose, place.mode, measure.key, load)
    return float(np.asarray(value))


def ball(place: Place, here: bool) -> tuple[Sphere, ...]:
    """The largest ball without a singularity, about the place or anywhere; none in an empty
    workspace.
    """
    machine = place.machine
    position = machine.transform(place.pose, place.mode)[:3, 3]
    center = tuple(position.tolist()) if here else None
    if machine.sections is None:
        return ()
    found = machine.sections.singularity_free_ball(place.pose, place.mode, center)
    return () if found is None else (found,)


def curves(place: Place, chart: str) -> LocusCurves:
    """The loci of a chart, all but its two coordinates held."""
    return place.machine.singularities.locus(chart, place.pose, place.mode)


def profiles(place: Place, ratios: tuple[float, ...]) -> tuple[tuple[Design, Profile], ...]:
    """The profile of the machine, and those of its counterparts."""
    machine, design = place.machine, place.design
    machines = (design, *machine.counterparts)
    circles = [required(machine_of(m).circles, "circles of orientations") for m in machines]
    found = (each.profile(place.pose, ratios) for each in circles)
    return tuple(zip(machines, found, strict=True))


def passed(before: Place, pose: tuple[float, ...]) -> tuple[Event, ...]:
    """What the way to another pose passes, in the same mode."""
    machine = before.machine
    return machine.paths.passed(before.posture, machine.posture(pose, before.mode))


def field(place: Place, key: str, solid: str, points: Array) -> Array:
    """A measure (N,) at points (N, 3) of a solid as placed.

    NaN where there is none, or where the place's mode does not come (to within the deviation of a
    solid's facets).
    """
    machine = place.machine
    measure = next(m for m in machine.measures.specs if m.key == key)
    poses = required(machine.solids, "solids").poses(solid, place.pose, place.mode, points)
    known = np.flatnonzero(np.isfinite(poses).all(axis=1))
    known = known[_comes(place, poses[known])]
    values = np.full(len(poses), np.nan)
    load = place.load if measure.needs_load else None
    values[known] = machine.measures(poses[known], place.mode, key, load)
    return values


def _comes(place: Place, poses: Array) -> NDArray[np.bool_]:
    """Whether the mode has poses (N, P) within its strokes, or all but."""
    machine = place.machine
    solved = machine.inverse(poses)
    joints = solved.joints[:, solved.modes.index(place.mode)]
    axes = machine.joints
    low, high = (np.array([getattr(a, end) for a in axes]) for end in ("lower", "upper"))
    slack = SLACK * (high - low)
    within: NDArray[np.bool_] = ((joints >= low - slack) & (joints <= high + slack)).all(axis=1)
    return within


def placed(machine: Machine[Any], pose: Sequence[float], points: Array) -> Array:
    """The pose with O′ at points (N, 3), all else held: (N, P)."""
    poses = np.tile(np.asarray(pose, dtype=float), (len(points), 1))
    for n, c in enumerate(machine.coordinates):
        if c.key in ("x", "y", "z"):
            poses[:, n] = points[:, "xyz".index(c.key)]
    return poses


# --- a machine beside its counterpart


def beside(review: Review) -> Beside | None:
    """The counterpart, where it is to be compared with."""
    if not review[Control].compare:
        return None
    design = next(iter(review.machine.counterparts), None)
    if design is None:
        return None
    machine = machine_of(design)
    posture = machine.inverse.posture(review.pose, review.mode)
    drawing = machine.drawing(posture)
    platform = machine.transform(posture.pose, posture.mode)
    offset = np.array([APART * drawing.size, 0.0, 0.0])

    def moved(point: tuple[float, ...]) -> tuple[float, float, float]:
        x, y, z = (np.asarray(point) + offset).tolist()
        return x, y, z

    def fixed(body: Body) -> Body:
        points = np.array(body.points)
        if body.frame == "platform":
            points = points @ platform[:3, :3].T + platform[:3, 3]
        return replace(
            body, name=f"other {body.name}", points=tuple(map(moved, points.tolist())), frame="base"
        )

    bars = tuple(
        replace(
            bar,
            name=f"other {bar.name}",
            start=moved(bar.start),
            end=moved(bar.end),
            limb=None if bar.limb is None else bar.limb + OTHER,
        )
        for bar in drawing.bars
    )
    rows = joint_rows(machine, posture)
    return Beside(
        design,
        posture,
        replace(drawing, bars=bars, bodies=tuple(map(fixed, drawing.bodies)), points=(), axes=()),
        tuple(replace(row, limb=row.limb + OTHER) for row in rows),
        offset,
    )


# --- what is asked, and all that an answer depends on ----------------------------------------

REST = 0.2  # s for which a place must stay before curves are traced about it
HERE = Question("work.here", "control", look)
PASSED = Question("work.passed", "control", passed, kept=0)
BESIDE = Question("work.beside", "control", look)
CURVES = Question("work.curves", "loci", curves, REST, urgent=True)
CURVES_BESIDE = Question("work.curves_beside", "loci", curves, REST)
PROFILES = Question("work.profile", "loci", profiles, REST)
FREE = Question("work.free", "loci", ball, slow=True, urgent=True)


def same_branch(one: Place, other: Place) -> bool:
    """Whether both are of one machine in one mode."""
    return one.design == other.design and one.mode == other.mode


def orientation(review: Review) -> tuple[object, ...]:
    """All of a review on which balls depend, but for the position."""
    return review.design, review.mode, *_held(review, ("x", "y", "z"))


def chart_key(review: Review) -> tuple[object, ...]:
    """All that the curves of the chosen chart depend on: its own two coordinates are free."""
    chart = review[Control].chart
    spec = next(s for s in review.machine.singularities.loci if s.key == chart)
    return chart, review.design, review.mode, *_held(review, spec.axes)


def _held(review: Review, free: tuple[str, ...]) -> tuple[float, ...]:
    axes = review.machine.coordinates
    return tuple(
        v
        for c, v in zip(axes, review.pose, strict=True)
        if c.key not in free and c.symbol not in free
    )


@dataclass(frozen=True, slots=True)
class Logged:
    """Something that happened on the way: when (s since the epoch), in words, and of which kind."""

    at: float
    text: str
    kind: str


@dataclass(frozen=True, eq=False, slots=True)
class Controlled:
    """What is known of control, as panels draw it.

    Attributes:
        here: of the present place, or while ``stale`` of one shortly before.
        curves: of the chosen chart, or while ``curves_stale`` of it at a place before.
        profiles: of the machine and of its counterparts, each with its design.
        beside, curves_beside: the counterpart's, where it is compared with.
        ball: the largest one without a singularity, if a person asked for it; ``seeking`` it.
        log: what happened on the way, the newest first.
        trouble: what could not be computed.
    """

    here: Here | None
    stale: bool = False
    curves: LocusCurves | None = None
    curves_stale: bool = False
    profiles: tuple[tuple[Design, Profile], ...] = ()
    beside: Here | None = None
    curves_beside: LocusCurves | None = None
    ball: Sphere | None = None
    seeking: bool = False
    log: tuple[Logged, ...] = ()
    trouble: str = ""
