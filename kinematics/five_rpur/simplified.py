"""All same-mode solutions of the nine simplified 5-RPURs, by one algorithm in three stages.

Where limbs i, j satisfy the conditions 1-3 of Tale Masouleh et al., Meccanica 46 (2011), section
3, and stand in the same working mode, B_iB_j is parallel to e2 (eqs. 7, 8): in the frame turned
by R_y(−θ) they have one common w. The equations (`kinematics.five_rpur.equations`) then fall into
blocks that are solved one after the other:

1. (X, θ, w of the groups) from the limbs of the groups, F1 alone: a linkage in the plane normal to
   e1. With p, P of one limb i of a pair, σ = s_j − s_i, (α, β) = r_j − r_i turned and
   g = σ − α, k = σ² − 2σα + α² + β² + ρ_i² − ρ_j², a pair has

       2 P g − 2 p β + k = 0,   P² + p² = ρ_i²,   so   4(g² + β²) P² + 4 g k P + k² − 4 β² ρ_i² = 0.

   The resultant of two pairs, or of a pair and the third limb of an Mp group, is a trigonometric
   polynomial in θ of low degree: it is sampled, and solved in e^{iθ}.
2. w of every free limb: w = b ± sqrt(ρ² − (X + s − a)²).
3. (y, Z, φ): three legs in the y'z' plane, a planar 3-RPR, of degree 6 in e^{iφ}.

Every block is polished by Newton's method on its own equations. In the planes, points are taken
as isotropic coordinates a + ib, a − ib, which turn by e^{iθ} and e^{−iθ}; for complex points they
are independent of each other. All roots are kept, complex ones too, and told apart afterwards.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.errors import InputError
from kinematics.five_rpur.arrangements import CLASSES, PairKind, arrangements
from kinematics.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.five_rpur.equations import (
    PHI,
    THETA,
    UNKNOWNS,
    Complex,
    X,
    Y,
    Z,
    parameters,
)
from kinematics.five_rpur.polynomial import modulus, roots
from kinematics.spatial import Array

_FAR = 1e8  # |e^{iθ}|, |e^{iφ}| or the inverse beyond which a root is one at infinity
_CHUNK = 1024  # sextics at a time
_ROUNDS = 3  # of Newton's method


def expected(design: FiveRPURDesign) -> int | None:
    """How many same-mode solutions a length vector has; None for a design of no such class."""
    found = arrangements(design)
    known = CLASSES.get(found.name)
    return None if known is None or found.reasons else known.solutions


def same_mode_roots(design: FiveRPURDesign, joints: ArrayLike) -> tuple[Complex, NDArray[np.intp]]:
    machine = _machine(design)
    rho2 = np.ascontiguousarray(parameters(design, joints).rho2)
    parts = [_solve(machine, rho2[:, chunk]) for chunk in _chunks(machine, rho2.shape[1])]
    found = np.concatenate(parts, axis=1) if parts else np.empty((UNKNOWNS, 0, 0), dtype=complex)
    good = np.isfinite(found).all(axis=0)
    owner = np.broadcast_to(np.arange(found.shape[1])[:, None], found.shape[1:])
    return found[:, good], owner[good]


# --- the machine ---------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, slots=True)
class _Machine:
    """A simplified design without unit, in isotropic coordinates; all arrays (5, 1, 1).

    Attributes:
        base: r_x + i r_z; ``s``: s'_x; ``ry``: r_y; ``tip``: s'_y + i s'_z; ``link2``: l².
        groups: limbs (from 0) of each group, its most special pair first.
        shared: which groups are A2 pairs on their own.
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

    @property
    def grouped(self) -> list[int]:
        return [i for group in self.groups for i in group]

    @property
    def legs(self) -> list[int]:
        """One limb of each group, and the free ones: three."""
        return [*(group[0] for group in self.groups), *self.free]

    @property
    def sextics(self) -> int:
        """Planar problems a length vector."""
        return 2 * self.degree * 2 ** (sum(self.shared) + len(self.free))


