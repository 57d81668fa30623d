"""Every complex solution of the forward kinematics of any 5-RPUR, by a parameter homotopy.

A design's own start set is all solutions for its geometry and complex actuator lengths. It is
made once, by following the start set of the design's family (`forward.families`).
From there only the lengths have to move, which takes a few steps a path.

That nothing is missing is seen from the count, every path accounted for, and from the set being
closed under complex conjugation, as that of a real machine must be. Paths that are lost, or that
end at one solution together, are followed again with care; then all take another way, and the
union is taken.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.five_rpur.forward.equations import (
    Complex,
    Deformation,
    Parameters,
    conjugate,
    parameters,
    polish,
    regularity,
    signature,
)
from kinematics.five_rpur.forward.families import StartSet, kept_set, membership, start_set
from kinematics.tracking import CAREFUL, Control, Ending, relative_size, track

SAME = 1e-7
"""Relative distance below which two complex solutions are one."""
_REGULAR = 1e-10  # largest last correction of a regular solution, relative
_SINGULAR = 1e-12  # regularity of a solution on a curve of them, but for rounding
_DOUBTFUL = 1e-3  # regularity at the end of a path above which that is no singular solution
_NEAR = 1e-4  # relative distance of paths that end at one singular solution
_STAYS = 1e-2  # largest way from a path's end to the solution it is taken for, relative
_KEPT = 16  # own start sets in memory
_WAYS = 4
_QUICK = Control(first=0.2)  # from a start set with the same geometry


@dataclass(frozen=True, eq=False, slots=True)
class Roots:
    """All complex solutions at one vector of lengths.

    Attributes:
        values: (10, M) distinct ones, regular first.
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


