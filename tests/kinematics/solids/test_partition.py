"""Solids parted by the zeros of a function: nothing lost, every piece closed."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.errors import InputError
from kinematics.solids.csg import Solid
from kinematics.solids.files import encode
from kinematics.solids.isosurfaces import positive_part
from kinematics.solids.meshes import face_parts
from kinematics.solids.partition import partition

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]


def cube(side: float = 100.0) -> Solid:
    """From the origin."""
    return Solid.from_mesh(side * CORNERS, FACES)


def parted(solid, field, sign=1, count=23, **options):
    axes = [np.linspace(-8.0, 108.0, count + n) for n in range(3)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = field(nodes.reshape(-1, 3))[0].reshape(nodes.shape[:3])
    cutter = positive_part(axes, sign * values, lambda p: tuple(sign * v for v in field(p)))
    return partition(solid, cutter, sign, field, lambda mesh, volume: 0.0, **options)


def ball(center, radius):
    def field(points):
        away = points - center
        return (away**2).sum(axis=1) - radius**2, 2.0 * away

    return field


@pytest.mark.parametrize("sign", [1, -1])
def test_a_plane_cuts_a_cube_exactly(sign: int) -> None:
    normal = np.array([1.0, 2.0, 0.5])

    def plane(points):
        return points @ normal - 120.0, np.tile(normal, (len(points), 1))

    built = parted(cube(), plane, sign)
    below, above = sorted(built.pieces, key=lambda piece: piece.sign)
    # x + 2 y + z / 2 < 120 in the cube: the mean over z of the area below.
    z = np.linspace(0.0, 100.0, 20001)
    c = 120.0 - 0.5 * z
    area = (c**2 - np.maximum(c - 100.0, 0.0) ** 2) / 4.0
    volume = np.trapezoid(area, z)
    assert (below.sign, above.sign) == (-1, 1)
    assert below.volume == pytest.approx(volume, rel=1e-6)
    assert below.volume + above.volume == pytest.approx(1e6, rel=1e-9)
    assert built.volume == pytest.approx(1e6, rel=1e-9)
    assert built.watertight
    assert built.locus_unplaced == 0
    assert built.locus_residual < 1e-9


def test_a_hollow_is_a_piece_and_a_void_of_the_other() -> None:
    field = ball(np.array([50.0, 45.0, 55.0]), 30.0)
    built = parted(cube(), field)
    outer, inner = built.pieces
    assert (outer.sign, inner.sign) == (1, -1)
    assert inner.volume == pytest.approx(4.0 / 3.0 * np.pi * 30.0**3, rel=0.02)
    assert outer.volume + inner.volume == pytest.approx(1e6, rel=1e-9)
    assert built.piece_at((50.0, 45.0, 55.0)) == 1
    assert built.piece_at((50.0, 45.0, 90.0)) == 0
    assert built.piece_at((50.0, 45.0, 101.0)) is None
    assert set(built.piece_of) == {0, 1}
    # The zeros are there once as a surface, and twice in the solid.
    surface = built.locus_mesh()
    assert 2 * len(surface.faces) == built.on_locus.sum()
    away = np.linalg.norm(surface.vertices - (50.0, 45.0, 55.0), axis=1)
    assert np.abs(away - 30.0).max() < 1e-9
    assert face_parts(surface.vertices, surface.faces)[1].sum() / 2 == pytest.approx(
        4.0 * np.pi * 30.0**2, rel=0.02
    )


def test_every_piece_is_a_closed_solid_and_they_add_up() -> None:
    def waves(points):
        x, y, z = (points / 17.0).T
        value = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) - 0.3
        gradient = [
            np.cos(x) * np.cos(y) - np.sin(z) * np.sin(x),
            np.cos(y) * np.cos(z) - np.sin(x) * np.sin(y),
            np.cos(z) * np.cos(x) - np.sin(y) * np.sin(z),
        ]
        return value, np.stack(gradient, axis=-1) / 17.0

    built = parted(cube(), waves, count=40)
    assert built.watertight
    total = 0.0
    for n, piece in enumerate(built.pieces):
        mesh = built.piece_mesh(n)
        solid = Solid.from_mesh(mesh.vertices, mesh.faces)
        assert solid.volume == pytest.approx(piece.volume, rel=1e-9)
        total += solid.volume
    assert total == pytest.approx(1e6, rel=1e-7)
    surface = built.locus_mesh()
    assert built.locus_unplaced < 0.02 * len(surface.vertices)
    value, gradient = waves(surface.vertices)
    residual = np.abs(value) / np.linalg.norm(gradient, axis=1)
    assert (residual > 1e-9).sum() <= built.locus_unplaced
    assert encode(surface, "ply", is_open=True).startswith(b"ply")


def test_scraps_go_to_their_neighbour() -> None:
    def near_the_side(points):
        return points[:, 0] - 0.05, np.tile([1.0, 0.0, 0.0], (len(points), 1))

    whole = parted(cube(), near_the_side, thinnest=0.5)
    assert [piece.sign for piece in whole.pieces] == [1]
    assert whole.volume == pytest.approx(1e6, rel=1e-9)
    assert not whole.on_locus.any()
    thin = parted(cube(), near_the_side, thinnest=0.01)
    assert [piece.sign for piece in thin.pieces] == [1, -1]
    assert thin.pieces[1].volume == pytest.approx(500.0, rel=1e-3)


def test_one_sign_is_one_piece() -> None:
    built = partition(cube(), None, -1, ball(np.zeros(3), 1e3), lambda mesh, volume: 0.0)
    assert [piece.sign for piece in built.pieces] == [-1]
    assert not built.on_locus.any()
    assert not len(built.locus_mesh().faces)
    with pytest.raises(InputError, match="no piece 2 of 1"):
        built.piece_mesh(1)
    assert not partition(
        Solid.union(()), None, 1, ball(np.zeros(3), 1.0), lambda mesh, volume: 0.0
    ).pieces
