"""Files that leave Bohemia: their names, and their content read back by another reader."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from functools import cache
from pathlib import PurePath
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from app.features.review import files
from kinematics.designs.files import load_design, presets, read_design
from kinematics.errors import ComputationError, InputError
from kinematics.facets.solids import build_solid
from kinematics.machine import machine_of
from kinematics.screws.spatial import homogeneous, rotation_y, rotation_z
from kinematics.solids import csg
from kinematics.solids import files as solid_files

PLACEMENT = homogeneous(rotation_y(0.7) @ rotation_z(-0.3), [100.0, -200.0, 300.0])


@cache
def built() -> csg.BuiltSolid:
    """A real workspace in several pieces."""
    design = load_design("rpur-table1")
    pose = (0.0, 0.0, 0.0, 0.2, -0.1)
    return build_solid(machine_of(design).solids.request("workspace", pose, None, "preview"))


def read_back(data: bytes, kind: str) -> trimesh.Trimesh:
    mesh = trimesh.load(io.BytesIO(data), file_type=kind, force="mesh")
    assert isinstance(mesh, trimesh.Trimesh)
    mesh.merge_vertices()
    if kind == "glb":  # metres, y upwards
        x, y, z = 1000.0 * mesh.vertices.T
        mesh.vertices = np.stack([x, -z, y], axis=-1)
    return mesh


def test_the_formats_are_those_that_can_be_encoded() -> None:
    assert set(files.FORMATS) == set(solid_files.KINDS)
    assert set(files.MEDIA_TYPES) >= set(files.FORMATS)


@pytest.mark.parametrize("kind", files.FORMATS)
def test_a_file_holds_the_solid_in_base_coordinates(kind: str) -> None:
    solid = built()
    file = files.solid_file(solid, PLACEMENT, kind, name="a_b")
    assert file.name == (f"a_b.{kind}" if kind in ("3mf", "glb") else f"a_b_mm.{kind}")
    mesh = read_back(file.data, kind)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(solid.volume, rel=1e-5)
    moved = solid.mesh.vertices @ PLACEMENT[:3, :3].T + PLACEMENT[:3, 3]
    expected = np.array([moved.min(axis=0), moved.max(axis=0)])
    assert mesh.bounds == pytest.approx(expected, abs=1e-3)


def test_placing_moves_vertices_and_keeps_the_rest() -> None:
    mesh = built().mesh
    moved = files.placed(mesh, PLACEMENT)
    assert np.array_equal(moved.faces, mesh.faces)
    assert not moved.vertices.flags.writeable
    back = files.placed(moved, np.linalg.inv(PLACEMENT))
    assert back.vertices == pytest.approx(mesh.vertices, abs=1e-9)
    assert files.placed(mesh, np.eye(4)).vertices == pytest.approx(mesh.vertices, abs=0)


def test_an_unsound_or_empty_solid_is_not_written() -> None:
    solid = built()
    vertices = solid.mesh.vertices.copy()
    vertices[0] = np.nan
    bad = replace(solid, mesh=csg.SolidMesh(vertices, solid.mesh.faces))
    with pytest.raises(ComputationError):
        files.solid_bytes(bad, np.eye(4), "stl")

    design: Any = load_design("rpur-table1")
    far = replace(design.limbs[0], base=(9e5, 0.0, 0.0))
    apart = replace(design, limbs=(far, *design.limbs[1:]))
    request = machine_of(apart).solids.request("workspace", (0.0,) * 5, None, "preview")
    with pytest.raises(ComputationError, match="empty"):
        files.solid_bytes(build_solid(request), np.eye(4), "stl")


def test_an_unknown_format_is_named() -> None:
    with pytest.raises(InputError, match=r"'step'; .* stl, 3mf, ply, glb or obj"):
        files.solid_bytes(built(), np.eye(4), "step")


@pytest.mark.parametrize(
    ("path", "kind"), [("a.stl", "stl"), ("b.c/d.3MF", "3mf"), ("x.tar.Glb", "glb")]
)
def test_the_ending_says_the_format(path: str, kind: str) -> None:
    assert files.format_of(PurePath(path)) == kind


@pytest.mark.parametrize("path", ["a", "a.", "stl", ".stl", "a.stlx", "dir.stl/a"])
def test_other_endings_are_refused(path: str) -> None:
    with pytest.raises(InputError, match=r"one of \.stl, \.3mf, \.ply, \.glb, \.obj"):
        files.format_of(PurePath(path))


def test_names_say_what_the_solid_is() -> None:
    design = load_design("rpur-table1")
    axes = machine_of(load_design("rpur-table1")).coordinates[3:]

    def name(key: str, phi: float, theta: float, *modes: str) -> str:
        orientation = tuple(zip(axes, np.radians([phi, theta]).tolist(), strict=True))
        return files.solid_name(design, key, orientation, modes or None)

    assert name("workspace", 0, -0.0) == "rpur-table1_workspace_phi0_theta0"
    assert name("limb3/H2", -17.2, 45) == "rpur-table1_limb3-H2_phi-17.2_theta45"
    assert name("workspace", 1e-9, 0, "-+++-") == "rpur-table1_workspace_phi0_theta0_-+++-"
    assert name("workspace", 0, 0, "-+++-", "+++++").endswith("_2modes")
    assert name("workspace", 0, 0, "-+++-") != name("workspace", 0, 0, "++++-")


@given(st.text())
def test_any_text_becomes_a_part_of_a_file_name(text: str) -> None:
    part = files.sanitized(text)
    assert re.fullmatch(r"[A-Za-z0-9.+-]{1,80}", part)
    assert not part.startswith(".")
    assert files.sanitized(part) == part


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("rpur-table1", "rpur-table1"),
        ("../../etc/passwd", "etc-passwd"),
        ("C:\\a b", "C-a-b"),
        ("naïve", "naive"),
        ("φ", "unnamed"),
        ("", "unnamed"),
        ("-----", "-----"),
    ],
)
def test_sanitized(text: str, part: str) -> None:
    assert files.sanitized(text) == part


@pytest.mark.parametrize("name", [preset.name for preset in presets()])
def test_a_design_file_reads_back_equal(name: str) -> None:
    design = load_design(name)
    file = files.design_file(design)
    assert file.name == f"{name}.toml"
    assert read_design(file.data.decode(), origin="file", name=name) == design
