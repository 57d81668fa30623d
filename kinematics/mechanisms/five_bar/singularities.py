"""Where the five-bar loses control: at a posture, how far away that is, and the way back in.

Distances are to exact curves: arcs of the workspace's boundary, and the parallel singularities of
the posture's working mode. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from itertools import product

import numpy as np

from kinematics.answers.bounds import bound_of, range_of
from kinematics.answers.clearances import Clearance, ClearanceKind, DesignChange, Remedy
from kinematics.answers.sections import BOUNDS
from kinematics.answers.singularities import AT, Singularity, SingularityKind
from kinematics.answers.solutions import Posture, Reason
from kinematics.arrays import Array
from kinematics.errors import DesignError
from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.curves import Piece, pieces
from kinematics.mechanisms.five_bar.design import (
    LIMBS,
    SCHEMA,
    SUBSCRIPTS,
    FiveBarDesign,
)
from kinematics.mechanisms.five_bar.inverse import LIMITS, MODES, elbows
from kinematics.mechanisms.five_bar.loci import base_points
from kinematics.mechanisms.five_bar.motion import sines
from kinematics.plane import arcs
from kinematics.plane.arcs import Edge

_SAMPLES = 257
_LINK = BOUNDS.index("link")
_IN = 1e-9  # of the size: how far inside the boundary the nearest posture is put


# --- at a posture --------------------------------------------------------------------------


def singularities(
    design: FiveBarDesign, at: Posture, tolerance: float = AT
) -> tuple[Singularity, ...]:
    """What control is lost at a posture; empty as a rule, and where it does not close.

    Measures are sines of angles between links; below ``tolerance`` they count as none.
    """
    if not at.closes:
        return ()
    p, q = np.array(at.pose), np.array(at.joints)
    limbs, between = sines(design, p, q)
    found: list[Singularity] = []
    for i in range(LIMBS):
        rho = float(np.hypot(*(p - design.base[i])))
        if rho <= tolerance * design.size:
            text = f"with P on A{SUBSCRIPTS[i]} limb {i + 1} may turn as it likes"
            found.append(
                Singularity("serial", (i + 1,), f"limb {i + 1} is folded onto its base", text, 0.0)
            )
        elif abs(float(limbs[i])) <= tolerance:
            far = rho > float(design.proximal[i])
            cause = f"limb {i + 1} is {'stretched' if far else 'folded'}"
            text = f"P cannot be moved along limb {i + 1} by its actuator, whose two solutions meet"
            found.append(Singularity("serial", (i + 1,), cause, text, abs(float(limbs[i]))))
    if abs(float(between)) <= tolerance:
        found.append(_parallel(design, p, q, abs(float(between))))
    return tuple(found)


def _parallel(design: FiveBarDesign, p: Array, q: Array, measure: float) -> Singularity:
    b = elbows(design, q)
    unit = (p - b[0]) / design.distal[0]
    free = np.array([-unit[1], unit[0]])
    kind: SingularityKind = "parallel"
    together = float(np.hypot(*(b[1] - b[0]))) <= AT * design.size
    if together:
        cause, kind = "B₁ and B₂ coincide", "self-motion"
        text = "P turns freely about B₁ = B₂ with both actuators locked"
    else:
        extended = float(unit @ (p - b[1])) < 0.0
        cause = "B₁, P and B₂ are in line" + ("" if extended else ", folded")
        text = "P can move across the line of its distal links although both actuators are locked"
    return Singularity(
        kind,
        (1, 2),
        cause,
        text,
        measure,
        motion=(float(free[0]), float(free[1])),
        twist=(0.0, 0.0, 0.0, float(free[0]), float(free[1]), 0.0),
    )


# --- how far away --------------------------------------------------------------------------


def clearances(
    design: FiveBarDesign, at: Posture, *, singular: bool = True
) -> tuple[Clearance, ...]:
    """How far P is from singularities, the boundary and the ends of joint ranges, nearest first.

    Of its own working mode: the nearest parallel singularity; the boundary; for each limb the place
    where its working mode changes, and the ends of its range. Empty where the posture cannot be
    held; without the parallel one if not ``singular``.
    """
    if not at.reachable:
        return ()
    p = np.array(at.pose)
    found: list[Clearance] = []
    curve = nearest_parallel(design, at.mode, p) if singular else None
    if curve is not None:
        point, extended = curve
        how = "B₁, P and B₂ come into line" if extended else "the distal links fold together"
        found.append(_clearance(design, "parallel", p, point, f"{how}", 0, ""))
    edges = [edge for loop in workspace.loops(design, (at.mode,)) for edge in loop]
    nearest = nearest_on(edges, p)
    if nearest is not None:
        edge, point = nearest
        limb = int(edge.shown.limb[0])
        bound = bound_of(LIMITS, limb, BOUNDS[int(edge.shown.bound[0])])
        found.append(_clearance(design, "boundary", p, point, "the workspace ends", limb, bound))
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
            found.append(
                _clearance(design, "mode", p, point, text, i + 1, bound_of(LIMITS, i + 1, "link"))
            )
        for bound in range_of(LIMITS, i + 1):
            ends = [e for e in of_limb if BOUNDS[int(e.shown.bound[0])] == bound]
            end = nearest_on(ends, p)
            if end is not None:
                text = f"θ{SUBSCRIPTS[i]} comes to the end of its range"
                found.append(_clearance(design, "stroke", p, end[1], text, i + 1, bound))
    return tuple(sorted(found, key=lambda each: each.distance))


def _clearance(
    design: FiveBarDesign,
    kind: ClearanceKind,
    p: Array,
    point: Array,
    what: str,
    limb: int,
    bound: str,
) -> Clearance:
    distance = float(np.hypot(*(point - p)))
    text = f"{distance:.1f} mm to where {what}"
    x, y = (float(v) for v in point)
    return Clearance(
        kind,
        distance,
        (x, y, 0.0),
        text,
        limb or None,
        bound,
        1e-9 * design.size,
    )


def nearest_on(edges: list[Edge], p: Array) -> tuple[Edge, Array] | None:
    """The edge nearest to P, and the point on it; edges are single arcs."""
    if not edges:
        return None
    k, point = arcs.nearest(arcs.joined([edge.shown for edge in edges]), p)
    return edges[k], point


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


def parallel_distance(design: FiveBarDesign, mode: str, points: Array) -> Array:
    """mm from points (N, 2) to the nearest parallel singularity of a mode; inf: there is none."""
    found = [nearest_parallel(design, mode, point) for point in points]
    return np.array(
        [
            np.inf if each is None else float(np.hypot(*(each[0] - point)))
            for each, point in zip(found, points, strict=True)
        ]
    )


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


# --- the way back in -----------------------------------------------------------------------


def remedy(design: FiveBarDesign, at: Posture) -> Remedy:
    """The nearest posture that can be held, and the changes of the design that allow this one."""
    if at.reachable:
        return Remedy(at, 0.0, (), "the pose can be held as it is")
    p = np.array(at.pose)
    nearest, distance = None, float("inf")
    for mode in (at.mode, *(other for other in MODES if other != at.mode)):
        edges = [edge for loop in workspace.loops(design, (mode,)) for edge in loop]
        found = nearest_on(edges, p)
        if found is None:
            continue
        inside = _into(design, found[0], found[1], mode)
        if inside is not None and (nearest is None or mode == at.mode):
            nearest, distance = inside, float(np.hypot(*(np.array(inside.pose) - p)))
            break
    changes = _changes(design, at)
    others = tuple(m for m in MODES if m != at.mode and posture(design, at.pose, m).reachable)
    if nearest is None:
        text = "the limbs do not reach a common place, so no pose can be held"
    elif nearest.mode == at.mode:
        text = f"the nearest place that can be held is {distance:.1f} mm away"
    else:
        text = (
            f"the nearest place that can be held is {distance:.1f} mm away, in working mode "
            f"{nearest.mode.replace('-', '−')}"
        )
    if changes:
        text += f"; or {' and '.join(change.text for change in changes[0])}"
    return Remedy(nearest, distance, changes, text, others, 2e-6 * design.size)


def _into(design: FiveBarDesign, edge: Edge, point: Array, mode: str) -> Posture | None:
    """A posture at a point of the boundary, or as little inside as rounding asks for."""
    centroid = np.mean([edge.first, edge.last], axis=0)
    ways = [point - edge.shown.center[0], edge.shown.center[0] - point, centroid - point]
    for part in (0.0, _IN, 1e3 * _IN):
        for way in ways:
            length = float(np.hypot(*way))
            if length > 0.0:
                aside = point + way * (part * design.size / length)
                tried = posture(design, (float(aside[0]), float(aside[1])), mode)
                if tried.reachable:
                    return tried
    return None


def _changes(design: FiveBarDesign, at: Posture) -> tuple[tuple[DesignChange, ...], ...]:
    """For each limb every single number that would do; together they must allow the pose."""
    options = [list(_options(design, at, reason)) for reason in at.reasons]
    found: list[tuple[float, tuple[DesignChange, ...]]] = []
    for together in product(*options):
        changed: FiveBarDesign = design
        try:
            for path, value in together:
                changed = SCHEMA.changed(changed, path, value)
        except DesignError:
            continue
        if not posture(changed, at.pose, at.mode).reachable:
            continue
        changes = tuple(_described(design, path, value) for path, value in together)
        size = sum(abs(c.after - c.before) for c in changes)
        found.append((size, changes))
    found.sort(key=lambda each: each[0])
    return tuple(changes for _, changes in found)


Path = tuple[str | int, ...]


def _options(design: FiveBarDesign, at: Posture, reason: Reason) -> Iterator[tuple[Path, float]]:
    """Numbers of the design that bring one limb within one bound, a breath further in."""
    i = reason.limb - 1
    p = np.array(at.pose)
    amount = reason.amount * (1.0 + 1e-9) + 1e-9 * design.size
    if reason.unit == "rad":
        end = int(reason.bound == "rho_max")
        limit = float(design.joint_range[i, end])
        yield ("joint_range_deg", i, end), limit + (amount if end else -amount)
        return
    limb = design.limbs[i]
    rho = float(np.hypot(*(p - design.base[i])))
    far = rho > limb.proximal + limb.distal
    if far:
        yield ("proximal", i), limb.proximal + amount
        yield ("distal", i), limb.distal + amount
    else:
        sign = 1.0 if limb.proximal > limb.distal else -1.0
        yield ("proximal", i), limb.proximal - sign * amount
        yield ("distal", i), limb.distal + sign * amount
    # |P − A_i| as wanted: x ± r_3 = ± sqrt(R² − y²).
    wanted = limb.proximal + limb.distal - 1e-9 * design.size
    wanted = wanted if far else abs(limb.proximal - limb.distal) + 1e-9 * design.size
    square = wanted**2 - float(p[1]) ** 2
    if square >= 0.0:
        side = -1.0 if i == 0 else 1.0
        for root in (square**0.5, -(square**0.5)):
            half = side * (float(p[0]) - root)
            if half > 0.0:
                yield ("half_base",), half


def _described(design: FiveBarDesign, path: Path, value: float) -> DesignChange:
    field = next(each for each in SCHEMA.fields(design) if each.path == path)
    where = "" if field.group == "Base" else f" of {field.group.lower()}"
    if field.unit == "rad":
        before, after = np.degrees([field.value, value])
        text = f"move {field.label} from {before:.1f}° to {after:.1f}°"
    else:
        text = f"change the {field.label}{where} from {field.value:.1f} to {value:.1f} mm"
    return DesignChange(path, field.label, field.value, value, text)
