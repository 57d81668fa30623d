"""Loci of singularities as files: pure functions from curves to CSV and SVG. Angles are degrees."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from app.features.singularities.plot import chart_svg
from app.terminal.files import format_known
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.singularities import SingularityKind
from kinematics.arrays import Array
from kinematics.storage import csv_text

FORMATS: tuple[str, ...] = ("csv", "svg")


def locus_bytes(
    found: LocusCurves, spec: LocusSpec, kind: str, *, title: str = "", note: str = ""
) -> bytes:
    """A chart's curves as the content of a file.

    Raises:
        InputError: ``kind`` is not one of `FORMATS`.
    """
    if format_known(kind, FORMATS, "a chart is") == "csv":
        return locus_csv(found, spec).encode()
    return chart_svg(spec, found, title=title, note=note).encode()


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
    return "".join(_latin(c) if "α" <= c <= "ω" else c for c in symbol.lower() if c.isalnum())


def _latin(letter: str) -> str:
    """ "phi" of "φ"; Unicode alone writes lambda without its b."""
    return unicodedata.name(letter).rpartition(" ")[2].lower().replace("lamda", "lambda")
