"""Makes the start set of the 4-SPS + 1-SPR from nothing, and writes it into a folder.

One machine is built around one random configuration, so that it has that solution. Following it
to other random machines and back permutes the solutions; new ones are kept until none come any
more (monodromy: Duff, Hill, Jensen, Lee, Leykin & Sommars, IMA J. Numer. Anal. 39 (2019) 1421).

    python -m kinematics.four_sps_spr.forward.monodromy FOLDER
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from kinematics.errors import ComputationError
from kinematics.four_sps_spr.design import LIMBS, SPR
from kinematics.four_sps_spr.forward.equations import (
    Deformation,
    Parameters,
    marks,
    on_patch,
    polish,
)
from kinematics.four_sps_spr.forward.roots import cluster
from kinematics.four_sps_spr.forward.start_set import FILE, GENERAL_COUNT, StartSet
from kinematics.tracking import Complex, Ending, track

_PATIENCE = 10  # loops without anything new, after which the set is taken to be whole
_MOST_LOOPS = 80

Report = Callable[[str], None]


def completed_set(
    rng: np.random.Generator, report: Report = lambda _: None, *, planar: bool = False
) -> StartSet:
    """All solutions of a random complex machine, from a single one.

    Args:
        planar: base and platform points in planes, the axis in that of the platform.
    """
    machine, roots = _seed(rng, planar)
    idle = 0
    for n in range(_MOST_LOOPS):
        before = roots.shape[1]
        stops = [machine, _random_machine(rng, planar), _random_machine(rng, planar), machine]
        moved = roots
        for here, there in pairwise(stops):
            ends = track(Deformation(here, there), moved)
            moved = ends.values[:, ends.endings == Ending.REGULAR]
        roots = _distinct(machine, np.concatenate([roots, moved], axis=1))
        report(f"loop {n + 1}, {roots.shape[1]} solutions")
        idle = idle + 1 if roots.shape[1] == before else 0
        if idle >= _PATIENCE:
            break
    return StartSet(machine, roots)


def _seed(rng: np.random.Generator, planar: bool) -> tuple[Parameters, Complex]:
    """A random machine that has one random configuration."""
    g = _random_machine(rng, planar)
    x, y = _random(rng, 4, 1), _random(rng, 4, 1)
    y = y - x * (x * y).sum() / (x * x).sum()
    u = on_patch(np.concatenate([x, y]))
    pose = marks(u)[:, 0]
    r, p = pose[:9].reshape(3, 3), pose[9:]
    base, platform, axis = (np.array(v, dtype=complex) for v in (g.base, g.platform, g.axis))
    normal = r @ axis
    apart = platform[SPR] @ axis - (base[SPR] - p) @ normal
    base[SPR, 0] += apart / normal[0]
    vectors = p + platform @ r.T - base
    return g._replace(base=base, squares=(vectors * vectors).sum(axis=1)), u


def _distinct(machine: Parameters, roots: Complex) -> Complex:
    values, error = polish(machine, roots)
    values = values[:, error < 1e-10]
    return values[:, np.unique(cluster(values), return_index=True)[1]]


def _random(rng: np.random.Generator, *shape: int) -> Complex:
    values: Complex = (rng.normal(size=shape) + 1j * rng.normal(size=shape)) / np.sqrt(2.0)
    return values


def _random_machine(rng: np.random.Generator, planar: bool) -> Parameters:
    base, platform, axis = _random(rng, LIMBS, 3), 0.7 * _random(rng, LIMBS, 3), _random(rng, 3)
    if planar:
        base[:, 2] = platform[:, 2] = 0.0
        axis[2] = 0.0
    return Parameters(base, platform, axis, _random(rng, LIMBS))


def make(folder: Path, *, seed: int = 2017, report: Report = lambda _: None) -> None:
    """Write the start set.

    Raises:
        ComputationError: it did not come out with as many solutions as it must have.
    """
    found = completed_set(np.random.default_rng(seed), report)
    count = found.roots.shape[1]
    if count != GENERAL_COUNT:
        raise ComputationError(
            f"the general 4-SPS + 1-SPR came out with {count} solutions, not {GENERAL_COUNT}; "
            "try again with another seed"
        )
    folder.mkdir(parents=True, exist_ok=True)
    np.savez(folder / FILE, **found.parameters._asdict(), roots=found.roots.astype(np.complex64))


def main(arguments: Sequence[str]) -> int:
    """``python -m kinematics.four_sps_spr.forward.monodromy FOLDER``."""
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
    sys.stdout.write(f"4-SPS + 1-SPR: {line}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
