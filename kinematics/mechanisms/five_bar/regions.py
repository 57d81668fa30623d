"""Regions of the five-bar's plane as results: the workspace, each working mode's, the aspects."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from kinematics.answers.modes import one_of
from kinematics.answers.sections import Region, RegionSpec
from kinematics.facets.regions import RegionsFacet
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.aspects import aspects
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import MODES
from kinematics.plane.arcs import Arcs
from kinematics.plane.regions import point_inside, section_of


class Regions(RegionsFacet[FiveBarDesign]):
    """What can be reached in any of the modes, one region, of which some pieces may hang together;
    that of each mode; the parts of each mode that no singularity divides, larger ones first. Edges
    and areas are exact, the plane is the base's own, z = 0.
    """

    specs = (
        RegionSpec("workspace", "Workspace", ("x", "y"), "Fig. 9", uses_modes=True, joint="θ"),
        RegionSpec(
            "modes", "Workspace of each working mode", ("x", "y"), uses_modes=True, joint="θ"
        ),
        RegionSpec("aspects", "Aspects", ("x", "y"), uses_modes=True, joint="θ"),
    )

    def arcs(self, pose: Sequence[float], modes: tuple[str, ...] | None) -> Arcs:
        return workspace.made_of(self.design, MODES if modes is None else modes)

    def found(
        self, key: str, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[Region, ...]:
        chosen = MODES if modes is None else tuple(modes)
        for mode in chosen:
            one_of(mode, MODES)
        if key == "workspace":
            return (_of_modes(self.design, None if modes is None else chosen),)
        if key == "modes":
            return tuple(_of_modes(self.design, (mode,)) for mode in chosen)
        return tuple(region for region in _aspects(self.design) if region.mode in chosen)


@lru_cache(maxsize=64)
def _of_modes(design: FiveBarDesign, modes: tuple[str, ...] | None) -> Region:
    chosen = MODES if modes is None else modes
    loops = workspace.loops(design, chosen)
    section = section_of(loops, workspace.made_of(design, chosen) if chosen else None)
    one = chosen[0] if len(chosen) == 1 else ""
    title = f"working mode {one.replace('-', '−')}" if one else "workspace"
    return Region(title, section, 0.0, one, 0, 0, point_inside(loops))


@lru_cache(maxsize=64)
def _aspects(design: FiveBarDesign) -> tuple[Region, ...]:
    found: list[Region] = []
    for aspect in aspects(design):
        sign = "det B > 0" if aspect.sign > 0 else "det B < 0"
        off = max((e.deviation for loop in aspect.loops for e in loop), default=0.0)
        found.append(
            Region(
                f"working mode {aspect.mode.replace('-', '−')}, {sign}",
                section_of(aspect.loops),
                off,
                aspect.mode,
                aspect.sign,
                aspect.group,
                point_inside(aspect.loops),
            )
        )
    return tuple(found)
