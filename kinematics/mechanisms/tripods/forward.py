"""Forward kinematics: all 16 solutions, 8 in each operation mode, for given limb lengths.

Each mode is solved in closed form by `conics` as complex numbers; only then are the real ones told
from the others. Solutions come in pairs, mirrored by the plane of the triangle that carries the
revolute joints: Z changes its sign, the tilt stays, the azimuth turns by π in mode 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.solutions import ForwardSolutions, SelfMotion
from kinematics.arrays import Array
from kinematics.facets.forward import ForwardFacet, Found
from kinematics.mechanisms.tripods import conics, posing
from kinematics.mechanisms.tripods.conics import Complex
from kinematics.mechanisms.tripods.design import MODES, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import limb_lengths
from kinematics.mechanisms.tripods.posing import Reduced

EXPECTED = 16
_EACH = 8  # in one operation mode
_REAL = 1e-9  # largest imaginary part, relative, of what is real but for rounding
_SAME = 3e-7  # distance, relative, of solutions that are one, where no limb is short
_FAR = 1e6  # beyond it a solution is at infinity
_MISS = 1e-12  # what a solution may leave of the equations, relative
_METHOD = "two conics a mode in closed form, polished"


class Forward(ForwardFacet[TripodDesign]):
    """``roots`` are Study parameters (8, 16), complex, mode 1 first, mirror pairs side by side."""

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        return True

    def solve(self, joints: Array, *, mixed_modes: bool) -> list[ForwardSolutions]:
        design = self.design
        h = design.revolute_radius / design.spherical_radius
        scaled = joints / design.spherical_radius
        shortest = np.sqrt(np.minimum(scaled.min(axis=-1), 1.0))
        told = []
        for mode in MODES:
            r = conics.roots(h, mode_sign(mode), scaled)
            points = np.stack([r.x0, r.x1, r.x2, r.v], axis=-1)
            each = zip(points, r.miss, _SAME * shortest, strict=True)
            told.append(_of_mode(design, joints, mode, [_distinct(*one) for one in each], r.curve))
        return self.answers([_found(design, *one) for one in zip(joints, *told, strict=True)])


def mirrored(design: TripodDesign, poses: ArrayLike, mode: str) -> Array:
    """The other pose of each pair, (..., 3): the same limb lengths, v → −v."""
    p = posing.read_poses(poses)
    x0, x1, x2, v = posing.reduce_poses(design, p, mode)
    return posing.to_poses(design, Reduced(x0, -x1, -x2, -v), mode)


# --- inside --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Distinct:
    """The solutions of one mode: (n, 4) complex, how often each counts, which are real."""

    points: Complex
    multiplicity: NDArray[np.intp]
    real: NDArray[np.bool_]
    everything: Complex

    @property
    def count(self) -> int:
        return int(self.multiplicity.sum())


def _distinct(points: Complex, miss: Array, near: float) -> _Distinct:
    """Join those that coincide but for rounding; leave out those at infinity.

    Double solutions are known to the root of what rounding leaves of the shortest limb.
    """
    with np.errstate(invalid="ignore"):
        size = np.abs(points).max(axis=-1)
    good = np.isfinite(size) & (size < _FAR) & (miss < _MISS)
    points = points[good]
    both = np.stack([points * np.array([s, s, s, 1.0]) for s in (1.0, -1.0)])
    apart = np.abs(both[:, :, None] - points[None, None]).max(axis=-1).min(axis=0)
    alike = apart <= near * (1.0 + np.abs(points).max(axis=-1, initial=0.0))
    left = np.ones(len(points), dtype=bool)
    joined, counts = [], []
    for n in range(len(points)):
        if not left[n]:
            continue
        group = np.flatnonzero(alike[n] & left)
        left[group] = False
        turn = np.where(
            np.abs(both[0, group] - points[n]).max(axis=-1)
            <= np.abs(both[1, group] - points[n]).max(axis=-1),
            1.0,
            -1.0,
        )
        same = points[group].copy()
        same[:, :3] *= turn[:, None]
        joined.append(same.mean(axis=0))
        counts.append(len(group))
    one = np.array(joined, dtype=complex).reshape(-1, 4)
    number = np.array(counts, dtype=np.intp)
    # Solutions that coincide are real where they are so but for what tells them apart.
    bound = np.where(number > 1, near, _REAL) * (1.0 + np.abs(one).max(axis=-1, initial=0.0))
    real = (np.abs(one.imag) <= bound[:, None]).all(axis=-1)
    return _Distinct(one, number, real, points)


class _Told(NamedTuple):
    """The solutions of one mode: of the real ones poses (n, 3), and residuals (n,) mm; all as Study
    parameters (m, 8).
    """

    found: _Distinct
    curve: bool
    poses: Array
    residual: Array
    roots: Complex


def _of_mode(
    design: TripodDesign, rho: Array, mode: str, sets: list[_Distinct], curves: NDArray[np.bool_]
) -> list[_Told]:
    """For B length vectors (B, 3) at once, since the arrays of each are short."""
    radius = design.spherical_radius
    x0, x1, x2, v = np.concatenate([one.points[one.real].real for one in sets]).T
    norm = np.sqrt(x0 * x0 + x1 * x1 + x2 * x2)
    poses = posing.to_poses(design, Reduced(x0 / norm, x1 / norm, x2 / norm, radius * v), mode)
    counts = [int(one.real.sum()) for one in sets]
    # Lengths keep digits that the joints' places lose where limbs are short.
    off = limb_lengths(design, poses, mode) - np.repeat(rho, counts, axis=0)
    off = np.abs(off).max(axis=-1, initial=0.0)
    a, b, c, d = np.concatenate([one.everything for one in sets]).T
    roots = posing.to_study(design, Reduced(a, b, c, radius * d), mode)
    each = [np.split(values, np.cumsum(counts)[:-1]) for values in (poses, off)]
    whole = np.split(roots, np.cumsum([len(one.everything) for one in sets])[:-1])
    return list(map(_Told, sets, curves.tolist(), *each, whole))


def _found(design: TripodDesign, rho: Array, *both: _Told) -> Found:
    """Both modes' solutions at lengths (3,)."""
    sets, curve = [told.found for told in both], tuple(told.curve for told in both)
    count, motions = sum(one.count for one in sets), _self_motions(design, rho, curve)
    complete = count == EXPECTED and not any(curve)
    complete &= all(_closed(one.everything) for one in sets)
    notes = []
    if count < EXPECTED and not motions:
        notes.append(
            f"{EXPECTED - count} of {EXPECTED} solutions are at infinity for these lengths."
        )
    elif not complete and not motions:
        notes.append("Solutions nearly coincide, so that they may not be told apart rightly.")
    return Found(
        joints=rho,
        poses=np.concatenate([told.poses for told in both]),
        modes=tuple(mode for mode, told in zip(MODES, both, strict=True) for _ in told.poses),
        multiplicity=np.concatenate([one.multiplicity[one.real] for one in sets]),
        roots=np.concatenate([told.roots for told in both]).T,
        count=count,
        expected=EXPECTED,
        complete=complete,
        method=_METHOD,
        notes=tuple(notes),
        self_motions=motions,
        residual=np.concatenate([told.residual for told in both]),
    )


