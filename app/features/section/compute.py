"""What is computed of sections, in a process of its own: pure functions and plain results.

A section takes some 50 µs once the compiled code is there, a volume some 10 ms; what is drawn of a
section is made here too, so that the page's loop only passes it on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from app.features.section.plot import Bounds, Picture, Shade, section_bounds
from app.features.section.state import Cut, point_in_section
from app.features.singularities.compute import placed
from app.features.singularities.state import Control
from app.features.workspace.state import Workspace, solver_modes
from app.jobs.answers import Question
from app.language import tr
from app.review.state import Review
from app.review.units import minus, tenths
from app.scene.painting import scale
from kinematics.answers.sections import Box, Section, Sphere, Volume
from kinematics.arrays import Array
from kinematics.facets.sections import SectionsFacet
from kinematics.machine import machine_of, required
from kinematics.mechanism import Design, mechanism_class
from kinematics.plane.regions import contains

LOOKS = 24  # sections from which the extent of a workspace in its planes is taken
CHART = "section"  # of a mechanism's loci: the one in this plane
CHORD = 1.0  # mm of a section's outline, to see what is within
CELLS = 100  # of a measure's picture, along its longer side
STEP = 6.0  # mm, the longest chord of an arc in the scene
ON_PLANE = 0.05  # mm; the platform is in a plane that it is not farther from


@dataclass(frozen=True, slots=True)
class Region:
    """The workspace that is cut and measured. Regions are equal where the workspaces are.

    ``what`` is everything that it depends on.
    """

    what: tuple[Any, ...]
    design: Design = field(compare=False)
    pose: tuple[float, ...] = field(compare=False)
    modes: tuple[str, ...] | None = field(compare=False)


def prepare(kind: str) -> None:
    """Make ready what takes long the first time on a machine."""
    mechanism_class(kind).prepare()


@dataclass(frozen=True, slots=True)
class Wish:
    """A section to draw: of what, where (mm).

    ``mark`` is where the platform stands in the plane, mm.
    """

    region: Region
    at: float
    mark: tuple[float, float] | None
    lost: Lost | None = None


@dataclass(frozen=True, slots=True)
class Lost:
    """What a section also shows: where control is lost in a mode, and a measure of it by colour.

    ``shade`` is a measure's key, "" for none; ``load`` [F, T] counts for some measures only.
    """

    mode: str
    locus: bool
    shade: str
    load: tuple[float, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Extent:
    """Where a workspace is: along the normal of its sections, and in their planes; mm.

    Both are None if it is empty.
    """

    along: tuple[float, float] | None
    across: Bounds | None


Modes = tuple[str, ...] | None
"""Working modes; None for all of them together."""


@dataclass(frozen=True, eq=False, slots=True)
class Drawn:
    """A section as the page shows it.

    Attributes:
        lines: (S, 2, 3) mm along the edges, in the frame of sections.
        line_limb: (S,) from 1.
        fill: triangles (T, 3, 3) mm that fill the region.
        locus: (L, 2, 3) mm along the curves where control is lost, likewise.
        picture: for the plot.
    """

    wish: Wish
    section: Section
    extent: Extent
    lines: Array
    line_limb: np.ndarray
    fill: Array
    locus: Array
    picture: Picture


@dataclass(frozen=True, eq=False, slots=True)
class Sections:
    """What is known of the workspace's sections and measures, as panels draw it.

    Attributes:
        drawn: the section, or while ``stale`` the one before.
        volume: of the present workspace; while it is not known ``old_volume`` is of one before.
        ball, box: the largest ones in the present workspace, if a person asked for them, and of
            which modes that is.
        trouble: what could not be computed.
    """

    drawn: Drawn | None
    stale: bool
    volume: Volume | None
    old_volume: Volume | None
    ball: tuple[Sphere, Modes] | None
    box: tuple[Box, Modes] | None
    trouble: str


Which = Literal["shown", "present", "all"]
"""Modes: those of the workspace on display, the machine's own, all together."""


def region(review: Review, which: Which = "shown") -> Region:
    """What is cut in a review whose mechanism has sections, of these modes."""
    machine, design = review.machine, review.design
    modes: Modes = (review.mode,)
    if which != "present":
        modes = None if which == "all" else solver_modes(review)
    request = required(machine.solids, "solids").request("workspace", review.pose, modes, "fine")
    what = (request.mechanism, *request.arguments)
    return Region(what, design, review.pose, modes)


