"""The wrenches that hold the platform, and the forces that a load asks for."""

from __future__ import annotations

from abc import abstractmethod

from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics, WrenchSystem
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class StaticsFacet(Facet[D]):
    """Wrenches and equilibrium of a batch of postures in one mode."""

    topic = "statics"

    @abstractmethod
    def wrenches(self, poses: ArrayLike, mode: str) -> WrenchSystem:
        """The wrenches that actuators and constraints can exert at poses (..., P)."""

    @abstractmethod
    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
        """What holds loads (..., 6) [F, T about O′] at poses (..., P): N and N·mm, base frame.

        Raises:
            InputError: not finite numbers, or not six in a load.
        """
