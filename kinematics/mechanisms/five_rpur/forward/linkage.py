"""The groups of a simplified 5-RPUR as a linkage in the plane normal to e1: X, θ and their w.

This is the first of the three stages of `forward.stages`, in the frame turned by
R_y(−θ) and with only F1 of the grouped limbs. An A1 pair has its U joint at one of two fixed
points, where two circles meet; an A2 pair has B_i at one of two fixed places (P, p) from A_i in
the turned frame. Of an A3 pair, with σ = s_j − s_i, (α, β) = r_j − r_i turned, g = σ − α and
k = σ² − 2σα + α² + β² + ρ_i² − ρ_j², there remains

    2 P g − 2 p β + k = 0 and P² + p² = ρ_i², so 4(g² + β²) P² + 4 g k P + k² − 4 β² ρ_i² = 0.

From two pairs, or from a pair and the third limb of an Mp group, X is eliminated; what is left is
a trigonometric polynomial in θ, sampled and then solved in e^{iθ}. Points are taken as a + ib and
a − ib, which turn by e^{iθ} and e^{−iθ}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.arrangements import Group, PairKind
from kinematics.mechanisms.five_rpur.design import LIMBS
from kinematics.mechanisms.five_rpur.forward.columns import (
    CLOSE,
    FLAT,
    Index,
    Step,
    both_roots,
    cramer,
    square_root,
    told_apart,
)
from kinematics.mechanisms.five_rpur.forward.equations import Complex, Parameters
from kinematics.mechanisms.five_rpur.forward.polynomial import modulus, roots

FAR = 1e8
"""|e^{iθ}|, |e^{iφ}| or an inverse beyond this belongs to a root at infinity."""
_ONE = 1e-7  # what differs from its conjugate by less is worked out on its own


@dataclass(frozen=True, eq=False, slots=True)
class Machine:
    """A simplified design without unit, in isotropic coordinates; arrays (5, 1).

    Attributes:
        base: r_x + i r_z.
        s: s'_x.
        ry: r_y.
        tip: s'_y + i s'_z.
        link2: l².
        groups: limbs (from 0) of each group, its most special pair first.
        kinds: of the groups' special pairs.
        free: the limbs in no group.
    """

    base: Complex
    s: Array
    ry: Array
    tip: Complex
    link2: Array
    groups: tuple[tuple[int, ...], ...]
    kinds: tuple[PairKind, ...]
    free: tuple[int, ...]

    @classmethod
    def of(cls, g: Parameters, groups: Sequence[Group]) -> Machine:
        """The machine with these parameters (of any lengths) and these groups."""
        members, kinds = [], []
        for group in groups:
            pair = next(pair for pair in group.pairs if pair.kind == group.kind)
            members.append((*pair.limbs, *(i for i in group.limbs if i not in pair.limbs)))
            kinds.append(group.kind)
        rx, ry, rz, sx, sy, sz, link2 = (np.real(v) for v in g[:7])
        return cls(
            base=rx + 1j * rz,
            s=sx,
            ry=ry,
            tip=sy + 1j * sz,
            link2=link2,
            groups=tuple(tuple(i - 1 for i in limbs) for limbs in members),
            kinds=tuple(kinds),
            free=tuple(i for i in range(LIMBS) if not any(i + 1 in limbs for limbs in members)),
        )

    @property
    def sided(self) -> tuple[bool, ...]:
        """Which groups' special pairs have two places, whatever θ is."""
        return tuple(kind != "A3" for kind in self.kinds)

    @property
    def degree(self) -> int:
        """Of the trigonometric polynomial in θ."""
        if len(self.groups) == 1:
            return 1 if self.sided[0] else 3
        return {0: 8, 1: 3, 2: 1}[sum(self.sided)]

    @property
    def sextics(self) -> int:
        """Planar 3-RPRs a length vector."""
        return 2 * self.degree << (sum(self.sided) + len(self.free))

    @property
    def legs(self) -> tuple[tuple[int, ...], ...]:
        """The limbs that make one leg in the y'z' plane, for each of three."""
        return (*self.groups, *((i,) for i in self.free))

    def turned(self, t: Complex, limbs: Sequence[int] = range(LIMBS)) -> tuple[Complex, Complex]:
        """a_i, b_i of some limbs, (n, N), at e^{iθ} (N,)."""
        base = self.base[list(limbs)]
        forward, backward = base * t, base.conj() / t
        return 0.5 * (forward + backward), -0.5j * (forward - backward)


