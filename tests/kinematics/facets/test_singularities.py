"""Serial singularities from gains alone, as a mechanism without words of its own tells them."""

from __future__ import annotations

import pytest

from kinematics.designs.files import load_design
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.machine import machine_of


@pytest.mark.parametrize(
    ("name", "pose", "mode", "limbs"),
    [
        ("five-bar", (720.0, 0.0), "+-", [1]),  # limb 1 stretched
        ("five-bar", (0.0, 738.644), "+-", []),
        ("sps-spr", (0.0, 0.0, 560.0, 0.1, 0.0, 0.0), "", []),
    ],
)
def test_an_actuator_without_effect_is_told(
    name: str, pose: tuple[float, ...], mode: str, limbs: list[int]
) -> None:
    machine = machine_of(load_design(name))
    posture = machine.posture(machine.complete_pose(pose, mode), mode)
    found = SingularitiesFacet(machine.mechanism).serial(posture, 1e-6)
    assert [each.limbs for each in found] == [(limb,) for limb in limbs]
    own = [each for each in machine.singularities.at(posture) if each.kind == "serial"]
    assert [each.limbs for each in own] == [each.limbs for each in found]
