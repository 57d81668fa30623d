"""From lengths to a set of assembly modes: what mechanisms share, and what is said of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array, finite
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.homotopy.solving import Roots

NEAR = 1.0
"""mm, angles times the characteristic length: closer solutions are near a fold."""
CLOSES = 1e-7
"""Largest residual of a solution, relative to the machine and to the shortest of its lengths."""
NONE_REAL = "No solution is real: the machine cannot be assembled with these lengths."
NONE_FOUND = "No real solution was found."


def positive_lengths(
    joints: ArrayLike, symbols: Sequence[str], noun: str = "actuator lengths"
) -> Array:
    """Lengths (J,) or (..., J) as (B, J) mm.

    Raises:
        InputError: not as many finite positive lengths as symbols.
    """
    lengths = finite(joints, name="the joints", last=len(symbols)).reshape(-1, len(symbols))
    if (lengths <= 0.0).any():
        row, limb = (int(n) for n in np.argwhere(lengths <= 0.0)[0])
        got = f"{symbols[limb]} = {lengths[row, limb]:g}"
        raise InputError(f"{noun} must be positive (mm), got {got}")
    return lengths


def grouped(count: int, pairs: ArrayLike) -> NDArray[np.intp]:
    """Labels 0 … m − 1 of ``count`` things, the same for those that pairs (N, 2) tie together."""
    labels = np.arange(count)
    for i, j in np.asarray(pairs, dtype=int).reshape(-1, 2).tolist():
        one, two = labels[i], labels[j]
        if one != two:
            labels[labels == max(one, two)] = min(one, two)
    return np.unique(labels, return_inverse=True)[1].astype(np.intp)


def not_closed(residual: Array, size: float, lengths: Array) -> tuple[str, ...]:
    """A sentence where solutions do not satisfy the closure equations as well as they must.

    Args:
        residual: (N,) mm.
        size: of the machine, mm.
        lengths: of the actuators, mm.
    """
    worst = float(residual.max(initial=0.0))
    if worst <= CLOSES * min(size, float(np.abs(lengths).min())):
        return ()
    return (
        f"Solutions are off by up to {worst:.2g} mm, which is not small against the machine or its "
        "lengths: digits are lost, so that some may be wrong or missing.",
    )


def accounted(found: Roots, title: str, count: int, missing: int) -> tuple[str, ...]:
    """A sentence each for solutions that a design has not, or not at these lengths, or that may be
    missing; ``count``: how many the family of that title has.
    """
    notes = []
    if missing > 0:
        notes.append(
            f"Of the {count} solutions of {title} this design has {count - missing}: along two "
            "ways to it the others ran off to infinity."
        )
    if found.complete and found.infinite:
        notes.append(
            f"{found.infinite} of {found.expected} solutions are at infinity for these lengths."
        )
    return (*notes, *found.doubts)


def described(
    multiplicity: NDArray[np.intp], gap: Array, condition: Array, pairs: int
) -> tuple[str, ...]:
    """A sentence each for doubles, near-doubles, pairs that are nearly real, singular ones."""
    notes = []
    for times in np.unique(multiplicity[multiplicity > 1]):
        count = int(np.count_nonzero(multiplicity == times))
        what = "solution counts" if count == 1 else "solutions count"
        notes.append(f"{count} {what} {times}-fold: assembly modes merge there.")
    near = gap[gap < NEAR]
    if near.size:
        notes.append(
            f"{near.size} solutions have another one within {near.max():.2g} mm, as next to a fold."
        )
    if pairs:
        notes.append(
            f"{pairs} complex pair{'s are' if pairs > 1 else ' is'} within {NEAR:g} mm of being "
            "real: assembly modes are about to appear."
        )
    if np.isinf(condition).any():
        notes.append("Some solutions are singular: the platform is not held there.")
    return tuple(notes)