class Found(NamedTuple):
    """Some stages done: X, e^{iθ} and w of the groups, then of the free limbs, in N columns."""

    state: Complex  # (2 + legs, N)
    owner: Index  # (N,)

    def take(self, which: NDArray[np.bool_]) -> Found:
        """Some of the columns."""
        return self if which.all() else Found(self.state[:, which], self.owner[which])

    def side(self) -> Array:
        """Opposite for a solution and its conjugate; 0 where they are (nearly) the same."""
        t, w = self.state[1], self.state[2:]
        side: Array = np.log(modulus(t))
        for v in w.imag:
            side = np.where(np.abs(side) > _ONE, side, v)
        return np.where(np.abs(side) > _ONE, side, 0.0)


# --- the equations of the linkage -----------------------------------------------------------


class _Tie(NamedTuple):
    """What ties limb j to limb i of a group: 2 P_i g − 2 p_i β + k = 0."""

    g: Complex | Array
    beta: Complex | Array
    k: Complex | Array


class _Quadratic(NamedTuple):
    """The coefficients of X², X and 1 that are left of a pair without its w."""

    square: Complex | Array
    linear: Complex | Array
    constant: Complex | Array


class _Plane:
    """The groups' linkage at some θ: a, b (5, …) and ρ² (5, …), real or complex.

    ``sides`` (G, …) are ±1 for the place of each group's special pair if it is an A1 or A2 pair.
    """

    def __init__(
        self,
        m: Machine,
        a: Complex | Array,
        b: Complex | Array,
        rho2: Complex | Array,
        sides: Array,
    ) -> None:
        self.m, self.a, self.b, self.rho2, self.sides = m, a, b, rho2, sides

    def place(self, group: int) -> tuple[Complex | Array, Complex | Array]:
        """X and w of an A1 or A2 pair."""
        i, j = self.m.groups[group][:2]
        rho2, side = self.rho2[i], self.sides[group]
        if self.m.kinds[group] == "A1":
            alpha, beta = self.a[j] - self.a[i], self.b[j] - self.b[i]
            distance2 = modulus(self.m.base[j] - self.m.base[i]) ** 2
            along = 0.5 * (rho2 - self.rho2[j] + distance2) / distance2
            across = side * square_root(rho2 / distance2 - along * along)
            big_p, p = along * alpha - across * beta, along * beta + across * alpha
        else:
            sigma = self.m.s[j] - self.m.s[i]
            big_p = -0.5 * (sigma * sigma + rho2 - self.rho2[j]) / sigma
            p = side * square_root(rho2 - big_p * big_p)
        return big_p - self.m.s[i] + self.a[i], p + self.b[i]

    def tie(self, i: int, j: int) -> _Tie:
        """What an A3 pair is bound to."""
        sigma = self.m.s[j] - self.m.s[i]
        alpha, beta = self.a[j] - self.a[i], self.b[j] - self.b[i]
        k = (sigma - 2.0 * alpha) * sigma + alpha * alpha + beta * beta
        return _Tie(sigma - alpha, beta, k + (self.rho2[i] - self.rho2[j]))

    def quadratic(self, group: int) -> _Quadratic:
        """Without w."""
        i, j = self.m.groups[group][:2]
        g, beta, k = self.tie(i, j)
        square, linear = 4.0 * (g * g + beta * beta), 4.0 * g * k
        shift = self.m.s[i] - self.a[i]
        return _Quadratic(
            square,
            2.0 * square * shift + linear,
            (square * shift + linear) * shift + k * k - 4.0 * beta * beta * self.rho2[i],
        )

    def eliminant(self) -> Complex | Array:
        """Zero where the groups fit together."""
        groups, sided = self.m.groups, self.m.sided
        value: Complex | Array
        if len(groups) == 1 and sided[0]:
            x, w = self.place(0)
            k = groups[0][2]
            value = (x + self.m.s[k] - self.a[k]) ** 2 + (w - self.b[k]) ** 2 - self.rho2[k]
        elif len(groups) == 1:
            i, j, k = groups[0]
            one, two = self.tie(i, j), self.tie(i, k)
            value = (
                (one.k * two.beta - two.k * one.beta) ** 2
                + (one.g * two.k - two.g * one.k) ** 2
                - 4.0 * self.rho2[i] * (one.g * two.beta - two.g * one.beta) ** 2
            )
        elif all(sided):
            value = self.place(0)[0] - self.place(1)[0]
        elif any(sided):
            x, _ = self.place(sided.index(True))
            c = self.quadratic(sided.index(False))
            value = (c.square * x + c.linear) * x + c.constant
        else:
            c, d = self.quadratic(0), self.quadratic(1)
            value = (c.square * d.constant - d.square * c.constant) ** 2 - (
                c.square * d.linear - d.square * c.linear
            ) * (c.linear * d.constant - d.linear * c.constant)
        return value

    def positions(self, t: Complex, problem: Index) -> list[Complex | Array]:
        """X and w of each group, (N,), at the roots e^{iθ} of the problems' eliminants."""
        groups, sided = self.m.groups, self.m.sided
        if any(sided):
            x, _ = self.place(sided.index(True))
        elif len(groups) == 1:
            i, j, k = groups[0]
            one, two = self.tie(i, j), self.tie(i, k)
            scale = 0.5 / (one.g * two.beta - two.g * one.beta)
            big_p = (two.k * one.beta - one.k * two.beta) * scale
            w = (one.g * two.k - two.g * one.k) * scale + self.b[i]
            return [big_p - self.m.s[i] + self.a[i], w]
        else:
            c, d = self.quadratic(0), self.quadratic(1)
            x = d.square * c.constant - c.square * d.constant
            x = x / (c.square * d.linear - d.square * c.linear)
        return [
            x,
            *(
                self.place(group)[1] if sided[group] else self._height(group, x, t, problem)
                for group in range(len(groups))
            ),
        ]

    def _height(self, group: int, x: Complex | Array, t: Complex, problem: Index) -> Complex:
        """w of an A3 pair with known X."""
        i, j = self.m.groups[group][:2]
        g, beta, k = self.tie(i, j)
        big_p = x + self.m.s[i] - self.a[i]
        p: Complex = (big_p * g + 0.5 * k) / beta
        flat = np.flatnonzero(~(modulus(beta) > FLAT * modulus(g)))
        if len(flat):  # A_iA_j is parallel to e2: p and −p, so a double root
            both = both_roots(self.rho2[i][flat] - big_p[flat] ** 2)
            p[flat] = told_apart(both, p[flat], t[flat], problem[flat])
        return np.asarray(p + self.b[i])


