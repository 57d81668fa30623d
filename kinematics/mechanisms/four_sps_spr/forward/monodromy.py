"""Makes the start set of the 4-SPS + 1-SPR from nothing, and writes it into a folder.

It comes from a single solution of one random machine, see `kinematics.homotopy.monodromy`.

    python -m kinematics.mechanisms.four_sps_spr.forward.monodromy FOLDER
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from kinematics.errors import ComputationError
from kinematics.homotopy.monodromy import Report, completed, print_line, random_complex, run
from kinematics.homotopy.tracking import Complex
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR
from kinematics.mechanisms.four_sps_spr.forward.equations import (
    Deformation,
    Parameters,
    marks,
    on_patch,
    polish,
)
from kinematics.mechanisms.four_sps_spr.forward.roots import cluster
from kinematics.mechanisms.four_sps_spr.forward.start_set import FILE, GENERAL_COUNT, StartSet

_PATIENCE = 10  # loops without anything new, after which the set is taken to be whole


def completed_set(
    rng: np.random.Generator, report: Report = lambda _: None, *, planar: bool = False
) -> StartSet:
    """All solutions of a random complex machine, from a single one.

    Args:
        planar: base and platform points in planes, the axis in that of the platform.
    """
    return completed(
        _seed(rng, planar),
        lambda: _random_machine(rng, planar),
        Deformation,
        _distinct,
        lambda _, idle: idle >= _PATIENCE,
        report,
    )


def _seed(rng: np.random.Generator, planar: bool) -> StartSet:
    """A random machine that has one random configuration."""
    g = _random_machine(rng, planar)
    x, y = random_complex(rng, 4, 1), random_complex(rng, 4, 1)
    y = y - x * (x * y).sum() / (x * x).sum()
    u = on_patch(np.concatenate([x, y]))
    pose = marks(u)[:, 0]
    r, p = pose[:9].reshape(3, 3), pose[9:]
    base, platform, axis = (np.array(v, dtype=complex) for v in (g.base, g.platform, g.axis))
    normal = r @ axis
    apart = platform[SPR] @ axis - (base[SPR] - p) @ normal
    base[SPR, 0] += apart / normal[0]
    vectors = p + platform @ r.T - base
    return StartSet(g._replace(base=base, squares=(vectors * vectors).sum(axis=1)), u)


def _distinct(machine: Parameters, roots: Complex) -> Complex:
    values, error = polish(machine, roots)
    values = values[:, error < 1e-10]
    return values[:, np.unique(cluster(values), return_index=True)[1]]


def _random_machine(rng: np.random.Generator, planar: bool) -> Parameters:
    base, platform = random_complex(rng, LIMBS, 3), 0.7 * random_complex(rng, LIMBS, 3)
    axis = random_complex(rng, 3)
    if planar:
        base[:, 2] = platform[:, 2] = 0.0
        axis[2] = 0.0
    return Parameters(base, platform, axis, random_complex(rng, LIMBS))


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
    """``python -m kinematics.mechanisms.four_sps_spr.forward.monodromy FOLDER``."""
    return run(partial(make, report=_print), arguments)


def _print(line: str) -> None:
    print_line(f"4-SPS + 1-SPR: {line}")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
