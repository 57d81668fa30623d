"""What is computed of a trajectory in a process of its own: pure functions and plain results.

The joints, their rates and forces take a moment, the distances to singularities much longer: they
come in parts, coarse first, so that whatever is wanted next need not wait for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.features.singularities.state import Control
from app.features.trajectory.state import (
    FILE,
    POINTS,
    STRAIGHT,
    STROKE,
    Plan,
    missing,
    path_of,
    plane_of,
)
from app.jobs.answers import Question
from app.review.state import Review
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.machine import Machine, machine_of
from kinematics.mechanism import Design
from kinematics.trajectories import (
    Event,
    Fits,
    Path,
    TimeLaw,
    Trajectory,
    constrained,
    fit,
    giving_way,
    trajectory,
)
from kinematics.trajectories.along import Along
from kinematics.trajectories.events import events_of
from kinematics.trajectories.sampling import NEAR

PART = 6  # distances that are found in one go
HALVINGS = 40  # of the time in which a way leaves the workspace
MOST_KNOTS = 60  # way points that are marked
ReachKey = tuple[Design, tuple[float, ...], str, tuple[int, int], int | None]
CELLS, COARSE = 160, 64  # of the reach in the plane of a stroke, along each side
ROOM = 0.05  # of the reach's size, left free around it


@dataclass(frozen=True, slots=True)
class Asked:
    """All that a trajectory depends on; ``follows`` is the coordinate that should give way."""

    design: Design
    mode: str
    plan: Plan
    load: tuple[float, ...]
    follows: int | None

    @property
    def machine(self) -> Machine[Any]:
        return machine_of(self.design)


@dataclass(frozen=True, eq=False, slots=True)
class Computed:
    """A trajectory as it was asked for.

    Attributes:
        path, law: what it runs on, to play it at any time.
        found: its samples; of the distances those that are known, else NaN.
        spots: (N, 3) mm, O′ at the samples, base frame.
        marks: (E, 3) mm, O′ where each event of ``found`` begins.
        knots: (K, 3) mm, O′ at both ends and at the way points.
    """

    asked: Asked
    path: Path
    law: TimeLaw
    found: Trajectory
    spots: Array
    marks: Array
    knots: Array

    def pose_at(self, time: float) -> tuple[float, ...]:
        """The pose at a time, s."""
        share, _, _ = self.law.at([time])
        return tuple(self.path.at(share)[0][0].tolist())


@dataclass(frozen=True, eq=False, slots=True)
class Reach:
    """Where the machine can be in a plane of two pose coordinates, all others held.

    ``bounds`` are from and to of both, mm or rad; ``inside`` (N, N) by the first and the
    second at the cells' middles; ``lost`` are curves (N, 2), mm and rad, where control is lost.
    """

    plane: tuple[int, int]
    bounds: tuple[tuple[float, float], tuple[float, float]]
    inside: np.ndarray
    lost: tuple[Array, ...] = ()


def asked(review: Review) -> Asked | None:
    """What a review asks for; None where there is nothing to compute."""
    plan = review[Plan]
    if not plan.on or missing(plan):
        return None
    usual = Plan()
    # How it is shown makes no other trajectory, nor do ways that are not taken.
    shown = ("playback", "pace", "halt", "degree", "plot", "plane")
    others = {
        "straight": ("start", "end"),
        "points": ("points",),
        "file": ("file", "file_name", "times", "file_open"),
        STROKE: ("stroke", "smooth"),
    }
    left = [name for way, names in others.items() if way != plan.way for name in names]
    plan = replace(plan, **{name: getattr(usual, name) for name in (*shown, *left)})
    follows = review.dependent
    if plan.file_open:
        follows = [c.key for c in review.machine.coordinates].index(plan.file_open)
    return Asked(review.design, review.mode, plan, review[Control].load, follows)


# --- called in the process ----------------------------------------------------------------


def compute(of: Asked) -> Computed:
    """The trajectory without distances to singularities."""
    machine, plan = of.machine, of.plan
    path, law = path_of(plan, machine)
    follows = giving_way(path, machine, of.mode, of.follows)
    found = trajectory(
        machine,
        path,
        law,
        of.mode,
        samples=plan.samples,
        load=of.load,
        limits=plan.limits,
        distances=False,
        dependent=follows,
    )
    path = constrained(path, machine, of.mode, follows)
    spots = machine.transform(found.poses, of.mode)[:, :3, 3]
    knots = _knots(of, spots, follows)
    return Computed(of, path, law, found, spots, _marks(of, found.events), knots)


def _knots(of: Asked, spots: Array, follows: int | None) -> Array:
    """The ends and, of not too many, the way points; these are not on a way that is constrained."""
    points = {POINTS: of.plan.points, FILE: of.plan.file}.get(of.plan.way, ())
    if follows is not None or not 2 < len(points) <= MOST_KNOTS:
        return spots[[0, -1]]
    poses = np.array(points)
    places: Array = of.machine.transform(poses, of.mode)[:, :3, 3]
    return places


def distances(of: Asked, poses: Array) -> Array:
    """mm (N,) to the nearest parallel or constraint singularity of poses (N, P); inf: none."""
    path, law = path_of(of.plan, of.machine)
    along = Along(of.machine, path, law, of.mode)
    return np.array([along.distance(pose) for pose in poses.tolist()])


def judged(computed: Computed) -> Computed:
    """The same with the events that the distances show, too."""
    of, found = computed.asked, computed.found
    along = Along(of.machine, computed.path, computed.law, of.mode)
    near = NEAR * of.machine.length
    events = events_of(along, found, of.plan.limits, near)
    return replace(computed, found=replace(found, events=events), marks=_marks(of, events))


def leaves_at(computed: Computed) -> float | None:
    """When the straight way leaves the workspace, s; None where it stays, or begins beyond it."""
    beyond = [event.start for event in computed.found.events if event.kind == "outside"]
    at = min(beyond, default=0.0)
    return at if computed.asked.plan.way == STRAIGHT and at > 0.0 else None


def last_inside(computed: Computed, leaves: float) -> tuple[float, ...] | None:
    """The last pose of a way that can be reached before it ``leaves`` the workspace, s."""
    machine, mode = computed.asked.machine, computed.asked.mode

    def inside(time: float) -> bool:
        return bool(machine.inverse.posture(computed.pose_at(time), mode).reachable)

    times = computed.found.times
    low, high = float(times[times < leaves][-1]), leaves
    if not inside(low):
        return None
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if inside(middle) else (low, middle)
    return computed.pose_at(low)


def known_distances(found: Trajectory) -> tuple[Array, Array]:
    """Times (K,) and mm (K,) to singularities there: at samples, and where one is met or near."""
    known = np.isfinite(found.distance)
    met = [(t, 0.0) for e in found.events if e.kind == "singularity" for t in (e.start, e.end)]
    met += [(e.at, e.value) for e in found.events if e.kind == "near"]
    more = np.array(sorted(set(met))).reshape(-1, 2)
    more = more[np.isfinite(more).all(axis=1)]
    times = np.concatenate([found.times[known], more[:, 0]])
    order = np.argsort(times, kind="stable")
    return times[order], np.concatenate([found.distance[known], more[:, 1]])[order]


def fitted(computed: Computed, degree: int) -> Fits:
    """Polynomials for the joints, with their true error."""
    of = computed.asked
    return fit(of.machine, computed.found, degree)


def reach(
    design: Design, pose: tuple[float, ...], mode: str, plane: tuple[int, int], follows: int | None
) -> Reach:
    """Where the machine can be in a plane, drawn close around."""
    machine = machine_of(design)
    axes = machine.coordinates
    whole = [(axes[n].lower, axes[n].upper) for n in plane]
    # Coordinates that follow are solved for one by one.
    free = [n for n in machine.dependent if n not in plane]
    cells = COARSE if free else CELLS

    def inside(bounds: Sequence[tuple[float, float]]) -> np.ndarray:
        middles = (np.arange(cells) + 0.5) / cells
        u, v = (low + middles * (high - low) for low, high in bounds)
        poses = np.tile(np.asarray(pose, dtype=float), (cells * cells, 1))
        poses[:, plane] = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
        possible = np.ones(len(poses), dtype=bool)
        for n, each in enumerate(poses.tolist() if free else ()):
            possible[n] = False
            for way in [follows] if follows in free else free:
                with suppress(InputError):
                    poses[n] = machine.complete_pose(tuple(each), mode, dependent=way)
                    possible[n] = True
                    break
        answer = machine.inverse(poses)
        found: np.ndarray = answer.within_stroke[:, answer.modes.index(mode)] & possible
        return found.reshape(cells, cells)

    seen = inside(whole)
    if not seen.any():
        return Reach(plane, (whole[0], whole[1]), seen)
    close = []
    for n, (low, high) in enumerate(whole):
        rows = np.flatnonzero(seen.any(axis=1 - n)).tolist()
        cell = (high - low) / cells
        close.append((low + (rows[0] - 0.5) * cell, low + (rows[-1] + 1.5) * cell))
    if axes[plane[0]].unit == axes[plane[1]].unit:  # the same scale both ways
        half = 0.5 * max(high - low for low, high in close) * (1.0 + 2.0 * ROOM)
        close = [(0.5 * (a + b) - half, 0.5 * (a + b) + half) for a, b in close]
    return Reach(plane, (close[0], close[1]), inside(close), _lost(machine, pose, mode, plane))


def _lost(
    machine: Machine[Any], pose: Sequence[float], mode: str, plane: tuple[int, int]
) -> tuple[Array, ...]:
    """Curves in a plane where control is lost, if the mechanism has a chart of it."""
    symbols = [machine.coordinates[n].symbol for n in plane]
    for chart in machine.singularities.loci:
        if sorted(chart.axes) == sorted(symbols):
            found = machine.singularities.locus(chart.key, pose, mode)
            turn = 1 if list(chart.axes) == symbols else -1
            return tuple(curve[:, ::turn] for curve in found.lost())
    return ()


def _marks(of: Asked, events: Sequence[Event]) -> Array:
    if not events:
        return np.empty((0, 3))
    poses = np.array([event.pose for event in events])
    marks: Array = of.machine.transform(poses, of.mode)[:, :3, 3]
    return marks


@dataclass(frozen=True, eq=False, slots=True)
class Moved:
    """The trajectory as panels draw it.

    Attributes:
        computed: the newest; ``stale`` while another one is wanted.
        missing: what a person has to do until there is a path.
        share: of the distances to singularities that are known; ``measuring`` the others.
        fits: polynomials of the wanted degree; None while there are none.
        fit_trouble: why there are none.
        reach: where a stroke can run; None while it is not known.
        trouble: what could not be computed.
    """

    computed: Computed | None
    stale: bool
    missing: str
    share: float
    measuring: bool
    fits: Fits | None
    fit_trouble: str
    reach: Reach | None
    trouble: str


# --- in which order distances are found ----------------------------------------------------


def parts(samples: int) -> list[tuple[int, ...]]:
    """The samples whose distances are found together, coarse first; every one is in one part."""
    order: list[int] = []
    step = 1 << max(0, (samples - 1).bit_length() - 4)
    known: set[int] = set()
    while step:
        new = [n for n in range(0, samples, step) if n not in known]
        order += new
        known.update(new)
        step //= 2
    return [tuple(order[n : n + PART]) for n in range(0, samples, PART)]


def reach_key(review: Review) -> ReachKey:
    """All that the reach in the plane of a stroke depends on."""
    plane = plane_of(review[Plan], review.machine.coordinates)
    held = tuple(0.0 if n in plane else v for n, v in enumerate(review.pose))
    return review.design, held, review.mode, plane, review.dependent


REST = 0.2  # s for which a trajectory must stay asked for before it is computed
TRAJECTORY = Question("work.trajectory", "trajectory", compute, REST)
DISTANCES = Question("", "trajectory", distances, urgent=True, kept=500)
JUDGED = Question("", "trajectory", judged, urgent=True)
FITS = Question("work.fits", "trajectory", fitted, REST)
REACH = Question("work.reach", "trajectory", reach)
