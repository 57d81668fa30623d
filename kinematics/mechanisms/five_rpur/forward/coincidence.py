"""Solutions of the 5-RPUR that coincide, nearly coincide, or belong to a curve of solutions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import SelfMotion
from kinematics.arrays import Array
from kinematics.homotopy.assembly_sets import NEAR
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward.equations import (
    PHI,
    THETA,
    Complex,
    Frame,
    Parameters,
    conjugate,
    from_poses,
    from_real,
    parameters,
    real_part,
    residuals,
    terms,
    to_poses,
)

REAL = 1e-7
"""Relative distance of a solution from its conjugate below which it is real."""

_FAR = 100.0  # units
_MOST = 24  # singular solutions looked at for a self-motion
_SINGULAR = 1e-4  # smallest singular value of the equations, relative to the largest
_TRIES = (2e-2, 1e-1)  # how far along a free direction solutions must exist, in units
_NEXT = (5e-3, 2e-2)  # the same next to a posture that is known exactly
_CLOSES = 1e-12  # of the equations, relative


def nearly_real(frame: Frame, roots: Complex, length: float) -> NDArray[np.intp]:
    """The complex solutions that are less than NEAR from their conjugates and not real."""
    away = np.abs(roots - conjugate(roots))
    linear, angular = frame.unit * away[:PHI], length * away[PHI : THETA + 1]
    mm2 = (linear**2).sum(axis=0) + (angular**2).sum(axis=0)
    near = np.flatnonzero(mm2 < NEAR * NEAR)
    relative = (away[:, near] / np.maximum(np.abs(roots[:, near]), 1.0)).max(axis=0)
    found: NDArray[np.intp] = near[relative > REAL]
    return found


# --- curves of solutions ---------------------------------------------------------------------


def finite_motion(
    design: FiveRPURDesign, pose: Sequence[float], elbows: Array, joints: Sequence[float]
) -> bool:
    """Whether a singular posture can move on, both ways and a finite way, with its joints locked.

    Solutions are sought some mm away along what is free there; next to a double solution, or one
    that counts three- or fourfold, there are none.

    Args:
        pose: (5,) mm and rad.
        elbows: (5, 3) mm, B_i in the base frame.
        joints: (5,) mm.
    """
    frame = Frame.of(design)
    u = from_poses(design, frame, np.array([pose]), np.asarray(elbows)[None])
    return _real_curve(parameters(design, joints, frame), u, _NEXT) is not None


def self_motions(
    design: FiveRPURDesign, rho: Array, frame: Frame, singular: Complex, length: float
) -> tuple[SelfMotion, ...]:
    """The motions that stay free with all actuators locked, from the singular solutions (10, n).

    A path that ends on a curve of solutions ends anywhere on it, as a rule not at a real point;
    that is sought next to its real part. Then solutions are sought a finite way along the free
    direction there: at a fold there are none, on a self-motion they exist on both sides.

    Returns:
        One motion for each working mode that some were found in.
    """
    if not singular.size:
        return ()
    g = parameters(design, rho, frame)
    # Far out regular solutions look singular; what is nearly real is tried first.
    singular = singular[:, np.abs(singular).max(axis=0) < _FAR]
    away = np.abs(singular - conjugate(singular)).max(axis=0)
    answer: dict[str, SelfMotion] = {}
    for n in np.argsort(away)[:_MOST]:
        found = _real_curve(g, singular[:, [n]])
        if found is None:
            continue
        here, free = found
        mode = "".join(
            "+" if q >= 0.0 else "-" for q in terms(g, _configuration(here)).q.real[:, 0]
        )
        pose, ahead = to_poses(frame, np.stack([here[:5], here[:5] + 1e-6 * free[:5]], axis=1))
        d = ahead - pose
        d[3:] = np.mod(d[3:] + np.pi, 2.0 * np.pi) - np.pi
        d /= np.sqrt((d[:3] ** 2).sum() + ((length * d[3:]) ** 2).sum())
        motion = SelfMotion(tuple(pose.tolist()), mode, tuple(d.tolist()), _text(mode, d, length))
        answer.setdefault(mode, motion)
    return tuple(answer.values())


def _text(mode: str, d: Array, length: float) -> str:
    parts = np.abs(d) * np.array([1.0, 1.0, 1.0, length, length])
    names = ("x", "y", "z", "φ", "θ")
    free = [name for name, part in zip(names, parts, strict=True) if part > 0.05 * parts.max()]
    return (
        f"Self-motion in mode {mode}: the platform moves freely ({', '.join(free)}) with all "
        "actuators locked; infinitely many solutions belong to it."
    )


def real_jacobian(g: Parameters, u: Complex) -> Array:
    """d(F1, F2)/d(X, y, Z, φ, θ, w) at real configurations, (n, 10, 10), without unit."""
    t = terms(g, u)
    count = u.shape[1]
    j = np.zeros((count, 2 * LIMBS, 10))
    limb = np.arange(LIMBS)
    p, q, big_p, big_y = (v.real.T for v in (t.p, t.q, t.big_p, t.big_y))
    j[:, :LIMBS, 0] = big_p
    j[:, :LIMBS, 4] = (t.big_p * t.b - t.p * t.a).real.T
    j[:, limb, 5 + limb] = p
    j[:, LIMBS:, 1] = big_y
    j[:, LIMBS:, 2] = q
    j[:, LIMBS:, 3] = (t.q * t.my - t.big_y * t.mz).real.T
    j[:, LIMBS + limb, 5 + limb] = -q
    return j


def _real_curve(
    g: Parameters, u: Complex, tries: tuple[float, ...] = _TRIES
) -> tuple[Array, Array] | None:
    """A real point (X, y, Z, φ, θ, w) of a curve of solutions near u, and its unit direction.

    Solutions have to exist ``tries`` away from it, in units, both ways.
    """
    values, w = real_part(u)
    here = _closed(g, np.concatenate([values, w])[:, 0])
    if here is None:
        return None
    _, sizes, vectors = np.linalg.svd(real_jacobian(g, _configuration(here))[0])
    for direction in vectors[sizes <= _SINGULAR * sizes[0]][::-1]:
        if all(
            _reaches(g, here, sign * step * direction) for step in tries for sign in (1.0, -1.0)
        ):
            return here, direction
    return None


def _reaches(g: Parameters, here: Array, step: Array) -> bool:
    """There is a solution about ``step`` away."""
    there = _closed(g, here + step)
    if there is None:
        return False
    moved = there - here
    size = float(np.linalg.norm(step))
    return bool(moved @ step > 0.5 * size * size and np.linalg.norm(moved) < 3.0 * size)


def _closed(g: Parameters, guess: Array) -> Array | None:
    """The nearest solution by Gauss-Newton steps of least length; None if there is none."""
    point = guess
    for _ in range(30):
        u = _configuration(point)
        f = np.concatenate([part.real[:, 0] for part in residuals(g, u)])
        if np.abs(f).max() <= _CLOSES * max(1.0, float(g.rho2.real.max())):
            return point
        j = real_jacobian(g, u)[0]
        step = np.linalg.lstsq(j, -f, rcond=1e-9)[0]
        point = point + step * min(1.0, 0.2 / max(float(np.abs(step).max()), 1e-300))
    return None


def _configuration(point: Array) -> Complex:
    return from_real(point[:5, None], point[5:, None])
