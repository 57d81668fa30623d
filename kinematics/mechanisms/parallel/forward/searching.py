"""Machines of other limbs: real solutions by Newton's method from many random places.

That none is missing is not known, and is never said.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.forward import placed_apart
from kinematics.homotopy.assembly_sets import grouped
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.closing import newton
from kinematics.mechanisms.parallel.forward.found import Assembled

STARTS = 600
_CLOSES = 1e-9  # of the characteristic length
_SAME = 1e-6
_METHOD = f"Newton's method from {STARTS} random places"
NOTE = (
    "Solutions were searched for, in real numbers: some may be missing, and complex ones are not "
    "counted."
)


def solve(machine: Assembly, joints: Array) -> list[Assembled]:
    """For joints (B, L)."""
    return [_one(machine, q) for q in joints]


def _one(machine: Assembly, joints: Array) -> Assembled:
    rng = np.random.default_rng(11)
    x = rng.normal(size=(STARTS, 4))
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    x[: STARTS // 3] = [1.0, 0.0, 0.0, 0.0] + 0.4 * x[: STARTS // 3]
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    placements = np.tile(machine.reference, (STARTS, 1, 1))
    placements[:, :3, :3] = _turns(x) @ machine.reference[:3, :3]
    reach = max(machine.length, float(np.abs(machine.reference[:3, 3]).max()))
    placements[:, :3, 3] += reach * rng.normal(size=(STARTS, 3))
    signs = rng.choice([-1.0, 1.0], size=(STARTS, len(machine.limbs)))
    found = newton(machine, placements, np.tile(joints, (STARTS, 1)), signs, rounds=60)
    good = np.flatnonzero(found.off < _CLOSES * machine.length)
    there, regular = found.placement[good], found.regular[good]
    apart = placed_apart(there, there, machine.length)
    near = np.argwhere(np.triu(apart < _SAME * machine.length, 1))
    firsts = np.unique(grouped(len(there), near), return_index=True)[1]
    there = there[firsts]
    singular = regular[firsts] < 1e-7
    count = len(there)
    return Assembled(
        there,
        np.ones(count, dtype=np.intp),
        np.zeros((0, 0), dtype=complex),
        count,
        count,
        False,
        _METHOD,
        (NOTE,),
        free=there[singular],
    )


def _turns(x: Array) -> Array:
    """Rotations (N, 3, 3) of unit quaternions (N, 4)."""
    a, b, c, d = x.T
    rows = [
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ]
    return np.moveaxis(np.array(rows), -1, 0)
