"""Paths in pose space, apart from the time: points by the share s of the way, 0 to 1.

Poses mix mm and rad; a path's ``scale`` says what each coordinate counts for in its length. All
paths are frozen and hashable.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.trajectories import Derivatives, Path
from kinematics.arrays import Array, finite
from kinematics.errors import InputError

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Pose = tuple[float, ...]
MOST_POINTS = 100_000
SAME = 1e-9  # mm: points that are nearer to each other are one


@dataclass(frozen=True)
class Line:
    """The straight way from one pose to another."""

    start: Pose
    end: Pose
    scale: Pose

    @property
    def length(self) -> float:
        """mm, see `Path`."""
        return float(np.linalg.norm(_scaled(self.scale, self.start, self.end)))

    @property
    def knots(self) -> Array:
        """See `Path`: none."""
        return np.empty(0)

    def at(self, share: ArrayLike) -> Derivatives:
        """See `Path`."""
        s = np.asarray(share, dtype=float)[:, None]
        start, end = np.array(self.start), np.array(self.end)
        slope = np.broadcast_to(end - start, (len(s), len(start)))
        return start + s * (end - start), slope, np.zeros_like(slope)


@dataclass(frozen=True)
class Polyline:
    """Straight ways between points, with rounded corners.

    A corner is a parabola from ``blend`` mm before the point to as much behind it, or to the middle
    of a shorter side; along it the velocity turns evenly, which is what s is measured by: the
    velocity is continuous, the acceleration finite. With a blend of 0 corners are sharp.
    """

    points: tuple[Pose, ...]
    scale: Pose
    blend: float

    @property
    def length(self) -> float:
        """mm, see `Path`; a corner counts as its two tangents."""
        return float(_polyline(self).ends[-1])

    @property
    def knots(self) -> Array:
        """See `Path`: where a straight part or a rounded corner ends."""
        ends = _polyline(self).ends
        return np.asarray(ends[:-1] / ends[-1])

    def at(self, share: ArrayLike) -> Derivatives:
        """See `Path`."""
        s = np.asarray(share, dtype=float)
        parts = _polyline(self)
        total = parts.ends[-1]
        at = s * total
        which = np.clip(np.searchsorted(parts.ends, at), 0, len(parts.ends) - 1)
        a, b, c = (each[which] for each in parts.shapes)
        u = (at - parts.starts[which])[:, None]
        return (
            a + u * (b + u * c),
            total * (b + 2.0 * u * c),
            total**2 * 2.0 * c,
        )


@dataclass(frozen=True)
class Spline:
    """The natural cubic spline through points, which are at given shares of the way.

    Where a point follows itself the way rests there: the parts before and after it end and begin
    with no speed. With ``corners`` the points are joined by straight ways.
    """

    points: tuple[Pose, ...]
    shares: tuple[float, ...]
    scale: Pose
    corners: bool = False

    @property
    def length(self) -> float:
        """mm, see `Path`."""
        return _length(self, self.shares)

    @property
    def knots(self) -> Array:
        """See `Path`: the points; the third derivative leaps there."""
        return np.array(self.shares[1:-1])

    def at(self, share: ArrayLike) -> Derivatives:
        """See `Path`."""
        spline = _cubic(self)
        s = np.asarray(share, dtype=float)
        return spline(s), spline(s, 1), spline(s, 2)


@dataclass(frozen=True)
class Drawn:
    """A curve drawn by hand, smoothed: it passes its points within about ``smooth`` mm."""

    points: tuple[Pose, ...]
    scale: Pose
    smooth: float
    closed: bool

    @property
    def length(self) -> float:
        """mm, see `Path`."""
        return _length(self, np.linspace(0.0, 1.0, len(self.points)))

    @property
    def knots(self) -> Array:
        """See `Path`: the spline's."""
        (knots, _, _), _ = _smoothed(self)
        inner = np.unique(knots)
        return inner[(inner > 0.0) & (inner < 1.0)]

    def at(self, share: ArrayLike) -> Derivatives:
        """See `Path`."""
        from scipy.interpolate import splev

        spline, scale = _smoothed(self)
        s = np.asarray(share, dtype=float)
        found = [np.stack(splev(s, spline, der=n), axis=-1) / scale for n in range(3)]
        return found[0], found[1], found[2]


