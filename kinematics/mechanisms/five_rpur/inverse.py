"""Inverse kinematics of the 5-RPUR: actuator lengths, joint points and reasons, for batches.

In the base frame turned by R_y(−θ), with (X, Y, Z) = C_i − A_i, the second link is
C − B = (0, Y, σ h), h = sqrt(l² − Y²), and the actuator ρ = hypot(X, Z − σ h); σ = ±1 is the
working mode of the limb (Tale Masouleh et al., Meccanica 46 (2011), eqs. 3-6 and 27).

Poses are (x, y, z, φ, θ), mm and rad. A limb closes where |Y| ≤ l; what lies beyond a stroke is
still computed, what cannot close is NaN.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.bounds import Bound, decimals, limb_bounds
from kinematics.answers.modes import one_of
from kinematics.answers.solutions import InverseSolutions
from kinematics.arrays import Array, finite, frozen
from kinematics.errors import InputError
from kinematics.facets.inverse import InverseFacet
from kinematics.mechanisms.five_rpur.design import (
    JOINT_SYMBOLS,
    LIMBS,
    MODES,
    SUBSCRIPTS,
    FiveRPURDesign,
)
from kinematics.screws.spatial import homogeneous, rotation_x, rotation_y

STROKE_SLACK = 1e-9
"""mm by which rounding may carry an actuator over its stroke end."""
LINK_SLACK = 1e-13
"""Part of l by which rounding may carry |Y| over l."""
SNAP = 1e-10
"""mm within which a length is the one that was wanted."""

_Components = tuple[Array, Array, Array]

_CHUNK = 4096  # poses at a time, so that the temporaries stay in the cache


# --- lengths -------------------------------------------------------------------------------


def limb_lengths(design: FiveRPURDesign, poses: ArrayLike) -> Array:
    """Actuator lengths in both working modes of every limb.

    Args:
        poses: (..., 5) mm and rad.

    Returns:
        (..., 5, 2) mm, sign + first; NaN where the limb cannot close (|Y| > l).

    Raises:
        InputError: not finite numbers, or not five a pose.
    """
    flat, shape = _flat(poses)
    lengths = np.empty((len(flat), LIMBS, 2))
    for part in _chunks(len(flat)):
        lengths[part] = _both_lengths(design, limb_vectors(design, flat[part]))
    return frozen(lengths.reshape(*shape, LIMBS, 2))


def inverse(design: FiveRPURDesign, poses: ArrayLike) -> InverseSolutions:
    """All working modes of the design, in their order, of poses (..., 5) in mm and rad.

    Raises:
        InputError: not finite numbers, or not five a pose.
    """
    flat, shape = _flat(poses)
    count, modes = len(flat), design.modes
    pick = _mode_pick(modes)
    exists = np.isin(MODES, modes)
    joints = np.empty((count, len(modes), LIMBS))
    within = np.empty((count, len(modes)), dtype=bool)
    residual = np.empty(count)
    for part in _chunks(count):
        offsets = limb_vectors(design, flat[part])
        lengths = _both_lengths(design, offsets)
        np.take(lengths.reshape(-1, 2 * LIMBS), pick, axis=1, out=joints[part], mode="clip")
        within[part] = _all_modes(_within(design, lengths))[:, exists]
        residual[part] = _worst_residual(design, flat[part], offsets, lengths)
    return InverseSolutions(
        modes=modes,
        joints=frozen(joints.reshape(*shape, len(modes), LIMBS)),
        within_stroke=frozen(within.reshape(*shape, len(modes))),
        residual=frozen(residual.reshape(shape)),
    )


class RPURInverse(InverseFacet[FiveRPURDesign]):
    """All working modes at once, from the ten lengths that the limbs can have."""

    def __call__(self, poses: ArrayLike) -> InverseSolutions:
        return inverse(self.design, poses)

    def inside(self, poses: ArrayLike, modes: Iterable[str] | None = None) -> NDArray[np.bool_]:
        return inside(self.design, poses, modes)


def inside(
    design: FiveRPURDesign, poses: ArrayLike, modes: Iterable[str] | None = None
) -> NDArray[np.bool_]:
    """Whether poses (..., 5) can be held within all strokes in one of ``modes`` (None: of all).

    Returns:
        (...) bool; the workspace as a membership test.

    Raises:
        InputError: not finite numbers, or a mode that the design has not.
    """
    flat, shape = _flat(poses)
    wanted = chosen(design, [modes] if isinstance(modes, str) else modes)
    picks = None if wanted is None else _mode_pick(wanted)
    answer = np.empty(len(flat), dtype=bool)
    for part in _chunks(len(flat)):
        ok = _within(design, _both_lengths(design, limb_vectors(design, flat[part])))
        if picks is None:
            answer[part] = np.all(np.any(ok, axis=2), axis=1)
        else:
            picked: NDArray[np.bool_] = ok.reshape(-1, 2 * LIMBS)[:, picks]
            answer[part] = np.any(np.all(picked, axis=2), axis=1)
    return frozen(answer.reshape(shape))


def signs(mode: str | ArrayLike, design: FiveRPURDesign | None = None) -> Array:
    """The signs σ_i of working modes: "+-+++" → (5,), or ±1 numbers (..., 5) as they are.

    Raises:
        InputError: not one sign for each of the five limbs; a mode that the design has not.
    """
    if isinstance(mode, str):
        known = one_of(mode, MODES)
        for limbs in () if design is None else design.merged_joints:
            if len({mode[i - 1] for i in limbs}) > 1:
                *most, last = limbs
                raise InputError(
                    f"there is no working mode {mode}: limbs {', '.join(map(str, most))} and "
                    f"{last} share a U joint, so that they have one sign"
                )
        return np.array(known.sigma)
    values = finite(mode, name="the signs of a working mode", last=LIMBS)
    if not (np.abs(values) == 1.0).all():
        raise InputError("the signs of a working mode must be +1 or -1")
    return values


def chosen(design: FiveRPURDesign, modes: Iterable[str] | None) -> tuple[str, ...] | None:
    """The working modes that a question is about; None where it is about all 32.

    Args:
        modes: some of the design's; None for all that it has.

    Raises:
        InputError: a mode that the design has not.
    """
    if modes is None:
        return design.modes if design.merged_joints else None
    wanted = tuple(modes)
    for mode in wanted:
        signs(mode, design)
    return wanted


# --- one mode: joints, margins, residuals --------------------------------------------------

LIMITS = limb_bounds(JOINT_SYMBOLS, links=[f"l{mark}" for mark in SUBSCRIPTS])


def joints_of(design: FiveRPURDesign, poses: ArrayLike, mode: str) -> Array:
    """Actuator lengths (..., 5) mm of poses (..., 5) in one working mode; NaN: cannot close."""
    flat, sigma, shape = _broadcast(design, poses, mode)
    x, y, z = limb_vectors(design, flat)
    with np.errstate(invalid="ignore", over="ignore"):
        lengths = np.hypot(x, z - sigma * _height(design, y))
    return np.asarray(lengths.T.reshape(*shape, LIMBS))


def margins(design: FiveRPURDesign, poses: Array, joints: Array) -> Array:
    """How far poses (..., 5) with lengths (..., 5) are from each of `LIMITS`, (..., 15) mm."""
    y = limb_vectors(design, poses.reshape(-1, 5))[1].T.reshape(joints.shape)
    room = (design.link - np.abs(y), joints - design.stroke[:, 0], design.stroke[:, 1] - joints)
    return np.stack(room, axis=-1).reshape(*joints.shape[:-1], len(LIMITS))


def why_not(bound: Bound, link: float, amount: float) -> str:
    """Why a limb cannot close."""
    digits = decimals(amount)
    return (
        f"limb {bound.limb} cannot reach: its platform point lies {amount:.{digits}f} mm "
        f"beyond the link length {bound.joint} = {link:g} mm along e₁ "
        f"(|Y| = {link + amount:.{digits}f} mm)"
    )


# --- points and frames ---------------------------------------------------------------------


def joint_points(
    design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike
) -> tuple[Array, Array, Array]:
    """A, B and C of every limb in the base frame.

    Args:
        poses: (..., 5) mm and rad.
        modes: one mode as "+-+++" for all poses, or signs ±1 (..., 5) that broadcast with them.

    Returns:
        Three arrays (..., 5, 3) mm; real beyond the strokes too, B is NaN where a limb cannot
        close.
    """
    flat, sigma, shape = _broadcast(design, poses, modes)
    elbow = _elbows(design, flat, limb_vectors(design, flat), sigma)
    tip = _tips(design, flat)
    out = (*shape, LIMBS, 3)
    base = np.broadcast_to(design.base, out).copy()
    return (
        frozen(base),
        frozen(np.stack(elbow, axis=-1).swapaxes(0, 1).reshape(out)),
        frozen(np.stack(tip, axis=-1).swapaxes(0, 1).reshape(out)),
    )


def closure_residual(
    design: FiveRPURDesign, poses: ArrayLike, modes: str | ArrayLike, joints: ArrayLike
) -> Array:
    """How far each limb is from closing with the given lengths, (..., 5) mm.

    The largest of | |B−A| − ρ |, | |C−B| − l |, |(C−B)·e2| and |y_B − y_A| (eqs. 3-5), in the
    base frame; NaN where a limb cannot close.
    """
    flat, sigma, shape = _broadcast(design, poses, modes)
    rho = np.broadcast_to(np.asarray(joints, dtype=float), (*shape, LIMBS)).reshape(-1, LIMBS).T
    elbows = _elbows(design, flat, limb_vectors(design, flat), sigma)
    residual = _residual(design, flat[:, 4], elbows, _tips(design, flat), rho)
    return frozen(residual.T.reshape(*shape, LIMBS))


def transform(poses: ArrayLike) -> Array:
    """From platform to base coordinates: poses (..., 5) → (..., 4, 4), Q by eq. 1."""
    p = finite(poses, name="a pose", last=5)
    return homogeneous(_platform_rotation(p), p[..., :3])


# --- inside --------------------------------------------------------------------------------


def _mode_pick(modes: Iterable[str]) -> NDArray[np.intp]:
    """Where the limbs' lengths of each mode stand in the 10 of a pose, (M, 5)."""
    return np.array(
        [[2 * i + (sign == "-") for i, sign in enumerate(mode)] for mode in modes], dtype=np.intp
    ).reshape(-1, LIMBS)


