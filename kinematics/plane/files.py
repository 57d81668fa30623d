"""Sections as files: pure functions from a section to DXF and CSV. Lengths mm."""

from __future__ import annotations

import io
from collections.abc import Callable
from math import atan2, degrees, isfinite
from typing import Any

from kinematics.answers.sections import BOUNDS, EdgeBound, Section, SectionSpec
from kinematics.errors import InputError
from kinematics.storage import csv_text

LINETYPES: dict[EdgeBound, str] = {
    "rho_max": "CONTINUOUS",
    "rho_min": "DASHED",
    "link": "DOT",
    "parallel": "CONTINUOUS",
}

Edge = dict[str, Any]


def section_bytes(section: Section, spec: SectionSpec, kind: str) -> bytes:
    """A section as the content of a file, "dxf" or "csv".

    Raises:
        InputError: it is written as neither.
    """
    if kind not in ("dxf", "csv"):
        raise InputError(f"a section is saved as .dxf or .csv, not as {kind!r}")
    return (section_dxf if kind == "dxf" else section_csv)(section, spec).encode()


def section_loops(section: Section) -> list[list[Edge]]:
    """The edges in order, loop by loop, as plain values; an arc's sweep is signed, in degrees."""
    return [
        [_edge(section, k) for k in range(section.loop_start[n], section.loop_start[n + 1])]
        for n in range(section.loops)
    ]


def _edge(section: Section, k: int) -> Edge:
    radius = float(section.radius[k])
    is_arc = isfinite(radius)
    return {
        "kind": "arc" if is_arc else "line",
        "limb": int(section.limb[k]),
        "bound": BOUNDS[section.bound[k]],
        "from": section.start[k].tolist(),
        "to": section.end[k].tolist(),
        "center": section.center[k].tolist() if is_arc else None,
        "radius": radius if is_arc else None,
        "sweep_deg": degrees(section.sweep[k]),
    }


def section_csv(section: Section, spec: SectionSpec) -> str:
    """One row an edge, in order; loop, piece and edge count from 1. A line has no center."""
    u, v = ("".join(letter for letter in axis if letter.isalnum()) for axis in spec.axes)
    places = [f"{name}_{axis}_mm" for name in ("from", "to", "center") for axis in (u, v)]
    rows: list[list[object]] = [
        ["loop", "piece", "edge", "kind", "limb", "bound", *places, "radius_mm", "sweep_deg"]
    ]
    for n, loop in enumerate(section_loops(section)):
        for k, edge in enumerate(loop, start=1):
            kind = edge["kind"], edge["limb"], edge["bound"]
            center = edge["center"] or ("", "")
            radius = "" if edge["radius"] is None else edge["radius"]
            points = *edge["from"], *edge["to"], *center
            where = n + 1, int(section.loop_piece[n]) + 1, k
            rows.append([*where, *kind, *points, radius, edge["sweep_deg"]])
    return csv_text(rows)


def section_dxf(
    section: Section,
    spec: SectionSpec,
    *,
    title: str = "",
    color: Callable[[int], tuple[int, int, int]] | None = None,
) -> str:
    """A drawing of true arcs and lines: a layer a limb, dashed by bound, in the section's order.

    The drawing's x and y are the section's axes.

    Args:
        color: red, green and blue, 0 to 255, of a limb's layer; None: all the same.
    """
    from ezdxf import units
    from ezdxf.filemanagement import new

    drawing = new("R2010", setup=["linetypes"], units=units.MM)
    plane = f"{spec.normal} = {section.at:.9g} mm; x, y are {', '.join(spec.axes)}"
    drawing.header.custom_vars.append("Section", f"{title}: {plane}" if title else plane)
    for limb in sorted({*section.limb.tolist(), *section.construction.circle_limb.tolist()}):
        layer = drawing.layers.add(f"limb{limb}")
        if color is not None:
            layer.rgb = color(limb)
    space = drawing.modelspace()
    for edge in (edge for loop in section_loops(section) for edge in loop):
        look = {"layer": f"limb{edge['limb']}", "linetype": LINETYPES[edge["bound"]]}
        if edge["kind"] == "line":
            space.add_line(edge["from"], edge["to"], dxfattribs=look)
            continue
        ends = edge["from"], edge["to"]
        first, last = ends if edge["sweep_deg"] > 0 else ends[::-1]  # arcs turn to the left
        space.add_arc(
            edge["center"],
            edge["radius"],
            _angle(edge["center"], first),
            _angle(edge["center"], last),
            dxfattribs=look,
        )
    written = io.StringIO()
    drawing.write(written)
    return written.getvalue()


def _angle(center: list[float], point: list[float]) -> float:
    """The direction of a point from a center, degrees."""
    return degrees(atan2(point[1] - center[1], point[0] - center[0]))
