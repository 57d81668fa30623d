"""Singular orientations at an altitude: exact curves in the polar chart of tilt and azimuth.

At each tilt P is a polynomial in w = sin 3φ; its roots in [−1, 1] give up to 18 azimuths each. The
range of tilts is parted where a root enters at w = ± 1 and where two merge, all of which are
known as roots of polynomials (`micr`); in between the branches w_j(θ) are regular, so none is
missed and none has to be found on a grid.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from kinematics.answers.loci import LocusCurve, LocusCurves, LocusSpec
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.mechanisms.tripods import polynomial
from kinematics.mechanisms.tripods.design import Kind, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.micr import RING, critical_tilts

ORIENTATION = "orientation"
LOCI = (
    LocusSpec(
        ORIENTATION,
        "Singular orientations at this altitude",
        ("θ", "φ"),
        ("rad", "rad"),
        polar=True,
        figure="Nayak et al. 2017, Fig. 3",
    ),
)
_NODES = 25  # of each branch between two critical tilts
_SLACK = 1e-7  # by which rounding may carry a double root beyond w = ± 1 or into the complex
_NARROW = 1e-6  # rad: critical tilts nearer than that are one, known so well
_JOINED = 4e-6  # rad within which ends of branches are one point
_LONGEST = 0.05  # rad between two points of a curve
_FILLINGS = 8
_HALVINGS = 30
_CROSSING = 1e-5  # rad
_RIM = 181  # points of the constraint circle
_PARTED = 12  # times a piece is parted that should not have to be


class Loci(SingularitiesFacet[TripodDesign]):
    """The chart of orientations at an altitude."""

    loci = LOCI

    def locus(
        self, key: str, pose: Sequence[float], mode: str, at: float | None = None
    ) -> LocusCurves:
        """Actuation singularities at an altitude and the constraint singularity at a tilt of 180°.

        ``barriers`` of a 3-SPR is its ring at 90°, where no position has the altitude.

        Raises:
            InputError: there is no such chart, or the altitude is not finite.
        """
        design, altitude = self.design, float(pose[0])
        if key != ORIENTATION:
            raise InputError(f"there is no chart {key!r}; known is {ORIENTATION}")
        if not np.isfinite(altitude):
            raise InputError("the altitude must be a finite number")
        k = mode_sign(mode) * design.platform_radius / design.base_radius
        z = altitude / design.base_radius
        curves = [
            LocusCurve(points, _residual(design.mechanism, k, z, points))
            for points in singular_curves(design.mechanism, k, z)
        ]
        rim = np.stack([np.full(_RIM, np.pi), np.linspace(-np.pi, np.pi, _RIM)], axis=-1)
        rim[-1] = rim[0]
        return LocusCurves.of(
            [*curves, LocusCurve(rim, np.zeros(_RIM), "constraint")],
            np.array([[0.0, np.pi], [-np.pi, np.pi]]),
            () if design.revolute_on_base else (RING,),
        )


def singular_curves(kind: Kind, k: float, z: float) -> list[Array]:
    """Curves (n, 2) of (θ, φ) with P = 0, for h1 = 1; azimuths run on beyond ± π, but
    a closed curve ends at the very point at which it began."""
    pieces = [piece for branch in branches(kind, k, z) for piece in _azimuths(branch)]
    return _joined(pieces)


class Branch(NamedTuple):
    """A root w(θ) between two critical tilts, (n,) each."""

    tilt: Array
    w: Array


def branches(kind: Kind, k: float, z: float) -> list[Branch]:
    """All roots w ∈ [−1, 1] of P as functions of the tilt, 0 < θ ≤ π, for h1 = 1."""
    cuts = [0.0, *critical_tilts(kind, k, z), np.pi]
    if kind == "three_spr":
        # There two branches cross, or meet in a point: known exactly, and otherwise only roughly.
        cuts = [c for c in cuts if abs(c - RING) > _CROSSING] + [RING]
    cuts = sorted(set(cuts))
    found: list[Branch] = []
    for low, high in pairwise(cuts):
        found += _between(kind, k, z, low, high, _PARTED)
    return found


# --- inside --------------------------------------------------------------------------------


def _between(kind: Kind, k: float, z: float, low: float, high: float, deep: int) -> list[Branch]:
    """Branches between two tilts; where their number changes all the same, the piece is parted."""
    if high - low < _NARROW:
        return []
    turn = np.linspace(0.0, np.pi, _NODES)
    tilt = low + (high - low) * 0.5 * (1.0 - np.cos(turn))  # crowded at the ends: roots like √
    inner = _roots(kind, k, z, tilt[1:-1])
    counts = np.isfinite(inner).sum(axis=-1)
    if (counts != counts[0]).any() and deep:
        at = int((counts != counts[0]).argmax())
        cut = _change(kind, k, z, tilt[at], tilt[at + 1], int(counts[at]))
        return [
            *_between(kind, k, z, low, cut, deep - 1),
            *_between(kind, k, z, cut, high, deep - 1),
        ]
    number = int(counts.min())
    if not number:
        return []
    w = np.sort(inner, axis=-1)[:, :number]  # NaN last
    first, last = (_continued(_at_end(kind, k, z, tilt[m]), w[n]) for m, n in ((0, 0), (-1, -1)))
    whole = np.concatenate([first[None], w, last[None]])
    tilt, whole = _filled(kind, k, z, tilt, whole)
    parted: list[Branch] = []
    for one in whole.T:
        known = np.isfinite(one)
        parted += _without_jumps(kind, k, z, Branch(tilt[known], one[known]))
    return parted


def _without_jumps(kind: Kind, k: float, z: float, branch: Branch) -> list[Branch]:
    """Parted where one root leaves at w = 1 and another enters at w = −1 at the same tilt."""
    step = branch.tilt[1:] * np.abs(np.diff(np.arcsin(branch.w))) / 3.0
    gaps = np.flatnonzero(step > 5.0 * _LONGEST)
    parts: list[Branch] = []
    start_tilt, start_w, last = branch.tilt[:0], branch.w[:0], 0
    for gap in gaps.tolist():
        ends = list(branch.tilt[gap : gap + 2])
        values = list(branch.w[gap : gap + 2])
        for _ in range(_HALVINGS):
            middle = 0.5 * (ends[0] + ends[1])
            roots = _roots(kind, k, z, np.array([middle]), slack=_SLACK)[0]
            roots = roots[np.isfinite(roots)]
            if not len(roots):
                break
            near = [roots[np.abs(roots - value).argmin()] for value in values]
            side = int(abs(near[1] - values[1]) < abs(near[0] - values[0]))
            ends[side], values[side] = middle, float(near[side])
        parts.append(
            Branch(
                np.concatenate([start_tilt, branch.tilt[last : gap + 1], ends[:1]]),
                np.concatenate([start_w, branch.w[last : gap + 1], values[:1]]),
            )
        )
        start_tilt, start_w, last = np.array(ends[1:]), np.array(values[1:]), gap + 1
    parts.append(
        Branch(
            np.concatenate([start_tilt, branch.tilt[last:]]),
            np.concatenate([start_w, branch.w[last:]]),
        )
    )
    return [part for part in parts if len(part.tilt) > 1]


def _change(kind: Kind, k: float, z: float, low: float, high: float, count: int) -> float:
    """Where the number of roots ceases to be ``count``, which it is not at ``high``."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if int(np.isfinite(_roots(kind, k, z, np.array([middle]))).sum()) == count:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _filled(kind: Kind, k: float, z: float, tilt: Array, w: Array) -> tuple[Array, Array]:
    """More nodes where the curves' points would be far apart, up to `_LONGEST` in the chart."""
    for _ in range(_FILLINGS):
        azimuth = np.arcsin(w) / 3.0
        across = tilt[1:, None] * np.abs(np.diff(azimuth, axis=0))
        step = np.hypot(across, np.diff(tilt)[:, None])
        far = np.flatnonzero(np.nanmax(step, axis=1, initial=0.0) > _LONGEST)
        if not len(far):
            break
        middle = 0.5 * (tilt[far] + tilt[far + 1])
        new = np.sort(_roots(kind, k, z, middle), axis=-1)[:, : w.shape[1]]
        good = np.isfinite(new).all(axis=-1) & (middle > tilt[far]) & (middle < tilt[far + 1])
        if not good.any():
            break
        tilt = np.insert(tilt, far[good] + 1, middle[good])
        w = np.insert(w, far[good] + 1, new[good], axis=0)
    return tilt, w


