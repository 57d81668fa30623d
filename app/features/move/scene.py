"""The handle on the platform."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from app.scene.machine import Scene
from kinematics.arrays import Array


def dragged(scene: Scene, act: Callable[[str, int | None, Array], None]) -> None:
    """Call ``act(phase, client, (4, 4))`` when a hand moves the platform's handle."""

    async def moved(event: Any) -> None:
        placed = np.eye(4)
        placed[:3, :3] = viser.transforms.SO3(np.array(event.target.wxyz)).as_matrix()
        placed[:3, 3] = event.target.position
        act(event.phase, event.client_id, placed)

    scene.handle.on_update(moved)
