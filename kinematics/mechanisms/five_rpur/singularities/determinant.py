"""The determinant of the wrenches at one orientation and working mode, in closed form.

In the base frame turned by R_y(−θ), with (X, Y, Z) = C_i − A_i, q = σ h(Y), p = Z − q and
c = R_x(φ) s'_i, limb i transmits −(qX, pY, pq)/(ρ l) through B_i = O′ + c − (0, Y, q). The five
rows [force, moment about x', moment about y'], freed of their factors −1/(ρ l), are

    q X,  p Y,  p q,  p (c_y q − c_z Y),  q ((c_z − q) X − c_x p).

Three columns have p as a factor. Laplace's rule along them leaves ten terms, one for each pair
(d, e) of limbs with a < b < c the others:

    F = Σ (−1)^(d+e) D_abc p_a p_b p_c q_d q_e (X_d X_e (q_d − q_e + c_ze − c_zd)
                                               − c_xe X_d p_e + c_xd X_e p_d),

D_abc the determinant of the rows (Y, q, c_y q − c_z Y). F has the sign of the determinant of
the wrenches of `statics`, and is finite and continuous wherever the limbs close. At a fixed y' all
Y, q and D are constant: F is then a polynomial of degree 2 in x' and 4 in z'. Lengths mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.screws.spatial import rotation_x, rotation_y

_PAIRS = np.array(list(combinations(range(LIMBS), 2)))
_D, _E = _PAIRS.T
_A, _B, _C = np.array([[k for k in range(LIMBS) if k not in pair] for pair in _PAIRS]).T
_SIGN = np.where((_D + _E) % 2 == 0, 1.0, -1.0)

ROUNDING = 1e-13
"""Part of the sum of its terms' absolute values below which F is no more than rounding."""

_LEAST_Q = 1e-9  # part of l; nearer to |Y| = l the slope of q is taken from there


