"""How distances change as a box's faces or a ball's centre move: exact against differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.inscribed import balls, boxes
from kinematics.mechanisms.five_rpur.inscribed.contacts import Contacts, contacts
from kinematics.mechanisms.five_rpur.inscribed.largest import sphere
from kinematics.mechanisms.five_rpur.inscribed.region import Region
from tests.kinematics.mechanisms.five_rpur.inscribed.test_inscribed import case_with_room


def followed(near: Contacts, found: Contacts, reach: float) -> Array:
    """The values of contacts among those of a body moved a little, NaN of what is not there."""
    values = np.full(len(near.value), np.nan)
    for n in range(len(values)):
        same = np.flatnonzero((found.tube == near.tube[n]) & (found.piece == near.piece[n]))
        away = np.linalg.norm(found.point[same] - near.point[n], axis=1)
        if away.min(initial=np.inf) < reach:
            values[n] = found.value[same[away.argmin()]]
    return values


def differences(value: Callable[[Array], Array], count: int, h: float) -> tuple[Array, Array]:
    """First derivatives (N, count) and unmixed second ones, from values (N,) at moves."""
    steps = h * np.eye(count)
    up, down = (np.stack([value(way * e) for e in steps], axis=1) for way in (1.0, -1.0))
    return (up - down) / (2.0 * h), (up - 2.0 * value(np.zeros(count))[:, None] + down) / h**2


@pytest.mark.parametrize("seed", range(2, 4))
def test_distances_from_the_faces_of_a_box(seed: int) -> None:
    design, phi, theta, modes = case_with_room(seed)
    room, region = sphere(design, phi, theta, modes), Region.at(design, phi, theta, modes)
    half = room.radius * np.array([0.4, 0.3, 0.25])
    corners = np.array(room.center) + np.stack([-half, half])
    corners, near = boxes.fitted(region, corners, 0.3 * room.radius)
    pushes, bend = boxes._pushes(region, corners, near, np.arange(len(near.value)))

    def value(move: Array) -> Array:
        probe = boxes._Faces(region, corners + move.reshape(2, 3))
        return followed(near, contacts(region, probe, 0.6 * room.radius), 0.05 * room.radius)

    first, second = differences(value, 6, 2e-3 * room.radius)
    assert np.isfinite(first).all()
    np.testing.assert_allclose(pushes, first, rtol=0, atol=1e-5)
    bends = bend.diagonal(axis1=1, axis2=2)
    np.testing.assert_allclose(bends * room.radius, second * room.radius, rtol=0, atol=4e-3)


@pytest.mark.parametrize("seed", range(2, 4))
def test_distances_from_the_centre_of_a_ball(seed: int) -> None:
    design, phi, theta, modes = case_with_room(seed)
    room, region = sphere(design, phi, theta, modes), Region.at(design, phi, theta, modes)
    center = np.array(room.center) + 0.2 * room.radius * np.array([0.5, -0.7, 0.4])
    radius, near = balls.clearance(region, center, 0.5 * room.radius)
    assert near is not None
    use = np.arange(len(near.value))
    away = center - near.point
    bend = balls._bend(region, near, use, away)

    def value(move: Array) -> Array:
        found = contacts(region, balls._Centre(region, center + move), 0.9 * room.radius)
        return followed(near, found, 0.2 * room.radius)

    first, second = differences(value, 3, 2e-3 * room.radius)
    assert np.isfinite(first).all()
    np.testing.assert_allclose(away / near.value[:, None], first, rtol=0, atol=1e-5)
    inner = (near.at > 1e-6) & (near.at < np.pi - 1e-6)  # at a tube's end the foot stays
    bends = bend.diagonal(axis1=1, axis2=2)[inner]
    np.testing.assert_allclose(bends * room.radius, second[inner] * room.radius, rtol=0, atol=4e-3)

    # A step of small reach is the best of all within it, and gives what it promises.
    reach = 0.02 * radius
    none = balls.Obstacles(np.empty(0), np.empty((0, 3)), np.empty((0, 3, 3)))
    move, hoped, _ = balls._ball_step(region, center, near, none, radius, reach)
    there, _ = balls.clearance(region, center + move, 0.0)
    assert there == pytest.approx(hoped, abs=2e-4 * radius)
    tried = np.random.default_rng(seed).uniform(-reach, reach, (30, 3))
    best = max(balls.clearance(region, center + each, 0.0)[0] for each in tried)
    assert there >= min(best, radius + reach) - 2e-4 * radius  # it gains no more than its reach
