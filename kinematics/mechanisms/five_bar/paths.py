"""What P passes on a straight way in one working mode, and paths that stop where they have to.

Everything that can happen on a line is a root of a polynomial along it: the circles of a limb's
reach and of the ends of its range (degree 2), and the two sextics of parallel singularities (degree
6). Between neighbouring roots nothing changes, so that the middles of the intervals tell what
happens at each root, and nothing is passed over. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import NEAR, Event
from kinematics.answers.solutions import Followed, Posture
from kinematics.arrays import Array, finite
from kinematics.facets.inverse import posture
from kinematics.facets.pose_paths import after_part, along, corners_of, follow_ways
from kinematics.mechanisms.five_bar.curves import sextic
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import in_range, joints_of, signs
from kinematics.mechanisms.five_bar.statics import sines

GAP = 1e-6
"""mm by which a path stops before a singularity."""
_SAME = 1e-9  # of the way: roots that are one
_ZERO = 1e-6  # a sine that is none at a root, which is only found to about 1e-12 of the size


_WHY = {
    "parallel": "before a parallel singularity",
    "serial": "before a serial singularity, where the limb is stretched or folded",
    "stroke": "at the end of a joint's range",
}


class _Way(NamedTuple):
    """A straight way of P, (2,) mm each."""

    start: Array
    end: Array

    @property
    def length(self) -> float:
        return float(np.hypot(*(self.end - self.start)))

    def pose(self, s: float) -> tuple[float, ...]:
        if s == 1.0:
            return tuple(self.end.tolist())
        return tuple((self.start + s * (self.end - self.start)).tolist())


def _ways(corners: Sequence[ArrayLike]) -> list[_Way]:
    return [_Way(np.array(a), np.array(b)) for a, b in pairwise(corners)]


class _State(NamedTuple):
    """Of one place: which limbs close, which are within their range, and the determinant's sign."""

    closes: tuple[bool, ...]
    within: tuple[bool, ...]
    sign: int


def passed(
    design: FiveBarDesign, before: Posture, after: Posture, through: ArrayLike = ()
) -> tuple[Event, ...]:
    """What is passed on the way from one posture to another of the same mode, in order.

    The way is straight, or straight from one to the next of the poses ``through`` (N, 2); fractions
    are of the whole length. Of postures in different modes it is only told that no way was driven.

    Raises:
        InputError: the poses on the way are not two finite numbers each.
    """
    if before.mode != after.mode:
        limb = next(i + 1 for i in range(LIMBS) if before.mode[i] != after.mode[i])
        text = (
            f"working mode {after.mode.replace('-', '−')} was chosen: no way of P leads there "
            f"from {before.mode.replace('-', '−')} but over a serial singularity"
        )
        return (Event("serial", 0.0, before.pose, limb, text, True),)
    between = finite(np.reshape(through, (-1, 2)), name="a pose")
    ways = _ways([before.pose, *between, after.pose])
    return along(ways, lambda way: events(design, way.start, way.end, before.mode))


def events(design: FiveBarDesign, start: Array, end: Array, mode: str) -> tuple[Event, ...]:
    """What the straight way from ``start`` to ``end`` (2,) mm passes in one working mode."""
    signs(mode)
    if float(np.hypot(*(end - start))) <= 1e-12 * design.size:
        return ()
    roots = _roots(design, start, end)
    marks = [0.0, *roots, 1.0]
    middles = [0.5 * (a + b) for a, b in pairwise(marks)]
    states = [_state(design, start + s * (end - start), mode) for s in middles]
    found: list[Event] = []
    for s, before, after in zip(roots, states[:-1], states[1:], strict=True):
        found += _at(design, start + s * (end - start), s, before, after, mode)
    return tuple(found)


def path(design: FiveBarDesign, start: Posture, poses: ArrayLike) -> Followed:
    """Follow straight lines through poses (N, 2), in the start's mode.

    The path stops `GAP` before a singularity that it would cross or touch, and at the end of a
    joint's range. ``fraction`` is of the whole length.

    Raises:
        InputError: no poses, or not two finite numbers each.
    """
    return follow_ways(
        start,
        _ways([start.pose, *corners_of(poses, ("x", "y"))]),
        events=lambda way: events(design, way.start, way.end, start.mode),
        posture=lambda pose: posture(design, pose, start.mode),
        back=lambda way: GAP / way.length,
        why=lambda event, _, part: f"stopped {after_part(part)}, {_WHY[event.kind]}",
        warning=lambda here, stopped: "" if stopped else warning(design, here),
    )


def warning(design: FiveBarDesign, at: Posture) -> str:
    """A word where a posture stands near a singularity; "" as a rule."""
    if not at.closes:
        return ""
    limbs, between = sines(design, np.array(at.pose), np.array(at.joints))
    if abs(float(between)) < NEAR:
        return "near a parallel singularity: the distal links are nearly in line"
    for i in range(LIMBS):
        if abs(float(limbs[i])) < NEAR:
            return f"near a serial singularity: limb {i + 1} is nearly stretched or folded"
    return ""


# --- inside --------------------------------------------------------------------------------


