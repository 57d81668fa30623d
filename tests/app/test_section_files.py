"""Sections as files: what is read back is the section, to the last digit that the format has."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import replace
from itertools import pairwise
from math import radians, tau
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest

from app.features.section.files import section_bytes, section_loops
from app.scene.palette import limb_color, rgb
from kinematics.answers.sections import Construction, Section, together
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from tests.app.made_sections import EMPTY, LENS, RING, SPEC, TWO, area_by_edge

SECTIONS = {"ring": RING, "lens": LENS, "two": TWO, "empty": EMPTY}
ALL = pytest.mark.parametrize("section", SECTIONS.values(), ids=SECTIONS)


# --- DXF -----------------------------------------------------------------------------------


@ALL
def test_a_dxf_holds_true_arcs_that_close_and_enclose_the_area(section: Section) -> None:
    drawing = ezdxf.read(io.StringIO(section_bytes(section, SPEC, "dxf").decode()))
    auditor = drawing.audit()
    assert not auditor.errors
    assert not auditor.fixes
    assert drawing.units == ezdxf.units.MM
    found = list(drawing.modelspace())
    assert [edge.dxftype() for edge in found] == [
        "ARC" if arc else "LINE" for arc in section.is_arc
    ]
    area = 0.0
    edges = []
    for k, edge in enumerate(found):
        if edge.dxftype() == "ARC":
            turn = radians(edge.dxf.end_angle - edge.dxf.start_angle) % tau
            ends = complex(*edge.start_point.xyz[:2]), complex(*edge.end_point.xyz[:2])
            if section.sweep[k] < 0:
                ends, turn = ends[::-1], -turn
        else:
            turn = 0.0
            ends = complex(*edge.dxf.start.xyz[:2]), complex(*edge.dxf.end.xyz[:2])
        area += area_by_edge(*ends, turn)
        edges.append(ends)
        assert edge.dxf.layer == f"limb{section.limb[k]}"
        assert drawing.layers.get(edge.dxf.layer).rgb == rgb(limb_color(int(section.limb[k])))
    assert area == pytest.approx(section.area, rel=1e-12, abs=1e-9)
    for first, last in pairwise(section.loop_start):
        loop = edges[first:last]
        for (_, end), (start, _) in zip(loop, loop[1:] + loop[:1], strict=True):
            assert abs(end - start) < 1e-9


def test_a_dxf_says_which_plane_it_is() -> None:
    text = section_bytes(RING, SPEC, "dxf", title="Table 1").decode()
    (said,) = dict(ezdxf.read(io.StringIO(text)).header.custom_vars).values()
    assert said == "Table 1: x′ = 25 mm; x, y are y′, z′"


def test_a_dxf_tells_the_bounds_by_their_dashes() -> None:
    drawing = ezdxf.read(io.StringIO(section_bytes(TWO, SPEC, "dxf").decode()))
    space = drawing.modelspace()
    assert {edge.dxf.linetype for edge in space.query("LINE")} == {"DOT"}
    assert {edge.dxf.linetype for edge in space.query("ARC")} == {"CONTINUOUS"}
    assert "DOT" in drawing.linetypes


# --- CSV and plain values ------------------------------------------------------------------


@ALL
def test_a_csv_loses_nothing(section: Section) -> None:
    rows = list(csv.DictReader(io.StringIO(section_bytes(section, SPEC, "csv").decode())))
    assert len(rows) == len(section.limb)
    for k, row in enumerate(rows):
        assert [float(row["from_y_mm"]), float(row["from_z_mm"])] == section.start[k].tolist()
        assert [float(row["to_y_mm"]), float(row["to_z_mm"])] == section.end[k].tolist()
        assert int(row["limb"]) == section.limb[k]
        assert row["kind"] == ("arc" if section.is_arc[k] else "line")
        if section.is_arc[k]:
            assert float(row["radius_mm"]) == section.radius[k]
            center = [float(row["center_y_mm"]), float(row["center_z_mm"])]
            assert center == section.center[k].tolist()
            assert radians(float(row["sweep_deg"])) == pytest.approx(section.sweep[k], abs=1e-14)
        else:
            assert row["radius_mm"] == row["center_y_mm"] == row["center_z_mm"] == ""
    counts = np.diff(section.loop_start)
    assert [int(row["loop"]) for row in rows] == np.repeat(
        1 + np.arange(len(counts)), counts
    ).tolist()
    pieces = np.repeat(section.loop_piece + 1, counts).tolist()
    assert [int(row["piece"]) for row in rows] == pieces


def test_loops_as_plain_values() -> None:
    (loop,) = section_loops(LENS)
    first, second = loop
    assert first["to"] == second["from"]
    assert second["to"] == first["from"]
    assert first["center"] == [-30.0, 0.0]
    assert first["bound"] == "rho_max"
    assert first["sweep_deg"] == pytest.approx(2 * 53.13010235415598)
    assert section_loops(EMPTY) == []
    line = section_loops(TWO)[0][0]
    assert (line["kind"], line["center"], line["radius"], line["sweep_deg"]) == (
        "line",
        None,
        None,
        0.0,
    )


def test_other_formats_are_refused() -> None:
    with pytest.raises(InputError, match="svg, dxf or csv"):
        section_bytes(RING, SPEC, "pdf")


# --- sizes, layers, colours ----------------------------------------------------------------

SVG = "{http://www.w3.org/2000/svg}"


def _numbers(path: str) -> list[tuple[float, float]]:
    """The ends of a path's parts."""
    ends = []
    for _, rest in re.findall(r"([MLA])([^MLAZ]*)", path):
        words = [float(word) for word in rest.split()]
        ends.append((words[-2], -words[-1]))
    return ends


