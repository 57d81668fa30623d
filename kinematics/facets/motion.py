"""Velocities and accelerations of platform and actuators, both ways."""

from __future__ import annotations

from abc import abstractmethod

from numpy.typing import ArrayLike

from kinematics.answers.motion import Motion
from kinematics.facets.facet import Facet
from kinematics.mechanism import D


class MotionFacet(Facet[D]):
    """First and second order motion of a batch of postures in one mode."""

    topic = "motion"

    @abstractmethod
    def inverse(
        self,
        poses: ArrayLike,
        mode: str,
        pose_rates: ArrayLike,
        pose_accelerations: ArrayLike | None = None,
    ) -> Motion:
        """What the actuators do when the pose changes.

        Args:
            poses: (..., P) mm and rad.
            pose_rates: (..., P) mm/s and rad/s; broadcasts with the poses.
            pose_accelerations: (..., P) mm/s² and rad/s²; None: zero.

        Returns:
            NaN for limbs that cannot close or are in a serial singularity.

        Raises:
            InputError: not finite numbers, or not P of them.
        """

    @abstractmethod
    def forward(
        self,
        poses: ArrayLike,
        mode: str,
        joint_rates: ArrayLike,
        joint_accelerations: ArrayLike | None = None,
    ) -> Motion:
        """What the platform does when the actuators move.

        Args:
            poses: (..., P) mm and rad.
            joint_rates: (..., J) mm/s or rad/s; broadcasts with the poses.
            joint_accelerations: (..., J) mm/s² or rad/s²; None: zero.

        Returns:
            NaN where a limb cannot close and at parallel singularities.

        Raises:
            InputError: not finite numbers, or not J of them.
        """
