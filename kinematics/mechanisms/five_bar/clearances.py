"""How far P of the five-bar is from singularities, the boundary and the ends of joint ranges.

Distances are to exact curves: arcs of the workspace's boundary, and the parallel singularities of
the posture's working mode. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from kinematics.answers.bounds import Bound, bound_of, range_of
from kinematics.answers.clearances import Clearance, ClearanceKind
from kinematics.answers.sections import BOUNDS
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.curve_pieces import Piece, pieces
from kinematics.mechanisms.five_bar.design import LIMBS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import LIMITS
from kinematics.mechanisms.five_bar.loci import base_points
from kinematics.mechanisms.five_bar.nearest_pose import NearestPose, nearest_on

_SAMPLES = 257
_LINK = BOUNDS.index("link")


class Clearances(NearestPose):
    """Of the posture's own working mode."""

    def to_bounds(self, posture: Posture) -> Iterator[Clearance]:
        """The boundary; for each limb the place where its working mode changes, and the ends of its
        range. None where the posture cannot be held.
        """
        design = self.design
        if not posture.reachable:
            return
        p = np.array(posture.pose)
        edges = [edge for loop in workspace.loops(design, (posture.mode,)) for edge in loop]
        nearest = nearest_on(edges, p)
        if nearest is not None:
            edge, point = nearest
            limb = int(edge.shown.limb[0])
            bound = bound_of(LIMITS, limb, BOUNDS[int(edge.shown.bound[0])])
            yield _clearance(design, "boundary", p, point, "the workspace ends", bound)
        for i in range(LIMBS):
            of_limb = [edge for edge in edges if int(edge.shown.limb[0]) == i + 1]
            links = [edge for edge in of_limb if int(edge.shown.bound[0]) == _LINK]
            places = [] if not links else [nearest_on(links, p)]
            points = [each[1] for each in places if each is not None]
            if i in base_points(design):
                points.append(design.base[i])
            if points:
                point = min(points, key=lambda each: float(np.hypot(*(each - p))))
                text = f"limb {i + 1} comes to its serial singularity"
                link = bound_of(LIMITS, i + 1, "link")
                yield _clearance(design, "mode", p, point, text, link)
            for bound in range_of(LIMITS, i + 1):
                ends = [e for e in of_limb if BOUNDS[int(e.shown.bound[0])] == bound]
                end = nearest_on(ends, p)
                if end is not None:
                    text = f"{bound.joint} comes to the end of its range"
                    yield _clearance(design, "stroke", p, end[1], text, bound)

    def to_singularities(self, posture: Posture) -> Iterator[Clearance]:
        p = np.array(posture.pose)
        curve = nearest_parallel(self.design, posture.mode, p) if posture.reachable else None
        if curve is not None:
            point, extended = curve
            how = "B₁, P and B₂ come into line" if extended else "the distal links fold together"
            yield _clearance(self.design, "parallel", p, point, how)


def _clearance(
    design: FiveBarDesign,
    kind: ClearanceKind,
    p: Array,
    point: Array,
    what: str,
    bound: Bound | None = None,
) -> Clearance:
    distance = float(np.hypot(*(point - p)))
    text = f"{distance:.1f} mm to where {what}"
    x, y = (float(v) for v in point)
    limb = None if bound is None else bound.limb
    return Clearance(kind, distance, (x, y, 0.0), text, limb, bound or "", 1e-9 * design.size)


def nearest_parallel(design: FiveBarDesign, mode: str, p: Array) -> tuple[Array, bool] | None:
    """The nearest parallel singularity of a working mode: the point, and whether extended."""
    table = _sampled(design, mode)
    if not table:
        return None
    best, found = np.inf, None
    ranked = sorted(table, key=lambda each: float(np.hypot(*(each[2] - p).T).min()))
    for piece, share, points in ranked:
        distance = np.hypot(*(points - p).T)
        if distance.min() > best + 2.0 * _longest(points):
            break
        inner = (distance <= np.roll(distance, 1)) & (distance <= np.roll(distance, -1))
        for n in np.flatnonzero(inner & (distance < best + 2.0 * _longest(points))).tolist():
            low, high = share[max(n - 1, 0)], share[min(n + 1, len(share) - 1)]
            point, value = _least(piece, p, float(low), float(high))
            if value < best:
                best, found = value, (point, piece.loop.side == 1)
    return found


@lru_cache(maxsize=64)
def _sampled(design: FiveBarDesign, mode: str) -> list[tuple[Piece, Array, Array]]:
    table = []
    for piece in pieces(design):
        if piece.mode == mode:
            share = np.linspace(0.0, 1.0, _SAMPLES)
            table.append((piece, share, piece.loop.points(piece.tau(share))[0]))
    return table


def _longest(points: Array) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).max())


def _least(piece: Piece, p: Array, low: float, high: float) -> tuple[Array, float]:
    """The nearest point on a part of a piece, and how near, by ever finer samples."""
    for _ in range(8):
        share = np.linspace(low, high, 33)
        points = piece.loop.points(piece.tau(share))[0]
        distance = np.hypot(*(points - p).T)
        n = int(distance.argmin())
        low, high = float(share[max(n - 1, 0)]), float(share[min(n + 1, 32)])
    return points[n], float(distance[n])
