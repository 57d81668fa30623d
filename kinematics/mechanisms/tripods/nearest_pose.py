"""The ways out of a pose of a 3-RPS or 3-SPR that cannot be held."""

from __future__ import annotations

import numpy as np

from kinematics.answers.clearances import DesignChange, DesignChanges
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.clearances import ClearancesFacet, Nearest
from kinematics.facets.inverse import posture as posture_at
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import LIMBS, SCHEMA, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import limb_lengths, offsets
from kinematics.mechanisms.tripods.posing import Reduced
from kinematics.mechanisms.tripods.study import translation

_EXACT = 1e-9  # of the machine's size
_TILTS, _TURNS = 121, 72  # of the search for the nearest orientation
_REFINED = 5


class NearestPose(ClearancesFacet[TripodDesign]):
    """Exact along the straight line that the orientation leaves, searched for at others."""

    def nearest(
        self,
        posture: Posture,
        modes: tuple[str, ...],
        changes: DesignChanges,
    ) -> tuple[Nearest | None, str]:
        """At the orientation the nearest altitude is exact; if there is none, the nearest
        orientation at the same altitude is searched for, by steps of some degrees that are made
        finer.
        """
        design = self.design
        straight = _nearest_altitude(design, posture) if posture.closes else None
        if straight is not None:
            altitude = straight.posture.pose[0]
            return straight, f"The nearest altitude at this orientation is Z = {altitude:.2f} mm."
        turned = _nearest_orientation(design, posture)
        if turned is None:
            return None, (
                "No altitude at this orientation and no orientation at this altitude is within the "
                "strokes."
            )
        here, there = (
            posing.positions(design, np.array(p.pose), p.mode) for p in (posture, turned)
        )
        _, tilt, azimuth = np.degrees(turned.pose)
        return Nearest(turned, float(np.linalg.norm(there - here)), float("inf")), (
            f"The nearest orientation found at this altitude is a tilt of {tilt:.2f}° about the "
            f"azimuth {azimuth:.2f}°."
        )

    def changes(self, posture: Posture) -> DesignChanges:
        """The stroke that reaches the pose: all limbs share it."""
        design = self.design
        if not posture.closes:
            return ()
        low, high = design.stroke
        least, most = min(posture.joints), max(posture.joints)
        change = []
        wider = design
        for index, (end, wanted, name) in enumerate(((low, least, "ρ min"), (high, most, "ρ max"))):
            beyond = wanted < end if index == 0 else wanted > end
            if not beyond:
                continue
            wider = SCHEMA.changed(wider, ("stroke", index), wanted)
            change.append(
                DesignChange(
                    ("stroke", index), name, end, wanted, f"{name} from {end:g} to {wanted:.2f} mm"
                )
            )
        return (tuple(change),) if change else ()


def _nearest_altitude(design: TripodDesign, posture: Posture) -> Nearest | None:
    """The nearest v at which all limbs are within their strokes: intervals, intersected."""
    pose = np.array(posture.pose)
    reduced = posing.reduce_poses(design, pose, posture.mode)
    h, k = design.revolute_radius, mode_sign(posture.mode) * design.spherical_radius
    outward, upward = offsets(h, k, reduced)
    v = float(reduced.v)
    lift = np.asarray(upward) - v
    low, high = design.stroke
    allowed = [(-np.inf, np.inf)]
    for i in range(LIMBS):
        far = high**2 - float(outward[i]) ** 2
        if far < 0.0:
            return None
        top, bottom = np.sqrt(far), np.sqrt(max(low**2 - float(outward[i]) ** 2, 0.0))
        own = [(-top - lift[i], -bottom - lift[i]), (bottom - lift[i], top - lift[i])]
        allowed = [
            (max(a, c), min(b, d)) for a, b in allowed for c, d in own if max(a, c) <= min(b, d)
        ]
    if not allowed:
        return None
    # A hair inside, so that rounding does not put the posture beyond an end again.
    inside = [
        float(np.clip(v, a, b)) if b - a < 2e-9 else float(np.clip(v, a + 1e-9, b - 1e-9))
        for a, b in allowed
    ]
    best = min(inside, key=lambda value: abs(value - v))
    z = place(design, reduced, best, posture.mode)[2]
    found = posture_at(design, (z, *posture.pose[1:]), posture.mode)
    return Nearest(found, abs(best - v), _EXACT * design.size) if found.reachable else None


def _nearest_orientation(design: TripodDesign, posture: Posture) -> Posture | None:
    """The orientation at this altitude nearest by angle, on a grid that is made finer."""
    z, tilt, azimuth = posture.pose
    here = _unit(np.array([tilt, azimuth]))
    tilts = np.linspace(0.0, np.pi, _TILTS)
    turns = np.linspace(-np.pi, np.pi, _TURNS, endpoint=False)
    grid = np.stack(np.meshgrid(tilts, turns, indexing="ij"), axis=-1).reshape(-1, 2)
    best: Array | None = None
    step = np.array([tilts[1], turns[1] - turns[0]])
    for _ in range(_REFINED):
        poses = np.concatenate([np.full((len(grid), 1), z), grid], axis=-1)
        lengths = limb_lengths(design, poses, posture.mode)
        low, high = design.stroke
        with np.errstate(invalid="ignore"):
            able = ((lengths >= low) & (lengths <= high)).all(axis=-1)
        if able.any():
            near = np.abs(_unit(grid[able]) @ here)
            best = grid[able][int(near.argmax())]
        if best is None:
            return None
        fine = np.linspace(-1.0, 1.0, 41)
        around = np.stack(np.meshgrid(fine, fine, indexing="ij"), axis=-1).reshape(-1, 2)
        grid = best + around * step
        step = step / 15.0
    assert best is not None
    turn = float(np.pi - (np.pi - best[1]) % (2.0 * np.pi))
    found = posture_at(design, (z, abs(float(best[0])), turn), posture.mode)
    return found if found.reachable else None


def _unit(chart: Array) -> Array:
    half = 0.5 * chart[..., 0]
    s = np.sin(half)
    return np.stack([np.cos(half), s * np.cos(chart[..., 1]), s * np.sin(chart[..., 1])], axis=-1)


def place(
    design: TripodDesign, reduced: Reduced, v: float, mode: str
) -> tuple[float, float, float]:
    there = reduced._replace(v=np.array(v))
    x, y, z = translation(posing.to_study(design, there, mode)).tolist()
    return x, y, z
