"""What a straight way in the pose coordinates passes, and following a path of such ways.

On a way Z, θ and φ (the shorter way round) change evenly. P and the limb lengths are looked at in
small steps, and where their signs change between two of them that place is found exactly.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from kinematics.answers.bounds import range_of
from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Followed, Posture
from kinematics.arrays import Array
from kinematics.facets.inverse import posture as posture_at
from kinematics.facets.pose_paths import corners_of, follow_ways
from kinematics.mechanisms.tripods import polynomial, posing
from kinematics.mechanisms.tripods.design import LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.inverse import LIMITS

_STEPS = 720  # of a way
_BEFORE = 1e-6  # of the way, by which a path stops before a singularity
_TURN_ROUND = 1e-9  # rad from 180°: the tilt at which the operation modes meet


def passed(design: TripodDesign, before: Posture, after: Posture) -> tuple[Event, ...]:
    """What is passed on the straight way from one posture to another of the same mode, in order.

    Of postures in different modes it is only told that no way was driven.
    """
    if before.mode != after.mode:
        text = (
            f"the operation mode was set to {after.mode}: a machine changes it only in the "
            "constraint singularity, at a tilt of 180°"
        )
        meet = abs(before.pose[1] - np.pi) <= _TURN_ROUND and abs(after.pose[1] - np.pi) <= 1e-6
        return () if meet else (Event("parallel", 0.0, before.pose, None, text, True),)
    return _events(design, before.mode, _Way.between(design, before.pose, after.pose))


def path(design: TripodDesign, start: Posture, poses: ArrayLike) -> Followed:
    """Follow straight ways through poses (N, 3), in the start's mode.

    Stops shortly before a parallel singularity, and at a stroke end that it would pass.

    Raises:
        InputError: no poses, or not three finite numbers each.
    """
    corners = [start.pose, *corners_of(poses, ("z", "tilt", "azimuth"))]
    return follow_ways(
        start,
        [_Way.between(design, a, b) for a, b in pairwise(corners)],
        events=lambda way: _events(design, start.mode, way),
        posture=lambda pose: posture_at(design, pose, start.mode),
        back=lambda _: _BEFORE,
        why=lambda event, *_: event.text,
    )


# --- inside --------------------------------------------------------------------------------


class _Way(NamedTuple):
    """Both ends (3,), the azimuth of the second one the shorter way round, and its length, mm."""

    start: Array
    end: Array
    length: float

    @classmethod
    def between(cls, design: TripodDesign, start: ArrayLike, end: ArrayLike) -> _Way:
        a, b = np.array(start, dtype=float), np.array(end, dtype=float)
        b[2] = a[2] + np.pi - (np.pi - (b[2] - a[2])) % (2.0 * np.pi)
        radius = design.platform_radius
        return cls(a, b, float(np.linalg.norm((b - a) * (1.0, radius, radius))))

    def at(self, s: ArrayLike) -> Array:
        """Poses (..., 3) at s (...), their azimuths as they are on the way."""
        return np.asarray(self.start + np.asarray(s)[..., None] * (self.end - self.start))

    def pose(self, s: float) -> tuple[float, ...]:
        z, tilt, azimuth = self.at(s).tolist()
        return z, tilt, float(np.pi - (np.pi - azimuth) % (2.0 * np.pi))


def _events(design: TripodDesign, mode: str, way: _Way) -> tuple[Event, ...]:
    """What a way passes, in order."""
    if not way.length > 0.0:
        return ()
    fractions = np.linspace(0.0, 1.0, _STEPS + 1)
    poses = way.at(fractions)
    found = _singular(design, mode, way, fractions, poses)
    found += _strokes(design, mode, way, fractions, poses)
    return tuple(sorted(found, key=lambda event: event.fraction))


def _singular(
    design: TripodDesign, mode: str, way: _Way, fractions: Array, poses: Array
) -> list[Event]:
    def side(fraction: float) -> float:
        return float(_polynomial(design, mode, way.at(fraction)))

    values = np.asarray(_polynomial(design, mode, poses))
    found = []
    for n in np.flatnonzero(values[:-1] * values[1:] < 0.0).tolist():
        at = float(brentq(side, fractions[n], fractions[n + 1], xtol=1e-14))
        text = f"a parallel singularity was crossed at {_where(way, at)}"
        found.append(Event("parallel", at, way.pose(at), None, text, True))
    return found


def _strokes(
    design: TripodDesign, mode: str, way: _Way, fractions: Array, poses: Array
) -> list[Event]:
    lengths = posing.limb_lengths(design, poses, mode)
    found = []
    for i in range(LIMBS):
        for bound, end in zip(range_of(LIMITS, i + 1), design.stroke, strict=True):
            sign = 1.0 if bound == "rho_min" else -1.0
            with np.errstate(invalid="ignore"):
                room = sign * (lengths[:, i] - end)
            room = np.where(np.isfinite(room), room, sign)

            def left(fraction: float, i: int = i, sign: float = sign, end: float = end) -> float:
                return sign * float(posing.limb_lengths(design, way.at(fraction), mode)[i] - end)

            out = (room[:-1] >= 0.0) & (room[1:] < -1e-9)
            back = (room[:-1] < -1e-9) & (room[1:] >= 0.0)
            for n in np.flatnonzero(out | back).tolist():
                low, high = float(fractions[n]), float(fractions[n + 1])
                at = float(brentq(left, low, high, xtol=1e-14)) if room[n] != 0.0 else low
                word = "passed" if out[n] else "came back within"
                text = (
                    f"limb {i + 1} {word} the end of its stroke ({bound.name}) at {_where(way, at)}"
                )
                found.append(Event("stroke", at, way.pose(at), i + 1, text, bool(out[n])))
    return found


def _polynomial(design: TripodDesign, mode: str, poses: Array) -> Array:
    z, tilt, azimuth = (poses[..., n] for n in range(posing.POSE))
    k = mode_sign(mode) * design.platform_radius
    return np.asarray(
        polynomial.value(design.mechanism, design.base_radius, k, z, tilt, np.sin(3.0 * azimuth))
    )


def _where(way: _Way, fraction: float) -> str:
    z, tilt, azimuth = way.pose(fraction)
    return f"z = {z:.1f} mm, θ = {np.degrees(tilt):.1f}°, φ = {np.degrees(azimuth):.1f}°"