def _closed(points: Complex) -> bool:
    """The conjugate of every solution is a solution."""
    if not len(points):
        return True
    other = np.stack([points * np.array([s, s, s, 1.0]) for s in (1.0, -1.0)]).conj()
    apart = np.abs(other[:, :, None] - points[None, None]).max(axis=-1).min(axis=(0, 2))
    return bool((apart <= 1e-6 * (1.0 + np.abs(points).max(axis=-1))).all())


def _self_motions(
    design: TripodDesign, rho: Array, curve: tuple[bool, ...]
) -> tuple[SelfMotion, ...]:
    """Equal limbs where the spherical triangle is twice the revolute one leave a curve free.

    There r² = D0 for all limbs wherever v = −k Im ζ³/x0 and (E + k²) q − E = k² (Re ζ³)²,
    E = D0 − (k − h)², k = 2 h. The pose given has Re ζ³ = 0.
    """
    found = []
    for mode, free in zip(MODES, curve, strict=True):
        k, h = mode_sign(mode) * design.spherical_radius, design.revolute_radius
        e = float((rho**2).mean()) - (k - h) ** 2
        if not free or e <= 0.0:
            continue
        q = e / (e + k * k)
        s = float(np.sqrt(q))
        azimuth = np.pi / 6.0
        x0 = float(np.sqrt(1.0 - q))
        lift = -k * s**3 / x0
        reduced = Reduced(
            np.array(x0),
            np.array(s * np.cos(azimuth)),
            np.array(s * np.sin(azimuth)),
            np.array(lift),
        )
        pose = posing.to_poses(design, reduced, mode)
        found.append(
            SelfMotion(
                tuple(pose.tolist()),
                mode,
                free_direction(design, pose, mode),
                "With three equal limbs and a triangle of spherical joints twice as large as that "
                f"of the revolute ones, the platform stays free in operation mode {mode} although "
                "all actuators are locked.",
            )
        )
    return tuple(found)


def free_direction(design: TripodDesign, pose: Array, mode: str) -> tuple[float, ...]:
    """d(Z, θ, φ) of unit length, angles times h2, that changes the limb lengths least."""
    length = design.platform_radius
    step = 1e-6
    scale = np.array([length, 1.0, 1.0]) * step
    up, down = (limb_lengths(design, pose + sign * np.diag(scale), mode) for sign in (1.0, -1.0))
    slopes = (up - down).T / (2.0 * scale) / np.array([1.0, length, length])
    direction = np.linalg.svd(slopes)[2][-1] / np.array([1.0, length, length])
    return tuple(float(v) for v in direction)