def _roots(kind: Kind, k: float, z: float, tilt: Array, slack: float = 0.0) -> Array:
    """Roots in w (n, 3) in [−1, 1], NaN for others; with ``slack`` also those nearly in it."""
    roots = polynomial.roots_in_w(kind, 1.0, k, z, tilt)
    with np.errstate(invalid="ignore"):
        good = np.abs(roots.imag) <= np.sqrt(slack) if slack else roots.imag == 0.0
        good &= np.abs(roots.real) <= 1.0 + np.sqrt(slack)
    w = np.where(good, np.clip(roots.real, -1.0, 1.0), np.nan)
    if w.shape[-1] < 3:
        w = np.concatenate([w, np.full((*w.shape[:-1], 3 - w.shape[-1]), np.nan)], axis=-1)
    return w


def _at_end(kind: Kind, k: float, z: float, tilt: float) -> Array:
    """The roots in [−1, 1] at a critical tilt, with those that rounding carries out of it."""
    if tilt == np.pi:
        return np.zeros(1)  # c = 0 leaves P = 2 (h1 − k) w Z²
    if kind == "three_spr" and tilt == RING:
        known = np.array([2.0 * z, -z / k])
        return np.asarray(known[np.abs(known) <= 1.0])
    return np.asarray(_roots(kind, k, z, np.array([tilt]), slack=_SLACK)[0])


