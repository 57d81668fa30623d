"""Cases and machines that the tests of the 3-RPS and 3-SPR share.

reference/rps_spr_forward.json, rps_spr_singularity.json and micr_table.json were computed apart
from this code: all 16 solutions with 30 digits from the loop equations, determinants of the six
wrenches built from the joints, and MICR by a scan of P with refinement.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.tripods import circles, study
from kinematics.mechanisms.tripods.design import KINDS, Kind, TripodDesign

REFERENCE = Path(__file__).parents[3] / "reference"
NAMES: dict[str, Kind] = {"RPS": "three_rps", "SPR": "three_spr"}


def stored(name: str) -> dict[str, Any]:
    """A file of reference cases."""
    found: dict[str, Any] = json.loads((REFERENCE / name).read_text())
    return found


def machine(kind: Kind, h1: float = 100.0, h2: float = 160.0) -> TripodDesign:
    return TripodDesign(kind, h1, h2, (20.0, 600.0))


def some_machines(rng: np.random.Generator, count: int) -> list[TripodDesign]:
    """Of both kinds in turn, with radii from 50 to 300 mm."""
    radii = rng.uniform(50.0, 300.0, (count, 2)).tolist()
    return [TripodDesign(KINDS[n % 2], a, b, (0.0, 999.0)) for n, (a, b) in enumerate(radii)]


def some_poses(rng: np.random.Generator, count: int, *, farthest: float = 3.1) -> Array:
    """Altitudes from 60 to 250 mm, any azimuth, and tilts that stay off 0 and 90°."""
    tilt = rng.uniform(0.05, farthest, count)
    tilt = np.where(np.abs(tilt - 0.5 * np.pi) < 0.05, 0.7, tilt)
    return np.stack([rng.uniform(60.0, 250.0, count), tilt, rng.uniform(-3.1, 3.1, count)], axis=-1)


# --- what is checked with ---------------------------------------------------------------------


def to_transform(parameters: ArrayLike) -> Array:
    """4x4 matrices of real Study parameters (..., 8) of any length but zero.

    Raises:
        InputError: not finite, x = 0, or off the Study quadric by more than 1e-6 of their size.
    """
    values = finite(parameters, name="the Study parameters", last=8)
    square = (values[..., :4] ** 2).sum(axis=-1)
    if (square == 0.0).any():
        raise InputError("the Study parameters x0 … x3 must not all be zero")
    off = np.abs((values[..., :4] * values[..., 4:]).sum(axis=-1))
    size = np.linalg.norm(values[..., :4], axis=-1) * np.linalg.norm(values[..., 4:], axis=-1)
    if (off > 1e-6 * size).any():
        raise InputError("the Study parameters must satisfy x0 y0 + x1 y1 + x2 y2 + x3 y3 = 0")
    values = values / np.sqrt(square)[..., None]
    matrix = np.zeros((*values.shape[:-1], 4, 4))
    matrix[..., :3, :3] = study.rotation(values[..., :4])
    matrix[..., :3, 3] = study.translation(values)
    matrix[..., 3, 3] = 1.0
    return matrix


def circle_points(tilt: float, azimuth: float, radius: float, count: int = 181) -> Array:
    """Points (n, 2) of (tilt, azimuth) of the circle about an orientation, closed."""
    frame = circles._frame(tilt, azimuth)
    turn = np.linspace(0.0, 2.0 * np.pi, count)
    return circles._chart(circles._on_circle(frame, np.array(radius), turn))
