"""Following assembly modes of the 4-SPS + 1-SPR: its closure equations as quadrics.

Unknowns are p and the entries of R, row by row.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.following import ClosureFollowing
from kinematics.facets.inverse import posture
from kinematics.homotopy.quadrics import Quadrics, dot, image, square, unknowns
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.states import State, placed, pose_of

_COUNT = 12


class Following(ClosureFollowing[FourSPSSPRDesign]):
    """Of the two triples of angles of an orientation the one nearer to those before is told."""

    def closure(self, mode: str) -> Quadrics:
        return _closure(self.design)

    def unknowns(self, pose: Sequence[float], mode: str) -> Array:
        return unknowns_of(self.design, placed(pose))

    def posture(self, unknowns: Array, joints: Array, pose: Sequence[float], mode: str) -> Posture:
        state = state_of(self.design, unknowns)
        return posture(self.design, pose_of(state, pose), known=joints)


def unknowns_of(design: FourSPSSPRDesign, state: State) -> Array:
    """(12,) of a state."""
    return np.concatenate([state.p / design.length, state.r.ravel()])


def state_of(design: FourSPSSPRDesign, unknowns: Array) -> State:
    """The state of (12,)."""
    return State(unknowns[3:].reshape(3, 3), design.length * unknowns[:3])


@lru_cache(maxsize=64)
def _closure(design: FourSPSSPRDesign) -> Quadrics:
    base, platform = design.base / design.length, design.platform / design.length
    p, turn, lengths = np.split(np.array(unknowns(_COUNT + LIMBS)), [3, _COUNT])
    r = turn.reshape(3, 3)
    equations = []
    for a, b, length in zip(base, platform, lengths, strict=True):
        leg = [q + s - c for q, s, c in zip(p, image(r, b), a, strict=True)]
        equations.append(0.5 * (dot(leg, leg) - square(length)))
    to_base = [c - q for c, q in zip(base[SPR].tolist(), p, strict=True)]
    equations.append(dot(to_base, image(r, design.axis)) - design.offset / design.length)
    for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)):
        equations.append((0.5 if i == j else 1.0) * (dot(r[:, i], r[:, j]) - float(i == j)))
    return Quadrics.of(equations)