def wish(review: Review) -> Wish:
    """The section that a review shows."""
    x, y, z = point_in_section(review)
    mark = (y, z) if abs(x - review[Cut].at) < ON_PLANE else None
    return Wish(region(review), review[Cut].at, mark, _lost(review))


def _lost(review: Review) -> Lost | None:
    """What of control is shown in the section; nothing unless it is on display elsewhere too."""
    control, machine = review[Control], review.machine
    traced = any(spec.key == CHART for spec in machine.singularities.loci)
    locus = traced and control.locus and review[Workspace].shown("aspects") is not None
    if not (locus or control.shade):
        return None
    needs = any(m.key == control.shade and m.needs_load for m in machine.measures.specs)
    return Lost(review.mode, locus, control.shade, control.load if needs else ())


# --- called in the process ----------------------------------------------------------------


def draw(wanted: Wish) -> Drawn:
    """The section, its edges, the region filled, its plot."""
    of = wanted.region
    machine = machine_of(of.design)
    section = _sections(of).at(of.pose, of.modes, wanted.at)
    spec = machine.section_spec
    assert spec is not None
    reach = extent(of)
    lines, limbs = edges(section)
    points, faces = filled(section)
    held = _held(wanted, section)
    curves, beyond = _parted(_curves(wanted), held)
    picture = Picture(
        section,
        spec,
        mark=wanted.mark,
        bounds=reach.across,
        curves=curves,
        beyond=beyond,
        shade=_shade(wanted, section, held),
        note=of_what(of),
    )
    at = section.at
    return Drawn(
        wanted,
        section,
        reach,
        _raised(lines, at),
        limbs,
        _raised(points[faces], at),
        _raised(segments(curves), at),
        picture,
    )


def of_what(of: Region) -> str:
    """The orientation and the modes of what is cut: "φ 0°, θ 0° · mode +−+−+"."""
    axes = zip(machine_of(of.design).coordinates, of.pose, strict=True)
    turned = [f"{c.symbol} {tenths(c.outer(v))}°" for c, v in axes if c.unit == "rad"]
    modes = of.modes
    every = tr("section.every_mode") if modes is None else tr("section.modes", n=len(modes))
    which = (
        minus(tr("section.mode", mode=modes[0])) if modes is not None and len(modes) == 1 else every
    )
    return " · ".join(filter(None, (", ".join(turned), which)))


def segments(curves: Sequence[Array]) -> Array:
    """Curves (K, 2) each as segments (S, 2, 2), all together."""
    pairs = [np.stack([run[:-1], run[1:]], axis=1) for run in curves]
    return np.concatenate([*pairs, np.empty((0, 2, 2))])


def _curves(wanted: Wish) -> list[Array]:
    """Where control is lost in the plane, each curve (N, 2) mm."""
    of, lost = wanted.region, wanted.lost
    if lost is None or not lost.locus:
        return []
    found = machine_of(of.design).singularities.locus(CHART, of.pose, lost.mode, wanted.at)
    return found.lost()


def _held(wanted: Wish, section: Section) -> Section | None:
    """The part of a section that the mode has of which control is shown; None where it has none."""
    of, lost = wanted.region, wanted.lost
    if lost is None or not (of.modes is None or lost.mode in of.modes):
        return None
    if of.modes == (lost.mode,):
        return section
    return _sections(of).at(of.pose, (lost.mode,), wanted.at)


def _parted(curves: Sequence[Array], held: Section | None) -> tuple[list[Array], list[Array]]:
    """The parts of curves within a section, and the others."""
    within: list[Array] = []
    beyond: list[Array] = []
    for points in curves:
        inside = np.zeros(len(points), dtype=bool)
        if held is not None:
            for loop in range(held.loops):
                inside ^= contains(held.polyline(loop, CHORD), points)
        edges = np.flatnonzero(np.diff(inside)) + 1
        for first, behind in pairwise([0, *edges.tolist(), len(points)]):
            # Up to the first point of the next part, so that no gap is left.
            (within if inside[first] else beyond).append(points[first : behind + 1])
    return within, beyond