def _flat(poses: object) -> tuple[Array, tuple[int, ...]]:
    array = finite(poses, name="a pose", last=5)
    return array.reshape(-1, 5), array.shape[:-1]


def _chunks(count: int) -> Iterator[slice]:
    return (slice(k, min(k + _CHUNK, count)) for k in range(0, count, _CHUNK))


def limb_vectors(design: FiveRPURDesign, poses: Array) -> _Components:
    """C_i − A_i in the frame turned by R_y(−θ): X, Y, Z, each (5, n), of poses (n, 5)."""
    r = design.base.T[:, :, None]
    s = design.platform.T[:, :, None]
    px, py, pz, phi, theta = poses.T
    c, sn = np.cos(theta), np.sin(theta)
    cf, sf = np.cos(phi), np.sin(phi)
    dx, dz = px - r[0], pz - r[2]
    return (
        dx * c - dz * sn + s[0],
        py - r[1] + s[1] * cf - s[2] * sf,
        dx * sn + dz * c + s[1] * sf + s[2] * cf,
    )


def _height(design: FiveRPURDesign, y: Array) -> Array:
    """h = sqrt(l² − Y²), (5, n); NaN where |Y| > l."""
    link = design.link[:, None]
    distance = np.abs(y)
    with np.errstate(invalid="ignore", over="ignore"):
        h = np.sqrt((link - distance) * (link + distance))
    edge = np.isnan(h) & (distance <= link * (1.0 + LINK_SLACK))
    if edge.any():
        h[edge] = 0.0
    return h


