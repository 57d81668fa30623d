"""All solutions of a machine's equations at once, followed from those of another machine.

A mechanism hands in its equations (`Closure`) and a start set, all solutions at some parameters;
paths lead from there to one target or to many. That nothing is missing is seen from the count,
every path accounted for, and from the set being closed under complex conjugation, as that of a real
machine must be. Paths that are lost, or that end at one solution together, are followed again with
care; then all take another way, and the union is taken. Paths that run off to infinity are
believed only where a second way, which leads elsewhere, gives the same solutions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from kinematics.homotopy.assembly_sets import grouped
from kinematics.homotopy.tracking import (
    CAREFUL,
    Complex,
    Control,
    Ending,
    Homotopy,
    Index,
    Real,
    relative_size,
    track,
)

P = TypeVar("P")

SAME = 1e-7
"""Relative distance below which two complex solutions are one."""
AROUND = (0.35, -0.45, 0.8)
"""How far later ways lead around through complex parameters, relative to the straight one."""
_REGULAR = 1e-10  # largest last correction of a regular solution, relative
_DOUBTFUL = 1e-3  # regularity at the end of a path above which that is no singular solution
_STAYS = 1e-2  # largest way from a path's end to the solution it is taken for, relative


@dataclass(frozen=True, eq=False)
class StartSet(Generic[P]):
    """All ``roots`` (K, M) of one machine with complex ``parameters``.

    ``complete`` is false where paths to it were lost, so that some may be missing.
    """

    parameters: P
    roots: Complex
    complete: bool = True


@dataclass(frozen=True, eq=False, slots=True)
class Roots:
    """All complex solutions at one target.

    Attributes:
        values: (K, M) distinct ones, regular first.
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
    def settled(self) -> bool:
        """Every path is accounted for, along two ways where some run off to infinity."""
        accounted = self.lost == 0 and self.count + self.infinite == self.expected
        return accounted and (self.infinite == 0 or self.ways > 1)

    @property
    def surplus(self) -> bool:
        """More solutions turned up than paths began: the start set was short."""
        return self.count + self.infinite > self.expected

    @property
    def complete(self) -> bool:
        """Every path is accounted for, and the set is closed under conjugation."""
        return self.settled and self.closed and self.whole

    @property
    def doubts(self) -> tuple[str, ...]:
        """A sentence for the user where solutions may be missing; none where all is accounted."""
        if self.lost:
            return (f"{self.lost} paths could not be followed: solutions may be missing.",)
        if not self.whole:
            return ("The start set of this design has gaps: solutions may be missing.",)
        if not self.closed:
            return ("A solution lacks its complex conjugate: solutions may be missing.",)
        if not self.complete:
            led = f"{self.expected} paths led to {self.count} solutions"
            return (f"{led}: some may be missing.",)
        return ()


class Closure(Protocol[P]):
    """The closure equations of a kind of mechanism over the complex numbers, as a module has them.

    P are the parameters of a machine with given joints, of one or of several targets.
    """

    @property
    def SINGULAR(self) -> float:
        """Regularity of a solution on a curve of them, but for rounding."""
        ...

    @property
    def NEAR(self) -> float:
        """Relative distance of paths that end at one singular solution."""
        ...

    def of(self, g: P, columns: Index) -> P:
        """Parameters for n points, ``columns`` (n,) the target of each."""
        ...

    def between(self, start: P, end: P, around: float = 0.0) -> Homotopy:
        """From one machine to another, t going as t + i t (1 − t) ``around``."""
        ...

    def polish(self, g: P, u: Complex, rounds: int = 3) -> tuple[Complex, Real]:
        """Newton's method: the points, and their last correction (n,), relative."""
        ...

    def regularity(self, g: P, u: Complex) -> Real:
        """How far the equations are from singular, (n,), 0 … 1."""
        ...

    def conjugate(self, u: Complex) -> Complex:
        """The conjugate solutions."""
        ...

    def marks(self, u: Complex) -> tuple[Complex, Real]:
        """What tells poses apart, (L, n), and how much less two of one agree far out, (n,) ≥ 1."""
        ...

    def infinite(self, values: Complex, goals: Complex) -> NDArray[np.bool_]:
        """Which points solve the equations but are no pose, (n,).

        Args:
            values: as they were tracked; far out where a curve of solutions is at infinity.
            goals: where Newton's method leads from there.
        """
        ...


