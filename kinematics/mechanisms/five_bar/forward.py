"""Forward kinematics of the five-bar: both assembly modes, and how they fare while joints move.

P lies at |B_i P| = r_2 from both elbows: two circles, two points, one on each side of the way from
B_1 to B_2. The determinant of the unit vectors from B_1 and B_2 to P is positive on its left; it
vanishes where the points meet, at a parallel singularity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import count, islice

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.solutions import ForwardSolutions, Merged, Refreshed, SelfMotion
from kinematics.arrays import Array, finite
from kinematics.facets.forward import ForwardFacet, Found
from kinematics.mechanisms.five_bar.design import LIMBS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import elbows, mode_of
from kinematics.mechanisms.five_bar.joints_line import first_crossing

MEETING = 1e-12
"""Part of the size: circles that miss each other by less touch; centres that near coincide."""


def both_points(design: FiveBarDesign, joints: ArrayLike) -> Array:
    """P of both assembly modes, (..., 2, 2) mm, the one of positive determinant first.

    NaN where the circles about B_1 and B_2 do not meet, or where B_1 = B_2, so that P is free on a
    circle or nowhere.

    Args:
        joints: (..., 2) rad.
    """
    b = elbows(design, finite(joints, name="the joints", last=LIMBS))
    between = b[..., 1, :] - b[..., 0, :]
    d = np.hypot(between[..., 0], between[..., 1])
    r, s = design.distal
    slack = MEETING * design.size
    apart = (d > r + s + slack) | (d < abs(r - s) - slack) | (d <= slack)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = 0.5 * (d + (r - s) * (r + s) / d)
        four_areas = (r + s + d) * np.maximum(r + s - d, 0.0)
        four_areas = four_areas * np.maximum(d + r - s, 0.0) * np.maximum(d - r + s, 0.0)
        up = np.where(apart, np.nan, np.sqrt(four_areas) / (2.0 * d))
        unit = between / d[..., None]
    left = np.stack([-unit[..., 1], unit[..., 0]], axis=-1)
    foot = b[..., 0, :] + along[..., None] * unit
    points = np.stack([foot + up[..., None] * left, foot - up[..., None] * left], axis=-2)
    points.setflags(write=False)
    return points


class Forward(ForwardFacet[FiveBarDesign]):
    """Two circles, two points."""

    counted_from = 0
    none_real = ""  # the notes say why

    @property
    def size(self) -> float:
        return float(min(self.design.size, self.design.distal.min()))

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        return True

    def solve(self, joints: Array, *, mixed_modes: bool) -> list[ForwardSolutions]:
        points = both_points(self.design, joints)
        return self.answers([_found(self.design, *one) for one in zip(joints, points, strict=True)])

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        """An assembly mode keeps its sign of the determinant as long as it is real; where both end
        on the way, they have merged with each other, and what is real at the end is new.
        """
        (now,) = self([joints])
        crossing = first_crossing(self.design, before.joints, now.joints)
        if crossing is None and len(before) == len(now):
            order = [_same_side(before, sign) for sign in np.sign(now.determinant)]
            kept = tuple(before.identities[n] for n in order)
            return Refreshed(replace(now, identities=kept), (), ())
        fresh = (number for number in count(0) if number not in before.identities)
        new = tuple(islice(fresh, len(now)))
        merged: tuple[Merged, ...] = ()
        if len(before):
            last = before.poses[0] if crossing is None else crossing.point
            pose = (float(last[0]), float(last[1]))
            pairs = zip(before.identities, reversed(before.identities), strict=True)
            merged = tuple(
                Merged(one, two if two != one else None, pose, before.modes[n])
                for n, (one, two) in enumerate(pairs)
            )
        return Refreshed(replace(now, identities=new), new, merged)


def _found(design: FiveBarDesign, joints: Array, points: Array) -> Found:
    b = elbows(design, joints)
    between = float(np.hypot(*(b[1] - b[0])))
    r, s = design.distal.tolist()
    slack = MEETING * design.size
    notes: tuple[str, ...] = ()
    motions: tuple[SelfMotion, ...] = ()
    times, count = 1, 2
    if between <= slack and abs(r - s) > slack:
        notes = ("B₁ and B₂ coincide and the distal links differ, so P cannot be put",)
        points, count = points[:0], 0
    elif between <= slack:
        motions = (_circle(design, joints, b[0], r),)
        notes = ("B₁ and B₂ coincide: P moves freely on a circle about them",)
        points, times = np.array([motions[0].pose]), 2
    elif not np.isfinite(points).all():
        far = between > r + s
        word = "further apart than the distal links reach" if far else "too near to one another"
        notes = (f"B₁ and B₂ are {between:.6g} mm apart, {word}: no assembly mode is real",)
        points = points[:0]
    elif float(np.hypot(*(points[0] - points[1]))) <= 1e-9 * design.size:
        notes = ("both assembly modes meet here: a parallel singularity",)
        points, times = points[:1], 2
    return Found(
        joints=joints,
        poses=points,
        modes=tuple(mode_of(design, points, np.broadcast_to(joints, (len(points), LIMBS)))),
        multiplicity=np.full(len(points), times),
        roots=_complex_points(design, b) if count else np.zeros((0, 2), dtype=complex),
        count=count,
        expected=2,
        complete=not motions,
        method="the two points in which the circles of the distal links meet",
        notes=notes,
        self_motions=motions,
    )


def _complex_points(design: FiveBarDesign, b: Array) -> np.ndarray:
    """Both solutions, real or conjugate, as complex (x, y); none where B_1 = B_2."""
    between = b[1] - b[0]
    d2 = complex(between @ between)
    if abs(d2) <= (MEETING * design.size) ** 2:
        return np.zeros((0, 2), dtype=complex)
    r, s = design.distal.tolist()
    a = 0.5 + 0.5 * (r - s) * (r + s) / d2
    h = np.sqrt(r * r / d2 - a * a)
    left = np.array([-between[1], between[0]])
    return np.array([b[0] + a * between + sign * h * left for sign in (1.0, -1.0)])


def _circle(design: FiveBarDesign, joints: Array, center: Array, radius: float) -> SelfMotion:
    """P turning about B_1 = B_2; the pose shown is the one farthest from the base."""
    away = np.array([0.0, 1.0]) if center[1] >= 0.0 else np.array([0.0, -1.0])
    p = center + radius * away
    return SelfMotion(
        pose=(float(p[0]), float(p[1])),
        mode=mode_of(design, p, joints)[0],
        direction=(1.0, 0.0),
        text="P turns freely about B₁ = B₂ with both actuators locked",
    )


def _same_side(before: ForwardSolutions, sign: float) -> int:
    """Which solution before had this sign of the determinant."""
    return int(np.argmax(np.sign(before.determinant) * (sign if sign else 1.0)))
