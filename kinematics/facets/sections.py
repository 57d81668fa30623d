"""Exact sections of the workspace at a pose's orientation, its volume, and what fits inside."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from kinematics.answers.sections import Box, Section, SectionSpec, Sphere, Volume
from kinematics.arrays import Array
from kinematics.facets.facet import Facet
from kinematics.mechanism import D

Modes = tuple[str, ...] | None
"""A set of modes; None: all together."""


class SectionsFacet(Facet[D]):
    """Plane sections in closed form and what is integrated over them."""

    topic = "sections"
    spec: SectionSpec

    @abstractmethod
    def frame(self, pose: Sequence[float]) -> Array:
        """(4, 4) from the sections' coordinates (normal first) to the base frame."""

    @abstractmethod
    def range(self, pose: Sequence[float], modes: Modes) -> tuple[float, float] | None:
        """Where along the normal the workspace can be, mm; None where it is empty."""

    @abstractmethod
    def at(self, pose: Sequence[float], modes: Modes, at: float) -> Section:
        """The section by the plane at ``at`` mm along the normal."""

    @abstractmethod
    def volume(
        self,
        pose: Sequence[float],
        modes: Modes,
        *,
        relative: float = 1e-6,
        pieces: bool = True,
    ) -> Volume:
        """The volume to a fraction of itself; without its pieces in a fifth of the time."""

    @abstractmethod
    def common(
        self,
        pose: Sequence[float],
        modes: Modes,
        others: Sequence[tuple[SectionsFacet[D], Modes]],
        *,
        relative: float = 1e-6,
        pieces: bool = True,
    ) -> Volume:
        """Of what this workspace and those of other designs have in common, as `volume`.

        At one orientation, with the base frames on one another.
        """

    @abstractmethod
    def ball(
        self, pose: Sequence[float], modes: Modes, center: Sequence[float] | None = None
    ) -> Sphere | None:
        """The largest ball inside, about ``center`` (3,) mm or wherever; None where none fits."""

    @abstractmethod
    def box(
        self, pose: Sequence[float], modes: Modes, center: Sequence[float] | None = None
    ) -> Box | None:
        """The largest box inside with edges along x, y, z; None where none fits."""

    @abstractmethod
    def singularity_free_ball(
        self, pose: Sequence[float], mode: str, center: Sequence[float] | None = None
    ) -> Sphere | None:
        """The largest ball inside without a parallel singularity in it."""
