"""The three stages by which the nine simplified 5-RPURs are solved, for many lengths at a time.

Where limbs i, j satisfy the conditions 1-3 of Tale Masouleh et al., Meccanica 46 (2011), section
3, and stand in the same working mode, B_iB_j is parallel to e2 (eqs. 7, 8): in the frame turned
by R_y(−θ) they have one common w. The equations F1, F2 of `kinematics.five_rpur.equations` then
fall into blocks, solved one after the other:

1. X, θ and w of the groups from F1 of their limbs, a linkage in the plane normal to e1. With P, p
   of limb i of a pair, σ = s_j − s_i, (α, β) = r_j − r_i turned, g = σ − α and
   k = σ² − 2σα + α² + β² + ρ_i² − ρ_j²,

       2 P g − 2 p β + k = 0 and P² + p² = ρ_i², so 4(g² + β²) P² + 4 g k P + k² − 4 β² ρ_i² = 0.

   From two pairs, or from a pair and the third limb of an Mp group, X is eliminated; what is
   left is a trigonometric polynomial in θ, sampled and then solved in e^{iθ}.
2. w of every free limb: w = b ± sqrt(ρ² − (X + s − a)²).
3. y, Z, φ from F2 of three legs, a planar 3-RPR: a polynomial of degree 6 in e^{iφ}.

Each block is polished by Newton's method on its own equations. A point (a, b) of a plane is taken
as a + ib, a − ib, which turn by e^{iθ} and e^{−iθ}; for complex points the two are independent.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.five_rpur.arrangements import Group, PairKind
from kinematics.five_rpur.design import LIMBS
from kinematics.five_rpur.equations import (
    PHI,
    THETA,
    UNKNOWNS,
    Complex,
    Parameters,
    W,
    X,
    Y,
    Z,
    conjugate,
)
from kinematics.five_rpur.polynomial import modulus, roots
from kinematics.spatial import Array

Index = NDArray[np.intp]

FAR = 1e8
"""|e^{iθ}|, |e^{iφ}| or an inverse beyond this belongs to a root at infinity."""
_ONE = 1e-7  # what differs from its conjugate by less is worked out on its own
_SETTLED = 1e-9  # size of a step after which Newton's method has only rounding left
_ROUNDS = 12  # of Newton's method; three do for a simple root
_ACCEPTED = 1e-6  # size of its last step: halved each time where roots coincide


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
        shared: which groups are A2 pairs, with one base point.
        free: the limbs in no group.
        degree: of the trigonometric polynomial in θ.
    """

    base: Complex
    s: Array
    ry: Array
    tip: Complex
    link2: Array
    groups: tuple[tuple[int, ...], ...]
    shared: tuple[bool, ...]
    free: tuple[int, ...]
    degree: int

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
            shared=tuple(
                len(limbs) == 2 and kind == "A2" for limbs, kind in zip(members, kinds, strict=True)
            ),
            free=tuple(i for i in range(LIMBS) if not any(i + 1 in limbs for limbs in members)),
            degree=_degree(kinds, middle=len(members[0]) > 2),
        )

    @property
    def sextics(self) -> int:
        """Planar 3-RPRs a length vector."""
        signs = sum(self.shared) + len(self.free)
        return 2 * self.degree << signs

    @property
    def legs(self) -> tuple[tuple[int, ...], ...]:
        """The limbs that make one leg in the y'z' plane, for each of three."""
        return (*self.groups, *((i,) for i in self.free))

    def turned(self, t: Complex, limbs: Sequence[int] = range(LIMBS)) -> tuple[Complex, Complex]:
        """a_i, b_i of some limbs, (n, N), at e^{iθ} (N,)."""
        base = self.base[list(limbs)]
        forward, backward = base * t, base.conj() / t
        return 0.5 * (forward + backward), -0.5j * (forward - backward)


def _degree(kinds: Sequence[PairKind], *, middle: bool) -> int:
    if middle:
        return 3 if kinds[0] == "A3" else 2
    # The constant term of a pair's quadratic in X is of degree 2 (A1) or 3 (A3) in θ; X of an A2
    # pair is of degree 1.
    constants = [{"A1": 2, "A3": 3}[kind] for kind in kinds if kind != "A2"]
    if len(constants) == 2:
        return 2 * sum(constants) - 4
    return constants[0] if constants else 1


