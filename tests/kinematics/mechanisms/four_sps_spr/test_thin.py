"""Solids of the 4-SPS + 1-SPR that are thin beside it, and the branch that they are of."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from kinematics.machine import machine_of
from kinematics.mechanisms.four_sps_spr import workspace
from kinematics.mechanisms.four_sps_spr.constraint import dependent_values
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import leg_lengths
from tests.kinematics.mechanisms.four_sps_spr.machines import general, preset
from tests.kinematics.mechanisms.four_sps_spr.test_volume import held


def stroked(design: FourSPSSPRDesign, lengths, more, scale: float = 1.0) -> FourSPSSPRDesign:
    """The design, ``scale`` times as large, with strokes of ± ``more`` mm about some lengths."""
    limbs = tuple(
        replace(
            limb,
            base=tuple(scale * v for v in limb.base),
            platform=tuple(scale * v for v in limb.platform),
            stroke=(scale * (length - by), scale * (length + by)),
        )
        for limb, length, by in zip(design.limbs, lengths, more, strict=True)
    )
    return replace(design, limbs=limbs)


@cache
def thin(seed: int, scale: float = 1.0):
    """A design whose strokes just hold some random pose, the request of its solid, the pose."""
    rng = np.random.default_rng(seed)
    while True:
        design = general(int(rng.integers(1000)))
        index = int(rng.integers(3, 6))
        pose = np.append(
            rng.uniform((-80.0, -80.0, 500.0), (80.0, 80.0, 640.0)), rng.uniform(-0.4, 0.4, 3)
        )
        both = dependent_values(design, pose, index)
        if np.isfinite(both).all():
            break
    pose[index] = both[rng.integers(2)]
    lengths = leg_lengths(design, pose)
    more = lengths.mean() * 10.0 ** rng.uniform(-4.0, -1.0) * rng.uniform(0.5, 1.5, 5)
    pose[:3] *= scale
    design = stroked(design, lengths, more, scale)
    return design, workspace.request_at(design, tuple(pose), index), pose


@pytest.mark.parametrize("seed", range(5))
def test_the_volume_is_within_its_error_however_thin_the_solid_is(seed: int) -> None:
    design, request, pose = thin(seed)
    assert held(design, request, pose[None, :3]).all()
    for resolution in ("preview", "normal"):
        found = workspace.build(design, request, resolution)
        assert found.watertight
        assert found.piece_at(pose[:3]) is not None or found.volume_error > 0.0
        low, high = found.mesh.vertices.min(axis=0), found.mesh.vertices.max(axis=0)
        room = 0.05 * (high - low)
        low, high = low - room, high + room
        assert (low < pose[:3]).all()
        assert (pose[:3] < high).all()
        count, box = 200_000, float(np.prod(high - low))
        points = np.random.default_rng(1).uniform(low, high, (count, 3))
        share = held(design, request, points).mean()
        spread = box * np.sqrt(share * (1.0 - share) / count)
        assert abs(found.volume - box * share) <= found.volume_error + 4.5 * spread
    assert found.volume_error <= 1e-3 * found.volume or "The error is" in found.note


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_nothing_depends_on_the_unit(scale: float) -> None:
    one, two = (workspace.build(*thin(2, s)[:2], "preview") for s in (1.0, scale))
    assert len(one.pieces) == len(two.pieces)
    assert two.volume == pytest.approx(scale**3 * one.volume, rel=1e-3)
    assert two.volume_error == pytest.approx(scale**3 * one.volume_error, rel=0.05)


def test_strokes_of_5_mm_about_a_pose() -> None:
    pose = (0.0, 0.0, 600.0, 0.0, 0.0, 0.0)
    design = stroked(preset(), leg_lengths(preset(), pose), [5.0] * 5)
    for resolution in ("preview", "normal"):
        found = workspace.build(design, workspace.request_at(design, pose, 5), resolution)
        assert abs(found.volume - 1189.17) <= found.volume_error + 0.2
        assert len(found.pieces) == 1


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_branch_is_that_of_inverse_kinematics(mirrored: bool) -> None:
    machine = machine_of(preset())
    space = machine.workspace(alpha=0.0, beta=0.0, gamma=None)
    shown = space.solid("preview")
    low, high = shown.mesh.vertices.min(axis=0), shown.mesh.vertices.max(axis=0)
    assert low[2] == pytest.approx(-653.7, abs=2.0)
    assert high[2] == pytest.approx(729.5, abs=2.0)
    assert shown.branch is not None
    assert shown.branch.gamma == pytest.approx(0.0, abs=1e-9)
    assert shown.to_dict()["branch"]["gamma_deg"] == pytest.approx(0.0, abs=1e-9)
    pose = (0.0, 0.0, 650.0, 0.0, 0.0, np.radians(132.968) if mirrored else 0.0)
    request = machine.solids.request("workspace/gamma", pose, None, "preview")
    assert (request == machine.solids.request("workspace/gamma", space.pose, None, "preview")) != (
        mirrored
    )
    assert machine.solids.branch("workspace/gamma", pose)[5] == pytest.approx(pose[5], abs=1e-4)
    (back,) = machine.solids.poses("workspace/gamma", pose, "", [pose[:3]])
    assert back == pytest.approx(pose, abs=1e-4)