def solve(
    closure: Closure[P],
    start: StartSet[P],
    target: P,
    count: int = 1,
    *,
    real: bool,
    around: float = 0.0,
    control: Control | None = None,
) -> list[Roots]:
    """All solutions of each of ``count`` targets, along as many ways as it takes to find them.

    Paths that are doubtful at the end of a way are followed again with care. Where that does not
    help, and where some run off to infinity, all paths take another way, which leads every one of
    them elsewhere, and what is new joins what was found before.

    Args:
        start: from which every target is followed; where something is missing in it, no other way
            makes the answers complete.
        real: the targets are real machines, whose solutions come with their conjugates.
        around: how far the first way leads around through complex parameters.
    """
    equations = _Targets(closure, target)
    starts, whole = start.roots, start.complete
    paths = starts.shape[1]
    answers: list[Roots | None] = [None] * count
    left = np.arange(count)
    for leads in (around, *AROUND) if whole else (around,):
        of, begun = np.repeat(left, paths), np.tile(starts, (1, len(left)))
        way = closure.between(start.parameters, closure.of(target, of), leads)
        ends = track(way, begun, control)
        values, endings = ends.values.copy(), ends.endings.copy()
        _settle(equations, values, endings, of)
        again = _doubtful(equations, values, endings, paths)
        if again.size:
            ends = track(way.take(again), begun[:, again], CAREFUL)
            values[:, again], endings[again] = ends.values, ends.endings
            _settle(equations, values, endings, of, again)
        for k, one in enumerate(left.tolist()):
            mine = slice(k * paths, (k + 1) * paths)
            answers[one] = _gathered(
                equations,
                values[:, mine],
                endings[mine],
                one,
                known=answers[one],
                whole=whole,
                real=real,
            )
        left = np.array([k for k in left.tolist() if _unfinished(answers[k])], dtype=np.intp)
        if not left.size:
            break
    return [found for found in answers if found is not None]


def cluster(closure: Closure[P], values: Complex, distance: float = SAME) -> Index:
    """Labels 0 … m − 1 of solutions (K, n): the same for those within a relative distance."""
    count = values.shape[1]
    if count < 2:
        return np.arange(count)
    marks, loose = closure.marks(values)
    # Summed by hand: a product of matrices would wake other cores.
    key = (marks.real * np.cos(1.9 * np.arange(len(marks)) + 0.4)[:, None]).sum(axis=0)
    order = np.argsort(key)
    key, marks = key[order], marks[:, order]
    near = distance * loose[order]
    reach = 2.0 * len(marks) * near * np.maximum(np.abs(marks).max(axis=0), 1.0)
    pairs = [np.zeros((0, 2), dtype=np.intp)]
    for k in range(1, count):  # ends at once unless many share a key
        left = np.flatnonzero(key[k:] - key[:-k] <= reach[k:])
        if not left.size:
            break
        away = relative_size(marks[:, left] - marks[:, left + k], marks[:, left])
        one = left[away <= near[left]]
        pairs.append(np.stack([order[one], order[one + k]], axis=1))
    return grouped(count, np.concatenate(pairs))


def among(closure: Closure[P], values: Complex, known: Complex) -> NDArray[np.bool_]:
    """Which of the values (K, n) are one of those known, to within `SAME`."""
    labels = cluster(closure, np.concatenate([known, values], axis=1))
    count = known.shape[1]
    return np.isin(labels[count:], labels[:count])


# --- inside --------------------------------------------------------------------------------


class _Targets(Generic[P]):
    """The equations of some targets, ``of`` (n,) which of them each column is of."""

    def __init__(self, closure: Closure[P], target: P) -> None:
        self.closure, self._target = closure, target

    def polish(self, values: Complex, of: Index, rounds: int = 3) -> tuple[Complex, Real]:
        return self.closure.polish(self.closure.of(self._target, of), values, rounds)

    def regularity(self, values: Complex, of: Index) -> Real:
        return self.closure.regularity(self.closure.of(self._target, of), values)


def _unfinished(found: Roots | None) -> bool:
    # More solutions than paths there are along every way.
    return found is None or not (found.settled or found.count > found.expected)