def _shade(wanted: Wish, section: Section, held: Section | None) -> Shade | None:
    """The measure over the plane, as a picture; None where it is not asked for."""
    of, lost = wanted.region, wanted.lost
    if lost is None or not lost.shade or held is None or not held.loops:
        return None
    machine = machine_of(of.design)
    measure = next(m for m in machine.measures.specs if m.key == lost.shade)
    across = (u0, u1), (v0, v1) = section_bounds(held)
    wide = max(2, min(CELLS, round(CELLS * (u1 - u0) / max(u1 - u0, v1 - v0))))
    high = max(2, min(CELLS, round(CELLS * (v1 - v0) / max(u1 - u0, v1 - v0))))
    u = u0 + (np.arange(wide) + 0.5) / wide * (u1 - u0)
    v = v0 + (np.arange(high) + 0.5) / high * (v1 - v0)
    flat = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    frame = _sections(of).frame(of.pose)
    points = _raised(flat, wanted.at) @ frame[:3, :3].T + frame[:3, 3]
    poses = placed(machine, of.pose, points)
    load = lost.load if measure.needs_load else None
    values = np.asarray(machine.measures(poses, lost.mode, measure.key, load))
    steps = scale(values, high=measure.better == "high", limits=measure.limits)
    if steps is None:
        return None
    return Shade(values.reshape(high, wide), across, steps, None if held is section else held)


@lru_cache(maxsize=16)
def extent(of: Region) -> Extent:
    """Where the workspace is; from so many sections that a picture of it does not jump."""
    sections = _sections(of)
    along = sections.range(of.pose, of.modes)
    if along is None:
        return Extent(None, None)
    places = np.linspace(*along, LOOKS + 2)[1:-1]
    cuts = [sections.at(of.pose, of.modes, float(at)) for at in places]
    found = np.array([section_bounds(cut) for cut in cuts if cut.loops]).reshape(-1, 2, 2)
    if not len(found):
        return Extent(along, None)
    (u0, v0), (u1, v1) = found[:, :, 0].min(axis=0), found[:, :, 1].max(axis=0)
    return Extent(along, ((float(u0), float(u1)), (float(v0), float(v1))))


def measure(of: Region) -> Volume:
    """The exact volume."""
    return _sections(of).volume(of.pose, of.modes)


def sphere(of: Region, center: Sequence[float] | None) -> tuple[Sphere, ...]:
    """The largest ball inside; none in an empty workspace."""
    found = _sections(of).ball(of.pose, of.modes, center)
    return () if found is None else (found,)


def box(of: Region, center: Sequence[float] | None) -> tuple[Box, ...]:
    """The largest box inside, likewise."""
    found = _sections(of).box(of.pose, of.modes, center)
    return () if found is None else (found,)


def _sections(of: Region) -> SectionsFacet[Any]:
    return required(machine_of(of.design).sections, "exact sections")


def edges(section: Section, step: float = STEP) -> tuple[Array, np.ndarray]:
    """Line segments (S, 2, 2) along the edges, and whose each is, limbs from 1."""
    runs = [section.edge_points(k, step) for k in range(len(section.limb))]
    pairs = [np.stack([run[:-1], run[1:]], axis=1) for run in runs]
    flat = np.concatenate(pairs) if pairs else np.empty((0, 2, 2))
    limbs = np.repeat(section.limb, [len(pair) for pair in pairs])
    return flat, limbs


def filled(section: Section, step: float = STEP) -> tuple[Array, np.ndarray]:
    """Triangles of the region: points (V, 2) mm and faces (F, 3)."""
    from kinematics.solids.csg import flat_mesh

    return flat_mesh([section.polyline(n, step) for n in range(section.loops)])


def _raised(flat: Array, at: float) -> Array:
    """Points (..., 2) of a plane at ``at`` as points (..., 3)."""
    return np.concatenate([np.full((*flat.shape[:-1], 1), at), flat], axis=-1)


REST = 0.15  # s for which a workspace must stay before it is measured
SECTION = Question("work.section", "sections", draw)
# Apart, so that a section is never behind a volume, let alone behind the first one of all, for
# which code is compiled.
VOLUME = Question("work.volume", "measures", measure, REST, kept=64)
Inside = tuple[Region, tuple[float, ...] | None]
"""Of what the largest is wanted, and about which point; None for wherever the most room is."""
BALL = Question("work.ball", "measures", sphere, slow=True, urgent=True)
BOX = Question("work.box", "measures", box, slow=True, urgent=True)
