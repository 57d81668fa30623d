"""Following assembly modes of the 5-RPUR: its closure equations as quadrics.

Unknowns are X, y, Z, the cosines and sines of φ and θ, and w_i, with X, Z the position of O' and
w_i the z' coordinate of B_i in the base frame turned by R_y(−θ). With a_i, b_i the x', z'
coordinates of A_i, each limb is two quadrics (from Tale Masouleh et al., Meccanica 46 (2011),
eqs. 3-6):

    (X + s'_ix − a_i)² + (w_i − b_i)² = ρ_i²
    (y + C s'_iy − S s'_iz − r_iy)² + q_i² = l_i²,    q_i = Z + S s'_iy + C s'_iz − w_i

In this form a limb may pass v_i ∥ e1 (q_i = 0) smoothly, where its working mode σ_i = sign q_i
changes by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from math import atan2, cos, sin

import numpy as np

from kinematics.answers.solutions import Followed, Posture
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.following import ClosureFollowing
from kinematics.facets.inverse import posture
from kinematics.facets.paths import PathsFacet
from kinematics.homotopy.quadrics import Quadric, Quadrics, square, unknowns
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import signs

_COUNT = 7 + LIMBS


class Following(ClosureFollowing[FiveRPURDesign]):
    """Of a simplified design as of any other: limbs may pass into other working modes, those that
    share a U joint together."""

    @cached_property
    def unit(self) -> float:
        return float(self.design.link.mean())

    def closure(self, mode: str) -> Quadrics:
        return _closure(self.design)

    def unknowns(self, pose: Sequence[float], mode: str) -> Array:
        """B_i are as the working mode says; a limb that cannot close has its link along e1."""
        values = finite(pose, name="a pose", last=5)
        if values.shape != (5,):
            raise InputError("one pose of 5 numbers (x, y, z, φ, θ) is needed")
        x, y, z, phi, theta = values.tolist()
        c, s, cf, sf = cos(theta), sin(theta), cos(phi), sin(phi)
        _, sy, sz = self.design.platform.T
        across = np.abs(y + cf * sy - sf * sz - self.design.base[:, 1])
        height = (self.design.link - across) * (self.design.link + across)
        up = x * s + z * c
        w = up + sf * sy + cf * sz - signs(mode, self.design) * np.sqrt(np.maximum(height, 0.0))
        place = np.array([x * c - z * s, y, up]) / self.unit
        return np.concatenate([place, [cf, sf, c, s], w / self.unit])

    def posture(self, unknowns: Array, joints: Array, pose: Sequence[float], mode: str) -> Posture:
        x, y, z, cf, sf, c, s = unknowns[:7].tolist()
        turn = 1.0 / np.hypot(c, s)
        place = self.unit * np.array([(x * c + z * s) * turn, y, (z * c - x * s) * turn])
        angles = atan2(sf, cf), atan2(s, c)
        heights = zip(self._heights(unknowns), mode, strict=True)
        mode = "".join(old if q == 0.0 else "+" if q > 0.0 else "-" for q, old in heights)
        return posture(self.design, (*place.tolist(), *angles), mode, known=joints)

    def _heights(self, points: Array) -> Array:
        """q_i at points (..., n), (..., 5); of merged limbs the same to the last digit."""
        _, sy, sz = self.design.platform.T / self.unit
        z, cf, sf = (points[..., n, None] for n in (2, 3, 4))
        heights: Array = z + sf * sy + cf * sz - points[..., 7:]
        for first, *others in self.design.merged_joints:
            heights[..., [i - 1 for i in others]] = heights[..., [first - 1]]
        return heights

    def events(self, start: Posture, end: Posture, visited: Array) -> str:
        q = self._heights(visited)
        passed = np.asarray(q[:-1] * q[1:] < 0.0)
        parts = []
        for i in np.argsort(passed.argmax(axis=0), kind="stable"):
            if passed[:, i].any():
                back = start.mode[i] == end.mode[i]
                sign = end.mode[i] if not back else "-" if start.mode[i] == "+" else "+"
                text = f"limb {i + 1} passed into working mode {sign.replace('-', '−')}"
                parts.append(text + (" and back" if back else ""))
        return "; ".join(parts)

    def warning(self, reached: Followed) -> str:
        stopped = reached.stop == "singularity"
        return self.other(PathsFacet).warning(reached.posture, stopped=stopped)


@lru_cache(maxsize=64)
def _closure(design: FiveRPURDesign) -> Quadrics:
    unit = float(design.link.mean())
    x, y, z, cf, sf, c, s, *rest = unknowns(_COUNT + LIMBS)
    heights, lengths = rest[:LIMBS], rest[LIMBS:]
    points = (design.base / unit, design.platform / unit, design.link / unit)
    merged = {i - 1: limbs[0] - 1 for limbs in design.merged_joints for i in limbs[1:]}
    equations = [0.5 * (square(cf) + square(sf) - 1.0), 0.5 * (square(c) + square(s) - 1.0)]
    for i, ((rx, ry, rz), (sx, sy, sz), link) in enumerate(zip(*points, strict=True)):
        w, rho = heights[i], lengths[i]
        across, up = x + sx - rx * c + rz * s, w - rx * s - rz * c
        side, height = y + sy * cf - sz * sf - ry, z + sy * sf + sz * cf - w
        equations.append(0.5 * (square(across) + square(up) - square(rho)))
        if i in merged:  # the same link: its U joint is that of the first of them
            equations.append(Quadric([]) + (w - heights[merged[i]]))
        else:
            equations.append(0.5 * (square(side) + square(height) - link**2))
    return Quadrics.of(equations)