def solve(m: Machine, rho2: Complex | Array) -> tuple[Complex, Index]:
    """All finite solutions found, (10, M), and the column of ρ² (5, B) each belongs to.

    Of real lengths, only one of two conjugate solutions of stages 1 and 2 is worked out; the
    other's solutions are its conjugates. A solution that is not settled, as where several
    coincide, may be missing. Divisions by zero are meant to pass: callers silence them.
    """
    real = not np.iscomplexobj(rho2)
    planar = _planar(m, rho2, real)
    step = _planar_step(m, rho2, planar.owner)
    planar = planar.take(_polish(planar.state, step) < _ACCEPTED)
    if real:
        planar = planar.take(planar.side() >= 0.0)
    legs = _free(m, rho2, planar)
    if real:
        legs = legs.take(legs.side() >= 0.0)
    u, owner, column = _platform(m, legs)
    if real:
        twins = np.flatnonzero((legs.side() > 0.0)[column])
        u = np.concatenate([u, conjugate(u[:, twins])], axis=1)
        owner = np.concatenate([owner, owner[twins]])
    return u, owner


class _Found(NamedTuple):
    """Some stages done: X, e^{iθ} and w of the groups, then of the free limbs, in N columns."""

    state: Complex  # (2 + legs, N)
    owner: Index  # (N,)

    def take(self, which: NDArray[np.bool_]) -> _Found:
        return self if which.all() else _Found(self.state[:, which], self.owner[which])

    def side(self) -> Array:
        """Opposite for a solution and its conjugate; 0 where they are (nearly) the same."""
        t, w = self.state[1], self.state[2:]
        side: Array = np.log(modulus(t))
        for v in w.imag:
            side = np.where(np.abs(side) > _ONE, side, v)
        return np.where(np.abs(side) > _ONE, side, 0.0)


_Step = Callable[[Complex, Index], tuple[Complex, Array]]


def _polish(state: Complex, step: _Step) -> Array:
    """Newton's method on the columns of ``state``, in place; the size of the last step of each.

    ``step`` gives the change of some columns and how large it is.
    """
    size = np.full(state.shape[1], np.inf)
    moving = np.arange(state.shape[1])
    for _ in range(_ROUNDS):
        change, now = step(state[:, moving], moving)
        regular = np.isfinite(now)
        if not regular.all():  # at a singular point itself: there it stays
            moving, change, now = moving[regular], change[:, regular], now[regular]
        state[:, moving] += change
        size[moving] = now
        moving = moving[now > _SETTLED]
        if not len(moving):
            break
    return size


def _cramer(columns: tuple[Complex, Complex, Complex], right: Complex) -> list[Complex]:
    """x with column_1 x_1 + column_2 x_2 + column_3 x_3 = −right, each (3, N)."""
    one, two, three = columns
    minors = _cross(two, three)
    scale = -1.0 / _dot(one, minors)
    return [_dot(right, v) * scale for v in (minors, _cross(three, one), _cross(one, two))]


_Three = Complex | tuple[Complex, Complex, Complex]


def _dot(u: _Three, v: _Three) -> Complex:
    answer: Complex = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    return answer


def _cross(u: Complex, v: Complex) -> tuple[Complex, Complex, Complex]:
    return (
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    )


