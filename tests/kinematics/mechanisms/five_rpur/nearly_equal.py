"""Designs whose limbs are equal but for a little, and a sweep over what is made of them.

The suite takes a few (`test_nearly_equal`); by hand as many as one likes:

    PYTHONPATH=. python tests/kinematics/mechanisms/five_rpur/nearly_equal.py 0 1000 fine aspects
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kinematics.errors import ComputationError
from kinematics.facets.solids import Resolution, SurfaceKind
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.singularities.aspects import aspects
from kinematics.mechanisms.five_rpur.slicing import integral
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter, prepare
from kinematics.mechanisms.five_rpur.workspace.workspace import workspace
from tests.kinematics.mechanisms.five_rpur.machines import section, volume

FAMILIES = ("base", "platform", "link", "stroke", "all", "axis", "touching", "roles")
LONGEST = 20.0
"""s of processor time that anything may take."""


@dataclass(frozen=True)
class Case:
    """A design, an orientation (rad) and modes; ``apart``: what limbs are apart, of their size."""

    seed: int
    design: FiveRPURDesign
    phi: float
    theta: float
    modes: tuple[str, ...] | None
    family: str
    apart: float


def case(seed: int) -> Case:
    """Two to five limbs that are equal but for 1e-12 … 1e-3 of their size, of any size."""
    r = np.random.default_rng(seed)
    family = FAMILIES[seed % len(FAMILIES)]
    scale = 10.0 ** float(r.choice([0, 0, 0, -6, -3, 3, 6]))
    apart = 10.0 ** r.uniform(-12.0, -3.0)
    same = int(r.integers(2, 6))
    link = float(r.choice([150.0, r.uniform(20.0, 400.0)]))
    low = float(r.choice([250.0, 0.0, r.uniform(0.0, 500.0)]))
    high = low + float(r.choice([150.0, r.uniform(5.0, 400.0)]))
    base, platform = r.uniform(-100.0, 100.0, 3), r.uniform(-100.0, 100.0, 3)
    if r.random() < 0.2:
        base = np.round(base, -1)
    little = apart * (link + high)
    limbs = []
    for i in range(5):
        b, p, length, stroke = base.copy(), platform.copy(), link, [low, high]
        change = r.uniform(-little, little, 9)
        if i >= same:
            b += r.uniform(-150.0, 150.0, 3)
            p += r.uniform(-50.0, 50.0, 3)
            length = float(r.choice([link, r.uniform(0.5, 1.5) * link]))
            stroke = [low * r.uniform(0.5, 1.0), high * r.uniform(1.0, 1.5)]
        if family == "axis":
            b[r.integers(3)] += r.choice([-little, 0.0, little])
        if family == "touching" and i == same - 1:
            # The last one stands where its solid and the others' touch, give or take a little.
            way = [2.0 * high, 2.0 * link, 2.0 * (high + link), high - low, high + low]
            b[r.integers(3)] += r.choice(way) + change[0]
        if family == "roles" and i == same - 1:
            # Its shortest stroke is the others' longest, or its link their stroke.
            if r.random() < 0.5:
                stroke = [max(0.0, high + change[0]), high + 150.0]
            else:
                length = max(low, 1.0) + abs(change[0])
        if family in ("base", "all"):
            b += change[:3]
        if family in ("platform", "all"):
            p += change[3:6]
        if family in ("link", "all"):
            length += float(r.choice([-little, 0.0, little, change[6]]))
        if family in ("stroke", "all"):
            stroke = [max(0.0, stroke[0] + change[7]), stroke[1] + change[8]]
        limbs.append(
            Limb(
                tuple((b * scale).tolist()),
                tuple((p * scale).tolist()),
                length * scale,
                (float(stroke[0] * scale), float(stroke[1] * scale)),
            )
        )
    one, two, three, four, five = (limbs[i] for i in r.permutation(5))
    square = [0.0, np.pi / 2.0, np.pi, 3.5 * np.pi]
    phi, theta = (float(r.choice([*square, *r.uniform(-np.pi, np.pi, 4)])) for _ in range(2))
    signs = ["".join(r.choice(["+", "-"], 5)) for _ in range(int(r.integers(1, 6)))]
    modes = None if r.random() < 0.5 else tuple(dict.fromkeys(signs))
    return Case(
        seed, FiveRPURDesign((one, two, three, four, five)), phi, theta, modes, family, apart
    )


def wrong_solids(
    this: Case, kinds: list[tuple[Resolution, SurfaceKind]], exact: tuple[float, float]
) -> Iterator[str]:
    """What is wrong with the solids: not closed, or a volume outside its error."""
    for resolution, surface in kinds:
        name = f"{this.seed} {this.family} {this.apart:.0e} {resolution} {surface}"
        begun = time.process_time()
        try:
            built = workspace(this.design, this.phi, this.theta, this.modes, resolution, surface)
        except ComputationError as error:
            yield f"{name}: refused, {error}"
            continue
        if time.process_time() - begun > LONGEST:
            yield f"{name}: took {time.process_time() - begun:.0f} s"
        if not closed(built.mesh.vertices, built.mesh.faces):
            yield f"{name}: leaks"
        if not abs(built.volume - exact[0]) <= built.volume_error + exact[1]:
            yield f"{name}: {built.volume:g} ± {built.volume_error:g}, not {exact[0]:g}"


def closed(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Every edge is there once in either direction, vertices being known by their places in single
    precision."""
    _, place = np.unique(vertices.astype(np.float32), axis=0, return_inverse=True)
    corners = place.reshape(-1)[faces]
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    forth, back = start * len(vertices) + end, end * len(vertices) + start
    once = len(np.unique(forth)) == len(forth)
    return once and bool((np.sort(forth) == np.sort(back)).all()) and bool((start != end).all())


