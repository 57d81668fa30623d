"""A machine: one design bound to its mechanism, with everything that can be asked of it.

`Machine` is what people hold. What it can answer stands in its facets, one a topic; a facet that a
machine has not is None.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from numpy.typing import ArrayLike

from kinematics.answers.drawings import Drawing
from kinematics.answers.sections import MapSpec, RegionSpec, SectionSpec
from kinematics.answers.solutions import Finding, Posture
from kinematics.designs.files import change_table
from kinematics.errors import InputError
from kinematics.mechanism import (
    Coordinate,
    D,
    Design,
    DesignField,
    Mechanism,
    mechanism_class,
)
from kinematics.screws.spatial import Array

if TYPE_CHECKING:  # a facet is loaded when it is first asked for
    from kinematics.facets.circles import CirclesFacet
    from kinematics.facets.clearances import ClearancesFacet
    from kinematics.facets.continuation import FollowingFacet
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


class Machine(Generic[D]):
    """One design of one mechanism.

    Attributes:
        design: the design, frozen.
        mechanism: the primitives of its kind.
        inverse, forward, following, motion, statics, measures, singularities, clearances, paths:
            facets that every machine has.
        solids, sections, regions, maps, circles: facets that a machine may lack; None then.
    """

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
        self.mechanism: Mechanism[D] = mechanism_class(design.mechanism)(design)

    def __getattr__(self, name: str) -> Any:
        """Facets are made when they are first asked for."""
        if name not in FACETS:
            raise AttributeError(f"a machine has no {name!r}")
        made = self.mechanism.facets.get(name)
        facet = None if made is None else made(self.mechanism)
        setattr(self, name, facet)
        return facet

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
    def modes(self) -> tuple[str, ...]:
        """Its modes: one sign a limb, or operation modes by number."""
        return self.mechanism.modes

    @property
    def mode_noun(self) -> str:
        """ "working mode" or "operation mode"; "" where there is one mode only."""
        return self.mechanism.mode_noun

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The P coordinates of a pose: names, units, ranges."""
        return self.mechanism.pose_coordinates()

    @cached_property
    def joints(self) -> tuple[Coordinate, ...]:
        """The J actuated joints: names, units, ranges."""
        return self.mechanism.joint_coordinates()

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

    def text(self, topic: str) -> str:
        """Markdown about a topic of the mechanism, see `Mechanism.text`."""
        return self.mechanism.text(topic)

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

    # --- its design

    @property
    def table(self) -> dict[str, Any]:
        """What the design's file says, as plain values."""
        return self.mechanism.design_table()

    @property
    def fields(self) -> tuple[DesignField, ...]:
        """Every number of the design that may be edited."""
        return self.mechanism.design_fields()

    def edited(self, path: Sequence[str | int], value: float) -> Machine[D]:
        """The machine with one number changed and everything checked again.

        Args:
            path: a `DesignField.path`, as ``("limb", 2, "base", 0)``.

        Raises:
            InputError: the design has no such number.
            DesignError: the design would not be valid with it.
        """
        table = change_table(self.table, self.fields, path, value)
        return Machine(self.mechanism.read_design(table, origin="", name=self.design.name))

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


FACETS = frozenset(name for name in Machine.__annotations__)


@lru_cache(maxsize=64)
def machine_of(design: Design) -> Machine[Any]:
    """The machine of a design, kept while it is used."""
    return Machine(design)


F = TypeVar("F")


def required(facet: F | None, what: str) -> F:
    """A facet that a question cannot do without.

    Args:
        what: what the machine would need, as "sections".

    Raises:
        InputError: the machine has it not.
    """
    if facet is None:
        raise InputError(f"this mechanism has no {what}")
    return facet
