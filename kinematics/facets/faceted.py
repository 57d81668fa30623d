"""A design bound to its mechanism, with a facet for each topic: what a machine answers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic

from numpy.typing import ArrayLike

from kinematics.answers.drawings import Drawing
from kinematics.answers.modes import Mode
from kinematics.answers.sections import MapSpec, RegionSpec, SectionSpec
from kinematics.answers.solutions import Finding, Posture
from kinematics.arrays import Array
from kinematics.mechanism import Coordinate, D, Design, Mechanism, mechanism_of

if TYPE_CHECKING:  # a facet is loaded when it is first asked for
    from kinematics.facets.circles import CirclesFacet
    from kinematics.facets.clearances import ClearancesFacet
    from kinematics.facets.following import FollowingFacet
    from kinematics.facets.forward import ForwardFacet
    from kinematics.facets.inverse import InverseFacet
    from kinematics.facets.maps import MapsFacet
    from kinematics.facets.measures import MeasuresFacet
    from kinematics.facets.motion import MotionFacet
    from kinematics.facets.paths import PathsFacet
    from kinematics.facets.regions import RegionsFacet
    from kinematics.facets.sections import SectionsFacet
    from kinematics.facets.singularities import SingularitiesFacet
    from kinematics.facets.solids import SolidsFacet, SolidSpec
    from kinematics.facets.statics import StaticsFacet


class Faceted(Generic[D]):
    """One design of one mechanism and what can be asked of it, see `kinematics.machine.Machine`."""

    inverse: InverseFacet[D]
    forward: ForwardFacet[D]
    following: FollowingFacet[D]
    motion: MotionFacet[D]
    statics: StaticsFacet[D]
    measures: MeasuresFacet[D]
    singularities: SingularitiesFacet[D]
    clearances: ClearancesFacet[D]
    paths: PathsFacet[D]
    solids: SolidsFacet[D] | None
    sections: SectionsFacet[D] | None
    regions: RegionsFacet[D] | None
    maps: MapsFacet[D] | None
    circles: CirclesFacet[D] | None

    def __init__(self, design: D) -> None:
        self.design = design
        self.mechanism: Mechanism[D] = mechanism_of(design)

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"a machine has no {name!r}")

    def __dir__(self) -> list[str]:
        """Facets among them, also before they are made."""
        return sorted({*super().__dir__(), *TOPICS})

    # --- what it is

    @property
    def kind(self) -> str:
        """How design files name the mechanism, as "five_rpur"."""
        return self.mechanism.kind

    @property
    def title(self) -> str:
        """How people name the mechanism."""
        return self.mechanism.title

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Its modes: one sign a limb, operation modes by number, or both."""
        return self.mechanism.modes

    @property
    def mode_noun(self) -> str:
        """ "working mode", "operation mode", "mode" of both; "" where there is one mode only."""
        return self.mechanism.mode_noun

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The P coordinates of a pose: names, units, ranges."""
        return self.mechanism.coordinates

    @cached_property
    def joints(self) -> tuple[Coordinate, ...]:
        """The J actuated joints: names, units, ranges."""
        return self.mechanism.actuators

    @cached_property
    def dependent(self) -> tuple[int, ...]:
        """Those pose coordinates of which one follows from the others; empty as a rule."""
        return self.mechanism.dependent_coordinates()

    @property
    def length(self) -> float:
        """mm that an angle of 1 rad counts for where both are compared."""
        return self.mechanism.length

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What is worth knowing about the design; warnings among them."""
        return self.mechanism.findings()

    @cached_property
    def home(self) -> Posture:
        """A posture in the middle of what the machine can do."""
        return self.mechanism.home()

    @property
    def counterparts(self) -> tuple[Design, ...]:
        """Other machines with the same numbers, which it is worth comparing with."""
        return self.mechanism.counterparts()

    # --- what it can show

    @property
    def solid_specs(self) -> tuple[SolidSpec, ...]:
        """The solids that it can show; none where it has no such facet."""
        return () if self.solids is None else self.solids.specs

    @property
    def region_specs(self) -> tuple[RegionSpec, ...]:
        """The plane regions that it can show; none where it has no such facet."""
        return () if self.regions is None else self.regions.specs

    @property
    def section_spec(self) -> SectionSpec | None:
        """What its sections are called; None where it has no such facet."""
        return None if self.sections is None else self.sections.spec

    @property
    def map_spec(self) -> MapSpec | None:
        """What its maps show; None where it has no such facet."""
        return None if self.maps is None else self.maps.spec

    # --- poses

    def posture(self, pose: Sequence[float], mode: str) -> Posture:
        """The whole configuration at one pose in one mode, reachable or not, with its reasons."""
        return self.inverse.posture(pose, mode)

    def complete_pose(
        self,
        pose: Sequence[float],
        mode: str,
        moved: int | None = None,
        dependent: int | None = None,
    ) -> tuple[float, ...]:
        """The pose with its dependent coordinate made true, see `Mechanism.complete_pose`."""
        return self.mechanism.complete_pose(pose, mode, moved, dependent)

    def transform(self, poses: ArrayLike, mode: str | Sequence[str]) -> Array:
        """(..., 4, 4) from platform to base coordinates, mm; ``mode``: one, or one each."""
        return self.mechanism.transform(poses, mode)

    def pose_from_transform(self, transform: ArrayLike, mode: str) -> tuple[float, ...]:
        """The pose whose platform is nearest to where ``transform`` (4, 4) puts it."""
        return self.mechanism.pose_from_transform(transform, mode)

    def drawing(self, posture: Posture) -> Drawing:
        """Its bars, bodies and marks at a posture, mm, base frame."""
        return self.mechanism.drawing(posture)


class _Topic:
    """A facet, made when a machine is first asked for it; of the class what such a facet is."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __get__(self, machine: Faceted[Any] | None, owner: type[Faceted[Any]]) -> Any:
        if machine is None:
            module = import_module(f"kinematics.facets.{self.name}")
            return vars(module)[f"{self.name.capitalize()}Facet"]
        facet = machine.mechanism.facet(self.name)
        vars(machine)[self.name] = facet
        return facet


TOPICS = frozenset(Faceted.__annotations__)
"""The facets that a machine may have."""
for _name in TOPICS:
    setattr(Faceted, _name, _Topic(_name))
