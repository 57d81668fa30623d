"""Machines that only translate: three spheres, two solutions (trilateration)."""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.forward.found import Assembled

_DEGENERATE = 1e-12  # of the size: centres in a line
_METHOD = "the two points in which three spheres meet"


def solve(machine: Assembly, joints: Array) -> list[Assembled]:
    """For joints (B, 3)."""
    e, length = machine.drives.locked(joints)
    turn = machine.reference[:3, :3]
    centres = e - machine.drives.b @ turn.T
    return [_one(machine, *each) for each in zip(centres, length, strict=True)]


def _one(machine: Assembly, c: Array, length: Array) -> Assembled:
    one, two = c[1] - c[0], c[2] - c[0]
    normal = np.cross(one, two)
    area = float(normal @ normal)
    size = max(float(np.abs(c).max()), float(length.max()))
    if area <= (_DEGENERATE * size * size) ** 2:
        text = "The centres of the three spheres are in a line: no set of solutions is complete."
        nothing = np.zeros((0, 4, 4))
        blank = np.zeros((3, 0), dtype=complex)
        return Assembled(nothing, np.zeros(0, dtype=np.intp), blank, 0, 2, False, _METHOD, (text,))
    right = 0.5 * np.array(
        [
            one @ one + length[0] ** 2 - length[1] ** 2,
            two @ two + length[0] ** 2 - length[2] ** 2,
            0.0,
        ]
    )
    foot = np.linalg.solve(np.stack([one, two, normal]), right)
    square = (length[0] ** 2 - foot @ foot) / area
    touching = abs(square) * area <= 1e-13 * size * size
    height = np.sqrt(complex(0.0 if touching else square))
    roots = np.stack([c[0] + foot + s * height * normal for s in (1.0, -1.0)], axis=1)
    real = square >= 0.0 or touching
    placements = np.tile(machine.reference, (2 if real and not touching else int(real), 1, 1))
    if real:
        placements[:, :3, 3] = roots.real.T[: len(placements)]
    times = np.full(len(placements), 2 if touching else 1, dtype=np.intp)
    return Assembled(placements, times, roots, 2, 2, True, _METHOD)
