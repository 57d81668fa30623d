"""Makes the start set of the 4-SPS + 1-SPR from nothing, and writes it into a folder.

It comes from a single solution of one random machine, see `kinematics.homotopy.monodromy`.

    python -m kinematics.mechanisms.four_sps_spr.forward.monodromy FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from kinematics.homotopy.monodromy import Report, completed, counted, random_complex, run
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR
from kinematics.mechanisms.four_sps_spr.forward.equations import CLOSURE, Parameters
from kinematics.mechanisms.four_sps_spr.forward.roots import FILE, GENERAL_COUNT, StartSet

_PATIENCE = 10  # loops without anything new, after which the set is taken to be whole


def completed_set(
    rng: np.random.Generator, report: Report = lambda _: None, *, planar: bool = False
) -> StartSet:
    """All solutions of a random complex machine, from a single one.

    Args:
        planar: base and platform points in planes, the axis in that of the platform.
    """
    return completed(
        CLOSURE,
        _seed(rng, planar),
        lambda: _random_machine(rng, planar),
        lambda _, idle: idle >= _PATIENCE,
        report,
    )


def _seed(rng: np.random.Generator, planar: bool) -> StartSet:
    """A random machine that has one random configuration."""
    g = _random_machine(rng, planar)
    x, y = random_complex(rng, 4, 1), random_complex(rng, 4, 1)
    y = y - x * (x * y).sum() / (x * x).sum()
    u = CLOSURE.on_patch(np.concatenate([x, y]))
    pose = CLOSURE.placed(u)[:, 0]
    r, p = pose[:9].reshape(3, 3), pose[9:]
    base, platform, axis = (np.array(v, dtype=complex) for v in (g.base, g.platform, g.axis))
    normal = r @ axis
    apart = platform[SPR] @ axis - (base[SPR] - p) @ normal
    base[SPR, 0] += apart / normal[0]
    vectors = p + platform @ r.T - base
    return StartSet(g._replace(base=base, squares=(vectors * vectors).sum(axis=1)), u)


def _random_machine(rng: np.random.Generator, planar: bool) -> Parameters:
    base, platform = random_complex(rng, LIMBS, 3), 0.7 * random_complex(rng, LIMBS, 3)
    axis = random_complex(rng, 3)
    if planar:
        base[:, 2] = platform[:, 2] = 0.0
        axis[2] = 0.0
    return Parameters(base, platform, axis, random_complex(rng, LIMBS))


def make(folder: Path, report: Report) -> None:
    """Write the start set.

    Raises:
        ComputationError: it did not come out with as many solutions as it must have.
    """
    title = "4-SPS + 1-SPR"
    found = completed_set(np.random.default_rng(2017), lambda line: report(f"{title}: {line}"))
    counted(found, f"the general {title}", GENERAL_COUNT)
    roots = found.roots.astype(np.complex64)
    np.savez(folder / FILE, **found.parameters._asdict(), roots=roots)


if __name__ == "__main__":
    sys.exit(run(make, sys.argv[1:]))
