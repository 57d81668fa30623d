"""The adapter over manifold3d: Booleans that remember, pieces with voids, files that survive."""

from __future__ import annotations

import io
import pickle

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from kinematics.errors import ComputationError, InputError
from kinematics.screws.spatial import homogeneous, rotation_x, rotation_y
from kinematics.solids.csg import Solid, SolidMesh, finish
from kinematics.solids.files import KINDS, encode

CORNERS = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)
SQUARES = np.concatenate([SIDES[:, [0, 1, 2]], SIDES[:, [0, 2, 3]]])
NAMES = ("x0", "x1", "y0", "y1", "z0", "z1")


def box(low=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0)) -> Solid:
    vertices = np.asarray(low) + CORNERS * np.asarray(size)
    side = np.tile(np.arange(6), 2)
    return Solid.from_mesh(vertices, SQUARES, patch=side, plane=side, tags=NAMES)


def finished(solid: Solid, **options):
    return finish(solid, lambda traced, volume: 0.0, **options)


def reloaded(data: bytes, kind: str) -> trimesh.Trimesh:
    loaded = trimesh.load(io.BytesIO(data), file_type=kind)
    mesh = loaded.to_mesh() if isinstance(loaded, trimesh.Scene) else loaded
    if kind == "glb":  # metres, y upwards
        x, y, z = 1000.0 * mesh.vertices.T
        mesh.vertices = np.stack([x, -z, y], axis=-1)
    return mesh


# --- adapter


def test_measures_of_a_box():
    solid = box((1, 2, 3), (2, 3, 4))
    assert solid.volume == pytest.approx(24.0, rel=1e-14)
    assert solid.area == pytest.approx(52.0, rel=1e-14)
    assert solid.bounds == ((1, 2, 3), (3, 5, 7))
    assert solid.triangles == 12
    assert not solid.is_empty


def test_booleans():
    a, b = box(), box((0.5, 0.25, 0.25), (1, 0.5, 0.5))
    assert Solid.union((a, b)).volume == pytest.approx(1.125)
    assert Solid.intersection((a, b)).volume == pytest.approx(0.125)
    assert a.difference((b,)).volume == pytest.approx(0.875)
    assert a.difference((b, box((0, 0, 0.9)))).volume == pytest.approx(0.775)


def test_empty_solids_are_solids():
    for empty in (
        Solid.union(()),
        Solid.intersection((box(), box((5, 0, 0)))),
        box().difference((box(),)),
        Solid.from_mesh(np.zeros((0, 3)), np.zeros((0, 3), int)),
    ):
        assert empty.is_empty
        assert empty.volume == 0.0
        assert empty.bounds is None
        assert Solid.union((empty, box())).volume == pytest.approx(1.0)
        built = finished(empty)
        assert (built.triangles, built.pieces, built.volume, built.area) == (0, (), 0.0, 0.0)
        assert built.mesh.vertices.shape == built.shaded.vertices.shape == (0, 3)


def test_an_intersection_of_nothing_is_refused():
    with pytest.raises(InputError, match="at least one"):
        Solid.intersection(())


@pytest.mark.parametrize(
    ("vertices", "faces", "why"),
    [
        (np.where(CORNERS == 1, np.nan, CORNERS), SQUARES, "NaN"),
        (np.where(CORNERS == 1, np.inf, CORNERS), SQUARES, "infinite"),
        (CORNERS, SQUARES[1:], "not closed"),
        (CORNERS, np.concatenate([SQUARES[1:], SQUARES[:1, ::-1]]), "not closed"),
        (CORNERS[:-1], SQUARES, "does not exist"),
    ],
)
def test_faulty_meshes_are_refused_in_one_sentence(vertices, faces, why):
    with pytest.raises(ComputationError, match=why):
        Solid.from_mesh(vertices, faces)


def test_moves():
    turn = rotation_x(0.3) @ rotation_y(-1.1)
    moved = box().transformed(homogeneous(turn, (5.0, 6.0, 7.0)))
    expected = CORNERS @ turn.T + (5.0, 6.0, 7.0)
    np.testing.assert_allclose(moved.bounds, (expected.min(axis=0), expected.max(axis=0)))
    assert moved.volume == pytest.approx(1.0)
    np.testing.assert_allclose(box().transformed(turn).translated((5, 6, 7)).bounds, moved.bounds)


def test_faces_remember_their_surface_through_booleans_and_moves():
    parts = [box().translated((0.3 * n, 0.2 * n, 0.1 * n)) for n in range(3)]
    for solid in (Solid.intersection(parts), Solid.union(parts), parts[0].difference(parts[1:])):
        traced = solid.translated((10, 20, 30)).traced()
        corners = traced.mesh.vertices[traced.mesh.faces]
        assert len(traced.patch_of) == len(corners)
        for patch, triangle in zip(np.array(traced.patch_of), corners, strict=True):
            name, transform = traced.patches[patch].tag, traced.patches[patch].transform
            axis, at = "xyz".index(name[0]), float(name[1])
            np.testing.assert_allclose(triangle[:, axis] - transform[axis, 3], at, atol=1e-12)


# --- finished solids


def test_pieces_are_sorted_and_sum_up():
    built = finished(Solid.union((box(size=(1, 1, 1)), box((5, 0, 0), (2, 1, 1)))))
    assert [p.volume for p in built.pieces] == pytest.approx([2.0, 1.0])
    assert built.pieces[0].centroid == pytest.approx((6.0, 0.5, 0.5))
    assert built.pieces[0].bounds == ((5, 0, 0), (7, 1, 1))
    assert built.volume == pytest.approx(3.0)
    assert built.area == pytest.approx(16.0)


