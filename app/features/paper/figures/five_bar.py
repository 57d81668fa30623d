"""Figures and tables of Sosa-López et al. (2017). Lengths are cm here, as there."""

from __future__ import annotations

from collections.abc import Sequence

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
from app.features.paper.recomputed.five_bar import START, S, machine
from app.features.paper.recomputed.five_bar_ways import fitted, powers_of, value, way
from app.scene.palette import BEYOND, INK, LIGHT, LIMBS
from kinematics.arrays import Array

_PAIR = (LIMBS[0], LIMBS[1])


@draws(S, "Fig. 1")
def sketch(item: Item) -> Files:
    page = figure(5.6, 5.2)
    (panel,) = axes(page, equal=True)
    made = machine()
    q = np.array(made.at((0.0, START), "+-").joints)
    p = np.array([0.0, START / 10.0])
    for n, side in enumerate((-24.0, 24.0)):
        a = np.array([side, 0.0])
        b = a + 48.0 * np.array([np.cos(q[n]), np.sin(q[n])])
        panel.plot(*np.stack([a, b]).T, color=LIMBS[n], linewidth=4, solid_capstyle="round")
        panel.plot(*np.stack([b, p]).T, color=LIMBS[n], linewidth=2.2)
        for point, text in ((a, f"A{n + 1}"), (b, f"B{n + 1}")):
            panel.plot(*point, "o", color=INK)
            panel.annotate(
                text, tuple(point.tolist()), (8, 4), textcoords="offset points", color=INK
            )
    panel.plot(*p, "o", color=INK)
    panel.annotate("P", tuple(p.tolist()), (8, 4), textcoords="offset points", color=INK)
    panel.plot([-24, 24], [0, 0], color=LIGHT.steel, linewidth=2)
    named(panel, "x (cm)", "y (cm)", "mode +−, r₁ = r₂ = 48 cm, r₃ = 24 cm")
    return pictures(item, page)


def _curves(
    item: Item, times: Array, values: Array, labels: Sequence[str], unit: str, title: str
) -> Files:
    """Two curves over time, and their samples."""
    page = figure(6.4, 3.8)
    (panel,) = axes(page)
    for n, label in enumerate(labels):
        panel.plot(times, values[:, n], color=_PAIR[n], linewidth=1.8, label=label)
    panel.grid(alpha=0.25)
    panel.legend(fontsize=9, frameon=False)
    named(panel, "t (s)", unit, title)
    rows = [[float(t), *row] for t, row in zip(times, values.tolist(), strict=True)]
    return {**pictures(item, page), **table(item, ("t_s", *labels), rows)}


@draws(S, "Fig. 3", "Fig. 4")
def desired(item: Item) -> Files:
    found = way(item.data["trajectory"], 201)
    return _curves(item, found.times, found.poses / 10.0, ("x", "y"), "cm", "desired trajectory")


@draws(S, "Fig. 5", "Fig. 6")
def driven(item: Item) -> Files:
    name, samples = item.data["trajectory"], item.data["samples"]
    fits, found = fitted(name, samples, item.data["degree"]), way(name, samples)
    page = figure(9.0, 3.8)
    left, right = axes(page, across=2)
    for n, label in enumerate(("x", "y")):
        left.plot(found.times, fits.poses[:, n] / 10.0, color=_PAIR[n], label=label)
        right.plot(found.times, fits.pose_error[:, n] / 10.0, color=_PAIR[n], label=label)
    for panel in (left, right):
        panel.grid(alpha=0.25)
        panel.legend(fontsize=9, frameon=False)
    named(left, "t (s)", "cm", f"driven by polynomials of degree {fits.degree}")
    named(right, "t (s)", "cm", "true error of that")
    both = np.concatenate([fits.poses, fits.pose_error], axis=1) / 10.0
    rows = [[float(t), *row] for t, row in zip(found.times, both.tolist(), strict=True)]
    header = ("t_s", "x_cm", "y_cm", "error_x_cm", "error_y_cm")
    return {**pictures(item, page), **table(item, header, rows)}