# --- its solutions ---------------------------------------------------------------------------


def planar(m: Machine, rho2: Complex | Array, real: bool) -> Found:
    """Stage 1. Of ``real`` lengths, of two conjugate solutions only one need be found."""
    # A problem for every combination of places.
    combinations = np.array(list(product(*((1.0, -1.0) if v else (1.0,) for v in m.sided)))).T
    owner = np.tile(np.arange(rho2.shape[1]), combinations.shape[1])
    sides = np.repeat(combinations, rho2.shape[1], axis=1)
    rho2 = rho2[:, owner]
    # From values at roots of unity to the coefficients of e^{−i degree θ} … e^{i degree θ}.
    count = 2 * m.degree + 1
    at = m.base * np.exp(2j * np.pi * np.arange(count) / count)
    a, b = at.real[..., None], at.imag[..., None]
    values = _Plane(m, a, b, rho2[:, None], sides[:, None]).eliminant()
    t = roots(np.roll(np.fft.fft(values, axis=0), m.degree, axis=0))
    problem = np.tile(np.arange(t.shape[1]), len(t))
    t = t.ravel()
    size = modulus(t)
    finite = (size < FAR) & (size > (1.0 - CLOSE if real else 1.0 / FAR))
    t, problem = t[finite], problem[finite]
    plane = _Plane(m, *m.turned(t), rho2[:, problem], sides[:, problem])
    x, *w = plane.positions(t, problem)
    return Found(np.stack([x, t, *w]), owner[problem])


def planar_step(m: Machine, rho2: Complex | Array, owner: Index) -> Step:
    """Newton's step for X, e^{iθ} and w of the groups on F1 = (P² + p² − ρ²)/2 of their limbs."""
    limbs = [i for group in m.groups for i in group]
    group_of = [2 + k for k, group in enumerate(m.groups) for _ in group]
    first, second = slice(0, None, 2), slice(1, None, 2)

    def step(state: Complex, columns: Index) -> tuple[Complex, Array]:
        x, t = state[0], state[1]
        a, b = m.turned(t, limbs)
        big_p, p = x + m.s[limbs] - a, state[group_of] - b
        turn = big_p * b - p * a  # dF1/dθ
        f1 = 0.5 * (big_p * big_p + p * p - rho2[limbs][:, owner[columns]])
        change = np.empty_like(state)
        if len(m.groups) == 1:
            change[0], turned, change[2] = cramer((big_p, turn, p), f1)
        else:
            # p_j × row i − p_i × row j is free of the pair's w.
            big, tilt, right = (
                p[second] * v[first] - p[first] * v[second] for v in (big_p, turn, f1)
            )
            scale = 1.0 / (big[0] * tilt[1] - big[1] * tilt[0])
            change[0] = (right[1] * tilt[0] - right[0] * tilt[1]) * scale
            turned = (right[0] * big[1] - right[1] * big[0]) * scale
            rest = (f1 + big_p * change[0] + turn * turned) * p.conj()
            weight = p.real * p.real + p.imag * p.imag
            change[2:] = -(rest[first] + rest[second]) / (weight[first] + weight[second])
        change[1] = 1j * t * turned
        moved = modulus(change) / (1.0 + modulus(state))
        moved[1] = modulus(turned)
        size = moved.max(axis=0)
        return change, size

    return step
