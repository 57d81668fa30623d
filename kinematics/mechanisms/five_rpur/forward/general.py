"""Every complex solution of the forward kinematics of any 5-RPUR, by a parameter homotopy.

A design's own start set is all solutions for its geometry and complex actuator lengths. It is
made once, by following the start set of the design's family (`forward.families`).
From there only the lengths have to move, which takes a few steps a path. How paths are settled
and counted is `kinematics.homotopy.solving`.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from kinematics.homotopy.solving import AROUND, Roots, solve
from kinematics.homotopy.start_sets import OwnStartSets, made
from kinematics.homotopy.tracking import Control
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign, Ties
from kinematics.mechanisms.five_rpur.forward import equations
from kinematics.mechanisms.five_rpur.forward.equations import Complex, Parameters, W, parameters
from kinematics.mechanisms.five_rpur.forward.families import (
    StartSet,
    exact,
    kept_set,
    membership,
    start_set,
)

_QUICK = Control(first=0.2)  # from a start set with the same geometry
_TIED = 1e-6  # relative difference of w of limbs whose U joints are one

_own: OwnStartSets[Parameters] = OwnStartSets(equations, 16, _QUICK)


# --- a design's own start set ---------------------------------------------------------------


def own_start_set(design: FiveRPURDesign) -> StartSet:
    """All solutions for a design's geometry at complex lengths; kept for the next call."""
    return _own.get(_key(design), partial(_kept_or_made, design))


def has_own_start_set(design: FiveRPURDesign) -> bool:
    """The design's own start set is at hand, so that solving it takes a tenth of a second."""
    return _key(design) in _own or kept_set(design) is not None


def _key(design: FiveRPURDesign) -> tuple[object, ...]:
    return tuple((limb.base, limb.platform, limb.link) for limb in design.limbs)


def _kept_or_made(design: FiveRPURDesign) -> StartSet:
    return kept_set(design) or make_own(design)


def make_own(design: FiveRPURDesign) -> StartSet:
    """Follow the family's start set to the design's geometry."""
    member = membership(design)
    start, target = start_set(member), exact(parameters(design, np.zeros(LIMBS)), member)
    return made(equations, start, target._replace(rho2=_complex_lengths(target)))


def _complex_lengths(g: Parameters) -> Complex:
    """ρ² of a start set: as long as actuators are, and well away from the real ones."""
    turns = np.array([0.9, -1.3, 0.5, 1.7, -0.7])[:, None]
    size = 1.0 + float(np.mean(np.abs(g.rx) ** 2 + np.abs(g.rz) ** 2))
    sizes = size * np.array([1.1, 0.8, 1.3, 0.9, 1.0])[:, None]
    return np.asarray((sizes * np.exp(1j * turns)).astype(complex))


# --- solving --------------------------------------------------------------------------------


def roots_at(design: FiveRPURDesign, joints: ArrayLike, tied: Ties = ()) -> Roots:
    """All complex solutions for actuator lengths (5,), mm; of limbs that are ``tied`` in one mode.

    Limbs of one U joint stay together on every path, so that theirs are paths of their own.
    """
    (found,) = _own.solve(
        _key(design),
        partial(_kept_or_made, design),
        lambda own: _moved(own, design, joints),
        1,
        membership(design).family.count,
        partial(_of_ties, tied=tied),
    )
    return found


def _of_ties(roots: Complex, tied: Ties) -> Complex:
    """Those of the roots (10, n) in which tied limbs have one U joint."""
    one = np.ones(roots.shape[1], dtype=bool)
    for first, *others in tied:
        w = roots[W][first - 1]
        for i in others:
            one &= np.abs(roots[W][i - 1] - w) <= _TIED * (1.0 + np.abs(w))
    return roots[:, one]


def roots_from(
    design: FiveRPURDesign, known: Complex, before: ArrayLike, joints: ArrayLike
) -> Roots:
    """The same from all solutions ``known`` at the lengths ``before``: quicker if they are near.

    The way leads around through complex lengths, as real solutions merge on a straight one.
    """
    own = own_start_set(design).parameters
    start = StartSet(_moved(own, design, before), known)
    target = _moved(own, design, joints)
    (found,) = solve(equations, start, target, real=True, around=AROUND[-1], control=_QUICK)
    return found


def _moved(own: Parameters, design: FiveRPURDesign, joints: ArrayLike) -> Parameters:
    return own._replace(rho2=parameters(design, joints).rho2.astype(complex))