@lru_cache(maxsize=64)
def _machine(design: FiveRPURDesign) -> _Machine:
    found = arrangements(design)
    if found.name not in CLASSES or found.reasons:
        raise InputError("the design is none of the nine simplified ones")
    groups, kinds = [], []
    for group in found.groups:
        pair = next(pair for pair in group.pairs if pair.kind == group.kind)
        first = [i - 1 for i in pair.limbs]
        groups.append((*first, *(i - 1 for i in group.limbs if i - 1 not in first)))
        kinds.append(group.kind)
    g = parameters(design, np.zeros(LIMBS))
    return _Machine(
        base=(g.rx + 1j * g.rz)[..., None],
        s=np.real(g.sx)[..., None],
        ry=np.real(g.ry)[..., None],
        tip=(g.sy + 1j * g.sz)[..., None],
        link2=np.real(g.link2)[..., None],
        groups=tuple(groups),
        shared=tuple(
            len(group) == 2 and kind == "A2" for group, kind in zip(groups, kinds, strict=True)
        ),
        free=tuple(i for i in range(LIMBS) if all(i not in group for group in groups)),
        degree=_degree(kinds, len(groups[0]) == 3),
    )


def _degree(kinds: list[PairKind], middle: bool) -> int:
    if middle:
        return 3 if kinds == ["A3"] else 2
    # An A1 and an A3 pair are of degree 2 and 3 in what the other's quadratic is in X; two shared
    # base points leave a linear equation.
    order = {"A1": 2, "A3": 3}
    quadratic = [order[kind] for kind in kinds if kind != "A2"]
    if len(quadratic) == 2:
        return 2 * sum(quadratic) - 4
    return quadratic[0] if quadratic else 1


# --- stage 1: X, θ and the groups' w ---------------------------------------------------------


class _Pair(NamedTuple):
    """What ties limb j to limb i at some θ, each (n, B): 2 P g − 2 p β + k = 0."""

    g: Complex | Array
    beta: Complex | Array
    k: Complex | Array


def _pair(m: _Machine, i: int, j: int, a: Complex, b: Complex, rho2: Complex | Array) -> _Pair:
    sigma = m.s[j] - m.s[i]
    alpha, beta = a[j] - a[i], b[j] - b[i]
    k = (sigma - 2.0 * alpha) * sigma + alpha * alpha + beta * beta + rho2[i] - rho2[j]
    return _Pair(sigma - alpha, beta, k)


def _turned(m: _Machine, t: Complex) -> tuple[Complex, Complex]:
    """a_i, b_i (5, …) at e^{iθ} (…)."""
    forward, backward = m.base * t, m.base.conj() / t
    return 0.5 * (forward + backward), -0.5j * (forward - backward)


def _quadratic(
    m: _Machine, i: int, j: int, a: Complex, b: Complex, rho2: Complex | Array
) -> tuple[Complex | Array, Complex | Array, Complex | Array]:
    """The coefficients of X², X and 1 that a pair leaves when its w is eliminated."""
    g, beta, k = _pair(m, i, j, a, b, rho2)
    square, linear = 4.0 * (g * g + beta * beta), 4.0 * g * k
    shift = m.s[i] - a[i]
    return (
        square,
        2.0 * square * shift + linear,
        (square * shift + linear) * shift + k * k - 4.0 * beta * beta * rho2[i],
    )


def _shared_x(m: _Machine, i: int, j: int, a: Complex, rho2: Complex | Array) -> Complex | Array:
    """X of an A2 pair, whose β = 0: X + s_i − a_i = −k/(2σ)."""
    sigma = m.s[j] - m.s[i]
    x: Complex = a[i] - m.s[i] - 0.5 * (sigma * sigma + rho2[i] - rho2[j]) / sigma
    return x


class _Planar(NamedTuple):
    """Stage 1, R roots of B length vectors: X, e^{iθ} (R, B), w of the groups (G, R, B)."""

    x: Complex
    t: Complex
    w: Complex


