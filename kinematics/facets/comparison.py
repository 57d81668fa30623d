"""Workspaces of several designs over one another: what they share, and what each alone reaches.

Of 5-RPURs at one orientation all is exact: the limbs of all machines bound the same sections. Of
plane workspaces so is it by their arcs. Else solids are cut with each other, and what their facets
may be off is told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from math import inf
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.sections import Section
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.facet import required
from kinematics.facets.regions import RegionsFacet
from kinematics.facets.solids import Resolution, SolidsFacet
from kinematics.facets.spaces import ShownSolid, Space
from kinematics.plane.arcs import joined
from kinematics.plane.arrangement import boundary
from kinematics.plane.regions import section_of

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid, Solid

MOST = 4
"""Designs that are compared at a time."""
THINNEST = {"preview": 3e-3, "normal": 1e-3, "fine": 3e-4}
"""Of the size: parts thinner than this on the average may be due to facets alone."""


@dataclass(frozen=True, slots=True)
class Size:
    """A volume, mm³, or an area, mm², and an estimate from above of its error."""

    value: float
    error: float


@dataclass(frozen=True, eq=False, slots=True)
class Parts:
    """Solids where the first workspace stands: what all share, and what each alone reaches."""

    common: BuiltSolid
    only: tuple[BuiltSolid, ...]


class Comparison:
    """Two to four workspaces over one another, their base frames on one another.

    Those of tripods, whose solids are poses drawn as places, are drawn as of the first one.

    Attributes:
        spaces: the workspaces.
        unit: of their sizes.

    Raises:
        InputError: fewer than two or more than four, or workspaces of different coordinates.

    Example:
        >>> import kinematics as kin
        >>> one, other = kin.open("rpur-table1"), kin.open("rpur-table2")
        >>> found = one.compare(other, phi=0.1, theta=0.0)
        >>> abs(found.common.value + found.only[0].value - found.sizes[0].value) < 100
        True
    """

    def __init__(self, spaces: Sequence[Space[Any]], relative: float = 1e-6) -> None:
        if not 2 <= len(spaces) <= MOST:
            raise InputError(f"two to {MOST} designs are compared, got {len(spaces)}")
        self.spaces = tuple(spaces)
        self.relative = relative
        self._way = self._told()
        self.unit: Literal["mm³", "mm²"] = "mm²" if self._way == "regions" else "mm³"

    def __repr__(self) -> str:
        names = ", ".join(space.machine.design.name for space in self.spaces)
        return f"<Comparison of {names}: {self.common.value:.6g} {self.unit} in common>"

    @property
    def exact(self) -> bool:
        """Whether sizes are those of the true workspaces, and not of meshes."""
        return self._way != "solids"

    @cached_property
    def sizes(self) -> tuple[Size, ...]:
        """How large each workspace is."""
        if self._way == "sections":
            return tuple(self._shared((n,)) for n in range(len(self.spaces)))
        if self._way == "regions":
            return tuple(_size(space.section()) for space in self.spaces)
        made = zip(*self._made("normal"), strict=True)
        return tuple(_charted_size(shown.built, solid) for shown, solid in made)

    @cached_property
    def common(self) -> Size:
        """What all of them share."""
        if self._way == "regions":
            return _size(self.sections[0])
        return self._shared(tuple(range(len(self.spaces))))

    @cached_property
    def only(self) -> tuple[Size, ...]:
        """What each of them reaches and no other does."""
        if self._way == "regions":
            return tuple(_size(section) for section in self.sections[1])
        return tuple(self._alone(n) for n in range(len(self.spaces)))

    @cached_property
    def sections(self) -> tuple[Section, tuple[Section, ...]]:
        """Of plane workspaces: the region that all share, and what each alone reaches.

        Raises:
            InputError: the workspaces are not plane.
        """
        if self._way != "regions":
            raise InputError("these workspaces are solids: ask for parts()")
        facets = [required(space.machine.regions, "plane workspace") for space in self.spaces]
        made = [f.arcs(s.pose, s.modes) for f, s in zip(facets, self.spaces, strict=True)]
        arcs = joined([one for one in made if one is not None])
        size = max(space.machine.length for space in self.spaces)

        def held(points: Array) -> NDArray[np.bool_]:
            """(M, N) which workspace holds which point."""
            return np.stack([s.machine.inverse.inside(points, s.modes) for s in self.spaces])

        def alone(n: int) -> Section:
            def inside(points: Array) -> NDArray[np.bool_]:
                found = held(points)
                return np.asarray(found[n] & (found.sum(axis=0) == 1))

            return section_of(boundary(arcs, inside, size))

        def shared(points: Array) -> NDArray[np.bool_]:
            return np.asarray(held(points).all(axis=0))

        every = section_of(boundary(arcs, shared, size))
        return every, tuple(alone(n) for n in range(len(self.spaces)))

    def parts(self, resolution: Resolution = "normal", *, judged: bool = True) -> Parts:
        """What they share, and what each alone reaches, as closed solids.

        Their volumes are the meshes'; ``volume_error`` says how far from the true ones.

        Args:
            judged: else the errors are not known, and infinite: that takes less time.

        Raises:
            InputError: the workspaces are plane: see `sections`.
        """
        from kinematics.solids.csg import Solid

        if self._way == "regions":
            raise InputError("these workspaces are plane: ask for sections")
        solids = self._solids(resolution)
        made = zip(*self._made(resolution), strict=True)
        every = Solid.intersection(solids)
        error = inf
        if judged:
            error = sum(_charted_size(shown.built, solid).error for shown, solid in made)
            error += abs(every.volume - self.common.value)
        # Where surfaces of two lie on one another, facets leave slivers between them.
        thinnest = THINNEST[resolution] * max(solid.volume for solid in solids) ** (1.0 / 3.0)
        return Parts(
            _finished(every, error, thinnest),
            tuple(
                _finished(one.difference([*solids[:n], *solids[n + 1 :]]), error, thinnest)
                for n, one in enumerate(solids)
            ),
        )

    # --- inside

    def _told(self) -> Literal["sections", "regions", "solids"]:
        """How the workspaces are put over one another."""
        machines = [space.machine for space in self.spaces]
        kinds = {machine.kind for machine in machines}
        for machine in machines:
            if machine.solids is None and machine.regions is None:
                raise InputError(f"the workspace of {machine.design.name} is not known as a solid")
        plane = [_is_plane(space) for space in self.spaces]
        if all(plane) and len(kinds) == 1:
            facets = [required(machine.regions, "plane workspace") for machine in machines]
            if all(_has_arcs(f, s) for f, s in zip(facets, self.spaces, strict=True)):
                return "regions"
            raise InputError(
                f"plane workspaces of a {machines[0].title} lie in different planes; let one "
                "angle follow from the constraint, as gamma=None"
            )
        if any(plane):
            raise InputError("a plane workspace and a solid have no volume in common")
        charts = {machine.kind for machine in machines if _is_chart(machine.solids)}
        if charts and len(kinds) > 1:
            names = " and ".join(sorted({machine.title for machine in machines}))
            raise InputError(f"the workspaces of {names} are of different coordinates")
        turned = {
            tuple(v for v, axis in zip(s.pose, s.pose.axes, strict=True) if axis.unit == "rad")
            for s in self.spaces
        }
        if len(kinds) == len(turned) == 1 and machines[0].sections is not None:
            return "sections"
        return "solids"

    @cached_property
    def _kept(self) -> dict[tuple[int, ...], Size]:
        return {}

    def _shared(self, which: tuple[int, ...]) -> Size:
        """What some of them share, by their numbers."""
        if which not in self._kept:
            self._kept[which] = self._found(which)
        return self._kept[which]

    def _found(self, which: tuple[int, ...]) -> Size:
        if self._way == "sections":
            first, *others = (self.spaces[n] for n in which)
            facet = required(first.machine.sections, "exact sections")
            beside = [(required(s.machine.sections, "exact sections"), s.modes) for s in others]
            found = facet.common(
                first.pose, first.modes, beside, relative=self.relative, pieces=False
            )
            return Size(found.value, found.error)
        if len(which) == 1:
            return self.sizes[which[0]]
        fine, rough = (self._meeting(which, resolution) for resolution in ("normal", "preview"))
        error = sum(self.sizes[n].error for n in which) + abs(fine - rough)
        return Size(fine, error)

    def _alone(self, n: int) -> Size:
        """By inclusion and exclusion."""
        others = [m for m in range(len(self.spaces)) if m != n]
        value, error = 0.0, 0.0
        for count in range(len(others) + 1):
            for chosen in combinations(others, count):
                part = self._shared(tuple(sorted((n, *chosen))))
                value += part.value * (-1.0) ** count
                error += part.error
        return Size(max(value, 0.0), error)

    def _meeting(self, which: tuple[int, ...], resolution: Resolution) -> float:
        """The volume that the meshes of some share."""
        from kinematics.solids.csg import Solid

        solids = self._solids(resolution)
        return Solid.intersection([solids[n] for n in which]).volume

    def _solids(self, resolution: Resolution) -> tuple[Solid, ...]:
        return self._made(resolution)[1]

    @cached_property
    def _meshes(self) -> dict[Resolution, tuple[tuple[ShownSolid, ...], tuple[Solid, ...]]]:
        return {}

    def _made(self, resolution: Resolution) -> tuple[tuple[ShownSolid, ...], tuple[Solid, ...]]:
        """The workspaces at a resolution, as they stand in the first one's base frame or chart."""
        from kinematics.solids.csg import Solid

        if resolution not in self._meshes:
            shown = tuple(space.solid(resolution) for space in self.spaces)
            places = (self._charted(n, one) for n, one in enumerate(shown))
            solids = (Solid.of(one.built, at) for one, at in zip(shown, places, strict=True))
            self._meshes[resolution] = shown, tuple(solids)
        return self._meshes[resolution]

    def _charted(self, n: int, shown: ShownSolid) -> Array:
        """Where the vertices of a workspace are among those of the first one, (V, 3) mm."""
        vertices = shown.mesh.vertices
        own, first = self.spaces[n].machine.solids, self.spaces[0].machine.solids
        if n == 0 or own is None or first is None or not _is_chart(own):
            return vertices
        space = self.spaces[n]
        mode = (space.modes or (space.machine.home.mode,))[0]
        poses = own.poses(shown.spec.key, space.pose, mode, vertices)
        return first.point(shown.spec.key, poses, mode)


def _is_plane(space: Space[Any]) -> bool:
    return space.machine.regions is not None and space.follows is None


def _has_arcs(facet: RegionsFacet[Any], space: Space[Any]) -> bool:
    return facet.arcs(space.pose, space.modes) is not None


def _is_chart(facet: SolidsFacet[Any] | None) -> bool:
    """Whether a solid's places are drawn for poses, and not where O′ is."""
    return facet is not None and type(facet).point is not SolidsFacet.point


def _size(section: Section) -> Size:
    return Size(section.area, section.area_error)


def _charted_size(built: BuiltSolid, drawn: Solid) -> Size:
    """The size of a solid as it is drawn among the others, which may be in another scale."""
    scale = drawn.volume / built.volume if built.volume else 1.0
    return Size(drawn.volume, scale * built.volume_error)


def _finished(solid: Solid, error: float, thinnest: float) -> BuiltSolid:
    from kinematics.solids.csg import finish

    return finish(solid, lambda _, volume: error, thinnest=thinnest, total=True)
