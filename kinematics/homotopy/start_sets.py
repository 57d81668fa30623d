"""Machines' own start sets: made once, kept in memory, grown when more solutions turn up.

Following from its own start set, a machine's solutions take a few steps a path. The set is made
from that of the machine's family, on whose way a path may be lost or may seem to run off to
infinity; then solutions are missing at all lengths. That shows as soon as the conjugate of some
solution is not among those found: what turned up is followed back, and the set is whole again.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import replace
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from kinematics.errors import ComputationError
from kinematics.homotopy.solving import Closure, Roots, StartSet, cluster, distinct, solve
from kinematics.homotopy.tracking import Complex, Control

P = TypeVar("P")

_GROWTHS = 3  # times that a set is looked through for what it lacks


class OwnStartSets(Generic[P]):
    """The start sets of the machines that were solved last.

    Args:
        closure: their equations.
        kept: how many sets.
        control: with which a set is followed to other joints of its machine.
    """

    def __init__(self, closure: Closure[P], kept: int, control: Control) -> None:
        self._closure, self._kept, self._control = closure, kept, control
        self._sets: OrderedDict[Hashable, StartSet[P]] = OrderedDict()

    def __contains__(self, key: Hashable) -> bool:
        return key in self._sets

    def get(self, key: Hashable, make: Callable[[], StartSet[P]]) -> StartSet[P]:
        """A machine's set, made if it is not there."""
        found = self._sets.get(key)
        return self.keep(key, make() if found is None else found)

    def keep(self, key: Hashable, found: StartSet[P]) -> StartSet[P]:
        """The set, which from now on is the machine's."""
        self._sets[key] = found
        self._sets.move_to_end(key)
        while len(self._sets) > self._kept:
            self._sets.popitem(last=False)
        return found

    def solve(
        self,
        key: Hashable,
        make: Callable[[], StartSet[P]],
        at: Callable[[P], P],
        count: int,
        most: int,
        some: Callable[[Complex], Complex] | None = None,
    ) -> list[Roots]:
        """All solutions at some targets, from a machine's own set.

        Args:
            key: the machine.
            at: the targets, from the parameters of its set.
            count: how many they are.
            most: how many solutions almost every machine of the family has; more are none.
            some: those of the set's solutions that count; None: all.
        """
        start = self.get(key, make)
        found = self._followed(start, at, count, some)
        for _ in range(_GROWTHS):
            short = next((n for n, one in enumerate(found) if one.surplus), None)
            larger = None if short is None else self._grown(start, at, short, found[short], most)
            if larger is None:
                break
            start = self.keep(key, larger)
            found = self._followed(start, at, count, some)
        return found

    def _followed(
        self,
        start: StartSet[P],
        at: Callable[[P], P],
        count: int,
        some: Callable[[Complex], Complex] | None,
    ) -> list[Roots]:
        own = start if some is None else replace(start, roots=some(start.roots))
        target = at(start.parameters)
        return solve(self._closure, own, target, count, real=True, control=self._control)

    def _grown(
        self, start: StartSet[P], at: Callable[[P], P], n: int, found: Roots, most: int
    ) -> StartSet[P] | None:
        """The set with what was found at the n-th target followed back; None if nothing is new.

        Once it was short, it is whole only with as many as there can be.
        """
        closure, known = self._closure, found.values[:, : found.regular]
        there = closure.of(at(start.parameters), np.full(known.shape[1], n))
        (back,) = solve(closure, StartSet(there, known), start.parameters, real=False)
        roots = np.concatenate([start.roots, back.values[:, : back.regular]], axis=1)
        roots = distinct(roots, cluster(closure, roots))
        count = roots.shape[1]
        if not start.roots.shape[1] < count <= most:
            return None
        return StartSet(start.parameters, roots, count == most)


def made(
    closure: Closure[P], start: StartSet[P], target: P, control: Control | None = None
) -> StartSet[P]:
    """A start set at ``target``, along the paths of another one.

    It is whole if those were, or if it has as many solutions as they had: no machine of a family
    has more than almost all of them. What is singular for lengths that nothing is special about
    leads nowhere.
    """
    (found,) = solve(closure, start, target, real=False, control=control)
    roots = found.values[:, : found.regular]
    count = roots.shape[1]
    whole = found.complete and found.count == count
    return StartSet(target, roots, whole or (start.complete and count == start.roots.shape[1]))


def stored(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of a start set's file, made by a mechanism's `forward.monodromy`.

    Raises:
        ComputationError: the file cannot be read.
    """
    try:
        with np.load(path) as file:
            return {key: file[key] for key in file.files}
    except (OSError, ValueError, KeyError) as error:
        raise ComputationError(
            f"the start solutions {path.name} cannot be read ({error}); reinstall Bohemia, or make "
            "them again with 'make start-solutions'"
        ) from None
