"""Circles of orientations: how far the platform can turn in every direction. Plain results.

Angles rad, but where printed numbers are compared with. Arrays are read-only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinematics.arrays import Array, Frozen

CircleLimit = Literal["parallel", "constraint", "stroke"]


@dataclass(frozen=True, slots=True)
class OrientationCircle:
    """The largest circle of orientations about one, at a fixed position, that one limit leaves.

    Attributes:
        limit: which.
        radius: rad, the angle by which the platform can turn from the centre in every direction;
            π where nothing is met.
        contacts: (tilt, azimuth) of the orientations that are met first, rad; none at π.
        limb: from 1, whose stroke ends; None for singularities.
        bound: "rho_min" or "rho_max", likewise.
        barred: within the circle there are orientations without any position at this altitude.
        error: rad, an estimate from above of the error of ``radius``.
        text: one sentence for the user.
    """

    limit: CircleLimit
    radius: float
    contacts: tuple[tuple[float, float], ...]
    text: str
    limb: int | None = None
    bound: str = ""
    barred: bool = False
    error: float = 0.0


@dataclass(frozen=True, eq=False)
class MicrTable(Frozen):
    """Maximum inscribed circle radii (MICR) about the level platform, of many machines.

    Attributes:
        modes: M operation modes.
        radius: (M, ...) rad; NaN where no tilt is singular.
        contact: (M, ...) the azimuth that is met first, rad, one of those that symmetry makes.
        barred: (M, ...) the circle holds tilts without any position at this altitude.
        printed: (M, ...) degrees, what the method of the mechanism's paper prints of it.
        note: why that is another number; "" where there is no such paper.
    """

    modes: tuple[str, ...]
    radius: Array
    contact: Array
    barred: np.ndarray
    printed: Array
    note: str


@dataclass(frozen=True, eq=False)
class ProfileCurve(Frozen):
    """One curve of a `Profile`: ``title`` and ``mode`` say of what, ``own`` whether of the very
    machine; ``radius`` (N,) rad, π where nothing is met.
    """

    title: str
    mode: str
    own: bool
    radius: Array


@dataclass(frozen=True, eq=False)
class Profile(Frozen):
    """Radii of circles of orientations, rad, against a ratio of lengths.

    Attributes:
        title, across, up: what it is, and what its axes are called.
        x: (N,) the ratio.
        at: where the machine stands.
    """

    title: str
    across: str
    up: str
    x: Array
    curves: tuple[ProfileCurve, ...]
    at: float
    figure: str = ""
