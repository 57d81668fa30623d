"""Long random walks: no step leads to another assembly mode. Judged by the full solution set."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinematics.answers.solutions import ForwardSolutions, Posture
from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import distance, following, forward, preset

SMALL, LARGE = 0.3, 60.0  # mm, of the moves


def roomy(name: str) -> FiveRPURDesign:
    """The preset with strokes that let walks go far."""
    design = preset(name)
    assert isinstance(design, FiveRPURDesign)
    one, two, three, four, five = (replace(limb, stroke=(30.0, 900.0)) for limb in design.limbs)
    return replace(design, limbs=(one, two, three, four, five))


def determinant(design: FiveRPURDesign, at: Posture) -> float:
    length = design.length
    return float(np.linalg.det(wrench_matrix(design, at.pose, at.mode, length=length)))


def members(design: FiveRPURDesign, found: ForwardSolutions) -> list[Posture]:
    pairs = zip(found.poses.tolist(), found.modes, strict=True)
    return [posture(design, tuple(pose), mode) for pose, mode in pairs]


def beginning(design: FiveRPURDesign, rng: np.random.Generator) -> Posture:
    while True:
        everyone = members(design, forward(design, rng.uniform(250, 400, 5))[0])
        regular = [p for p in everyone if abs(determinant(design, p)) > 1e-3]
        if regular:
            return regular[rng.integers(len(regular))]


def walk(design: FiveRPURDesign, start: Posture, moves: int, rng: np.random.Generator) -> int:
    """Some moves on; how many of them reached their target, and were found in the full set."""
    sign = np.sign(determinant(design, start))
    here, reached = start, 0
    for _ in range(moves):
        size = SMALL * (LARGE / SMALL) ** rng.uniform()
        goal = np.clip(np.add(here.joints, size * rng.normal(size=5)), 40.0, 890.0)
        end = following(design).follow(here, goal)
        assert end.stop in ("target", "singularity")
        there = end.posture
        assert there.residual < 1e-10
        # No singularity was passed; the way back leads back, small steps lead there as well.
        assert np.sign(determinant(design, there)) == sign
        back = following(design).follow(there, here.joints)
        assert back.stop == "target"
        exact = 1e-8 / min(1.0, abs(determinant(design, there)))
        assert distance(back.posture, here) < 1e-6
        small = here
        for part in np.arange(1, 21) / 20:
            joints = (1 - part) * np.array(here.joints) + part * np.array(there.joints)
            small = following(design).follow(small, joints).posture
        if end.stop == "singularity":
            # Short of it by a little in one go, by a little more in 20 steps.
            assert distance(small, there) < 0.05
            break
        reached += 1
        np.testing.assert_allclose(there.joints, goal, rtol=0, atol=1e-9)
        assert distance(small, there) < exact
        assert small.mode == there.mode
        found = forward(design, there.joints)[0]
        assert found.complete
        everyone = members(design, found)
        gaps = [distance(there, other) for other in everyone]
        nearest = int(np.argmin(gaps))
        assert gaps[nearest] < exact
        assert everyone[nearest].mode == there.mode
        here = there
    return reached


NAMES = ["rpur-a1a2", "rpur-a2a3", "rpur-a3a3", "rpur-mpa2", "rpur-mpa3"]


@pytest.mark.parametrize("name", [*NAMES, "rpur-table1", "rpur-table1-icee"])
def test_walks_stay_in_the_set(name: str) -> None:
    """In whatever modes: limbs of an arrangement that is not merged may stand in different ones."""
    design, rng = roomy(name), np.random.default_rng(21)
    reached = 0
    while reached < 3:
        reached += walk(design, beginning(design, rng), 2, rng)
