"""A machine on its way round its workspace, as an SVG that moves without a script."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import kinematics as kin
from app.features.report.drawing import Shape, Sheet, bar_paint, themed
from app.review.state import new_review
from app.review.view import View, view
from app.scene.palette import DARK, LIGHT
from app.widgets.svg import document, line, tag
from kinematics.machine import Machine

FRAMES = 40
SECONDS = 6.0
INSIDE = 0.85  # of the radius of the largest ball in the workspace

STYLE = (
    f".frame{{visibility:hidden;animation:shown {SECONDS:g}s step-end infinite}}"
    f"@keyframes shown{{0%{{visibility:visible}}{100 / FRAMES:g}%{{visibility:hidden}}}}"
    "@media(prefers-reduced-motion:reduce)"
    "{.frame{animation:none}.frame:first-of-type{visibility:visible}}"
)
"""Each frame has its turn; who asks for less motion sees the first one."""


def moving(name: str, mode: str) -> tuple[str, str]:
    """The picture of a machine with three translations, and what it shows."""
    machine = kin.open(name)
    space = machine.workspace(modes=mode)
    built, ball = space.solid("preview").built, space.largest_ball()
    assert ball is not None, name
    volume = space.volume(1e-4, pieces=False)
    turn = np.linspace(0.0, 2.0 * np.pi, FRAMES, endpoint=False)
    curve = np.stack([np.cos(turn), np.sin(turn), 0.5 * np.sin(2.0 * turn)], axis=1)
    curve *= INSIDE / np.linalg.norm(curve, axis=1).max()
    places = np.array(ball.center) + ball.radius * curve
    views = [_view(machine, place, mode) for place in places.tolist()]

    ends = np.array([[(bar.start, bar.end) for bar in each.drawing.bars] for each in views])
    sheet = Sheet(views[0], [ends.reshape(-1, 3), built.mesh.vertices])
    shape = Shape(
        key="workspace",
        title=name,
        on=True,
        vertices=np.asarray(built.mesh.vertices, dtype=float),
        faces=built.mesh.faces,
        lines=built.edges.astype(float),
        color=(LIGHT.workspace, DARK.workspace),
        edge=(LIGHT.edge, DARK.edge),
    )
    area, rim = sheet.solid(shape)
    way = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in sheet.eye.px(places)) + "Z"
    frames = "".join(_frame(each, sheet, n) for n, each in enumerate(views))
    path = line(way, themed("silhouette"), 1.2, stroke_dasharray="2 4")
    content = f"<style>{STYLE}</style>{sheet.ground(np.inf)}{area}{path}{frames}{rim}"
    caption = (
        f"<code>{name}</code> in working mode {mode.replace('-', '−')}, level: its workspace, "
        f"{volume.value / 1e6:.2f} dm³, and a way in the largest ball inside, of radius "
        f"{ball.radius:.1f} mm. Drawn by Bohemia when this page was built"
    )
    return document(sheet.eye.size, content, name=f"{name} moving in its workspace"), caption


def _view(machine: Machine, place: list[float], mode: str) -> View:
    pose = (*place, *(0.0 for _ in machine.coordinates[3:]))
    shown = view(replace(new_review(machine.design), pose=pose, mode=mode))
    assert shown.posture.reachable, shown.posture
    return shown


def _frame(shown: View, sheet: Sheet, number: int) -> str:
    """All bars as plain strokes and the platform, the farthest first."""
    here, eye = Sheet(shown), sheet.eye
    here.eye = eye
    parts = []
    for body in shown.drawing.bodies:
        cloud = here.cloud(body)
        near = -np.inf if body.frame == "base" else float(eye.depth(cloud).mean())
        parts.append((near, here._body(body, cloud)))
    for bar in shown.drawing.bars:
        ends = np.array([bar.start, bar.end])
        (a, b), (c, d) = eye.px(ends).tolist()
        thick = max((1.1 if bar.role == "rail" else 2.0) * bar.radius * eye.scale, 0.9)
        drawn = line(f"M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}", bar_paint(bar), thick)
        parts.append((float(eye.depth(ends).mean()), drawn))
    drawn = "".join(part for _, part in sorted(parts, key=lambda part: part[0]))
    wait = f"animation-delay:{number * SECONDS / FRAMES - SECONDS:.3g}s"
    return tag("g", drawn, class_="frame", style=wait)
