"""How the platform is held, in the scene: wrench lines, ways to what is nearest, free motion; load,
forces and motion as arrows, of which the load's is one that a person drags.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from app.features.section.scene import Ball
from app.features.singularities.compute import Here
from app.features.singularities.state import Control
from app.language import tr
from app.review.units import how_far
from app.review.view import View
from app.scene import palette
from app.scene.nodes import Nodes, colors
from app.scene.shapes import body_mesh
from kinematics.answers.clearances import Clearance
from kinematics.answers.motion import WrenchSystem
from kinematics.answers.sections import Sphere
from kinematics.arrays import Array

MOST = 8  # wrenches, clearances and forces that are drawn
REACH = 0.9  # of the machine's size: half a wrench's line
SWING = 0.22  # of the machine's size: how far the free motion is shown
PERIOD, SWINGS = 1.6, 2  # s, and how often
USUAL_LOAD = 100.0  # N
# Those that are named in the scene; more labels would lie one over the other.
_WHAT = {
    "parallel": "singularities.singular",
    "constraint": "singularities.singular",
    "boundary": "limits.boundary",
}

Arrow = tuple[Array, Array, str]
"""From, to, colour."""


def _arrows(nodes: Nodes, node: Any, arrows: list[Arrow]) -> None:
    if arrows:
        nodes.set(node, colors=colors([color for _, _, color in arrows]))
    nodes.points(node, np.array([arrow[:2] for arrow in arrows]))


class Held:
    """Scene nodes, made with nothing to see, then only moved."""

    def __init__(self, nodes: Nodes) -> None:
        self._nodes = nodes
        self._lines = [
            nodes.lines(f"/control/wrench{n}", palette.limb_color(n + 1), 2.0) for n in range(MOST)
        ]
        self._arrows = nodes.arrows("/control/arrows", 0.008)
        self._ways = nodes.lines("/control/ways", palette.INK, 2.5)
        self._labels = [nodes.label(f"/control/labels/way{n}") for n in range(MOST)]
        self._ghost = nodes.mesh("/control/ghost", palette.BEYOND, 0.6)
        self._ghost_of: object = None
        self._ball = Ball(nodes, "/free", palette.FREE)

    def show(self, view: View, here: Here | None, ball: Sphere | None) -> None:
        """Bring them to what is known of the present place."""
        control, size = view.review[Control], view.drawing.size
        wrenches = here.wrenches if here is not None and control.wrenches else None
        self._show_wrenches(wrenches, size)
        self._show_clearances(view, here if control.clearances else None)
        self._ball.show(ball)

    def _show_wrenches(self, system: WrenchSystem | None, size: float) -> None:
        ink = self._nodes.colors.ink
        forces: list[Arrow] = []
        couples: list[Arrow] = []
        rows = () if system is None else zip(system.names, system.rows, system.point, strict=True)
        for name, row, point in rows:
            if not np.isfinite(row).all():
                continue
            length = float(np.linalg.norm(row[:3]))
            if length > 0.0:
                color = palette.limb_color(name.limb) if name.limb else ink
                forces.append((point, row[:3] / length, color))
            else:
                couples.append((point, row[3:] / np.linalg.norm(row[3:]), ink))
        for n, node in enumerate(self._lines):
            ends = np.empty((0, 2, 3))
            if n < len(forces):
                point, along, color = forces[n]
                ends = np.stack([point - REACH * size * along, point + REACH * size * along])[None]
                self._nodes.set(node, colors=colors([color])[0])
            self._nodes.points(node, ends)
        arrows = [(p, p + 0.3 * size * d, c) for p, d, c in forces]
        # A couple is an arrow with two heads, as in mechanics.
        arrows += [(p, p + part * size * d, c) for part in (0.45, 0.39) for p, d, c in couples]
        _arrows(self._nodes, self._arrows, arrows)

    def _show_clearances(self, view: View, here: Here | None) -> None:
        shown: list[Clearance] = []
        for way in () if here is None else here.clearances:
            # One of a kind is enough to see, and one at a place.
            if all(way.kind != w.kind and way.point != w.point for w in shown):
                shown.append(way)
        shown = shown[:MOST]
        origin = view.platform[:3, 3]
        if shown:
            each = np.repeat(colors([_way_color(way) for way in shown])[:, None], 2, axis=1)
            self._nodes.set(self._ways, colors=each)
        self._nodes.points(self._ways, np.array([(origin, way.point) for way in shown]))
        named = [way for way in shown if way.kind in _WHAT]
        for n, label in enumerate(self._labels):
            seen = n < len(named)
            text = f"{how_far(named[n])} · {tr(_WHAT[named[n].kind])}" if seen else ""
            self._nodes.text(label, text, named[n].point if seen else None)

    def swing(self, view: View, motion: tuple[float, ...], elapsed: float) -> bool:
        """The platform's ghost on its free motion; False when the show is over."""
        bodies = [b for b in view.drawing.bodies if b.frame == "platform"]
        over = elapsed > SWINGS * PERIOD or not bodies
        self._nodes.set(self._ghost, visible=not over)
        if over:
            return False
        if self._ghost_of != bodies[0]:
            self._ghost_of = bodies[0]
            self._ghost.vertices, self._ghost.faces = body_mesh(bodies[0])
        review = view.review
        step = SWING * view.drawing.size * np.sin(2 * np.pi * elapsed / PERIOD)
        pose = np.array(review.pose) + step * np.array(motion)
        self._nodes.pose(self._ghost, review.machine.transform(pose, review.mode))
        return True

    def still(self) -> None:
        """No ghost any more."""
        self._nodes.set(self._ghost, visible=False)