# --- stage 1 ---------------------------------------------------------------------------------


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
    """The groups' linkage at some θ: a, b (5, …), real or complex, and ρ² (5, …) that fit."""

    def __init__(
        self, m: Machine, a: Complex | Array, b: Complex | Array, rho2: Complex | Array
    ) -> None:
        self.m, self.a, self.b, self.rho2 = m, a, b, rho2

    def tie(self, i: int, j: int) -> _Tie:
        sigma = self.m.s[j] - self.m.s[i]
        alpha, beta = self.a[j] - self.a[i], self.b[j] - self.b[i]
        k = (sigma - 2.0 * alpha) * sigma + alpha * alpha + beta * beta
        return _Tie(sigma - alpha, beta, k + (self.rho2[i] - self.rho2[j]))

    def quadratic(self, i: int, j: int) -> _Quadratic:
        g, beta, k = self.tie(i, j)
        square, linear = 4.0 * (g * g + beta * beta), 4.0 * g * k
        shift = self.m.s[i] - self.a[i]
        return _Quadratic(
            square,
            2.0 * square * shift + linear,
            (square * shift + linear) * shift + k * k - 4.0 * beta * beta * self.rho2[i],
        )

    def shared_x(self, i: int, j: int) -> Complex | Array:
        """X of an A2 pair: β = 0 leaves 2 P σ + k = 0."""
        sigma = self.m.s[j] - self.m.s[i]
        k = sigma * sigma + self.rho2[i] - self.rho2[j]
        x: Complex | Array = self.a[i] - self.m.s[i] - 0.5 * k / sigma
        return x

    def eliminant(self) -> Complex | Array:
        """Zero where the groups fit together."""
        groups, shared = self.m.groups, self.m.shared
        value: Complex | Array
        if len(groups) == 1:
            i, j, k = groups[0]
            one, two = self.tie(i, j), self.tie(i, k)
            value = (
                (one.k * two.beta - two.k * one.beta) ** 2
                + (one.g * two.k - two.g * one.k) ** 2
                - 4.0 * self.rho2[i] * (one.g * two.beta - two.g * one.beta) ** 2
            )
        elif all(shared):
            value = self.shared_x(*groups[0][:2]) - self.shared_x(*groups[1][:2])
        elif any(shared):
            at = shared.index(True)
            x = self.shared_x(*groups[at][:2])
            c = self.quadratic(*groups[1 - at][:2])
            value = (c.square * x + c.linear) * x + c.constant
        else:
            c, d = (self.quadratic(*group[:2]) for group in groups)
            value = (c.square * d.constant - d.square * c.constant) ** 2 - (
                c.square * d.linear - d.square * c.linear
            ) * (c.linear * d.constant - d.linear * c.constant)
        return value

    def positions(self) -> list[Complex | Array]:
        """Where the eliminant is zero: X and w of each group, one after the other in rows.

        A row is (N,), or (2, N) for both signs of w of an A2 pair.
        """
        groups, shared = self.m.groups, self.m.shared
        if len(groups) == 1:
            i, j, k = groups[0]
            one, two = self.tie(i, j), self.tie(i, k)
            scale = 0.5 / (one.g * two.beta - two.g * one.beta)
            big_p = (two.k * one.beta - one.k * two.beta) * scale
            w = (one.g * two.k - two.g * one.k) * scale + self.b[i]
            return [big_p - self.m.s[i] + self.a[i], w]
        if any(shared):
            x = self.shared_x(*groups[shared.index(True)][:2])
        else:
            c, d = (self.quadratic(*group[:2]) for group in groups)
            x = d.square * c.constant - c.square * d.constant
            x = x / (c.square * d.linear - d.square * c.linear)
        rows: list[Complex | Array] = [x]
        for (i, j), is_shared in zip(groups, shared, strict=True):
            big_p = x + self.m.s[i] - self.a[i]
            if is_shared:
                rows.append(self.b[i] + _both(self.rho2[i] - big_p * big_p))
            else:
                tie = self.tie(i, j)
                rows.append((big_p * tie.g + 0.5 * tie.k) / tie.beta + self.b[i])
        return rows


def _both(square: Complex | Array) -> Complex:
    """Both square roots, (2, N)."""
    root = np.sqrt(square.astype(complex))
    return np.stack([root, -root])


def _combined(rows: Sequence[Complex | Array], owner: Index) -> _Found:
    """All combinations of rows (N,) or (2, N) as columns."""
    two = [k for k, row in enumerate(rows) if row.ndim > 1]
    spread = []
    for k, row in enumerate(rows):
        if row.ndim > 1:
            at = two.index(k)
            row = row.reshape(*[1] * at, 2, *[1] * (len(two) - at - 1), -1)
        spread.append(row)
    state = np.stack(np.broadcast_arrays(*spread)).reshape(len(rows), -1)
    return _Found(state, np.tile(owner, 2 ** len(two)))


