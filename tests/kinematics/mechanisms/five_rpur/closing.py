"""Poses at which every limb of a 5-RPUR closes, for the tests of motion and statics."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import joint_points, limb_lengths, signs


def closing_poses(
    design: FiveRPURDesign, count: int, seed: int, *, least_rho: float = 60.0
) -> tuple[Array, Array]:
    """Random poses with |Y| ≤ 0.9 l and ρ ≥ ``least_rho``, and random signs; (n, 5) each."""
    rng = np.random.default_rng(seed)
    many = 60 * count
    position = rng.uniform((-400, -100, -500), (400, 250, 500), (many, 3))
    poses = np.column_stack([position, rng.uniform(-np.pi, np.pi, (many, 2))])
    sigma = rng.choice([-1.0, 1.0], (many, 5))
    _, b, c = joint_points(design, poses, sigma)
    good = (np.abs((c - b)[..., 1]) <= 0.9 * design.link).all(axis=-1)
    good &= (lengths(design, poses, sigma) >= least_rho).all(axis=-1)
    poses, sigma = poses[good][:count], sigma[good][:count]
    assert len(poses) == count
    return poses, sigma


def lengths(design: FiveRPURDesign, poses: Any, sigma: Any) -> Array:
    """ρ (..., 5) in the modes that signs (..., 5) or "+-+++" say."""
    both = limb_lengths(design, poses)
    sigma = signs(sigma) if isinstance(sigma, str) else np.asarray(sigma)
    return np.where(sigma > 0, both[..., 0], both[..., 1])
