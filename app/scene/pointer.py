"""Where a person points at in the scene, and what is near that. Lengths in px unless said."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser.transforms as tf

from kinematics.arrays import Array

POINTER = "Pointer"
"""Label of the hidden box into which browsers write where it is."""
PRESSED = "pressed"
"""What stands behind it where a button was pressed."""
NEAR = 24.0  # px; something that is nearer is pointed at


@dataclass(frozen=True, eq=False, slots=True)
class Pointer:
    """A person's pointer.

    Attributes:
        client: whose it is.
        tab: which of the tabs is open, from 0.
        spot: from the upper left of the scene; None while the pointer is elsewhere.
        pressed: the button was pressed there and let go again.
    """

    client: Any
    tab: int
    spot: tuple[float, float] | None
    pressed: bool = False

    def distances(self, points: Array) -> Array:
        """How far points (N, 3) mm are from it on the screen, (N,); ∞ for what is not seen."""
        if self.spot is None or self.client is None:
            return np.full(len(points), np.inf)
        camera = self.client.camera
        there, depth = on_screen(camera, points)
        away = np.hypot(*(there - self.spot).T)
        return np.where(depth > 0.0, away, np.inf)

    def place(self, points: Array) -> Array | None:
        """What it points at, (3,) mm: the nearest of points (N, 3), if one is near; else as far off
        as what the camera looks at. None while it is not in the scene."""
        if self.spot is None or self.client is None:
            return None
        away = self.distances(points)
        if len(points) and away.min() <= NEAR:
            return np.asarray(points[int(away.argmin())])
        camera = self.client.camera
        x, y = np.subtract(self.spot, 0.5 * np.array([camera.image_width, camera.image_height]))
        turn = tf.SO3(np.asarray(camera.wxyz)).as_matrix()
        position = np.asarray(camera.position)
        depth = float((np.asarray(camera.look_at) - position) @ turn[:, 2])
        scale = depth / _scale(camera)
        return np.asarray(position + turn @ np.array([x * scale, y * scale, depth]))

    def length(self, mm: float, at: Array) -> float:
        """How long ``mm`` at a point (3,) are on the screen; 0 while that is not seen."""
        if self.client is None:
            return 0.0
        depth = float(on_screen(self.client.camera, at[None])[1][0])
        return mm * _scale(self.client.camera) / depth if depth > 0.0 else 0.0


def on_screen(camera: Any, points: Array) -> tuple[Array, Array]:
    """Where points (N, 3) mm are in a camera's picture, (N, 2), and how far before it, (N,) mm.

    The camera looks along its z, its y is down (`viser.CameraHandle`).
    """
    turn = tf.SO3(np.asarray(camera.wxyz)).as_matrix()
    x, y, depth = ((points - np.asarray(camera.position)) @ turn).T
    scale = _scale(camera) / np.where(np.abs(depth) < 1e-9, 1e-9, depth)
    middle = 0.5 * np.array([camera.image_width, camera.image_height])
    return np.stack([x * scale, y * scale], axis=1) + middle, depth


def _scale(camera: Any) -> float:
    return 0.5 * float(camera.image_height) / math.tan(0.5 * float(camera.fov))
