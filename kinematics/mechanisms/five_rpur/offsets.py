"""Where each limb's vertex space stands in x'y'z', the base frame turned by R_y(−θ).

p' = R_y(−θ) p lies in the workspace iff p' − w'_i ∈ B_i for all limbs, w'_i = R_y(−θ) r_i −
R_x(φ) s'_i (Tale Masouleh et al. 2011, eq. 27). Lengths mm, angles rad.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.screws.spatial import rotation_x, rotation_y

SAME_SOLIDS = 1e-9
"""Part of a limb's size: solids of limbs closer than that would enclose films of air."""
_LEAST = 1e-2  # of the shortest stroke and link: what limbs are told apart by at least
SAME_NUMBERS = 4e-15
"""Part of a limb's size: what differs by less does so by rounding alone."""


def offset_points(design: FiveRPURDesign, phi: ArrayLike, theta: ArrayLike) -> Array:
    """w'_i of eq. 27: where each limb's vertex space stands in x'y'z'.

    ``phi`` and ``theta`` (...,) rad, broadcast together; returns (..., 5, 3) mm.
    """
    phi, theta = np.broadcast_arrays(finite(phi, name="phi"), finite(theta, name="theta"))
    base = design.base @ np.swapaxes(rotation_y(-theta), -1, -2)
    platform = design.platform @ np.swapaxes(rotation_x(phi), -1, -2)
    return np.asarray(base - platform)


def aligned_offsets(design: FiveRPURDesign, phi: float, theta: float, same: float) -> Array:
    """`offset_points` of one orientation, (5, 3) mm, with coordinates that are the same made equal.

    ``same`` is the part of the smallest limb's size by which they may differ.

    Raises:
        InputError: not one finite number each.
    """
    offsets = offset_points(design, phi, theta)
    if offsets.shape != (LIMBS, 3):
        raise InputError("phi and theta must be one number each")
    return _aligned(offsets, same * float((design.link + design.stroke[:, 1]).min()))


@dataclass(frozen=True, eq=False)
class PlacedLimbs:
    """Limbs of which those that are nearly equal have been made equal: ``offset`` (5, 3), ``link``
    (5,) and ``stroke`` (5, 2), mm; no surface of a vertex space was moved farther than ``moved``.
    """

    offset: Array
    link: Array
    stroke: Array
    moved: float


def merged_limbs(design: FiveRPURDesign, phi: float, theta: float, same: float) -> PlacedLimbs:
    """The limbs at one orientation; coordinates and lengths that are nearly the same made equal.

    ``same`` is the part of the smallest limb's size by which they may differ, but no more than a
    small part of a stroke or a link.

    Raises:
        InputError: not one finite number each.
    """
    step = same * float((design.link + design.stroke[:, 1]).min())
    least = min(float(np.diff(design.stroke).min()), float(design.link.min()))
    step = min(step, _LEAST * least)
    exact = aligned_offsets(design, phi, theta, 0.0)
    lengths = np.column_stack([design.link, design.stroke])
    offset, equal = _aligned(exact, step), _aligned(lengths, step)
    # A point of the surface is w' + ρ u + l v, with unit vectors u and v.
    change = np.abs(equal - lengths)
    moved = np.linalg.norm(offset - exact, axis=1) + change[:, 0] + change[:, 1:].max(axis=1)
    return PlacedLimbs(offset, equal[:, 0], equal[:, 1:], float(moved.max()))


def _aligned(offsets: Array, step: float) -> Array:
    """Each coordinate of the limbs' offsets, with those that differ by rounding made equal."""
    result = offsets.copy()
    for column in result.T:
        order = np.argsort(column, kind="stable")
        for last, this in pairwise(order):
            if column[this] - column[last] <= step:
                column[this] = column[last]
    return result
