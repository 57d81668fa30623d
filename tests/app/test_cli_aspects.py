"""`bohemia singularity` without a pose: aspects of an orientation, loci and pieces as files."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.conftest import Finished, answered, refused

Run = Callable[..., Finished]

DESIGN = load_design("rpur-table1")
MACHINE = machine_of(DESIGN)
AT = ("singularity", "rpur-table1", "--phi", "-10", "--theta", "20", "--mode", "-----")
ANGLES = np.radians([-10.0, 20.0])


def determinants(points):
    poses = np.column_stack([points, np.tile(ANGLES, (len(points), 1))])
    return machine_of(DESIGN).statics.wrenches(poses, "-----").determinant


def test_pieces_their_signs_and_their_sum(bohemia: Run) -> None:
    answer = answered(bohemia(*AT, "--json"))
    assert answer["mode"] == answer["working_mode"] == "-----"
    pieces = answer["pieces"]
    assert len(pieces) > 1
    assert {piece["sign"] for piece in pieces} == {1, -1}
    assert sum(p["volume_mm3"] for p in pieces) == pytest.approx(answer["volume_mm3"], rel=1e-12)
    whole = answered(bohemia("workspace", *AT[1:6], "--modes", "-----", "--json"))
    assert answer["volume_mm3"] == pytest.approx(whole["volume_mm3"], rel=1e-6)
    assert answer["watertight"] is True
    assert answer["locus_area_mm2"] > 0.0
    assert answer["locus_residual_mm"] < 1e-9
    assert answer["file"] is None
    largest = pieces[0]
    determinant = determinants(np.array([largest["centroid_mm"]]))
    assert np.sign(determinant) == largest["sign"]


def test_the_surface_is_written_once_and_open(here: Run, tmp_path: Path) -> None:
    answer = answered(here(*AT, "-o", str(tmp_path / "locus.ply"), "--json"))
    surface = trimesh.load(tmp_path / "locus.ply", process=False)
    assert not surface.is_watertight
    assert surface.area == pytest.approx(answer["locus_area_mm2"], rel=1e-5)
    rows = (tmp_path / "locus.ply").read_bytes()
    assert b"unit mm" in rows[:200]
    # Its vertices are where the wrenches are dependent, but for some at the rim.
    away = np.abs(determinants(np.asarray(surface.vertices)))
    assert np.median(away) < 1e-6 * np.abs(determinants(surface.vertices + 5.0)).max()
    answered(here(*AT, "-o", str(tmp_path / "locus.csv"), "--json"))
    text = (tmp_path / "locus.csv").read_text()
    points = np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1)
    assert text.startswith("x_mm,y_mm,z_mm\n")
    assert points == pytest.approx(np.asarray(surface.vertices), abs=1e-3)


def test_a_piece_is_written_as_a_closed_solid(here: Run, tmp_path: Path) -> None:
    path = tmp_path / "piece.stl"
    answer = answered(here(*AT, "--what", "2", "-o", str(path), "--json"))
    solid = trimesh.load(path)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(answer["pieces"][1]["volume_mm3"], rel=1e-5)
    assert solid.center_mass == pytest.approx(answer["pieces"][1]["centroid_mm"], abs=1e-2)


def test_said_in_words(here: Run) -> None:
    text = here(*AT, "--resolution", "preview").stdout
    assert "working mode -----, preview" in text
    assert re.search(r"1 +[\d\u202f]+ +det [<>] 0", text)
    assert "pieces may be joined through others" in text
    empty = here("singularity", "rpur-table1", "--mode", "++--+").stdout
    assert "The workspace of this mode is empty at this orientation." in empty
    none = here("singularity", "rpur-mpa1", "--mode", "+++++", "--resolution", "preview").stdout
    assert "No singularity inside is found at this resolution; a finer one" in none


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--what", "9", "-o", "x.stl"), "there is no piece 9 of"),
        (("--what", "all"), "--what must be locus or the number of a piece, got 'all'"),
        (("-o", "x.dxf"), "ending .dxf"),
        (("--what", "1", "-o", "x.csv"), "ending .csv"),
        (("--at", "3"), "--at goes with --pose"),
        (("--chart", "section"), "--chart goes with --pose"),
        (("--pose", "0,100,300,0,0"), "--phi is for all positions together"),
        (("--resolution", "best"), "invalid choice"),
    ],
)
def test_refusals(here: Run, arguments: tuple[str, ...], said: str) -> None:
    assert said in refused(here(*AT, *arguments))


def test_no_surface_no_file(here: Run, tmp_path: Path) -> None:
    path = tmp_path / "locus.stl"
    done = here("singularity", "rpur-mpa1", "--mode", "+++++", "-o", str(path))
    assert done.code == 1
    assert "there is no singularity inside the workspace" in done.stderr
    assert not path.exists()
