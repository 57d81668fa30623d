"""Machines and places that the tests of singular geometry share."""

from __future__ import annotations

import numpy as np

from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inverse import MODES, inside
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.screws.spatial import rotation_x, rotation_y
from tests.kinematics.mechanisms.five_rpur.machines import preset

TABLES = ("rpur-table1", "rpur-table1-icee", "rpur-table2")


def random_design(rng: np.random.Generator) -> FiveRPURDesign:
    """Limbs anywhere, or, in half of the cases, on a coarse lattice: with much in common."""
    lattice = rng.random() < 0.5
    limbs = []
    for _ in range(5):
        base, platform = rng.uniform(-100, 100, 3), rng.uniform(-60, 60, 3)
        if lattice:
            base, platform = np.round(base, -2), 50.0 * np.round(platform / 50.0)
        low = float(rng.choice([0.0, 50.0, 150.0, 250.0]))
        stroke = (low, low + float(rng.choice([60.0, 150.0, 300.0])))
        link = float(rng.choice([80.0, 150.0, 220.0]))
        limbs.append(Limb(tuple(base.tolist()), tuple(platform.tolist()), link, stroke))
    return FiveRPURDesign(tuple(limbs))


def random_case(seed: int) -> tuple[FiveRPURDesign, float, float, str]:
    """A design, φ, θ and a mode."""
    rng = np.random.default_rng(seed)
    design = preset(TABLES[seed % 3]) if rng.random() < 0.4 else random_design(rng)
    phi, theta = (0.0, 0.0) if rng.random() < 0.3 else rng.uniform(-1.5, 1.5, 2).tolist()
    return design, phi, theta, MODES[rng.integers(len(MODES))]


def closing_points(determinant: Determinant, count: int, seed: int) -> np.ndarray:
    """(count, 3) in x'y'z', where every limb closes, about the machine."""
    rng = np.random.default_rng(seed)
    low, high = determinant.span
    middle, size = determinant.offset.mean(axis=0), determinant.size
    points = middle + rng.uniform(-0.8 * size, 0.8 * size, (count, 3))
    points[:, 1] = rng.uniform(low, high, count)
    return points


def poses(design, phi: float, theta: float, points) -> np.ndarray:
    """(N, 5) from points (N, 3) in x'y'z'."""
    turned = np.asarray(points) @ rotation_y(theta).T
    return np.column_stack([turned, np.broadcast_to([phi, theta], (len(turned), 2))])


def held(design, phi: float, theta: float, mode: str, points) -> np.ndarray:
    """Whether points (N, 3) in x'y'z' are in the workspace of a mode."""
    return inside(design, poses(design, phi, theta, points), (mode,))


def moved_base(design: FiveRPURDesign, turn: float, shift) -> FiveRPURDesign:
    """The machine with its base turned about e1 and moved."""
    base = design.base @ rotation_y(turn).T + shift
    return FiveRPURDesign(
        tuple(
            Limb(tuple(b.tolist()), limb.platform, limb.link, limb.stroke)
            for b, limb in zip(base, design.limbs, strict=True)
        )
    )


def other_reference(design: FiveRPURDesign, shift) -> FiveRPURDesign:
    """The machine with O' moved by ``shift`` in the platform frame."""
    return FiveRPURDesign(
        tuple(
            Limb(limb.base, tuple((c - shift).tolist()), limb.link, limb.stroke)
            for c, limb in zip(design.platform, design.limbs, strict=True)
        )
    )


def turned(phi: float, theta: float) -> np.ndarray:
    return rotation_y(theta) @ rotation_x(phi)


def always_singular(design: FiveRPURDesign) -> FiveRPURDesign:
    """Two limbs at one place: in equal modes their wrenches are one."""
    one, _, three, four, five = design.limbs
    return FiveRPURDesign((one, one, three, four, five))
