"""Where the platform can be when the joints are known: all assembly modes."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.solutions import ForwardSolutions, Refreshed
from kinematics.arrays import Array, finite
from kinematics.facets.facet import Facet
from kinematics.homotopy.assembly_sets import positive_lengths
from kinematics.homotopy.assembly_tracking import told_apart
from kinematics.mechanism import D

_CLEAR = 0.35  # of the distance to the next solution: what one may move in a piece
_FINEST = 12  # halvings
_TOGETHER = 0.5  # of the characteristic length: how near solutions are that left together


class ForwardFacet(Facet[D]):
    """Forward kinematics: every solution, with how it is known that they are all.

    Attributes:
        chunk: vectors of joints that are solved at a time.
        noun: what messages call the joints.
        keeps_mode: an assembly mode stays in its mode while the joints move.
    """

    topic = "forward"
    chunk = 512
    noun = "actuator lengths"
    keeps_mode = False

    @overload
    def __call__(  # type: ignore[overload-overlap]  # a list of numbers is one vector
        self, joints: Sequence[float], *, mixed_modes: bool = False
    ) -> ForwardSolutions: ...

    @overload
    def __call__(
        self, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> tuple[ForwardSolutions, ...]: ...

    def __call__(
        self, joints: ArrayLike, *, mixed_modes: bool = False
    ) -> ForwardSolutions | tuple[ForwardSolutions, ...]:
        """The set of solutions for joints (J,), mm or rad; of a batch (N, J) a tuple of N sets.

        No solution, or joints beyond a stroke, are answers like others.

        Args:
            mixed_modes: as if joints that the design says to be merged were not: also solutions
                in modes that it has not.

        Raises:
            InputError: not J finite numbers each; lengths that are not positive.

        Example:
            >>> import kinematics as kin
            >>> solutions = kin.open("five-bar").forward([1.8, 1.3])
            >>> len(solutions), solutions.complete, solutions[0].mode
            (2, True, '+-')
        """
        coordinates = self.mechanism.actuators
        symbols = [c.symbol for c in coordinates]
        if all(c.unit == "mm" and not c.signed for c in coordinates):
            flat = positive_lengths(joints, symbols, self.noun)
        else:
            flat = finite(joints, name="the joints", last=len(symbols)).reshape(-1, len(symbols))
        answers: list[ForwardSolutions] = []
        for part in (flat[n : n + self.chunk] for n in range(0, len(flat), self.chunk)):
            began = perf_counter()
            found = self.solve(part, mixed_modes=mixed_modes)
            seconds = (perf_counter() - began) / len(part)
            answers += [self.finished(one, one.seconds or seconds) for one in found]
        return answers[0] if np.ndim(joints) == 1 else tuple(answers)

    def finished(self, found: ForwardSolutions, seconds: float) -> ForwardSolutions:
        """A set with the names of its coordinates, and how long it took."""
        return replace(found, seconds=seconds, axes=self.mechanism.coordinates)

    @abstractmethod
    def solve(self, joints: Array, *, mixed_modes: bool) -> Sequence[ForwardSolutions]:
        """The sets for at most `chunk` vectors of joints (B, J), which were checked."""

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        """Whether a set takes a few milliseconds at most, so that a page may wait for it."""
        return False

    def distances(
        self, poses: Array, modes: Sequence[str], others: Array, other_modes: Sequence[str]
    ) -> Array:
        """(N, M) mm: √(|ΔO′|² + (L · angle)²) between all poses of two sets, L the characteristic
        length.
        """
        transform = self.mechanism.transform
        return placed_apart(
            transform(poses, modes), transform(others, other_modes), self.mechanism.length
        )

    # --- who is who while the joints move

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        """The set for other joints, whose solutions keep the identities they had ``before``.

        All real solutions are found everywhere on the straight line between the old and the new
        joints, so this is for mechanisms that are quick. The line is halved until the sets at the
        ends of a piece correspond beyond doubt: each solution has moved by much less than it is
        away from any other that it could be taken for.

        Raises:
            InputError: as for the solutions themselves.
        """
        (now,) = self([joints], mixed_modes=before.mixed_modes)
        start, end = np.array(before.joints), np.array(now.joints)
        who = np.arange(len(before))  # of ``before``, each of the present set; −1 of new ones
        last, piece = before.poses.copy(), np.full(len(before), -1)
        pending = [(0.0, 1.0, before, now, 0)]
        done = 0
        while pending:
            low, high, a, b, depth = pending.pop()
            became = self._became(a, b)
            whole = (became >= 0).all() and len(b) == len(a)
            if not whole and depth < _FINEST:
                middle = 0.5 * (low + high)
                (between,) = self([start + middle * (end - start)], mixed_modes=before.mixed_modes)
                pending += [
                    (middle, high, between, b, depth + 1),
                    (low, middle, a, between, depth + 1),
                ]
                continue
            # Pieces are worked off in their order, so ``who`` is of ``a``.
            gone = np.flatnonzero((became < 0) & (who >= 0))
            last[who[gone]], piece[who[gone]], done = a.poses[gone], done, done + 1
            kept = became >= 0
            here = np.full(len(b), -1)
            here[became[kept]] = who[kept]
            who = here
        which = np.full(len(before), -1)
        which[who[who >= 0]] = np.flatnonzero(who >= 0)
        # Two that met left in the same piece.
        apart = self.distances(last, before.modes, last, before.modes)
        meets = piece[:, None] == piece[None, :]
        if self.keeps_mode:
            meets &= np.array(before.modes)[:, None] == np.array(before.modes)[None, :]
        near = _TOGETHER * self.mechanism.length
        side = np.sign(before.determinant)
        return told_apart(before, now, which, last, side, np.where(meets, apart, np.inf), near)

    def _became(self, a: ForwardSolutions, b: ForwardSolutions) -> Array:
        """(len(a),) which solution of ``b`` each of ``a`` is; −1 where that is not beyond doubt."""
        answer = np.full(len(a), -1)
        if not len(a) or not len(b):
            return answer
        apart = self._alike(a, b)
        nearest = apart.argmin(axis=1)
        rows = np.arange(len(a))
        good = apart[rows, nearest] < _CLEAR * np.minimum(self._free(a), self._free(b)[nearest])
        good &= apart[:, nearest].argmin(axis=0) == rows
        answer[good] = nearest[good]
        return answer

    def _alike(self, a: ForwardSolutions, b: ForwardSolutions) -> Array:
        """Distances between two sets; infinite between solutions that are never the same."""
        apart = self.distances(a.poses, a.modes, b.poses, b.modes)
        same = np.sign(a.determinant)[:, None] == np.sign(b.determinant)[None, :]
        if self.keeps_mode:
            same &= np.array(a.modes)[:, None] == np.array(b.modes)[None, :]
        return np.where(same, apart, np.inf)

    def _free(self, found: ForwardSolutions) -> Array:
        """Distance of each solution to the next one it could be taken for, mm."""
        apart = self._alike(found, found)
        np.fill_diagonal(apart, np.inf)
        return np.asarray(apart.min(axis=1))


def placed_apart(a: Array, b: Array, length: float) -> Array:
    """(N, M) mm between platforms placed by (N, 4, 4) and (M, 4, 4), angles times ``length``."""
    shift = np.linalg.norm(a[:, None, :3, 3] - b[None, :, :3, 3], axis=-1)
    # |R1 − R2| = 2 √2 sin(angle/2), which is exact for small angles too.
    turn = np.linalg.norm(a[:, None, :3, :3] - b[None, :, :3, :3], axis=(-1, -2))
    angle = 2.0 * np.arcsin(np.clip(turn / np.sqrt(8.0), 0.0, 1.0))
    return np.asarray(np.hypot(shift, length * angle))


def gaps(apart: Array) -> Array:
    """(N,) distance of each to the nearest other one, from all distances (N, N); inf for none."""
    others = apart + np.diag(np.full(len(apart), np.inf))
    return np.asarray(others.min(axis=1, initial=np.inf))