def _both_lengths(design: FiveRPURDesign, offsets: _Components) -> Array:
    """(n, 5, 2) from X, Y, Z, each (5, n)."""
    x, y, z = offsets
    h = _height(design, y)
    lengths = np.empty((2, *x.shape))
    with np.errstate(invalid="ignore", over="ignore"):
        np.hypot(x, z - h, out=lengths[0])
        np.hypot(x, z + h, out=lengths[1])
    return lengths.transpose(2, 1, 0)


def _within(design: FiveRPURDesign, lengths: Array) -> NDArray[np.bool_]:
    low, high = design.stroke[:, :1] - STROKE_SLACK, design.stroke[:, 1:] + STROKE_SLACK
    return np.asarray((lengths >= low) & (lengths <= high))


def _broadcast(
    design: FiveRPURDesign, poses: object, modes: str | ArrayLike
) -> tuple[Array, Array, tuple[int, ...]]:
    """Poses (n, 5), signs (5, n) or (5, 1), and the common leading shape."""
    p = finite(poses, name="a pose", last=5)
    sigma = signs(modes, design)
    if sigma.ndim == 1:
        return p.reshape(-1, 5), sigma[:, None], p.shape[:-1]
    shape = np.broadcast_shapes(p.shape[:-1], sigma.shape[:-1])
    flat = np.broadcast_to(p, (*shape, 5)).reshape(-1, 5)
    return flat, np.broadcast_to(sigma, (*shape, LIMBS)).reshape(-1, LIMBS).T, shape


