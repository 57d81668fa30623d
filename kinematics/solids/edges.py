"""The sharp edges of a shaded mesh as few line segments: what makes a translucent solid readable.

Every segment costs the browser as much as many triangles where there is no GPU, so runs of short
segments that hardly turn are drawn as one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SHARP = np.cos(np.radians(24.0))  # faces that meet at less make no edge
TURN = np.cos(np.radians(7.0))  # a joint of two segments that turns less may be left out
PASSES = 12
ENOUGH = 0.98  # of the edges left by a pass: the next one is not worth its time
MANY = 500  # fewer are drawn as they are


def crease_lines(vertices: NDArray[np.float32], faces: NDArray[np.uint32]) -> NDArray[np.float32]:
    """Line segments (E, 2, 3) along the edges at which a mesh was split for shading and is sharp.

    Args:
        vertices: (V, 3); on a crease each side has vertices of its own.
        faces: (F, 3).
    """
    points, edges = _creases(vertices, faces)
    for seed in range(PASSES if len(edges) > MANY else 0):
        before, edges = len(edges), _straightened(points, edges, seed)
        if len(edges) > ENOUGH * before:
            break
    lines: NDArray[np.float32] = points[edges]
    return lines


def _creases(
    vertices: NDArray[np.float32], faces: NDArray[np.uint32]
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Points without doubles (P, 3), and the edges (E, 2) of one face each where faces meet that
    are turned to each other by more than `SHARP`; an edge that only one has is one, too.
    """
    start = faces.astype(np.int64)
    end = np.roll(start, -1, axis=1)
    edges = np.stack([np.minimum(start, end).ravel(), np.maximum(start, end).ravel()], axis=-1)
    _, first, count = np.unique(
        edges[:, 0] << 32 | edges[:, 1], return_index=True, return_counts=True
    )
    first = first[count == 1]
    edges = edges[first]
    a, b, c = (vertices[faces[first // 3, n]].astype(float) for n in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    used, compact = np.unique(edges, return_inverse=True)
    # Rows as bytes: on the mesh's float32 grid equal points are equal to the bit.
    rows = np.ascontiguousarray(vertices[used]).view("V12").reshape(-1)
    _, where, joined = np.unique(rows, return_index=True, return_inverse=True)
    points = vertices[used[where]]
    both = np.sort(joined.reshape(-1)[compact.reshape(-1, 2)], axis=1)
    real = both[:, 0] != both[:, 1]
    return points, _sharp(both[real], normal[real])


def _sharp(edges: NDArray[np.int64], normal: NDArray[np.float64]) -> NDArray[np.int64]:
    """Each edge (E, 2) once, of those whose faces' normals (E, 3) differ enough."""
    key = edges[:, 0] << 32 | edges[:, 1]
    order = np.argsort(key, kind="stable")
    key, normal = key[order], normal[order]
    flat = (normal == 0.0).all(axis=1)  # slivers are turned to nothing
    turned = np.einsum("ij,ij->i", normal[1:], normal[:-1]) <= SHARP
    smooth = (key[1:] == key[:-1]) & ~(turned & ~flat[1:] & ~flat[:-1])
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    joints = np.concatenate([[0], np.cumsum(smooth)])
    last = first + count - 1
    sharp = joints[last] - joints[first] < np.maximum(count - 1, 1)
    kept: NDArray[np.int64] = edges[order[first[sharp]]]
    return kept


def _straightened(
    points: NDArray[np.float32], edges: NDArray[np.int64], seed: int
) -> NDArray[np.int64]:
    """The edges with some joints left out: no two neighbours in one pass."""
    count = len(points)
    degree = np.bincount(edges.reshape(-1), minlength=count)
    ends = np.concatenate([edges, edges[:, ::-1]])
    order = np.argsort(ends[:, 0], kind="stable")
    start = np.searchsorted(ends[order, 0], np.arange(count))
    joints = np.flatnonzero(degree == 2)
    if not len(joints):
        return edges
    before, after = ends[order[start[joints]], 1], ends[order[start[joints] + 1], 1]
    into, out = points[joints] - points[before], points[after] - points[joints]
    size = np.linalg.norm(into, axis=1) * np.linalg.norm(out, axis=1)
    straight = np.einsum("ij,ij->i", into, out) > TURN * size
    straight &= before != after
    rank = np.full(count, -1.0)
    rank[joints[straight]] = np.random.default_rng(seed).random(int(straight.sum()))
    leave = straight & (rank[joints] > rank[before]) & (rank[joints] > rank[after])
    gone = np.zeros(count, dtype=bool)
    gone[joints[leave]] = True
    kept = edges[~gone[edges].any(axis=1)]
    bridged = np.sort(np.stack([before[leave], after[leave]], axis=1), axis=1)
    return _distinct(np.concatenate([kept, bridged]))


def _distinct(edges: NDArray[np.int64]) -> NDArray[np.int64]:
    _, first = np.unique(edges[:, 0] << 32 | edges[:, 1], return_index=True)
    return edges[first]