def wrong_volumes(this: Case, exact: tuple[float, float]) -> Iterator[str]:
    """What is wrong with volumes, their pieces and sections."""
    name = f"{this.seed} {this.family} {this.apart:.0e}"
    cutter = Cutter(this.design, this.phi, this.theta, this.modes)
    low, high = cutter.range
    unseen = 2.0 * integral.UNSEEN * (high - low) * cutter.size**2
    for relative in (1e-2, 1e-4, 1e-6):
        begun = time.process_time()
        found = volume(this.design, this.phi, this.theta, this.modes, relative=relative)
        if time.process_time() - begun > LONGEST:
            yield f"{name}: volume took {time.process_time() - begun:.0f} s"
        if not abs(found.value - exact[0]) <= found.error + exact[1]:
            yield f"{name}: {found.value:g} ± {found.error:g}, not {exact[0]:g}"
        enough = found.sections > 10_000  # no volume is worth more
        if not enough and found.error > 1.01 * relative * found.value + unseen > unseen:
            yield f"{name}: wanted {relative:g}, got {found.error / found.value:g}"
        if found.pieces and not abs(sum(found.pieces) / found.value - 1.0) < 1e-9:
            yield f"{name}: pieces {found.pieces} of {found.value:g}"
    for share in (0.02, 0.3, 0.5, 0.61, 0.97) if low < high else ():
        at = low + share * (high - low)
        cut = section(this.design, this.phi, this.theta, at, this.modes)
        area = cutter.cut(np.array([at])).moments[0, 0]
        size = cutter.size**2
        if abs(cut.area - area) > 1e-12 * size or abs(cut.loop_area.sum() - area) > 1e-9 * size:
            yield f"{name}: section at {share} {cut.area:g}, {area:g}, {cut.loop_area.sum():g}"


def exactly(this: Case) -> tuple[float, float]:
    """The volume and its error, from many more sections."""
    found = volume(this.design, this.phi, this.theta, this.modes, relative=1e-8, pieces=False)
    return found.value, found.error


KINDS: list[tuple[Resolution, SurfaceKind]] = [
    ("preview", "facets"),
    ("normal", "facets"),
    ("normal", "true"),
]


def main(first: int, last: int, *more: str) -> None:
    prepare()
    kinds = [*KINDS]
    if "fine" in more:
        kinds += [("fine", "facets"), ("fine", "true")]
    begun, found, slowest = time.process_time(), 0, (0.0, 0)
    for seed in range(first, last):
        start = time.process_time()
        this = case(seed)
        exact = exactly(this)
        wrong = [*wrong_volumes(this, exact), *wrong_solids(this, kinds, exact)]
        if "aspects" in more:
            for mode in (this.modes or ("+++++",))[:1]:
                try:
                    built = aspects(this.design, this.phi, this.theta, mode, "preview")
                    if not built.watertight:
                        wrong.append(f"{seed}: aspects leak")
                except ComputationError as error:
                    if "every pose" not in str(error):
                        wrong.append(f"{seed} aspects: {error}")
        for line in wrong:
            print(line, flush=True)
        found += len(wrong)
        slowest = max(slowest, (time.process_time() - start, seed))
    took = time.process_time() - begun
    print(f"{last - first} designs in {took:.0f} s, {found} faults; slowest {slowest}")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:])