def _planar(m: _Machine, rho2: Complex | Array) -> _Planar:
    t = roots(_trigonometric(m, rho2))
    a, b = _turned(m, t)
    if len(m.groups) == 1:
        i, j, p = m.groups[0]
        one, two = (_pair(m, i, k, a, b, rho2) for k in (j, p))
        scale = 0.5 / (one.g * two.beta - two.g * one.beta)
        big_p = (two.k * one.beta - one.k * two.beta) * scale
        w = (one.g * two.k - two.g * one.k) * scale + b[i]
        return _Planar(big_p - m.s[i] + a[i], t, w[None])
    if any(m.shared):
        x = _shared_x(m, *m.groups[m.shared.index(True)], a, rho2)
    else:
        (a1, b1, c1), (a2, b2, c2) = (_quadratic(m, *pair, a, b, rho2) for pair in m.groups)
        x = (a2 * c1 - a1 * c2) / (a1 * b2 - a2 * b1)
    w = []
    for (i, j), shared in zip(m.groups, m.shared, strict=True):
        big_p = x + m.s[i] - a[i]
        if shared:
            half = np.sqrt((rho2[i] - big_p * big_p).astype(complex))
            w.append(np.stack([b[i] + half, b[i] - half]))
        else:
            pair = _pair(m, i, j, a, b, rho2)
            w.append(((big_p * pair.g + 0.5 * pair.k) / pair.beta + b[i])[None])
    all_of = np.broadcast_arrays(x, t, w[0][:, None], w[1][None])
    x, t, *w = (v.reshape(-1, v.shape[-1]) for v in all_of)
    return _Planar(x, t, np.stack(w))


def _trigonometric(m: _Machine, rho2: Complex | Array) -> Complex:
    """The polynomial in e^{iθ}, (2 degree + 1, B), from its values at roots of unity."""
    count = 2 * m.degree + 1
    t = np.exp(2j * np.pi * np.arange(count) / count)[:, None]
    turned = m.base * t
    a, b = turned.real, turned.imag
    if len(m.groups) == 1:
        i, j, p = m.groups[0]
        one, two = (_pair(m, i, k, a, b, rho2) for k in (j, p))
        values = (
            (one.k * two.beta - two.k * one.beta) ** 2
            + (one.g * two.k - two.g * one.k) ** 2
            - 4.0 * rho2[i] * (one.g * two.beta - two.g * one.beta) ** 2
        )
    elif all(m.shared):
        first, second = (_shared_x(m, *pair, a, rho2) for pair in m.groups)
        values = first - second
    elif any(m.shared):
        at = m.shared.index(True)
        x = _shared_x(m, *m.groups[at], a, rho2)
        square, linear, constant = _quadratic(m, *m.groups[1 - at], a, b, rho2)
        values = (square * x + linear) * x + constant
    else:
        (a1, b1, c1), (a2, b2, c2) = (_quadratic(m, *pair, a, b, rho2) for pair in m.groups)
        values = (a1 * c2 - a2 * c1) ** 2 - (a1 * b2 - a2 * b1) * (b1 * c2 - b2 * c1)
    return np.roll(np.fft.fft(values, axis=0), m.degree, axis=0)


def _polished_planar(m: _Machine, rho2: Complex | Array, start: _Planar) -> tuple[_Planar, Array]:
    """Newton's method on F1 of the grouped limbs; the size of its last step, (R, B)."""
    x, t, w = start
    limbs = m.grouped
    group_of = [k for k, group in enumerate(m.groups) for _ in group]
    for _ in range(_ROUNDS):
        a, b = (v[limbs] for v in _turned(m, t))
        big_p, p = x + m.s[limbs] - a, w[group_of] - b
        turn = big_p * b - p * a  # of F1 = (P² + p² − ρ²)/2 with θ
        f1 = 0.5 * (big_p * big_p + p * p - rho2[limbs, None])
        if len(m.groups) == 1:
            dx, dw0, dtheta = _cramer((big_p, p, turn), f1)
            dw = dw0[None]
        else:
            # dw is eliminated from each pair: p_j × row i − p_i × row j
            first, second = slice(0, None, 2), slice(1, None, 2)
            big, tilt, right = (
                p[second] * v[first] - p[first] * v[second] for v in (big_p, turn, f1)
            )
            scale = 1.0 / (big[0] * tilt[1] - big[1] * tilt[0])
            dx = (right[1] * tilt[0] - right[0] * tilt[1]) * scale
            dtheta = (right[0] * big[1] - right[1] * big[0]) * scale
            rest = (f1 + big_p * dx + turn * dtheta) * p.conj()
            weight = p.real * p.real + p.imag * p.imag
            dw = -(rest[first] + rest[second]) / (weight[first] + weight[second])
        x, t, w = x + dx, t + 1j * t * dtheta, w + dw
    step = np.maximum(modulus(dtheta), modulus(dx) / (1.0 + modulus(x)))
    step = np.maximum(step, (modulus(dw) / (1.0 + modulus(w))).max(axis=0))
    return _Planar(x, t, w), step


