"""The geometry that the scene makes itself: turns, bars, hulls, linear colours."""

from __future__ import annotations

import numpy as np
import viser.transforms as tf

from app.scene import palette
from app.scene.shapes import CYLINDER, body_mesh, turns_z_to
from kinematics.answers.drawings import Body


def _volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, n]].astype(float) for n in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def test_turns_take_z_to_any_direction() -> None:
    rng = np.random.default_rng(3)
    along = rng.normal(size=(200, 3))
    along[:4] = [(0, 0, 1), (0, 0, -1), (1e-9, 0, -1), (3, 0, 0)]
    length = np.linalg.norm(along, axis=1)
    turns = turns_z_to(along, length)
    for turn, vector, size in zip(turns, along, length, strict=True):
        turned = tf.SO3(turn.astype(float)).as_matrix()[:, 2]
        assert np.allclose(turned, vector / size, atol=1e-5)


def test_a_bar_that_is_not_there_turns_into_no_nan() -> None:
    assert np.isfinite(turns_z_to(np.zeros((1, 3)), np.zeros(1))).all()


def test_the_unit_cylinder_is_closed_and_looks_outwards() -> None:
    vertices, faces = CYLINDER
    assert np.isclose(_volume(vertices, faces), 12 * np.sin(2 * np.pi / 24), rtol=1e-6)


def test_hulls_look_outwards_even_of_one_point() -> None:
    for points in (((0.0, 0.0, 0.0),), ((0.0, 0.0, 0.0), (50.0, 0.0, 0.0), (0.0, 80.0, 5.0))):
        vertices, faces = body_mesh(Body("b", points, 10.0, "platform", "platform"))
        assert _volume(vertices, faces) > 0.9 * 4 / 3 * np.pi * 1000 * 0.8


def test_linear_colours_keep_black_and_white() -> None:
    assert palette.linear("#000000") == (0, 0, 0)
    assert palette.linear("#FFFFFF") == (255, 255, 255)
    assert all(a < b for a, b in zip(palette.linear("#808080"), (128, 128, 128), strict=True))