@dataclass(frozen=True, eq=False)
class Determinant:
    """F at one orientation and working mode, in units of the 12th power of `size`.

    Beyond the y' where every limb closes, F goes on as it is at the end.

    Attributes:
        offset: (5, 3) w'_i.
        tip: (5, 3) c_i.
        sign: (5,) σ_i.
        link: (5,) l_i.
        size: mm, a length of the machine.
        span: the least and the greatest y' where every limb closes; none does where they are
            not in this order.
        turn: (3, 3) from x'y'z' to the base frame.
    """

    offset: Array
    tip: Array
    sign: Array
    link: Array
    size: float
    span: tuple[float, float]
    turn: Array

    @classmethod
    def at(cls, design: FiveRPURDesign, phi: float, theta: float, mode: str) -> Determinant:
        """The determinant of a machine.

        Raises:
            InputError: an angle that is not finite, or not five signs.
        """
        offset = offset_points(design, phi, theta)
        y = offset[:, 1]
        return cls(
            offset=offset,
            tip=np.asarray(design.platform @ rotation_x(phi).T),
            sign=inverse.signs(mode, design),
            link=design.link,
            size=float((design.link + design.stroke[:, 1]).max()),
            span=(float((y - design.link).max()), float((y + design.link).min())),
            turn=rotation_y(theta),
        )

    @property
    def closes(self) -> bool:
        """Whether there is any place where every limb closes."""
        return self.span[0] < self.span[1]

    # --- values

    def value(self, points: ArrayLike) -> Array:
        """F at points (..., 3) in x'y'z'; returns (...,)."""
        return np.asarray(self._terms(np.asarray(points, dtype=float))[0].sum(axis=0))

    def roundoff(self, points: ArrayLike) -> Array:
        """An estimate from above of the rounding error of F at points (..., 3)."""
        return np.asarray(ROUNDING * self._terms(np.asarray(points, dtype=float))[1])

    def value_and_gradient(self, points: ArrayLike) -> tuple[Array, Array]:
        """F (...,) and its gradient (..., 3) by x', y' and z', per mm.

        Where |Y| = l of a limb the true slope along y' is infinite: a large finite one is given.
        """
        p = np.asarray(points, dtype=float)
        shape = p.shape[:-1]
        flat = p.reshape(-1, 3)
        value, gradient = np.empty(len(flat)), np.empty((len(flat), 3))
        for part in range(0, len(flat), _CHUNK):
            here = slice(part, part + _CHUNK)
            value[here], gradient[here] = self._slopes(flat[here])
        return value.reshape(shape), gradient.reshape(*shape, 3)

    def _limbs(self, points: Array) -> tuple[Array, Array, Array, Array]:
        """X, Y, q, p, each (5, ...), in units of the size."""
        ahead = (slice(None),) + (None,) * (points.ndim - 1)
        x, z = (points[..., k] - self.offset[:, k][ahead] for k in (0, 2))
        y, q = self._heights(points[..., 1])
        x, z = x / self.size, z / self.size
        return x, y, q, z - q

    def _heights(self, y: Array) -> tuple[Array, Array]:
        """Y and q (5, ...) in units of the size; ``y`` is held within the span."""
        ahead = (slice(None),) + (None,) * y.ndim
        link = self.link[ahead]
        held = np.clip(y, *self.span) if self.closes else y
        own = np.clip(held - self.offset[:, 1][ahead], -link, link)
        q = self.sign[ahead] * np.sqrt((link - own) * (link + own))
        return own / self.size, q / self.size

    def _terms(self, points: Array) -> tuple[Array, Array]:
        ahead = (slice(None),) + (None,) * (points.ndim - 1)
        return terms(*self._limbs(points), self.tip.T[(slice(None), *ahead)] / self.size)

    def _slopes(self, points: Array) -> tuple[Array, Array]:
        x, y, q, p = self._limbs(points)
        cx, cy, cz = (column[:, None] / self.size for column in self.tip.T)
        # d/dy' of Y, q and p; F is constant beyond the span.
        free = (points[:, 1] >= self.span[0]) & (points[:, 1] <= self.span[1])
        dy = free.astype(float)
        steep = np.where(self.sign < 0.0, -1.0, 1.0)[:, None] * np.maximum(
            np.abs(q), _LEAST_Q * self.link[:, None] / self.size
        )
        dq = -dy * y / steep
        lean, dlean = cy * q - cz * y, cy * dq - cz * dy

        pa, pb, pc, pd, pe = p[_A], p[_B], p[_C], p[_D], p[_E]
        xd, xe, qd, qe = x[_D], x[_E], q[_D], q[_E]
        cxd, cxe = cx[_D], cx[_E]
        bc, ac, ab = pb * pc, pa * pc, pa * pb
        cube, dcube = pa * bc, bc + ac + ab  # by z'
        ycube = -(bc * dq[_A] + ac * dq[_B] + ab * dq[_C])
        pair, dpair = qd * qe, dq[_D] * qe + qd * dq[_E]
        minor, dminor = _minor(y, q, lean), _minor_slope(y, dy, q, dq, lean, dlean)
        wide = qd - qe + cz[_E] - cz[_D]
        inner = xd * xe * wide - cxe * xd * pe + cxd * xe * pd
        inner_x = (xd + xe) * wide - cxe * pe + cxd * pd
        inner_z = cxd * xe - cxe * xd
        inner_y = xd * xe * (dq[_D] - dq[_E]) + cxe * xd * dq[_E] - cxd * xe * dq[_D]

        own = _SIGN[:, None] * pair * minor  # what does not depend on x' and z'
        by_y = cube * (dpair * minor + pair * dminor) * inner
        by_y += pair * minor * (ycube * inner + cube * inner_y)
        value = (own * cube * inner).sum(axis=0)
        gradient = np.stack(
            [
                (own * cube * inner_x).sum(axis=0),
                (_SIGN[:, None] * by_y).sum(axis=0),
                (own * (dcube * inner + cube * inner_z)).sum(axis=0),
            ],
            axis=-1,
        )
        return value, gradient / self.size

    # --- polynomials at constant y'

    def coefficients(self, y: ArrayLike, center: tuple[float, float]) -> Array:
        """(N, 3, 5) a[j, k] of F = Σ a[j, k] u^j w^k in the planes y' = ``y`` (N,).

        u = (x' − x'_0) / size and w = (z' − z'_0) / size, ``center`` = (x'_0, z'_0).
        """
        y = np.atleast_1d(np.asarray(y, dtype=float))
        own, q = self._heights(y)
        cx, cy, cz = (column[:, None] / self.size for column in self.tip.T)
        x0 = (center[0] - self.offset[:, :1]) / self.size  # X = u + x0
        p0 = (center[1] - self.offset[:, 2:]) / self.size - q  # p = w + p0
        front = _SIGN[:, None] * q[_D] * q[_E] * _minor(own, q, cy * q - cz * own)
        pa, pb, pc, pd, pe = p0[_A], p0[_B], p0[_C], p0[_D], p0[_E]
        cube = np.stack(
            [pa * pb * pc, pa * pb + pa * pc + pb * pc, pa + pb + pc, np.ones_like(pa)], axis=-1
        )
        cube *= front[..., None]
        xd, xe = x0[_D], x0[_E]
        wide = q[_D] - q[_E] + cz[_E] - cz[_D]
        cxd, cxe = cx[_D], cx[_E]
        # The factor in brackets, as a polynomial in u (rows) and w.
        inner = np.zeros((*wide.shape, 3, 2))
        inner[..., 0, 0] = xd * xe * wide - cxe * xd * pe + cxd * xe * pd
        inner[..., 1, 0] = (xd + xe) * wide - cxe * pe + cxd * pd
        inner[..., 2, 0] = wide
        inner[..., 0, 1] = cxd * xe - cxe * xd
        inner[..., 1, 1] = cxd - cxe
        result = np.zeros((len(y), 3, 5))
        result[..., :4] = np.einsum("tnj,tnk->njk", inner[..., 0], cube)
        result[..., 1:] += np.einsum("tnj,tnk->njk", inner[..., 1], cube)
        return result

    def along_z(self, x: Array, y: Array) -> Array:
        """(N, 5) coefficients of F in powers of z' / size on the lines at x' and y' (N,)."""
        result = np.empty((len(x), 5))
        for part in range(0, len(x), _LINES):
            here = slice(part, part + _LINES)
            result[here] = self._on_lines(x[here], y[here]).T
        return result

    def _on_lines(self, x: Array, y: Array) -> Array:
        own, q = self._heights(y)
        cx, cy, cz = (column[:, None] / self.size for column in self.tip.T)
        away = (x - self.offset[:, :1]) / self.size
        p = -self.offset[:, 2:] / self.size - q  # at z' = 0
        front = _SIGN[:, None] * q[_D] * q[_E] * _minor(own, q, cy * q - cz * own)
        pa, pb, pc = p[_A], p[_B], p[_C]
        xd, xe = front * away[_D], away[_E]
        one, other = cx[_D] * front * xe, cx[_E] * xd
        level = xd * xe * (q[_D] - q[_E] + cz[_E] - cz[_D]) - other * p[_E] + one * p[_D]
        slope = one - other
        pair, both = pb * pc, pb + pc
        cube = (pa * pair, pair + pa * both, pa + both)
        return np.stack(
            [
                (level * cube[0]).sum(axis=0),
                (level * cube[1] + slope * cube[0]).sum(axis=0),
                (level * cube[2] + slope * cube[1]).sum(axis=0),
                (level + slope * cube[2]).sum(axis=0),
                slope.sum(axis=0),
            ]
        )

    def on_grid(self, x: Array, y: Array, z: Array) -> Array:
        """F (nx, ny, nz) at the nodes of a grid."""
        center = float(x.mean()), float(z.mean())
        a = self.coefficients(y, center)
        u = np.power.outer((x - center[0]) / self.size, np.arange(3))
        w = np.power.outer((z - center[1]) / self.size, np.arange(5))
        values: Array = u @ (a @ w.T)  # (ny, nx, nz)
        return np.ascontiguousarray(values.transpose(1, 0, 2))


