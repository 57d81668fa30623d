"""Load, forces and motion as arrows in the scene; the load's is one that a person drags."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from app.features.singularities.compute import Here
from app.features.singularities.state import Control
from app.review.view import View
from app.scene import palette
from app.scene.machine import Scene
from kinematics.arrays import Array

MOST = 8  # forces that are drawn
USUAL_LOAD = 100.0  # N


class Loads:
    """Scene nodes, made once for a mechanism, then only moved."""

    def __init__(
        self, scene: Scene, pulled: Callable[[str, int | None, tuple[float, ...]], None]
    ) -> None:
        self._scene = scene
        self._on_pull = pulled
        self.pulled = False  # a hand holds the arrow's tip and decides where it is
        self._forces: Any = None
        self._force_labels: list[Any] = []
        self._load: Any = None
        self._tip: Any = None
        self._rates: Any = None
        self._rate_labels: list[Any] = []

    def prepare(self, size: float) -> None:
        """Make the nodes, with nothing to see."""
        scene = self._scene.server.scene
        self._forces, self._load, self._rates = (
            scene.add_arrows(
                f"/control/{name}",
                np.zeros((1, 2, 3), np.float32),
                palette.rgb(palette.INK),
                shaft_radius=thick * size,
                head_radius=3.0 * thick * size,
                head_length=0.06 * size,
                visible=False,
            )
            for name, thick in (("forces", 0.012), ("load", 0.014), ("rates", 0.008))
        )
        self._force_labels, self._rate_labels = (
            [
                scene.add_label(
                    f"/control/labels/{name}{n}", "", anchor="bottom-center", visible=False
                )
                for n in range(count)
            ]
            for name, count in (("force", MOST), ("rate", 2))
        )
        self._tip = scene.add_transform_controls(
            "/control/tip",
            scale=0.2 * size,
            line_width=3.0,
            disable_rotations=True,
            depth_test=False,
            visible=False,
        )

        async def dragged(event: Any) -> None:
            tip = tuple(float(v) for v in event.target.position)
            self._on_pull(event.phase, event.client_id, tip)

        self._tip.on_update(dragged)

    def show(self, view: View, here: Here | None) -> None:
        """Bring them to what is known of the present place."""
        self._show_forces(here if view.review[Control].forces else None, view.drawing.size)
        self._show_load(view)
        self._show_rates(view, here)

    def _show_forces(self, here: Here | None, size: float) -> None:
        """What each limb exerts on the platform as an arrow at its end, named by its actuator."""
        arrows: list[tuple[Array, Array, str, str]] = []
        if here is not None and here.wrenches is not None and here.statics is not None:
            system, values = here.wrenches, np.asarray(here.statics.forces)
            forces = here.exerted[:, None] * np.asarray(system.rows)[:, :3]
            lengths = np.linalg.norm(forces, axis=1)
            largest = float(np.nanmax(lengths, initial=0.0))
            for n, (name, unit) in enumerate(zip(system.names, here.force_units, strict=True)):
                if not (np.isfinite(lengths[n]) and lengths[n] > 1e-9 * largest):
                    continue
                tip = system.point[n] + 0.45 * size * forces[n] / largest
                color = palette.limb_color(name.limb) if name.limb else palette.INK
                what = ""
                if name.kind == "actuation" and unit == "N":
                    what = " push" if values[n] >= 0 else " pull"
                text = f"{abs(values[n]):.3g} {unit}{what}"
                arrows.append((system.point[n], tip, color, text))
        self._arrow_set(self._forces, self._force_labels, arrows)

    def _show_load(self, view: View) -> None:
        control = view.review[Control]
        origin = view.platform[:3, 3]
        tip = origin + self.scale(view) * np.array(control.load[:3])
        arrows = [(origin, tip, palette.LOAD, "")] if control.arrow else []
        self._arrow_set(self._load, [], arrows)
        if self._tip.visible != control.arrow:
            self._tip.visible = control.arrow
        if control.arrow and not self.pulled:
            self._tip.position = tuple(float(v) for v in tip)

    def _show_rates(self, view: View, here: Here | None) -> None:
        """The velocity of O′ and its acceleration, each as long as suits the eye."""
        arrows: list[tuple[Array, Array, str, str]] = []
        if here is not None and here.motion is not None:
            origin, size = view.platform[:3, 3], view.drawing.size
            rows = (
                (here.motion.twist, palette.VELOCITY, "mm/s"),
                (here.motion.twist_rate, palette.ACCELERATION, "mm/s²"),
            )
            for twist, color, unit in rows:
                linear = np.asarray(twist)[3:]
                length = float(np.linalg.norm(linear))
                if np.isfinite(length) and length > 1e-9:
                    tip = origin + 0.5 * size * linear / length
                    arrows.append((origin, tip, color, f"{length:.3g} {unit}"))
        self._arrow_set(self._rates, self._rate_labels, arrows)

    @staticmethod
    def _arrow_set(
        node: Any, labels: list[Any], arrows: list[tuple[Array, Array, str, str]]
    ) -> None:
        if node.visible != bool(arrows):
            node.visible = bool(arrows)
        if arrows:
            node.points = np.array([(a, b) for a, b, _, _ in arrows], dtype=np.float32)
            node.colors = np.array([palette.rgb(c) for _, _, c, _ in arrows], np.uint8)
        for n, label in enumerate(labels):
            seen = n < len(arrows)
            if label.visible != seen:
                label.visible = seen
            if seen:
                label.text = arrows[n][3]
                label.position = tuple(float(v) for v in arrows[n][1])

    @staticmethod
    def scale(view: View) -> float:
        """mm of the load's arrow for each N: the usual load is half as long as the machine."""
        return 0.5 * view.drawing.size / USUAL_LOAD

    def force_of(self, view: View, tip: tuple[float, ...]) -> tuple[float, ...]:
        """The force whose arrow ends there, N, to the digits of the page."""
        force = (np.array(tip) - view.platform[:3, 3]) / self.scale(view)
        return tuple(round(float(v), 1) for v in force)
