"""Figures of the 5-RPUR papers that are solids: dome, holes, vertex space, workspaces."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from app.features.paper.figures.drawers import Files, axes, draws, figure, pictures
from app.features.paper.figures.shading import View, shaded
from app.features.paper.items import Item
from app.features.paper.recomputed.rpur_model import J, K
from app.features.paper.recomputed.rpur_space import HIGH, LINK, degrees_of, part, solid
from app.scene.palette import INK
from kinematics.arrays import Array
from kinematics.solids.files import encode
from kinematics.solids.meshes import SolidMesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OPEN = View(cut=((0.0, -1.0, 0.0), 0.0))
"""What lies before y = 0 is left out."""


@draws(J, "Fig. 8")
def dome(item: Item) -> Files:
    made = half_dome()
    told = "lower half of the Bohemian dome of ρ = 400 mm, l = 150 mm"
    return {
        **_drawn(item, made, View(height=-20.0), told),
        f"{item.stem}.glb": encode(made, "glb", is_open=True),
        f"{item.stem}.stl": encode(made, "stl", is_open=True),
    }


@cache
def half_dome(count: int = 72) -> SolidMesh:
    """z = −√(ρ² − x²) − √(l² − y²), facing down."""
    a = np.linspace(-0.5 * np.pi, 0.5 * np.pi, count)
    x, y = np.meshgrid(HIGH * np.sin(a), LINK * np.sin(a), indexing="ij")
    z = -HIGH * np.cos(a)[:, None] - LINK * np.cos(a)
    vertices = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    first = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    one = np.stack([first, first + 1, first + count], axis=1)
    two = np.stack([first + 1, first + count + 1, first + count], axis=1)
    return SolidMesh(vertices, np.concatenate([one, two]).astype(np.int32))


@draws(J, "Fig. 9", "Fig. 10", "Fig. 11", "Fig. 12", "Fig. 13")
@draws(K, "Fig. 5")
def holes(item: Item) -> Files:
    key = item.data["solid"]
    shown = part(key)
    view = _OPEN if key in ("whole", "H2", "H3") else View()
    cut = ", cut at y = 0" if view.cut else ""
    told = f"limb of ρ = 250 … 400 mm, l = 150 mm{cut}: {shown.volume / 1e6:.4g}·10⁶ mm³"
    return {**_drawn(item, shown.mesh, view, told), **_solids(item, shown.mesh)}


@draws(J, "Fig. 14", "Fig. 15", "Fig. 18", "Fig. 19")
@draws(K, "Fig. 6", "Fig. 7", "Fig. 10")
def workspaces(item: Item) -> Files:
    degrees = degrees_of(item)
    shown = solid(item.data["design"], degrees)
    told = (
        f"{item.data['design']}, φ = {degrees[0]:g}°, θ = {degrees[1]:g}°: "
        f"{shown.volume / 1e6:.4g}·10⁶ mm³ in {len(shown.built.pieces)} pieces"
    )
    return {**_drawn(item, shown.mesh, View(), told), **_solids(item, shown.mesh)}


def _solids(item: Item, mesh: SolidMesh) -> Files:
    return {f"{item.stem}.{kind}": encode(mesh, kind) for kind in ("stl", "glb")}


def _drawn(item: Item, mesh: SolidMesh, view: View, told: str) -> Files:
    image, span = shaded(mesh, view)
    wide, high = span[1] - span[0], span[3] - span[2]
    page = figure(6.4, 6.4 * min(max(high / wide, 0.5), 1.3) + 0.5)
    (panel,) = axes(page)
    panel.imshow(image, extent=span, origin="lower", interpolation="antialiased")
    _directions(panel, span, view.frame)
    panel.set_axis_off()
    panel.set_title(told, fontsize=10, color=INK)
    return pictures(item, page)


def _directions(panel: Axes, span: tuple[float, ...], frame: Array) -> None:
    """x, y, z in the lower left corner, of one length each."""
    size = 0.09 * max(span[1] - span[0], span[3] - span[2])
    start = np.array([span[0] + 1.2 * size, span[2] + 1.2 * size])
    for axis, name in enumerate("xyz"):
        way = size * frame[:2, axis]
        (x, y), (u, v) = (start + way).tolist(), (start + 1.25 * way).tolist()
        arrow = {"arrowstyle": "-|>", "color": INK, "linewidth": 1.0}
        panel.annotate("", (x, y), (float(start[0]), float(start[1])), arrowprops=arrow)
        panel.text(u, v, name, fontsize=9, color=INK, ha="center", va="center")
