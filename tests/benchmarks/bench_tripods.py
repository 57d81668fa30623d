"""How fast the 3-RPS and 3-SPR are solved; run apart from the tests.

The MICR table is that of Nayak et al. (2017), Figs. 4 and 5: both machines, both operation modes,
eight ratios and eighty altitudes, 2560 values.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from kinematics.designs.files import load_design
from kinematics.facets.circles import micr
from kinematics.machine import machine_of

FLOOR = 1.0  # seconds for the table
ROUNDS = 7
RATIOS = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0])[:, None]
HEIGHTS = np.linspace(0.05, 4.0, 80)


def best(action: Callable[[], object]) -> float:
    """Seconds of the fastest of several rounds: other work on the machine only adds."""
    times = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return min(times)


def table() -> None:
    for kind in ("three_rps", "three_spr"):
        micr(kind, 1.0, RATIOS, HEIGHTS)


def one(name: str) -> None:
    design = load_design(name)
    joints = np.random.default_rng(0).uniform(*design.stroke, (200, 3))
    home = machine_of(design).home
    aside = (home.pose[0], 0.1, 0.2)
    each = {
        "forward, one vector": lambda: machine_of(design).forward(joints[0]),
        "forward, a vector of 200": lambda: machine_of(design).forward(joints),
        "locus at an altitude": lambda: machine_of(design).singularities.locus(
            "orientation", home.pose, home.mode
        ),
        "circles about an orientation": lambda: machine_of(design).circles.about(aside, home.mode),
    }
    for what, action in each.items():
        share = 200 if what.endswith("200") else 1
        print(f"{name}  {what:30}  {1e3 * best(action) / share:.2f} ms")


def main() -> None:
    seconds = best(table)
    print(f"MICR, the whole table of 2560: {1e3 * seconds:.0f} ms (at most {1e3 * FLOOR:.0f})")
    for name in ("rps-3", "spr-3"):
        one(name)
    assert seconds <= FLOOR


if __name__ == "__main__":
    main()
