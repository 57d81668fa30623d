"""Machines that the tests of the 4-SPS + 1-SPR share, and poses that satisfy the constraint."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.homotopy.study import placed
from kinematics.machine import machine_of
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign, Limb
from tests.kinematics.references import read


def reference(name: str):
    return read(f"{name}.json")


def preset() -> FourSPSSPRDesign:
    design = load_design("sps-spr")
    assert isinstance(design, FourSPSSPRDesign)
    return design


def pose_distances(design: FourSPSSPRDesign, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Between poses (n, 6) and (m, 6), (n, m) mm."""
    no_modes = [""] * max(len(one), len(other))
    return machine_of(design).forward.distances(one, no_modes, other, no_modes)


def distances(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Between the poses of roots (8, n) and (8, m), (n, m): of R and p, relative to max(1, p)."""
    a, b = placed(one), placed(other)
    apart = np.abs(a[:, :, None] - b[:, None, :]).max(axis=0)
    size = np.maximum(np.abs(a).max(axis=0)[:, None], np.abs(b).max(axis=0)[None, :])
    ratio: np.ndarray = apart / np.maximum(size, 1.0)
    return ratio


def pentagon(radius: float) -> np.ndarray:
    turns = np.radians(72.0 * np.arange(5))
    return radius * np.column_stack([np.cos(turns), np.sin(turns), np.zeros(5)])


def machine(base, platform, axis, stroke=(450.0, 800.0)) -> FourSPSSPRDesign:
    limbs = tuple(
        Limb(tuple(map(float, a)), tuple(map(float, b)), stroke)
        for a, b in zip(base, platform, strict=True)
    )
    return FourSPSSPRDesign(limbs, tuple(map(float, axis)))


def pentagons() -> FourSPSSPRDesign:
    """Base and platform two regular pentagons, n6 the tangent at B5: the samples' machine."""
    turn = np.radians(288.0)
    axis = (-np.sin(turn), np.cos(turn), 0.0)
    return machine(pentagon(400.0), pentagon(100.0), axis)


def general(seed: int = 1) -> FourSPSSPRDesign:
    """Nothing plane about it, and an axis in no particular direction."""
    rng = np.random.default_rng(seed)
    base = pentagon(400.0) + rng.normal(size=(5, 3)) * (60.0, 60.0, 50.0)
    platform = pentagon(100.0)[[1, 0, 3, 2, 4]] + rng.normal(size=(5, 3)) * (30.0, 30.0, 25.0)
    return machine(base, platform, rng.normal(size=3))


def poses(design: FourSPSSPRDesign, count: int, seed: int = 0, tilt: float = 0.5) -> np.ndarray:
    """Poses about a place above the base, (count, 6), that satisfy the constraint."""
    rng = np.random.default_rng(seed)
    found: list[tuple[float, ...]] = []
    while len(found) < count:
        pose = np.append(
            rng.uniform((-80.0, -80.0, 500.0), (80.0, 80.0, 640.0)), rng.uniform(-tilt, tilt, 3)
        )
        try:
            found.append(complete_pose(design, pose))
        except InputError:
            continue
    return np.array(found)


angles = st.floats(-3.1, 3.1)
places = st.tuples(st.floats(-400.0, 400.0), st.floats(-400.0, 400.0), st.floats(-700.0, 700.0))