# --- making them ---------------------------------------------------------------------------


def line(start: Sequence[float], end: Sequence[float], scale: Sequence[float]) -> Line:
    """A checked straight line.

    Raises:
        InputError: the poses are no numbers or the same.
    """
    a, b = _checked([start, end], scale, repeated=True)
    if np.linalg.norm(_scaled(tuple(scale), a, b)) < SAME:
        raise InputError("the start and the end of the line are one pose; choose another end")
    return Line(a, b, tuple(scale))


def polyline(points: ArrayLike, scale: Sequence[float], blend: float = 0.0) -> Path:
    """Through points (N, P) with corners rounded from ``blend`` mm on; of two points a line.

    Raises:
        InputError: less than two points, one that is no number, or one that follows itself.
    """
    if not 0.0 <= blend < np.inf:
        raise InputError(f"a blend must be a length of 0 mm or more, got {blend:g}")
    checked = _checked(points, scale)
    if len(checked) == 2:
        return Line(checked[0], checked[1], tuple(scale))
    return Polyline(checked, tuple(scale), float(blend))


def spline(
    points: ArrayLike,
    scale: Sequence[float],
    shares: ArrayLike | None = None,
    *,
    corners: bool = False,
) -> Path:
    """A smooth path through points (N, P), or with corners straight ways; of two points a line.

    Args:
        shares: (N,) where on the way they are, increasing; None: by the lengths of their chords. A
            point that follows itself at a later share is a rest.

    Raises:
        InputError: as of `polyline`, or shares that do not increase.
    """
    repeated = shares is not None
    checked = _checked(points, scale, repeated=repeated)
    if shares is None:
        chords = np.linalg.norm(np.diff(np.array(checked) * np.array(scale), axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(chords)])
    else:
        along = finite(shares, name="the times", last=len(checked))
        if (np.diff(along) <= 0.0).any():
            n = int(np.argmax(np.diff(along) <= 0.0)) + 2
            raise InputError(f"the times must increase; point {n} is not later than the one before")
    along = (along - along[0]) / (along[-1] - along[0])
    if len(checked) == 2:
        return Line(checked[0], checked[1], tuple(scale))
    return Spline(checked, tuple(along.tolist()), tuple(scale), corners)


def drawn(points: ArrayLike, scale: Sequence[float], smooth: float = 1.0) -> Path:
    """A hand-drawn curve (N, P), smoothed; closed where it ends where it began.

    Points that are nearer to the one before than a tenth of ``smooth`` mm are left out.

    Raises:
        InputError: less than two different points, or one that is no number.
    """
    p = finite(points, name="the points", last=len(scale))
    weights = np.array(scale)
    kept = [0]
    for n in range(1, len(p)):
        if np.linalg.norm((p[n] - p[kept[-1]]) * weights) > max(0.1 * smooth, 1e-9):
            kept.append(n)
    if len(kept) < 2:
        raise InputError("a drawn path needs at least two different points")
    if len(kept) == 2:
        return Line(_pose(p[0]), _pose(p[kept[-1]]), tuple(scale))
    p = p[kept]
    reach = float(np.linalg.norm((p - p[0]) * weights, axis=1).max())
    ends = float(np.linalg.norm((p[-1] - p[0]) * weights))
    closed = len(p) > 4 and ends < max(smooth, 0.02 * reach)
    if closed:
        p[-1] = p[0]
    return Drawn(tuple(map(_pose, p)), tuple(scale), float(smooth), closed)


# --- inside --------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, slots=True)
class _Parts:
    """Of a polyline: each from a start to an end (K,) mm, a + u b + u² c with u from the start."""

    starts: Array
    ends: Array
    shapes: tuple[Array, Array, Array]  # (K, P) each


