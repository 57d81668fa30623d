"""What a mechanism answers where it has nothing of the kind."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.sections import (
    Box,
    MapCells,
    MapSpec,
    Region,
    RegionSpec,
    Section,
    SectionSpec,
    Sphere,
    Volume,
)
from kinematics.answers.singularities import (
    Clearance,
    Event,
    LocusCurves,
    LocusSpec,
    Measure,
    MicrTable,
    ModeChange,
    OrientationCircle,
    Profile,
    Remedy,
)
from kinematics.answers.solutions import Fold, Posture
from kinematics.errors import InputError
from kinematics.mechanism import (
    Coordinate,
    Design,
    Resolution,
    SolidRequest,
    SolidSpec,
    SurfaceKind,
)
from kinematics.screws.spatial import Array

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid
    from kinematics.trajectories import NamedTrajectory


class Bare:
    """What a mechanism answers where it has nothing of the kind; to be inherited, overridden."""

    mode_noun = "working mode"
    has_profile = False

    def about(self, topic: str) -> str:
        """Markdown about a topic of this mechanism: what it is, its paper's figures and equations.

        Topics: "move", "mode" (one phrase: what + says of a limb), "solutions", "workspace",
        "section", "singularities", "map", "trajectory", "design". "" where nothing is to be said.
        """
        return ""

    def dependent_coordinates(self, design: Any) -> tuple[int, ...]:
        """Those pose coordinates of which one, whichever is chosen, follows from the others."""
        return ()

    def complete_pose(
        self,
        design: Any,
        pose: Sequence[float],
        mode: str,
        moved: int | None = None,
        dependent: int | None = None,
    ) -> tuple[float, ...]:
        """The pose with its dependent coordinate made true, where a mechanism has such.

        Args:
            pose: one coordinate may be NaN: that one is solved for. Else ``dependent`` gives way
                or, where that is the one that was ``moved`` by hand or None, another one.

        Raises:
            InputError: there is no such pose, or the mechanism has no dependent coordinate.
        """
        if any(value != value for value in pose):
            raise InputError("every coordinate of the pose must be given")
        return tuple(pose)

    def prepare(self) -> None:
        pass

    def solids(self, design: Any) -> tuple[SolidSpec, ...]:
        return ()

    def solid_request(
        self,
        design: Any,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest:
        raise InputError(f"this mechanism has no solid {key!r}")

    def solid_placement(self, design: Any, key: str, pose: Sequence[float]) -> Array:
        raise InputError(f"this mechanism has no solid {key!r}")

    def build_solid(self, request: SolidRequest) -> BuiltSolid:
        raise InputError("this mechanism has no solids")

    def solid_point(self, design: Any, key: str, pose: Sequence[float], mode: str) -> Array:
        """Where a pose is in a solid as placed, (3,) mm: the place of O′, unless overridden."""
        at: Array = self.transform(design, pose, mode)[:3, 3]  # type: ignore[attr-defined]
        return at

    def solid_poses(
        self, design: Any, key: str, pose: Sequence[float], mode: str, points: ArrayLike
    ) -> Array:
        """The poses (N, P) that points (N, 3) mm of a solid as placed stand for, all else held.

        NaN where there is none.
        """
        places = np.asarray(points, dtype=float)
        poses = np.tile(np.asarray(pose, dtype=float), (len(places), 1))
        axes: tuple[Coordinate, ...] = self.pose_coordinates(design)  # type: ignore[attr-defined]
        for n, c in enumerate(axes):
            if c.key in ("x", "y", "z"):
                poses[:, n] = places[:, "xyz".index(c.key)]
        return poses

    def section_spec(self, design: Any) -> SectionSpec | None:
        return None

    def section_frame(self, design: Any, pose: Sequence[float]) -> Array:
        raise InputError(_NO_SECTIONS)

    def section_range(
        self, design: Any, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[float, float] | None:
        return None

    def section(
        self, design: Any, pose: Sequence[float], modes: tuple[str, ...] | None, at: float
    ) -> Section:
        raise InputError(_NO_SECTIONS)

    def volume(
        self,
        design: Any,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        *,
        relative: float = 1e-6,
    ) -> Volume:
        raise InputError(_NO_SECTIONS)

    def sphere(
        self,
        design: Any,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Sphere | None:
        raise InputError(_NO_SECTIONS)

    def box(
        self,
        design: Any,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Box | None:
        raise InputError(_NO_SECTIONS)

    def singularity_free_ball(
        self, design: Any, pose: Sequence[float], mode: str, center: Sequence[float] | None = None
    ) -> Sphere | None:
        return None

    def map_spec(self, design: Any) -> MapSpec | None:
        return None

    def map_cells(
        self,
        design: Any,
        poses: ArrayLike,
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        *,
        relative: float = 1e-4,
    ) -> MapCells:
        raise InputError("this mechanism has no map")

    def fold_ahead(self, design: Any, posture: Posture, joints: Sequence[float]) -> Fold | None:
        return None

    def forward_is_quick(self, design: Any, *, mixed_modes: bool = False) -> bool:
        return True

    def measures(self, design: Any) -> tuple[Measure, ...]:
        return ()

    def measure(
        self,
        design: Any,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        raise InputError(f"this mechanism has no measure {key!r}")

    def clearances(
        self, design: Any, posture: Posture, *, singular: bool = True
    ) -> tuple[Clearance, ...]:
        return ()

    def remedy(self, design: Any, posture: Posture) -> Remedy:
        return Remedy(None, nan, (), "")

    def passed(self, design: Any, before: Posture, after: Posture) -> tuple[Event, ...]:
        return ()

    def mode_change(self, design: Any, posture: Posture, wanted: str = "") -> ModeChange | None:
        """Where the mode may be changed without taking the machine apart; None where nowhere."""
        return None

    def circles(
        self, design: Any, pose: Sequence[float], mode: str
    ) -> tuple[OrientationCircle, ...]:
        """About the pose's orientation, at its altitude: one circle for each limit."""
        return ()

    def profile(self, design: Any, pose: Sequence[float], ratios: Sequence[float] = ()) -> Profile:
        """Such circles about the level platform against the altitude, if `has_profile`."""
        raise InputError("this mechanism has no profile of circles over the altitude")

    def profile_place(self, design: Any, pose: Sequence[float]) -> float:
        """Where on the axis of its profile the machine stands."""
        raise InputError("this mechanism has no profile of circles over the altitude")

    def micr(self, base: ArrayLike, platform: ArrayLike, altitude: ArrayLike) -> MicrTable:
        """MICR over circumradii and altitudes, which broadcast."""
        raise InputError("this mechanism has no maximum inscribed circle (MICR)")

    def counterparts(self, design: Any) -> tuple[Design, ...]:
        """Other machines with the same numbers, which it is worth comparing with."""
        return ()

    def locus_specs(self, design: Any) -> tuple[LocusSpec, ...]:
        return ()

    def locus(
        self, design: Any, key: str, pose: Sequence[float], mode: str, at: float | None = None
    ) -> LocusCurves:
        raise InputError(f"this mechanism has no loci {key!r}")

    def region_specs(self, design: Any) -> tuple[RegionSpec, ...]:
        return ()

    def region_frame(self, design: Any, pose: Sequence[float]) -> Array:
        raise InputError("this mechanism's workspace does not lie in a plane")

    def regions(
        self, design: Any, key: str, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[Region, ...]:
        raise InputError(f"this mechanism has no regions {key!r}")

    def trajectories(self, design: Any) -> tuple[NamedTrajectory, ...]:
        return ()


_NO_SECTIONS = "this mechanism has no solid workspace to cut or to measure"
