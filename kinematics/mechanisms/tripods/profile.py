"""MICR against the altitude, of one machine or of many ratios (Nayak et al. 2017, Figs. 4, 5)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.circles import Profile, ProfileCurve
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.mechanisms.tripods.design import TripodDesign
from kinematics.mechanisms.tripods.micr import table

LOWEST, HIGHEST, COUNT = 0.02, 4.0, 200  # of Z / h1, as in the paper's figures
MOST = 12  # ratios


def profile(design: TripodDesign, altitude: float, ratios: Sequence[float] = ()) -> Profile:
    """Curves of MICR over Z / h1, both operation modes of every ratio h2 / h1.

    Args:
        design: the machine; its own ratio comes first.
        altitude: Z, mm, whose place is marked.
        ratios: further h2 / h1.

    Raises:
        InputError: a ratio is not a positive number, or there are too many of them.
    """
    if len(ratios) > MOST:
        raise InputError(f"at most {MOST} ratios h2 / h1 can be compared, got {len(ratios)}")
    if not all(np.isfinite(r) and r > 0.0 for r in ratios):
        raise InputError("a ratio h2 / h1 must be a positive number")
    own = design.platform_radius / design.base_radius
    at = np.linspace(LOWEST, max(HIGHEST, abs(altitude) / design.base_radius), COUNT)
    wanted = [own, *(r for r in dict.fromkeys(ratios) if r != own)]
    found = table(design.mechanism, np.ones((len(wanted), 1)), np.array(wanted)[:, None], at)
    curves = [
        ProfileCurve(f"h₂/h₁ = {ratio:g}", mode, n == 0, _shown(found.radius[m, n]))
        for n, ratio in enumerate(wanted)
        for m, mode in enumerate(found.modes)
    ]
    return Profile(
        "MICR over the altitude",
        "Z / h₁",
        "MICR",
        at,
        tuple(curves),
        abs(altitude) / design.base_radius,
        "Figs. 4 and 5",
    )


def _shown(radius: Array) -> Array:
    """Where no tilt is singular the whole half turn is free."""
    return np.where(np.isnan(radius), np.pi, radius)
