"""What is computed of designs side by side: the same for the page, the command and the report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.features.compare.state import Beside
from app.features.section.compute import edges, filled
from app.features.section.state import Cut, place_in_section
from app.features.workspace.compute import REST_FINE, REST_NORMAL, STEP, in_space
from app.features.workspace.state import solver_modes
from app.jobs.answers import Question
from app.language import tr
from app.review.state import Review
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.designs.differences import Difference, differences
from kinematics.errors import BohemiaError, InputError
from kinematics.facets.comparison import Comparison, Size
from kinematics.facets.figures import Figure, best, figures
from kinematics.machine import Machine, machine_of, spaces
from kinematics.mechanism import Design

if TYPE_CHECKING:
    from kinematics.answers.sections import Section, SectionSpec
    from kinematics.facets.comparison import Parts
    from kinematics.facets.solids import Resolution
    from kinematics.facets.spaces import Space


@dataclass(frozen=True, slots=True)
class Request:
    """Two to four designs, asked for the same.

    Attributes:
        designs: the first one's base frame and coordinates are those of all.
        held: angles of the first one by key, rad; None: what follows from the others.
        modes: of the workspaces; None: all together.
        pose: (P,) of the first one, mm and rad, which is asked of all.
        mode: in which it is.
        at: where the plane of sections stands along its normal, mm; None: through O′ at the pose.
    """

    designs: tuple[Design, ...]
    held: tuple[tuple[str, float | None], ...]
    modes: tuple[str, ...] | None
    pose: tuple[float, ...]
    mode: str
    at: float | None = None

    @property
    def machines(self) -> tuple[Machine[Any], ...]:
        return tuple(machine_of(design) for design in self.designs)


@dataclass(frozen=True, slots=True)
class Asked:
    """What one design answers to the pose: its posture, or ``why`` it has none."""

    posture: Posture | None
    why: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """A figure of merit of all designs: NaN where one has it not; ``best`` by their numbers."""

    title: str
    unit: str
    values: tuple[float, ...]
    errors: tuple[float, ...]
    best: tuple[int, ...]
    key: str


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """Areas (N,), mm², of a workspace's sections at places (N,) along the normal, mm."""

    at: Array
    area: Array


@dataclass(frozen=True, eq=False, slots=True)
class Compared:
    """Designs side by side.

    Attributes:
        unit: of the sizes, "mm³" or "mm²".
        sizes, common, only: of the workspaces over one another; none and ``why`` where they are of
            different coordinates.
        exact: they are those of the true workspaces, and not of meshes.
        curves: of each design, where its sections are exact.
        outlines: so are the sections by one plane, ``at`` mm along the normal.
    """

    request: Request
    unit: str
    sizes: tuple[Size, ...]
    common: Size | None
    only: tuple[Size, ...]
    exact: bool
    why: str
    differences: tuple[Difference, ...]
    rows: tuple[Row, ...]
    asked: tuple[Asked, ...]
    curves: tuple[Curve | None, ...]
    outlines: tuple[Section | None, ...]
    at: float


def compare(request: Request, relative: float = 1e-6, *, measured: bool = True) -> Compared:
    """Everything that a comparison shows in numbers.

    Args:
        measured: also the figures of merit, which take longest.

    Raises:
        InputError: a machine has no such mode.
    """
    machines, its_spaces = request.machines, _spaces(request)
    at = request.at
    if at is None:
        at = place_in_section(machines[0], request.pose, request.mode)[0]
    why, found, common = "", None, None
    sizes: tuple[Size, ...] = ()
    only: tuple[Size, ...] = ()
    try:
        found = Comparison(its_spaces, relative)
        sizes, common, only = found.sizes, found.common, found.only
    except InputError as error:
        why = str(error)
    return Compared(
        request=request,
        unit="mm³" if found is None else found.unit,
        sizes=sizes,
        common=common,
        only=only,
        exact=found is not None and found.exact,
        why=why,
        differences=differences([machine.mechanism for machine in machines]),
        rows=measures(request) if measured else (),
        asked=tuple(_asked(machine, request) for machine in machines),
        curves=tuple(map(_curve, its_spaces)),
        outlines=tuple(_outline(space, at) for space in its_spaces),
        at=at,
    )


def asked(machine: Machine[Any], first: Machine[Any], pose: tuple[float, ...], mode: str) -> Asked:
    """What a machine answers to a pose (P,) of another one, mm and rad, in its mode."""
    if [axis.key for axis in machine.coordinates] != [axis.key for axis in first.coordinates]:
        return Asked(None, tr("compare.other_coordinates", machine=machine.title))
    if mode not in machine.modes:
        return Asked(None, tr("compare.no_mode", noun=machine.mode_noun, mode=mode))
    try:
        return Asked(machine.posture(pose, mode))
    except BohemiaError as error:
        return Asked(None, str(error))


def differing(found: Compared) -> list[dict[str, Any]]:
    """The numbers in which the designs differ as plain values, degrees for rad."""
    answer = []
    for one in found.differences:
        turned = one.unit == "rad"
        values = [v if v is None else degrees(v) if turned else v for v in one.values]
        unit = "deg" if turned else one.unit
        answer.append({"field": one.field, "label": one.label, "values": values, "unit": unit})
    return answer


