"""How well a posture is held, as one number: conditioning, manipulability, …

All of them are of the six wrenches and their gains, moments by the characteristic length, so that
they depend on neither the base frame nor a unit. A mechanism says which of them it has.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Wrenches, WrenchKind
from kinematics.answers.singularities import Measure
from kinematics.arrays import Array, frozen
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.facets.statics import StaticsFacet
from kinematics.mechanism import D
from kinematics.screws.wrenches import condition, normalised, scale, singular_values, unit_motions

CONDITIONING = Measure("conditioning", "Conditioning", "", "high", (0.0, 1.0))
MANIPULABILITY = Measure("manipulability", "Manipulability", "", "high", (0.0, 1.0))
FORCE = Measure("force", "Largest actuator force", "N", "low", (0.0, None), needs_load=True)
TRANSMISSION = Measure("transmission", "Transmission index", "", "high", (0.0, 1.0))
_SINGULAR = 1e-14  # determinant of the wrenches below which there is no transmission


class MeasuresFacet(Facet[D]):
    """The measures that a mechanism has; `specs` names methods by their keys."""

    topic = "measures"

    specs: tuple[Measure, ...] = (CONDITIONING, MANIPULABILITY, FORCE)

    def __call__(
        self,
        poses: ArrayLike,
        mode: str,
        key: str,
        load: Sequence[float] | None = None,
    ) -> Array:
        """The measure ``key`` at poses (..., P) in one mode, (...); NaN where they do not close.

        Args:
            load: [F, T] N and N·mm at O′, base frame, for measures that need one.

        Raises:
            InputError: there is no such measure, or it needs a load.
        """
        spec = next((each for each in self.specs if each.key == key), None)
        if spec is None:
            known = ", ".join(each.key for each in self.specs)
            raise InputError(f"there is no measure {key!r}; known are {known}")
        if not spec.needs_load:
            return frozen(getattr(self, key)(poses, mode))
        if load is None:
            raise InputError(
                f"the measure {key!r} needs a load, [Fx, Fy, Fz, Tx, Ty, Tz]; none is given"
            )
        return frozen(getattr(self, key)(poses, mode, load))

    def conditioning(self, poses: ArrayLike, mode: str) -> Array:
        """1/κ: 1 is isotropic, 0 at singularities of either type (Gosselin and Angeles 1991)."""
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / self.condition(poses, mode))

    def condition(self, poses: ArrayLike, mode: str, length: float | None = None) -> Array:
        """The condition number κ (...) of the map from joint rates to motions of the platform.

        Args:
            length: mm, > 0, by which angular velocities count; that of the mechanism by default.

        Returns:
            ≥ 1; infinite at singularities of either type, NaN where a limb cannot close.

        Raises:
            InputError: ``length`` is not a positive number.
        """
        size = self.mechanism.length if length is None else float(length)
        if not (np.isfinite(size) and size > 0):
            raise InputError("the characteristic length must be a positive number of mm")
        return frozen(condition(self._at(poses, mode), size))

    def manipulability(self, poses: ArrayLike, mode: str) -> Array:
        """sqrt(det G Gᵀ), G the six wrenches, each of unit size.

        Yoshikawa's measure (1985) of the wrenches as they are scaled for a quality index (Lee,
        Duffy and Hunt 1998): 1 where they are normal to each other, by Hadamard's inequality; 0 at
        parallel singularities. A limb in a serial singularity still transmits its force.
        """
        unit = normalised(self._at(poses, mode).rows, self.mechanism.length)
        closes = np.asarray(np.isfinite(unit).all(axis=(-1, -2)))
        value = np.abs(np.linalg.det(np.where(closes[..., None, None], unit, 0.0)))
        return np.where(closes, np.minimum(value, 1.0), np.nan)

    def singular_value(self, poses: ArrayLike, mode: str) -> Array:
        """The smallest singular value of the six wrenches, each of unit size."""
        values = singular_values(self._at(poses, mode).rows, self.mechanism.length)
        return np.asarray(values[..., -1])

    def transmission(self, poses: ArrayLike, mode: str) -> Array:
        """The least of all limbs' input and output transmission indices (Wang, Wu and Liu 2010).

        Input: the gain of the limb's force, divided by the largest that it can have. Output:
        |f·v| / |v|, v the velocity of the platform's point on the unit force f when all other
        actuators are locked: the virtual coefficient of wrench and output twist, divided by its
        maximum over all directions of the force at its point of application (Chen and Angeles
        2007). 0 at singularities of either type.
        """
        mechanism = self.mechanism
        rows, gain, point = self._at(poses, mode)
        count = gain.shape[-1]
        good = np.asarray(np.isfinite(rows).all(axis=(-1, -2)))
        scaled = np.where(good[..., None, None], rows / scale(mechanism.length), 0.0)
        held = good & (np.abs(np.linalg.det(scaled)) > _SINGULAR)
        free = np.swapaxes(unit_motions(rows, mechanism.length), -1, -2)[..., :count, :]
        arm = point[..., :count, :] - mechanism.placement(poses, mode)[..., None, :3, 3]
        moved = free[..., :3] + np.cross(free[..., 3:], arm)
        with np.errstate(invalid="ignore", divide="ignore"):
            push = np.abs((rows[..., :count, :3] * moved).sum(axis=-1))
            push = push / np.linalg.norm(moved, axis=-1)
            pull = np.abs(gain) / mechanism.largest_gain
            least = np.minimum(push, pull).min(axis=-1)
        held = held & np.isfinite(least)
        return np.where(held, np.minimum(least, 1.0), np.where(good, 0.0, np.nan))

    def force(self, poses: ArrayLike, mode: str, load: ArrayLike) -> Array:
        """The largest actuator force for a load, N or N·mm; infinite at parallel singularities."""
        found = self._largest(poses, mode, load, "actuation")
        closes = np.isfinite(self._at(poses, mode).rows).all(axis=(-1, -2))
        return np.where(closes & np.isnan(found), np.inf, found)

    def constraint_force(self, poses: ArrayLike, mode: str, load: ArrayLike) -> Array:
        """The largest force of the constraints for a load, N; NaN at parallel singularities."""
        return self._largest(poses, mode, load, "constraint")

    def _at(self, poses: ArrayLike, mode: str) -> Wrenches:
        return self.other(StaticsFacet).at(poses, mode)

    def _largest(self, poses: ArrayLike, mode: str, load: ArrayLike, kind: WrenchKind) -> Array:
        found = self.other(StaticsFacet).forces(poses, mode, load)
        chosen = [name.kind == kind for name in found.names]
        return np.asarray(np.abs(found.forces[..., chosen]).max(axis=-1))
