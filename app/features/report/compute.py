"""What a report tells of a design, computed by the functions that the page asks, one by one.

Each request is that of the page for the same review, so that both have the same numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from app.features.map.compute import chart_request
from app.features.map.state import Chart
from app.features.section import compute as sections
from app.features.singularities import compute as control
from app.features.solutions import compute as assembly
from app.features.trajectory import compute as trajectories
from app.features.trajectory.state import Plan
from app.features.workspace import compute as workspaces
from app.features.workspace.state import Flat, Workspace, usual_opacity
from app.features.workspace.state import Shown as On
from app.review.state import Review
from app.review.view import View, view
from kinematics.answers.circles import Profile
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.sections import Box, Sphere, Volume
from kinematics.errors import BohemiaError, InputError
from kinematics.facets.map_sweeps import Map, sweep
from kinematics.facets.solids import Resolution, SolidSpec
from kinematics.machine import required
from kinematics.mechanism import Design
from kinematics.trajectories import Fits

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

MOST_FACES = 30_000  # of a solid that is shown; a finer one is shown by its preview
Tell = Callable[[str], None]
"""Told what is begun."""


@dataclass(frozen=True, slots=True)
class Depth:
    """How much is computed.

    Attributes:
        resolution: of solids.
        cells: of a map along each side; 0: no map.
    """

    resolution: Resolution = "normal"
    cells: int = 9


@dataclass(frozen=True, eq=False, slots=True)
class Shown:
    """A solid: as it was built, and as it is shown, which may be coarser."""

    spec: SolidSpec
    built: workspaces.Built
    seen: BuiltSolid
    on: bool


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """A workspace by its exact sections.

    Attributes:
        present, every: of the present mode and of all together; the same where there is one.
    """

    present: Volume
    every: Volume
    ball: Sphere | None
    box: Box | None
    free: Sphere | None
    drawn: sections.Drawn
    of: sections.Region


@dataclass(frozen=True, eq=False, slots=True)
class Moving:
    """A trajectory with everything that is known of it."""

    computed: trajectories.Computed
    fits: Fits | None


@dataclass(frozen=True, eq=False, slots=True)
class Found:
    """All that is told of one review.

    Attributes:
        failed: what could not be computed, and why.
    """

    view: View
    here: control.Here
    solids: tuple[Shown, ...]
    measured: Measured | None
    regions: tuple[workspaces.Laid, ...]
    curves: tuple[tuple[LocusSpec, LocusCurves], ...]
    profiles: tuple[tuple[Design, Profile], ...]
    map: Map | None
    known: assembly.Known | None
    ahead: tuple[assembly.Ahead, ...]
    moving: Moving | None
    failed: tuple[str, ...]

    @property
    def review(self) -> Review:
        return self.view.review


def gather(
    review: Review,
    depth: Depth = Depth(),
    tell: Tell = lambda text: None,
    *,
    chart: Map | None = None,
    executor: Executor | None = None,
    workers: int = 1,
) -> Found:
    """Compute everything.

    Args:
        chart: a map that is there already.
        executor: with so many ``workers`` that a map may use meanwhile.
    """
    machine = review.machine
    failed: list[str] = []

    @contextmanager
    def part(title: str) -> Iterator[None]:
        """A part that may fail without the others."""
        tell(title)
        try:
            yield
        except BohemiaError as error:
            failed.append(f"{title}: {error}")

    with ThreadPoolExecutor(1) as one:
        mapped = None
        if chart is None and machine.map_spec is not None and depth.cells:
            mapped = one.submit(_map, review, depth.cells, executor, workers)
        seen = view(review)
        tell("what holds the platform")
        here = control.look(control.spot_of(review))
        solids: list[Shown] = []
        measured: Measured | None = None
        regions: tuple[workspaces.Laid, ...] = ()
        curves: list[tuple[LocusSpec, LocusCurves]] = []
        profiles: tuple[tuple[Design, Profile], ...] = ()
        known: assembly.Known | None = None
        ahead: tuple[assembly.Ahead, ...] = ()
        moving: Moving | None = None
        for wish, on in _wishes(review):
            with part(wish.spec.title.lower()):
                solids.append(_solid(wish, depth.resolution, on=on))
        if machine.sections is not None:
            with part("the exact volume and sections"):
                measured = _measured(review)
        if machine.region_specs:
            with part("the regions of the workspace"):
                regions = tuple(_laid(review))
        for spec in machine.singularities.loci:
            with part("the singular curves"):
                curves.append((spec, control.curves(here.place, spec.key)))
        if machine.circles is not None:
            with part("the profile"):
                profiles = _profiles(here.place)
        if seen.posture.closes:
            with part("all solutions"):
                wanted = assembly.Wish(review.design, tuple(seen.posture.joints))
                known = assembly.Known(review.design, assembly.solve(wanted).solutions)
            with part("the folds ahead"):
                ahead = assembly.look_ahead(review.design, seen.posture)
        if (of := trajectories.asked(review)) is not None:
            with part("the trajectory"):
                moving = _moving(of, review[Plan].degree)
        if mapped is not None:
            with part("the map"):
                chart = mapped.result()
    return Found(
        seen,
        here,
        tuple(solids),
        measured,
        regions,
        tuple(curves),
        profiles,
        chart,
        known,
        ahead,
        moving,
        tuple(failed),
    )


def _wishes(review: Review) -> Iterator[tuple[workspaces.SolidWish, bool]]:
    """The solids on display, and what else a machine has of workspaces; and which are which."""
    shown = workspaces.wishes(review)
    yield from ((wish, True) for wish in shown)
    there = {wish.spec.key for wish in shown}
    keys = [s.key for s in review.machine.solid_specs if s.limb is None and s.key not in there]
    if not keys:
        return
    slice_ = review[Workspace]
    for key in keys:
        one = (On(key, usual_opacity(key)),)
        for wish in workspaces.wishes(review.having(replace(slice_, solids=one))):
            yield wish, False


def _solid(wish: workspaces.SolidWish, resolution: Resolution, *, on: bool) -> Shown:
    solid = seen = workspaces.build(wish.requests[resolution])
    if solid.triangles > MOST_FACES:
        seen = workspaces.build(wish.requests["preview"])
    return Shown(wish.spec, workspaces.Built(wish, resolution, solid), seen, on)


def _measured(review: Review) -> Measured:
    of, every = (sections.region(review, which) for which in ("present", "all"))
    present = sections.measure(of)
    ball, box = sections.sphere(of, None), sections.box(of, None)
    free = control.ball(control.spot_of(review), here=False)
    return Measured(
        present,
        present if every == of else sections.measure(every),
        next(iter(ball), None),
        next(iter(box), None),
        next(iter(free), None),
        sections.draw(sections.wish(review)),
        of,
    )


def _laid(review: Review) -> Iterator[workspaces.Laid]:
    """The regions of every kind, with the curves where control is lost."""
    flat = review[Flat]
    for spec in review.machine.region_specs:
        wish = workspaces.wish(review.having(replace(flat, on=True, key=spec.key, locus=True)))
        if wish is not None:
            yield workspaces.lay(wish)


def _profiles(place: control.Place) -> tuple[tuple[Design, Profile], ...]:
    circles = required(place.machine.circles, "circles of orientations")
    at = circles.profile_place(place.pose)
    return tuple((each, replace(p, at=at)) for each, p in control.profiles(place, ()))


def _moving(of: trajectories.Asked, degree: int) -> Moving:
    """The trajectory with its distances to singularities."""
    computed = trajectories.compute(of)
    distance = np.full(len(computed.found.times), np.nan)
    for each in trajectories.parts(len(distance)):
        distance[list(each)] = trajectories.distances(of, computed.found.poses[list(each)])
    found = replace(computed.found, distance=distance)
    computed = trajectories.judged(replace(computed, found=found))
    fits = None
    if degree:
        with suppress(InputError):
            fits = trajectories.fitted(computed, degree)
    return Moving(computed, fits)


def _map(review: Review, cells: int, executor: Executor | None, workers: int) -> Map:
    """The map that the review asks for, of no more cells than are asked for here."""
    chart = review[Chart]
    spans = [replace(s, count=min(s.count, cells)) for s in chart.spans]
    chosen = review.having(replace(chart, first=spans[0], second=spans[1]))
    request = chart_request(chosen)
    if executor is not None:
        return sweep(request, executor, chunk=4, in_flight=workers + 1)
    with ThreadPoolExecutor(1) as own:
        return sweep(request, own)