def _planar(m: Machine, rho2: Complex | Array, real: bool) -> _Found:
    count = 2 * m.degree + 1
    at = m.base * np.exp(2j * np.pi * np.arange(count) / count)
    samples = _Plane(m, at.real[..., None], at.imag[..., None], rho2[:, None])
    # From values at roots of unity to the coefficients of e^{−i degree θ} … e^{i degree θ}.
    polynomial = np.roll(np.fft.fft(samples.eliminant(), axis=0), m.degree, axis=0)
    t = roots(polynomial)
    owner = np.tile(np.arange(rho2.shape[1]), len(t))
    t = t.ravel()
    size = modulus(t)
    finite = (size < FAR) & (size > (1.0 - _ONE if real else 1.0 / FAR))
    t, owner = t[finite], owner[finite]
    x, *w = _Plane(m, *m.turned(t), rho2[:, owner]).positions()
    return _combined([x, t, *w], owner)


def _planar_step(m: Machine, rho2: Complex | Array, owner: Index) -> _Step:
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
            change[0], turned, change[2] = _cramer((big_p, turn, p), f1)
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


# --- stages 2 and 3 --------------------------------------------------------------------------


def _free(m: Machine, rho2: Complex | Array, planar: _Found) -> _Found:
    """Stage 2: with w of the free limbs, all combinations of signs."""
    x, t = planar.state[:2]
    limbs = list(m.free)
    a, b = m.turned(t, limbs)
    big_p = x + m.s[limbs] - a
    w = _both(rho2[limbs][:, planar.owner] - big_p * big_p) + b
    return _combined([*planar.state, *w.transpose(1, 0, 2)], planar.owner)


class _Legs:
    """Three legs in the y'z' plane in isotropic coordinates: B_k at n, C_k at tip e^{iφ}."""

    def __init__(self, m: Machine, w: Complex) -> None:
        limbs = [limbs[0] for limbs in m.legs]
        self.tip, self.link2 = m.tip[limbs], m.link2[limbs]
        self.n, self.nc = m.ry[limbs] + 1j * w, m.ry[limbs] - 1j * w

    def sextic(self) -> Complex:
        """The polynomials in e^{iφ} whose roots close the legs, (7, N).

        With d_k the vector from B_1C_1 to B_kC_k and e_k = |d_k|² + l_1² − l_k², the vector t from
        B_1 to C_1 has 2 t·d_k = −e_k and |t|² = l_1²:
        |e_2 d_3 − e_3 d_2|² = 4 l_1² (d_2 × d_3)².
        """
        n, nc = self.n[1:] - self.n[0], self.nc[1:] - self.nc[0]
        tip = self.tip[1:] - self.tip[0]
        tip_c, link2 = tip.conj(), self.link2[0]
        zero = tip * tip_c + n * nc + link2 - self.link2[1:]  # e by powers of e^{iφ}
        minus, plus = -tip_c * n, -tip * nc

        def minor(u: Complex, v: Complex) -> Complex:
            value: Complex = u[0] * v[1] - u[1] * v[0]
            return value

        # e_2 d_3 − e_3 d_2 of powers −1 … 2 and −2 … 1; the cross product of powers −1 … 1.
        one = [
            -minor(minus, n),
            minor(minus, tip) - minor(zero, n),
            minor(zero, tip) - minor(plus, n),
            minor(plus, tip),
        ]
        two = [
            minor(minus, tip_c),
            minor(zero, tip_c) - minor(minus, nc),
            minor(plus, tip_c) - minor(zero, nc),
            -minor(plus, nc),
        ]
        cross = [-minor(tip_c, n), minor(tip_c, tip) + minor(nc, n), -minor(nc, tip)]
        answer = np.zeros((7, n.shape[1]), dtype=complex)
        for i, u in enumerate(one):
            for j, v in enumerate(two):
                answer[i + j] += u * v
        for i, u in enumerate(cross):
            for j, v in enumerate(cross):
                answer[i + j + 1] += link2 * u * v
        return answer

    def take(self, columns: Index) -> _Legs:
        """The legs of other columns."""
        answer = object.__new__(_Legs)
        answer.tip, answer.link2 = self.tip, self.link2
        answer.n, answer.nc = self.n[:, columns], self.nc[:, columns]
        return answer

    def place(self, f: Complex) -> Complex:
        """y + iZ, y − iZ and e^{iφ}, (3, N), of roots of the sextic (N,)."""
        tip, tip_c = self.tip * f, self.tip.conj() / f
        d = (tip[1:] - tip[0]) - (self.n[1:] - self.n[0])
        dc = (tip_c[1:] - tip_c[0]) - (self.nc[1:] - self.nc[0])
        e = d * dc + self.link2[0] - self.link2[1:]
        scale = 1.0 / (dc[0] * d[1] - d[0] * dc[1])
        v = (e[1] * d[0] - e[0] * d[1]) * scale + self.n[0] - tip[0]
        vc = (e[0] * dc[1] - e[1] * dc[0]) * scale + self.nc[0] - tip_c[0]
        return np.stack([v, vc, f])

    def step(self, state: Complex, columns: Index) -> tuple[Complex, Array]:
        """Newton's step for those on F2 = Y² + q² − l² of the three legs."""
        v, vc, f = state
        tip, tip_c = self.tip * f, self.tip.conj() / f
        u, uc = v + tip - self.n[:, columns], vc + tip_c - self.nc[:, columns]
        tilt = 1j * (uc * tip - u * tip_c)
        dv, dvc, turned = _cramer((uc, u, tilt), u * uc - self.link2)
        size = (modulus(dv) + modulus(dvc)) / (1.0 + modulus(v) + modulus(vc)) + modulus(turned)
        return np.stack([dv, dvc, 1j * f * turned]), size