def terms(x: Array, y: Array, q: Array, p: Array, tip: Array) -> tuple[Array, Array]:
    """The ten terms of F, and an upper bound of the size of their parts, summed.

    Args:
        x, y, q, p: X, Y, q and p of the limbs, (5, ...), in one unit of length.
        tip: (3, 5, ...) c_x, c_y and c_z likewise; broadcasts with them.

    Returns:
        (10, ...) and (...,).
    """
    cx, cy, cz = tip
    lean = cy * q - cz * y
    sign = _SIGN[(slice(None),) + (None,) * (q.ndim - 1)]
    front = sign * (p[_A] * p[_B] * p[_C]) * (q[_D] * q[_E])
    minor = _minor(y, q, lean)
    inner = (
        x[_D] * x[_E] * (q[_D] - q[_E] + cz[_E] - cz[_D])
        - cx[_E] * x[_D] * p[_E]
        + cx[_D] * x[_E] * p[_D]
    )
    ay, aq, al = np.abs(y), np.abs(q), np.abs(cy * q) + np.abs(cz * y)
    most = (
        np.abs(x[_D] * x[_E]) * (aq[_D] + aq[_E] + np.abs(cz[_E]) + np.abs(cz[_D]))
        + np.abs(cx[_E] * x[_D] * p[_E])
        + np.abs(cx[_D] * x[_E] * p[_D])
    )
    bound = np.abs(front) * _permanent(ay, aq, al) * most
    return front * minor * inner, np.asarray(bound.sum(axis=0))


