"""What a move of the five-bar meets."""

from __future__ import annotations

import numpy as np

from kinematics.answers.singularities import NEAR
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS
from kinematics.mechanisms.five_bar.inverse import joints_of
from kinematics.mechanisms.five_bar.named_paths import NamedPaths
from kinematics.mechanisms.five_bar.statics import sines


class Paths(NamedPaths):
    """Smooth functions of the reach and of the ends of ranges, also where angles come round."""

    @property
    def reach_limbs(self) -> tuple[int, ...]:
        return tuple(np.repeat(np.arange(1, LIMBS + 1), 2).tolist())

    def reach(self, poses: Array, mode: str) -> Array:
        """(r_1 + r_2)² − ρ² and ρ² − (r_1 − r_2)², by (r_1 + r_2)²."""
        square = ((poses[:, None, :] - self.design.base) ** 2).sum(axis=-1)
        r1, r2 = self.design.proximal, self.design.distal
        both = np.stack([(r1 + r2) ** 2 - square, square - (r1 - r2) ** 2], axis=-1)
        return (both / ((r1 + r2) ** 2)[:, None]).reshape(len(poses), 2 * LIMBS)

    def ranges(self, poses: Array, mode: str) -> Array:
        """Cosines of what a joint is from the middle of its range, above that of the end."""
        ranged = np.asarray(np.isfinite(self.design.joint_range).all(axis=-1))
        low, high = np.where(ranged[:, None], self.design.joint_range, 0.0).T
        joints = np.nan_to_num(joints_of(self.design, poses, mode))
        half = np.minimum(0.5 * (high - low), np.pi)
        within = np.cos(joints - 0.5 * (low + high)) - np.cos(half)
        return np.repeat(np.where(ranged, within, np.inf), 2, axis=-1)

    def touched(self, limb: int, what: str, where: str) -> str:
        at = f"A{SUBSCRIPTS[limb - 1]}"
        return f"P passed {at} {where}, where limb {limb} is folded onto its base"

    def warning(self, posture: Posture, *, stopped: bool = False) -> str:
        """A word where a posture stands near a singularity; "" as a rule."""
        if stopped or not posture.closes:
            return ""
        limbs, between = sines(self.design, np.array(posture.pose), np.array(posture.joints))
        if abs(float(between)) < NEAR:
            return "near a parallel singularity: the distal links are nearly in line"
        for i in range(LIMBS):
            if abs(float(limbs[i])) < NEAR:
                return f"near a serial singularity: limb {i + 1} is nearly stretched or folded"
        return ""
