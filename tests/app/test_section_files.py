"""Sections as files: what is read back is the section, to the last digit that the format has."""

from __future__ import annotations

import csv
import io
from itertools import pairwise
from math import radians, tau

import ezdxf
import numpy as np
import pytest

from app.features.section.files import section_bytes, section_loops
from app.scene.palette import limb_color, rgb
from kinematics.answers.sections import Section
from kinematics.errors import InputError
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
