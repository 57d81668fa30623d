"""The facets of the mechanism, each a thin face of the rooms that compute."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.loci import LocusCurves
from kinematics.answers.motion import Motion, Statics, WrenchSystem
from kinematics.answers.sections import Box, MapCells, Section, SectionSpec, Sphere, Volume
from kinematics.answers.singularities import AT, Event, Singularity
from kinematics.answers.solutions import (
    Followed,
    ForwardSolutions,
    InverseSolutions,
    Posture,
    Refreshed,
)
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.solids import (
    SURFACES,
    Resolution,
    SolidRequest,
    SolidsFacet,
    SolidSpec,
    SurfaceKind,
)
from kinematics.mechanisms.five_rpur import clearances as room
from kinematics.mechanisms.five_rpur import design as designs
from kinematics.mechanisms.five_rpur import (
    inverse,
    maps,
    measures,
    motion,
    section,
    statics,
    volume,
)
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.forward import assembly, refreshing
from kinematics.mechanisms.five_rpur.inscribed import largest
from kinematics.mechanisms.five_rpur.nearest_pose import ways_in
from kinematics.mechanisms.five_rpur.paths import driving, events
from kinematics.mechanisms.five_rpur.singularities import ball, curves, kinds
from kinematics.screws.spatial import homogeneous, rotation_x, rotation_y

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid
from kinematics.facets.clearances import ClearancesFacet
from kinematics.facets.forward import ForwardFacet
from kinematics.facets.inverse import InverseFacet
from kinematics.facets.maps import MapsFacet
from kinematics.facets.measures import MeasuresFacet
from kinematics.facets.motion import MotionFacet
from kinematics.facets.paths import PathsFacet
from kinematics.facets.sections import SectionsFacet
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.facets.statics import StaticsFacet

_PARTS = {
    "whole": ("vertex space", "Fig. 13"),
    "plus": ("half of mode +", ""),
    "minus": ("half of mode −", ""),
    "body": ("main body", "Fig. 12"),
    "H1": ("hole H₁", "Fig. 9"),
    "H2": ("hole H₂", "Fig. 10"),
    "H3": ("hole H₃", "Fig. 11"),
}


_ASPECTS = SolidSpec(
    "aspects", "Aspects of the present mode", "Singularities", of_present_mode=True
)


class RPURInverse(InverseFacet[FiveRPURDesign]):
    """TODO"""

    def posture(self, pose: Sequence[float], mode: str) -> Posture:
        return inverse.posture(self.design, pose, mode)

    def __call__(self, poses: ArrayLike) -> InverseSolutions:
        return inverse.inverse(self.design, poses)

    def inside(self, pose: Sequence[float], modes: tuple[str, ...] | None) -> bool:
        return bool(inverse.inside(self.design, pose, modes))


class RPURForward(ForwardFacet[FiveRPURDesign]):
    """TODO"""

    def __call__(
        self, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]:
        return assembly.forward(self.design, joints, mixed_modes=mixed_modes)

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        return refreshing.refresh(self.design, before, joints)

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        return assembly.forward_is_quick(self.design, mixed_modes=mixed_modes)


class RPURMotion(MotionFacet[FiveRPURDesign]):
    """TODO"""

    def inverse(
        self,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.inverse_motion(self.design, poses, mode, pose_rates, pose_accelerations)

    def forward(
        self,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        return motion.forward_motion(self.design, poses, mode, joint_rates, joint_accelerations)


class RPURStatics(StaticsFacet[FiveRPURDesign]):
    """TODO"""

    def wrenches(self, poses: ArrayLike, mode: str) -> WrenchSystem:
        return statics.wrench_system(self.design, poses, mode)

    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
        return statics.statics(self.design, poses, mode, loads)


class RPURSingularities(SingularitiesFacet[FiveRPURDesign]):
    """TODO"""

    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        return kinds.singularities(self.design, posture, tolerance)

    loci = curves.SPECS

    def locus(
        self,
        key: str,
        pose: Sequence[float],
        mode: str,
        at: float | None = None,
    ) -> LocusCurves:
        return curves.locus(self.design, key, pose, mode, at)


class RPURClearances(ClearancesFacet[FiveRPURDesign]):
    """TODO"""

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        found = room.clearances(self.design, posture)
        return room.with_singularity(self.design, posture, found) if singular else found

    def nearest_pose(self, posture: Posture) -> Remedy:
        return ways_in.remedy(self.design, posture)


class RPURPaths(PathsFacet[FiveRPURDesign]):
    """TODO"""

    def passed(self, before: Posture, after: Posture) -> tuple[Event, ...]:
        return events.passed(self.design, before, after)

    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        return driving.path(self.design, posture, poses)


class RPURMeasures(MeasuresFacet[FiveRPURDesign]):
    """TODO"""

    specs = measures.MEASURES

    def __call__(
        self,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        return measures.measure(self.design, poses, mode, key, load)


class RPURSolids(SolidsFacet[FiveRPURDesign]):
    """TODO"""

    @property
    def specs(self) -> tuple[SolidSpec, ...]:
        workspace = SolidSpec(
            "workspace",
            "Constant-orientation workspace",
            "Workspace",
            figure="Figs. 14, 15, 18",
            uses_modes=True,
            surfaces=SURFACES,
        )
        return (workspace, _ASPECTS, *_limb_specs())

    def request(
        self,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest:
        if key == "workspace":
            orientation = float(pose[3]), float(pose[4])
            arguments: tuple[Any, ...] = (key, self.design.limbs, *orientation, modes, surface)
        elif key == _ASPECTS.key:
            if modes is None or len(modes) != 1:
                raise InputError("aspects are those of one working mode; choose one")
            arguments = (key, self.design.limbs, float(pose[3]), float(pose[4]), modes[0])
        else:
            i, part = _limb_part(key)
            limb = self.design.limbs[i]
            arguments = ("part", limb.link, *limb.stroke, part)
        return SolidRequest(self.mechanism.kind, arguments, resolution)

    def placement(self, key: str, pose: Sequence[float]) -> Array:
        """4x4 from the frame in which the solid is built to the base frame.

        The workspace and the aspects are built in x'y'z' (paper, section 4), a vertex space too
        but about A_i, to be offset by w'_i (eq. 27).
        """
        phi, theta = float(pose[3]), float(pose[4])
        turned = rotation_y(theta)
        offset = np.zeros(3)
        if key not in ("workspace", _ASPECTS.key):
            i, _ = _limb_part(key)
            offset = self.design.base[i] - turned @ rotation_x(phi) @ self.design.platform[i]
        return homogeneous(turned, offset)

    @staticmethod
    def build(request: SolidRequest) -> BuiltSolid:
        from kinematics.mechanisms.five_rpur.workspace import workspace

        what, *arguments = request.arguments
        if what == "workspace":
            limbs, phi, theta, modes, surface = arguments
            design = FiveRPURDesign(limbs)
            return workspace.workspace(design, phi, theta, modes, request.resolution, surface)
        if what == _ASPECTS.key:
            from kinematics.mechanisms.five_rpur.singularities import aspects

            limbs, phi, theta, mode = arguments
            design = FiveRPURDesign(limbs)
            return aspects.aspects(design, phi, theta, mode, request.resolution)
        link, low, high, part = arguments
        zero = (0.0, 0.0, 0.0)
        limb = Limb(zero, zero, link, (low, high))
        alone = FiveRPURDesign((limb, limb, limb, limb, limb))
        return workspace.limb_part(alone, 1, part, request.resolution)


class RPURSections(SectionsFacet[FiveRPURDesign]):
    """TODO"""

    spec = SectionSpec("Section at x′", "x′", ("y′", "z′"), "Fig. 17")

    def frame(self, pose: Sequence[float]) -> Array:
        """4x4 from (x', y', z') to the base frame: R_y(θ)."""
        return homogeneous(rotation_y(float(pose[4])), np.zeros(3))

    def range(
        self, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[float, float] | None:
        return section.section_range(self.design, pose[3], pose[4], modes)

    def at(
        self,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        at: float,
    ) -> Section:
        return section.section(self.design, pose[3], pose[4], at, modes)

    def volume(
        self,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        *,
        relative: float = 1e-6,
        pieces: bool = True,
    ) -> Volume:
        return volume.volume(
            self.design, pose[3], pose[4], modes, relative=relative, structure=pieces
        )

    def ball(
        self,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Sphere | None:
        return largest.sphere(self.design, pose[3], pose[4], modes, center)

    def box(
        self,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Box | None:
        return largest.box(self.design, pose[3], pose[4], modes, center)

    def singularity_free_ball(
        self,
        pose: Sequence[float],
        mode: str,
        center: Sequence[float] | None = None,
    ) -> Sphere | None:
        return ball.singularity_free_ball(self.design, pose[3], pose[4], mode, center)


class RPURMaps(MapsFacet[FiveRPURDesign]):
    """TODO"""

    spec = maps.SPEC

    def cells(
        self,
        poses: ArrayLike,
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        *,
        relative: float = 1e-4,
    ) -> MapCells:
        return maps.map_cells(self.design, poses, modes, quantities, relative=relative)


@cache
def _limb_specs() -> tuple[SolidSpec, ...]:
    return tuple(
        SolidSpec(f"limb{i}/{part}", f"Limb {i}: {title}", f"Limb {i}", limb=i, figure=figure)
        for i in range(1, designs.LIMBS + 1)
        for part, (title, figure) in _PARTS.items()
    )


def _limb_part(key: str) -> tuple[int, str]:
    name, _, part = key.partition("/")
    number = name.removeprefix("limb")
    if number not in {str(i) for i in range(1, designs.LIMBS + 1)} or part not in _PARTS:
        raise InputError(
            f"there is no solid {key!r}; it is 'workspace', 'aspects' or 'limbN/PART' with N "
            f"from 1 to 5 and PART one of {', '.join(_PARTS)}"
        )
    return int(number) - 1, part
