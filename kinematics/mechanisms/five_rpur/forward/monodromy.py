"""Makes the start sets of the 5-RPUR from nothing, and writes them into a folder.

The general set comes from a single solution (`homotopy.monodromy`). The families' sets are
followed from it, its surplus running off to infinity, and their own loops add what was lost on
the way.

    python -m kinematics.mechanisms.five_rpur.forward.monodromy FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from kinematics.designs.files import load_design
from kinematics.homotopy.monodromy import (
    Report,
    completed,
    counted,
    each_once,
    random_complex,
    run,
)
from kinematics.homotopy.tracking import Ending, track
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward import equations
from kinematics.mechanisms.five_rpur.forward.equations import (
    PHI,
    THETA,
    UNKNOWNS,
    Deformation,
    Parameters,
    residuals,
)
from kinematics.mechanisms.five_rpur.forward.families import (
    FAMILIES,
    MACHINES,
    Family,
    Membership,
    StartSet,
    exact,
)
from kinematics.mechanisms.five_rpur.forward.general import make_own

_PATIENCE = 4  # loops without anything new, after which a set is taken to be whole
_SPREAD = 0.7  # of the base and platform points of random machines, in links


def general_set(rng: np.random.Generator, report: Report) -> StartSet:
    """All solutions of a random complex machine, from a single one."""
    g = _random_machine(rng, FAMILIES[0])
    u = random_complex(rng, UNKNOWNS, 1)
    u[PHI : THETA + 1] /= np.abs(u[PHI : THETA + 1]) ** 0.5
    f1, f2 = residuals(g._replace(link2=np.zeros((LIMBS, 1)), rho2=np.zeros((LIMBS, 1))), u)
    return _completed(
        StartSet(g._replace(link2=2.0 * f2, rho2=2.0 * f1), u), FAMILIES[0], rng, report
    )


def family_set(
    general: StartSet, family: Family, rng: np.random.Generator, report: Report
) -> StartSet:
    """All solutions of a random complex machine of a family."""
    machine = _random_machine(rng, family)
    ends = track(Deformation(general.parameters, machine), general.roots)
    regular = each_once(equations, machine, ends.values[:, ends.ended(Ending.REGULAR)])
    return _completed(StartSet(machine, regular), family, rng, report)


def _completed(
    known: StartSet, family: Family, rng: np.random.Generator, report: Report
) -> StartSet:
    """Loops through random machines of the family until they bring nothing new."""
    found = completed(
        equations,
        known,
        lambda: _random_machine(rng, family),
        # From one solution, loops bring nothing new by chance.
        lambda count, idle: idle >= _PATIENCE * (1 if count >= family.count else 3),
        lambda line: report(f"{family.name}: {line}"),
    )
    return counted(found, family.title, family.count)


def _random_machine(rng: np.random.Generator, family: Family) -> Parameters:
    """A random complex machine of a family."""
    points = (_SPREAD * random_complex(rng, LIMBS, 1) for _ in range(6))
    squares = (random_complex(rng, LIMBS, 1) for _ in range(2))
    return exact(Parameters(*points, *squares), Membership(family, tuple(range(LIMBS))))


def write(folder: Path, name: str, found: StartSet) -> None:
    """One file; single precision is enough, as whoever reads it begins with a Newton step."""
    np.savez(
        folder / f"five_rpur-{name}.npz",
        parameters=np.hstack(found.parameters).T,
        roots=found.roots.astype(np.complex64),
    )


def make(folder: Path, report: Report) -> None:
    """Write all start sets.

    Raises:
        ComputationError: a set did not come out with as many solutions as it must have.
    """
    rng = np.random.default_rng(2011)
    general = general_set(rng, report)
    write(folder, FAMILIES[0].name, general)
    for family in FAMILIES[1:]:
        write(folder, family.name, family_set(general, family, rng, report))
    for name in MACHINES:
        design = load_design(name)
        assert isinstance(design, FiveRPURDesign)
        found = make_own(design)
        write(folder, name, found)
        report(f"{name}: {found.roots.shape[1]} solutions")


if __name__ == "__main__":
    sys.exit(run(make, sys.argv[1:]))
