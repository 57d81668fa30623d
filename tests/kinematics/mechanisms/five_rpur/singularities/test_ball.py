"""The singularity-free ball: inside, of one sign, held from all sides, and never the larger one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.inscribed.largest import sphere
from kinematics.mechanisms.five_rpur.singularities import ball
from kinematics.mechanisms.five_rpur.singularities.aspects import aspects
from kinematics.mechanisms.five_rpur.singularities.ball import singularity_free_ball
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.mechanisms.five_rpur.singularities.nearest import nearest_singularity, zeros_near
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.mechanisms.five_rpur.singularities.cases import (
    always_singular,
    held,
    random_case,
)

TABLE_1, PHI, THETA, MODE = preset("rpur-table1"), 0.2, 0.1, "+++++"


def free(design, phi, theta, mode, ball) -> bool:
    """Whether random points of a ball are in the workspace, all on one side."""
    rng = np.random.default_rng(3)
    v = rng.normal(size=(4000, 3))
    v *= (rng.random(len(v)) ** (1 / 3) / np.linalg.norm(v, axis=1))[:, None]
    determinant = Determinant.at(design, phi, theta, mode)
    points = ball.center @ determinant.turn + 0.9999 * ball.radius * v
    values = determinant.value(points)
    sure = np.abs(values) > determinant.roundoff(points)
    return bool(held(design, phi, theta, mode, points).all()) and len(set(values[sure] > 0)) == 1


@pytest.mark.slow
@settings(max_examples=4)
@given(st.integers(0, 10**6))
def test_the_best_ball_is_free_and_no_larger_than_the_inscribed_one(seed: int) -> None:
    design, phi, theta, mode = random_case(seed)
    best = singularity_free_ball(design, phi, theta, mode)
    inscribed = sphere(design, phi, theta, (mode,))
    if best is None:
        return
    assert free(design, phi, theta, mode, best)
    assert best.radius <= inscribed.radius * 1.05 + 1e-6  # both are only the best found
    about = singularity_free_ball(design, phi, theta, mode, center=best.center)
    assert about.radius == pytest.approx(best.radius, abs=2 * best.error)


def test_it_cannot_grow_by_a_small_step() -> None:
    best = singularity_free_ball(TABLE_1, PHI, THETA, MODE)
    for step in np.concatenate([np.eye(3), -np.eye(3)]):
        there = singularity_free_ball(TABLE_1, PHI, THETA, MODE, center=best.center + step)
        assert there.radius <= best.radius + best.error


def test_about_a_point_it_is_the_nearer_of_boundary_and_singularity() -> None:
    rng = np.random.default_rng(4)
    box = aspects(TABLE_1, PHI, THETA, MODE, "preview").pieces[0].bounds
    turn = Determinant.at(TABLE_1, PHI, THETA, MODE).turn
    nearer = set()
    for center in rng.uniform(*box, (20, 3)) @ turn.T:
        wall = sphere(TABLE_1, PHI, THETA, (MODE,), center).radius
        zero = nearest_singularity(TABLE_1, [*center, PHI, THETA], MODE).distance
        ball = singularity_free_ball(TABLE_1, PHI, THETA, MODE, center=center)
        assert ball.radius == pytest.approx(min(wall, zero), abs=2 * ball.error)
        nearer.add(wall < zero if wall > 0 else None)
    assert nearer == {True, False, None}


@pytest.mark.slow
def test_in_every_piece_one_is_found_that_stays_there() -> None:
    built = aspects(TABLE_1, PHI, THETA, MODE)
    turn = Determinant.at(TABLE_1, PHI, THETA, MODE).turn
    best = singularity_free_ball(TABLE_1, PHI, THETA, MODE)
    radii = []
    for n, piece in enumerate(built.pieces):
        point = turn @ piece.centroid
        assert built.piece_at(piece.centroid) == n
        ball = singularity_free_ball(TABLE_1, PHI, THETA, MODE, piece=point)
        assert built.piece_at(ball.center @ turn) == n
        assert free(TABLE_1, PHI, THETA, MODE, ball)
        radii.append(ball.radius)
    assert max(radii) == pytest.approx(best.radius, abs=1e-3)


def test_where_there_is_none() -> None:
    always = always_singular(TABLE_1)
    assert singularity_free_ball(always, 0.0, 0.0, "+++++") is None
    assert singularity_free_ball(TABLE_1, 0.0, 0.0, "++--+") is None
    outside = singularity_free_ball(TABLE_1, 0.0, 0.0, MODE, center=(0.0, 900.0, 0.0))
    assert outside.radius == 0.0
    assert singularity_free_ball(TABLE_1, 0.0, 0.0, MODE, piece=(0.0, 900.0, 0.0)) is None
    with pytest.raises(InputError, match="not both"):
        singularity_free_ball(TABLE_1, 0.0, 0.0, MODE, center=(0, 0, 0), piece=(0, 0, 0))


def test_behind_the_shared_interface() -> None:
    center = [80.0, 100.0, 450.0]
    pose = [0.0, 0.0, 0.0, PHI, THETA]
    sections = machine_of(load_design("rpur-table1")).sections
    assert sections is not None
    found = sections.singularity_free_ball(pose, MODE, center)
    assert found.radius == singularity_free_ball(TABLE_1, PHI, THETA, MODE, center).radius > 0.0


def test_distances_from_the_singular_surface_bend_as_differences_say() -> None:
    determinant = Determinant.at(TABLE_1, PHI, THETA, MODE)
    home = np.array(machine_of(TABLE_1).home.pose[:3]) @ determinant.turn
    (points, *_) = zeros_near(determinant, home, 400.0)
    _, slope = determinant.value_and_gradient(points[:1])
    center = points[0] + 20.0 * slope[0] / np.linalg.norm(slope)
    seen = ball._Seen(determinant, points)
    here = seen(center, 5.0)
    assert here.value[0] > 1.0
    h = 0.05 * float(here.value[0])
    for axis in np.eye(3):
        up, down = (seen(center + way * h * axis, 5.0).value[0] for way in (1.0, -1.0))
        assert (up - down) / (2.0 * h) == pytest.approx(here.normal[0] @ axis, abs=2e-3)
        second = (up - 2.0 * here.value[0] + down) / h**2
        most = float(np.abs(here.bend[0]).max())
        assert second == pytest.approx(axis @ here.bend[0] @ axis, abs=0.05 * most)
