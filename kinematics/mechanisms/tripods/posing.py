"""Poses (Z, tilt, azimuth) of both machines, and the one form in which both are solved.

In operation mode 2 the platform's quaternion is (c, s cos φ, s sin φ, 0), c, s = cos, sin θ/2, and
its torsion is zero; in mode 1 it is (0, s sin φ, −s cos φ, c), which is the same turned by π about
the platform's normal: R u_i of mode 1 is −R u_i of mode 2. So with k = ±h of the spherical joints
(σ = −1 in mode 1) both modes share their formulas.

That much is shared by every platform on three spherical joints that limbs hold in three planes
120° apart, as of a 3-RPS, a 3-SPR or a 3-PRS; `limbs` has what is particular to the first two. A
3-SPR is a 3-RPS held by its platform: its poses are the inverses of those of the 3-RPS with base
and platform exchanged. `Reduced` is the pose of the triangle with the spherical joints as the
triangle with the revolute joints sees it. Lengths mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.tripods import study
from kinematics.mechanisms.tripods.design import (
    mode_sign,
)
from kinematics.mechanisms.tripods.study import Values
from kinematics.screws.spatial import homogeneous, rigid

POSE = 3
"""Z (mm), tilt θ and azimuth φ (rad) of the axis about which the platform is tilted."""


class Triangles(Protocol):
    """What a platform's poses depend on: the design of a tripod, whatever its limbs.

    Attributes:
        base_radius, spherical_radius: circumradii of the base's and the spherical joints, mm.
        revolute_on_base: the planes in which limbs stay are fixed to the base, not to the platform.
    """

    @property
    def base_radius(self) -> float: ...
    @property
    def spherical_radius(self) -> float: ...
    @property
    def revolute_on_base(self) -> bool: ...


class Reduced(NamedTuple):
    """The spherical triangle seen from the revolute one, as zero-torsion form and altitude.

    Attributes:
        x0, x1, x2: (...,) with x0² + x1² + x2² = 1; both signs are the same pose.
        v: (...,) mm, the altitude of its centre.
    """

    x0: Values
    x1: Values
    x2: Values
    v: Values


# --- between the forms ---------------------------------------------------------------------


def read_poses(poses: ArrayLike) -> Array:
    """Poses (..., 3) as finite numbers.

    Raises:
        InputError: they are not.
    """
    return finite(poses, name="a pose", last=POSE)


def quaternion(poses: Array, mode: str) -> Array:
    """(..., 4) of length one, the paper's x (eq. 15 with the torsion of the mode)."""
    half = 0.5 * poses[..., 1]
    c, s = np.cos(half), np.sin(half)
    x1, x2 = s * np.cos(poses[..., 2]), s * np.sin(poses[..., 2])
    zero = np.zeros_like(c)
    parts = (c, x1, x2, zero) if mode_sign(mode) > 0 else (zero, x2, -x1, c)
    return np.stack(parts, axis=-1)


def reduce_poses(design: Triangles, poses: Array, mode: str) -> Reduced:
    """(Z, θ, φ) → the reduced form. Infinite or NaN v: no finite position has this altitude.

    Of a 3-SPR, Z = h1 s² sin θ sin 3φ − v cos θ: at θ = 90° the altitude is no longer free.
    """
    z, tilt, azimuth = (poses[..., n] for n in range(POSE))
    c, s = np.cos(0.5 * tilt), np.sin(0.5 * tilt)
    if design.revolute_on_base:
        return Reduced(c, s * np.cos(azimuth), s * np.sin(azimuth), z)
    sign = -mode_sign(mode)  # the inverse of mode 2 has its axis turned round
    lift = design.base_radius * s * s * np.sin(tilt) * np.sin(3.0 * azimuth) - z
    cosine = np.cos(tilt)
    with np.errstate(divide="ignore", invalid="ignore"):
        v = np.where(np.abs(cosine) < LEVEL, np.nan, lift / cosine)
    return Reduced(c, sign * s * np.cos(azimuth), sign * s * np.sin(azimuth), v)


ASIDE = 1e-8
"""rad: there the pose is as wrong by its tilt as its position is by rounding, some 1e-6 mm."""
LEVEL = 1e-12
"""|cos θ| below which the altitude of a 3-SPR says nothing of where it is."""


def to_study(design: Triangles, reduced: Reduced, mode: str) -> Values:
    """The Study parameters (..., 8) of the platform's pose; complex for complex ones."""
    x0, x1, x2, v = reduced
    zero = np.zeros_like(x0 * x1)
    k = mode_sign(mode) * design.spherical_radius
    parts = (x0, x1, x2, zero) if mode_sign(mode) > 0 else (zero, x2, -x1, x0)
    x = np.stack(np.broadcast_arrays(*parts), axis=-1)
    place = np.stack(
        np.broadcast_arrays(k * (x1 * x1 - x2 * x2), -2.0 * k * x1 * x2, v + zero), axis=-1
    )
    found = study.with_translation(x, place)
    return found if design.revolute_on_base else study.inverse(found)


