"""What a pointer in the scene is on: a point that is near, else a line, else a body's plane."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from app.features.marks.compute import Thing, Things, thing, typed_place
from app.features.marks.model import LINE, PLANE, POINT, Anchor
from app.review.state import Options
from app.review.view import View
from app.scene.pointer import Pointer, on_screen
from kinematics.answers.drawings import Body
from kinematics.arrays import Array

NEAR = {POINT: 14.0, LINE: 9.0}  # px
SAME = 3.0  # px; of points that are as near as that the one that is before the others


def snapped(pointer: Pointer, view: View, known: Things, corners: Array) -> Thing | None:
    """The thing under a pointer; ``corners`` (N, 3) of solids are points, too."""
    if pointer.spot is None or pointer.client is None:
        return None
    camera, spot = pointer.client.camera, np.array(pointer.spot)
    points = [t for a, t in known.items() if a.kind == POINT]
    places = np.concatenate([np.array([t.at for t in points]).reshape(-1, 3), corners])
    n = _nearest(pointer, places)
    if n is not None:
        return points[n] if n < len(points) else thing(known, typed_place(places[n]))
    lines = [t for t in known.values() if _is_seen(t, view)]
    if lines:
        ends, depth = on_screen(camera, np.array([t.ends for t in lines]).reshape(-1, 3))
        ends = ends.reshape(-1, 2, 2)
        away = _to_segments(spot, ends)
        away[(depth.reshape(-1, 2) <= 0.0).any(axis=1)] = np.inf
        if away.min() <= NEAR[LINE]:
            return lines[int(away.argmin())]
    bodies = [(_covers(camera, spot, body, view), body.role) for body in view.drawing.bodies]
    found = min(((d, role) for d, role in bodies if np.isfinite(d)), default=None)
    return None if found is None else known.get(Anchor(PLANE, found[1]))


def _nearest(pointer: Pointer, places: Array) -> int | None:
    away = pointer.distances(places)
    if not len(away) or away.min() > NEAR[POINT]:
        return None
    depth = on_screen(pointer.client.camera, places)[1]
    return int(np.where(away <= away.min() + SAME, depth, np.inf).argmin())


def _is_seen(of: Thing, view: View) -> bool:
    """Whether a line is drawn."""
    options, name = view.review[Options], of.anchor.name
    if of.anchor.kind != LINE:
        return False
    if name.startswith("axis/"):
        return options.axes
    frame = name.startswith(("base/", "platform/"))
    return options.frames if frame else options.machine


def _to_segments(spot: Array, ends: Array) -> Array:
    """How far (2,) is from segments (N, 2, 2), (N,)."""
    start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    long = np.maximum((way**2).sum(axis=1), 1e-12)
    share = np.clip(((spot - start) * way).sum(axis=1) / long, 0.0, 1.0)
    away: Array = np.linalg.norm(start + share[:, None] * way - spot, axis=1)
    return away


def _covers(camera: object, spot: Array, body: Body, view: View) -> float:
    """How far before the camera a body is that covers a place of its picture; ∞ where it does not.

    A body with a radius covers as much more.
    """
    points = np.array(body.points, dtype=float)
    if body.frame == "platform":
        points = points @ view.platform[:3, :3].T + view.platform[:3, 3]
    around = body.radius * np.concatenate([np.eye(3), -np.eye(3)])
    seen, depth = on_screen(camera, (points[:, None] + around).reshape(-1, 3))
    if not (depth > 0.0).all():
        return np.inf
    try:
        rim = ConvexHull(seen).equations
    except QhullError:
        return np.inf
    inside = (rim[:, :2] @ spot + rim[:, 2] <= 0.0).all()
    return float(depth.mean()) if inside else np.inf
