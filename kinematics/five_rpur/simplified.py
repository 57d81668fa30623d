"""All same-mode solutions of the nine simplified 5-RPURs."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.errors import InputError
from kinematics.five_rpur import stages
from kinematics.five_rpur.arrangements import CLASSES, arrangements
from kinematics.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.five_rpur.equations import (
    Complex,
    Frame,
    parameters,
)
from kinematics.spatial import Array, finite

_CHUNK = 512


@lru_cache(maxsize=64)
def _machine(design):
    found = arrangements(design)
    frame = Frame.of(design)
    return stages.Machine.of(parameters(design, np.zeros(LIMBS), frame), found.groups), frame.unit

def expected(design: FiveRPURDesign) -> int | None:
    """How many same-mode solutions a length vector has; None for a design of no such class."""
    found = arrangements(design)
    known = CLASSES.get(found.name)
    return None if known is None or found.reasons else known.solutions


def same_mode_roots(design: FiveRPURDesign, joints: ArrayLike) -> tuple[Complex, NDArray[np.intp]]:
    machine, unit = _machine(design)
    rho = np.asarray(joints,dtype=float).reshape(-1,LIMBS).T/unit
    rho2 = rho*rho
    found, owner = [], []
    size = max(1, _CHUNK // machine.sextics)
    for k in range(0, rho2.shape[1], size):
        u, o = stages.solve(machine, rho2[:, k:k+size])
        order = np.argsort(o, kind="stable")
        found.append(u[:, order]); owner.append(k + o[order])
    return np.concatenate(found, axis=1), np.concatenate(owner)
