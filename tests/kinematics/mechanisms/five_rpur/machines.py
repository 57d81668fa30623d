"""Designs, and how far postures are apart, for all tests of the 5-RPUR."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from kinematics.answers.sections import MapCells, Section, Volume
from kinematics.answers.solutions import ForwardSolutions, Posture
from kinematics.designs.files import load_design
from kinematics.facets.sections import Modes
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.design import MODES, FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.following import Following
from kinematics.mechanisms.five_rpur.maps import Maps
from kinematics.mechanisms.five_rpur.mechanism import FiveRPUR
from kinematics.mechanisms.five_rpur.sections import Sections

MODE_SIGNS = {mode: mode.sigma for mode in MODES}
"""σ_i of every working mode."""


def signature(u: np.ndarray) -> np.ndarray:
    """One number a configuration (10, n), the same only for the same; conjugates have conjugate
    ones."""
    turns = u[3:5]
    values = np.concatenate([u[:3], turns + 1.0 / turns, 1j * (1.0 / turns - turns), u[5:]])
    numbers: np.ndarray = np.cos(1.7 * np.arange(len(values)) + 0.4) @ values
    return numbers


def preset(name: str, *, merged: bool = False) -> FiveRPURDesign:
    """A preset; as if none of its U joints were merged, so that it has all 32 modes."""
    design = load_design(name)
    assert isinstance(design, FiveRPURDesign)
    return design if merged else replace(design, merged_joints=())


def made(base: Any, platform: Any, link: Any) -> FiveRPURDesign:
    """Five limbs with long strokes."""
    one, two, three, four, five = (
        Limb(tuple(map(float, a)), tuple(map(float, c)), float(length), (1.0, 1000.0))
        for a, c, length in zip(base, platform, link, strict=True)
    )
    return FiveRPURDesign((one, two, three, four, five))


def following(design: FiveRPURDesign) -> Following:
    """The facet, with what it has of its own."""
    return Following(FiveRPUR(design))


def forward(
    design: FiveRPURDesign, joints: Any, *, mixed_modes: bool = False
) -> tuple[ForwardSolutions, ...]:
    """All assembly modes at one vector of lengths or at several."""
    rows = joints if isinstance(joints, str) else np.reshape(joints, (-1, np.shape(joints)[-1]))
    return machine_of(design).forward(rows, mixed_modes=mixed_modes)


def _sections(design: FiveRPURDesign) -> Sections:
    return Sections(FiveRPUR(design))


def section(
    design: FiveRPURDesign, phi: float, theta: float, at: float, modes: Modes = None
) -> Section:
    """One section, by the orientation alone."""
    return _sections(design).at((0.0, 0.0, 0.0, phi, theta), modes, at)


def sections(
    design: FiveRPURDesign, phi: float, theta: float, at: Any, modes: Modes = None
) -> tuple[Section, ...]:
    """Several sections."""
    return tuple(section(design, phi, theta, x, modes) for x in at)


def section_range(
    design: FiveRPURDesign, phi: float, theta: float, modes: Modes = None
) -> tuple[float, float] | None:
    """Where sections can be, by the orientation alone."""
    return _sections(design).range((0.0, 0.0, 0.0, phi, theta), modes)


def volume(
    design: FiveRPURDesign, phi: float, theta: float, modes: Modes = None, **wanted: Any
) -> Volume:
    """The volume, by the orientation alone."""
    return _sections(design).volume((0.0, 0.0, 0.0, phi, theta), modes, **wanted)


def map_cells(
    design: FiveRPURDesign, poses: Any, modes: Modes, quantities: Any, **wanted: Any
) -> MapCells:
    """What a map shows at some poses."""
    return Maps(FiveRPUR(design)).cells(poses, modes, quantities, **wanted)


def of_forward_case(case: Any) -> FiveRPURDesign:
    """The machine of a case of rpur_forward.json, which has no strokes."""
    rows = zip(case["r"], case["s_prime"], case["l"], strict=True)
    return FiveRPURDesign(tuple(Limb(tuple(r), tuple(s), l_, (250.0, 400.0)) for r, s, l_ in rows))


def of_volume_case(case: Any) -> FiveRPURDesign:
    """The machine of a case of volumes.json."""
    rows = zip(case["r"], case["s"], case["l"], case["rho_min"], case["rho_max"], strict=True)
    return FiveRPURDesign(tuple(Limb(tuple(r), tuple(s), l_, (a, b)) for r, s, l_, a, b in rows))


def distance(one: Posture, two: Posture) -> float:
    """mm; angles at 100 mm."""
    gap = np.subtract(one.pose, two.pose)
    gap[3:] = (gap[3:] + np.pi) % (2 * np.pi) - np.pi
    return float(np.abs(gap * [1, 1, 1, 100, 100]).max())