@draws(S, "Fig. 9")
def workspace(item: Item) -> Files:
    made = machine()
    page = figure(7.0, 6.6)
    (panel,) = axes(page, equal=True)
    for region in made.workspace().regions():
        for n in range(region.section.loops):
            loop = region.section.polyline(n, 5.0) / 10.0
            panel.fill(*loop.T, color=LIGHT.workspace, alpha=0.22, linewidth=0)
    curves = made.singularities.locus("plane-all", made.home.pose, made.home.mode)
    rows: list[list[object]] = []
    for c, kind in enumerate(curves.kinds):
        points = curves.points[curves.start[c] : curves.start[c + 1]] / 10.0
        first = kind not in [str(row[1]) for row in rows]
        color, style = (INK, "--") if kind == "serial" else (BEYOND, "-")
        panel.plot(*points.T, style, color=color, linewidth=1.5, label=kind if first else None)
        rows += [[c + 1, kind, *point] for point in points.tolist()]
    for n, side in enumerate((-24.0, 24.0)):
        panel.plot(side, 0.0, "o", color=INK, markersize=4)
        panel.annotate(f"A{n + 1}", (side, 0.0), (6, -12), textcoords="offset points", color=INK)
    panel.legend(fontsize=9, frameon=False, loc="upper left")
    named(panel, "x (cm)", "y (cm)", "workspace of all modes and its singular curves")
    return {**pictures(item, page), **table(item, ("curve", "kind", "x_cm", "y_cm"), rows)}


@draws(S, "Fig. 10")
def joint_rates(item: Item) -> Files:
    found = way("rest-to-rest", 201)
    return _curves(item, found.times, found.joint_rates, ("θ̇₁", "θ̇₂"), "rad/s", "driven joints")


@draws(S, "Fig. 11")
def rates(item: Item) -> Files:
    found = way("rest-to-rest", 201)
    return _curves(item, found.times, found.pose_rates / 10.0, ("ẋ", "ẏ"), "cm/s", "end effector")


@draws(S, "Fig. 13")
def accelerations(item: Item) -> Files:
    found = way("rest-to-rest", 201)
    values = found.pose_accelerations / 10.0
    return _curves(item, found.times, values, ("ẍ", "ÿ"), "cm/s²", "end effector")


@draws(S, "Table II", "Table III", "Table IV")
def tables(item: Item) -> Files:
    """What is printed, and the true errors of the fits."""
    unit = ("cm", "cm_per_s", "cm_per_s2")[item.data["order"]]
    names = ("line", "rest-to-rest")[-len(item.data["rows"]) :]
    rows: list[list[object]] = []
    for name, printed in zip(names, item.data["rows"], strict=True):
        samples, degree = (101, 3) if name == "line" else (201, 8)
        true = fitted(name, samples, degree).deviation[item.data["order"]] / 10.0
        rows.append([name, *printed, *true.tolist(), float(np.hypot(*true))])
    header = [f"{who}_{what}_{unit}" for who in ("printed", "true") for what in ("x", "y", "both")]
    return table(item, ("trajectory", *header), rows)


@draws(S, "eq. 16", "eq. 17", "eq. 18", "eq. 19")
def polynomials(item: Item) -> Files:
    """The polynomial as printed less the joint's exact curve."""
    name, samples = item.data["trajectory"], item.data["samples"]
    found, joint = way(name, samples), item.data["joint"] - 1
    fits = fitted(name, samples, item.data["degree"])
    exact = found.joints[:, joint]
    off = np.stack(
        [value(powers_of(item), found.times) - exact, fits.joint_error[:, joint]], axis=1
    )
    labels = ("digits as printed", "full digits")
    return _curves(item, found.times, off, labels, "rad", f"θ{joint + 1}: polynomial less exact")
