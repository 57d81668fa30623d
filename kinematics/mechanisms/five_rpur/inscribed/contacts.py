"""How far the constant-orientation workspace reaches around a point or a box: exact contacts.

The point of the complement that is nearest to something inside (`region`) lies

- on the tube of one set, at a local minimum, where no other set covers it;
- on the curve in which two tubes meet that replace each other, or at an end of a piece of it;
- on a flat end |y − y_i| = l_i of some limb, which bounds every mode.

Along a tube and along a curve the search is one-dimensional: in a plane y = const the point is
known in closed form. Base frame; lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.inscribed.region import DETAIL, LIMB, ROUNDS, Ints, Region

_SAME = 1e-13  # part of the range of samples by which two of them are one


class Probe(Protocol):
    """A body that is to stay clear of the complement, and how far points are from it."""

    @property
    def tube(self) -> Ints:
        """(K,) indices into `Region.tubes`: the tubes on each of which `foot` seeks a point."""

    def foot(self, which: Ints, axis: tuple[Array, Array, Array]) -> Array:
        """The point (..., 3) of a tube, in the plane of each point of its axis, that the body
        may meet first; NaN where there is none. ``which`` (...,) indices into `tube`.
        """

    def samples(self, beta: Array) -> Array:
        """Angles (K, M) at which to look: evenly spaced ones (K, N), and more where the foot
        turns so fast that those may miss a minimum.
        """

    def measure(self, points: Array) -> Array:
        """Distances of points (..., 3), mm: negative inside the body, inf where NaN."""


@dataclass(frozen=True, eq=False)
class Contacts:
    """Points of the complement that a body meets first, nearest first.

    Attributes:
        value: (N,) mm, by `Probe.measure`.
        point: (N, 3).
        tube: (N,) index into `Region.tubes`, −1 of a curve.
        piece: (N,) index into `Region.curves`, −1 of a tube.
        at: (N,) the parameter, β of a tube, s of a curve.
    """

    value: Array
    point: Array
    tube: Ints
    piece: Ints
    at: Array


def contacts(region: Region, probe: Probe, band: float) -> Contacts:
    """The nearest points on tubes and curves, and local minima up to ``band`` mm farther."""
    sets, _, _ = region.tubes
    kinds = np.arange(len(probe.tube))
    evenly = region.angles[LIMB[sets[probe.tube]]]
    beta = probe.samples(evenly)

    def on_tube(which: Ints, t: Array) -> Array:
        return probe.foot(which, region.axis(sets[probe.tube[which]], t))

    curves = region.curves
    on_curves = probe.measure(curves.points)
    on_tubes = probe.measure(on_tube(kinds[:, None], beta))
    # Between samples the axis of a tube runs no farther than this, and its nearest point with it.
    slack = region.link[LIMB[sets[probe.tube]]] * (evenly[:, 1] - evenly[:, 0])
    limit = float(on_curves.min(initial=np.inf)) + band
    which, sample = _minima(on_tubes - slack[:, None], limit)
    value, at, point = _polished(on_tube, probe, which, beta[which], sample)
    bound = np.flatnonzero(np.isfinite(value))
    bound = bound[region.uncovered(point[bound], 1 << sets[probe.tube[which[bound]]])]
    limit = min(limit, float(value[bound].min(initial=np.inf)) + band)
    piece, sample = _minima(on_curves - curves.gaps[:, None], limit)
    grid = np.broadcast_to(np.linspace(0.0, np.pi, DETAIL), (len(piece), DETAIL))
    value_c, at_c, point_c = _polished(curves.at, probe, piece, grid, sample)

    values = np.concatenate([value[bound], value_c])
    order = np.argsort(values, kind="stable")
    order = order[values[order] <= values.min(initial=np.inf) + band]
    none = np.full(len(piece), -1)
    return Contacts(
        value=values[order],
        point=np.concatenate([point[bound], point_c])[order],
        tube=np.concatenate([probe.tube[which[bound]], none])[order],
        piece=np.concatenate([np.full(len(bound), -1), piece])[order],
        at=np.concatenate([at[bound], at_c])[order],
    )


def _minima(values: Array, limit: float) -> tuple[Ints, Ints]:
    """Rows and columns of local minima along the rows, up to a limit."""
    lowest = values <= limit
    lowest[:, 1:] &= values[:, 1:] <= values[:, :-1]
    lowest[:, :-1] &= values[:, :-1] < values[:, 1:]
    row, column = np.nonzero(lowest)
    return row, column


def _polished(
    curve: Callable[[Ints, Array], Array],
    probe: Probe,
    which: Ints,
    grid: Array,
    sample: Ints,
) -> tuple[Array, Array, Array]:
    """Local minima between the neighbours of samples: values, parameters and points."""
    if not which.size:
        return np.empty(0), np.empty(0), np.empty((0, 3))
    rows = np.arange(len(which))
    # Samples may coincide to a rounding; the neighbours that count are the next distinct ones.
    same = np.maximum(_SAME * np.ptp(grid, axis=1), 1e-15)[:, None]
    ahead = grid - grid[rows, sample][:, None]
    low = np.where(ahead < -same, grid, grid[:, :1]).max(axis=1)
    high = np.where(ahead > same, grid, grid[:, -1:]).min(axis=1)
    value, at, point = grid[rows, sample], grid[rows, sample], np.empty((len(which), 3))
    split = np.linspace(0.0, 1.0, 17)
    for _ in range(ROUNDS):
        t = low[:, None] + (high - low)[:, None] * split
        points = curve(which[:, None], t)
        values = probe.measure(points)
        best = values.argmin(axis=1)
        value, at, point = values[rows, best], t[rows, best], points[rows, best]
        low, high = t[rows, np.maximum(best - 1, 0)], t[rows, np.minimum(best + 1, 16)]
    return value, at, point
