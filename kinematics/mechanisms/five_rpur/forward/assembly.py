"""Forward kinematics of the 5-RPUR: all assembly modes for given actuator lengths.

A set has what the inverse kinematics holds: all working modes of the design, which are 32 unless
limbs share a merged U joint. A simplified design whose arrangements are all merged is solved in
closed or univariate form (`forward.simplified`), every other one by a parameter homotopy
(`forward.general`). Both give all complex solutions, polished; only then are the real ones told
from the others.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import ForwardSolutions
from kinematics.arrays import Array, finite
from kinematics.facets.forward import ForwardFacet, Found
from kinematics.facets.statics import StaticsFacet
from kinematics.homotopy.assembly_sets import NONE_REAL, accounted
from kinematics.homotopy.solving import Roots
from kinematics.homotopy.tracking import relative_size
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import LIMBS, MODES, FiveRPURDesign, Ties
from kinematics.mechanisms.five_rpur.forward import general, simplified
from kinematics.mechanisms.five_rpur.forward.coincidence import REAL, nearly_real, self_motions
from kinematics.mechanisms.five_rpur.forward.equations import (
    Complex,
    Frame,
    Parameters,
    conjugate,
    from_real,
    parameters,
    polish,
    real_part,
    steepness,
    terms,
    to_poses,
)
from kinematics.mechanisms.five_rpur.forward.families import membership
from kinematics.screws.wrenches import condition, determinant

_SORTED = 9  # decimals of angles that solutions are sorted by
_NEAR_LENGTHS = 0.1  # of the longest: the largest change over which solutions are tracked on
_REAL_ENOUGH = 1e-12  # relative size of the last correction of a root that is polished
_SINGULAR = 1e-12  # steepness below which a self-motion is looked for
_SIGNS: dict[str, Array] = {mode: np.array(mode.sigma) for mode in MODES}


@dataclass(frozen=True, slots=True)
class _All:
    """What is known of the complex solutions at one length vector, see `Found`."""

    roots: Complex
    multiplicity: NDArray[np.intp]
    count: int
    expected: int
    complete: bool
    method: str
    notes: tuple[str, ...] = ()


class Solving(ForwardFacet[FiveRPURDesign]):
    """All assembly modes for given actuator lengths."""

    chunk = 128  # so that the temporaries stay in the cache
    double = 1e-5

    @property
    def none_real(self) -> str:  # type: ignore[override]
        isolated = "No isolated solution is real."
        return isolated if arrangements(self.design).reasons else NONE_REAL

    def alike(self, modes: Sequence[str]) -> Iterator[tuple[Any, Any]]:
        """All at once: primitives take the signs of each."""
        yield slice(None), np.array([_SIGNS[mode] for mode in modes]).reshape(-1, LIMBS)

    def held(self, poses: Array, mode: Any) -> tuple[Array, Array]:
        """Of wrenches that are worked out once, see `ForwardFacet.held`."""
        wrenches, length = self.other(StaticsFacet).at(poses, mode), self.mechanism.length
        value = np.nan_to_num(determinant(wrenches.rows, length))
        return condition(wrenches, length), value

    def solve(self, joints: Array, *, mixed_modes: bool) -> list[ForwardSolutions]:
        if self.is_quick(mixed_modes=mixed_modes):
            return self.answers(_real(self.design, joints, self._by_stages(joints), mixed_modes))
        return [self._by_paths(one, mixed_modes) for one in joints]

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        """A few milliseconds a vector: all arrangements of a simplified design are merged."""
        tied = set(self._ties(mixed_modes))
        merged = all(group.limbs in tied for group in arrangements(self.design).groups)
        return merged and bool(tied) and simplified.expected(self.design) is not None

    def tracked_on(self, before: ForwardSolutions, joints: Sequence[float]) -> ForwardSolutions:
        """All assembly modes at lengths (5,), mm, tracked from those known if these are near."""
        rho = finite(joints, name="the joints", last=LIMBS).reshape(LIMBS)
        known, mixed = before.roots.shape[1], before.mixed_modes
        near = np.abs(rho - before.joints).max() <= _NEAR_LENGTHS * float(np.abs(rho).max())
        sound = before.complete and known == before.complex_count
        if near and sound and not self.is_quick(mixed_modes=mixed):
            began = perf_counter()
            roots = general.roots_from(self.design, before.roots, before.joints, rho)
            if roots.complete:
                found = self._by_paths(rho, mixed, roots)
                return self.finished(found, perf_counter() - began)
        (now,) = self([rho], mixed_modes=mixed)
        return now

    def _by_paths(
        self, rho: Array, mixed_modes: bool, roots: Roots | None = None
    ) -> ForwardSolutions:
        began = perf_counter()
        found = _by_homotopy(self.design, rho, self._ties(mixed_modes), roots)
        (answer,) = self.answers(_real(self.design, rho[None], [found], mixed_modes))
        return replace(answer, seconds=perf_counter() - began)

    def _by_stages(self, rho: Array) -> list[_All]:
        design = self.design
        roots, owner = simplified.same_mode_roots(design, rho)
        expected = simplified.expected(design) or 0
        method = (
            f"{arrangements(design).name} solved in three stages (θ, free limbs, planar sextic)"
        )
        answer = []
        parted = np.split(roots, np.searchsorted(owner, np.arange(1, len(rho))), axis=1)
        for one, own in zip(rho, parted, strict=True):
            count = own.shape[1]
            found = _All(own, np.ones(count, np.intp), count, expected, count == expected, method)
            if not found.complete:
                # Where the homotopy lost more than the stages did, theirs are what is known.
                short = f"{count} of {expected} solutions were found."
                other = _by_homotopy(design, one, design.merged_joints)
                fewer = other.count < count <= expected
                found = replace(found, method=other.method, notes=(short,)) if fewer else other
            answer.append(found)
        return answer

    def _ties(self, mixed_modes: bool) -> Ties:
        return () if mixed_modes else self.design.merged_joints


def _by_homotopy(
    design: FiveRPURDesign, rho: Array, tied: Ties, roots: Roots | None = None
) -> _All:
    kept = general.has_own_start_set(design)
    family = membership(design).family
    found = general.roots_at(design, rho, tied) if roots is None else roots
    if roots is not None:
        method = f"{found.expected} paths tracked from the last lengths"
    elif kept or tied:
        method = f"{found.expected} paths tracked from the design's own start set"
    else:
        method = f"{family.count} paths tracked from the start set of {family.title}"
    if tied:
        method = f"{method}, merged limbs in one working mode"
    reasons = arrangements(design).reasons
    own = general.own_start_set(design)
    missing = 0 if tied or not own.complete else family.count - own.roots.shape[1]
    notes = accounted(found, family.title, family.count, missing)
    if reasons:
        notes = (
            f"{reasons[0]} Solutions in the modes where that holds are not isolated: they lie on "
            "curves and are not among these.",
        )
    return _All(
        found.values,
        found.multiplicity,
        found.count,
        found.expected if tied else family.count,
        found.complete and not reasons,
        method,
        notes,
    )


def _real(
    design: FiveRPURDesign, rho: Array, found: Sequence[_All], mixed_modes: bool
) -> list[Found]:
    """The real solutions among the roots; one pass for all."""
    frame = Frame.of(design)
    numbers = np.repeat(np.arange(len(rho)), [f.roots.shape[1] for f in found])
    roots = np.concatenate([f.roots for f in found], axis=1)
    real = np.flatnonzero(relative_size(roots - conjugate(roots), roots) <= REAL)
    owner = numbers[real]
    g = parameters(design, rho[owner], frame)
    values, w = _made_real(g, roots[:, real])
    poses = to_poses(frame, values)
    # The working modes are the signs of q_i.
    t = terms(g, from_real(values, w))
    signs = (2 ** np.arange(LIMBS)[::-1]) @ (t.q.real < 0.0)
    off = np.hypot(t.big_p.real, t.p.real) - np.sqrt(g.rho2.real)
    off_link = np.hypot(t.big_y.real, t.q.real) - np.sqrt(g.link2.real)
    residual = frame.unit * np.maximum(np.abs(off), np.abs(off_link)).max(axis=0, initial=0.0)
    # Those of one angle, which rounding must not sort, stand by what comes next.
    phi, theta = np.round(poses[:, 3:], _SORTED).T
    order = np.lexsort((poses[:, 0], phi, theta, owner))
    bounds = np.searchsorted(owner[order], np.arange(len(rho) + 1))
    weights = np.concatenate([f.multiplicity for f in found])[real]
    singular = steepness(parameters(design, rho[numbers], frame), roots) <= _SINGULAR
    pairs = np.bincount(numbers[nearly_real(frame, roots, design.length)], minlength=len(rho)) // 2
    machine = replace(design, merged_joints=()) if mixed_modes else design
    answers = []
    for k, one in enumerate(found):
        mine = order[bounds[k] : bounds[k + 1]]
        answers.append(
            Found(
                joints=rho[k],
                poses=poses[mine],
                modes=tuple(MODES[n] for n in signs[mine]),
                multiplicity=weights[mine],
                roots=one.roots,
                count=one.count,
                expected=one.expected,
                complete=one.complete,
                method=one.method,
                notes=one.notes,
                pairs=int(pairs[k]),
                self_motions=self_motions(
                    machine, rho[k], frame, roots[:, singular & (numbers == k)]
                ),
                mixed_modes=mixed_modes,
                residual=residual[mine],
            )
        )
    return answers


def _made_real(g: Parameters, u: Complex) -> tuple[Array, Array]:
    """The real configurations next to u, polished.

    Arrangements are exact where u was found, and but for rounding in the machine ``g``.
    """
    values, w = real_part(u)
    fine, error = polish(g, from_real(values, w), rounds=2, enough=_REAL_ENOUGH)
    better = error <= _REAL_ENOUGH
    values[:, better], w[:, better] = real_part(fine[:, better])
    return values, w
