"""The plane of the constraint, and in it the constant-orientation workspace, exactly.

At a given R the constraint (A_5 − p)·m = b_5·n6, m = R n6, leaves p a plane. Leg i keeps p between
two spheres about c_i = A_i − R b_i, which that plane cuts in circles: the workspace is an
intersection of rings, bounded by arcs (`plane.annuli`). Limb 5 has its centre in the plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import rotation
from kinematics.plane.annuli import Rings, rings_section
from kinematics.plane.annuli import inside as inside_rings
from kinematics.plane.regions import nearest_point


class Plane(NamedTuple):
    """Where p may be at an orientation: m·p = ``at``.

    Attributes:
        frame: (3, 3) rows m, u, v of the plane's frame, right-handed, in the base frame.
        at: mm.
        centers: (5, 3) mm, c_i = A_i − R b_i in the frame (m, u, v).
    """

    frame: Array
    at: float
    centers: Array

    def place(self, uv: Array) -> Array:
        """Points (..., 2) of the plane in the base frame, (..., 3) mm."""
        return np.asarray(self.at * self.frame[0] + uv @ self.frame[1:])

    def coordinates(self, points: Array) -> Array:
        """(u, v) of points (..., 3) of the base frame, projected on the plane."""
        return np.asarray(points @ self.frame[1:].T)


def plane(design: FourSPSSPRDesign, angles: Sequence[float]) -> Plane:
    """The plane at an orientation (α, β, γ), rad. v points up as far as it can."""
    r = rotation((0.0, 0.0, 0.0, *angles))
    m = r @ design.axis
    up = np.array([0.0, 0.0, 1.0])
    v = up - (up @ m) * m
    if np.linalg.norm(v) < 1e-9:  # a level plane: v is y
        v = np.array([0.0, 1.0, 0.0])
        v = v - (v @ m) * m
    v = v / np.linalg.norm(v)
    frame = np.stack([m, np.cross(v, m), v])
    centers = (design.base - design.platform @ r.T) @ frame.T
    return Plane(frame, float(centers[SPR, 0]), centers)


def rings(design: FourSPSSPRDesign, here: Plane) -> Rings:
    """The rings in the plane's (u, v)."""
    away = here.centers[:, 0] - here.at
    low, high = design.stroke[:, 0], design.stroke[:, 1]
    with np.errstate(invalid="ignore"):
        outer = np.sqrt(high * high - away * away)
        inner = np.sqrt(low * low - away * away)
    return Rings(
        here.centers[:, 1:],
        np.nan_to_num(inner, nan=0.0),
        np.nan_to_num(outer, nan=0.0),
        np.arange(1, LIMBS + 1, dtype=np.int64),
    )


def nearest_place(
    design: FourSPSSPRDesign, angles: Sequence[float], point: Array
) -> tuple[Array, float] | None:
    """The place of the workspace at an orientation nearest to a point (3,), and how far, mm."""
    here = plane(design, angles)
    found = rings(design, here)
    uv = here.coordinates(point)
    if not inside_rings(found, uv):
        on_edge = nearest_point(rings_section(found, here.at), uv)
        if on_edge is None:
            return None
        uv = on_edge[0]
    place = here.place(uv)
    return place, float(np.linalg.norm(place - point))
