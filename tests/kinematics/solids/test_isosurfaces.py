"""Isosurfaces: closed, exact, and as large as they should be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.solids.csg import Solid
from kinematics.solids.isosurfaces import positive_part


def ball(points):
    """1 − |p|² and its gradient."""
    return 1.0 - (points**2).sum(axis=-1), -2.0 * points


def on_grid(axes, field=ball):
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    return field(nodes.reshape(-1, 3))[0].reshape(nodes.shape[:-1])


def test_a_ball_is_closed_exact_and_of_its_volume() -> None:
    errors = []
    for count in (12, 24):
        axes = [np.linspace(-1.2, 1.3, count)] * 3
        found = positive_part(axes, on_grid(axes), ball)
        solid = Solid.from_mesh(found.vertices, found.faces)
        assert found.on_zero.all()
        assert len(solid.shells()) == 1
        assert np.abs(np.linalg.norm(found.vertices, axis=1) - 1.0).max() < 1e-11
        assert found.residual.max() < 1e-11
        errors.append(4.0 / 3.0 * np.pi - solid.volume)
    assert 0.0 < errors[1] < 0.3 * errors[0]
    assert errors[1] < 0.015


def test_faces_look_outwards_and_are_well_shaped() -> None:
    axes = [np.linspace(-1.2, 1.2, 17)] * 3  # nodes lie on the sphere
    found = positive_part(axes, on_grid(axes), ball)
    a, b, c = (found.vertices[found.faces[:, n]] for n in range(3))
    normal = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normal, a + b + c) > 0.0).all()
    sides = np.linalg.norm(np.concatenate([b - a, c - b, a - c]), axis=1)
    assert sides.min() > 0.05 * (axes[0][1] - axes[0][0])


def test_sides_of_the_box_close_what_it_cuts() -> None:
    axes = [np.linspace(-0.5, 2.0, 26), np.geomspace(1.0, 4.0, 30) - 2.5, np.linspace(-2, 2, 33)]
    found = positive_part(axes, on_grid(axes), ball)
    solid = Solid.from_mesh(found.vertices, found.faces)
    whole, cap = 4.0 / 3.0 * np.pi, np.pi * 0.5**2 * (3.0 - 0.5) / 3.0
    assert solid.volume == pytest.approx(whole - cap, rel=0.01)
    side = found.vertices[found.faces[~found.on_zero]][:, :, 0]
    assert side == pytest.approx(-0.5, abs=1e-3)
    assert np.isfinite(found.residual).sum() == np.unique(found.faces[found.on_zero]).size


def test_nan_is_outside() -> None:
    axes = [np.linspace(-1.2, 1.2, 25)] * 3
    values = on_grid(axes)
    values[:12] = np.nan
    found = positive_part(axes, values, ball)
    volume = Solid.from_mesh(found.vertices, found.faces).volume  # half, and half a cell more
    assert volume == pytest.approx(2.0 / 3.0 * np.pi + 0.05 * np.pi, rel=0.01)
    assert found.vertices[:, 0].min() == pytest.approx(axes[0][11] + 0.05)


def test_nothing_positive_has_no_faces() -> None:
    axes = [np.linspace(2.0, 3.0, 5)] * 3
    assert not len(positive_part(axes, on_grid(axes), ball).faces)


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_any_signs_at_the_nodes_make_a_closed_manifold(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(2, 8, 3))
    values = rng.choice([-1.0, -1e-9, 0.0, 1e-12, 2.0, np.nan], shape)
    axes = [np.cumsum(rng.uniform(0.1, 1.0, n)) for n in shape]

    def flat(points):  # as good as no information about the function
        return np.zeros(len(points)), np.zeros_like(points)

    found = positive_part(axes, values, flat)
    solid = Solid.from_mesh(found.vertices, found.faces)  # raises unless closed and oriented
    assert solid.volume >= 0.0
    assert (solid.volume > 0.0) == bool((values >= 0.0).any())


def test_grids_that_are_none_are_refused() -> None:
    good = np.arange(3.0)
    with pytest.raises(InputError, match="three increasing axes"):
        positive_part([good, good, good[::-1]], np.zeros((3, 3, 3)), ball)
    with pytest.raises(InputError, match="shape"):
        positive_part([good] * 3, np.zeros((3, 3, 4)), ball)
    with pytest.raises(InputError, match="infinite"):
        positive_part([good] * 3, np.full((3, 3, 3), np.inf), ball)
