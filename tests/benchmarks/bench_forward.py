"""How fast all assembly modes are found, against random starts of a numerical solver.

Run apart from the tests, on a quiet machine. The comparison is of one run: SciPy's `fsolve` on
the five closure equations from random poses, which is what people use today and which never says
how many solutions it missed.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import fsolve

from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward import families, general
from kinematics.mechanisms.five_rpur.inverse import limb_lengths
from tests.kinematics.mechanisms.five_rpur.machines import forward

CLASSES = ["a1a1", "a1a2", "a1a3", "a2a2", "a2a3", "a3a3", "mpa1", "mpa2", "mpa3"]
LENGTHS = [295.4, 348.7, 306.3, 335.8, 311.8]  # 110 real solutions of Table 1
STARTS = 300


def median(action: Callable[[], object], rounds: int = 15) -> float:
    """Seconds, the median of several rounds."""
    action()
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def verdict(value: float, floor: float, *, above: bool = False) -> str:
    return "met" if (value >= floor if above else value <= floor) else "MISSED"


def simplified() -> None:
    """The nine arrangements as the paper has them: limbs of a group stand in one working mode."""
    rng = np.random.default_rng(0)
    joints = rng.uniform(250, 400, (600, 5))
    for name in CLASSES:
        design = load_design(f"rpur-{name}")
        assert isinstance(design, FiveRPURDesign)
        groups = tuple(group.limbs for group in arrangements(design).groups)
        design = replace(design, merged_joints=groups)
        each = iter(np.tile(joints, (2, 1)))
        alone = 1e3 * median(lambda design=design, each=each: forward(design, next(each)), 200)
        rate = len(joints) / median(lambda design=design: forward(design, joints), 3)
        print(
            f"{name:8s} {alone:6.2f} ms alone ({verdict(alone, 3)}: 3 ms), "
            f"{rate:6.0f} length vectors a second ({verdict(rate, 1000, above=True)}: 1000)"
        )


def in_all_modes() -> None:
    """The same designs as they are: limbs that do not share a joint stand in any mode."""
    joints = np.random.default_rng(0).uniform(250, 400, (12, 5))
    for name in CLASSES:
        design = load_design(f"rpur-{name}")
        each = iter(np.tile(joints, (2, 1)))
        alone = 1e3 * median(lambda design=design, each=each: forward(design, next(each)), 12)
        print(f"{name:8s} {alone:6.1f} ms with all modes of the design")


def by_homotopy() -> None:
    design = load_design("rpur-table1")
    assert isinstance(design, FiveRPURDesign)
    limbs = [
        replace(limb, base=(limb.base[0], limb.base[1] + 3.0 * k, limb.base[2] - 2.0 * k))
        for k, limb in enumerate(design.limbs)
    ]
    limbs[0] = replace(limbs[0], platform=(-50.0, 8.0, 5.0))
    generic = replace(design, limbs=tuple(limbs))
    assert families.membership(generic).family.count == 1680

    def from_the_generic_start() -> None:
        general._own._sets.clear()
        (found,) = forward(generic, LENGTHS)
        assert found.complete, found.notes

    first = median(from_the_generic_start, 5)
    print(
        f"general  {first:6.2f} s, all 1680 paths from the generic start, twice "
        f"({verdict(first, 1.5)}: 1.5 s)"
    )
    again = median(lambda: forward(generic, LENGTHS), 7)
    print(f"general  {again:6.2f} s from the design's own start set")
    own = median(lambda: forward(design, LENGTHS), 7)
    print(f"Table 1  {own:6.2f} s from its own start set ({verdict(own, 0.4)}: 0.4 s)")
    (known,) = forward(design, LENGTHS)
    for change in (0.1, 1.0, 5.0):
        moved = np.array(LENGTHS) + change * np.array([1.0, -0.5, 0.3, 0.8, -1.0])
        took = median(lambda moved=moved: machine_of(design).forward.refresh(known, moved), 7)
        print(
            f"Table 1  {took:6.3f} s after a change of {change:g} mm, with identities "
            f"({verdict(took, 0.1)}: 0.1 s)"
        )
    compared(design, own, len(known))


def compared(design: FiveRPURDesign, own: float, count: int) -> None:
    rng = np.random.default_rng(1)
    poses: list[np.ndarray] = []

    def closure(pose: np.ndarray, sigma: np.ndarray) -> np.ndarray:
        both = limb_lengths(design, pose)
        return np.nan_to_num(np.where(sigma > 0, both[:, 0], both[:, 1]), nan=1e3) - LENGTHS

    begin = time.perf_counter()
    for _ in range(STARTS):
        sigma = rng.choice([-1.0, 1.0], 5)
        start = rng.uniform([-300, -100, -500, -np.pi, -np.pi], [300, 300, 500, np.pi, np.pi])
        pose, _, flag, _ = fsolve(closure, start, args=(sigma,), full_output=True)
        if flag == 1 and np.abs(closure(pose, sigma)).max() < 1e-6:
            pose[3:] = np.mod(pose[3:] + np.pi, 2 * np.pi) - np.pi
            if all(np.abs(pose - other).max() > 1e-4 for other in poses):
                poses.append(pose)
    took = time.perf_counter() - begin
    print(
        f"fsolve   {took:6.2f} s for {STARTS} random starts: {len(poses)} of {count} solutions; "
        f"{took / max(len(poses), 1) / (own / count):.0f} times the time for each"
    )


if __name__ == "__main__":
    import warnings

    warnings.simplefilter("ignore", RuntimeWarning)  # fsolve's, where it does not converge
    simplified()
    in_all_modes()
    by_homotopy()
