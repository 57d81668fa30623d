"""The meshes that the scene makes itself: sticks, cylinders, balls, hulls. Knows no viser."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import ConvexHull

from kinematics.answers.drawings import Body, Drawing
from kinematics.arrays import Array

CELLS = 5  # of the ground's grid, that the base spans at least


def turns_z_to(along: np.ndarray, length: np.ndarray) -> np.ndarray:
    """The shortest rotations that take +z to vectors (N, 3) of these lengths; (N, 4) wxyz."""
    x, y, z = (along / np.maximum(length, 1e-6)[:, None]).T
    w = 1.0 + z
    down = w < 1e-6
    turns = np.stack([w, np.where(down, 1.0, -y), x, np.zeros_like(x)], axis=1)
    turns[down] = (0.0, 1.0, 0.0, 0.0)
    turned: np.ndarray = turns / np.linalg.norm(turns, axis=1, keepdims=True)
    return turned.astype(np.float32)


def cylinder(sides: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed unit cylinder on z from 0 to 1; caps have vertices of their own for crisp edges."""
    a = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(a), np.sin(a)], axis=1)
    low = np.column_stack([ring, np.zeros(sides)])
    high = np.column_stack([ring, np.ones(sides)])
    vertices = np.concatenate([low, high, low, high, [[0, 0, 0], [0, 0, 1]]])
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


def ball(rings: int = 6, sides: int = 12) -> Array:
    """Points (N, 3) of a unit sphere, (rings + 1) × sides of them, from the top down."""
    polar = np.pi * np.arange(rings + 1) / rings
    around = 2 * np.pi * np.arange(sides) / sides
    p, q = np.meshgrid(polar, around, indexing="ij")
    return np.stack([np.sin(p) * np.cos(q), np.sin(p) * np.sin(q), np.cos(p)], axis=-1).reshape(
        -1, 3
    )


def body_mesh(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """The hull of balls about the body's points, turned outwards."""
    points = np.array(body.points, dtype=float)
    cloud = (points[:, None, :] + body.radius * ball()[None]).reshape(-1, 3)
    return _hull(cloud)


def _hull(cloud: Array) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and faces (F, 3) of the hull of points, turned outwards."""
    hull = ConvexHull(cloud)
    corners = cloud[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    used, faces = np.unique(faces, return_inverse=True)
    return cloud[used].astype(np.float32), faces.reshape(-1, 3).astype(np.uint32)


def ground_cell(drawing: Drawing) -> float:
    """The side of a cell of the ground's grid, mm: 1, 2 or 5 times a power of ten, such that 5 to
    15 cells span the machine's base.
    """
    base = next(b for b in drawing.bodies if b.name == "base")
    flat = np.array(base.points)[:, :2]
    most = (float(np.ptp(flat, axis=0).max()) + 2.0 * base.radius) / CELLS
    power = 10.0 ** math.floor(math.log10(most))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= most * (1.0 + 1e-9))


def base_floor(drawing: Drawing) -> float:
    """The height of the base's underside, mm."""
    base = next(b for b in drawing.bodies if b.name == "base")
    return min(p[2] for p in base.points) - base.radius


CYLINDER = cylinder(24)
BALL = _hull(ball(24, 48))
