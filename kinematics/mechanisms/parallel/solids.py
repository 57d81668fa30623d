"""Where a parallel mechanism can be while three coordinates of its pose are free: a solid.

Positions are places, of O′ in the base frame; angles are drawn as lengths, one radian as long as
the characteristic length, along what axes are left. Other coordinates are held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.facets.solids import SolidRequest, SolidsFacet, SolidSpec, SurfaceKind
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.design import ParallelDesign
from kinematics.mechanisms.parallel.mechanism import Parallel
from kinematics.mechanisms.parallel.mobility import SYMBOLS

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid

KEY = "workspace"


def slots(machine: Assembly) -> tuple[int, int, int]:
    """Which of the pose's coordinates is drawn along x, y and z."""
    free = machine.chart.free
    found = {coordinate: n for n, coordinate in enumerate(free) if coordinate < 3}
    for n, coordinate in enumerate(free):
        if coordinate >= 3 and len(found) < 3:
            found[next(k for k in range(3) if k not in found)] = n
    return found[0], found[1], found[2]


def scales(machine: Assembly) -> Array:
    """(3,) mm per unit of the coordinates that are drawn."""
    free = machine.chart.free
    return np.array([1.0 if free[n] < 3 else machine.length for n in slots(machine)])


class Solids(SolidsFacet[ParallelDesign]):
    """One solid, of one mode at a time where there are several."""

    @property
    def _machine(self) -> Assembly:
        return cast(Parallel, self.mechanism).machine

    @property
    def specs(self) -> tuple[SolidSpec, ...]:
        machine = self._machine
        free = machine.chart.free
        shown = slots(machine)
        names = ", ".join(SYMBOLS[free[n]] for n in sorted(shown))
        title = f"Workspace: {names}"
        held = [SYMBOLS[c] for n, c in enumerate(free) if n not in shown]
        if held:
            title += f" while {', '.join(held)} stay{'s' if len(held) == 1 else ''}"
        several = len(self.mechanism.modes) > 1
        places = all(free[n] < 3 for n in shown)
        return (SolidSpec(KEY, title, "Workspace", of_present_mode=several, places=places),)

    def arguments(
        self,
        spec: SolidSpec,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        surface: SurfaceKind,
    ) -> tuple[Any, ...]:
        shown = slots(self._machine)
        held = tuple(0.0 if n in shown else float(v) for n, v in enumerate(pose))
        mode = str(modes[0]) if modes else str(self.mechanism.modes[0])
        return replace(self.design, name="", title="", source=""), mode, held

    def point(self, key: str, pose: ArrayLike, mode: str) -> Array:
        shown = np.asarray(pose, dtype=float)[..., list(slots(self._machine))]
        return np.asarray(shown * scales(self._machine))

    def poses(self, key: str, pose: Sequence[float], mode: str, points: ArrayLike) -> Array:
        places = np.asarray(points, dtype=float)
        poses = np.tile(np.asarray(pose, dtype=float), (len(places), 1))
        poses[:, list(slots(self._machine))] = places / scales(self._machine)
        return poses

    @staticmethod
    def build(request: SolidRequest) -> BuiltSolid:
        from kinematics.mechanisms.parallel.workspace import build

        design, mode, held = request.arguments
        return build(design, mode, held, request.resolution)
