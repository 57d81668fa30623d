"""What every mechanism offers, and the registry of mechanisms.

Whoever serves a user (pages, commands) sees mechanisms only through this protocol: adding one
takes a folder, a line in `_MODULES` and its design files.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, Protocol

from numpy.typing import ArrayLike

from kinematics.answers.drawings import Drawing
from kinematics.answers.motion import Motion, Statics, WrenchSystem
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
    AT,
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
    Singularity,
)
from kinematics.answers.solutions import (
    Finding,
    Fold,
    Followed,
    ForwardSolutions,
    InverseSolutions,
    Posture,
    Refreshed,
)
from kinematics.errors import InputError
from kinematics.screws.spatial import Array

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid
    from kinematics.trajectories import NamedTrajectory

Resolution = Literal["preview", "normal", "fine"]
RESOLUTIONS: tuple[Resolution, ...] = ("preview", "normal", "fine")
SurfaceKind = Literal["facets", "true"]
SURFACES: tuple[SurfaceKind, ...] = ("facets", "true")
"""Of a solid's mesh: right on the average, or with every vertex on the exact surfaces."""


@dataclass(frozen=True, slots=True)
class Coordinate:
    """One pose or joint coordinate: how it is called, its unit and the range worth offering."""

    key: str
    symbol: str
    unit: Literal["mm", "rad"]
    lower: float
    upper: float
    limb: int | None = None


