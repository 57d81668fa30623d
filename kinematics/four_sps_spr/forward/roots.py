"""Every complex solution of the forward displacement of any 4-SPS + 1-SPR.

A design's own start set is all solutions for its geometry and complex lengths, made once by
following the general machine's 40. From there only the lengths move, for many vectors at a time.

That nothing is missing is seen from the count, every path accounted for, and from the set being
closed under complex conjugation, as that of a real machine must be. Paths that are lost, or that
end at one solution together, are followed again with care, and then along another way.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.four_sps_spr.forward.equations import (
    Deformation,
    Parameters,
    conjugate,
    marks,
    parameters,
    polish,
    regularity,
)
from kinematics.four_sps_spr.forward.start_set import StartSet, general_set
from kinematics.spatial import Array
from kinematics.tracking import CAREFUL, Complex, Control, Ending, relative_size, track

SAME = 1e-7
"""Relative distance below which two complex solutions are one."""
SINGULAR = 1e-11
"""Regularity of a solution on a curve of them, but for rounding."""
_REGULAR = 1e-10  # largest last correction of a regular solution, relative
_INFINITE = 1e10  # extent of what is a solution of the equations but no pose
_DOUBTFUL = 1e-3  # regularity at the end of a path above which that is no singular solution
_NEAR = 1e-3  # relative distance of paths that end at one singular solution
_STAYS = 1e-2  # largest way from a path's end to the solution it is taken for, relative
_KEPT = 64  # own start sets in memory
_WAYS = 4
_QUICK = Control(first=0.1)


@dataclass(frozen=True, eq=False, slots=True)
class Roots:
    """All complex solutions at one vector of lengths.

    Attributes:
        values: (8, M) distinct ones, regular first.
        multiplicity: (M,) how many paths end there.
        infinite: paths that run off to infinity.
        lost: paths that could not be followed to their end.
        expected: how many paths there were.
        closed: the conjugate of every regular solution is one.
        whole: nothing is missing in the set that the paths began from.
        regular: how many of the values are regular.
        ways: along how many ways the paths were followed.
    """

    values: Complex
    multiplicity: NDArray[np.intp]
    infinite: int
    lost: int
    expected: int
    closed: bool
    whole: bool
    regular: int
    ways: int

    @property
    def count(self) -> int:
        """Finite solutions with their multiplicity."""
        return int(self.multiplicity.sum())

    @property
    def complete(self) -> bool:
        """Every path is accounted for, and the set is closed under conjugation."""
        accounted = self.lost == 0 and self.count + self.infinite == self.expected
        return accounted and self.closed and self.whole


# --- a design's own start set ---------------------------------------------------------------

_own: OrderedDict[tuple[object, ...], StartSet] = OrderedDict()


def own_start_set(design: FourSPSSPRDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    key = (*((limb.base, limb.platform) for limb in design.limbs), design.revolute_axis)
    found = _own.get(key)
    if found is None:
        found = _own[key] = _make_own(design)
        while len(_own) > _KEPT:
            _own.popitem(last=False)
    _own.move_to_end(key)
    return found


def _make_own(design: FourSPSSPRDesign) -> StartSet:
    """Follow the general set to the design's geometry."""
    target = parameters(design, np.zeros(LIMBS))
    turns = np.exp(1j * np.array([0.9, -1.3, 0.5, 1.7, -0.7]))
    size = 1.0 + float(np.mean((np.asarray(target.base).real ** 2).sum(axis=-1)))
    target = target._replace(squares=size * np.array([1.1, 0.8, 1.3, 0.9, 1.0]) * turns)
    (found,) = _solve(general_set(), target, 1, real=False)
    return StartSet(target, found.values[:, : found.regular], found.complete)


# --- solving --------------------------------------------------------------------------------


def roots_at(design: FourSPSSPRDesign, joints: Array) -> list[Roots]:
    """All complex solutions for each of some vectors of lengths (B, 5), mm."""
    start = own_start_set(design)
    squares = np.asarray(parameters(design, joints).squares, dtype=complex)
    target = start.parameters._replace(squares=squares)
    return _solve(start, target, len(joints), real=True)


