"""What P passes on a straight way in one working mode.

Everything that can happen on a line is a root of a polynomial along it: the circles of a limb's
reach and of the ends of its range (degree 2), and the two sextics of parallel singularities (degree
6). Between neighbouring roots nothing changes, so that nothing is passed over.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from kinematics.answers.singularities import NEAR
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.segments import ROUNDING, Part, Segment
from kinematics.mechanisms.five_bar.curves import sextic
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS
from kinematics.mechanisms.five_bar.inverse import elbows, joints_of
from kinematics.mechanisms.five_bar.named_paths import NamedPaths
from kinematics.mechanisms.five_bar.statics import sines
from kinematics.zeros import special_points

_SAME = 1e-9  # of the way: roots that are one


class Paths(NamedPaths):
    """Exact: every place where something may happen is a root of a polynomial."""

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

    def determinant(self, poses: Array, mode: str) -> tuple[Array, Array]:
        """The sine of the angle between the distal links."""
        _, between = sines(self.design, poses, joints_of(self.design, poses, mode))
        return np.nan_to_num(between), np.full(len(poses), ROUNDING)

    def places(
        self,
        move: Segment,
        part: Part,
        functions: Callable[[Array], Array],
        *,
        stationary: bool = False,
        noise: float = 0.0,
    ) -> list[Array]:
        roots = _roots(self, *move.start.tolist(), *move.change.tolist())
        inner = part.t(roots[(roots > part.a + _SAME) & (roots < part.b - _SAME)])
        found = np.concatenate([[0.0], inner, [np.pi]])
        return [found] * functions(found[:1]).shape[1]

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


@lru_cache(maxsize=8)
def _roots(paths: Paths, x: float, y: float, dx: float, dy: float) -> Array:
    """The parts of a way at which something may happen, increasing."""
    design = paths.design
    ranged = np.where(np.isfinite(design.joint_range), design.joint_range, 0.0)
    ends = [
        (elbows(design, angles)[i], float(design.distal[i]))
        for i, limb in enumerate(design.limbs)
        if limb.joint_range_deg is not None
        for angles in ranged.T
    ]

    def poses(s: Array) -> Array:
        return np.stack([x + s * dx, y + s * dy], axis=-1)

    def polynomials(s: Array) -> Array:
        p = poses(s)
        circles = [((p - at) ** 2).sum(axis=-1) - radius**2 for at, radius in ends]
        return np.stack([*circles, *(sextic(design, p, side)[0] for side in (1, -1))], axis=-1)

    # Where a base joint is passed the reach is stationary.
    reach = special_points(lambda s: paths.reach(poses(s), ""), 0.0, 1.0, stationary=True)
    return np.unique(np.concatenate([*reach, *special_points(polynomials, 0.0, 1.0)]))
