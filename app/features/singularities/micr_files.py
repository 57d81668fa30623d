"""Curves of maximum inscribed circle radii as files: CSV and figures. Angles are degrees here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from app.scene.palette import BEYOND, INK
from app.terminal.files import format_known, picture
from kinematics.answers.circles import MicrTable
from kinematics.storage import csv_text

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
    if format_known(ending, FORMATS, "curves are") == "csv":
        return micr_csv(kind, ratios, heights, found).encode()
    return picture(micr_figure(title, ratios, heights, found), ending)


def micr_csv(kind: str, ratios: Sequence[float], heights: Sequence[float], found: MicrTable) -> str:
    """One row a circle; where no tilt is singular both angles are empty."""
    rows: list[Sequence[object]] = [COLUMNS]
    angles = np.degrees(np.stack([found.radius, found.contact], axis=-1))
    for place in np.ndindex(*found.radius.shape):
        n, r, h = place
        told = [value if np.isfinite(value) else "" for value in angles[place].tolist()]
        crosses = int(found.barred[place])
        rows.append([kind, found.modes[n], ratios[r], round(heights[h], 12), *told, crosses])
    return csv_text(rows)


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
