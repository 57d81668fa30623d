"""Curves of maximum inscribed circle radii as files: CSV and figures. Angles are degrees here."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from app.scene.palette import BEYOND, INK
from kinematics.answers.circles import MicrTable
from kinematics.errors import InputError

if TYPE_CHECKING:  # loaded only where a figure is drawn
    from matplotlib.figure import Figure

FORMATS: tuple[str, ...] = ("csv", "svg", "png")
COLUMNS = (
    "mechanism",
    "mode",
    "h2_over_h1",
    "z_over_h1",
    "micr_deg",
    "contact_azimuth_deg",
    "crosses_ring",
)
_COLORS = "viridis"
_DOTS = 200  # per inch


def micr_bytes(
    kind: str,
    title: str,
    ratios: Sequence[float],
    heights: Sequence[float],
    found: MicrTable,
    ending: str,
) -> bytes:
    """The curves (modes, ratios, heights) as the content of a file.

    Raises:
        InputError: ``ending`` is not one of `FORMATS`.
    """
    match ending:
        case "csv":
            return micr_csv(kind, ratios, heights, found).encode()
        case "svg" | "png":
            return _picture(micr_figure(title, ratios, heights, found), ending)
    raise InputError(f"there is no format {ending!r}; curves are written as csv, svg or png")


def micr_csv(kind: str, ratios: Sequence[float], heights: Sequence[float], found: MicrTable) -> str:
    """One row a circle; where no tilt is singular both angles are empty."""
    written = io.StringIO()
    rows = csv.writer(written, lineterminator="\n")
    rows.writerow(COLUMNS)
    radius, contact = np.degrees(found.radius), np.degrees(found.contact)
    for n, mode in enumerate(found.modes):
        for r, ratio in enumerate(ratios):
            for h, height in enumerate(heights):
                angles = [
                    value if np.isfinite(value) else ""
                    for value in (float(radius[n, r, h]), float(contact[n, r, h]))
                ]
                crosses = int(found.barred[n, r, h])
                rows.writerow([kind, mode, ratio, round(height, 12), *angles, crosses])
    return written.getvalue()


def micr_figure(
    title: str, ratios: Sequence[float], heights: Sequence[float], found: MicrTable
) -> Figure:
    """MICR against Z/h1, a panel a mode and a curve a ratio, as in the paper's Figs. 4 and 5."""
    import matplotlib
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.4, 4.8), layout="constrained")
    figure.suptitle(title, fontsize=11)
    panels: Any = figure.subplots(1, len(found.modes), sharey=True, squeeze=False)[0]
    colors = matplotlib.colormaps[_COLORS](np.linspace(0.0, 0.92, max(len(ratios), 2)))
    radius = np.degrees(found.radius)
    for n, (panel, mode) in enumerate(zip(panels, found.modes, strict=True)):
        for r, ratio in enumerate(ratios):
            panel.plot(heights, radius[n, r], color=colors[r], label=f"{ratio:g}", linewidth=1.5)
        if found.barred.any():
            panel.axhline(90.0, color=BEYOND, linewidth=0.9, linestyle="--")
            panel.text(
                0.99,
                91.0,
                "no position at 90°",
                color=BEYOND,
                fontsize=8,
                ha="right",
                transform=panel.get_yaxis_transform(),
            )
        panel.set_title(f"Operation mode {mode}", fontsize=10, color=INK)
        panel.set_xlabel("Z/h₁")
        panel.grid(alpha=0.25)
        panel.set_ylim(bottom=0.0)
    panels[0].set_ylabel("MICR (°)")
    panels[-1].legend(title="h₂/h₁", fontsize=8, frameon=False)
    return figure


def _picture(figure: Figure, ending: str) -> bytes:
    import logging

    import matplotlib

    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it talks of its font cache
    written = io.BytesIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "bohemia"}):
        metadata = {"Date": None} if ending == "svg" else None
        figure.savefig(written, format=ending, dpi=_DOTS, metadata=metadata)
    return written.getvalue()
