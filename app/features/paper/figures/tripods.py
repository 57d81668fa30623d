"""Figures of Nayak et al. (2017)."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np

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
from app.features.paper.recomputed.tripods_algebra import N, machine
from app.features.paper.recomputed.tripods_circles import HEIGHTS, RATIOS
from app.features.paper.recomputed.tripods_circles import table as micr_table
from app.scene.palette import BEYOND, INK, LIGHT, LIMBS
from kinematics.facets.circles import micr

_GREEN = LIMBS[2]


@draws(N, "Fig. 1", "Fig. 2")
def machines(item: Item) -> Files:
    made = machine(item.data["design"])
    # A posture that is turned, so that it shows which joint is where.
    at = made.at((1.2 * made.home.pose[0], 0.35, 0.6), "2")
    page = figure(5.4, 5.0)
    panel: Any = page.subplots(subplot_kw={"projection": "3d"})
    radii = float(made.table["base_radius"]), float(made.table["platform_radius"])
    turn = np.radians([0.0, -120.0, 120.0, 0.0])
    ring = np.stack([np.cos(turn), np.sin(turn), np.zeros(4)], axis=1)
    a = radii[0] * ring
    b = radii[1] * ring @ at.transform[:3, :3].T + at.transform[:3, 3]
    panel.plot(*a.T, color=LIGHT.steel, linewidth=2.5)
    panel.plot(*b.T, color=LIGHT.platform, linewidth=2.5)
    for n in range(3):
        panel.plot(*np.stack([a[n], b[n]]).T, color=LIMBS[n], linewidth=3.0)
        panel.text(*a[n], f" A{n + 1}", fontsize=9, color=INK)
        panel.text(*b[n], f" B{n + 1}", fontsize=9, color=INK)
        # The axis of the revolute joint.
        along = np.array([-np.sin(turn[n]), np.cos(turn[n]), 0.0]) * 0.25 * radii[0]
        spr = item.data["design"] == "spr-3"
        middle, along = (b[n], at.transform[:3, :3] @ along) if spr else (a[n], along)
        panel.plot(*np.stack([middle - along, middle + along]).T, color=INK, linewidth=1.2)
    panel.set_box_aspect(np.ptp(np.concatenate([a, b]), axis=0))
    panel.tick_params(labelsize=6)
    panel.set_title(f"{made.title}, h₁ = {radii[0]:g}, h₂ = {radii[1]:g} mm", fontsize=9)
    return pictures(item, page)


@draws(N, "Fig. 3(a)", "Fig. 3(b)")
def loci(item: Item) -> Files:
    made, mode = machine("spr-3"), item.data["mode"]
    curves = made.singularities.locus(
        made.singularities.loci[0].key, (100.0 * item.data["z"], 0.0, 0.0), mode
    )
    found = micr("three_spr", item.data["h1"], item.data["h2"], item.data["z"])
    radius = float(np.degrees(found.radius[int(mode) - 1]))
    page = figure(6.2, 6.4)
    panel: Any = page.subplots(subplot_kw={"projection": "polar"})
    rows: list[list[object]] = []
    for c, points in enumerate(curves.lost()):
        panel.plot(points[:, 1], np.degrees(points[:, 0]), color=_GREEN, linewidth=1.6)
        rows += [[c + 1, *np.degrees(point).tolist()] for point in points]
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    panel.plot(turn, np.full_like(turn, radius), color=BEYOND, linewidth=1.8)
    panel.set_rlim(0.0, 180.0)
    panel.set_rticks([45, 90, 135])
    panel.tick_params(labelsize=8)
    panel.annotate(
        f"MICR {radius:.4f}°",
        (np.radians(-60.0), radius),
        (26, -26),
        textcoords="offset points",
        color=LIGHT.bad,
        fontsize=9,
        arrowprops={"arrowstyle": "-", "color": LIGHT.bad},
    )
    panel.set_title(
        f"3-SPR, mode {mode}, h₁ = 1, h₂ = 2, Z = 1: tilt (radius) over azimuth",
        fontsize=10,
        color=INK,
    )
    header = ("curve", "tilt_deg", "azimuth_deg")
    return {**pictures(item, page), **table(item, header, rows)}


@draws(N, "Fig. 4(a)", "Fig. 4(b)", "Fig. 5(a)", "Fig. 5(b)")
def circles(item: Item) -> Files:
    mechanism, mode = item.data["mechanism"], int(item.data["mode"])
    radius = np.degrees(micr_table(mechanism).radius[mode - 1])
    page = figure(6.8, 4.6)
    (panel,) = axes(page)
    colors = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.92, len(RATIOS)))
    for ratio, curve, color in zip(RATIOS, radius, colors, strict=True):
        panel.plot(HEIGHTS, curve, color=color, linewidth=1.5, label=f"{ratio:g}")
    if "cursor" in item.data:
        exact = float(np.degrees(micr(mechanism, 1.0, 2.0, 1.0).radius[mode - 1]))
        panel.plot(1.0, exact, "o", color=BEYOND, markersize=6)
        text = f"{exact:.4f}°; printed {item.data['cursor']}°"
        panel.annotate(
            text, (1.0, exact), (14, -4), textcoords="offset points", fontsize=9, color=LIGHT.bad
        )
        panel.axhline(160.0, color=INK, linewidth=0.6, linestyle=":")
        panel.text(0.03, 161.5, "cap of the paper's plot", fontsize=8, color=INK)
    panel.set_xlim(0.0, 4.0)
    panel.set_ylim(0.0, 180.0 if mechanism == "three_spr" else 90.0)
    panel.grid(alpha=0.25)
    panel.legend(
        title="h₂/h₁", fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0)
    )
    title = {"three_rps": "3-RPS", "three_spr": "3-SPR"}[mechanism]
    named(panel, "Z/h₁", "MICR (°)", f"{title}, operation mode {mode}")
    rows = [
        [ratio, round(float(height), 12), "" if np.isnan(value) else float(value)]
        for ratio, curve in zip(RATIOS, radius, strict=True)
        for height, value in zip(HEIGHTS, curve, strict=True)
    ]
    return {**pictures(item, page), **table(item, ("h2_over_h1", "z_over_h1", "micr_deg"), rows)}