def own_start_set(design: FiveRPURDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    key = tuple((limb.base, limb.platform, limb.link) for limb in design.limbs)
    found = _own.get(key)
    if found is None:
        found = kept_set(design) or make_own(design)
        _own[key] = found
        while len(_own) > _KEPT:
            _own.popitem(last=False)
    _own.move_to_end(key)
    return found


def has_own_start_set(design: FiveRPURDesign) -> bool:
    """The design's own start set is at hand, so that solving it takes a tenth of a second."""
    key = tuple((limb.base, limb.platform, limb.link) for limb in design.limbs)
    return key in _own or kept_set(design) is not None


def make_own(design: FiveRPURDesign) -> StartSet:
    """Follow the family's start set to the design's geometry."""
    start = start_set(membership(design))
    target = parameters(design, np.zeros(LIMBS))
    target = target._replace(rho2=_complex_lengths(target))
    found = _solve(start, target, real=False)
    return StartSet(target, found.values[:, : found.regular], found.complete)


def _complex_lengths(g: Parameters) -> Complex:
    """ρ² of a start set: as long as actuators are, and well away from the real ones."""
    turns = np.array([0.9, -1.3, 0.5, 1.7, -0.7])[:, None]
    size = 1.0 + float(np.mean(np.abs(g.rx) ** 2 + np.abs(g.rz) ** 2))
    sizes = size * np.array([1.1, 0.8, 1.3, 0.9, 1.0])[:, None]
    lengths: Complex = (sizes * np.exp(1j * turns)).astype(complex)
    return lengths


# --- solving --------------------------------------------------------------------------------


def roots_at(design: FiveRPURDesign, joints: ArrayLike) -> Roots:
    """All complex solutions for actuator lengths (5,), mm."""
    start = own_start_set(design)
    return _solve(start, _moved(start.parameters, design, joints), real=True, control=_QUICK)


def roots_from(
    design: FiveRPURDesign, known: Complex, before: ArrayLike, joints: ArrayLike
) -> Roots:
    """The same from all solutions ``known`` at the lengths ``before``: quicker if they are near.

    The way leads around through complex lengths, as real solutions merge on a straight one.
    """
    own = own_start_set(design).parameters
    start = StartSet(_moved(own, design, before), known)
    target = _moved(own, design, joints)
    size = float(np.abs(target.rho2 - start.parameters.rho2).max())
    return _solve(start, target, real=True, bend=size * _BEND, control=_QUICK)


def _moved(own: Parameters, design: FiveRPURDesign, joints: ArrayLike) -> Parameters:
    return own._replace(rho2=parameters(design, joints).rho2.astype(complex))


_BEND: Complex = np.exp(1j * np.array([1.0, 2.1, 1.6, 0.7, 1.9]))[:, None]


def _solve(
    start: StartSet,
    target: Parameters,
    *,
    real: bool,
    bend: Complex | None = None,
    control: Control | None = None,
) -> Roots:
    """All solutions of the target, along as many ways as it takes to find them.

    Paths that are doubtful at the end of a way are followed again with care. Where that does not
    help, all paths take another way, which leads every one of them elsewhere, and what is new
    joins what was found before.
    """
    found: Roots | None = None
    for n in range(_WAYS):
        around = _only_lengths(bend) if n == 0 else _around(start.parameters, target, n)
        way = Deformation(start.parameters, target, around)
        ends = track(way, start.roots, control)
        values, endings = ends.values.copy(), ends.endings.copy()
        _settle(target, values, endings)
        again = _doubtful(values, endings)
        if again.size:
            ends = track(way.take(again), start.roots[:, again], CAREFUL)
            values[:, again], endings[again] = ends.values, ends.endings
            _settle(target, values, endings, again)
        found = _gathered(target, values, endings, known=found, whole=start.complete, real=real)
        if found.lost == 0:
            break
    assert found is not None
    return found


def _around(start: Parameters, target: Parameters, n: int) -> Parameters:
    """A way around through complex t, which stays within the family."""
    turn = 1j * (0.35, -0.45, 0.8)[n - 1]
    return Parameters(
        *(
            np.zeros((1, 1)) if a is b else np.asarray(turn * (b - a), dtype=complex)
            for a, b in zip(start, target, strict=True)
        )
    )


def _only_lengths(bend: Complex | None) -> Parameters | None:
    if bend is None:
        return None
    nothing = np.zeros((1, 1))
    return Parameters(*(nothing,) * 7, rho2=bend)


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
    ends, error = polish(target, values[:, who])
    enough = _rounding(values[:, who])
    slow = np.flatnonzero(~(error <= enough))  # near another solution it takes more rounds
    if slow.size:
        ends[:, slow], error[slow] = polish(target, ends[:, slow], rounds=8)
    settled = (error <= enough) & (regularity(target, ends) > _SINGULAR)
    settled &= relative_size(ends - values[:, who], ends) < _STAYS
    values[:, who[settled]] = ends[:, settled]
    arrived = endings[who] == Ending.REGULAR
    endings[who[settled]] = Ending.REGULAR
    endings[who[arrived & ~settled]] = Ending.SINGULAR
    # A path that ends at a singular solution comes where the equations are nearly singular.
    left = who[~settled & (endings[who] == Ending.SINGULAR)]
    endings[left[regularity(target.take(left), values[:, left]) > _DOUBTFUL]] = Ending.LOST


def _rounding(values: Complex) -> NDArray[np.float64]:
    """The largest last correction of a regular solution, (n,): larger far out."""
    allowed: NDArray[np.float64] = _REGULAR * np.maximum(np.abs(values).max(axis=0), 1.0)
    return allowed


def _doubtful(values: Complex, endings: NDArray[np.int8]) -> NDArray[np.intp]:
    """Paths that were lost, and those that claim the same regular solution."""
    regular = np.flatnonzero(endings == Ending.REGULAR)
    groups = cluster(values[:, regular])
    crowded = regular[np.bincount(groups)[groups] > 1] if regular.size else regular
    return np.sort(np.concatenate([np.flatnonzero(endings == Ending.LOST), crowded]))


def cluster(values: Complex, distance: float = SAME) -> NDArray[np.intp]:
    """Labels 0 … m − 1 of solutions (10, n): the same for those within a relative distance."""
    count = values.shape[1]
    labels = np.arange(count)
    if count < 2:
        return labels
    marks = signature(values)
    order = np.argsort(marks.real)
    sorted_marks, ordered = marks[order], values[:, order]
    scale = distance * (1.0 + np.abs(sorted_marks))
    for k in range(1, count):  # ends at once unless many share a real part
        near = sorted_marks[k:].real - sorted_marks[:-k].real <= 16.0 * scale[k:]
        if not near.any():
            break
        left = np.flatnonzero(near)
        away = relative_size(ordered[:, left] - ordered[:, left + k], ordered[:, left])
        for i in left[away <= distance]:
            one, two = labels[order[i]], labels[order[i + k]]
            if one != two:
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
    # What a conjugate brought in already is not there twice.
    marks = cluster(np.concatenate([regular, singular], axis=1))
    singular = singular[:, ~np.isin(marks[regular.shape[1] :], marks[: regular.shape[1]])]
    groups = cluster(singular, _NEAR)
    firsts = np.unique(groups, return_index=True)[1] if groups.size else groups
    found = np.concatenate([regular, singular[:, firsts]], axis=1)
    weights = np.bincount(groups) if groups.size else np.zeros(0, dtype=np.intp)
    infinite = int(np.count_nonzero(endings == Ending.INFINITE))
    return Roots(
        values=found,
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
    mirrored = conjugate(regular)
    groups = cluster(np.concatenate([regular, mirrored], axis=1))
    count = regular.shape[1]
    known = np.zeros(int(groups.max(initial=-1)) + 1, dtype=bool)
    known[groups[:count]] = True
    fresh = np.flatnonzero(~known[groups[count:]])
    if not fresh.size:
        return regular, True
    missing, error = polish(target, mirrored[:, fresh])
    return np.concatenate([regular, missing], axis=1), bool((error <= _rounding(missing)).all())
