"""How fast the inverse problem and a slider's motion are solved; run apart from the tests.

A limb solution is one actuator length: one limb at one pose in one of its two working modes, so
10 a pose. The 32 working modes of the mechanism only combine them and are not counted again.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np

from kinematics.designs.files import load_design
from kinematics.facets.inverse import posture
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import MODES, inside, inverse, limb_lengths

FLOOR = 5e6  # limb solutions a second
ROUNDS = 7


def best(action: Callable[[], object]) -> float:
    """Seconds of the fastest of several rounds: other work on the machine only adds."""
    times = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return min(times)


def random_poses(count: int) -> np.ndarray:
    rng = np.random.default_rng(0)
    position = rng.uniform((-400, -50, -500), (400, 200, 500), (count, 3))
    return np.column_stack([position, rng.uniform(-np.pi, np.pi, (count, 2))])


def main() -> None:
    design = load_design("rpur-table1")
    assert isinstance(design, FiveRPURDesign)
    poses = random_poses(200_000)
    rates = {}
    for name, count, action in (
        ("lengths", len(poses), lambda: limb_lengths(design, poses)),
        ("membership", len(poses), lambda: inside(design, poses)),
        ("all 32 modes, with residual", 50_000, lambda: inverse(design, poses[:50_000])),
    ):
        rates[name] = 2 * LIMBS * count / best(action)
        print(f"{name:32s} {rates[name] / 1e6:8.1f} million limb solutions a second")

    rng = np.random.default_rng(1)
    fits = inverse(design, poses[:20_000]).within_stroke
    chosen = rng.permutation(np.argwhere(fits))[:200]
    starts = [posture(design, tuple(poses[n].tolist()), MODES[m]) for n, m in chosen]
    # What is loaded for the first move is not what is measured.
    machine_of(design).following.follow(starts[0], starts[0].joints[::-1])
    for step in (1.0, 5.0, 20.0):
        times = []
        for k, start in enumerate(starts):
            joints = list(start.joints)
            joints[k % LIMBS] += step if k % 2 else -step
            begin = time.perf_counter()
            machine_of(design).following.follow(start, joints)
            times.append(1e3 * (time.perf_counter() - begin))
        print(
            f"{f'actuator moved by {step:g} mm':32s} {statistics.median(times):8.2f} ms median, "
            f"{np.quantile(times, 0.95):.2f} ms in 95 of 100, {max(times):.2f} ms worst"
        )
    met = "met" if rates["lengths"] >= FLOOR else "missed"
    print(f"floor of {FLOOR / 1e6:g} million limb solutions a second: {met}")


if __name__ == "__main__":
    main()