def scaled(section: Section, by: float) -> Section:
    """The same, so many times as large."""

    def made() -> Construction:
        old = section.construction
        return replace(old, center=old.center * by, radius=old.radius * by, line=old.line * by)

    return replace(
        section,
        start=section.start * by,
        end=section.end * by,
        center=section.center * by,
        radius=section.radius * by,
        construct=made,
    )


@pytest.mark.parametrize("by", [1e-6, 1e-3, 1.0, 1e3])
@pytest.mark.parametrize("section", [RING, LENS, TWO], ids=["ring", "lens", "two"])
def test_an_svg_has_its_true_size_in_mm(section: Section, by: float) -> None:
    section = scaled(section, by)
    root = ElementTree.fromstring(section_bytes(section, SPEC, "svg", title="a"))
    left, top, wide, high = map(float, root.get("viewBox", "").split())
    assert root.get("width", "").endswith("mm")
    assert float(root.get("width", "").removesuffix("mm")) == wide
    assert float(root.get("height", "").removesuffix("mm")) == high
    (region,) = (p for p in root.iter(f"{SVG}path") if p.get("class") == "region")
    ends = np.array(_numbers(region.get("d", "")))
    for true in section.start:  # each corner where it is, in mm
        assert np.linalg.norm(ends - true, axis=1).min() < 1e-6 * wide
    assert (ends[:, 0] > left).all()
    assert (ends[:, 0] < left + wide).all()
    assert (-ends[:, 1] > top).all()
    assert (-ends[:, 1] < top + high).all()
    assert wide < 2.5 * max(np.ptp(ends, axis=0))  # the drawing fills its sheet
    radii = {float(r) for r in re.findall(r"A([-\d.]+) ", region.get("d", ""))}
    for radius in section.radius[section.is_arc].tolist():
        assert min(abs(known - radius) for known in radii) < 1e-6 * wide


@ALL
def test_a_dxf_has_the_extents_of_its_edges(section: Section) -> None:
    drawing = ezdxf.read(io.StringIO(section_bytes(section, SPEC, "dxf").decode()))
    low, high = (np.array(drawing.header[f"$EXT{end}"])[:2] for end in ("MIN", "MAX"))
    points = [section.edge_points(k, 0.01) for k in range(len(section.limb))]
    true = np.concatenate(points) if points else np.zeros((1, 2))
    assert low == pytest.approx(true.min(axis=0), abs=1e-3)
    assert high == pytest.approx(true.max(axis=0), abs=1e-3)
    assert drawing.header["$INSUNITS"] == 4  # mm


@pytest.mark.parametrize("key", ["aspects", "modes"])
def test_each_aspect_has_a_layer_and_a_colour(key: str) -> None:
    machine = machine_of(load_design("five-bar"))
    regions = machine.regions.of(key, machine.home.pose, None)
    spec = next(s for s in machine.region_specs if s.key == key).plane
    whole = together([region.section for region in regions])
    text = section_bytes(whole, spec, "dxf", parts=regions).decode()
    drawing = ezdxf.read(io.StringIO(text))
    assert not drawing.audit().errors
    used = {edge.dxf.layer for edge in drawing.modelspace()}
    layers = [drawing.layers.get(name) for name in used]
    assert len(layers) == len(regions) > 1
    assert len({layer.color for layer in layers}) == len({layer.rgb for layer in layers})
    assert len({layer.rgb for layer in layers}) == len(regions)
    assert all(layer.color != 7 for layer in layers)
    for n, region in enumerate(regions, start=1):
        edges = [e for e in drawing.modelspace() if e.dxf.layer.split()[0] == str(n)]
        assert len(edges) == len(region.section.limb)
    svg = ElementTree.fromstring(section_bytes(whole, spec, "svg", parts=regions))
    fills = [p.get("fill") for p in svg.iter(f"{SVG}path") if p.get("class") == "region"]
    assert len(set(fills)) == len(regions)
