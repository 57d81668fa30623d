"""Exact plane sections of a workspace, and what is integrated over them: plain results.

A section is a set of closed loops of arcs and lines; the region lies to the left of every edge,
so outer loops run counter-clockwise and holes clockwise. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array, Frozen, Ints

EdgeBound = Literal["rho_min", "rho_max", "link", "parallel"]
BOUNDS: tuple[EdgeBound, ...] = ("rho_min", "rho_max", "link", "parallel")
"""What an edge is due to: an end of the stroke (of a joint's range), the reach of the links, where
the limb's two solutions meet; or, of no limb, a parallel singularity."""


@dataclass(frozen=True, eq=False)
class Construction(Frozen):
    """The circles and lines of which a section's edges are parts (Tale Masouleh 2011, Fig. 17).

    Attributes:
        center: (C, 2) mm.
        radius: (C,) mm.
        circle_limb: (C,) from 1.
        circle_bound: (C,) indices into `BOUNDS`.
        line: (M, 2, 2) both ends of each line, mm.
        line_limb: (M,) from 1.
    """

    center: Array
    radius: Array
    circle_limb: Ints
    circle_bound: Ints
    line: Array
    line_limb: Ints

    @classmethod
    def of_circles(
        cls,
        center: ArrayLike = (),
        radius: ArrayLike = (),
        limb: ArrayLike = (),
        bound: ArrayLike = (),
    ) -> Construction:
        """Circles without lines; none if nothing is given."""
        return cls(
            np.asarray(center, dtype=float).reshape(-1, 2),
            np.asarray(radius, dtype=float),
            np.asarray(limb, dtype=np.int64),
            np.asarray(bound, dtype=np.int64),
            np.zeros((0, 2, 2)),
            np.zeros(0, dtype=np.int64),
        )


@dataclass(frozen=True, eq=False)
class Section(Frozen):
    """The exact section of a workspace by a plane; all arrays read-only.

    Edge k runs from ``start[k]`` to ``end[k]``; ``loop_start[n]`` to ``loop_start[n + 1]`` are the
    edges of loop n, in order. A whole circle is two half circles.

    Attributes:
        at: where the plane stands, mm.
        start, end: (E, 2) mm.
        limb: (E,) from 1: whose bound the edge is; 0 of a parallel singularity.
        bound: (E,) indices into `BOUNDS`.
        center: (E, 2) mm of an arc; NaN of a line.
        radius: (E,) mm of an arc; inf of a line.
        sweep: (E,) rad, the arc's signed angle, counter-clockwise positive; 0 of a line.
        loop_start: (L + 1,).
        loop_area: (L,) mm², negative of holes.
        loop_piece: (L,) which piece of the region the loop bounds, from 0.
        area: mm².
        perimeter: mm.
        centroid: (2,) mm; NaN of an empty section.
        second_moments: (3,) mm⁴ about the centroid: ∫v² dA, ∫w² dA, ∫vw dA with (v, w) the
            section's coordinates (here y′, z′) from the centroid.
        construct: gives the curves that made it, see `construction`.
        area_error: mm², an estimate from above of the area's error, besides the rounding of closed
            forms: from curves that are no arcs, and from edges that do not quite meet. Slivers
            between two arcs thinner than 1e-7 of the size (1e-10 of its square) are not counted.
    """

    at: float
    start: Array
    end: Array
    limb: Ints
    bound: Ints
    center: Array
    radius: Array
    sweep: Array
    loop_start: Ints
    loop_area: Array
    loop_piece: Ints
    area: float
    perimeter: float
    centroid: Array
    second_moments: Array
    construct: Callable[[], Construction]
    area_error: float = 0.0

    def __repr__(self) -> str:
        return (
            f"<Section at {self.at:.6g} mm: {self.area:.6g} mm², {self.pieces} pieces, "
            f"{len(self.start)} edges>"
        )

    @cached_property
    def construction(self) -> Construction:
        """The circles and lines of which the edges are parts."""
        return self.construct()

    @property
    def loops(self) -> int:
        """The number of closed loops."""
        return len(self.loop_start) - 1

    @property
    def pieces(self) -> int:
        """The number of connected pieces of the region."""
        return int(self.loop_piece.max()) + 1 if self.loops else 0

    @property
    def is_arc(self) -> NDArray[np.bool_]:
        """(E,) arcs, as against lines."""
        return np.isfinite(self.radius)

    def polyline(self, loop: int, step: float) -> Array:
        """A loop as points (N, 2) on its edges, no arc's chord longer than about ``step`` mm.

        The first point is not repeated at the end.
        """
        edges = range(self.loop_start[loop], self.loop_start[loop + 1])
        return np.concatenate([self.edge_points(k, step)[:-1] for k in edges])

    def edge_points(self, edge: int, step: float) -> Array:
        """Points (N, 2) along an edge from its start to its end, both included."""
        if not np.isfinite(self.radius[edge]):
            return np.stack([self.start[edge], self.end[edge]])
        length = abs(self.sweep[edge]) * self.radius[edge]
        count = max(2, int(np.ceil(abs(self.sweep[edge]) / 0.5)), int(np.ceil(length / step)))
        from_center = self.start[edge] - self.center[edge]
        angle = np.arctan2(from_center[1], from_center[0]) + self.sweep[edge] * np.linspace(
            0.0, 1.0, count + 1
        )
        points = self.center[edge] + self.radius[edge] * np.stack(
            [np.cos(angle), np.sin(angle)], axis=-1
        )
        points[0], points[-1] = self.start[edge], self.end[edge]
        return np.asarray(points)


def kept(made: Construction) -> Callable[[], Construction]:
    """``construct`` of a section that has it already; it crosses to other processes."""
    return partial(_same, made)


def _same(made: Construction) -> Construction:
    return made


def together(sections: Sequence[Section]) -> Section:
    """Several sections as one, their loops and pieces one after another; no moments."""
    if len(sections) == 1:
        return sections[0]
    pieces = np.cumsum([0, *(s.pieces for s in sections[:-1])])
    edges = np.cumsum([0, *(len(s.start) for s in sections[:-1])])

    def all_of(name: str) -> Any:
        return np.concatenate([getattr(s, name) for s in sections])

    starts = [s.loop_start[:-1] + n for s, n in zip(sections, edges, strict=True)]
    return Section(
        at=0.0,
        start=all_of("start"),
        end=all_of("end"),
        limb=all_of("limb"),
        bound=all_of("bound"),
        center=all_of("center"),
        radius=all_of("radius"),
        sweep=all_of("sweep"),
        loop_start=np.concatenate([*starts, [sum(len(s.start) for s in sections)]]).astype(int),
        loop_area=all_of("loop_area"),
        loop_piece=np.concatenate(
            [s.loop_piece + n for s, n in zip(sections, pieces, strict=True)]
        ),
        area=sum(s.area for s in sections),
        perimeter=sum(s.perimeter for s in sections),
        centroid=np.full(2, np.nan),
        second_moments=np.full(3, np.nan),
        construct=kept(Construction.of_circles()),
        area_error=sum(s.area_error for s in sections),
    )


@dataclass(frozen=True, slots=True)
class RegionSpec:
    """Regions of a plane that a mechanism can show: "workspace", "modes", "aspects", …

    Attributes:
        key, title: how it is called.
        axes: the symbols of the plane's coordinates.
        uses_modes: it depends on the chosen set of modes.
        joint: the letter of the joints whose ranges bound it.
    """

    key: str
    title: str
    axes: tuple[str, str]
    figure: str = ""
    uses_modes: bool = False
    joint: str = "ρ"

    @property
    def plane(self) -> SectionSpec:
        """The regions' boundaries as sections by the plane."""
        return SectionSpec(self.title, "normal", self.axes, self.figure, self.joint)


@dataclass(frozen=True, eq=False)
class Region(Frozen):
    """A region of a mechanism's plane with its boundary.

    Attributes:
        title: one line for the user.
        section: its boundary, loop by loop; its area and moments are those of the true boundary.
        deviation: mm by which an edge may leave the true boundary; 0 where all are true arcs.
            Of a curve that is no arc every edge is an arc through three points of it.
        mode: the mode it belongs to; "" where it is of several.
        sign: of the wrenches' determinant all over it; 0 where that changes.
        group: regions with the same number can be joined through serial singularities; 0 of one
            that was not asked.
        inside: (2,) mm, a point well inside; NaN of an empty region.
    """

    title: str
    section: Section
    deviation: float
    mode: str
    sign: int
    group: int
    inside: Array


@dataclass(frozen=True, eq=False)
class Volume(Frozen):
    """A volume as the integral of exact section areas.

    Attributes:
        value: mm³.
        error: mm³, an estimate from above of |value − true volume|.
        centroid: (3,) mm in the base frame; NaN of an empty workspace.
        pieces: the volumes of the connected pieces, mm³, largest first; none if not asked for.
        at: (N,) where sections were taken, increasing, mm.
        area: (N,) their areas, mm².
        events: (P,) where the structure of the section changes, increasing, mm; those that have no
            closed form as closely as neighbouring sections tell.
        sections: how many sections were computed.
    """

    value: float
    error: float
    centroid: Array
    pieces: tuple[float, ...]
    at: Array
    area: Array
    events: Array
    sections: int


@dataclass(frozen=True, eq=False)
class Sphere(Frozen):
    """A ball inside the workspace: centre (3,) and radius, mm, base frame.

    ``error``: mm by which the largest ball about this centre may differ from ``radius``.
    """

    center: Array
    radius: float
    error: float


@dataclass(frozen=True, eq=False)
class Box(Frozen):
    """A box inside the workspace, its edges along x, y, z of the base frame.

    ``low`` and ``high`` (3,) mm are its corners; ``error``: mm by which a face may stand out.
    """

    low: Array
    high: Array
    error: float

    @cached_property
    def volume(self) -> float:
        """mm³."""
        return float(np.prod(self.high - self.low))


@dataclass(frozen=True, slots=True)
class SectionSpec:
    """What a mechanism calls its sections: the plane ``normal`` = const and the axes in it.

    ``joint`` is the letter of the joints whose ranges bound them.
    """

    title: str
    normal: str
    axes: tuple[str, str]
    figure: str = ""
    joint: str = "ρ"


@dataclass(frozen=True, slots=True)
class Quantity:
    """Something that a map shows: "volume", "pieces", "largest_piece", "sphere", "stroke"."""

    key: str
    title: str
    unit: Literal["mm³", "mm", "%", ""]


@dataclass(frozen=True, slots=True)
class MapSpec:
    """What a mechanism's map runs over: two pose coordinates (indices), and what it can show."""

    axes: tuple[int, int]
    quantities: tuple[Quantity, ...]
    figure: str = ""


@dataclass(frozen=True, eq=False)
class MapCells(Frozen):
    """Points of a map: the wanted quantities and their errors, in their units.

    Attributes:
        values: (N, Q).
        errors: (N, Q) estimates from above of each value's error.
    """

    values: Array
    errors: Array
