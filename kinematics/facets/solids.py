"""Solids that a mechanism can show: workspaces, aspects, vertex spaces and their parts."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.mechanism import D, mechanism_class

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid

Resolution = Literal["preview", "normal", "fine"]
RESOLUTIONS: tuple[Resolution, ...] = ("preview", "normal", "fine")
SurfaceKind = Literal["facets", "true"]
SURFACES: tuple[SurfaceKind, ...] = ("facets", "true")
"""Of a solid's mesh: right on the average, or with every vertex on the exact surfaces."""


@dataclass(frozen=True, slots=True)
class SolidSpec:
    """A solid that a mechanism can show: "workspace", "aspects", "limb1/whole", "limb1/H2", …

    It may depend on the chosen set of modes (``uses_modes``), or on the present mode alone
    (``of_present_mode``), which is then all that `SolidsFacet.request` is handed. ``follows``: the
    pose coordinate that is not held but follows from the others (`dependent_coordinates`).
    ``places``: its points are places of O′, and not those of a chart.
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
    places: bool = True


@dataclass(frozen=True, slots=True)
class SolidRequest:
    """Everything a solid depends on and nothing else, so equal requests are equal solids.

    ``arguments`` is hashable, picklable and understood by the mechanism alone.
    """

    mechanism: str
    arguments: tuple[Any, ...]
    resolution: Resolution


class SolidsFacet(Facet[D]):
    """Solids, asked for by a request that other processes can build."""

    topic = "solids"

    @property
    @abstractmethod
    def specs(self) -> tuple[SolidSpec, ...]:
        """What there is."""

    @abstractmethod
    def arguments(
        self,
        spec: SolidSpec,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        surface: SurfaceKind,
    ) -> tuple[Any, ...]:
        """What a solid depends on, see `SolidRequest`; one mode where it is of one only."""

    def request(
        self,
        key: str,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        resolution: Resolution,
        surface: SurfaceKind = "facets",
    ) -> SolidRequest:
        """The solid ``key`` at a pose's orientation for a set of modes; None: of all together.

        Raises:
            InputError: there is no such solid, or it is of one mode only and another set is given.
        """
        spec = self.spec(key)
        if spec.of_present_mode and (modes is None or len(modes) != 1):
            noun = self.mechanism.mode_noun
            raise InputError(f"{key} can be shown of one {noun} at a time only; choose one")
        arguments = self.arguments(spec, pose, modes, surface)
        return SolidRequest(self.mechanism.kind, arguments, resolution)

    def spec(self, key: str) -> SolidSpec:
        """One of `specs`.

        Raises:
            InputError: there is no such solid.
        """
        found = next((spec for spec in self.specs if spec.key == key), None)
        if found is None:
            raise InputError(f"there is no solid {key!r}; {self.known}")
        return found

    @property
    def known(self) -> str:
        """Which solids there are, as the end of a sentence."""
        return f"known are {', '.join(spec.key for spec in self.specs)}"

    def placement(self, key: str, pose: Sequence[float]) -> Array:
        """(4, 4) from the frame in which the solid is built to the base frame, mm."""
        return np.eye(4)

    def branch(self, key: str, pose: Sequence[float]) -> tuple[float, ...] | None:
        """A pose in the solid that tells it from others which one might mean; None: there are none.

        Where a coordinate follows from the others in more than one way, a solid is of one way.
        """
        return None

    build: ClassVar[Any]
    """build(request) → BuiltSolid: static, as it needs nothing but the request."""

    def point(self, key: str, pose: ArrayLike, mode: str) -> Array:
        """Where poses (..., P) are in a solid as placed, (..., 3) mm: the place of O′, unless
        overridden.
        """
        return np.asarray(self.mechanism.transform(pose, mode)[..., :3, 3])

    def poses(self, key: str, pose: Sequence[float], mode: str, points: ArrayLike) -> Array:
        """The poses (N, P) that points (N, 3) mm of a solid as placed stand for, all else held.

        NaN where there is none.
        """
        places = np.asarray(points, dtype=float)
        poses = np.tile(np.asarray(pose, dtype=float), (len(places), 1))
        for n, c in enumerate(self.mechanism.coordinates):
            if c.key in ("x", "y", "z"):
                poses[:, n] = places[:, "xyz".index(c.key)]
        return poses


def build_solid(request: SolidRequest) -> BuiltSolid:
    """The solid of a request; a fraction of a second to some seconds."""
    built: BuiltSolid = mechanism_class(request.mechanism).facets["solids"].build(request)
    return built
