"""All complex solutions at given actuator lengths, by stages or by a homotopy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.homotopy.solving import Roots
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Ties
from kinematics.mechanisms.five_rpur.forward import general, simplified
from kinematics.mechanisms.five_rpur.forward.equations import Complex
from kinematics.mechanisms.five_rpur.forward.families import Family, membership


@dataclass(frozen=True, slots=True)
class Found:
    """What is known of the complex solutions at one length vector."""

    roots: Complex
    multiplicity: NDArray[np.intp]
    count: int
    expected: int | None
    complete: bool
    method: str
    notes: tuple[str, ...]


def by_stages(design: FiveRPURDesign, rho: Array) -> list[Found]:
    roots, owner = simplified.same_mode_roots(design, rho)
    expected = simplified.expected(design)
    name = arrangements(design).name
    bounds = np.searchsorted(owner, np.arange(len(rho) + 1))
    answer = []
    for k, one in enumerate(rho):
        own = roots[:, bounds[k] : bounds[k + 1]]
        count = own.shape[1]
        if count != expected:
            found = by_homotopy(design, one, design.merged_joints)
            short = f"{count} of {expected} solutions were found."
            own_way = Found(own, _once(count), count, expected, False, found.method, (short,))
            # Where the homotopy lost more than the stages did, theirs are what is known.
            answer.append(own_way if found.count < count <= (expected or 0) else found)
            continue
        answer.append(
            Found(
                own,
                _once(count),
                count,
                expected,
                True,
                f"{name} solved in three stages (θ, free limbs, planar sextic)",
                (),
            )
        )
    return answer


def _once(count: int) -> NDArray[np.intp]:
    return np.ones(count, dtype=np.intp)


def by_homotopy(
    design: FiveRPURDesign, rho: Array, tied: Ties, roots: Roots | None = None
) -> Found:
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
    notes = _completeness(found, family, missing)
    if reasons:
        notes = (
            f"{reasons[0]} Solutions in the modes where that holds are not isolated: they lie on "
            "curves and are not among these.",
        )
    return Found(
        found.values,
        found.multiplicity,
        found.count,
        found.expected if tied else family.count,
        found.complete and not reasons,
        method,
        notes,
    )


def _completeness(found: Roots, family: Family, missing: int) -> tuple[str, ...]:
    notes = []
    if missing > 0:
        notes.append(
            f"Of the {family.count} solutions of {family.title}, this design has "
            f"{family.count - missing}: along two ways to it the others ran off to infinity."
        )
    if found.complete and found.infinite:
        notes.append(
            f"{found.infinite} of {found.expected} solutions are at infinity for these lengths."
        )
    return (*notes, *found.doubts)
