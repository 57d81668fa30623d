"""The posture a review starts from: reachable, and free to move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.designs.files import load_design, presets
from kinematics.homotopy.continuation import Tracer
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.home import DRIVES, PIECES, home, reach
from kinematics.mechanisms.five_rpur.inverse import inside

NAMES = [p.name for p in presets() if p.mechanism == "five_rpur"]


@pytest.mark.parametrize("name", NAMES)
def test_every_actuator_can_be_moved_both_ways(name: str) -> None:
    design = load_design(name)
    start = home(design)
    assert start.reachable
    assert start.pose[2] > design.base[:, 2].max()
    for i in range(5):
        for direction in (-1.0, 1.0):
            joints = list(start.joints)
            joints[i] += 3.0 * direction
            followed = machine_of(design).following.follow(start, joints)
            assert followed.stop == "target", (i, direction, followed.text)


@pytest.mark.parametrize("name", NAMES)
def test_limbs_that_share_a_platform_point_stand_alike(name: str) -> None:
    design = load_design(name)
    mode = home(design).mode
    pairs = [p for group in arrangements(design).groups for p in group.pairs if p.kind == "A1"]
    assert all(mode[p.limbs[0] - 1] == mode[p.limbs[1] - 1] for p in pairs)


@pytest.mark.parametrize("name", NAMES)
def test_the_reach_holds_every_pose_that_can_be_held(name: str) -> None:
    design = load_design(name)
    low, high = reach(design)
    rng = np.random.default_rng(5)
    poses = np.concatenate(
        [rng.uniform(-700, 700, (100_000, 3)), rng.uniform(-np.pi, np.pi, (100_000, 2))], axis=1
    )
    held = poses[inside(design, poses), :3]
    assert len(held) > 50
    assert (held >= low).all()
    assert (held <= high).all()


def test_a_machine_that_reaches_nothing_still_has_a_place_to_start() -> None:
    def limb(x: float) -> Limb:
        return Limb((x, 0.0, 0.0), (0.0, 0.0, 0.0), 50.0, (100.0, 120.0))

    design = FiveRPURDesign((limb(-5e3), limb(0.0), limb(5e3), limb(9e3), limb(1e4)))
    start = home(design)
    assert not start.reachable
    assert np.isfinite(start.pose).all()


@pytest.mark.slow
def test_a_machine_that_is_nearly_singular_everywhere_has_a_home_soon(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Every drive of such a machine takes thousands of proven pieces, and there are thousands."""
    design = load_design("rpur-mpa2")
    one, two, three, four, five = (
        replace(limb, base=tuple(np.array(design.limbs[0].base) + 1e-4 * n), stroke=(250.0, 400.0))
        for n, limb in enumerate(design.limbs)
    )
    nearly = replace(design, limbs=(one, two, three, four, five), merged_joints=())
    taken = []

    def counted(self, level):
        taken.append(level)
        return advance(self, level)

    advance = Tracer.advance
    monkeypatch.setattr(Tracer, "advance", counted)
    assert home(nearly).reachable
    assert len(taken) <= DRIVES * (PIECES + 1)