def at_poses(
    design: FiveRPURDesign, poses: Array, sign: Array, *, imaginary: bool = False
) -> tuple[Array, Array]:
    """F and its rounding (...,) at poses (..., 5) in a mode with the signs (5,).

    Args:
        imaginary: beyond |Y| = l of a limb q is imaginary, and F complex; else q is 0 there.
    """
    flat, size = poses.reshape(-1, 5), float((design.link + design.stroke[:, 1]).max())
    x, y, z = (part / size for part in inverse.limb_vectors(design, flat))
    link = (design.link / size)[:, None]
    square = link * link - y * y if imaginary else np.maximum((link - y) * (link + y), 0.0)
    q = sign[:, None] * np.sqrt(square.astype(complex) if imaginary else square)
    tip = design.platform @ rotation_x(flat[:, 3]).swapaxes(-1, -2) / size
    parts, most = terms(x, y, q, z - q, tip.transpose(2, 1, 0))
    shape = poses.shape[:-1]
    return parts.sum(axis=0).reshape(shape), ROUNDING * most.reshape(shape)


_CHUNK = 2048  # points at a time, so that the temporaries stay in the cache
_LINES = 512  # likewise


def _minor(y: Array, q: Array, lean: Array) -> Array:
    """The determinants D_abc of the rows (Y, q, lean), (10, ...)."""
    ya, yb, yc = y[_A], y[_B], y[_C]
    qa, qb, qc = q[_A], q[_B], q[_C]
    return np.asarray(
        ya * (qb * lean[_C] - qc * lean[_B])
        - yb * (qa * lean[_C] - qc * lean[_A])
        + yc * (qa * lean[_B] - qb * lean[_A])
    )


def _permanent(y: Array, q: Array, lean: Array) -> Array:
    ya, yb, yc = y[_A], y[_B], y[_C]
    qa, qb, qc = q[_A], q[_B], q[_C]
    return np.asarray(
        ya * (qb * lean[_C] + qc * lean[_B])
        + yb * (qa * lean[_C] + qc * lean[_A])
        + yc * (qa * lean[_B] + qb * lean[_A])
    )


def _minor_slope(y: Array, dy: Array, q: Array, dq: Array, lean: Array, dlean: Array) -> Array:
    """d D_abc: the sum of the determinants with one column differentiated."""
    dy = np.broadcast_to(dy, y.shape)
    return _minor(dy, q, lean) + _minor(y, dq, lean) + _minor(y, q, dlean)
