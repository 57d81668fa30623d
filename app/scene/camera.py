"""Where the scene is seen from: named views, each with everything that is shown whole in it."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from app.review.state import Options, is_planar
from app.review.view import View
from kinematics.answers.drawings import Drawing
from kinematics.arrays import Array

if TYPE_CHECKING:
    import viser

Look = Literal["isometric", "plan", "front", "side", "fit"]
"""From where: "fit" stays where a person looks from."""

FIELD_OF_VIEW = math.radians(30.0)  # vertical; narrow, as engineers draw
NARROW = math.radians(6.0)  # from afar: viser has no parallel camera, and this is nearly one
FILLED = 0.84  # of the picture
ISOMETRIC = np.array([0.55, -0.83, 0.36])
# By whether the machine is in the x-y plane, where up is y. Not quite along what is up: such a
# picture could be turned either way.
_TOWARD = {
    False: {
        "isometric": ISOMETRIC,
        "plan": np.array([0.0, -1e-3, 1.0]),
        "front": np.array([0.0, -1.0, 0.0]),
        "side": np.array([1.0, 0.0, 0.0]),
    },
    True: {
        "isometric": np.array([0.35, -0.55, 0.75]),
        "plan": np.array([0.0, 0.0, 1.0]),
        "front": np.array([0.0, -1.0, 1e-3]),
        "side": np.array([1.0, 0.0, 0.0]),
    },
}
UP = {False: (0.0, 0.0, 1.0), True: (0.0, 1.0, 0.0)}
STILL = 1e-3  # of the camera's distance: it stands where it was put
RESHAPED = 0.02  # of a picture's shape: it has another one
REPORTED = 30.0  # s in which even a slow browser reports where it was made to look
MOST_COVERED = 0.6  # of the picture; the machine has the rest at the least
ASPECT = 1.0  # of a picture that is not known yet


@dataclass(frozen=True, slots=True)
class Camera:
    """From where somebody looks: mm, and the vertical field of view, rad.

    ``aspect``: width by height of the picture; 0 where that is not known.
    """

    position: tuple[float, float, float]
    look_at: tuple[float, float, float]
    up: tuple[float, float, float]
    fov: float
    aspect: float = 0.0

    @property
    def sound(self) -> bool:
        """Whether there is a picture from there."""
        back, up = np.subtract(self.position, self.look_at), np.array(self.up)
        numbers = (*self.position, *self.look_at, *self.up)
        if not all(math.isfinite(v) and abs(v) < 1e7 for v in numbers):
            return False
        across = float(np.linalg.norm(np.cross(back, up)))
        return (
            self.aspect >= 0.0
            and across > 1e-9
            and math.radians(0.5) <= self.fov <= math.radians(150.0)
        )


def camera_of(client: Any) -> Camera:
    """From where a browser looks."""
    seen = client.camera
    places = [np.asarray(at).tolist() for at in (seen.position, seen.look_at, seen.up_direction)]
    position, look_at, up = ((float(x), float(y), float(z)) for x, y, z in places)
    return Camera(position, look_at, up, float(seen.fov), float(seen.aspect))


def turn_to(client: Any, camera: Camera) -> None:
    """Have a browser look from there, in a narrower picture from as much farther off."""
    with client.atomic():
        seen = client.camera
        farther = max(1.0, camera.aspect / max(float(seen.aspect), 0.2))
        back = farther * np.subtract(camera.position, camera.look_at)
        away = float(np.linalg.norm(back))
        seen.up_direction, seen.fov = camera.up, camera.fov
        seen.position = np.add(camera.look_at, back)  # takes along what it looks at
        seen.look_at = camera.look_at
        seen.far = max(float(seen.far), 3.0 * away)


@dataclass(frozen=True, eq=False, slots=True)
class Aim:
    """What a browser was made to look at last: when, from where (3,), with the camera at a position
    (3,) mm, in a picture of a shape.
    """

    at: float
    toward: Array
    position: Array
    aspect: float
    reported: bool = False  # the browser has said that it looks from there

    def confirmed(self, camera: Any) -> bool:
        """Whether a browser reports that it looks from there."""
        away = np.linalg.norm(np.asarray(camera.position) - self.position)
        return float(away) <= STILL * float(np.linalg.norm(self.position))

    def outgrown(self, camera: Any) -> bool:
        """Whether the picture has another shape now, and nobody has turned it since."""
        return self.confirmed(camera) and abs(camera.aspect / self.aspect - 1.0) > RESHAPED


Aims = dict[int, Aim]
"""By client."""


def look(
    server: viser.ViserServer,
    view: View,
    more: Sequence[Array],
    name: Look | None = None,
    client: viser.ClientHandle | None = None,
    covered: tuple[float, float] = (0.0, 0.0),
    aims: Aims | None = None,
) -> None:
    """Show the machine whole, and ``more`` points (N, 3), mm.

    Args:
        aims: from where each browser was made to look last; brought up to date.
        covered: px at the foot and at the left of the scene over which something lies.
        name: from where; None is as the machine is shown at first.
        client: in this browser; None in every one and in those to come.
    """
    planar, size = is_planar(view.review.machine), view.drawing.size
    points = np.concatenate([machine_points(view.drawing), *more])
    parallel = view.review[Options].parallel

    def aim(
        camera: Any,
        aspect: float,
        toward: Array,
        narrow: bool,
        free: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        fov = NARROW if narrow else FIELD_OF_VIEW
        position, target = frame(
            points, toward, fov, aspect, flat=planar, foot=free[0], left=free[1]
        )
        camera.fov = fov
        camera.near = size / 100.0
        camera.far = 80.0 * size + 2.0 * float(np.linalg.norm(position - target))
        camera.position, camera.look_at = position, target

    if client is None:
        server.initial_camera.up = UP[planar]
        aim(server.initial_camera, ASPECT, toward_of(planar), parallel)
    for each in server.get_clients().values() if client is None else (client,):
        kept = name == "fit"
        toward = _seen_from(each, aims) if kept else toward_of(planar, name)
        narrow = parallel or name in ("plan", "front", "side")
        if kept:
            narrow |= each.camera.fov < 0.5 * (NARROW + FIELD_OF_VIEW)
        with each.atomic():
            each.camera.up_direction = UP[planar]
            picture = each.camera.image_height, each.camera.image_width
            foot, left = (
                min(px / max(whole, 1), MOST_COVERED)
                for px, whole in zip(covered, picture, strict=True)
            )
            aspect = each.camera.aspect
            aim(each.camera, aspect, toward, narrow, (foot, left))
        if aims is not None:
            at = np.asarray(each.camera.position)
            aims[each.client_id] = Aim(time.monotonic(), toward, at, aspect)


def toward_of(planar: bool, name: Look | None = None) -> Array:
    """From where a named view is seen, (3,); None: that at first."""
    toward: Array = _TOWARD[planar][name or ("plan" if planar else "isometric")]
    return toward


def _seen_from(client: Any, aims: Aims | None) -> Array:
    """From where a person looks, as a vector.

    What a browser reports until it has set its camera is still from before: of one that has just
    come it is viser's own view, from behind.
    """
    known = None if aims is None else aims.get(client.client_id)
    if known is not None and not known.reported and time.monotonic() - known.at < REPORTED:
        return known.toward
    camera = client.camera
    seen: Array = np.asarray(camera.position) - np.asarray(camera.look_at)
    return seen


def axes_of(toward: Array, *, flat: bool = False) -> tuple[Array, Array, Array]:
    """Right, up and towards the eye, (3,) each, of a picture that is seen from there.

    ``flat``: up is y, not z.
    """
    back = toward / np.linalg.norm(toward)
    right = np.cross(UP[flat], back)
    right /= np.linalg.norm(right)
    return right, np.cross(back, right), back


def frame(
    points: Array,
    toward: Array,
    fov: float,
    aspect: float,
    *,
    flat: bool = False,
    foot: float = 0.0,
    left: float = 0.0,
) -> tuple[Array, Array]:
    """Camera position and target (3,) from which points (N, 3) fill `FILLED` of the picture.

    Args:
        toward: (3,) where from.
        fov: rad, vertical.
        aspect: width by height of the picture.
        foot, left: the shares of the picture, from below and from the left, that are left free.
    """
    right, up, back = axes_of(toward, flat=flat)
    depth, tall = points @ back, math.tan(0.5 * fov)
    ends, away = [], [float(depth.max()) + 1e-6]
    for axis, half, taken in ((right, tall * max(aspect, 0.2), left), (up, tall, foot)):
        # low ≤ (p·a − c·a) / (c·back − p·back) ≤ high for every point p, of the camera c.
        low, high = (half * (taken + side * FILLED * (1.0 - taken)) for side in (-1.0, 1.0))
        least = float((points @ axis + low * depth).min())
        most = float((points @ axis + high * depth).max())
        ends.append((axis, least + most, low + high))
        away.append((most - least) / (high - low))
    distance, middle = max(away), 0.5 * float(depth.min() + depth.max())
    flat_place = sum(
        (0.5 * (both - tilt * distance) * axis for axis, both, tilt in ends), np.zeros(3)
    )
    return flat_place + distance * back, flat_place + middle * back


def machine_points(drawing: Drawing) -> Array:
    """Points (N, 3) mm around a machine: the ends of its bars, its base with its thickness."""
    ends = [p for bar in drawing.bars for p in (bar.start, bar.end)]
    around = np.concatenate([np.eye(3), -np.eye(3)])
    bases = [b for b in drawing.bodies if b.frame == "base"]
    thick = [(np.array(b.points)[:, None] + b.radius * around).reshape(-1, 3) for b in bases]
    return np.concatenate([np.array(ends), *thick])
