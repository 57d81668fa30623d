"""Where the scene is seen from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import viser

from app.review.state import is_planar
from app.review.view import View
from app.scene.machine import machine_bounds
from kinematics.arrays import Array

FIELD_OF_VIEW = math.radians(38.0)  # vertical; narrow, as engineers draw

UP = {False: (0.0, 0.0, 1.0), True: (0.0, 1.0, 0.0)}  # by whether it is in the x-y plane

Bounds = tuple[Array, Array]
"""The least and the largest corner of a box, (3,) mm each."""


def fit(server: viser.ViserServer, view: View, more: Sequence[Bounds]) -> None:
    """Show the machine whole, and ``more`` boxes, in every browser and in those to come."""
    boxes = [machine_bounds(view.drawing), *more]
    low = np.min([low for low, _ in boxes], axis=0)
    high = np.max([high for _, high in boxes], axis=0)
    planar, size = is_planar(view.review.machine), view.drawing.size

    up = UP[planar]

    def aim(camera: Any, aspect: float) -> None:
        camera.near, camera.far = size / 100.0, size * 80.0
        camera.fov = FIELD_OF_VIEW
        seen = frame((low, high), from_above=planar, aspect=aspect)
        camera.position, camera.look_at = seen

    server.initial_camera.up = up
    aim(server.initial_camera, 1.0)
    for client in server.get_clients().values():
        with client.atomic():
            client.camera.up_direction = up
            aim(client.camera, client.camera.aspect)


def frame(bounds: Bounds, *, from_above: bool = False, aspect: float = 1.0) -> tuple[Array, Array]:
    """Camera position and target that show a box whole, from the front right above.

    A machine in the x-y plane is seen ``from_above``, as it is drawn. ``aspect``: width by height
    of what it is seen in; a high one needs more distance.
    """
    low, high = bounds
    centre = 0.5 * (low + high)
    radius = 0.5 * float(np.linalg.norm(high - low))
    toward = np.array([0.0, 0.0, 1.0] if from_above else [0.62, -0.95, 0.42])
    half = math.atan(math.tan(0.5 * FIELD_OF_VIEW) * min(max(aspect, 0.2), 1.0))
    distance = 1.02 * radius / math.sin(half)
    return centre + distance * toward / np.linalg.norm(toward), centre
