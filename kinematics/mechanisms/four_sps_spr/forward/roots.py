"""Every complex solution of the forward displacement of any 4-SPS + 1-SPR.

Paths begin from all 40 solutions of one random complex machine, a stored file (see `monodromy`). A
general machine has as many, and so has one whose base and platform points lie in planes; of special
ones, as of two regular pentagons, some are at infinity. A design's own start set is all solutions
for its geometry and complex lengths, made once; from there only the lengths move, for many vectors
at a time. How paths are settled and counted is `kinematics.homotopy.solving`.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from kinematics.arrays import Array
from kinematics.designs.assets import asset_folder
from kinematics.homotopy import solving
from kinematics.homotopy.solving import Roots
from kinematics.homotopy.start_sets import OwnStartSets, made, stored
from kinematics.homotopy.tracking import Control
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.forward import equations
from kinematics.mechanisms.four_sps_spr.forward.equations import Parameters, parameters

GENERAL_COUNT = 40
FILE = "four_sps_spr-general.npz"
_QUICK = Control(first=0.1)

StartSet = solving.StartSet[Parameters]
_own: OwnStartSets[Parameters] = OwnStartSets(equations.CLOSURE, 64, _QUICK)


@cache
def general_set() -> StartSet:
    """The stored set."""
    file = stored(asset_folder("start_solutions") / FILE)
    roots = np.ascontiguousarray(file.pop("roots"), dtype=complex)
    return StartSet(Parameters(**file), roots)


def own_start_set(design: FourSPSSPRDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    return _own.get(_key(design), partial(_make_own, design))


def _key(design: FourSPSSPRDesign) -> tuple[object, ...]:
    return (*((limb.base, limb.platform) for limb in design.limbs), design.revolute_axis)


def _make_own(design: FourSPSSPRDesign) -> StartSet:
    """Follow the general set to the design's geometry."""
    target = parameters(design, np.zeros(LIMBS))
    turns = np.exp(1j * np.array([0.9, -1.3, 0.5, 1.7, -0.7]))
    size = 1.0 + float(np.mean((np.asarray(target.base).real ** 2).sum(axis=-1)))
    target = target._replace(squares=size * np.array([1.1, 0.8, 1.3, 0.9, 1.0]) * turns)
    return made(equations.CLOSURE, general_set(), target, _QUICK)


def roots_at(design: FourSPSSPRDesign, joints: Array) -> list[Roots]:
    """All complex solutions for each of some vectors of lengths (B, 5), mm."""
    squares = np.asarray(parameters(design, joints).squares, dtype=complex)
    return _own.solve(
        _key(design),
        partial(_make_own, design),
        lambda own: own._replace(squares=squares),
        len(squares),
        GENERAL_COUNT,
    )