def _solve(start: StartSet, target: Parameters, batch: int, *, real: bool) -> list[Roots]:
    """All solutions of each of a batch of targets, which differ in their lengths only."""
    paths = start.roots.shape[1]
    answers: list[Roots | None] = [None] * batch
    left = list(range(batch))
    for n in range(_WAYS):
        squares = np.atleast_2d(target.squares)[left]
        each = target._replace(squares=np.repeat(squares, paths, axis=0))
        way = Deformation(start.parameters, each, _bend(start.parameters, each, n))
        starts = np.tile(start.roots, (1, len(left)))
        ends = track(way, starts, _QUICK)
        values, endings = ends.values.copy(), ends.endings.copy()
        _settle(each, values, endings)
        again = _doubtful(values, endings, paths)
        if again.size:
            ends = track(way.take(again), starts[:, again], CAREFUL)
            values[:, again], endings[again] = ends.values, ends.endings
            _settle(each, values, endings, again)
        for k, one in enumerate(left):
            mine = slice(k * paths, (k + 1) * paths)
            answers[one] = _gathered(
                target._replace(squares=squares[k]),
                values[:, mine],
                endings[mine],
                known=answers[one],
                whole=start.complete,
                real=real,
            )
        left = [one for one in left if _unfinished(answers[one])]
        if not left:
            break
    return [found for found in answers if found is not None]


def _unfinished(found: Roots | None) -> bool:
    return found is None or found.lost > 0


def _bend(start: Parameters, target: Parameters, n: int) -> Complex | None:
    """A way around through other complex lengths; the first is straight."""
    if n == 0:
        return None
    around: Complex = 1j * (0.35, -0.45, 0.8)[n - 1] * (target.squares - start.squares)
    return around


def _settle(
    target: Parameters,
    values: Complex,
    endings: NDArray[np.int8],
    columns: NDArray[np.intp] | None = None,
) -> None:
    """Bring the ends down to rounding: what settles at once is a regular solution, else not."""
    chosen = endings != Ending.LOST
    if columns is not None:
        some = np.zeros_like(chosen)
        some[columns] = True
        chosen &= some
    who = np.flatnonzero(chosen)
    if not who.size:
        return

    def some_of(columns: NDArray[np.intp]) -> Parameters:
        return target._replace(squares=target.squares[columns])

    ends, error = polish(some_of(who), values[:, who])
    slow = np.flatnonzero(~(error <= _rounding(values[:, who])))
    if slow.size:  # near another solution it takes more rounds
        ends[:, slow], error[slow] = polish(some_of(who[slow]), ends[:, slow], rounds=8)
    settled = (error <= _rounding(values[:, who])) & (regularity(some_of(who), ends) > SINGULAR)
    settled &= relative_size(ends - values[:, who], ends) < _STAYS
    far = ~(_extent(ends) < _INFINITE)
    values[:, who[settled]] = ends[:, settled]
    arrived = endings[who] == Ending.REGULAR
    endings[who[settled]] = Ending.REGULAR
    endings[who[arrived & ~settled]] = Ending.SINGULAR
    endings[who[far & settled]] = Ending.INFINITE
    left = who[~settled & (endings[who] == Ending.SINGULAR)]
    gone = ~(_extent(values[:, left]) < _INFINITE)
    endings[left[gone]] = Ending.INFINITE
    left = left[~gone]
    # A path that ends at a singular solution comes where the equations are nearly singular.
    if left.size:
        doubt = regularity(some_of(left), values[:, left]) > _DOUBTFUL
        endings[left[doubt]] = Ending.LOST


def _extent(u: Complex) -> Array:
    norm = np.abs((u[:4] * u[:4]).sum(axis=0))
    size: Array = (np.abs(u) ** 2).sum(axis=0) / np.maximum(norm, 1e-300)
    return size


def _rounding(values: Complex) -> Array:
    """The largest last correction of a regular solution, (n,): larger far out."""
    allowed: Array = _REGULAR * np.maximum(np.abs(values).max(axis=0), 1.0)
    return allowed


