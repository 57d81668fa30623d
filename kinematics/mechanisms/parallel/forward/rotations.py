"""Machines that turn about a point: three directions, eight solutions at most.

e·R w = cos α of each limb is a quadratic form in a quaternion; three of them in projective space
have eight common points (Bézout), which are followed from those of x₁² = x₂² = x₃² = x₀².
"""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.homotopy.forms import PATCH, Deformation, FormEquations, normal_form, rotation_forms
from kinematics.homotopy.solving import Roots, StartSet
from kinematics.homotopy.solving import solve as followed
from kinematics.homotopy.tracking import Complex, Index
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.forward.found import Assembled

_REAL = 1e-7
_DOUBLE_REAL = 1e-4
_METHOD = "8 paths tracked from a system of three quadrics (Bézout's number)"


class Coefficients(NamedTuple):
    """(..., 3, 10) of x·x and R̂, row by row."""

    c: NDArray[Any]


class RotationEquations(FormEquations[Coefficients]):
    """Three combinations of x·x and the entries of R̂(x)."""

    def __init__(self) -> None:
        super().__init__(_FORMS, np.zeros((0, 4, 4)))

    def coefficients(self, g: Coefficients) -> Complex:
        return np.asarray(g.c, dtype=complex)

    def of(self, g: Coefficients, columns: Index) -> Coefficients:
        return Coefficients(g.c[columns] if g.c.ndim == 3 else g.c)

    def between(
        self, start: Coefficients, end: Coefficients, around: float = 0.0
    ) -> Deformation[Coefficients]:
        middle = Coefficients(0.5 * (start.c + end.c))
        return Deformation(self, start, middle, end, around)

    def placed(self, u: Complex) -> Complex:
        with np.errstate(all="ignore"):
            monomials = (self.halves(u) @ u.T[:, :, None])[..., 0].T
            values: Complex = monomials[1:] / monomials[0]
        return values


_FORMS = np.concatenate([np.eye(4)[None], rotation_forms()])
EQUATIONS = RotationEquations()


@cache
def _start() -> StartSet[Coefficients]:
    """x_k² − x_0², each times a complex number that nothing is special about."""
    flat = _FORMS.reshape(10, 16).T
    rows = []
    for k, turn in zip((1, 2, 3), (0.9, -2.3, 1.4), strict=True):
        form = np.zeros((4, 4))
        form[k, k], form[0, 0] = 1.0, -1.0
        rows.append(np.exp(1j * turn) * np.linalg.lstsq(flat, form.ravel())[0])
    roots = np.array([(1.0, *signs) for signs in product((1.0, -1.0), repeat=3)]).T.astype(complex)
    return StartSet(Coefficients(np.array(rows)), roots / (PATCH @ roots))


def solve(machine: Assembly, joints: Array) -> list[Assembled]:
    """For joints (B, 3)."""
    e, cosine = machine.drives.locked(joints)
    turned = e[..., :, None] * machine.drives.b[..., None, :]
    c = np.concatenate([-cosine[..., None], turned.reshape(*turned.shape[:-2], 9)], axis=-1)
    found = followed(EQUATIONS, _start(), Coefficients(c), len(c), real=True)
    return [_one(machine, roots) for roots in found]


def _one(machine: Assembly, roots: Roots) -> Assembled:
    form = normal_form(roots.values)
    away = np.abs(form.imag).max(axis=0, initial=0.0)
    limit = np.where(roots.multiplicity > 1, _DOUBLE_REAL, _REAL)
    limit[roots.regular :] = _DOUBLE_REAL
    real = np.flatnonzero(away <= limit)
    placements = _placements(machine, form[:, real])
    singular = np.arange(form.shape[1]) >= roots.regular
    return Assembled(
        placements,
        roots.multiplicity[real],
        form,
        roots.count,
        8,
        roots.complete,
        _METHOD,
        roots.doubts,
        int(np.count_nonzero((away > limit) & (away < 1e-3))) // 2,
        _placements(machine, form[:, singular]),
    )


def _placements(machine: Assembly, form: Complex) -> Array:
    """(N, 4, 4): R of each, and O′ where the centre that stays puts it."""
    x = form.real / np.linalg.norm(form.real, axis=0)
    r = EQUATIONS.placed(x.astype(complex)).real.T.reshape(-1, 3, 3)
    limb = machine.bonds.each[0].limb
    placements = np.tile(np.eye(4), (len(r), 1, 1))
    placements[:, :3, :3] = r
    placements[:, :3, 3] = limb.a - r @ limb.mark
    return placements
