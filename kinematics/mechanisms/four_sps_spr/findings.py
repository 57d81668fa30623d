"""What is worth knowing about a design: layouts that are singular, and what cannot be reached."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kinematics.answers.solutions import Finding, Severity
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.home import home
from kinematics.mechanisms.four_sps_spr.statics import legs, matrix, sizes

SINGULAR = 1e-9
"""Smallest singular value of G, relative to the largest, below which a layout is singular."""
ILL = 1e-4
"""The same below which home is said to be close to singular."""
PLANAR = 1e-9  # of the machine's size: points that lie in a plane
_SAMPLES = 24


@lru_cache(maxsize=64)
def findings(design: FourSPSSPRDesign) -> tuple[Finding, ...]:
    """Warnings about singular layouts and empty workspaces, and what kind of layout it is."""
    start = home(design)
    answer: list[Finding] = []

    def tell(severity: Severity, title: str, text: str, limbs: tuple[int, ...] = ()) -> None:
        answer.append(Finding(severity, title, text, limbs))

    ranks = _ranks(design, _sampled(design, level=False))
    level = _ranks(design, _sampled(design, level=True))
    here = _ranks(design, np.array([start.pose]))
    if ranks.size and ranks.max() < 6:
        tell(
            "warning",
            "Architecturally singular",
            f"The wrench matrix has rank {ranks.max()} at every pose: the legs and the "
            "constraint cannot hold the platform anywhere. Move base or platform points.",
        )
    elif level.size and level.max() < 6 and not any(start.pose[3:]):
        tell(
            "warning",
            "Singular at home",
            f"The wrench matrix has rank {level.max()} whenever the platform is parallel to "
            "the base, so the machine cannot be controlled there"
            + _pentagons(design)
            + "; tilt the platform, or use another layout.",
        )
    elif here.size and here.max() < 6:
        tell(
            "warning",
            "Singular at home",
            f"The wrench matrix has rank {here.max()} at the home posture, where the machine "
            "cannot be controlled; move base or platform points.",
        )
    elif _ratio(design, np.array([start.pose]))[0] < ILL:
        tell(
            "warning",
            "Close to singular at home",
            "The wrench matrix is nearly singular at the home posture: small loads there take "
            "large leg forces; move base or platform points.",
        )
    if not start.reachable:
        tell(
            "warning",
            "Out of reach",
            "No posture within all strokes was found: the workspace is empty or very small. "
            + " ".join(reason.text for reason in start.reasons[:1]),
            tuple(reason.limb for reason in start.reasons),
        )
    planes = [
        name
        for name, points in (("base", design.base), ("platform", design.platform))
        if _planar(points)
    ]
    if len(planes) == 2:
        tell(
            "info",
            "Planar base and platform",
            "Base and platform points each lie in a plane, so every assembly mode has a mirror "
            "image in the plane of the base where the revolute axis lies in the platform's.",
        )
    return tuple(answer)


def _pentagons(design: FourSPSSPRDesign) -> str:
    both = all(_regular(points) for points in (design.base, design.platform))
    return " (base and platform are two regular pentagons)" if both else ""


def _regular(points: Array) -> bool:
    """The points are a regular pentagon in this order, or in that of a pentagram."""
    around = points - points.mean(axis=0)
    size = float(np.linalg.norm(around, axis=1).max())
    if size == 0.0 or not _planar(points):
        return False
    sides = np.linalg.norm(around - np.roll(around, 1, axis=0), axis=1)
    radii = np.linalg.norm(around, axis=1)
    return bool(np.ptp(sides) < 1e-6 * size and np.ptp(radii) < 1e-6 * size)


def _planar(points: Array) -> bool:
    around = points - points.mean(axis=0)
    sizes = np.linalg.svd(around, compute_uv=False)
    return bool(sizes[2] <= PLANAR * max(float(sizes[0]), 1e-300))


def _sampled(design: FourSPSSPRDesign, *, level: bool) -> Array:
    """Poses that satisfy the constraint, about home, the same each time."""
    rng = np.random.default_rng(0)
    start = np.array(home(design).pose)
    poses = []
    for _ in range(_SAMPLES):
        pose = start + design.length * np.append(rng.normal(size=3), np.zeros(3))
        pose[3:] = 0.0 if level else rng.uniform(-0.7, 0.7, size=3)
        try:
            poses.append(complete_pose(design, tuple(pose)))
        except InputError:  # there is none at this orientation
            continue
    return np.array(poses).reshape(-1, 6)


def _ratio(design: FourSPSSPRDesign, poses: Array) -> Array:
    values = sizes(matrix(legs(design, poses)), design.length)
    return np.asarray(values[:, -1] / np.maximum(values[:, 0], 1e-300))


def _ranks(design: FourSPSSPRDesign, poses: Array) -> np.ndarray:
    """(n,) of G at poses (n, 6)."""
    if not len(poses):
        return np.zeros(0, dtype=int)
    values = sizes(matrix(legs(design, poses)), design.length)
    return np.asarray((values > SINGULAR * values[:, :1]).sum(axis=1))
