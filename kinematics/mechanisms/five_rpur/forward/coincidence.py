"""Solutions of the 5-RPUR that coincide, nearly coincide, or belong to a curve of solutions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import SelfMotion
from kinematics.arrays import Array
from kinematics.facets.following import ClosureFollowing
from kinematics.homotopy.assembly_sets import NEAR
from kinematics.mechanism import mechanism_of
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward.equations import (
    PHI,
    THETA,
    Complex,
    Frame,
    conjugate,
    from_real,
    parameters,
    real_part,
    terms,
    to_poses,
)

REAL = 1e-7
"""Relative distance of a solution from its conjugate below which it is real."""

_FAR = 100.0  # units
_MOST = 24  # singular solutions looked at for a self-motion


def nearly_real(frame: Frame, roots: Complex, length: float) -> NDArray[np.intp]:
    """The complex solutions that are less than NEAR from their conjugates and not real."""
    away = np.abs(roots - conjugate(roots))
    linear, angular = frame.unit * away[:PHI], length * away[PHI : THETA + 1]
    mm2 = (linear**2).sum(axis=0) + (angular**2).sum(axis=0)
    near = np.flatnonzero(mm2 < NEAR * NEAR)
    relative = (away[:, near] / np.maximum(np.abs(roots[:, near]), 1.0)).max(axis=0)
    return np.asarray(near[relative > REAL])


def self_motions(
    design: FiveRPURDesign, rho: Array, frame: Frame, singular: Complex
) -> tuple[SelfMotion, ...]:
    """The motions that stay free with all actuators locked, from the singular solutions (10, n).

    A path that ends on a curve of solutions ends anywhere on it, as a rule not at a real point;
    that is sought next to its real part.

    Returns:
        One motion for each working mode that some were found in.
    """
    # Far out regular solutions look singular; what is nearly real is tried first.
    singular = singular[:, np.abs(singular).max(axis=0, initial=0.0) < _FAR]
    if not singular.shape[1]:
        return ()
    away = np.abs(singular - conjugate(singular)).max(axis=0, initial=0.0)
    values, w = real_part(singular[:, np.argsort(away)[:_MOST]])
    q = terms(parameters(design, rho, frame), from_real(values, w)).q.real
    for first, *others in design.merged_joints:  # but for rounding they are the same
        q[[i - 1 for i in others]] = q[first - 1]
    modes = ["".join("+" if height >= 0.0 else "-" for height in each) for each in q.T]
    following: ClosureFollowing[FiveRPURDesign] = mechanism_of(design).facet("following")
    return following.self_motions(to_poses(frame, values), modes, rho)
