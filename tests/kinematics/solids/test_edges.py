"""Crease lines: every sharp edge, no smooth one, and few segments for long curves."""

from __future__ import annotations

import numpy as np

from kinematics.solids.edges import crease_lines


def _cube() -> tuple[np.ndarray, np.ndarray]:
    """A cube of which every face has four vertices of its own."""
    vertices, faces = [], []
    for axis in range(3):
        for side in (0.0, 1.0):
            first = len(vertices)
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = [float(u), float(v)]
                corner.insert(axis, side)
                vertices.append(corner)
            faces += [[first, first + 1, first + 2], [first, first + 2, first + 3]]
    return np.array(vertices, np.float32), np.array(faces, np.uint32)


def _capped_cylinder(sides: int) -> tuple[np.ndarray, np.ndarray]:
    """A cylinder whose cap rims are split, and whose side is smooth."""
    a = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
    top = ring + np.array([0.0, 0.0, 1.0])
    vertices = np.concatenate([ring, top, ring, top, [[0, 0, 0], [0, 0, 1]]])
    n = np.arange(sides)
    m = (n + 1) % sides
    faces = np.concatenate(
        [
            np.stack([n, m, sides + m], axis=1),
            np.stack([n, sides + m, sides + n], axis=1),
            np.stack([2 * sides + m, 2 * sides + n, np.full(sides, 4 * sides)], axis=1),
            np.stack([3 * sides + n, 3 * sides + m, np.full(sides, 4 * sides + 1)], axis=1),
        ]
    )
    return vertices.astype(np.float32), faces.astype(np.uint32)


def test_a_cube_has_its_twelve_edges() -> None:
    lines = crease_lines(*_cube())
    assert lines.shape == (12, 2, 3)
    lengths = np.linalg.norm(lines[:, 0] - lines[:, 1], axis=1)
    assert np.allclose(lengths, 1.0)
    assert len(np.unique(lines.mean(axis=1), axis=0)) == 12


def test_a_cylinder_has_its_two_rims_in_few_segments() -> None:
    lines = crease_lines(*_capped_cylinder(1000))
    assert len(lines) < 240
    for z in (0.0, 1.0):
        rim = lines[np.all(lines[..., 2] == z, axis=1)]
        length = np.linalg.norm(rim[:, 0] - rim[:, 1], axis=1).sum()
        assert np.isclose(length, 2 * np.pi, rtol=5e-3)
        # A closed curve: every point is met twice.
        _, count = np.unique(rim.reshape(-1, 3), axis=0, return_counts=True)
        assert (count == 2).all()
    middles = np.linalg.norm(lines.mean(axis=1)[:, :2], axis=1)
    assert middles.min() > 0.99
    assert not np.any(np.ptp(lines[..., 2], axis=1) > 0)  # the smooth side shows no line


def test_a_smooth_closed_mesh_has_none() -> None:
    vertices = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, -1, -1]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], np.uint32)
    assert len(crease_lines(vertices, faces)) == 0
