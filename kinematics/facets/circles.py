"""Circles of orientations without a singularity, and their radii over the altitude."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from kinematics.answers.circles import MicrTable, OrientationCircle, Profile
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.mechanism import D, mechanism_class


class CirclesFacet(Facet[D]):
    """The largest circles of orientations, and the maximum inscribed one (MICR)."""

    topic = "circles"

    @abstractmethod
    def about(self, pose: Sequence[float], mode: str) -> tuple[OrientationCircle, ...]:
        """About the pose's orientation, at its altitude: one circle for each limit."""

    @abstractmethod
    def profile(self, pose: Sequence[float], ratios: Sequence[float] = ()) -> Profile:
        """Such circles about the level platform against the altitude, also of other ratios."""

    @abstractmethod
    def profile_place(self, pose: Sequence[float]) -> float:
        """Where on the axis of its profile the machine stands."""

    @staticmethod
    @abstractmethod
    def micr(kind: Any, base: ArrayLike, platform: ArrayLike, altitude: ArrayLike) -> MicrTable:
        """MICR of a kind over circumradii and altitudes (mm), which broadcast."""


def micr(kind: str, base: ArrayLike, platform: ArrayLike, altitude: ArrayLike) -> MicrTable:
    """The maximum inscribed circles of a kind over circumradii and altitudes (mm).

    Raises:
        InputError: there is no such kind, or it has no such circle.
    """
    facet = mechanism_class(kind).facets.get("circles")
    if facet is None:
        raise InputError("this mechanism has no maximum inscribed circle (MICR)")
    table: MicrTable = facet.micr(kind, base, platform, altitude)
    return table
