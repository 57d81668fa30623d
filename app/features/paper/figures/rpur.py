"""Plane figures and tables of the 5-RPUR papers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from app.features.map.files import map_csv, map_figure
from app.features.paper.figures.drawers import (
    Files,
    axes,
    draws,
    figure,
    named,
    pictures,
    table,
)
from app.features.paper.items import Item
from app.features.paper.recomputed.postures import machine
from app.features.paper.recomputed.rpur_examples import examples
from app.features.paper.recomputed.rpur_model import PAIRS, J, K
from app.features.paper.recomputed.rpur_sections import section
from app.features.paper.recomputed.rpur_space import HIGH, LINK, LOW, chart, degrees_of
from app.scene.palette import INK, LIGHT, LIMBS
from kinematics.machine import Machine
from kinematics.plane.files import section_csv, section_dxf

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_GRID = 17  # orientations each way of Figs. 20 and 21
_SOLUTIONS = ("x_mm", "y_mm", "z_mm", "phi_deg", "theta_deg", "working_mode", "residual_mm")


# --- sketches ------------------------------------------------------------------------------


@draws(J, "Fig. 3")
@draws(K, "Fig. 3")
def arrangements(item: Item) -> Files:
    page = figure(10.5, 4.4)
    panels = page.subplots(1, 3, subplot_kw={"projection": "3d"})
    for panel, (kind, (name, i, j)) in zip(panels, PAIRS.items(), strict=True):
        _limbs(panel, machine(name), (i, j))
        panel.set_title(f"{kind}: limbs {i} and {j} of {name}", fontsize=9, color=INK)
    return pictures(item, page)


@draws(J, "Fig. 5")
def with_mp(item: Item) -> Files:
    page = figure(5.4, 4.8)
    panel = page.subplots(subplot_kw={"projection": "3d"})
    _limbs(panel, machine("rpur-mpa2"), (1, 2, 3))
    panel.set_title("{MpA2}: the second links of limbs 1, 2 and 3 are parallel", fontsize=9)
    return pictures(item, page)


@draws(K, "Fig. 2")
def one_limb(item: Item) -> Files:
    page = figure(5.4, 4.8)
    panel = page.subplots(subplot_kw={"projection": "3d"})
    _limbs(panel, machine("rpur-table1-icee"), (1,))
    panel.set_title("limb 1: ρ from A to B, l from B to C", fontsize=9, color=INK)
    return pictures(item, page)


def _limbs(panel: Any, made: Machine[Any], limbs: Iterable[int]) -> None:
    """Some limbs at home, A – B – C, and the platform."""
    home = made.home
    a = np.array([limb["base"] for limb in made.table["limb"]])
    b = made.statics.wrenches(home.pose, home.mode).point[:5]
    placed = made.mechanism.transform(home.pose, home.mode)
    s = np.array([limb["platform"] for limb in made.table["limb"]])
    c = placed[:3, 3] + s @ placed[:3, :3].T
    for limb in limbs:
        n = limb - 1
        color = LIMBS[n]
        panel.plot(*np.stack([a[n], b[n]]).T, color=color, linewidth=4.0, solid_capstyle="round")
        panel.plot(*np.stack([b[n], c[n]]).T, color=color, linewidth=2.0)
        for point, text in ((a[n], f"A{limb}"), (b[n], f"B{limb}"), (c[n], f"C{limb}")):
            panel.plot(*point[:, None], "o", color=INK, markersize=4)
            panel.text(*point, f" {text}", fontsize=8, color=INK)
    some = np.array([n - 1 for n in limbs])
    for point in c[some]:
        panel.plot(*np.stack([placed[:3, 3], point]).T, color=LIGHT.platform, linewidth=1.2)
    panel.set_box_aspect(
        np.ptp(np.concatenate([a[some], b[some], c[some]]), axis=0) + 150.0, zoom=1.15
    )
    panel.tick_params(labelsize=6)
    panel.view_init(22, -60)


@draws(J, "Fig. 6")
def base_and_platform(item: Item) -> Files:
    limbs = machine("rpur-a1a2").table["limb"]
    page = figure(8.6, 4.0)
    left, right = axes(page, across=2, equal=True)
    for panel, key, title, names in (
        (left, "base", "base: A₃ = A₄ in one point", ("x (mm)", "y (mm)")),
        (right, "platform", "platform: C₁ = C₂, and C₃C₄ along e₂", ("x′ (mm)", "y′ (mm)")),
    ):
        for n, limb in enumerate(limbs):
            x, y, _ = limb[key]
            panel.plot(x, y, "o", color=LIMBS[n], markersize=9 - 1.2 * n)
            side = -14 if n % 2 else 8
            panel.annotate(str(n + 1), (x, y), (8, side), textcoords="offset points", color=INK)
        panel.plot(0, 0, "+", color=INK)
        named(panel, *names, title)
    return pictures(item, page)


@draws(J, "Fig. 16")
@draws(K, "Fig. 8")
def outline(item: Item) -> Files:
    page = figure(6.4, 7.2)
    (panel,) = axes(page, equal=True)
    t = np.linspace(0.0, np.pi, 200)
    x = HIGH * np.cos(t)
    panel.fill_between(
        x,
        HIGH * np.sin(t) + LINK,
        -HIGH * np.sin(t) - LINK,
        color=LIGHT.workspace,
        alpha=0.18,
        linewidth=0,
    )
    for radius, style, text in ((HIGH, "-", "ρ_max"), (LOW, "--", "ρ_min")):
        for up in (LINK, -LINK):
            for side in (1.0, -1.0):
                wide = 1.6 if side * up > 0 else 0.7
                panel.plot(
                    radius * np.cos(t),
                    up + side * radius * np.sin(t),
                    style,
                    color=LIMBS[0],
                    linewidth=wide,
                )
        panel.annotate(
            text,
            (radius * 0.7, LINK + radius * 0.714),
            (6, 6),
            textcoords="offset points",
            color=INK,
        )
    for radius in (HIGH, -HIGH):
        panel.plot([radius, radius], [-LINK, LINK], color=LIMBS[0], linewidth=1.6)
    panel.axvline(50.0, color=LIGHT.beyond, linewidth=1.0, linestyle=":")
    panel.annotate("x′_H", (50.0, -600.0), (4, 0), textcoords="offset points", color=LIGHT.bad)
    panel.plot(0, 0, "+", color=INK)
    panel.annotate("w′", (0, 0), (6, -12), textcoords="offset points", color=INK)
    named(panel, "x′ − w′_x (mm)", "z′ − w′_z (mm)", "B_i seen along y′: bounds at y′ = w′_y")
    return pictures(item, page)


# --- section, maps -------------------------------------------------------------------------


@draws(J, "Fig. 17")
@draws(K, "Fig. 9")
def cross_section(item: Item) -> Files:
    found = section(item.data["design"], degrees_of(item), float(item.data["at"]))
    made, page = found.construction, figure(9.6, 5.4)
    left, right = axes(page, across=2, equal=True)
    t = np.linspace(0.0, 2.0 * np.pi, 181)
    for (y, z), radius, limb, bound in zip(
        made.center, made.radius, made.circle_limb, made.circle_bound, strict=True
    ):
        left.plot(
            y + radius * np.cos(t),
            z + radius * np.sin(t),
            color=LIMBS[limb - 1],
            linewidth=0.8,
            linestyle="-" if bound == 1 else "--",
        )
    for ends, limb in zip(made.line, made.line_limb, strict=True):
        left.plot(*ends.T, color=LIMBS[limb - 1], linewidth=0.8)
    for panel in (left, right):
        for n in range(found.loops):
            loop = found.polyline(n, 2.0)
            panel.fill(*loop.T, color=LIGHT.workspace, alpha=0.35, linewidth=0)
        for edge in range(len(found.start)):
            panel.plot(
                *found.edge_points(edge, 2.0).T,
                color=LIMBS[int(found.limb[edge]) - 1],
                linewidth=2.2,
            )
    for n, color in enumerate(LIMBS):
        right.plot([], [], color=color, label=f"limb {n + 1}")
    right.legend(fontsize=8, frameon=False)
    title = f"{len(made.radius)} circles of five limbs; dashed: ρ_min"
    named(left, "y′ (mm)", "z′ (mm)", title)
    named(right, "y′ (mm)", "z′ (mm)", f"what is inside all five: {found.area:.2f} mm²")
    files = pictures(item, page)
    files[f"{item.stem}.csv"] = section_csv(found, found.plane).encode()
    files[f"{item.stem}.dxf"] = section_dxf(found, found.plane).encode()
    return files


@draws(J, "Fig. 20", "Fig. 21")
@draws(K, "Fig. 11")
def volumes(item: Item) -> Files:
    found = chart(item.data["design"], _GRID)
    return {**pictures(item, map_figure(found)), f"{item.stem}.csv": map_csv(found).encode()}


# --- tables --------------------------------------------------------------------------------


@draws(J, "Table 1", "Table 2")
@draws(K, "Table I")
def designs(item: Item) -> Files:
    keys = [f"{name}_{axis}_mm" for name in ("r", "s") for axis in "xyz"]
    rows = zip(item.data["base"], item.data["platform"], strict=True)
    return table(item, ("i", *keys), ([n, *r, *s] for n, (r, s) in enumerate(rows, start=1)))


@draws(J, "C2")
def nine_designs(item: Item) -> Files:
    """The nine designs with as many real solutions as were found."""
    keys = [f"{name}_{axis}_mm" for name in ("r", "s") for axis in "xyz"]
    rows: list[Sequence[object]] = []
    for name, one in examples().items():
        told = one.complex_count, len(one.tied)
        for n, limb in enumerate(one.machine.table["limb"]):
            rho = one.found.joints[n]
            rows.append([name, *told, n + 1, *limb["base"], *limb["platform"], limb["link"], rho])
    header = ("design", "complex", "real", "limb", *keys, "l_mm", "rho_mm")
    files = table(item, header, rows)
    page = figure(7.2, 3.6)
    (panel,) = axes(page)
    _bars(panel)
    return {**files, **pictures(item, page)}


def _bars(panel: Axes) -> None:
    """Complex and most real solutions of the nine designs."""
    places = np.arange(len(examples()))
    every = [one.complex_count for one in examples().values()]
    real = [len(one.tied) for one in examples().values()]
    panel.bar(places, every, color=LIGHT.cut, width=0.62, label="complex")
    panel.bar(places, real, color=LIGHT.workspace, width=0.62, label="real, as many as were found")
    for n, (one, other) in enumerate(zip(every, real, strict=True)):
        panel.text(n, one + 2, str(one), ha="center", fontsize=8, color=INK)
        if other < one:
            panel.text(n, other - 9, str(other), ha="center", fontsize=8, color="white")
    panel.set_xticks(places, [*examples()])
    panel.legend(fontsize=8, frameon=False)
    named(panel, "", "solutions", "each arrangement in one working mode")


@draws(J, "C7", "C11", "C14")
def solutions(item: Item) -> Files:
    """All real solutions of the example with the most of them."""
    one = examples()[{"C7": "{A1A1}", "C11": "{A1A2}", "C14": "{MpA2}"}[item.name]]
    rows = [
        [
            *one.found.poses[n, :3].tolist(),
            *np.degrees(one.found.poses[n, 3:]).tolist(),
            one.found.modes[n],
            float(one.found.residual[n]),
        ]
        for n in one.tied.tolist()
    ]
    return table(item, _SOLUTIONS, rows)
