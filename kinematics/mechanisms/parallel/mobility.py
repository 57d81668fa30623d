"""How the platform can move: its degrees of freedom, in the field's words, and its coordinates.

The reference posture alone does not tell: there wrenches may be dependent that are not elsewhere.
So postures about it count, reached by random steps along what is free and closed again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.parallel.bonds import Bonds, moved
from kinematics.mechanisms.parallel.drives import Numbers

NAMES = ("x", "y", "z", "phi", "theta", "psi")
SYMBOLS = ("x", "y", "z", "φ", "θ", "ψ")
_PREFERENCE = np.array([0.1, 0.1, 0.0, 0.0, 0.0, 0.2])
_SAMPLES = 8
_STEP = (0.1, 0.15)  # rad, or parts of the characteristic length
_RANK = 1e-7
_STILL = 1e-9  # of rates: a coordinate that does not change
_SEARCHED = 0.5  # what coordinates lose from which others do not follow in closed form
_LEAST = 0.05  # of the least singular value of the rates of coordinates


@dataclass(frozen=True, eq=False)
class Mobility:
    """How the platform moves.

    Attributes:
        free: degrees of freedom.
        instantaneous: at the reference posture alone.
        redundant: how many of the limbs' wrenches say what others say already.
        words: as "3T2R" or "planar".
        group: "translation", "planar", "spherical" or "".
        postures: (N, 4, 4), the reference first.
        twists: (N, 6, free) bases of what is free, [v, ω L], orthonormal; of postures but the
            first one where that one has more.
    """

    free: int
    instantaneous: int
    redundant: int
    words: str
    group: str
    postures: Array
    twists: tuple[Array, ...]


def mobility(bonds: Bonds, reference: Array, length: float) -> Mobility:
    """The mobility about an assembled reference posture."""
    rng = np.random.default_rng(19)
    basis = _free(bonds, reference, length)
    count = basis.shape[1]
    part = rng.normal(size=(_SAMPLES, count))
    part *= rng.uniform(*_STEP, size=(_SAMPLES, 1)) / np.linalg.norm(part, axis=1, keepdims=True)
    scale = np.array([length, length, length, 1.0, 1.0, 1.0])
    tried = moved(np.broadcast_to(reference, (_SAMPLES, 4, 4)).copy(), part @ basis.T * scale)
    tried = bonds.closed(tried, length)
    there = tried[np.isfinite(tried).all(axis=(1, 2))]
    postures = np.concatenate([reference[None], there])
    bases = [basis, *(_free(bonds, t, length) for t in there)]
    free = min(base.shape[1] for base in bases)
    ordinary = [n for n, base in enumerate(bases) if base.shape[1] == free]
    twists = tuple(bases[n] for n in ordinary)
    words, group = _words(free, twists, postures[ordinary], length)
    redundant = bonds.count - (6 - free)
    return Mobility(free, count, redundant, words, group, postures[ordinary], twists)


def _free(bonds: Bonds, placement: Array, length: float) -> Array:
    """(6, d) orthonormal [v/L, ω] of the motions that the bonds leave."""
    if not bonds.count:
        return np.eye(6)
    rows = np.asarray(bonds.rows(placement)) / np.array([1.0, 1.0, 1.0, length, length, length])
    # Couples are unit ones: as they are, not by the length.
    size = np.linalg.norm(rows, axis=1, keepdims=True)
    _, values, right = np.linalg.svd(rows / np.where(size > 0.0, size, 1.0))
    return np.asarray(right[int((values > _RANK).sum()) :].T)


def _words(free: int, twists: tuple[Array, ...], postures: Array, length: float) -> tuple[str, str]:
    """The kind of motion, and its group."""
    if free == 6:
        return "6 degrees of freedom", ""
    if free == 0:
        return "no motion", ""
    turns = np.concatenate([basis[3:] for basis in twists], axis=1)
    values, directions = np.linalg.svd(turns)[1], np.linalg.svd(turns)[0]
    if values.max(initial=0.0) < _RANK:
        return f"{free}T: translations only", "translation"
    if (values[1:] < _RANK).all():
        axis = directions[:, 0]
        away = max(float(np.abs(axis @ basis[:3]).max()) for basis in twists)
        if away < _RANK and free == 3:
            return "planar: 2T1R", "planar"
        if free == 4:
            return "3T1R (Schoenflies)", ""
        return f"{free - 1}T1R", ""
    centre = _centre(twists, postures, length)
    if free <= 3 and centre:
        return "spherical", "spherical"
    rank = max(int((np.linalg.svd(basis[3:])[1] > _RANK).sum()) for basis in twists)
    pure = min(free - int((np.linalg.svd(basis[3:])[1] > _RANK).sum()) for basis in twists)
    if rank == free and pure == 0:
        return f"{free} degrees of freedom, like 1T2R: no pure translation", ""
    return f"{free - rank}T{rank}R", ""


def _centre(twists: tuple[Array, ...], postures: Array, length: float) -> bool:
    """Whether all motions turn about one point that stays: v of it vanishes."""
    rows, rights = [], []
    for basis, placement in zip(twists, postures, strict=True):
        for v, omega in zip(basis[:3].T, basis[3:].T, strict=True):
            x, y, z = omega
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            # v + ω × (c − p) = 0
            rows.append(cross)
            rights.append(cross @ placement[:3, 3] / length - v)
    matrix, right = np.concatenate(rows), np.concatenate(rights)
    point = np.linalg.lstsq(matrix, right)[0]
    return bool(np.abs(matrix @ point - right).max() < _RANK)


# --- coordinates ---------------------------------------------------------------------------


def angular_axes(angles: Numbers) -> Numbers:
    """E (..., 3, 3) with ω = E (φ̇, θ̇, ψ̇) of R = Rz(ψ) Ry(θ) Rx(φ), at angles (..., 3)."""
    theta, psi = angles[..., 1], angles[..., 2]
    ct, st, cp, sp = np.cos(theta), np.sin(theta), np.cos(psi), np.sin(psi)
    e = np.zeros((*ct.shape, 3, 3), dtype=ct.dtype)
    e[..., 0, 0], e[..., 1, 0], e[..., 2, 0] = cp * ct, sp * ct, -st
    e[..., 0, 1], e[..., 1, 1] = -sp, cp
    e[..., 2, 2] = 1.0
    return e


def angles_of(r: Array) -> Array:
    """(φ, θ, ψ) of rotations (..., 3, 3), θ in [−π/2, π/2]; φ = 0 where θ = ±π/2."""
    level = np.hypot(r[..., 0, 0], r[..., 1, 0])
    upright = level < 1e-12
    theta = np.arctan2(-r[..., 2, 0], level)
    psi = np.where(
        upright,
        np.arctan2(-r[..., 0, 1], r[..., 1, 1]),
        np.arctan2(r[..., 1, 0], r[..., 0, 0]),
    )
    phi = np.where(upright, 0.0, np.arctan2(r[..., 2, 1], r[..., 2, 2]))
    return np.stack([phi, theta, psi], axis=-1)


def rates(found: Mobility) -> Array:
    """(N, 6, d) rates of x/L, y/L, z/L, φ, θ, ψ on the bases of the twists."""
    turned = np.linalg.pinv(angular_axes(angles_of(found.postures[:, :3, :3])))
    twists = np.array(found.twists)
    return np.concatenate([twists[:, :3], turned @ twists[:, 3:]], axis=1)


def chosen(
    found: Mobility, solved: Callable[[tuple[int, ...]], bool] = lambda _: True
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The coordinates that tell a pose, and those that never change.

    Args:
        solved: whether the others follow in closed form from some: that is preferred.
    """
    by = rates(found)
    constant = tuple(np.flatnonzero((np.abs(by) < _STILL).all(axis=(0, 2))).tolist())
    best: tuple[float, tuple[int, ...]] | None = None
    for some in combinations(range(6), found.free):
        least = float(np.linalg.svd(by[:, some], compute_uv=False)[:, -1].min())
        if least < _LEAST and best is not None:
            continue
        score = (least if least >= _LEAST else least - 1.0) - 0.3 * float(
            _PREFERENCE[list(some)].sum()
        )
        if not solved(tuple(n for n in range(6) if n not in (*some, *constant))):
            score -= _SEARCHED
        if best is None or score > best[0] + 1e-9:
            best = score, some
    assert best is not None
    return best[1], constant
