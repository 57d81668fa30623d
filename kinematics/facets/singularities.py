"""Where control of the platform is lost: at a posture, and as curves over two coordinates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.singularities import AT, ModeChange, Singularity
from kinematics.answers.solutions import Posture
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.facets.motion import MotionFacet
from kinematics.facets.statics import StaticsFacet
from kinematics.mechanism import D
from kinematics.screws.singularity_geometry import lost


class SingularitiesFacet(Facet[D]):
    """Singularities with their causes, and their loci."""

    topic = "singularities"
    loci: tuple[LocusSpec, ...] = ()

    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        """The singularities that a posture is in; empty where a limb cannot close.

        Args:
            tolerance: what has a measure below it counts: the part of an actuator's largest gain
                that it has (serial ones, told first), or the smallest singular value of the six
                wrenches (parallel and constraint ones). A posture may be in several at once.
        """
        if not posture.closes:
            return ()
        return (*self.serial(posture, tolerance), *self.parallel(posture, tolerance))

    def serial(self, posture: Posture, tolerance: float) -> tuple[Singularity, ...]:
        """Those of limbs that do not drive the platform."""
        gain = self.other(StaticsFacet).at(posture.pose, posture.mode).gain
        part = np.abs(gain) / self.mechanism.largest_gain
        return tuple(
            Singularity(
                "serial",
                (n + 1,),
                f"the actuator of limb {n + 1} has no effect",
                f"Serial singularity of limb {n + 1}: its actuator does not move the platform.",
                float(part[n]),
            )
            for n in np.flatnonzero(part < tolerance).tolist()
        )

    def parallel(self, posture: Posture, tolerance: float) -> tuple[Singularity, ...]:
        """Those in which the wrenches do not hold the platform, one for each motion left free."""
        pose, mode = np.array(posture.pose), posture.mode
        motion = self.other(MotionFacet)
        return lost(
            self.other(StaticsFacet).wrenches(pose, mode),
            tuple(self.mechanism.placement(pose, mode)[:3, 3].tolist()),
            self.mechanism.length,
            lambda twist: motion.pose_rates(pose, mode, twist).tolist(),
            tolerance,
        )

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
