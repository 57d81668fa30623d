"""What a kind of parallel mechanism supplies, and how kinds are found.

A kind is a package of `kinematics.mechanisms` whose ``KINDS`` names its class; nothing else is to
be edited for a new one. Its class, bound to one design, supplies the primitives below; the facets
of `kinematics.facets` do the rest, and a kind names its own facet where it has something exact.
People hold a `kinematics.machine.Machine`, which is a mechanism with its facets. (Longer than 400
lines for the contract of each primitive, so that all of them stand together.)
"""

from __future__ import annotations

import pkgutil
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from importlib import import_module
from typing import Any, ClassVar, Generic, Literal, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.bounds import Bound
from kinematics.answers.coordinates import Coordinate as Coordinate
from kinematics.answers.drawings import Drawing
from kinematics.answers.modes import Mode, noun, one_of
from kinematics.answers.motion import Wrenches, WrenchName
from kinematics.answers.solutions import Finding, Posture
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.screws.spatial import cross_matrix

TINY = 1e-30
"""The imaginary time of derivatives: nothing beside the numbers, and far from underflow."""


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
    """One number of a design that a person may edit: where it stands and what it is.

    ``also``: further places that say the same number, and change with it.
    """

    path: tuple[str | int, ...]
    label: str
    value: float
    unit: Literal["mm", "rad", ""]
    group: str
    also: tuple[tuple[str | int, ...], ...] = ()


_GENERIC = {
    "inverse": "kinematics.facets.inverse:InverseFacet",
    "motion": "kinematics.facets.motion:MotionFacet",
    "statics": "kinematics.facets.statics:StaticsFacet",
    "singularities": "kinematics.facets.singularities:SingularitiesFacet",
    "measures": "kinematics.facets.measures:MeasuresFacet",
    "clearances": "kinematics.facets.clearances:ClearancesFacet",
    "paths": "kinematics.facets.paths:PathsFacet",
}


class Facets(Mapping[str, type[Any]]):
    """A kind's facets by name, each loaded when it is first asked for: a command starts quickly.

    A facet that is not named is the generic one, if there is one.

    Args:
        package: that of the kind.
        places: module and class of each, as ``inverse="inverse:TripodInverse"``.
    """

    def __init__(self, package: str, **places: str) -> None:
        own = {name: f"{package}.{place}" for name, place in places.items()}
        self._places = {**_GENERIC, **own}

    def __getitem__(self, name: str) -> type[Any]:
        module, _, facet = self._places[name].partition(":")
        found: type[Any] = getattr(import_module(module), facet)
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)


D = TypeVar("D", bound=Design)


class DesignSchema(Protocol[D]):
    """What the design files of a kind say, see `kinematics.designs.schema.Schema`."""

    def read(self, table: Mapping[str, Any], *, origin: str, name: str) -> D: ...
    def table(self, design: D) -> dict[str, Any]: ...
    def fields(self, design: D) -> tuple[DesignField, ...]: ...
    def changed(self, design: D, path: Sequence[str | int], value: float) -> D: ...
    def json_schema(self, kind: str) -> dict[str, Any]: ...


