"""Sections as files: pure functions from a section to DXF and CSV. Lengths mm."""

from __future__ import annotations

import io
from collections.abc import Callable, Collection, Sequence
from math import atan2, degrees, isfinite
from typing import Any

import numpy as np

from kinematics.answers.sections import BOUNDS, EdgeBound, Section, SectionSpec
from kinematics.errors import InputError
from kinematics.lengths import from_mm
from kinematics.storage import csv_text

LINETYPES: dict[EdgeBound, str] = {
    "rho_max": "CONTINUOUS",
    "rho_min": "DASHED",
    "link": "DOT",
    "parallel": "CONTINUOUS",
}

Edge = dict[str, Any]
Color = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""
FORBIDDEN = frozenset("<>/\\\":;?*|='`,")
"""What no layer's name may have."""
DXF_UNITS = {"mm": "MM", "cm": "CM", "m": "M", "inch": "IN"}


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
    color: Callable[[int], Color] | None = None,
    layers: Sequence[tuple[str, Color, Section]] = (),
    unit: str = "mm",
) -> str:
    """A drawing of true arcs and lines: a layer a limb, dashed by bound, in the section's order.

    The drawing's x and y are the section's axes, mm or of another ``unit``, as it states. Its
    extents are those of the edges.

    Args:
        color: of a limb's layer; None: all the same.
        layers: names, colours and the parts of which the section consists: a layer each, instead
            of one a limb.
    """
    from ezdxf import bbox, units, zoom
    from ezdxf.filemanagement import new

    drawing = new("R2010", setup=["linetypes"], units=getattr(units, DXF_UNITS[unit]))
    plane = (
        f"{spec.normal} = {from_mm(section.at, unit):.9g} {unit}; x, y are {', '.join(spec.axes)}"
    )
    drawing.header.custom_vars.append("Section", f"{title}: {plane}" if title else plane)
    space = drawing.modelspace()
    scale = from_mm(1.0, unit)
    used: set[int] = set()

    def layer(name: str, shown: Color | None) -> str:
        plain = name.replace("< 0", "negative").replace("> 0", "positive")[:100]
        plain = "".join("-" if c in FORBIDDEN or c < " " else c for c in plain)
        made = drawing.layers.add(plain)
        if shown is not None:
            made.rgb, made.color = shown, _nearest_index(shown, used)
            used.add(made.color)
        return plain

    limbs = sorted({*section.limb.tolist(), *section.construction.circle_limb.tolist()})
    if layers:
        for name, shown, part in layers:
            _draw(space, part, dict.fromkeys(limbs, layer(name, shown)), scale)
    else:
        shades = {n: None if color is None else color(n) for n in limbs}
        _draw(space, section, {n: layer(f"limb{n}", shade) for n, shade in shades.items()}, scale)
    box = bbox.extents(space)
    low, high = (box.extmin, box.extmax) if box.has_data else ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    space.reset_extents(low, high)
    drawing.header["$EXTMIN"], drawing.header["$EXTMAX"] = low, high  # where they begin at 0, 0
    space.reset_limits(tuple(low)[:2], tuple(high)[:2])
    if box.has_data:
        zoom.window(space, low, high)
    written = io.StringIO()
    drawing.write(written)
    return written.getvalue()


def _draw(space: Any, section: Section, layers: dict[int, str], scale: float) -> None:
    """Put the edges into a drawing, each on the layer of its limb."""
    for edge in (edge for loop in section_loops(section) for edge in loop):
        for name in ("from", "to", "center", "radius"):
            if edge[name] is not None:
                edge[name] = (np.asarray(edge[name]) * scale).tolist()
        look = {"layer": layers[edge["limb"]], "linetype": LINETYPES[edge["bound"]]}
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


def _nearest_index(shown: Color, used: Collection[int]) -> int:
    """The numbered colour that comes nearest, for programs that know no others; none twice, and not
    7, which is black or white as a program likes.
    """
    from ezdxf.colors import aci2rgb

    def distance(index: int) -> int:
        return sum((a - b) ** 2 for a, b in zip(aci2rgb(index), shown, strict=True))

    known = [n for n in range(1, 250) if n != 7]
    return min((n for n in known if n not in used or len(used) > 200), key=distance)


def _angle(center: list[float], point: list[float]) -> float:
    """The direction of a point from a center, degrees."""
    return degrees(atan2(point[1] - center[1], point[0] - center[0]))
