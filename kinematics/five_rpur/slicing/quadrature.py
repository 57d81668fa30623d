"""Two nested quadrature rules for integrands with square roots at both ends.

An integral over x' = a + (b − a) s, s in [0, 1], where the integrand behaves at the ends like a
series in √s and √(1 − s): areas of sections between two changes of their structure do. Nodes lie
at s = (1 − cos πu)/2 with the Gauss-Kronrod nodes u. Every rule has two coarser ones on every
second of its nodes: where the integrand has a kink, one of them may by chance agree with the
finer rule, hardly both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.spatial import Array

# Gauss-Kronrod, 7 and 15 points on [-1, 1] (QUADPACK): nodes > 0 from the largest on, then 0, and
# both weights; Gauss's nodes are every second one from the second.
_NODES = (
    0.991455371120812640,
    0.949107912342758525,
    0.864864423359769073,
    0.741531185599394440,
    0.586087235467691130,
    0.405845151377397167,
    0.207784955007898468,
    0.0,
)
_KRONROD = (
    0.022935322010529225,
    0.063092092629978553,
    0.104790010322250184,
    0.140653259715525919,
    0.169004726639267903,
    0.190350578064785410,
    0.204432940075298892,
    0.209482141084727828,
)
_GAUSS = (0.129484966168869693, 0.279705391489276668, 0.381830050505118945, 0.417959183673469388)


@dataclass(frozen=True, eq=False)
class Rule:
    """``place`` (N,) the nodes s, ``weights`` (N,), ``coarser`` (N, 2) of the coarser rules."""

    place: Array
    weights: Array
    coarser: Array


def _long() -> Rule:
    """The 15-point rule in u: geometric convergence for whatever is a series at both ends."""
    half = np.array(_NODES)
    mirrored = [*range(8), *range(6, -1, -1)]
    u = 0.5 + 0.5 * np.concatenate([-half, half[-2::-1]])
    gauss = np.zeros(8)
    gauss[1::2] = _GAUSS
    gauss = gauss[mirrored]
    # The nodes that Gauss leaves out, with the weights that integrate all polynomials they can.
    left = np.flatnonzero(gauss == 0.0)
    basis = np.polynomial.legendre.legvander(2.0 * u[left] - 1.0, left.size - 1)
    other = np.zeros(u.size)
    other[left] = np.linalg.solve(basis.T, 2.0 * (np.arange(left.size) == 0))
    slope = 0.25 * np.pi * np.sin(np.pi * u)
    return Rule(
        0.5 - 0.5 * np.cos(np.pi * u),
        np.array(_KRONROD)[mirrored] * slope,
        np.stack([gauss, other], axis=-1) * slope[:, None],
    )


def _short(place: Array) -> Rule:
    """A rule on seven symmetric nodes s that is exact for cubics and for s^½, s^³ᐟ² at both ends.

    The rules on every second node are exact for cubics.
    """
    even = np.stack(
        [place**0, (place - 0.5) ** 2, *(place**p + place[::-1] ** p for p in (0.5, 1.5))]
    )
    integrals = np.array([1.0, 1.0 / 12.0, 4.0 / 3.0, 4.0 / 5.0])
    rules = []
    for nodes, exact in (([0, 1, 2, 3], 4), ([1, 3], 2), ([0, 2], 2)):
        pairs = even[:exact, nodes] * np.where(np.array(nodes) == 3, 1.0, 2.0)
        weights = np.zeros(7)
        weights[nodes] = np.linalg.solve(pairs, integrals[:exact])
        weights[4:] = weights[2::-1]
        rules.append(weights)
    return Rule(place, rules[0], np.stack(rules[1:], axis=-1))


LONG = _long()
SHORT = _short(LONG.place[1::2])
"""Its nodes are every second one of `LONG`, from the second on."""
