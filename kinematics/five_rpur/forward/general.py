"""Every complex solution of the forward kinematics of any 5-RPUR, by a parameter homotopy.

A design's own start set is all solutions for its geometry and complex actuator lengths. It is
made once, by following the start set of the design's family (`forward.families`).
From there only the lengths have to move, which takes a few steps a path.

That nothing is missing is seen from the count, every path accounted for, and from the set being
closed under complex conjugation, as that of a real machine must be. Paths that are lost, or that
end at one solution together, are followed again with care, then around through other complex
lengths, and the union is taken.
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
from kinematics.tracking import CAREFUL, Control, Ending, Tracked, relative_size, track

SAME = 1e-7
"""Relative distance below which two complex solutions are one."""
_REGULAR = 1e-10  # largest last correction of a regular solution, relative
_SINGULAR = 1e-12  # regularity of a solution on a curve of them, but for rounding
_DOUBTFUL = 1e-3  # regularity at the end of a path above which that is no singular solution
_NEAR = 1e-4  # relative distance of paths that end at one singular solution
_STAYS = 1e-2  # largest way from a path's end to the solution it is taken for, relative
_KEPT = 16  # own start sets in memory
_DETOURS = 4
_ATTEMPTS = 3  # at a start set without gaps
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
        detours: how often some paths had to be followed again.
    """

    values: Complex
    multiplicity: NDArray[np.intp]
    infinite: int
    lost: int
    expected: int
    closed: bool
    whole: bool
    detours: int

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
    machine = parameters(design, np.zeros(LIMBS))
    for n in range(_ATTEMPTS):
        target = machine._replace(rho2=_complex_lengths(machine, n))
        found = _solve(start, target, real=False)
        if found.complete:
            break
    return StartSet(target, found.values[:, found.multiplicity == 1], found.complete)


def _complex_lengths(g: Parameters, n: int) -> Complex:
    """ρ² of a start set: as long as actuators are, and well away from the real ones."""
    turns = np.array([0.9, -1.3, 0.5, 1.7, -0.7])[:, None] * (1.0 - 0.15 * n)
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
    return _solve(start, target, real=True, bend=size * _bend(0), control=_QUICK)


def _moved(own: Parameters, design: FiveRPURDesign, joints: ArrayLike) -> Parameters:
    return own._replace(rho2=parameters(design, joints).rho2.astype(complex))


def _bend(n: int) -> Complex:
    """A way around through complex lengths, another for every n; of size 1."""
    angles = np.array([1.0, 2.1, 1.6, 0.7, 1.9]) + 2.399963 * n * np.arange(1, LIMBS + 1)
    bend: Complex = np.exp(1j * angles)[:, None] * (1.0 + 0.5 * n)
    return bend


def _solve(
    start: StartSet,
    target: Parameters,
    *,
    real: bool,
    bend: Complex | None = None,
    control: Control | None = None,
) -> Roots:
    def followed(columns: NDArray[np.intp], way: Complex | None, how: Control | None) -> Tracked:
        deformation = Deformation(start.parameters, target, _only_lengths(way))
        return track(deformation, start.roots[:, columns], how)

    paths = start.roots.shape[1]
    ends = followed(np.arange(paths), bend, control)
    values, endings = ends.values.copy(), ends.endings.copy()
    _settle(target, values, endings)
    detours = 0
    for n in range(_DETOURS):
        again = _doubtful(values, endings)
        if not again.size:
            break
        detours += 1
        way = bend if n == 0 else _bend(n)
        ends = followed(again, way, CAREFUL)
        values[:, again], endings[again] = ends.values, ends.endings
        _settle(target, values, endings, again)
    return _gathered(target, values, endings, detours=detours, whole=start.complete, real=real)


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
    # Far out, rounding is larger.
    enough = _REGULAR * np.maximum(np.abs(values[:, who]).max(axis=0), 1.0)
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
    detours: int,
    whole: bool,
    real: bool,
) -> Roots:
    paths = values.shape[1]
    regular = values[:, endings == Ending.REGULAR]
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
        detours=detours,
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
    enough = _REGULAR * np.maximum(np.abs(missing).max(axis=0), 1.0)
    return np.concatenate([regular, missing], axis=1), bool((error <= enough).all())