class Mechanism(ABC, Generic[D]):
    """One kind of parallel mechanism, bound to one design: the primitives that it supplies.

    Attributes:
        kind: how design files name it, as "five_rpur".
        title: how people name it.
        schema: how its designs are read, checked, written and edited.
        modes: its modes, see `kinematics.answers.modes`; one that is empty where there is no other.
        mode_noun: what they are: "working mode", "operation mode", "mode" of both kinds; "" where
            there is one mode only.
        snap: mm or rad within which joints that a pose gives back are those it was solved for.
        wrench_names: of the wrenches that its limbs exert, actuators first; the first rows of
            `wrenches`. Those after them are the same in every posture.
        facets: the kind's own facets by name (`kinematics.machine.Machine`); a facet that is not
            named is the generic one, or None where there is no generic one.
    """

    kind: ClassVar[str]
    title: ClassVar[str]
    schema: ClassVar[DesignSchema[Any]]
    modes: tuple[Mode, ...]
    mode_noun: str
    snap: ClassVar[float] = 1e-9
    wrench_names: tuple[WrenchName, ...]
    facets: ClassVar[Mapping[str, type[Any]]]

    def __init_subclass__(cls) -> None:
        if "modes" in vars(cls):
            cls.mode_noun = noun(cls.modes)

    def __init__(self, design: D) -> None:
        self.design = design
        self._made: dict[str, Any] = {}

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """`pose_coordinates`, kept."""
        return self.pose_coordinates()

    @cached_property
    def actuators(self) -> tuple[Coordinate, ...]:
        """`joint_coordinates`, kept."""
        return self.joint_coordinates()

    def mode(self, text: str) -> Mode:
        """The mode that is written so.

        Raises:
            InputError: the mechanism has no such mode; the message says how one is written.
        """
        return one_of(text, self.modes)

    def facet(self, topic: str) -> Any:
        """The facet of a topic, made when it is first asked for; None where the kind lacks it."""
        if topic not in self._made:
            made = self.facets.get(topic)
            self._made[topic] = None if made is None else made(self)
        return self._made[topic]

    # --- designs

    @classmethod
    def read_design(cls, table: Mapping[str, Any], *, origin: str, name: str) -> D:
        """The design that a parsed design file describes.

        Raises:
            DesignError: naming the origin, the key and the remedy.
        """
        found: D = cls.schema.read(table, origin=origin, name=name)
        return found

    def design_table(self) -> dict[str, Any]:
        """What the design's file says, as plain values; `read_design` reads it back equal."""
        return self.schema.table(self.design)

    def design_fields(self) -> tuple[DesignField, ...]:
        """Every number of the design that may be edited; paths lead into `design_table`."""
        return self.schema.fields(self.design)

    def edited(self, path: Sequence[str | int], value: float) -> D:
        """The design with one number, a path of `design_fields`, changed and checked again.

        Raises:
            InputError: the design has no such number.
            DesignError: the design would not be valid with it.
        """
        found: D = self.schema.changed(self.design, path, value)
        return found

    def findings(self) -> tuple[Finding, ...]:
        """What is worth knowing about the design before it moves; warnings among them."""
        return ()

    def counterparts(self) -> tuple[Design, ...]:
        """Other machines with the same numbers, which it is worth comparing with."""
        return ()

    # --- coordinates

    @abstractmethod
    def pose_coordinates(self) -> tuple[Coordinate, ...]:
        """The P coordinates of a pose, mm and rad, with the ranges that can be reached."""

    @abstractmethod
    def joint_coordinates(self) -> tuple[Coordinate, ...]:
        """The J actuated joints with their ranges, mm or rad."""

    def dependent_coordinates(self) -> tuple[int, ...]:
        """Those pose coordinates of which one, whichever is chosen, follows from the others."""
        return ()

    def complete_pose(
        self,
        pose: Sequence[float],
        mode: str,
        moved: int | None = None,
        dependent: int | None = None,
    ) -> tuple[float, ...]:
        """The pose with its dependent coordinate made true, where a mechanism has such.

        Args:
            pose: (P,) mm and rad; one coordinate may be NaN: that one is solved for. Else
                ``dependent`` gives way or, where that is the one that was ``moved`` by hand or
                None, another one.

        Raises:
            InputError: there is no such pose, or the mechanism has no dependent coordinate.
        """
        if any(value != value for value in pose):
            raise InputError("every coordinate of the pose must be given")
        return tuple(pose)

    @abstractmethod
    def transform(self, poses: ArrayLike, mode: str | Sequence[str]) -> Array:
        """(..., 4, 4) from platform to base coordinates, mm; ``mode``: one, or one each."""

    @abstractmethod
    def pose_from_transform(self, transform: ArrayLike, mode: str) -> tuple[float, ...]:
        """The pose whose platform is nearest to where ``transform`` (4, 4) puts it."""

    @property
    @abstractmethod
    def length(self) -> float:
        """mm that an angle of 1 rad counts for where both are compared."""

    # --- where the joints are, and what bounds them

    @property
    @abstractmethod
    def bounds(self) -> tuple[Bound, ...]:
        """The K bounds of the machine, in the order of `margins`, limb by limb."""

    @abstractmethod
    def joints(self, poses: Array, mode: str) -> Array:
        """The actuated joints (..., J), mm or rad, at poses (..., P) in one mode.

        Also beyond their ranges; NaN where the limb cannot close.
        """

    def joints_in(self, poses: Array, modes: Sequence[str]) -> Array:
        """The joints (..., M, J) in each of several modes, for a kind that has them at once."""
        return np.stack([self.joints(poses, mode) for mode in modes], axis=-2)

    @abstractmethod
    def margins(self, poses: Array, mode: str, joints: Array) -> Array:
        """(..., K) how far poses (..., P) with their joints (..., J) are from each of `bounds`.

        Signed, in the bound's unit: positive inside, negative beyond. That of a "link" is negative
        exactly where the limb cannot close (but for rounding). NaN where a bound says nothing: the
        range of a joint without a value, or of one that has none; infinite likewise.
        """

    @abstractmethod
    def residual(self, poses: Array, mode: str, joints: Array) -> Array:
        """(...) mm, the largest error with which the limbs that close do so; NaN where none does.

        Of the loops as the machine is drawn: lengths of bars, directions of axes.
        """

    def why_not(self, bound: Bound, pose: Array, mode: str, amount: float) -> str:
        """Why a pose (P,) is ``amount`` beyond a bound, in words; "": as of every joint's range."""
        return ""

    # --- motion and forces

    def placement(self, poses: ArrayLike, mode: str) -> Array:
        """`transform` (..., 4, 4) where the machine can be assembled; NaN elsewhere."""
        return self.transform(poses, mode)

    @abstractmethod
    def velocity_axes(self, poses: Array, mode: str) -> Array:
        """(..., 6, P): the velocity [v of O′, ω] for a unit rate of each coordinate of the pose.

        Analytic in the poses: complex ones are handed in for the derivative along a motion.
        """

    @abstractmethod
    def wrenches(self, placement: Array, mode: str) -> Wrenches:
        """What actuators and constraints exert on the platform placed at (..., 4, 4).

        NaN for limbs that cannot close. Analytic in the placement: complex ones are handed in for
        the derivative along a motion, and where there is none the answer to those is NaN.

        Args:
            mode: one, or whatever else the mechanism takes for a batch of them.
        """

    @property
    def largest_gain(self) -> Array | float:
        """(J,) the most that the gains of `wrenches` can be: 1, or a crank's length in mm."""
        return 1.0

    def bias(self, placement: Array, mode: str, velocity: Array, joint_rates: Array) -> Array:
        """(..., 6): β of row · [a, α] + β = gain · joint acceleration (0 for constraints).

        β = d(row)/dt · [v, ω] − d(gain)/dt · joint rate, here to rounding by the imaginary part of
        `wrenches` at a placement moved by an imaginary time.

        Args:
            velocity: (..., 6) [v, ω] of the platform.
            joint_rates: (..., J).
        """
        rate = np.zeros((*np.broadcast_shapes(velocity.shape[:-1], placement.shape[:-2]), 4, 4))
        rate[..., :3, :3] = cross_matrix(velocity[..., 3:]) @ placement[..., :3, :3]
        rate[..., :3, 3] = velocity[..., :3]
        moved: NDArray[Any] = placement + 1j * TINY * rate
        with np.errstate(divide="ignore", invalid="ignore"):  # complex NaN warn
            rows, gain, _ = self.wrenches(moved, mode)
            answer: Array = (rows.imag / TINY @ velocity[..., None])[..., 0]
        answer[..., : gain.shape[-1]] -= gain.imag / TINY * joint_rates
        return answer

    # --- the machine as people see it

    @abstractmethod
    def home(self) -> Posture:
        """A posture in the middle of what the machine can do, away from singularities."""

    @abstractmethod
    def drawing(self, posture: Posture) -> Drawing:
        """Its bars, bodies and marks at a posture, mm, base frame."""

    # --- for processes

    @classmethod
    def prepare(cls) -> None:
        """Make ready what takes long the first time on a machine."""
        return