def measures(request: Request) -> tuple[Row, ...]:
    """The figures of merit of all designs."""
    pairs = zip(_spaces(request), request.machines, strict=True)
    return tuple(_rows([figures(s, _asked(m, request).posture) for s, m in pairs]))


@dataclass(frozen=True, eq=False, slots=True)
class Drawn:
    """A part as the scene shows it: ``vertices`` (V, 3), ``faces`` (F, 3), sharp edges or the rim
    as ``lines`` (E, 2, 3), mm in the base frame.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    lines: NDArray[np.float32]


def parts(request: Request, resolution: Resolution) -> Parts:
    """The solids that the workspaces share, and that each alone reaches.

    Raises:
        InputError: the workspaces are of different coordinates, or plane.
    """
    return Comparison(_spaces(request)).parts(resolution)


def regions(request: Request) -> tuple[SectionSpec, Section, tuple[Section, ...]]:
    """Of plane workspaces how they are drawn, what they share, and what each alone reaches.

    Raises:
        InputError: the workspaces are of different coordinates, or solids.
    """
    every, alone = Comparison(_spaces(request)).sections
    return request.machines[0].region_specs[0].plane, every, alone


def drawn(request: Request, resolution: Resolution) -> tuple[Drawn, ...]:
    """What the scene shows of the workspaces: what all share first, then what each alone reaches.

    Raises:
        InputError: the workspaces are of different coordinates.
    """
    first = request.machines[0]
    if first.regions is None or first.solid_specs:
        found = Comparison(_spaces(request)).parts(resolution, judged=False)
        return tuple(
            Drawn(
                built.shaded.vertices,
                built.shaded.faces.astype(np.uint32),
                built.edges if built.triangles else np.empty((0, 2, 3), np.float32),
            )
            for built in (found.common, *found.only)
        )
    _, every, alone = regions(request)
    frame = first.regions.frame(request.pose)
    answer = []
    for section in (every, *alone):
        flat, faces = filled(section, STEP)
        points, lines = in_space(flat, frame), in_space(edges(section, STEP)[0], frame)
        answer.append(
            Drawn(points.astype(np.float32), faces.astype(np.uint32), lines.astype(np.float32))
        )
    return tuple(answer)


def request_of(review: Review) -> Request | None:
    """What the review compares; None where nothing stands beside it."""
    designs, machine = review[Beside].designs, review.machine
    if not designs:
        return None
    turned = [n for n, axis in enumerate(machine.coordinates) if axis.unit == "rad"]
    if not machine.region_specs and any(spec.of_present_mode for spec in machine.solid_specs[:1]):
        turned = []  # of all orientations
    last = machine.dependent[-1:]
    held = tuple(
        (machine.coordinates[n].key, None if n in last else review.pose[n]) for n in turned
    )
    return Request(
        (review.design, *designs),
        held,
        solver_modes(review),
        review.pose,
        review.mode,
        review[Cut].at,
    )


COMPARED: Question[Compared] = Question(
    "work.compare", "compare", partial(compare, measured=False), REST_NORMAL, kept=16
)
MEASURED: Question[tuple[Row, ...]] = Question(
    "work.measures", "compare", measures, REST_FINE, kept=16
)
# Coarse first; the normal solids of a pair may take seconds.
DRAWN: dict[Resolution, Question[tuple[Drawn, ...]]] = {
    "preview": Question("work.parts", "parts", partial(drawn, resolution="preview")),
    "normal": Question("work.parts", "parts", partial(drawn, resolution="normal"), REST_FINE),
}


# --- inside


def _spaces(request: Request) -> tuple[Space[Any], ...]:
    return spaces(request.machines, request.modes, **dict(request.held))


def _rows(every: Sequence[tuple[Figure, ...]]) -> Iterator[Row]:
    """Figures that at least two designs have in the same unit, in the order of the first."""
    nan = float("nan")
    keys = dict.fromkeys((figure.key, figure.unit) for own in every for figure in own)
    for key, unit in keys:
        found = [next((f for f in own if (f.key, f.unit) == (key, unit)), None) for own in every]
        known = [figure for figure in found if figure is not None]
        if len(known) < 2 or all(figure.value != figure.value for figure in known):
            continue
        values = [nan if figure is None else figure.value for figure in found]
        yield Row(
            known[0].title,
            unit,
            tuple(values),
            tuple(nan if figure is None else figure.error for figure in found),
            tuple(best(values, known[0].better)),
            key,
        )


def _asked(machine: Machine[Any], request: Request) -> Asked:
    return asked(machine, request.machines[0], request.pose, request.mode)


def _outline(space: Space[Any], at: float) -> Section | None:
    facet = space.machine.sections
    return None if facet is None else facet.at(space.pose, space.modes, at)


def _curve(space: Space[Any]) -> Curve | None:
    if space.machine.sections is None:
        return None
    volume = space.volume(1e-4, pieces=False)
    return Curve(volume.at, volume.area)