def test_a_void_belongs_to_the_piece_around_it():
    hollow = box(size=(4, 4, 4)).difference((box((0.5, 0.5, 0.5), (3, 3, 3)),))
    inside = box((1.5, 1.5, 1.5))
    beside = box((6, 0, 0), (2, 2, 2))
    built = finished(Solid.union((hollow, inside, beside)))
    assert [p.volume for p in built.pieces] == pytest.approx([64 - 27, 8, 1])
    assert built.pieces[0].centroid == pytest.approx((2, 2, 2))
    assert sum(p.volume for p in built.pieces) == pytest.approx(built.volume)
    assert built.watertight


def test_slivers_are_dropped_and_accounted_for():
    film = box((5, 0, 0), (1, 1, 1e-7))
    built = finished(Solid.union((box(), film)))
    assert len(built.pieces) == 1
    assert built.triangles == 12
    assert 1e-7 <= built.volume_error <= 3e-7
    thick = finished(Solid.union((box(), box((5, 0, 0), (1, 1, 0.1)))), thinnest=0.15)
    assert len(thick.pieces) == 1
    assert thick.volume_error >= 0.1


def test_shading_repeats_vertices_only_at_creases():
    built = finished(box())
    assert built.shaded.vertices.shape == (24, 3)
    assert built.shaded.vertices.dtype == np.float32
    assert built.shaded.faces.dtype == np.uint32
    np.testing.assert_array_equal(
        built.shaded.vertices[built.shaded.faces], built.mesh.vertices[built.mesh.faces]
    )
    smooth = finished(Solid.from_mesh(CORNERS, SQUARES))
    assert smooth.shaded.vertices.shape == (8, 3)


def test_results_are_read_only_also_after_a_pipe():
    built = pickle.loads(pickle.dumps(finished(box())))
    for array in (
        built.mesh.vertices,
        built.mesh.faces,
        built.shaded.vertices,
        built.shaded.faces,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
    assert built.mesh.faces.dtype == np.int32
    assert built.mesh.vertices.dtype == np.float64


# --- files


@pytest.mark.parametrize("kind", KINDS)
def test_files_survive_reloading(kind):
    solid = Solid.union((box((-3, 1, 2), (2, 3, 4)), box((-2, 2, 3), (2, 3, 4))))
    built = finished(solid.transformed(rotation_x(0.4) @ rotation_y(0.3)))
    again = reloaded(encode(built.mesh, kind), kind)
    assert again.is_watertight
    exact = kind != "glb"  # whose millimetres have been single-precision metres
    assert again.volume == pytest.approx(built.volume, rel=1e-9 if exact else 1e-7)
    near = {"rtol": 1e-8} if exact else {"rtol": 1e-6, "atol": 1e-6}
    np.testing.assert_allclose(again.bounds[0], built.mesh.vertices.min(axis=0), **near)
    np.testing.assert_allclose(again.bounds[1], built.mesh.vertices.max(axis=0), **near)


def test_files_state_their_unit():
    mesh = finished(box()).mesh
    assert b"mm" in encode(mesh, "stl")[:80]
    assert b"comment Bohemia, unit mm" in encode(mesh, "ply")
    assert encode(mesh, "obj").startswith(b"# Bohemia, unit mm")
    assert b'"extras":{"unit":"m","up":"y"' in encode(mesh, "glb")
    assert reloaded(encode(mesh, "3mf"), "3mf").units in ("mm", "millimeter")


def test_what_cannot_be_exported_is_refused():
    mesh = finished(box()).mesh
    with pytest.raises(InputError, match="stl"):
        encode(mesh, "step")
    with pytest.raises(InputError, match="empty"):
        encode(finished(Solid.union(())).mesh, "stl")
    with pytest.raises(ComputationError, match="NaN"):
        encode(SolidMesh(mesh.vertices * np.nan, mesh.faces), "stl")
    with pytest.raises(ComputationError, match="not closed"):
        encode(SolidMesh(mesh.vertices, mesh.faces[1:]), "glb")


@pytest.mark.parametrize(
    "places",
    [
        pytest.param(((0, 0, 0), (1, 1, 0)), id="along an edge"),
        pytest.param(((0, 0, 0), (1, 1, 1)), id="in a corner"),
        pytest.param(((0, 0, 0), (1, 1, 0), (0, 1, 1), (1, 0, 1)), id="checkerboard"),
        pytest.param(((400, 0, 0), (401 - 1e-9, 0.5, 0.5)), id="by rounding"),
        pytest.param(((900, 0, 0), (900.5, 0.5, 1 - 2e-6)), id="thinner than float32"),
    ],
)
def test_solids_that_touch_stay_closed_in_a_file_of_positions(places):
    solid = Solid.union(box(place) for place in places)
    built = finished(solid)
    assert built.watertight
    again = reloaded(encode(built.mesh, "stl"), "stl")
    assert again.is_watertight
    assert again.volume == pytest.approx(built.volume, rel=1e-6)
    assert built.volume == pytest.approx(solid.volume, rel=1e-3)


@given(
    st.lists(st.tuples(*[st.integers(0, 3)] * 3), min_size=1, max_size=6),
    st.floats(-3, 3),
    st.sampled_from([1e-3, 1.0, 1e4]),
)
def test_any_heap_of_blocks_makes_a_closed_file(places, angle, scale):
    blocks = Solid.union([box(np.multiply(place, scale), (scale,) * 3) for place in set(places)])
    built = finished(blocks.transformed(rotation_x(angle)))
    assert built.watertight
    assert built.volume == pytest.approx(len(set(places)) * scale**3, rel=1e-3)
    assert sum(p.volume for p in built.pieces) == pytest.approx(built.volume, rel=1e-12)
    # trimesh merges what is nearer than 1e-8, whatever the size.
    if scale >= 1.0:
        assert reloaded(encode(built.mesh, "stl"), "stl").is_watertight