def _state(design: FiveBarDesign, p: Array, mode: str) -> _State:
    joints = joints_of(design, p, mode)
    within = in_range(design, joints)
    _, between = sines(design, p, joints)
    sign = 0 if not np.isfinite(between) else (1 if between > 0.0 else -1)
    return _State(tuple(np.isfinite(joints).tolist()), tuple(within.tolist()), sign)


def _at(
    design: FiveBarDesign, p: Array, s: float, before: _State, after: _State, mode: str
) -> Iterator[Event]:
    """What happens at one root of the way."""
    pose = (float(p[0]), float(p[1]))
    where = after_part(s)
    for i in range(LIMBS):
        limb = i + 1
        if before.closes[i] and not after.closes[i]:
            text = f"P left the reach of limb {limb} {where}, at its serial singularity"
            yield Event("serial", s, pose, limb, text, True)
        elif after.closes[i] and not before.closes[i]:
            text = f"P came back within the reach of limb {limb} {where}"
            yield Event("serial", s, pose, limb, text, False)
        elif before.closes[i] and np.hypot(*(p - design.base[i])) <= 1e-9 * design.size:
            text = f"P passed A{SUBSCRIPTS[i]} {where}, where limb {limb} is folded onto its base"
            yield Event("serial", s, pose, limb, text, True)
        elif before.within[i] and not after.within[i]:
            text = f"θ{SUBSCRIPTS[i]} passed the end of its range {where}"
            yield Event("stroke", s, pose, limb, text, True)
        elif after.within[i] and not before.within[i]:
            text = f"θ{SUBSCRIPTS[i]} is back within its range {where}"
            yield Event("stroke", s, pose, limb, text, False)
    based = np.linalg.norm(p - design.base, axis=-1) <= 1e-9 * design.size
    if based.any() or not (all(before.closes) and all(after.closes)):
        return  # on a base joint its angle leaps, and with it the determinant
    if before.sign != after.sign:
        text = f"crossed a parallel singularity {where}: the machine is now in another aspect"
        yield Event("parallel", s, pose, None, text, True)
        return
    _, between = sines(design, p, joints_of(design, p, mode))
    if abs(float(between)) <= _ZERO:
        text = f"touched a parallel singularity {where}, without crossing it"
        yield Event("parallel", s, pose, None, text, True)


def _roots(design: FiveBarDesign, start: Array, end: Array) -> list[float]:
    """Everything at which something may happen, in (0, 1), increasing."""
    found: list[float] = []
    for i in range(LIMBS):
        limb, base = design.limbs[i], design.base[i]
        for radius in (limb.proximal + limb.distal, abs(limb.proximal - limb.distal)):
            found += _circle(base, radius, start, end)
        if limb.joint_range_deg is not None:
            for angle in design.joint_range[i].tolist():
                elbow = base + limb.proximal * np.array([np.cos(angle), np.sin(angle)])
                found += _circle(elbow, limb.distal, start, end)
    for side in (1, -1):
        found += _sextic(design, start, end, side)
    every = sorted(s for s in found if 0.0 < s < 1.0)
    return [s for n, s in enumerate(every) if n == 0 or s - every[n - 1] > _SAME]


def _circle(center: Array, radius: float, start: Array, end: Array) -> list[float]:
    """Where a line meets a circle; of a circle of no radius where it passes the center."""
    way, away = end - start, start - center
    length2 = float(way @ way)
    nearest = -float(away @ way) / length2
    across = float(away[0] * way[1] - away[1] * way[0]) ** 2 / length2
    square = (radius**2 - across) / length2
    if square < 0.0:
        slack = 1e-18 * (length2 + radius**2 + float(away @ away)) / length2
        return [nearest] if square > -slack else []
    half = float(np.sqrt(square))
    return [nearest - half, nearest + half]


def _sextic(design: FiveBarDesign, start: Array, end: Array, side: int) -> list[float]:
    """The real roots of a sextic along a line, polished by Newton's method."""
    # In Chebyshev's polynomials over a little more than the way, which keeps the digits.
    node = np.cos(np.pi * (np.arange(7) + 0.5) / 7)
    share = 0.5 + 0.55 * node
    value, _ = sextic(design, start + share[:, None] * (end - start), side)
    series = np.polynomial.Chebyshev.fit(node, value, 6, domain=[-1.0, 1.0])
    scale = float(np.abs(series.coef).max())
    if scale == 0.0:
        return []
    trimmed = series.trim(1e-14 * scale)
    if trimmed.degree() < 1:
        return []
    roots = trimmed.roots()
    # A double root, where a curve is touched, comes out as a pair that is nearly real.
    real = np.real(roots[np.abs(np.imag(roots)) < 1e-5])
    at = 0.5 + 0.55 * real
    way = end - start
    for _ in range(4):
        value, gradient = sextic(design, start + at[:, None] * way, side)
        slope = gradient @ way
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope == 0.0, 0.0, value / slope)
        at = np.where(np.abs(step) < 1e-4, at - step, at)
    roots_found: list[float] = at.tolist()
    return roots_found
