"""Makes the start sets of the 5-RPUR from nothing, and writes them into a folder.

One machine is built around one random configuration, so that it has that solution. Following it
to other random machines and back permutes the solutions; new ones are kept until none come any
more (monodromy: Duff, Hill, Jensen, Lee, Leykin & Sommars, IMA J. Numer. Anal. 39 (2019) 1421).
The families' sets are followed from the general one, whose surplus runs off to infinity, and
their own loops add what was lost on the way.

    python -m kinematics.five_rpur.forward.monodromy FOLDER
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from kinematics.designs import load_design
from kinematics.errors import ComputationError
from kinematics.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.five_rpur.forward.equations import (
    PHI,
    THETA,
    UNKNOWNS,
    Complex,
    Deformation,
    Parameters,
    polish,
    residuals,
)
from kinematics.five_rpur.forward.families import FAMILIES, MACHINES, Family, StartSet
from kinematics.five_rpur.forward.general import cluster, make_own
from kinematics.tracking import Control, Ending, track

_PATIENCE = 4  # loops without anything new, after which a set is taken to be whole
_MOST_LOOPS = 80
_SPREAD = 0.7  # of the base and platform points of random machines, in links

Report = Callable[[str], None]


def general_set(rng: np.random.Generator, report: Report) -> StartSet:
    """All solutions of a random complex machine, from a single one."""
    g = _random_machine(rng, FAMILIES[0])
    u = _random(rng, UNKNOWNS, 1)
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
    regular = ends.values[:, ends.endings == Ending.REGULAR]
    return _completed(StartSet(machine, _distinct(machine, regular)), family, rng, report)


def _completed(
    known: StartSet, family: Family, rng: np.random.Generator, report: Report
) -> StartSet:
    """Loops through random machines of the family until they bring nothing new."""
    machine, roots = known.parameters, known.roots
    idle = 0
    for n in range(_MOST_LOOPS):
        before = roots.shape[1]
        stops = [machine, _random_machine(rng, family), _random_machine(rng, family), machine]
        moved = roots
        for here, there in pairwise(stops):
            ends = track(Deformation(here, there), moved, Control())
            moved = ends.values[:, ends.endings == Ending.REGULAR]
        roots = _distinct(machine, np.concatenate([roots, moved], axis=1))
        report(f"{family.name}: loop {n + 1}, {roots.shape[1]} solutions")
        idle = idle + 1 if roots.shape[1] == before else 0
        # From one solution, loops bring nothing new by chance.
        if idle >= _PATIENCE and (roots.shape[1] >= family.count or idle >= 3 * _PATIENCE):
            break
    if roots.shape[1] != family.count:
        raise ComputationError(
            f"{family.title} came out with {roots.shape[1]} solutions, not {family.count}; "
            "try again with another seed"
        )
    return StartSet(machine, roots)


def _distinct(machine: Parameters, roots: Complex) -> Complex:
    values, error = polish(machine, roots)
    values = values[:, error < 1e-10]
    return values[:, np.unique(cluster(values), return_index=True)[1]]


def _random(rng: np.random.Generator, *shape: int) -> Complex:
    values: Complex = (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0)
    return values


def _random_machine(rng: np.random.Generator, family: Family) -> Parameters:
    """A random complex machine of a family."""
    rx, ry, rz, sx, sy, sz = (_SPREAD * _random(rng, LIMBS, 1) for _ in range(6))
    link2, rho2 = _random(rng, LIMBS, 1), _random(rng, LIMBS, 1)
    for kind, i, j in family.relations:
        if kind != "R":
            sy[j], sz[j] = sy[i], sz[i]
        if kind in ("R", "A2"):
            rx[j], rz[j] = rx[i], rz[i]
        if kind in ("A1", "A2", "A3"):
            ry[j], link2[j] = ry[i], link2[i]
        if kind == "A1":
            sx[j] = sx[i]
    return Parameters(rx, ry, rz, sx, sy, sz, link2, rho2)


def write(folder: Path, name: str, found: StartSet) -> None:
    """One file; single precision is enough, as whoever reads it begins with a Newton step."""
    np.savez(
        folder / f"five_rpur-{name}.npz",
        parameters=np.hstack(found.parameters).T,
        roots=found.roots.astype(np.complex64),
    )


def make(folder: Path, *, seed: int = 2011, report: Report = lambda _: None) -> None:
    """Write all start sets.

    Raises:
        ComputationError: a set did not come out with as many solutions as it must have.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(seed)
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


def main(arguments: Sequence[str]) -> int:
    """``python -m kinematics.five_rpur.forward.monodromy FOLDER``."""
    if len(arguments) != 1:
        sys.stderr.write("one folder is needed, as assets/start_solutions\n")
        return 2
    try:
        make(Path(arguments[0]), report=print_line)
    except ComputationError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    return 0


def print_line(line: str) -> None:
    """Progress, on the terminal at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
