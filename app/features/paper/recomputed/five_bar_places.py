"""Sosa-López et al. (2017): workspace, singularities and modes of the five-bar."""

from __future__ import annotations

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    counts,
    drawn,
)
from app.features.paper.recomputed.five_bar import R1, R3, START, S, machine, poses
from app.features.paper.registry import computes

# --- workspace, singularities --------------------------------------------------------------


@computes(S, "Fig. 9")
def fig_9(item: Item) -> Outcome:
    area = sum(region.section.area for region in machine().workspace().regions()) / 100.0
    r, d = 96.0, 48.0
    lens = 2 * r * r * np.arccos(0.5 * d / r) - 0.5 * d * np.sqrt(4 * r * r - d * d)
    serial, folded, extended, off = _loci()
    return drawn(
        abs(area - lens) < 1e-6 * lens and off < 1e-6,
        Quantity("area of the workspace", area, unit="cm²"),
        Quantity("lens of two discs of radius 96 cm about (±24, 0)", float(lens), unit="cm²"),
        Quantity("points of serial curves", float(serial)),
        Quantity("points of parallel curves, folded and extended", f"{folded} and {extended}"),
        Quantity("largest |det A| det B| on them, relative", off),
        proof="both areas agree, and on the curves that are drawn det A or det B vanishes",
    )


def _loci() -> tuple[int, int, int, float]:
    """Points of serial curves; of parallel ones, folded and extended; and how well they are so.

    Curves of all working modes: a point is singular in one of them at least.
    """
    made = machine()
    curves = made.singularities.locus("plane-all", made.home.pose, made.home.mode)
    found = {"serial": 0, "folded": 0, "extended": 0}
    worst = 0.0
    for c, kind in enumerate(curves.kinds):
        points = curves.points[curves.start[c] : curves.start[c + 1]]
        r = np.hypot(points[:, :1] + np.array([R3, -R3]), points[:, 1:])
        if kind == "serial":
            # |P − A_i| = r_1 + r_2, or 0 where a limb is folded onto its base
            worst = max(worst, float(np.minimum(np.abs(r - 960.0), r).min(axis=1).max()) / 960.0)
            found["serial"] += len(points)
            continue
        points = points[r.min(axis=1) > 1.0]  # with P on A_i that limb may stand anyhow
        sines, dots = [], []
        for mode in made.modes:
            q = made.mechanism.joints(points, mode)
            one, two = (
                points - np.stack([R1 * np.cos(q[:, n]) + side, R1 * np.sin(q[:, n])], -1)
                for n, side in ((0, -R3), (1, R3))
            )
            sines.append(np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 480.0**2)
            dots.append((one * two).sum(axis=-1))
        best = np.nanargmin(np.nan_to_num(sines, nan=9.0), axis=0)
        rows = np.arange(len(points))
        worst = max(worst, float(np.array(sines)[best, rows].max()))
        folded = int((np.array(dots)[best, rows] > 0.0).sum())
        found["folded"] += folded
        found["extended"] += len(points) - folded
    return found["serial"], found["folded"], found["extended"], worst


@computes(S, "C4")
def c_4(item: Item) -> Outcome:
    serial, folded, extended, off = _loci()
    made = machine()
    curves = made.singularities.locus("plane-all", made.home.pose, made.home.mode)
    height = float(np.sqrt(48.0**2 - 24.0**2))
    return counts(
        item.data["counts"],
        ("kinds on the library's curves", len({*curves.kinds})),
        ("cases of the second", (folded > 0) + (extended > 0)),
        more=[
            Quantity("circles of 48 cm about (0, ±y), folded: y", height, unit="cm"),
            Quantity("points: serial, folded, extended", f"{serial}, {folded}, {extended}"),
            Quantity("how well they are so", off),
        ],
    )


@computes(S, "C1")
def c_1(item: Item) -> Outcome:
    at = poses()
    rank = int(np.linalg.matrix_rank(at.b[0]))
    return counts(
        item.data["counts"],
        ("rank of B, coordinates of P", rank),
        more=[Quantity("driven joints", float(len(machine().joints)))],
    )


@computes(S, "C2")
def c_2(item: Item) -> Outcome:
    found = machine().inverse([0.0, START])
    distinct = len({tuple(np.round(row, 9)) for row in found.joints.tolist()})
    sets = machine().forward([1.8, 1.3])
    return counts(
        item.data["counts"],
        ("different angles for (0, 73.8644) cm", distinct),
        more=[Quantity("assembly modes at θ = 1.8, 1.3 rad", float(len(sets)))],
    )
