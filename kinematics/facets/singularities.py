"""Where control of the platform is lost: at a posture, and as curves over two coordinates."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.singularities import AT, ModeChange, Singularity
from kinematics.answers.solutions import Posture
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class SingularitiesFacet(Facet[D]):
    """Singularities with their causes, and their loci."""

    topic = "singularities"
    loci: tuple[LocusSpec, ...] = ()

    @abstractmethod
    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        """The singularities that a posture is in, to a tolerance of the singular values."""

    def locus(
        self, key: str, pose: Sequence[float], mode: str, at: float | None = None
    ) -> LocusCurves:
        """The curves of one of `loci` about a pose.

        Raises:
            InputError: there is no such chart.
        """
        raise InputError(f"this mechanism has no loci {key!r}")

    def mode_change(self, posture: Posture, wanted: str = "") -> ModeChange | None:
        """Where the mode may be changed without taking the machine apart; None where nowhere.

        Args:
            wanted: the mode to change to; "": any other.
        """
        return None
