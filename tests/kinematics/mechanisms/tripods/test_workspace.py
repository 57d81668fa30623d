"""The workspace over orientation and altitude, its aspects, and the locus as a surface."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.facets import inverse as generic
from kinematics.facets.solids import build_solid
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import chart, polynomial, workspace
from kinematics.mechanisms.tripods.columns import TripodColumns
from kinematics.mechanisms.tripods.design import mode_sign

HOME = (0.0, 0.0, 0.0)


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_the_solid_is_what_the_strokes_allow(name: str, rng: np.random.Generator) -> None:
    design = load_design(name)
    built = build_solid(machine_of(design).solids.request("workspace", HOME, ("2",), "preview"))
    assert built.watertight
    low, high = built.mesh.vertices.min(axis=0) - 1.0, built.mesh.vertices.max(axis=0) + 1.0
    points = rng.uniform(low, high, (200_000, 3))
    poses = chart.from_chart(design, points)
    inside = generic.inside(design, poses, ("2",)) & (poses[:, 1] <= np.pi)
    box = float(np.prod(high - low))
    share = inside.mean()
    spread = box * np.sqrt(share * (1.0 - share) / len(points))
    assert abs(built.volume - box * share) < built.volume_error + 4.0 * spread
    np.testing.assert_allclose(chart.to_chart(design, poses), points, atol=1e-9)
    # Vertices lie on an end of a stroke, or on the rim.
    lengths = generic.inverse(design, chart.from_chart(design, built.mesh.vertices)).joints
    off = np.abs(lengths[:, 1, :, None] - np.array(design.stroke)).min(axis=(1, 2))
    rim = np.pi - chart.from_chart(design, built.mesh.vertices)[:, 1]
    assert np.minimum(off, np.abs(rim) * design.platform_radius).max() < 1e-3


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_aspects_are_the_workspace_in_pieces_of_one_sign(name: str) -> None:
    design = load_design(name)
    whole, parted = (
        build_solid(machine_of(design).solids.request(key, HOME, ("2",), "preview"))
        for key in ("workspace", "aspects")
    )
    assert parted.watertight
    assert parted.volume == pytest.approx(whole.volume, rel=1e-5)
    assert {piece.sign for piece in parted.pieces} == {1, -1}
    k = mode_sign("2") * design.platform_radius
    statics = machine_of(design).statics
    for n, piece in enumerate(parted.pieces):
        z, tilt, azimuth = pose = chart.from_chart(design, np.array(piece.centroid))
        if parted.piece_at(piece.centroid) != n:
            continue  # its centroid is outside of it
        value = polynomial.value(
            design.mechanism, design.base_radius, k, z, tilt, np.sin(3.0 * azimuth)
        )
        determinant = float(statics.wrenches(pose, "2").determinant)
        # The determinant is the polynomial times what has one sign: −1 of a 3-RPS in mode 2.
        assert np.sign(value) == np.sign(determinant) * (-1 if name == "rps-3" else 1)
        assert np.sign(determinant) == piece.sign
    home = chart.to_chart(design, np.array(machine_of(design).home.pose))
    assert parted.piece_at(home) is not None


def test_the_locus_over_the_altitude() -> None:
    design = load_design("spr-3")
    found = workspace.locus_surface(design, "2", 20.0, 300.0, "preview")
    assert len(found.faces) > 1000
    assert found.residual.max() < 1e-6
    z, tilt, azimuth = chart.from_chart(design, found.vertices).T
    assert z.min() >= 19.0
    assert z.max() <= 301.0
    k = mode_sign("2") * design.platform_radius
    a = polynomial.in_w(design.mechanism, design.base_radius, k, z, tilt)
    value = polynomial.value(
        design.mechanism, design.base_radius, k, z, tilt, np.sin(3.0 * azimuth)
    )
    assert (np.abs(value) / np.abs(a).sum(axis=-1)).max() < 1e-6


def test_an_empty_workspace_and_what_is_refused() -> None:
    design = load_design("spr-3")
    empty = build_solid(machine_of(design).solids.request("workspace", HOME, ("1",), "preview"))
    assert empty.volume == 0.0
    assert not empty.pieces
    with pytest.raises(InputError, match="one operation mode"):
        machine_of(design).solids.request("workspace", HOME, None, "preview")
    with pytest.raises(InputError, match="there is no solid"):
        machine_of(design).solids.request("limb1/whole", HOME, ("1",), "preview")


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_what_limbs_change_over_a_cell_is_bounded(name: str, rng: np.random.Generator) -> None:
    """Of p and λ together; over small cells the bound is the slopes', and not much more."""
    design = load_design(name)
    for mode in ("1", "2"):
        columns = TripodColumns(design, mode)
        for size in (1e-4, 0.03, 0.3, 1.5):
            (low, high), (first, last) = columns.base
            middle = np.column_stack([rng.uniform(low, high, 400), rng.uniform(first, last, 400)])
            half = size * rng.uniform(0.0, 1.0, (400, 2)) * rng.integers(0, 2, (400, 2))
            bound = columns.spread(middle, half)
            p, shift = columns.limbs(middle)
            most = np.zeros_like(bound)
            shares = [*rng.uniform(-1.0, 1.0, (40, 2)), (1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0)]
            for share in np.array([*shares, (-1, 0), (0, 1), (0, -1)], dtype=float):
                there, moved = columns.limbs(middle + share * half)
                most = np.maximum(most, np.hypot(there - p, moved - shift))
            assert (most <= bound + 1e-12 * design.spherical_radius).all()
            if size < 1e-3:
                assert (bound <= 1.5 * most + 1e-2 * size**1.5 * design.spherical_radius).all()