def _elbows(
    design: FiveRPURDesign, poses: Array, offsets: _Components, sigma: Array
) -> _Components:
    """x, y, z of B_i in the base frame, each (5, n); all NaN where the limb cannot close."""
    x, y, z = offsets
    w = z - sigma * _height(design, y)
    x = x + 0.0 * w
    c, s = np.cos(poses[:, 4]), np.sin(poses[:, 4])
    r = design.base.T[:, :, None]
    return r[0] + c * x + s * w, r[1] + 0.0 * w, r[2] - s * x + c * w


def _tips(design: FiveRPURDesign, poses: Array) -> _Components:
    """x, y, z of C_i = p + Q s'_i (eq. 6), each (5, n)."""
    sx, sy, sz = design.platform.T[:, :, None]
    px, py, pz, phi, theta = poses.T
    c, s, cf, sf = np.cos(theta), np.sin(theta), np.cos(phi), np.sin(phi)
    up = sf * sy + cf * sz
    return px + c * sx + s * up, py + cf * sy - sf * sz, pz - s * sx + c * up


def _residual(
    design: FiveRPURDesign, theta: Array, elbows: _Components, tips: _Components, rho: Array
) -> Array:
    """The largest violation of eqs. 3-5 and of y_B = y_A, (5, n)."""
    bx, by, bz = elbows
    rx, ry, rz = design.base.T[:, :, None]
    vx, vy, vz = (tip - elbow for tip, elbow in zip(tips, elbows, strict=True))
    with np.errstate(over="ignore"):
        worst: Array = np.abs(np.sqrt((bx - rx) ** 2 + (bz - rz) ** 2) - rho)
        link = np.sqrt(vx * vx + vy * vy + vz * vz) - design.link[:, None]
    across = vx * np.cos(theta) - vz * np.sin(theta)
    for part in (link, across, by - ry):
        np.maximum(worst, np.abs(part), out=worst)
    return worst


def _worst_residual(
    design: FiveRPURDesign, poses: Array, offsets: _Components, lengths: Array
) -> Array:
    """(n,) over both modes of all limbs, NaN where a limb, hence every mode, cannot close."""
    tips = _tips(design, poses)
    plus, minus = (
        _residual(
            design,
            poses[:, 4],
            _elbows(design, poses, offsets, np.full((LIMBS, 1), sign)),
            tips,
            lengths[..., k].T,
        ).max(axis=0)
        for k, sign in enumerate((1.0, -1.0))
    )
    return np.asarray(np.maximum(plus, minus))


def _all_modes(within: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(n, 5, 2) limb by limb → (n, 32) mode by mode, in the order of `MODES`."""
    answer = within[:, 0]
    for i in range(1, LIMBS):
        answer = (answer[:, :, None] & within[:, i, None, :]).reshape(len(within), -1)
    return answer


def _platform_rotation(poses: Array) -> Array:
    return np.asarray(rotation_y(poses[..., 4]) @ rotation_x(poses[..., 3]))