def _cramer(columns: tuple[Complex, Complex, Complex], right: Complex) -> tuple[Complex, ...]:
    """Solutions of three equations: −right = Σ column_k x_k, each array (3, …)."""
    one, two, three = columns
    minors = _cross(two, three)
    scale = -1.0 / (one * minors).sum(axis=0)
    first = (right * minors).sum(axis=0) * scale
    second = (right * _cross(three, one)).sum(axis=0) * scale
    third = (right * _cross(one, two)).sum(axis=0) * scale
    return first, second, third


def _cross(u: Complex, v: Complex) -> Complex:
    return np.stack(
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    )


# --- stages 2 and 3 ------------------------------------------------------------------------


def _free(m: _Machine, rho2: Complex | Array, at: _Planar) -> _Planar:
    """Stage 2: the same with w of the legs, (3, S, B), in all combinations of signs."""
    a, b = _turned(m, at.t)
    sides = []
    for n, i in enumerate(m.free):
        big_p = at.x + m.s[i] - a[i]
        half = np.sqrt(rho2[i] - big_p * big_p)
        both = np.stack([b[i] + half, b[i] - half])
        sides.append(both[(slice(None), *[None] * (len(m.free) - 1 - n))])
    all_of = np.broadcast_arrays(at.x, at.t, *at.w, *sides)
    x, t, *w = (v.reshape(-1, v.shape[-1]) for v in all_of)
    return _Planar(x, t, np.stack(w))


def _sextic(m: _Machine, w: Complex) -> Complex:
    """The polynomials (7, …) in e^{iφ} of the planar 3-RPR with w (3, …) of its legs.

    With d_k = D_k, D̄_k from leg 1 to leg k in isotropic coordinates, e_k = D_k D̄_k + l_1² − l_k²
    and t from B_1 to C_1, 2 t·d_k = −e_k gives t; then |t|² = l_1².
    """
    ry, tip, link2 = (v[m.legs].reshape(3, *[1] * (w.ndim - 1)) for v in (m.ry, m.tip, m.link2))
    dy, dw = ry[1:] - ry[0], 1j * (w[1:] - w[0])
    n, nc = dy + dw, dy - dw
    mm = tip[1:] - tip[0]
    mc = mm.conj()
    e0 = mm * mc + n * nc + link2[0] - link2[1:]
    em, ep = -mc * n, -mm * nc  # of e^{−iφ}, e^{iφ}
    other = slice(None, None, -1)

    def minor(u: Complex, v: Complex) -> Complex:
        both = u * v[other]
        difference: Complex = both[0] - both[1]
        return difference

    # q = e_2 D_3 − e_3 D_2 of powers −1 … 2, its companion of −2 … 1, the determinant of −1 … 1.
    q = [-minor(em, n), minor(em, mm) - minor(e0, n), minor(e0, mm) - minor(ep, n), minor(ep, mm)]
    qc = [
        minor(em, mc),
        minor(e0, mc) - minor(em, nc),
        minor(ep, mc) - minor(e0, nc),
        -minor(ep, nc),
    ]
    det = [-minor(mc, n), minor(mc, mm) + minor(nc, n), -minor(nc, mm)]
    answer: Complex = np.zeros((7, *w.shape[1:]), dtype=complex)
    for i, u in enumerate(q):
        for j, v in enumerate(qc):
            answer[i + j] += u * v
    for i, u in enumerate(det):
        for j, v in enumerate(det):
            answer[i + j + 1] += link2[0] * (u * v)
    return answer