@lru_cache(maxsize=64)
def _polyline(path: Polyline) -> _Parts:
    points = np.array(path.points)
    lengths = np.linalg.norm(np.diff(points * np.array(path.scale), axis=0), axis=1)
    units = np.diff(points, axis=0) / lengths[:, None]
    halves = 0.5 * lengths
    blends = [min(path.blend, a, b) for a, b in pairwise(halves.tolist())]
    before = [0.0, *blends]
    after = [*blends, 0.0]
    ends: list[float] = []
    shapes: list[tuple[Array, Array, Array]] = []
    at = 0.0
    zero = np.zeros(points.shape[1])
    for n, length in enumerate(lengths.tolist()):
        straight = length - before[n] - after[n]
        if straight > 1e-12 * length:
            first = points[n] + before[n] * units[n]
            shapes.append((first, units[n], zero))
            at += straight
            ends.append(at)
        if n < len(blends) and after[n] > 0.0:
            half = after[n]
            first = points[n + 1] - half * units[n]
            bend = (units[n + 1] - units[n]) / (4.0 * half)
            shapes.append((first, units[n], bend))
            at += 2.0 * half
            ends.append(at)
    a, b, c = (np.array(each) for each in zip(*shapes, strict=True))
    return _Parts(np.array([0.0, *ends[:-1]]), np.array(ends), (a, b, c))


@lru_cache(maxsize=64)
def _cubic(path: Spline) -> PPoly:
    """The pieces between the points, from rest to rest."""
    from scipy.interpolate import CubicSpline, PPoly

    shares, points = np.array(path.shares), np.array(path.points)
    rests = np.linalg.norm(np.diff(points * np.array(path.scale), axis=0), axis=1) < SAME
    # Where a part of its own begins; the last one ends with the last point.
    starts = [n for n in range(len(rests)) if path.corners or n == 0 or rests[n] or rests[n - 1]]
    parts = []
    for first, last in pairwise([*starts, len(rests)]):
        if last - first == 1 and (path.corners or rests[first]):
            slope = np.diff(points[first : last + 1], axis=0) / np.diff(shares[first : last + 1])
            zero = np.zeros_like(slope)
            parts.append(np.stack([zero, zero, zero if rests[first] else slope, points[[first]]]))
            continue
        natural, still = (2, np.zeros(points.shape[1])), (1, np.zeros(points.shape[1]))
        ends = (still if first else natural, still if last < len(rests) else natural)
        here = slice(first, last + 1)
        parts.append(CubicSpline(shares[here], points[here], bc_type=ends).c)
    return PPoly(np.concatenate(parts, axis=1), shares)


@lru_cache(maxsize=64)
def _smoothed(path: Drawn) -> tuple[tuple[Array, list[Array], int], Array]:
    from scipy.interpolate import splprep

    scale = np.array(path.scale)
    p = np.array(path.points) * scale
    degree = min(5, len(p) - 1)
    weights = np.ones(len(p))
    if not path.closed:
        weights[[0, -1]] = 1e3  # the ends stay where they were drawn
    found, _ = splprep(p.T, w=weights, k=degree, s=len(p) * path.smooth**2, per=int(path.closed))
    return found, scale


def _length(path: Spline | Drawn, marks: ArrayLike) -> float:
    """∫ |dP| by Gauss's rule between each two marks."""
    at = np.asarray(marks, dtype=float)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = 0.5 * np.diff(at)[:, None]
    share = 0.5 * (at[:-1] + at[1:])[:, None] + half * nodes
    _, slope, _ = path.at(share.ravel())
    speed = np.linalg.norm(slope * np.array(path.scale), axis=1)
    return float(speed @ (half * weights).ravel())


def _scaled(scale: Pose, start: Pose, end: Pose) -> Array:
    return np.asarray((np.array(end) - np.array(start)) * np.array(scale))


def _checked(
    points: ArrayLike, scale: Sequence[float], *, repeated: bool = False
) -> tuple[Pose, ...]:
    p = finite(points, name="the points", last=len(scale))
    if p.ndim != 2 or len(p) < 2:
        raise InputError("a path needs at least two points")
    if len(p) > MOST_POINTS:
        raise InputError(f"a path may have {MOST_POINTS} points, got {len(p)}")
    steps = np.linalg.norm(np.diff(p * np.array(scale), axis=0), axis=1)
    if not repeated and (steps < SAME).any():
        n = int(np.argmax(steps < SAME)) + 2
        raise InputError(f"point {n} of the path is the same as the one before; leave it out")
    return tuple(map(_pose, p))


def _pose(values: Array) -> Pose:
    return tuple(float(v) for v in values)
