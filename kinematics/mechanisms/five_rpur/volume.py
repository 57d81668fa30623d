"""The workspace's volume and centroid: one quadrature over x' of exact section areas.

The area is a smooth function of x' but for roots, whose places are known, and kinks, where the
section changes its structure (`slicing.integral`). Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from kinematics.answers.sections import Volume
from kinematics.arrays import Array, Ints, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter
from kinematics.mechanisms.five_rpur.slicing.events import events
from kinematics.screws.spatial import rotation_y

MOST_SECTIONS = 60_000
"""No volume is worth more sections; what is reached by then is returned with its error."""

_SPECK = 1e-10  # of the volume: a piece that small is due to rounding


def volume(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: Iterable[str] | None = None,
    *,
    relative: float = 1e-6,
    between: tuple[float, float] | None = None,
    structure: bool = True,
) -> Volume:
    """The volume of the constant-orientation workspace by exact sections.

    Args:
        design: the machine.
        phi: φ, rad.
        theta: θ, rad.
        modes: working modes as "+-+++", of which any will do; None for all 32.
        relative: the error wanted, as a part of the volume.
        between: only what lies between these two x', mm.
        structure: also the pieces and the places where the section changes its structure, which
            take longer than the volume itself; without, there are none in the result.

    Raises:
        InputError: an angle or an end that is not finite, a mode that is not five signs, or an
            error wanted that is not between 1e-12 and 1.
    """
    cutter = Cutter(design, phi, theta, modes)
    found = integrate(cutter, relative, between)
    with np.errstate(invalid="ignore", divide="ignore"):
        centroid = np.array([found.first, *found.moments[1:3]]) / found.moments[0]
    centroid[1:] += cutter.origin
    return Volume(
        value=float(found.moments[0]),
        error=found.error,
        centroid=rotation_y(float(theta)) @ centroid,
        pieces=pieces(cutter, found) if structure else (),
        at=found.at,
        area=found.area,
        events=changes(cutter, found) if structure else np.empty(0),
        sections=found.sections,
    )


@dataclass(frozen=True, eq=False)
class Integral:
    """``moments`` (3,) of the volume (∫ dx' of those of sections), ``first`` = ∫ x' A dx';
    the volume's ``error``; the sections taken, ``at`` (N,) increasing, their ``area`` and ``marks``
    (N,), and the ``weights`` (N, 2) of areas and of their derivatives by x'; ``sections`` were
    computed.
    """

    moments: Array
    first: float
    error: float
    at: Array
    area: Array
    weights: Array
    marks: Ints
    sections: int


def integrate(
    cutter: Cutter, relative: float, between: tuple[float, float] | None = None
) -> Integral:
    """Integrals over x' of the sections' moments, until the volume's error is small enough.

    Raises:
        InputError: the wanted error is not between 1e-12 and 1, or ``between`` not two numbers.
    """
    if not 1e-12 <= relative <= 1.0:
        raise InputError(f"the wanted relative error must lie between 1e-12 and 1, got {relative}")
    low, high = cutter.range
    if between is not None:
        one, other = finite(between, name="between", last=2).tolist()
        low, high = max(low, min(one, other)), min(high, max(one, other))
    if not low < high:
        none = np.empty(0)
        return Integral(
            np.zeros(3), 0.0, 0.0, none, none, np.empty((0, 2)), none.astype(np.int64), 0
        )
    found = cutter.integral(low, high, relative, MOST_SECTIONS)
    value, slope = found.weights.T
    area, change = found.moments[:, 0], found.moments[:, 3]
    return Integral(
        moments=value @ found.moments[:, :3] + slope @ found.moments[:, 3:],
        first=float(value @ (found.at * area) + slope @ (area + found.at * change)),
        error=found.error,
        at=found.at,
        area=area.copy(),
        weights=found.weights,
        marks=found.marks,
        sections=found.sections,
    )


def pieces(cutter: Cutter, found: Integral) -> tuple[float, ...]:
    """The volumes of the connected pieces, mm³, largest first; what rounding makes is left out."""
    volumes = cutter.pieces(found.at, found.weights)
    kept = volumes[volumes > _SPECK * found.moments[0]]
    if kept.size:  # what the smallest were given too much
        kept[0] -= kept.sum() - found.moments[0]
    return tuple(kept.tolist())


def changes(cutter: Cutter, found: Integral) -> Array:
    """Where the structure of sections changes, increasing, mm: where a closed form says so between
    two sections that are built differently, else in the middle between them."""
    n = np.flatnonzero(found.marks[1:] != found.marks[:-1])
    a, b = found.at[n], found.at[n + 1]
    known = events(cutter.limbs, cutter.signs, cutter.size)
    middle = 0.5 * (a + b)
    if known.size:
        k = np.clip(np.searchsorted(known, middle), 1, max(known.size - 1, 1))
        near = known[np.minimum(np.stack([k - 1, k]), known.size - 1)]
        near = np.where(middle - near[0] < near[1] - middle, near[0], near[1])
        middle = np.where((a <= near) & (near <= b), near, middle)
    return np.unique(middle)