class Design(Protocol):
    """A design: frozen and hashable, built of floats and tuples."""

    @property
    def mechanism(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def source(self) -> str: ...
    def __hash__(self) -> int: ...


@dataclass(frozen=True, slots=True)
class DesignField:
    """One number of a design that a person may edit: where it stands and what it is."""

    path: tuple[str | int, ...]
    label: str
    value: float
    unit: Literal["mm", "rad", ""]
    group: str


@dataclass(frozen=True, slots=True)
class SolidSpec:
    """A solid that a mechanism can show: "workspace", "aspects", "limb1/whole", "limb1/H2", …

    It may depend on the chosen set of modes (``uses_modes``), or on the present mode alone
    (``of_present_mode``), which is then all that `solid_request` is handed. ``follows``: the pose
    coordinate that is not held but follows from the others (`dependent_coordinates`).
    """

    key: str
    title: str
    group: str
    limb: int | None = None
    figure: str = ""
    uses_modes: bool = False
    of_present_mode: bool = False
    surfaces: tuple[SurfaceKind, ...] = ("facets",)
    follows: int | None = None


@dataclass(frozen=True, slots=True)
class SolidRequest:
    """Everything a solid depends on and nothing else, so equal requests are equal solids.

    ``arguments`` is hashable, picklable and understood by the mechanism alone.
    """

    mechanism: str
    arguments: tuple[Any, ...]
    resolution: Resolution


class Mechanism(Protocol):
    """One kind of parallel mechanism. Stateless; ``design`` is of the kind's own design class."""

    @property
    def kind(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def modes(self) -> tuple[str, ...]: ...
    @property
    def mode_noun(self) -> str: ...  # "working mode", "operation mode"; "" where there is one only
    def about(self, topic: str) -> str: ...  # what a page says of the "move", "solutions", … of it

    # designs
    def read_design(self, table: Mapping[str, Any], *, origin: str, name: str) -> Design: ...
    def design_table(self, design: Any) -> dict[str, Any]: ...
    def design_fields(self, design: Any) -> tuple[DesignField, ...]: ...
    def with_field(self, design: Any, path: tuple[str | int, ...], value: float) -> Design: ...
    def findings(self, design: Any) -> tuple[Finding, ...]: ...

    # coordinates
    def pose_coordinates(self, design: Any) -> tuple[Coordinate, ...]: ...
    def joint_coordinates(self, design: Any) -> tuple[Coordinate, ...]: ...
    def dependent_coordinates(self, design: Any) -> tuple[int, ...]: ...
    def complete_pose(
        self,
        design: Any,
        pose: Sequence[float],
        mode: str,
        moved: int | None = None,
        dependent: int | None = None,
    ) -> tuple[float, ...]: ...

    # kinematics
    def home(self, design: Any) -> Posture: ...
    def posture(self, design: Any, pose: Sequence[float], mode: str) -> Posture: ...
    def inverse(self, design: Any, poses: ArrayLike) -> InverseSolutions: ...
    def follow(self, design: Any, posture: Posture, joints: Sequence[float]) -> Followed: ...
    def fold_ahead(self, design: Any, posture: Posture, joints: Sequence[float]) -> Fold | None: ...
    def forward(
        self, design: Any, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]: ...
    def refresh(
        self, design: Any, before: ForwardSolutions, joints: Sequence[float]
    ) -> Refreshed: ...
    def forward_is_quick(self, design: Any, *, mixed_modes: bool = False) -> bool: ...
    # where the platform stands may depend on the mode: one for all poses, or one for each
    def transform(self, design: Any, poses: ArrayLike, mode: str | Sequence[str]) -> Array: ...
    def pose_from_transform(
        self, design: Any, transform: ArrayLike, mode: str
    ) -> tuple[float, ...]: ...
    def drawing(self, design: Any, posture: Posture) -> Drawing: ...

    # motion and statics; one mode for all poses
    def characteristic_length(self, design: Any) -> float: ...
    def inverse_motion(
        self,
        design: Any,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion: ...
    def forward_motion(
        self,
        design: Any,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion: ...
    def wrench_system(self, design: Any, poses: ArrayLike, mode: str) -> WrenchSystem: ...
    def statics(self, design: Any, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics: ...

    # how well a posture is held, and where it is not
    def measures(self, design: Any) -> tuple[Measure, ...]: ...
    def measure(
        self,
        design: Any,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array: ...
    def singularities(
        self, design: Any, posture: Posture, tolerance: float = AT
    ) -> tuple[Singularity, ...]: ...
    def clearances(
        self, design: Any, posture: Posture, *, singular: bool = True
    ) -> tuple[Clearance, ...]: ...  # not singular: without what takes longer to find
    def remedy(self, design: Any, posture: Posture) -> Remedy: ...
    def passed(self, design: Any, before: Posture, after: Posture) -> tuple[Event, ...]: ...
    def path(
        self, design: Any, posture: Posture, poses: ArrayLike
    ) -> Followed: ...  # as driven, up to what would stop the machine
    def mode_change(
        self, design: Any, posture: Posture, wanted: str = ""
    ) -> ModeChange | None: ...  # to where this mode begins, or any other
    def locus_specs(self, design: Any) -> tuple[LocusSpec, ...]: ...
    def locus(
        self, design: Any, key: str, pose: Sequence[float], mode: str, at: float | None = None
    ) -> LocusCurves: ...

    # a workspace that lies in a plane: its regions; the frame is from (u, v, normal) to the base's
    def region_specs(self, design: Any) -> tuple[RegionSpec, ...]: ...
    def region_frame(self, design: Any, pose: Sequence[float]) -> Array: ...
    def regions(
        self, design: Any, key: str, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[Region, ...]: ...

    # ways that a mechanism's paper or trade runs, by name
    def trajectories(self, design: Any) -> tuple[NamedTrajectory, ...]: ...

    # circles of orientations without a singularity, and machines to compare with
    def circles(
        self, design: Any, pose: Sequence[float], mode: str
    ) -> tuple[OrientationCircle, ...]: ...
    @property
    def has_profile(self) -> bool: ...
    def profile(
        self, design: Any, pose: Sequence[float], ratios: Sequence[float] = ()
    ) -> Profile: ...
    def profile_place(self, design: Any, pose: Sequence[float]) -> float: ...
    def micr(self, base: ArrayLike, platform: ArrayLike, altitude: ArrayLike) -> MicrTable: ...
    def counterparts(self, design: Any) -> tuple[Design, ...]: ...

    # solids
    def solids(self, design: Any) -> tuple[SolidSpec, ...]: ...
    def solid_request(
        self,
        design: Any,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest: ...
    def solid_placement(self, design: Any, key: str, pose: Sequence[float]) -> Array: ...
    def build_solid(self, request: SolidRequest) -> BuiltSolid: ...
    def solid_point(self, design: Any, key: str, pose: Sequence[float], mode: str) -> Array: ...
    def solid_poses(
        self, design: Any, key: str, pose: Sequence[float], mode: str, points: ArrayLike
    ) -> Array: ...
    def inside(self, design: Any, pose: Sequence[float], modes: tuple[str, ...] | None) -> bool: ...

    # what takes long the first time on a machine is made ready; for processes nobody waits for
    def prepare(self) -> None: ...

    # exact sections and volumes of the workspace at the pose's orientation; a mechanism that has
    # none says so by a spec of None
    def section_spec(self, design: Any) -> SectionSpec | None: ...
    def section_frame(self, design: Any, pose: Sequence[float]) -> Array: ...
    def section_range(
        self, design: Any, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[float, float] | None: ...
    def section(
        self, design: Any, pose: Sequence[float], modes: tuple[str, ...] | None, at: float
    ) -> Section: ...
    def volume(
        self,
        design: Any,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        *,
        relative: float = 1e-6,
    ) -> Volume: ...
    def sphere(
        self,
        design: Any,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Sphere | None: ...
    def box(
        self,
        design: Any,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        center: Sequence[float] | None = None,
    ) -> Box | None: ...
    def singularity_free_ball(
        self, design: Any, pose: Sequence[float], mode: str, center: Sequence[float] | None = None
    ) -> Sphere | None: ...
    def map_spec(self, design: Any) -> MapSpec | None: ...
    def map_cells(
        self,
        design: Any,
        poses: ArrayLike,
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        *,
        relative: float = 1e-4,
    ) -> MapCells: ...


# Where each kind's mechanism stands; one package may offer several.
_MODULES = {
    "five_rpur": ("kinematics.mechanisms.five_rpur", "MECHANISM"),
    "five_bar": ("kinematics.mechanisms.five_bar", "MECHANISM"),
    "four_sps_spr": ("kinematics.mechanisms.four_sps_spr", "MECHANISM"),
    "three_rps": ("kinematics.mechanisms.tripods", "THREE_RPS"),
    "three_spr": ("kinematics.mechanisms.tripods", "THREE_SPR"),
}


def mechanism_kinds() -> tuple[str, ...]:
    """The kinds of mechanism that a design file may name."""
    return tuple(_MODULES)


@cache
def mechanism(kind: str) -> Mechanism:
    """The mechanism of a kind.

    Raises:
        InputError: there is no such kind.
    """
    place = _MODULES.get(kind)
    if place is None:
        raise InputError(
            f"there is no mechanism {kind!r}; known are {', '.join(mechanism_kinds())}"
        )
    module, name = place
    found: Mechanism = getattr(import_module(module), name)
    return found
