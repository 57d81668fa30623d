"""The three stages by which the nine simplified 5-RPURs are solved, for many lengths at a time.

Where limbs i, j satisfy the conditions 1-3 of Tale Masouleh et al., Meccanica 46 (2011), section
3, and stand in the same working mode, B_iB_j is parallel to e2 (eqs. 7, 8): in the frame turned
by R_y(−θ) they have one common w. The equations F1, F2 of `forward.equations` then
fall into blocks, solved one after the other:

1. X, θ and w of the groups from F1 of their limbs: `forward.linkage`.
2. w of every free limb: w = b ± sqrt(ρ² − (X + s − a)²).
3. y, Z, φ from F2 of three legs, a planar 3-RPR: a polynomial of degree 6 in e^{iφ}.

Each block is polished by Newton's method on its own equations. A point (a, b) of a plane is taken
as a + ib, a − ib, which turn by e^{iθ} and e^{−iθ}; for complex points the two are independent.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.forward.columns import (
    FLAT,
    Index,
    both_roots,
    cramer,
    newton,
    square_root,
    told_apart,
)
from kinematics.mechanisms.five_rpur.forward.equations import (
    PHI,
    THETA,
    UNKNOWNS,
    Complex,
    W,
    X,
    Y,
    Z,
    conjugate,
)
from kinematics.mechanisms.five_rpur.forward.linkage import FAR, Found, Machine, planar, planar_step
from kinematics.mechanisms.five_rpur.forward.polynomial import modulus, roots

_ACCEPTED = 1e-6  # size of Newton's last step: halved each time where roots coincide


def solve(m: Machine, rho2: Complex | Array) -> tuple[Complex, Index]:
    """All finite solutions found, (10, M), and the column of ρ² (5, B) each belongs to.

    Of real lengths, only one of two conjugate solutions of stages 1 and 2 is worked out; the
    other's solutions are its conjugates. A solution that is not settled, as where several
    coincide, may be missing. Divisions by zero are meant to pass: callers silence them.
    """
    real = not np.iscomplexobj(rho2)
    groups = planar(m, rho2, real)
    step = planar_step(m, rho2, groups.owner)
    groups = groups.take(newton(groups.state, step) < _ACCEPTED)
    if real:
        groups = groups.take(groups.side() >= 0.0)
    legs = _free(m, rho2, groups)
    if real:
        legs = legs.take(legs.side() >= 0.0)
    u, owner, column = _platform(m, legs)
    if real:
        twins = np.flatnonzero((legs.side() > 0.0)[column])
        u = np.concatenate([u, conjugate(u[:, twins])], axis=1)
        owner = np.concatenate([owner, owner[twins]])
    return u, owner


# --- stages 2 and 3 --------------------------------------------------------------------------


def _free(m: Machine, rho2: Complex | Array, groups: Found) -> Found:
    """Stage 2: with w of the free limbs, all combinations of signs."""
    x, t = groups.state[:2]
    limbs = list(m.free)
    a, b = m.turned(t, limbs)
    big_p = x + m.s[limbs] - a
    half = square_root(rho2[limbs][:, groups.owner] - big_p * big_p)
    signs = list(product((1.0, -1.0), repeat=len(limbs)))
    state = [np.concatenate([groups.state, b + np.array(sign)[:, None] * half]) for sign in signs]
    return Found(np.concatenate(state, axis=1), np.tile(groups.owner, len(signs)))


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
            return np.asarray(u[0] * v[1] - u[1] * v[0])

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

    def place(self, f: Complex, problem: Index) -> Complex:
        """y + iZ, y − iZ and e^{iφ}, (3, N), of roots e^{iφ} of the problems' sextics (N,)."""
        tip, tip_c = self.tip * f, self.tip.conj() / f
        m, mc, n, nc = (u[1:] - u[0] for u in (tip, tip_c, self.n, self.nc))
        d, dc = m - n, mc - nc
        e = d * dc + self.link2[0] - self.link2[1:]
        one, two = dc[0] * d[1], d[0] * dc[1]
        v = (e[1] * d[0] - e[0] * d[1]) / (one - two)
        vc = (e[0] * dc[1] - e[1] * dc[0]) / (one - two)
        size, size_c = modulus(m) + modulus(n), modulus(mc) + modulus(nc)
        size = size_c[0] * size[1] + size[0] * size_c[1]
        flat = np.flatnonzero(~(modulus(one - two) > FLAT * size))
        if len(flat):  # d_2 ∥ d_3, or 0, leaves one equation, and two vectors of length l_1
            longer = np.where(modulus(d[0] * dc[0]) > modulus(d[1] * dc[1]), 0, 1)[flat]
            d, dc, e = (u[longer, flat] for u in (d, dc, e))
            both = 0.5 * (both_roots(e * e - 4.0 * self.link2[0] * d * dc) - e) / dc
            v[flat] = told_apart(both, v[flat], f[flat], problem[flat])
            vc[flat] = self.link2[0] / v[flat]
        return np.stack([v + self.n[0] - tip[0], vc + self.nc[0] - tip_c[0], f])

    def step(self, state: Complex, columns: Index) -> tuple[Complex, Array]:
        """Newton's step for those on F2 = Y² + q² − l² of the three legs."""
        v, vc, f = state
        tip, tip_c = self.tip * f, self.tip.conj() / f
        u, uc = v + tip - self.n[:, columns], vc + tip_c - self.nc[:, columns]
        tilt = 1j * (uc * tip - u * tip_c)
        dv, dvc, turned = cramer((uc, u, tilt), u * uc - self.link2)
        size = (modulus(dv) + modulus(dvc)) / (1.0 + modulus(v) + modulus(vc)) + modulus(turned)
        return np.stack([dv, dvc, 1j * f * turned]), size


def _platform(m: Machine, found: Found) -> tuple[Complex, Index, Index]:
    """Stage 3: solutions (10, M), their owners, and the columns that they come from."""
    legs = _Legs(m, found.state[2:])
    f = roots(legs.sextic())
    column = np.tile(np.arange(f.shape[1]), len(f))
    f = f.ravel()
    size = modulus(f)
    finite = (size < FAR) & (size > 1.0 / FAR)
    f, column = f[finite], column[finite]
    legs = legs.take(column)
    state = legs.place(f, column)
    settled = newton(state, legs.step) < _ACCEPTED
    column = column[settled]
    return (
        _configurations(m, found.state[:, column], state[:, settled]),
        found.owner[column],
        column,
    )


def _configurations(m: Machine, linkage: Complex, platform: Complex) -> Complex:
    """The unknowns of `forward.equations` from those of stages 1, 2 and of 3."""
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
    grouped = 2 + len(m.groups)
    newton(linkage[:grouped], planar_step(m, rho2, owner))
    limbs = list(m.free)
    a, b = m.turned(linkage[1], limbs)
    big_p = linkage[0] + m.s[limbs] - a
    both = both_roots(rho2[limbs][:, owner] - big_p * big_p) + b
    off = modulus(both - linkage[grouped:])
    linkage[grouped:] = np.where(off[0] <= off[1], *both)
    platform = np.stack([u[Y] + 1j * u[Z], u[Y] - 1j * u[Z], u[PHI]])
    newton(platform, _Legs(m, linkage[2:]).step)
    u[:] = _configurations(m, linkage, platform)