def _platform(m: _Machine, w: Complex, f: Complex) -> tuple[Complex, Complex]:
    """y + iZ and y − iZ, each (6, …), at the roots e^{iφ} (6, …)."""
    ry, tip, link2 = (v[m.legs].reshape(3, *[1] * (w.ndim)) for v in (m.ry, m.tip, m.link2))
    n, nc = ry + 1j * w[:, None], ry - 1j * w[:, None]
    turned, turned_c = tip * f, tip.conj() / f
    d = (turned[1:] - turned[0]) - (n[1:] - n[0])
    dc = (turned_c[1:] - turned_c[0]) - (nc[1:] - nc[0])
    e = d * dc + link2[0] - link2[1:]
    scale = 1.0 / (dc[0] * d[1] - d[0] * dc[1])
    v = (e[1] * d[0] - e[0] * d[1]) * scale + n[0] - turned[0]
    vc = (e[0] * dc[1] - e[1] * dc[0]) * scale + nc[0] - turned_c[0]
    return v, vc


def _polished_platform(
    m: _Machine, w: Complex, f: Complex, v: Complex, vc: Complex
) -> tuple[Complex, Complex, Complex, Array]:
    """Newton's method on F2 of the three legs; the size of its last step, (6, …)."""
    ry, tip, link2 = (a[m.legs].reshape(3, *[1] * (w.ndim)) for a in (m.ry, m.tip, m.link2))
    n, nc = ry + 1j * w[:, None], ry - 1j * w[:, None]
    for _ in range(_ROUNDS):
        turned, turned_c = tip * f, tip.conj() / f
        u, uc = v + turned - n, vc + turned_c - nc
        right = u * uc - link2
        dv, dvc, dphi = _cramer((uc, u, 1j * (uc * turned - u * turned_c)), right)
        f, v, vc = f + 1j * f * dphi, v + dv, vc + dvc
    step = np.maximum(modulus(dv) + modulus(dvc), 0.0) / (1.0 + modulus(v) + modulus(vc))
    return f, v, vc, np.maximum(step, modulus(dphi))


# --- all together --------------------------------------------------------------------------


def _solve(m: _Machine, rho2: Complex | Array) -> Complex:
    """(10, B, K); NaN where a root is at infinity or was not settled."""
    with np.errstate(all="ignore"):
        first, step = _polished_planar(m, rho2, _planar(m, rho2))
        bad = ~((step < 1e-6) & (modulus(first.t) < _FAR) & (modulus(first.t) > 1.0 / _FAR))
        at = _free(m, rho2, _Planar(np.where(bad, np.nan, first.x), first.t, first.w))
        f = roots(_sextic(m, at.w).reshape(7, -1)).reshape(6, *at.x.shape)
        v, vc = _platform(m, at.w, f)
        f, v, vc, step = _polished_platform(m, at.w, f, v, vc)
        bad = ~((step < 1e-6) & (modulus(f) < _FAR) & (modulus(f) > 1.0 / _FAR))
        u = np.empty((UNKNOWNS, *f.shape), dtype=complex)
        u[X], u[THETA], u[PHI] = at.x, at.t, f
        u[Y], u[Z] = 0.5 * (v + vc), -0.5j * (v - vc)
        for i in range(LIMBS):
            group = next((k for k, members in enumerate(m.groups) if i in members), None)
            u[5 + i] = at.w[group if group is not None else len(m.groups) + m.free.index(i)]
        u[:, bad] = np.nan
    return u.reshape(UNKNOWNS, -1, u.shape[-1]).transpose(0, 2, 1)


def _chunks(m: _Machine, count: int) -> Iterator[slice]:
    size = max(1, _CHUNK // m.sextics)
    return (slice(k, min(k + size, count)) for k in range(0, count, size))
