"""The five-bar's parallel singularities as edges of regions: what is drawn, and what is integrated.

Drawn are arcs through three points each. Integrated is by panels of τ, halved until on each the
Legendre series of P has come down to rounding: near a cusp, or where a four-bar nearly lies flat,
P turns fast. Lengths mm.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kinematics.answers.sections import BOUNDS
from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.curve_pieces import Piece
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.plane.arcs import Arcs, Edge

DEVIATION = 1e-6
"""Part of the size by which a drawn arc may leave the true curve."""
TOLERANCE = 1e-13
"""Part of the size that the last terms of a panel's Legendre series may have."""
_ROUNDING = 1e-15  # of the size: by how much points are off at best
_WIDE = 0.4  # rad: a panel's width at first
_HALVINGS = 40
_MOST = 600  # panels of a piece
_NODES = 12
_PARALLEL = BOUNDS.index("parallel")


@lru_cache(maxsize=512)
def curve_edge(design: FiveBarDesign, piece: Piece) -> Edge:
    """A piece of a curve as an edge, whose area error is a bound from the series' last terms."""
    shown, off = _as_arcs(design, piece)
    points, steps, error = _panels(piece, design.size)
    ends, _ = piece.loop.points(piece.tau([0.0, 1.0]))
    return Edge(
        ends[0],
        ends[1],
        shown,
        points,
        steps,
        lambda share: piece.loop.points(piece.tau(share))[0],
        off,
        error,
    )


def _panels(piece: Piece, size: float) -> tuple[Array, Array, float]:
    """Nodes and steps (Q, 2) along a piece, and mm² by which areas that it bounds may be off."""
    nodes, weights, slope, series = _legendre(_NODES)
    turns = weights[:, None] * slope
    count = max(2, int(np.ceil(abs(piece.end - piece.start) / _WIDE)))
    low, width = np.arange(count) / count, np.full(count, 1.0 / count)
    done: list[tuple[Array, Array, Array]] = []
    for k in range(_HALVINGS + 1):
        share = low[:, None] + width[:, None] * (0.5 * (nodes + 1.0))
        points, _ = piece.loop.points(piece.tau(share))  # (panels, nodes, 2)
        last = np.abs((series @ points)[:, -2:]).max(axis=(1, 2))
        good = (last <= TOLERANCE * size) | (k == _HALVINGS) | (count > _MOST)
        done.append((low[good], points[good], last[good]))
        count += len(low) - int(good.sum())
        low, width = low[~good], 0.5 * width[~good]
        if not len(low):
            break
        low, width = np.concatenate([low, low + width]), np.tile(width, 2)
    order = np.argsort(np.concatenate([each[0] for each in done]))
    points = np.concatenate([each[1] for each in done])[order]
    last = np.concatenate([each[2] for each in done])[order]
    steps = turns @ points
    length = np.hypot(steps[..., 0], steps[..., 1]).sum(axis=1)
    error = float((last + _ROUNDING * size) @ length)
    return points.reshape(-1, 2), steps.reshape(-1, 2), error


def _as_arcs(design: FiveBarDesign, piece: Piece) -> tuple[Arcs, float]:
    """Arcs through three points each, and by how much they leave the curve, mm."""
    wanted = DEVIATION * design.size
    share = np.linspace(0.0, 1.0, 9)
    off = np.zeros(1)
    for _ in range(12):
        middle = 0.5 * (share[:-1] + share[1:])
        first, last = (piece.loop.points(piece.tau(s))[0] for s in (share[:-1], share[1:]))
        between = piece.loop.points(piece.tau(middle))[0]
        found = _three_points(first, between, last)
        quarters = [0.5 * (share[:-1] + middle), 0.5 * (middle + share[1:])]
        probes = [piece.loop.points(piece.tau(s))[0] - found.center for s in quarters]
        off = np.max([np.abs(np.hypot(p[:, 0], p[:, 1]) - found.radius) for p in probes], axis=0)
        wide = (off > wanted) | (np.abs(found.sweep) > 2.0)
        if not wide.any():
            break
        share = np.sort(np.concatenate([share, middle[wide]]))
    return found, float(off.max())


def _three_points(a: Array, b: Array, c: Array) -> Arcs:
    """The arcs from a over b to c, each (N, 2); of points in line one of a very large radius."""
    u, v = b - a, c - a
    twice = 2.0 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    length = np.hypot(v[:, 0], v[:, 1])
    least = 1e-12 * length**2
    twice = np.where(np.abs(twice) < least, np.where(twice < 0.0, -least, least), twice)
    uu, vv = (u**2).sum(axis=1), (v**2).sum(axis=1)
    offset = np.stack([v[:, 1] * uu - u[:, 1] * vv, u[:, 0] * vv - v[:, 0] * uu], axis=-1)
    center = a + offset / twice[:, None]
    radius = np.hypot(*(a - center).T)
    start = np.arctan2(a[:, 1] - center[:, 1], a[:, 0] - center[:, 0])
    end = np.arctan2(c[:, 1] - center[:, 1], c[:, 0] - center[:, 0])
    left = twice > 0.0
    sweep = np.where(left, (end - start) % (2 * np.pi), -((start - end) % (2 * np.pi)))
    none = np.zeros(len(a), dtype=int)
    return Arcs(center, radius, start, sweep, none, np.full(len(a), _PARALLEL))


@lru_cache(maxsize=4)
def _legendre(count: int) -> tuple[Array, Array, Array, Array]:
    """Gauss nodes on [−1, 1], weights, and the matrices of the derivatives at the nodes and of the
    coefficients of the Legendre series.
    """
    x, weights = np.polynomial.legendre.leggauss(count)
    apart = x[:, None] - x[None, :] + np.eye(count)
    scale = apart.prod(axis=1)
    slope = scale[:, None] / scale[None, :] / apart
    np.fill_diagonal(slope, 0.0)
    np.fill_diagonal(slope, -slope.sum(axis=1))
    series = np.polynomial.legendre.legvander(x, count - 1).T * weights
    series *= np.arange(count)[:, None] + 0.5
    return x, weights, slope, series
