"""Poses as places: (Z, θ, φ) is drawn at (h2 θ cos φ, h2 θ sin φ, Z).

Up is the altitude, outwards the tilt, one radian as long as the platform's circumradius.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import TripodDesign


def to_chart(design: TripodDesign, poses: Array) -> Array:
    """Where poses (..., 3) are drawn, (..., 3) mm."""
    z, tilt, azimuth = (poses[..., n] for n in range(posing.POSE))
    out = design.platform_radius * tilt
    return np.stack([out * np.cos(azimuth), out * np.sin(azimuth), z], axis=-1)


def from_chart(design: TripodDesign, points: Array) -> Array:
    """The poses (..., 3) drawn at points (..., 3); beyond the rim tilts are larger than π."""
    x, y, z = (points[..., n] for n in range(3))
    return np.stack([z, np.hypot(x, y) / design.platform_radius, np.arctan2(y, x)], axis=-1)