def _way_color(way: Clearance) -> str:
    if way.kind in ("parallel", "constraint"):
        return palette.BEYOND
    return palette.limb_color(way.limb) if way.limb else palette.mixed(palette.WORKSPACE, -0.3)


class Loads:
    """Scene nodes, made with nothing to see, then only moved."""

    def __init__(
        self, nodes: Nodes, pulled: Callable[[str, int | None, tuple[float, ...]], None]
    ) -> None:
        self._nodes = nodes
        self.pulled = False  # a hand holds the arrow's tip and decides where it is
        self._forces, self._load, self._rates = (
            nodes.arrows(f"/control/{name}", shaft)
            for name, shaft in (("forces", 0.012), ("load", 0.014), ("rates", 0.008))
        )
        self._labels = {
            name: [nodes.label(f"/control/labels/{name}{n}") for n in range(count)]
            for name, count in (("force", MOST), ("rate", 2))
        }
        tip = nodes.server.scene.add_transform_controls(
            "/control/tip", line_width=3.0, disable_rotations=True, depth_test=False, visible=False
        )
        self._tip = nodes.sized(tip, scale=0.2)
        nodes.dragged(
            self._tip, lambda phase, who, tip: pulled(phase, who, tuple(map(float, tip.position)))
        )

    def show(self, view: View, here: Here | None) -> None:
        """Bring them to what is known of the present place."""
        self._show_forces(here if view.review[Control].forces else None, view.drawing.size)
        self._show_load(view)
        self._show_rates(view, here)

    def _show_forces(self, here: Here | None, size: float) -> None:
        """What each limb exerts on the platform as an arrow at its end, named by its actuator."""
        arrows: list[Arrow] = []
        texts: list[str] = []
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
                arrows.append((system.point[n], tip, color))
                what = ""
                if name.kind == "actuation" and unit == "N":
                    what = " " + tr(
                        "singularities.push" if values[n] >= 0 else "singularities.pull"
                    )
                texts.append(f"{abs(values[n]):.3g} {unit}{what}")
        self._named(self._forces, "force", arrows, texts)

    def _show_load(self, view: View) -> None:
        control = view.review[Control]
        origin = view.platform[:3, 3]
        tip = origin + self.scale(view) * np.array(control.load[:3])
        _arrows(self._nodes, self._load, [(origin, tip, palette.LOAD)] if control.arrow else [])
        self._nodes.set(self._tip, visible=control.arrow)
        if self.pulled:
            self._nodes.forget("/control/tip")
        elif control.arrow:
            self._nodes.set(self._tip, position=tuple(float(v) for v in tip))

    def _show_rates(self, view: View, here: Here | None) -> None:
        """The velocity of O′ and its acceleration, each as long as suits the eye."""
        arrows: list[Arrow] = []
        texts: list[str] = []
        if here is not None and here.motion is not None:
            origin, size = view.platform[:3, 3], view.drawing.size
            for twist, color, unit in (
                (here.motion.twist, palette.VELOCITY, "mm/s"),
                (here.motion.twist_rate, palette.ACCELERATION, "mm/s²"),
            ):
                linear = np.asarray(twist)[3:]
                length = float(np.linalg.norm(linear))
                if np.isfinite(length) and length > 1e-9:
                    arrows.append((origin, origin + 0.5 * size * linear / length, color))
                    texts.append(f"{length:.3g} {unit}")
        self._named(self._rates, "rate", arrows, texts)

    def _named(self, node: Any, labels: str, arrows: list[Arrow], texts: list[str]) -> None:
        _arrows(self._nodes, node, arrows)
        for n, label in enumerate(self._labels[labels]):
            seen = n < len(arrows)
            self._nodes.text(label, texts[n] if seen else "", arrows[n][1] if seen else None)

    @staticmethod
    def scale(view: View) -> float:
        """mm of the load's arrow for each N: the usual load is half as long as the machine."""
        return 0.5 * view.drawing.size / USUAL_LOAD

    def force_of(self, view: View, tip: tuple[float, ...]) -> tuple[float, ...]:
        """The force whose arrow ends there, N, to the digits of the page."""
        force = (np.array(tip) - view.platform[:3, 3]) / self.scale(view)
        return tuple(round(float(v), 1) for v in force)
