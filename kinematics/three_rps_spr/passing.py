"""What a straight way in the pose coordinates passes, and following a path of such ways.

On a way Z, θ and φ (the shorter way round) change evenly. P and the limb lengths are looked at in
small steps, and where their signs change between two of them that place is found exactly.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from kinematics.errors import InputError
from kinematics.singularities import Event
from kinematics.solutions import Bound, Followed, Posture, Stop
from kinematics.spatial import Array, finite
from kinematics.three_rps_spr import polynomial, posing
from kinematics.three_rps_spr.design import LIMBS, TripodDesign, mode_sign
from kinematics.three_rps_spr.inverse import posture as posture_at

_STEPS = 720  # of a way
_BEFORE = 1e-6  # of the way, by which a path stops before a singularity
_TURN_ROUND = 1e-9  # rad from 180°: the tilt at which the operation modes meet
_ENDS: tuple[Bound, Bound] = ("rho_min", "rho_max")


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
    way = _way(before.pose, after.pose)
    if not np.abs(way[1] - way[0]).max() > 0.0:
        return ()
    fractions = np.linspace(0.0, 1.0, _STEPS + 1)
    poses = way[0] + fractions[:, None] * (way[1] - way[0])
    found = _singular(design, before.mode, way, fractions, poses)
    found += _strokes(design, before.mode, way, fractions, poses)
    return tuple(sorted(found, key=lambda event: event.fraction))


def path(design: TripodDesign, start: Posture, poses: ArrayLike) -> Followed:
    """Follow straight ways through poses (N, 3), in the start's mode.

    Stops shortly before a parallel singularity, and at a stroke end that it would pass.

    Raises:
        InputError: no poses, or not three finite numbers each.
    """
    targets = finite(poses, name="a pose", last=posing.POSE)
    if targets.ndim != 2 or not len(targets):
        raise InputError("a path must be a list of poses of 3 numbers (z, tilt, azimuth)")
    if not start.reachable:
        return Followed(start, "stalled", f"cannot start: {start.reasons[0].text}", 0.0)
    corners = np.concatenate([[start.pose], targets])
    scale = np.array([1.0, design.platform_radius, design.platform_radius])
    ways = [_way(tuple(a), tuple(b)) for a, b in pairwise(corners)]
    lengths = np.array([np.linalg.norm((b - a) * scale) for a, b in ways])
    whole, done = float(lengths.sum()), 0.0
    here = start
    for (a, b), length in zip(ways, lengths.tolist(), strict=True):
        after = posture_at(design, b, start.mode)
        for event in passed(design, here, after):
            if not event.stops:
                continue
            back = 0.0 if event.kind == "stroke" else _BEFORE
            part = max(event.fraction - back, 0.0)
            reached = posture_at(design, a + part * (b - a), start.mode)
            covered = (done + part * length) / whole if whole > 0.0 else 0.0
            stop: Stop = "stroke" if event.kind == "stroke" else "singularity"
            return Followed(reached, stop, event.text, covered, event.limb)
        here, done = after, done + length
    return Followed(here, "target", "", 1.0)


# --- inside --------------------------------------------------------------------------------


def _way(start: tuple[float, ...], end: tuple[float, ...]) -> tuple[Array, Array]:
    """Both ends, the azimuth of the second one the shorter way round."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    b[2] = a[2] + np.pi - (np.pi - (b[2] - a[2])) % (2.0 * np.pi)
    return a, b


def _singular(
    design: TripodDesign, mode: str, way: tuple[Array, Array], fractions: Array, poses: Array
) -> list[Event]:
    def side(fraction: float) -> float:
        return float(_polynomial(design, mode, way[0] + fraction * (way[1] - way[0])))

    values = np.asarray(_polynomial(design, mode, poses))
    found = []
    for n in np.flatnonzero(values[:-1] * values[1:] < 0.0).tolist():
        at = float(brentq(side, fractions[n], fractions[n + 1], xtol=1e-14))
        text = f"a parallel singularity was crossed at {_where(way, at)}"
        found.append(Event("parallel", at, _pose(way, at), None, text, True))
    return found


def _strokes(
    design: TripodDesign, mode: str, way: tuple[Array, Array], fractions: Array, poses: Array
) -> list[Event]:
    lengths = posing.limb_lengths(design, poses, mode)
    found = []
    for i in range(LIMBS):
        for bound, end in zip(_ENDS, design.stroke, strict=True):
            sign = 1.0 if bound == "rho_min" else -1.0
            with np.errstate(invalid="ignore"):
                room = sign * (lengths[:, i] - end)
            room = np.where(np.isfinite(room), room, sign)

            def left(fraction: float, i: int = i, sign: float = sign, end: float = end) -> float:
                pose = way[0] + fraction * (way[1] - way[0])
                return sign * float(posing.limb_lengths(design, pose, mode)[i] - end)

            out = (room[:-1] >= 0.0) & (room[1:] < -1e-9)
            back = (room[:-1] < -1e-9) & (room[1:] >= 0.0)
            for n in np.flatnonzero(out | back).tolist():
                low, high = float(fractions[n]), float(fractions[n + 1])
                at = float(brentq(left, low, high, xtol=1e-14)) if room[n] != 0.0 else low
                name = bound.replace("rho_", "ρ ")
                word = "passed" if out[n] else "came back within"
                text = f"limb {i + 1} {word} the end of its stroke ({name}) at {_where(way, at)}"
                found.append(Event("stroke", at, _pose(way, at), i + 1, text, bool(out[n])))
    return found


def _polynomial(design: TripodDesign, mode: str, poses: Array) -> Array:
    z, tilt, azimuth = (poses[..., n] for n in range(posing.POSE))
    k = mode_sign(mode) * design.platform_radius
    return np.asarray(
        polynomial.value(design.mechanism, design.base_radius, k, z, tilt, np.sin(3.0 * azimuth))
    )


def _pose(way: tuple[Array, Array], fraction: float) -> tuple[float, ...]:
    z, tilt, azimuth = (way[0] + fraction * (way[1] - way[0])).tolist()
    return z, tilt, float(np.pi - (np.pi - azimuth) % (2.0 * np.pi))


def _where(way: tuple[Array, Array], fraction: float) -> str:
    z, tilt, azimuth = _pose(way, fraction)
    return f"z = {z:.1f} mm, θ = {np.degrees(tilt):.1f}°, φ = {np.degrees(azimuth):.1f}°"
