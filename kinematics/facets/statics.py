"""The wrenches that hold the platform, and the forces that a load asks for."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Statics, Wrenches, WrenchSystem
from kinematics.facets.facet import Facet
from kinematics.mechanism import D
from kinematics.screws.wrenches import determinant, equilibrium


class StaticsFacet(Facet[D]):
    """Wrenches and equilibrium of a batch of postures in one mode."""

    topic = "statics"

    def wrenches(self, poses: ArrayLike, mode: str) -> WrenchSystem:
        """The wrenches that actuators and constraints can exert at poses (..., P).

        NaN for limbs that cannot close or have no direction.
        """
        names = self.mechanism.wrench_names
        rows, gain, point = self.at(poses, mode)
        value = determinant(rows, self.mechanism.length)
        return WrenchSystem(
            names, rows[..., : len(names), :].copy(), point[..., : len(names), :], value, gain
        )

    def forces(self, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
        """What holds loads (..., 6) [F, T about O′] at poses (..., P): N and N·mm, base frame.

        Raises:
            InputError: not finite numbers, or not six in a load.
        """
        names = self.mechanism.wrench_names
        rows, gain, _ = self.at(poses, mode)
        more = np.ones((*gain.shape[:-1], len(names) - gain.shape[-1]))
        gain = np.concatenate([gain, more], axis=-1)
        return equilibrium(names, rows, loads, self.mechanism.length, gain)

    def at(self, poses: ArrayLike, mode: str) -> Wrenches:
        """All six wrenches at poses (..., P), those too that have no name.

        Raises:
            InputError: not finite numbers, or not P of them.
        """
        mechanism = self.mechanism
        return mechanism.wrenches(mechanism.placement(poses, mode), mode)
