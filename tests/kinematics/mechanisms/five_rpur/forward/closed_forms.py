"""The paper's closed forms for {A1A1}, {A1A2} and {MpA2}, corrected, for any placement.

Tale Masouleh et al., Meccanica 46 (2011), sections 3.1-3.3, and where noted their conference
paper (ICEE 2010). In every one of the three, θ follows from a cos θ + b sin θ = c, the U joints
B_i from θ, and φ from a polynomial of degree six in tan(φ/2). What differs from the print:

- Eq. 12 has the sign of its argument turned and lacks ±; eq. 25 lacks ±. See `_angles`.
- Eq. 13 holds for z_A5 = 0. See `_u_joints`.
- Eqs. 15-25 put A_1 = A_2 into the origin and C_3 = C_4 to s_34 = 0. See `a1a2`.
- Section 3.2 counts one solution for B_1 and B_2. There are two, so 96 solutions rather than 48:
  with A_1 and A_2 in one point, the line B_1B_2 is the same distance away on either side of it.
- The conference paper's eqs. 8, 9 are for t = tan(θ/2), and H = Δz² + Δx² − Δs².
- Section 3.3 gives no formula for θ; here is one, see `mpa2`.

This is to be read and to check `kinematics.mechanisms.five_rpur.forward.simplified` with, which
solves all nine designs, quicker and where solutions coincide too. Everything may be complex: of 96
solutions usually most are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.screws.spatial import wrap_angle

Complex = NDArray[np.complex128]
Number = complex | np.complex128

_INFINITE = 1e-9  # |1 + u²| of a root near u = ±i, where e^{iφ} is 0 or infinite


class ClosedForm(NamedTuple):
    """All solutions for one length vector, real and complex.

    Attributes:
        poses: (M, 5) x, y, z, φ, θ, mm and rad, complex.
        joints_b: (M, 5, 3) the U joints B_i in the base frame, mm, complex.
    """

    poses: Complex
    joints_b: Complex

    def real_poses(self, tolerance: float = 1e-6) -> Array:
        """Those poses (N, 5) that are real to within a tolerance, mm and rad; angles in (−π, π]."""
        unreal = np.abs(self.poses.imag).max(axis=1, initial=0.0)
        unreal = np.maximum(unreal, np.abs(self.joints_b.imag).max(axis=(1, 2), initial=0.0))
        real = self.poses[unreal < tolerance].real
        return np.concatenate([real[:, :3], wrap_angle(real[:, 3:])], axis=1)


class Linkage(NamedTuple):
    """Stage one: θ, and what is known of the U joints as x_B, z_B by limb (from 0)."""

    theta: Number
    joints_b: dict[int, tuple[Number, Number]]


def closed_form(design: FiveRPURDesign, joints: ArrayLike) -> ClosedForm:
    """All solutions of an {A1A1}, {A1A2} or {MpA2} design with each group in one working mode.

    Args:
        design: the arrangements may be made of any limbs and stand anywhere.
        joints: ρ_1 … ρ_5, mm.

    Returns:
        Solutions that coincide are repeated. Left out: θ that is free (self-motion, where a = b =
        c = 0 in a cos θ + b sin θ = c), and φ = π, where tan(φ/2) is infinite.

    Raises:
        InputError: the design is of another class; not five finite lengths.
    """
    rho = finite(joints, name="the joints", last=LIMBS)
    if rho.shape != (LIMBS,):
        raise InputError("closed forms are evaluated for one set of 5 joints at a time")
    stage = _CLOSED.get(arrangements(design).name)
    if stage is None or arrangements(design).reasons:
        raise InputError(f"closed forms are given for {', '.join(_CLOSED)} designs")
    poses: list[Complex] = []
    joints_b: list[Complex] = []
    with np.errstate(all="ignore"):
        for linkage in stage(design, rho):
            for theta, known in _with_free_limbs(design, rho, linkage):
                found = _poses(design, theta, known) if np.isfinite(known).all() else []
                poses += found
                joints_b += [known] * len(found)
    return ClosedForm(
        np.array(poses, dtype=complex).reshape(-1, 5),
        np.array(joints_b, dtype=complex).reshape(-1, LIMBS, 3),
    )


# --- θ and the U joints of the arrangements --------------------------------------------------


def a1a1(design: FiveRPURDesign, rho: Array) -> Iterator[Linkage]:
    """{A1A1}, section 3.1: 4 placements of B_12 and B_34, and 2 of θ for each.

    Eq. 11, the difference of eq. 5 for both arrangements:
    (x_B34 − x_B12) cos θ − (z_B34 − z_B12) sin θ = s_34 − s_12. So eq. 12, corrected:
    θ = atan2(z_B12 − z_B34, x_B34 − x_B12) ± arccos((s_34 − s_12)/sqrt(Δx² + Δz²)).
    """
    one, two = (group.limbs for group in arrangements(design).groups)
    (i, j), (k, m) = ((limbs[0] - 1, limbs[1] - 1) for limbs in (one, two))
    s = design.platform[:, 0]
    for b12, b34 in product(_circles(design, rho, i, j), _circles(design, rho, k, m)):
        dx, dz = b34[0] - b12[0], b34[1] - b12[1]
        for theta in _angles(dx, -dz, s[k] - s[i]):
            yield Linkage(theta, {i: b12, j: b12, k: b34, m: b34})


def a1a2(design: FiveRPURDesign, rho: Array) -> Iterator[Linkage]:
    """{A1A2}, section 3.2: 2 placements of B_34, 2 of θ and 2 of B_1 and B_2 for each.

    With (x_A, z_A) = A_1 = A_2 and s_34 of C_3 = C_4, eq. 24 is
    (x_B34 − x_A) cos θ − (z_B34 − z_A) sin θ = s_34 + (ρ_2² − ρ_1² + s_1² − s_2²)/(2(s_2 − s_1)),
    and eq. 25 has ±. B_1 is on its circle where eq. 5 wants it, on one side or on the other, as
    B_5 is by eq. 13; B_2 follows by eqs. 20, 21.
    """
    groups = {group.kind: group.limbs for group in arrangements(design).groups}
    (i, j), (k, m) = ((groups[kind][0] - 1, groups[kind][1] - 1) for kind in ("A2", "A1"))
    s = design.platform[:, 0]
    x_a, _, z_a = design.base[i]
    right = 0.5 * (rho[j] ** 2 - rho[i] ** 2 + s[i] ** 2 - s[j] ** 2) / (s[j] - s[i])  # eq. 22
    for b34 in _circles(design, rho, k, m):
        for theta in _angles(b34[0] - x_a, z_a - b34[1], s[k] + right):
            for b1 in _u_joints(design, rho, i, theta, k, b34):
                b2 = _along(b1, s[j] - s[i], theta)
                yield Linkage(theta, {i: b1, j: b2, k: b34, m: b34})


def mpa2(design: FiveRPURDesign, rho: Array) -> Iterator[Linkage]:
    """{MpA2}, section 3.3: the planar 3-RPR with linear base and platform, 4 placements.

    In the frame turned by R_y(−θ), B_i is at (c, h) from A_i = A_j with
    c = (ρ_j² − ρ_i² − σ²)/(2σ), σ = s_j − s_i, and h = ± sqrt(ρ_i² − c²): neither depends on θ.
    B_p is at (c + s_p − s_i, h), and A_p at D (cos ψ, sin ψ), ψ = θ + atan2(Δz, Δx); so
    |A_pB_p| = ρ_p reads 2D ((c + s_p − s_i) cos ψ + h sin ψ) = (c + s_p − s_i)² + h² + D² − ρ_p².
    """
    (group,) = arrangements(design).groups
    i, j = next(tuple(limb - 1 for limb in pair.limbs) for pair in group.pairs if pair.kind == "A2")
    (p,) = (limb - 1 for limb in group.limbs if limb - 1 not in (i, j))
    s = design.platform[:, 0]
    dx, _, dz = design.base[p] - design.base[i]
    distance = float(np.hypot(dx, dz))
    sigma = s[j] - s[i]
    c = 0.5 * (rho[j] ** 2 - rho[i] ** 2 - sigma**2) / sigma
    c_p = c + s[p] - s[i]
    for sign in (1.0, -1.0):
        h = sign * np.sqrt(complex(rho[i] ** 2 - c**2))
        right = 0.5 * (c_p**2 + h**2 + distance**2 - rho[p] ** 2) / distance
        for psi in _angles(c_p, h, right):
            theta = psi - np.arctan2(dz, dx)
            x, z = _from_turned(c, h, theta)
            b_i = design.base[i, 0] + x, design.base[i, 2] + z
            b_j, b_p = (_along(b_i, s[n] - s[i], theta) for n in (j, p))
            yield Linkage(theta, {i: b_i, j: b_j, p: b_p})


_CLOSED: dict[str, Callable[[FiveRPURDesign, Array], Iterator[Linkage]]] = {
    "{A1A1}": a1a1,
    "{A1A2}": a1a2,
    "{MpA2}": mpa2,
}


def _circles(design: FiveRPURDesign, rho: Array, i: int, j: int) -> list[tuple[Number, Number]]:
    """x, z of both intersections of the circles about A_i and A_j with radii ρ_i and ρ_j."""
    (x, _, z), (dx, _, dz) = design.base[i], design.base[j] - design.base[i]
    distance2 = dx**2 + dz**2
    along = 0.5 * (rho[i] ** 2 - rho[j] ** 2 + distance2) / distance2
    across = np.sqrt(complex(rho[i] ** 2 / distance2 - along**2))
    return [(x + along * dx - side * dz, z + along * dz + side * dx) for side in (across, -across)]


def _angles(a: Number, b: Number, c: Number) -> tuple[Number, Number]:
    """Both θ with a cos θ + b sin θ = c: θ = atan2(b, a) ± arccos(c/sqrt(a² + b²)).

    For complex a and b, atan2(b, a) is −i log((a + ib)/sqrt(a² + b²)).
    """
    length = np.sqrt(complex(a * a + b * b))
    middle = -1j * np.log((a + 1j * b) / length)
    half = np.arccos(c / length + 0j)
    return middle + half, middle - half


def _u_joints(
    design: FiveRPURDesign, rho: Array, i: int, theta: Number, k: int, b_k: tuple[Number, Number]
) -> list[tuple[Number, Number]]:
    """x, z of B_i where B_k is known, eqs. 13 and 14 for any A_i.

    𝓛 = x_Bk cos θ − z_Bk sin θ + s_i − s_k, b = x_A sin θ + z_A cos θ,
    x_B = x_A sin² θ + z_A sin θ cos θ + 𝓛 cos θ ± sin θ sqrt(ρ² − (x_A cos θ − z_A sin θ − 𝓛)²),
    z_B = −𝓛 sin θ + cos θ (b ± sqrt(…)), with the same sign.
    """
    c, s = np.cos(theta), np.sin(theta)
    x_a, _, z_a = design.base[i]
    ell = b_k[0] * c - b_k[1] * s + design.platform[i, 0] - design.platform[k, 0]
    root = np.sqrt(complex(rho[i] ** 2 - (x_a * c - z_a * s - ell) ** 2))
    return [
        (
            x_a * s**2 + z_a * s * c + ell * c + s * half,
            -ell * s + c * (x_a * s + z_a * c + half),
        )
        for half in (root, -root)
    ]


def _along(b: tuple[Number, Number], offset: float, theta: Number) -> tuple[Number, Number]:
    """x, z of the point that is ``offset`` from b along e2 (eqs. 7, 8; 20, 21)."""
    return b[0] + offset * np.cos(theta), b[1] - offset * np.sin(theta)


def _from_turned(x: Number, z: Number, theta: Number) -> tuple[Number, Number]:
    c, s = np.cos(theta), np.sin(theta)
    return x * c + z * s, z * c - x * s


# --- the free limbs, φ and the pose ----------------------------------------------------------


def _with_free_limbs(
    design: FiveRPURDesign, rho: Array, linkage: Linkage
) -> Iterator[tuple[Number, Complex]]:
    """θ and all five B_i (5, 3), with both solutions of eq. 13 for every free limb."""
    theta, known = linkage
    k, b_k = next(iter(known.items()))
    free = [i for i in range(LIMBS) if i not in known]
    for sides in product(*(_u_joints(design, rho, i, theta, k, b_k) for i in free)):
        b = np.empty((LIMBS, 3), dtype=complex)
        b[:, 1] = design.base[:, 1]
        for i, (x, z) in [*known.items(), *zip(free, sides, strict=True)]:
            b[i, 0], b[i, 2] = x, z
        yield theta, b


def _poses(design: FiveRPURDesign, theta: Number, b: Complex) -> list[Complex]:
    """The poses of given θ and B_i: the six φ, and y, z of the frame turned by R_y(−θ) for each.

    Three of the circles that C_k describes about B_k in planes normal to e2 (conference paper,
    eq. 12) are all that is needed. With d_k the vector from B_1C_1 to B_kC_k, k = 2, 3, and
    v = B_1C_1: 2 v·d_k = l_k² − l_1² − |d_k|² gives v, and |v|² = l_1² the polynomial.
    """
    c, s = np.cos(theta), np.sin(theta)
    x_b, w = b[:, 0] * c - b[:, 2] * s, b[:, 0] * s + b[:, 2] * c
    legs = _three_legs(design, w)
    first = legs[0]
    m = design.platform[legs][:, 1:]
    n = np.stack([b[legs, 1], w[legs]], axis=1)
    link2 = design.link[legs] ** 2
    # d and the right sides times 1 + u², u = tan(φ/2): polynomials of degree 2, rising powers.
    one, cosine, sine = (np.array(v, dtype=complex) for v in ([1, 0, 1], [1, 0, -1], [0, 2, 0]))
    d, right = [], []
    for k in (1, 2):
        (my, mz), (ny, nz) = m[k] - m[0], n[k] - n[0]
        d.append((my * cosine - mz * sine - ny * one, my * sine + mz * cosine - nz * one))
        square = my * my + mz * mz + ny * ny + nz * nz
        mixed = (my * ny + mz * nz) * cosine + (my * nz - mz * ny) * sine
        right.append(0.5 * ((link2[k] - link2[0] - square) * one + 2.0 * mixed))
    mul = polynomial.polymul
    across = mul(d[0][0], d[1][1]) - mul(d[0][1], d[1][0])
    v_y = mul(right[0], d[1][1]) - mul(right[1], d[0][1])
    v_z = mul(right[1], d[0][0]) - mul(right[0], d[1][0])
    octic = mul(v_y, v_y) + mul(v_z, v_z) - link2[0] * mul(across, across)
    sextic, _ = polynomial.polydiv(octic, one)  # 1 + u² is a factor
    answer = []
    for u in polynomial.polyroots(sextic):
        if abs(1.0 + u * u) < _INFINITE * (1.0 + abs(u) ** 2):
            continue
        y, z = (polynomial.polyval(u, v) / polynomial.polyval(u, across) for v in (v_y, v_z))
        phi = 2.0 * np.arctan(u)
        cf, sf = np.cos(phi), np.sin(phi)
        (my, mz), (ny, nz) = m[0], n[0]
        x = x_b[first] - design.platform[first, 0]
        place = _from_turned(x, z + nz - (sf * my + cf * mz), theta)
        answer.append(np.array([place[0], y + ny - (cf * my - sf * mz), place[1], phi, theta]))
    return answer


def _three_legs(design: FiveRPURDesign, w: Complex) -> list[int]:
    """One limb of each group and the free ones: three, as the limbs of a group are one leg."""
    others = {i - 1 for group in arrangements(design).groups for i in group.limbs[1:]}
    return [i for i in range(len(w)) if i not in others]
