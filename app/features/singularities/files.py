"""Loci of singularities as files: pure functions from curves to CSV and SVG. Angles are degrees."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from app.scene.palette import BEYOND, INK, limb_color
from app.terminal.files import format_known, picture
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.singularities import SingularityKind
from kinematics.arrays import Array
from kinematics.storage import csv_text

if TYPE_CHECKING:  # loaded only where a figure is drawn
    from matplotlib.figure import Figure

FORMATS: tuple[str, ...] = ("csv", "svg")
_GREEK = {
    "α": "alpha",
    "β": "beta",
    "γ": "gamma",
    "θ": "theta",
    "λ": "lambda",
    "ρ": "rho",
    "σ": "sigma",
    "φ": "phi",
    "ψ": "psi",
}
_STYLES: dict[SingularityKind, tuple[str, str]] = {
    "parallel": (BEYOND, "-"),
    "constraint": (INK, "-"),
    "serial": (INK, "--"),
    "self-motion": (BEYOND, ":"),
    "architectural": (BEYOND, "-."),
}
"""Colour and dash; a serial curve has its limb's colour."""
_SIZE = 6.4, 5.6  # inches
_NARROW = 0.4


def locus_bytes(
    found: LocusCurves, spec: LocusSpec, kind: str, *, title: str = "", note: str = ""
) -> bytes:
    """A chart's curves as the content of a file.

    Raises:
        InputError: ``kind`` is not one of `FORMATS`.
    """
    if format_known(kind, FORMATS, "a chart is") == "csv":
        return locus_csv(found, spec).encode()
    return picture(locus_figure(found, spec, title=title, note=note), kind)


def columns(spec: LocusSpec) -> tuple[str, str]:
    """What the two coordinates are called in files: "phi_deg", "x_mm"."""
    first, second = (
        f"{_plain(symbol)}_{'deg' if unit == 'rad' else unit}"
        for symbol, unit in zip(spec.axes, spec.units, strict=True)
    )
    return first, second


def outer(points: Array, spec: LocusSpec) -> Array:
    """Points (N, 2) in people's units: radians become degrees."""
    return points * [np.degrees(1.0) if unit == "rad" else 1.0 for unit in spec.units]


def curves(found: LocusCurves, spec: LocusSpec) -> list[dict[str, Any]]:
    """The curves as plain values; a closed one ends where it begins."""
    points, residuals = outer(found.points, spec), _residuals(found, spec)
    answer = []
    for part, kind, limb in _each(found):
        line = points[part]
        answer.append(
            {
                "kind": kind,
                "limb": limb or None,
                "closed": len(line) > 2 and bool((line[0] == line[-1]).all()),
                "points": line.tolist(),
                "residual": float(residuals[part].max(initial=0.0)),
            }
        )
    return answer


def _each(found: LocusCurves) -> Iterator[tuple[slice, SingularityKind, int]]:
    """Of each curve its points among all, its kind, and its limb or 0."""
    ends = pairwise(found.start.tolist())
    for (first, behind), kind, limb in zip(ends, found.kinds, found.limb.tolist(), strict=True):
        yield slice(first, behind), kind, limb


def locus_csv(found: LocusCurves, spec: LocusSpec) -> str:
    """One row a point; curves count from 1, a limb is empty where a curve belongs to none."""
    unit = "deg" if spec.units[0] == "rad" else spec.units[0]
    rows: list[list[object]] = [["curve", "kind", "limb", *columns(spec), f"residual_{unit}"]]
    told = np.column_stack([outer(found.points, spec), _residuals(found, spec)])
    for n, (part, kind, limb) in enumerate(_each(found), start=1):
        rows += ([n, kind, limb or "", *point] for point in told[part].tolist())
    return csv_text(rows)


def _residuals(found: LocusCurves, spec: LocusSpec) -> Array:
    """In the first coordinate's unit, degrees for radians."""
    return np.degrees(found.residual) if spec.units[0] == "rad" else found.residual


def _plain(symbol: str) -> str:
    """Letters that every program reads: "φ" → "phi", "x′" → "x"."""
    return "".join(_GREEK.get(c, c) for c in symbol.lower() if c.isalnum())


# --- figures -------------------------------------------------------------------------------


def locus_figure(found: LocusCurves, spec: LocusSpec, *, title: str = "", note: str = "") -> Figure:
    """The curves in their chart; a polar chart has its second coordinate as the azimuth."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=_SIZE, layout="constrained")
    panel: Any = figure.add_subplot(projection="polar" if spec.polar else None)
    points = outer(found.points, spec)
    bounds = outer(found.bounds.T, spec).T
    named: set[str] = set()
    for part, kind, limb in _each(found):
        color, dash = _STYLES[kind]
        name = f"{kind}, limb {limb}" if limb else kind
        u, v = points[part].T
        panel.plot(
            *((found.points[part, 1], u) if spec.polar else (u, v)),
            color=limb_color(limb) if limb else color,
            linestyle=dash,
            linewidth=1.4,
            label=name if name not in named else "_",
        )
        named.add(name)
    for barrier in found.barriers if spec.polar else ():
        turn = np.linspace(0.0, 2.0 * np.pi, 361)
        radius = outer(np.array([[barrier, 0.0]]), spec)[0, 0]
        panel.plot(turn, np.full_like(turn, radius), color=INK, linestyle=":", linewidth=0.9)
    labels = [
        f"{a} ({'°' if unit == 'rad' else unit})"
        for a, unit in zip(spec.axes, spec.units, strict=True)
    ]
    if spec.polar:
        panel.set_rlim(0.0, float(bounds[0, 1]))
        panel.set_xlabel(f"radius {labels[0]}, azimuth {labels[1]}")
    else:
        panel.set_xlim(*bounds[0])
        panel.set_ylim(*bounds[1])
        panel.set_xlabel(labels[0])
        panel.set_ylabel(labels[1])
        if spec.units[0] == spec.units[1]:
            panel.set_aspect("equal")
            across, up = (bounds[:, 1] - bounds[:, 0]).tolist()
            if across < _NARROW * up:  # labels side by side need room
                panel.locator_params(axis="x", nbins=3)
    panel.grid(alpha=0.25)
    if not found.kinds:
        panel.text(0.5, 0.5, "no singularity here", transform=panel.transAxes, ha="center")
    if named:
        figure.legend(
            loc="outside lower center", ncols=min(len(named), 4), frameon=False, fontsize=9
        )
    panel.set_title(f"{title}\n{note}".strip(), fontsize=10)
    return figure
