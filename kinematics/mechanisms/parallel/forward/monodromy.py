"""Makes the start sets of mechanisms in Study's coordinates, and writes them into a folder.

Each comes from a single solution of one random machine, whose platform is turned and moved so that
it is the identity there; see `kinematics.homotopy.monodromy`.

    python -m kinematics.mechanisms.parallel.forward.monodromy FOLDER
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np

from kinematics.homotopy.monodromy import Report, completed, counted, random_complex, run
from kinematics.homotopy.solving import StartSet
from kinematics.homotopy.study import Limbs
from kinematics.homotopy.tracking import Complex
from kinematics.mechanisms.parallel.forward.study import Signature, equations, file_name

COUNTS: dict[Signature, int] = {
    (6, 0, 0): 40,
    (4, 1, 0): 40,
    (4, 0, 1): 40,
    (2, 2, 0): 32,
    (2, 1, 1): 24,
    (2, 0, 2): 32,
    (0, 3, 0): 16,
    (0, 2, 1): 16,
    (0, 1, 2): 16,
    (0, 0, 3): 16,
}
"""How many solutions almost every machine has, of all kinds with as many freedoms as limbs. That
none is missing is proven by `trace`; loops that bring nothing new prove nothing."""
_PATIENCE = 10  # loops without anything new, after which the set is taken to be whole


def completed_set(
    of: Signature, rng: np.random.Generator, report: Report = lambda _: None
) -> StartSet[Limbs]:
    """All solutions of a random complex machine, from a single one."""
    return completed(
        equations(of),
        _seed(of, rng),
        lambda: _random_machine(of, rng),
        lambda _, idle: idle >= _PATIENCE,
        report,
    )


def _seed(of: Signature, rng: np.random.Generator) -> StartSet[Limbs]:
    """A random machine that has one random configuration."""
    g = _random_machine(of, rng)
    closure = equations(of)
    x, y = random_complex(rng, 4, 1), random_complex(rng, 4, 1)
    y = y - x * (x * y).sum() / (x * x).sum()
    u = closure.on_patch(np.concatenate([x, y]))
    pose = closure.placed(u)[:, 0]
    r, p = pose[:9].reshape(3, 3), pose[9:]
    base: Complex = np.array(g.base, dtype=complex)
    for n, plane in enumerate(closure.planes):
        at = p + r @ g.platform[n]
        if plane == "base":
            off = (at - base[n]) @ g.axis[n]
            base[n] += off * g.axis[n] / (g.axis[n] @ g.axis[n])
        elif plane == "platform":
            normal = r @ g.axis[n]
            off = g.platform[n] @ g.axis[n] - (base[n] - p) @ normal
            base[n] += off * normal / (normal @ normal)
    vectors = p + g.platform @ r.T - base
    return StartSet(g._replace(base=base, squares=(vectors * vectors).sum(axis=1)), u)


def _random_machine(of: Signature, rng: np.random.Generator) -> Limbs:
    count = sum(of)
    return Limbs(
        random_complex(rng, count, 3),
        0.7 * random_complex(rng, count, 3),
        random_complex(rng, count, 3),
        random_complex(rng, count),
    )


def _named(report: Report, name: str, line: str) -> None:
    report(f"{name}: {line}")


def make(folder: Path, report: Report) -> None:
    """Write the start sets."""
    for of, count in COUNTS.items():
        name = file_name(of)
        found = completed_set(of, np.random.default_rng(2024), partial(_named, report, name))
        counted(found, f"the kind {of}", count)
        roots = found.roots.astype(np.complex64)
        np.savez(folder / name, **found.parameters._asdict(), roots=roots)


if __name__ == "__main__":
    sys.exit(run(make, sys.argv[1:]))