def _continued(ends: Array, near: Array) -> Array:
    """The root at an end of a piece that each branch leads to; NaN where there is none."""
    known = ends[np.isfinite(ends)]
    if not len(known):
        return np.full(len(near), np.nan)
    apart = np.abs(near[:, None] - known[None, :])
    nearest = apart.argmin(axis=1)
    reached = apart[np.arange(len(near)), nearest] < 0.25
    return np.where(reached, known[nearest], np.nan)


def _azimuths(branch: Branch) -> list[Array]:
    """The six curves (n, 2) that a branch stands for."""
    first = np.arcsin(branch.w)
    found = []
    for angle in (first, np.pi - first):
        for n in range(3):
            azimuth = (angle + 2.0 * np.pi * n) / 3.0
            found.append(np.stack([branch.tilt, azimuth], axis=-1))
    return found


def _joined(pieces: list[Array]) -> list[Array]:
    """Pieces that meet two at a point become one curve; a closed one ends where it begins."""
    ends = np.array([[_flat(piece[0]), _flat(piece[-1])] for piece in pieces]).reshape(-1, 2)
    if not len(ends):
        return []
    apart = np.linalg.norm(ends[:, None] - ends[None], axis=-1)
    near = apart < _JOINED
    partner = {
        n: int(np.flatnonzero(near[n] & (np.arange(len(ends)) != n))[0])
        for n in range(len(ends))
        if near[n].sum() == 2
    }
    left = set(range(len(pieces)))
    curves: list[Array] = []
    # Curves with a free end first, then the closed ones.
    starts = [n for n in range(len(ends)) if n not in partner] + list(range(len(ends)))
    for start in starts:
        if start // 2 not in left:
            continue
        chain: list[Array] = []
        at = start
        while at // 2 in left:
            piece = pieces[at // 2]
            left.discard(at // 2)
            chain.append(piece if at % 2 == 0 else piece[::-1])
            leaving = at ^ 1
            if leaving not in partner:
                break
            at = partner[leaving]
        curve = _chained(chain)
        closed = len(curve) > 2 and np.linalg.norm(_flat(curve[0]) - _flat(curve[-1])) < _JOINED
        if closed:
            curve[-1] = curve[0]
        curves.append(curve)
    return curves


def _chained(chain: list[Array]) -> Array:
    """Pieces one after another, without the points they share and with azimuths that run on."""
    whole = [chain[0]]
    for piece in chain[1:]:
        turns = np.round((whole[-1][-1, 1] - piece[0, 1]) / (2.0 * np.pi)) * 2.0 * np.pi
        whole.append(piece[1:] + np.array([0.0, turns]))
    return np.concatenate(whole)


def _flat(point: Array) -> Array:
    return np.array([point[0] * np.cos(point[1]), point[0] * np.sin(point[1])])


def _residual(kind: Kind, k: float, z: float, points: Array) -> Array:
    """|P| / |∇P| in the polar chart, rad."""
    tilt, azimuth = points[:, 0], points[:, 1]
    w = np.sin(3.0 * azimuth)
    step = 1e-30
    value = polynomial.value(kind, 1.0, k, z, tilt + 1j * step, w)
    a = polynomial.in_w(kind, 1.0, k, z, tilt)
    by_w = a[:, 1] + w * (2.0 * a[:, 2] + 3.0 * w * a[:, 3])
    across = by_w * 3.0 * np.cos(3.0 * azimuth) / np.maximum(tilt, 1e-12)
    slope = np.hypot(value.imag / step, across)
    # Where curves cross both vanish; rounding leaves the second order.
    return np.asarray(np.abs(value.real) / np.maximum(slope, 1e-9 * np.abs(a).sum(axis=-1) + 1e-15))