# --- discovery -----------------------------------------------------------------------------

MAIN = "five_rpur"
"""The kind that is named first where all are listed."""


@cache
def _places() -> dict[str, tuple[str, str]]:
    """Module and class of every kind; only the packages' own `__init__` are loaded for it."""
    rooms = import_module("kinematics.mechanisms")  # by name: nothing above is imported here
    found: dict[str, tuple[str, str]] = {}
    packages = pkgutil.iter_modules(rooms.__path__, f"{rooms.__name__}.")
    for room in sorted(packages, key=lambda room: not room.name.endswith(MAIN)):
        for kind, name in import_module(room.name).KINDS.items():
            found[kind] = (f"{room.name}.mechanism", name)
    return found


def mechanism_kinds() -> tuple[str, ...]:
    """The kinds of mechanism that a design file may name."""
    return tuple(_places())


@cache
def mechanism_class(kind: str) -> type[Mechanism[Any]]:
    """The class of a kind.

    Raises:
        InputError: there is no such kind.
    """
    place = _places().get(kind)
    if place is None:
        raise InputError(
            f"there is no mechanism {kind!r}; known are {', '.join(mechanism_kinds())}"
        )
    module, name = place
    found: type[Mechanism[Any]] = getattr(import_module(module), name)
    return found


@lru_cache(maxsize=64)
def mechanism_of(design: Design) -> Mechanism[Any]:
    """The mechanism of a design, kept with its facets while it is used."""
    return mechanism_class(design.mechanism)(design)
