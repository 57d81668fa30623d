"""The pose of a 5-RPUR that is nearest to where a hand drags its platform."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.screws.spatial import rigid, wrap_angle


def pose_from_transform(matrices: ArrayLike) -> Array:
    """The pose whose frame is nearest: (..., 4, 4) → (..., 5) mm and rad, angles in (−π, π].

    The platform turns only as R_y(θ) R_x(φ). Of these rotations the one nearest in the
    Frobenius norm is taken, the position is kept.

    Raises:
        InputError: not 4x4, or its upper left part is not a rotation (to 1e-3).
    """
    r, place = rigid(matrices)
    phi, theta = _nearest_angles(r)
    return np.concatenate([place, phi[..., None], theta[..., None]], axis=-1)


def _nearest_angles(r: Array) -> tuple[Array, Array]:
    """Angles that maximise trace(Qᵀ R), from a scan that finds the hill and exact half steps."""

    def best_theta(phi: Array, r: Array) -> tuple[Array, Array]:
        c, s = np.cos(phi), np.sin(phi)
        cosine = r[..., 0, 0] + s * r[..., 2, 1] + c * r[..., 2, 2]
        sine = s * r[..., 0, 1] + c * r[..., 0, 2] - r[..., 2, 0]
        trace = np.hypot(cosine, sine) + c * r[..., 1, 1] - s * r[..., 1, 2]
        return np.arctan2(sine, cosine), trace

    def best_phi(theta: Array) -> Array:
        c, s = np.cos(theta), np.sin(theta)
        cosine = r[..., 1, 1] + s * r[..., 0, 2] + c * r[..., 2, 2]
        sine = s * r[..., 0, 1] + c * r[..., 2, 1] - r[..., 1, 2]
        return np.arctan2(sine, cosine)

    scan = np.linspace(-np.pi, np.pi, 72, endpoint=False)
    _, trace = best_theta(scan, r[..., None, :, :])
    phi = scan[trace.argmax(axis=-1)]
    theta, _ = best_theta(phi, r)
    for _ in range(200):  # two rounds do for an admissible rotation: the mixed derivative is 0
        before = phi
        phi = best_phi(theta)
        theta, _ = best_theta(phi, r)
        if (np.abs(np.sin(phi - before)) < 1e-15).all():
            break
    return wrap_angle(phi), wrap_angle(theta)