def _settle(
    equations: _Targets[P],
    values: Complex,
    endings: NDArray[np.int8],
    of: Index,
    columns: Index | None = None,
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
    ends, error = equations.polish(values[:, who], of[who])
    enough = _rounding(values[:, who])
    slow = np.flatnonzero(~(error <= enough))  # near another solution it takes more rounds
    if slow.size:
        ends[:, slow], error[slow] = equations.polish(ends[:, slow], of[who[slow]], rounds=8)
    settled = (error <= enough) & (equations.regularity(ends, of[who]) > equations.closure.SINGULAR)
    settled &= relative_size(ends - values[:, who], ends) < _STAYS
    far = equations.closure.infinite(ends, ends)
    values[:, who[settled]] = ends[:, settled]
    arrived = endings[who] == Ending.REGULAR
    endings[who[settled]] = Ending.REGULAR
    endings[who[arrived & ~settled]] = Ending.SINGULAR
    endings[who[far & settled]] = Ending.INFINITE
    where = np.flatnonzero(~settled & (endings[who] == Ending.SINGULAR))
    left, goals = who[where], ends[:, where]
    gone = equations.closure.infinite(values[:, left], goals)
    endings[left[gone]] = Ending.INFINITE
    left = left[~gone]
    # A path that ends at a singular solution comes where the equations are nearly singular.
    if left.size:
        doubt = equations.regularity(values[:, left], of[left]) > _DOUBTFUL
        endings[left[doubt]] = Ending.LOST


def _rounding(values: Complex) -> Real:
    """The largest last correction of a regular solution, (n,): larger far out."""
    return np.asarray(_REGULAR * np.maximum(np.abs(values).max(axis=0), 1.0))


def _doubtful(
    equations: _Targets[P], values: Complex, endings: NDArray[np.int8], paths: int
) -> Index:
    """Paths that were lost, and those that claim the same regular solution of their target."""
    doubt = endings == Ending.LOST
    for first in range(0, len(endings), max(paths, 1)):
        mine = first + np.flatnonzero(endings[first : first + paths] == Ending.REGULAR)
        groups = cluster(equations.closure, values[:, mine], SAME)
        if groups.size:
            doubt[mine[np.bincount(groups)[groups] > 1]] = True
    return np.flatnonzero(doubt)


def _gathered(
    equations: _Targets[P],
    values: Complex,
    endings: NDArray[np.int8],
    target: int,
    *,
    known: Roots | None,
    whole: bool,
    real: bool,
) -> Roots:
    paths = values.shape[1]
    regular = values[:, endings == Ending.REGULAR]
    if known is not None:
        regular = np.concatenate([known.values[:, : known.regular], regular], axis=1)
    regular = distinct(regular, cluster(equations.closure, regular, SAME))
    closed = True
    if real:
        regular, closed = _with_conjugates(equations, regular, target)
    singular = _singular_ends(equations, values[:, endings == Ending.SINGULAR], target)
    # What a conjugate brought in already is not there twice.
    singular = singular[:, ~among(equations.closure, singular, regular)]
    groups = cluster(equations.closure, singular, equations.closure.NEAR)
    weights = np.bincount(groups) if groups.size else np.zeros(0, dtype=np.intp)
    infinite = int(np.count_nonzero(endings == Ending.INFINITE))
    return Roots(
        values=np.concatenate([regular, distinct(singular, groups)], axis=1),
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


def distinct(values: Complex, groups: Index) -> Complex:
    """The first of the values (K, n) of each group, by labels (n,)."""
    return values[:, np.unique(groups, return_index=True)[1]] if groups.size else values


def _singular_ends(equations: _Targets[P], values: Complex, target: int) -> Complex:
    """Newton's method halves the way to a double solution at every step; some steps are enough."""
    if not values.size:
        return values
    ends, _ = equations.polish(values, np.full(values.shape[1], target), rounds=24)
    strayed = ~(relative_size(ends - values, values) < _STAYS)
    ends[:, strayed] = values[:, strayed]
    return ends


def _with_conjugates(equations: _Targets[P], regular: Complex, target: int) -> tuple[Complex, bool]:
    """The solutions and their conjugates, which a real machine has too, and whether all closed.

    A path that was lost is made good by the one to the conjugate solution.
    """
    mirrored = equations.closure.conjugate(regular)
    fresh = np.flatnonzero(~among(equations.closure, mirrored, regular))
    if not fresh.size:
        return regular, True
    missing, error = equations.polish(mirrored[:, fresh], np.full(len(fresh), target))
    return np.concatenate([regular, missing], axis=1), bool((error <= _rounding(missing)).all())
