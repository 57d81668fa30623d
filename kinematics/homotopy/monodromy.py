"""All solutions of a family of machines from a single one, to make start sets.

One machine is built around one random configuration, so that it has that solution. Following it
to other random machines and back permutes the solutions; new ones are kept until none come any
more (monodromy: Duff, Hill, Jensen, Lee, Leykin & Sommars, IMA J. Numer. Anal. 39 (2019) 1421).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

import numpy as np

from kinematics.errors import ComputationError
from kinematics.homotopy.solving import Closure, StartSet, cluster, distinct
from kinematics.homotopy.tracking import Complex, Ending, track

P = TypeVar("P")
Report = Callable[[str], None]

MOST_LOOPS = 80


def completed(
    closure: Closure[P],
    known: StartSet[P],
    another: Callable[[], P],
    enough: Callable[[int, int], bool],
    report: Report,
) -> StartSet[P]:
    """Loops through random machines until they bring nothing new.

    Args:
        closure: the equations.
        known: a machine and some of its solutions.
        another: makes a random machine.
        enough: whether to stop, from the number of solutions and of loops without a new one.
    """
    machine, roots = known.parameters, known.roots
    idle = 0
    for n in range(MOST_LOOPS):
        before = roots.shape[1]
        stops = [machine, another(), another(), machine]
        moved = roots
        for here, there in pairwise(stops):
            ends = track(closure.between(here, there), moved)
            moved = ends.values[:, ends.ended(Ending.REGULAR)]
        roots = each_once(closure, machine, np.concatenate([roots, moved], axis=1))
        report(f"loop {n + 1}, {roots.shape[1]} solutions")
        idle = idle + 1 if roots.shape[1] == before else 0
        if enough(roots.shape[1], idle):
            break
    return StartSet(machine, roots)


def each_once(closure: Closure[P], machine: P, roots: Complex) -> Complex:
    """The regular solutions of a machine among some, polished."""
    values, error = closure.polish(machine, roots)
    values = values[:, error < 1e-10]
    return distinct(values, cluster(closure, values))


def counted(found: StartSet[P], title: str, count: int) -> StartSet[P]:
    """The set, which must have as many solutions as its family.

    Raises:
        ComputationError: it has not.
    """
    if found.roots.shape[1] != count:
        raise ComputationError(
            f"{title} came out with {found.roots.shape[1]} solutions, not {count}; "
            "try again with another seed"
        )
    return found


def random_complex(rng: np.random.Generator, *shape: int) -> Complex:
    """Complex numbers of size about one."""
    return np.asarray((rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0))


def run(make: Callable[[Path, Report], None], arguments: Sequence[str]) -> int:
    """What ``python -m …monodromy FOLDER`` does; the exit code."""
    if len(arguments) != 1:
        sys.stderr.write("one folder is needed, as assets/start_solutions\n")
        return 2
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    try:
        make(folder, _print_line)
    except ComputationError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    return 0


def _print_line(line: str) -> None:
    """Progress, on the terminal at once."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