def to_poses(design: Triangles, reduced: Reduced, mode: str) -> Array:
    """Real reduced poses → (..., 3): Z, tilt in [0, π], azimuth in (−π, π].

    At a tilt of 90° these three say nothing of where along its normal the platform of a 3-SPR
    stands, which they do as little as `ASIDE` from it: there the pose next to it is given.
    """
    x0, x1, x2, v = (np.asarray(part, dtype=float) for part in reduced)
    # x and −x are one pose; at a tilt of π, where that is one orientation seen from both sides,
    # the azimuth is the one in (−90°, 90°].
    flip = (x0 < 0.0) | ((x0 == 0.0) & ((x1 < 0.0) | ((x1 == 0.0) & (x2 < 0.0))))
    sign = np.where(flip, -1.0, 1.0)
    s = np.hypot(x1, x2)
    tilt = 2.0 * np.arctan2(s, sign * x0)
    sign = np.where((x0 == 0.0) | design.revolute_on_base, sign, -mode_sign(mode) * sign)
    azimuth = np.where(s > 0.0, np.arctan2(sign * x2, sign * x1), 0.0)
    azimuth = np.where(azimuth <= -np.pi, np.pi, azimuth)
    z = v
    if not design.revolute_on_base:
        off = tilt - 0.5 * np.pi
        near = 0.5 * np.pi + np.where(off < 0.0, -ASIDE, ASIDE)
        tilt = np.where(np.abs(off) < ASIDE, near, tilt)
        s = np.sin(0.5 * tilt)
        lift = design.base_radius * s * s * np.sin(tilt) * np.sin(3.0 * azimuth)
        z = lift - v * np.cos(tilt)
    return np.stack(np.broadcast_arrays(z, tilt, azimuth), axis=-1)


def positions(design: Triangles, poses: Array, mode: str) -> Array:
    """O′ (..., 3), mm: X and Y are parasitic motions, Z is the pose's.

    Where no finite position has this altitude, above the base's centre, so that it can be drawn.
    """
    found = study.translation(to_study(design, reduce_poses(design, poses, mode), mode))
    found = np.where(np.isfinite(found), found, 0.0)
    found[..., 2] = poses[..., 0]
    return np.asarray(found, dtype=float)


def transform(design: Triangles, poses: ArrayLike, mode: str | Sequence[str]) -> Array:
    """From platform to base coordinates: poses (..., 3) → (..., 4, 4); see `positions`.

    Args:
        mode: one for all poses, or one for each of (N, 3).
    """
    p = read_poses(poses)
    if not isinstance(mode, str):
        if p.ndim != 2 or len(p) != len(mode):
            raise InputError(f"{len(mode)} modes need as many poses, got an array {p.shape}")
        each = np.array(mode)
        found = np.empty((len(p), 4, 4))
        for one in sorted(set(mode)):
            found[each == one] = transform(design, p[each == one], one)
        return found
    return homogeneous(study.rotation(quaternion(p, mode)), positions(design, p, mode))


def placement(design: Triangles, poses: ArrayLike, mode: str) -> Array:
    """`transform` of poses (..., 3); NaN where no finite position has this altitude."""
    there = np.isfinite(reduce_poses(design, read_poses(poses), mode).v)
    return np.where(there[..., None, None], transform(design, poses, mode), np.nan)


def pose_from_transform(
    design: Triangles, matrix: ArrayLike, mode: str
) -> tuple[float, float, float]:
    """The pose of a mode with the given altitude and the nearest orientation.

    X and Y follow from the three coordinates, so those of ``matrix`` are left out of account. Of
    the orientations of the mode the one nearest in the Frobenius norm is taken.

    Raises:
        InputError: not 4x4, or its upper left part is not a rotation (to 1e-3).
    """
    from scipy.spatial.transform import Rotation  # slow to import

    r, place = rigid(matrix)
    x = np.roll(Rotation.from_matrix(r).as_quat(), 1)
    kept = x[[0, 1, 2]] if mode_sign(mode) > 0 else np.array([x[3], -x[2], x[1]])
    c, x1, x2 = kept if np.abs(kept).max() > 1e-9 else np.array([1.0, 0.0, 0.0])
    if c < 0.0:
        c, x1, x2 = -c, -x1, -x2
    s = float(np.hypot(x1, x2))
    azimuth = float(np.arctan2(x2, x1)) if s > 0.0 else 0.0
    return float(place[2]), float(2.0 * np.arctan2(s, c)), azimuth
