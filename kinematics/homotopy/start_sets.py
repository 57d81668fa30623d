"""Machines' own start sets: made once, kept in memory, grown when more solutions turn up.

Following from its own start set, a machine's solutions take a few steps a path. The set is made
from that of the machine's family, on whose way a path may be lost or may seem to run off to
infinity; then solutions are missing at all lengths. That shows as soon as the conjugate of some
solution is not among those found: what turned up is followed back, and the set is whole again.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

import numpy as np

from kinematics.homotopy.solving import Roots, StartSet, distinct
from kinematics.homotopy.tracking import Complex, Index

P = TypeVar("P")

_GROWTHS = 3  # times that a set is looked through for what it lacks


class OwnStartSets(Generic[P]):
    """The start sets of the machines that were solved last."""

    def __init__(self, kept: int) -> None:
        self._kept = kept
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
        forth: Callable[[StartSet[P]], list[Roots]],
        grow: Callable[[StartSet[P], int, Roots], StartSet[P] | None],
    ) -> list[Roots]:
        """All solutions at some targets, from a machine's own set.

        Args:
            key: the machine.
            forth: follows a set to all targets.
            grow: the set with what was found at the n-th target followed back, see `grown`.
        """
        start = self.get(key, make)
        found = forth(start)
        for _ in range(_GROWTHS):
            short = next((n for n, one in enumerate(found) if one.surplus), None)
            larger = None if short is None else grow(start, short, found[short])
            if larger is None:
                break
            start = self.keep(key, larger)
            found = forth(start)
        return found


def made(start: StartSet[P], target: P, found: Roots) -> StartSet[P]:
    """A start set at ``target``, from what was found there along the paths of another one.

    It is whole if those were, or if it has as many solutions as they had: no machine of a family
    has more than almost all of them. What is singular for lengths that nothing is special about
    leads nowhere.
    """
    roots = found.values[:, : found.regular]
    count = roots.shape[1]
    whole = found.complete and found.count == count
    return StartSet(target, roots, whole or (start.complete and count == start.roots.shape[1]))


def grown(
    start: StartSet[P], back: Roots, cluster: Callable[[Complex], Index], most: int
) -> StartSet[P] | None:
    """The set with the solutions ``back`` at its own parameters; None if none of them is new.

    Once it was short, it is whole only with as many as there can be.

    Args:
        most: how many solutions almost every machine of the family has; more are none.
    """
    roots = np.concatenate([start.roots, back.values[:, : back.regular]], axis=1)
    roots = distinct(roots, cluster(roots))
    count = roots.shape[1]
    if not start.roots.shape[1] < count <= most:
        return None
    return StartSet(start.parameters, roots, count == most)