def _platform(m: Machine, found: _Found) -> tuple[Complex, Index, Index]:
    """Stage 3: solutions (10, M), their owners, and the columns that they come from."""
    legs = _Legs(m, found.state[2:])
    f = roots(legs.sextic())
    column = np.tile(np.arange(f.shape[1]), len(f))
    f = f.ravel()
    size = modulus(f)
    finite = (size < FAR) & (size > 1.0 / FAR)
    f, column = f[finite], column[finite]
    legs = legs.take(column)
    state = legs.place(f)
    settled = _polish(state, legs.step) < _ACCEPTED
    column = column[settled]
    return (
        _configurations(m, found.state[:, column], state[:, settled]),
        found.owner[column],
        column,
    )


def _configurations(m: Machine, linkage: Complex, platform: Complex) -> Complex:
    """The unknowns of `kinematics.five_rpur.equations` from those of stages 1, 2 and of 3."""
    u = np.empty((UNKNOWNS, linkage.shape[1]), dtype=complex)
    v, vc, u[PHI] = platform
    u[Y], u[Z] = 0.5 * (v + vc), -0.5j * (v - vc)
    u[X], u[THETA] = linkage[:2]
    for k, limbs in enumerate(m.legs):
        for i in limbs:
            u[W][i] = linkage[2 + k]
    return u


def polish(m: Machine, rho2: Complex | Array, u: Complex, owner: Index) -> None:
    """Newton's method, stage by stage, on configurations u (10, M) in place."""
    linkage = u[[X, THETA, *(5 + limbs[0] for limbs in m.legs)]]
    groups = len(m.groups)
    _polish(linkage[: 2 + groups], _planar_step(m, rho2, owner))
    limbs = list(m.free)
    a, b = m.turned(linkage[1], limbs)
    big_p = linkage[0] + m.s[limbs] - a
    both = _both(rho2[limbs][:, owner] - big_p * big_p) + b
    off = modulus(both - linkage[2 + groups :])
    linkage[2 + groups :] = np.where(off[0] <= off[1], *both)
    platform = np.stack([u[Y] + 1j * u[Z], u[Y] - 1j * u[Z], u[PHI]])
    _polish(platform, _Legs(m, linkage[2:]).step)
    u[:] = _configurations(m, linkage, platform)
