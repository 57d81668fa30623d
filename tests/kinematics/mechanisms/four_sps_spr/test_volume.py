"""The workspace with one angle giving way: its exact volume, and the solid."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.errors import InputError
from kinematics.facets.solids import build_solid
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.four_sps_spr import home, inverse, workspace
from kinematics.mechanisms.four_sps_spr.constraint import dependent_values
from tests.kinematics.mechanisms.four_sps_spr.machines import general, preset

KIND = mechanism_class("four_sps_spr")


def on_branch(design, request, points):
    """Poses (n, 6) at places (n, 3), the angle that follows on the solid's branch, NaN for none."""
    poses = np.hstack([points, np.tile(request.angles, (len(points), 1))])
    both = dependent_values(design, poses, request.index)
    poses[:, request.index] = both[:, 0 if request.side < 0 else 1]
    return poses


def held(design, request, points):
    """Which places (n, 3) the solid holds, by nothing but the inverse kinematics."""
    poses = on_branch(design, request, points)
    inside = np.isfinite(poses).all(axis=1)
    inside[inside] = machine_of(design).inverse.inside(poses[inside])
    return inside


def sampled(design, request, count: int = 200_000):
    """The volume and its standard error by points of a box, without any plane."""
    low, high = (np.array(v) for v in home.reach(design))
    points = np.random.default_rng(0).uniform(low, high, (count, 3))
    share = held(design, request, points).mean()
    box = float(np.prod(high - low))
    return share * box, box * np.sqrt(share * (1.0 - share) / count)


@pytest.mark.parametrize(
    ("design", "index", "angles"),
    [
        (preset(), 5, (0.0, 0.0, 0.0)),
        (preset(), 3, (0.0, 0.15, -0.1)),
        (general(), 4, (0.2, 0.0, 0.1)),
    ],
)
def test_the_exact_volume_is_that_of_random_points(design, index: int, angles) -> None:
    request = workspace.request_at(design, (*machine_of(design).home.pose[:3], *angles), index)
    exact, error = workspace.exact_volume(design, request, 1e-3)
    counted, doubt = sampled(design, request)
    assert abs(exact - counted) < 4.0 * doubt + error
    assert error < 2e-2 * exact


def test_the_two_branches_are_told_apart_by_the_pose() -> None:
    design = preset()
    pose = machine_of(design).home.pose
    up = workspace.request_at(design, pose, 5)
    over = workspace.request_at(design, (*pose[:5], np.pi), 5)
    assert {up.side, over.side} == {-1, 1}
    poses = on_branch(design, up, np.array([[0.0, 0.0, 560.0], [30.0, -20.0, 600.0]]))
    assert np.abs(inverse.violation(design, poses)).max() < 1e-9
    ahead = poses + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1e-6])
    assert (np.sign(inverse.violation(design, ahead)) == -up.side).all()
    assert abs(poses[0, 5]) < 1e-12


def test_the_solid_is_closed_and_states_an_error_that_holds() -> None:
    design = preset()
    pose = machine_of(design).home.pose
    exact, doubt = workspace.exact_volume(design, workspace.request_at(design, pose, 5), 1e-4)
    for resolution, most in (("preview", 1.01e-2), ("normal", 2e-3)):
        request = machine_of(design).solids.request("workspace/gamma", pose, None, resolution)
        built = build_solid(request)
        assert built.watertight
        assert len(built.pieces) == 2  # above the base and below
        assert abs(built.volume - exact) <= built.volume_error + doubt
        assert built.volume_error < most * built.volume
    assert (
        machine_of(design).solids.placement("workspace/gamma", pose).tolist() == np.eye(4).tolist()
    )


def test_requests_depend_on_what_matters_only() -> None:
    design = preset()
    pose = np.array(machine_of(design).home.pose)
    one = machine_of(design).solids.request("workspace/gamma", pose, None, "normal")
    pose[2] += 20.0
    pose[5] = 0.3
    assert machine_of(design).solids.request("workspace/gamma", pose, None, "normal") == one
    pose[3] = 0.1
    assert machine_of(design).solids.request("workspace/gamma", pose, None, "normal") != one
    with pytest.raises(InputError, match="workspace/alpha"):
        machine_of(design).solids.request("workspace", pose, None, "normal")