def _doubtful(values: Complex, endings: NDArray[np.int8], paths: int) -> NDArray[np.intp]:
    """Paths that were lost, and those that claim the same regular solution of their target."""
    doubt = endings == Ending.LOST
    for first in range(0, len(endings), paths):
        mine = first + np.flatnonzero(endings[first : first + paths] == Ending.REGULAR)
        groups = cluster(values[:, mine])
        if groups.size:
            doubt[mine[np.bincount(groups)[groups] > 1]] = True
    return np.flatnonzero(doubt)


def distances(one: Complex, other: Complex) -> Array:
    """Between the poses of roots (8, n) and (8, m), (n, m): of R and p, relative to max(1, p)."""
    a, b = marks(one), marks(other)
    apart = np.abs(a[:, :, None] - b[:, None, :]).max(axis=0)
    size = np.maximum(np.abs(a).max(axis=0)[:, None], np.abs(b).max(axis=0)[None, :])
    ratio: Array = apart / np.maximum(size, 1.0)
    return np.where(np.isfinite(ratio), ratio, np.inf)


def cluster(values: Complex, distance: float = SAME) -> NDArray[np.intp]:
    """Labels 0 … m − 1 of solutions (8, n): the same for those within a relative distance."""
    count = values.shape[1]
    labels = np.arange(count)
    if count < 2:
        return labels
    near = np.argwhere(np.triu(distances(values, values) <= distance, 1))
    for i, j in near.tolist():
        one, two = labels[i], labels[j]
        labels[labels == max(one, two)] = min(one, two)
    return np.unique(labels, return_inverse=True)[1].astype(np.intp)


def _gathered(
    target: Parameters,
    values: Complex,
    endings: NDArray[np.int8],
    *,
    known: Roots | None,
    whole: bool,
    real: bool,
) -> Roots:
    paths = values.shape[1]
    regular = values[:, endings == Ending.REGULAR]
    if known is not None:
        regular = np.concatenate([known.values[:, : known.regular], regular], axis=1)
    groups = cluster(regular)
    regular = regular[:, np.unique(groups, return_index=True)[1]] if groups.size else regular
    closed = True
    if real:
        regular, closed = _with_conjugates(target, regular)
    singular = _singular_ends(target, values[:, endings == Ending.SINGULAR])
    if singular.size and regular.size:  # what a conjugate brought in already is not there twice
        singular = singular[:, distances(singular, regular).min(axis=1) > SAME]
    groups = cluster(singular, _NEAR)
    firsts = np.unique(groups, return_index=True)[1] if groups.size else groups
    weights = np.bincount(groups) if groups.size else np.zeros(0, dtype=np.intp)
    infinite = int(np.count_nonzero(endings == Ending.INFINITE))
    return Roots(
        values=np.concatenate([regular, singular[:, firsts]], axis=1),
        multiplicity=np.concatenate([np.ones(regular.shape[1], dtype=np.intp), weights]),
        infinite=infinite,
        # Below zero where a path ended beside its solution and a conjugate brought that in.
        lost=max(paths - infinite - regular.shape[1] - singular.shape[1], 0),
        expected=paths,
        closed=closed,
        whole=whole,
        regular=regular.shape[1],
        ways=1 if known is None else known.ways + 1,
    )


def _singular_ends(target: Parameters, values: Complex) -> Complex:
    """Newton's method halves the way to a double solution at every step; some steps are enough."""
    if not values.size:
        return values
    ends, _ = polish(target, values, rounds=24)
    strayed = ~(relative_size(ends - values, values) < _STAYS)
    ends[:, strayed] = values[:, strayed]
    return ends


def _with_conjugates(target: Parameters, regular: Complex) -> tuple[Complex, bool]:
    """The solutions and their conjugates, which a real machine has too, and whether all closed.

    A path that was lost is made good by the one to the conjugate solution.
    """
    if not regular.size:
        return regular, True
    mirrored = conjugate(regular)
    fresh = np.flatnonzero(distances(mirrored, regular).min(axis=1) > SAME)
    if not fresh.size:
        return regular, True
    missing, error = polish(target, mirrored[:, fresh])
    return np.concatenate([regular, missing], axis=1), bool((error <= _rounding(missing)).all())
