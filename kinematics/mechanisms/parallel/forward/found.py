"""What each way of solving hands over: complex solutions counted, real ones as placements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.homotopy.tracking import Complex


@dataclass(frozen=True, eq=False, slots=True)
class Assembled:
    """All that is known of the solutions at one vector of joints.

    Attributes:
        placements: (N, 4, 4) of those that seem real, mm.
        multiplicity: (N,).
        roots: (K, M) complex solutions in the way's own unknowns.
        count: finite complex solutions, with their multiplicity.
        expected: how many this machine has at almost all joints.
        complete: they are all.
        method, notes: in words.
        pairs: complex pairs that are nearly real.
        free: (F, 4, 4) of those on curves of solutions, or that may be.
    """

    placements: Array
    multiplicity: NDArray[np.intp]
    roots: Complex
    count: int
    expected: int
    complete: bool
    method: str
    notes: tuple[str, ...] = ()
    pairs: int = 0
    free: Array | None = None
