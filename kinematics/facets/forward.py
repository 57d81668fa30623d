"""Where the platform can be when the joints are known: all assembly modes."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any, ClassVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.solutions import ForwardSolutions, Refreshed, SelfMotion
from kinematics.arrays import Array, finite
from kinematics.facets.facet import Facet
from kinematics.facets.following import ClosureFollowing
from kinematics.facets.inverse import SLACK
from kinematics.facets.measures import MeasuresFacet
from kinematics.facets.statics import StaticsFacet
from kinematics.homotopy.assembly_sets import (
    NONE_FOUND,
    NONE_REAL,
    described,
    grouped,
    not_closed,
    positive_lengths,
)
from kinematics.homotopy.assembly_tracking import told_apart
from kinematics.mechanism import D
from kinematics.screws.wrenches import determinant

# Parts of the characteristic length: an end and the solution that it is, and two left at a fold.
_THERE, _TOGETHER = 1e-5, 0.5
_AT_ONCE = 1e-3  # of the way: solutions that end so near in it may have met


@dataclass(frozen=True, eq=False)
class Found:
    """The real solutions at one vector of joints, and what is known of all complex ones.

    Attributes:
        joints: (J,) mm or rad.
        poses, modes, multiplicity: of the N real ones; they may coincide.
        roots: (K, M) every complex solution in the mechanism's own unknowns.
        count: finite complex solutions, with their multiplicity.
        expected: how many almost every machine of the family has.
        complete: they are all.
        method, notes: in words.
        pairs: complex pairs that are nearly real.
        self_motions, mixed_modes: as of `ForwardSolutions`.
        residual: (N,) mm, where more is known of it than the poses tell.
    """

    joints: Array
    poses: Array
    modes: tuple[str, ...]
    multiplicity: NDArray[np.intp]
    roots: NDArray[np.complex128]
    count: int
    expected: int
    complete: bool
    method: str
    notes: tuple[str, ...] = ()
    pairs: int = 0
    self_motions: tuple[SelfMotion, ...] = ()
    mixed_modes: bool = False
    residual: Array | None = None


class ForwardFacet(Facet[D]):
    """Forward kinematics: every solution, with how it is known that they are all.

    Attributes:
        chunk: vectors of joints that are solved at a time.
        noun: what messages call the joints.
    """

    topic = "forward"
    chunk = 512
    noun = "actuator lengths"

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

    # --- what is said of solutions

    double: ClassVar[float] = 0.0
    """Part of the machine and its shortest length: closer solutions are one, seen twice."""
    counted_from: ClassVar[int] = 1
    none_real: ClassVar[str] = NONE_REAL

    @property
    def size(self) -> float:
        """A length of the machine, mm, against which residuals must be small."""
        return float(getattr(self.design, "size", self.mechanism.length))

    def alike(self, modes: Sequence[str]) -> Iterator[tuple[Any, Any]]:
        """Solutions that can be measured together, and their mode as primitives take it."""
        each = np.array(modes)
        for mode in dict.fromkeys(modes):
            yield np.flatnonzero(each == mode), mode

    def held(self, poses: Array, mode: Any) -> tuple[Array, Array]:
        """(N,) condition numbers, and determinants of the wrenches; 0 where there are none."""
        rows = self.other(StaticsFacet).at(poses, mode).rows
        value = np.nan_to_num(determinant(rows, self.mechanism.length))
        return self.other(MeasuresFacet).condition(poses, mode), value

    def answers(self, found: Sequence[Found]) -> list[ForwardSolutions]:
        """Sets with all that is said of their solutions; measured together."""
        mechanism = self.mechanism
        counts = [len(one.poses) for one in found]
        poses = np.concatenate([one.poses for one in found])
        joints = np.repeat(np.array([one.joints for one in found]), counts, axis=0)
        told = np.zeros((4, len(poses)))
        ends = [bound.end in ("min", "max") for bound in mechanism.bounds]
        modes = [mode for one in found for mode in one.modes]
        for some, mode in self.alike(modes):
            p, q = poses[some], joints[some]
            if found[0].residual is None:
                told[0, some] = mechanism.residual(p, mode, q)
            told[1:3, some] = self.held(p, mode)
            told[3, some] = (mechanism.margins(p, mode, q)[..., ends] < -SLACK).any(axis=-1)
        parts = np.split(told, np.cumsum(counts)[:-1], axis=1)
        placed = np.split(mechanism.transform(poses, modes), np.cumsum(counts)[:-1])
        each = zip(found, placed, parts, strict=True)
        return [self._answer(one, there, *part) for one, there, part in each]

    def _answer(
        self,
        one: Found,
        placed: Array,
        residual: Array,
        number: Array,
        value: Array,
        beyond: Array,
    ) -> ForwardSolutions:
        lengths = all(c.unit == "mm" and not c.signed for c in self.mechanism.actuators)
        least = np.abs(one.joints) if lengths else np.array([np.inf])
        poses, modes, weights = one.poses, one.modes, one.multiplicity
        residual = residual if one.residual is None else one.residual
        apart = placed_apart(placed, placed, self.mechanism.length)
        np.fill_diagonal(apart, np.inf)
        # Of solutions that coincide one stays, with their number.
        near = self.double * min(self.mechanism.length, float(least.min()))
        close = np.argwhere(np.triu(apart <= near, 1)) if near > 0.0 else np.empty((0, 2))
        if len(close):
            groups = grouped(len(poses), close)
            firsts = np.unique(groups, return_index=True)[1]
            poses, modes = poses[firsts], tuple(modes[n] for n in firsts)
            residual, number, value, beyond = (v[firsts] for v in (residual, number, value, beyond))
            weights = np.bincount(groups, weights).astype(np.intp)
            apart = apart[np.ix_(firsts, firsts)]
        gap = apart.min(axis=1, initial=np.inf)
        loose = not_closed(residual, self.size, least)
        complete = one.complete and not loose
        notes = (*one.notes, *loose, *described(weights, gap, number, one.pairs))
        if not len(poses):
            notes = (*notes, *filter(None, [self.none_real if complete else NONE_FOUND]))
        return ForwardSolutions(
            joints=tuple(one.joints.tolist()),
            poses=poses,
            modes=modes,
            residual=residual,
            condition=number,
            determinant=value,
            within_stroke=beyond == 0.0,
            multiplicity=weights,
            gap=gap,
            identities=tuple(range(self.counted_from, self.counted_from + len(poses))),
            complex_count=one.count,
            expected_count=one.expected,
            complete=complete,
            method=one.method,
            seconds=0.0,
            notes=(*notes, *(motion.text for motion in one.self_motions)),
            self_motions=one.self_motions,
            roots=one.roots,
            mixed_modes=one.mixed_modes,
        )

    # --- who is who while the joints move

    def refresh(self, before: ForwardSolutions, joints: Sequence[float]) -> Refreshed:
        """The set for other joints, whose solutions keep the identities they had ``before``.

        Every real solution is followed to the new joints by proven steps, beyond strokes too. Where
        it gets there it is the one of the new set that stands there; where it ends at a fold it has
        merged with the one that ends with it.

        Raises:
            InputError: as for the solutions themselves.
        """
        (now,) = self([joints], mixed_modes=before.mixed_modes)
        following: ClosureFollowing[D] = self.mechanism.facet("following")
        ends = [
            following.carried(pose, mode, before.joints, now.joints)
            for pose, mode in zip(before.poses.tolist(), before.modes, strict=True)
        ]
        last = np.array([end.pose for end in ends]).reshape(before.poses.shape)
        parts = np.array([end.fraction for end in ends])
        modes = [end.mode for end in ends]
        length, count = self.mechanism.length, len(ends)
        became = np.full(count, -1)
        if count and len(now):
            apart = self.distances(last, modes, now.poses, now.modes)
            nearest = apart.argmin(axis=1)
            there = (parts == 1.0) & (apart.min(axis=1) <= _THERE * length)
            there &= np.bincount(nearest[there], minlength=len(now))[nearest] <= 1
            became[there] = nearest[there]
        # Two that met ended at the same joints.
        together = np.abs(parts[:, None] - parts) <= _AT_ONCE
        apart = np.where(together, self.distances(last, modes, last, modes), np.inf)
        side = np.sign(before.determinant)
        return told_apart(before, now, became, last, side, apart, _TOGETHER * length)


def placed_apart(a: Array, b: Array, length: float) -> Array:
    """(N, M) mm between platforms placed by (N, 4, 4) and (M, 4, 4), angles times ``length``."""
    shift = np.linalg.norm(a[:, None, :3, 3] - b[None, :, :3, 3], axis=-1)
    # |R1 − R2| = 2 √2 sin(angle/2), which is exact for small angles too.
    turn = np.linalg.norm(a[:, None, :3, :3] - b[None, :, :3, :3], axis=(-1, -2))
    angle = 2.0 * np.arcsin(np.clip(turn / np.sqrt(8.0), 0.0, 1.0))
    return np.asarray(np.hypot(shift, length * angle))
