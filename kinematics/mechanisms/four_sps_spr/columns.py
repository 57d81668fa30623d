"""Where p can be while two angles are held and the third, θ, follows: by columns.

θ turns the platform about an axis e that stays. In the frame that turns along, with A_5 as its
origin, the platform stands still and the constraint is a plane that stands still, q·m = −b_5·n6:
q = −(b_5·n6) m + u t + v w with t along e × m and w = m × t. Leg i is |q + b_i − d_i(θ)|, d_i the
turned A_i − A_5. The constraint's derivative by θ is −|e × m| u: a branch of θ is one sign of u,
and where u = 0, at the fold, the branches meet. A unit of (θ, u, v) is |e × m| |u| of volume.
Lengths mm, angles rad.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import rotation
from kinematics.mechanisms.four_sps_spr.motion import angular_axes
from kinematics.solids.columns import Span

_LEAST = 1e-9
"""|e × m| below which θ has no say in the constraint."""
_CORE = 1e-4
"""Part of the span of u that is left out at the fold, of a volume 1e-8 as large at most: there the
surfaces of all θ may fall on one line."""


@dataclass(frozen=True)
class FollowingAngle:
    """The places on one branch of the angle that follows; columns over (|u|, θ) along v.

    Args:
        angles: α, β, γ; what stands at ``index`` does not matter.
        index: of the angle that follows among the pose's coordinates: 3, 4 or 5.
        side: +1 or −1, the sign of u.
    """

    design: FourSPSSPRDesign
    angles: tuple[float, float, float]
    index: int
    side: int

    @cached_property
    def _frame(self) -> tuple[Array, Array]:
        """R with θ = 0, and the rows e, m, t, w; t and w are zero where θ has no say."""
        angles = list(self.angles)
        angles[self.index - 3] = 0.0
        pose = np.array([0.0, 0.0, 0.0, *angles])
        axis = angular_axes(pose)[:, self.index - 3]
        r = rotation(pose)
        normal = r @ self.design.axis
        across = np.cross(axis, normal)
        steep = float(np.linalg.norm(across))
        t = across / steep if steep > _LEAST else np.zeros(3)
        return r, np.stack([axis, normal, t, np.cross(normal, t)])

    @cached_property
    def steepness(self) -> float:
        """|e × m|; 0 where the angle has no say in the constraint."""
        _, (axis, normal, t, _) = self._frame
        return float(t @ np.cross(axis, normal))

    @cached_property
    def _joints(self) -> Array:
        """b_i in the frame that turns along, (5, 3) as m, t, w."""
        r, rows = self._frame
        return np.asarray(self.design.platform @ r.T @ rows[1:].T)

    @cached_property
    def _bases(self) -> tuple[Array, Array, Array]:
        """d_i(θ) = first + second cos θ + third sin θ, (5, 3) each as m, t, w."""
        _, rows = self._frame
        axis = rows[0]
        d = self.design.base - self.design.base[SPR]
        along = np.outer(d @ axis, axis)
        parts = (along, d - along, -np.cross(axis, d))  # turned by −θ
        first, second, third = (np.asarray(part @ rows[1:].T) for part in parts)
        return first, second, third

    @property
    def low(self) -> Array:
        return np.asarray(self.design.stroke[:, 0])

    @property
    def high(self) -> Array:
        return np.asarray(self.design.stroke[:, 1])

    @cached_property
    def base(self) -> tuple[Span, Span]:
        """Limb 5 alone bounds u."""
        reach = self.design.stroke[SPR, 1] - self.side * self._joints[SPR, 1]
        farthest = max(float(reach), 1e-3 * float(self.design.stroke[SPR, 1]))
        return (_CORE * farthest, farthest), (-np.pi, np.pi)

    @property
    def closed(self) -> bool:
        return True

    @property
    def pole(self) -> bool:
        return False

    @property
    def tear(self) -> float | None:
        return None

    def limbs(self, at: Array) -> tuple[Array, Array]:
        """Across the column and along it: q + b_i − d_i."""
        first, second, third = self._bases
        turn = at[:, 1, None, None]
        away = self._joints - first - second * np.cos(turn) - third * np.sin(turn)
        across = np.hypot(away[..., 0] - self.design.offset, away[..., 1] + self.side * at[:, :1])
        return across, away[..., 2]

    def spread(self, at: Array, half: Array) -> Array:
        """A turn moves A_i about e, u moves all."""
        _, second, third = self._bases
        turn = at[:, 1, None, None]
        slope = np.linalg.norm(third * np.cos(turn) - second * np.sin(turn), axis=-1)
        bend = np.linalg.norm(second, axis=-1)
        b = half[:, 1:]
        return np.asarray(np.minimum(slope * b + 0.5 * bend * b * b, bend * b) + half[:, :1])

    def weight(self, at: Array) -> Array:
        return np.asarray(self.steepness * at[:, 0])

    def polynomial(self, at: Array) -> Array | None:
        return None

    def place(self, at: Array, v: Array) -> Array:
        """p in the base frame."""
        _, (axis, normal, t, w) = self._frame
        q = np.multiply.outer(self.side * at[:, 0], t) + np.multiply.outer(v, w)
        q = q - self.design.offset * normal
        turn = at[:, 1, None]
        along = np.multiply.outer(q @ axis, axis)
        turned = along + (q - along) * np.cos(turn) + np.cross(axis, q) * np.sin(turn)
        return np.asarray(turned + self.design.base[SPR])

    def coordinates(self, points: Array, turn: Array) -> tuple[Array, Array]:
        """Where places (N, 3) on the branch are whose angle is ``turn`` (N,): (N, 2) and v."""
        _, (axis, _, t, w) = self._frame
        q = points - self.design.base[SPR]
        along = np.multiply.outer(q @ axis, axis)
        back = (
            along + (q - along) * np.cos(turn)[:, None] - np.cross(axis, q) * np.sin(turn)[:, None]
        )
        return np.stack([self.side * (back @ t), turn], axis=-1), np.asarray(back @ w)


assert LIMBS == SPR + 1
