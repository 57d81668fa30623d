"""Workspaces that are thin beside their machine: nothing is missed, errors say what they mean."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from kinematics.facets.solids import build_solid
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods.design import TripodDesign
from kinematics.mechanisms.tripods.limbs import limb_lengths

HOME = (0.0, 0.0, 0.0)


def built(design: TripodDesign, mode: str, resolution: str, key: str = "workspace"):
    return build_solid(machine_of(design).solids.request(key, HOME, (mode,), resolution))


def quadrature(design: TripodDesign, mode: str, repeats: int = 8) -> tuple[float, float]:
    """The chart's volume and its standard error: over random orientations, one in each field of a
    raster, the altitudes between roots of the limbs' squared lengths, which are squares of them."""
    rng = np.random.default_rng(0)
    size, far = design.base_radius + design.platform_radius, float(np.max(design.stroke))
    n, m = 160, 240
    found = []
    for _ in range(repeats):
        grid = np.stack(np.meshgrid(np.arange(n), np.arange(m), indexing="ij"), axis=-1)
        part = (grid.reshape(-1, 2) + rng.uniform(size=(n * m, 2))) / (n, m)
        tilt, azimuth = np.pi * np.sqrt(part[:, 0]), 2.0 * np.pi * part[:, 1]

        def squares(z, tilt=tilt, azimuth=azimuth):
            poses = np.stack([np.full(n * m, z), tilt, azimuth], axis=-1)
            return limb_lengths(design, poses, mode) ** 2

        below, at, above = squares(-size), squares(0.0), squares(size)
        a, b = (above + below - 2.0 * at) / (2.0 * size**2), (above - below) / (2.0 * size)
        with np.errstate(invalid="ignore"):
            ends = [
                (-b + side * np.sqrt(b * b - 4.0 * a * (at - bound**2))) / (2.0 * a)
                for bound in design.stroke
                for side in (-1.0, 1.0)
            ]
        beyond = 10.0 * (size + far)
        marks = np.concatenate(ends, axis=1)
        marks = np.sort(np.where(np.isfinite(marks), marks, beyond), axis=1)
        total = np.zeros(n * m)
        for low, high in zip(marks.T[:-1], marks.T[1:], strict=True):
            z = 0.5 * (low + high)[:, None]
            length = a * z * z + b * z + at
            low_end, high_end = np.square(design.stroke)
            inside = ((length >= low_end) & (length <= high_end)).all(axis=1) & (high < beyond)
            total += np.where(inside, high - low, 0.0)
        found.append(np.pi * (np.pi * design.platform_radius) ** 2 * total.mean())
    return float(np.mean(found)), float(np.std(found) / np.sqrt(repeats - 1.0))


@cache
def thin(seed: int) -> tuple[TripodDesign, str]:
    """A design whose strokes just hold some random pose of a mode."""
    rng = np.random.default_rng(seed)
    kind = ("three_rps", "three_spr")[rng.integers(2)]
    base = 10.0 ** rng.uniform(1.5, 3.0)
    platform = base * 10.0 ** rng.uniform(-0.5, 0.5)
    mode = "12"[rng.integers(2)]
    pose = [
        rng.uniform(0.3, 1.5) * (base + platform),
        rng.uniform(0.0, 0.6),
        rng.uniform(-3.0, 3.0),
    ]
    bare = TripodDesign(kind, base, platform, (1.0, 2.0))
    lengths = limb_lengths(bare, np.array([pose]), mode)[0]
    more = lengths.mean() * 10.0 ** rng.uniform(-4.0, -1.0)
    return TripodDesign(kind, base, platform, (lengths.min() - more, lengths.max() + more)), mode


@pytest.mark.parametrize(
    ("kind", "radii", "stroke", "right"),
    [
        ("three_rps", (500.0, 350.0), (600.0, 620.0), 27_155.0),
        ("three_rps", (200.0, 100.0), (290.0, 310.0), 28_361.0),
        ("three_rps", (200.0, 100.0), (280.0, 320.0), 229_630.0),
        ("three_spr", (100.0, 200.0), (140.0, 142.0), 164.28),
    ],
)
def test_thin_workspaces_are_found_at_every_resolution(kind, radii, stroke, right) -> None:
    design = TripodDesign(kind, *radii, stroke)
    for resolution, most in (("preview", 0.05), ("normal", 1e-3)):
        found = built(design, "2", resolution)
        assert len(found.pieces) == 8
        assert abs(found.volume - right) <= found.volume_error + 1e-4 * right
        assert found.volume_error <= most * found.volume
        assert found.watertight
    value, spread = quadrature(design, "2")
    assert abs(value - right) < 4.0 * spread


@pytest.mark.parametrize("seed", range(6))
def test_the_volume_is_within_its_error_however_thin_the_solid_is(seed: int) -> None:
    design, mode = thin(seed)
    value, spread = quadrature(design, mode)
    for resolution in ("preview", "normal"):
        found, parted = (built(design, mode, resolution, key) for key in ("workspace", "aspects"))
        assert found.volume > 0.0  # a pose is known that is inside
        assert found.watertight
        assert parted.watertight
        assert abs(found.volume - value) <= found.volume_error + 4.5 * spread
        assert abs(parted.volume - value) <= parted.volume_error + 4.5 * spread
        assert len(parted.pieces) >= len(found.pieces)
    assert found.volume_error <= 1e-3 * found.volume or "The error is" in found.note


def test_strokes_within_rounding_are_looked_at_to_the_finest_cells() -> None:
    """Cells that cannot be halved any more stay as they are, and the search goes on."""
    low, high = 182.9695813032713, 182.96958130365772
    design = TripodDesign("three_rps", 176.80926986671753, 92.751100598315, (low, high))
    for resolution in ("preview", "normal"):
        found = built(design, "2", resolution)
        assert found.watertight
        assert found.volume < 1e-9
        assert found.volume_error > 0.0  # it is not empty


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("seed", [1, 5])
def test_nothing_depends_on_the_unit(seed: int, scale: float) -> None:
    design, mode = thin(seed)
    low, high = design.stroke
    other = TripodDesign(
        design.mechanism,
        scale * design.base_radius,
        scale * design.platform_radius,
        (scale * low, scale * high),
    )
    for key in ("workspace", "aspects"):
        one, two = (built(each, mode, "preview", key) for each in (design, other))
        assert len(one.pieces) == len(two.pieces)
        assert two.volume == pytest.approx(scale**3 * one.volume, rel=1e-3)
        assert two.volume_error == pytest.approx(scale**3 * one.volume_error, rel=0.05)
        assert two.watertight


def test_plus_minus_nothing_is_proven() -> None:
    design = TripodDesign("three_spr", 100.0, 200.0, (140.0, 142.0))
    empty = built(design, "1", "preview")
    assert (empty.volume, empty.volume_error, empty.note) == (0.0, 0.0, "")
    rng = np.random.default_rng(0)
    claimed = 0
    for _ in range(12):
        low = rng.uniform(50.0, 300.0)
        design = TripodDesign("three_rps", 200.0, 100.0, (low, low + rng.uniform(0.1, 60.0)))
        found = built(design, "1", "preview")
        if found.volume + found.volume_error == 0.0:
            claimed += 1
            high = design.stroke[1]
            poses = rng.uniform((-high, 0.0, -np.pi), (high, np.pi, np.pi), (50_000, 3))
            assert not machine_of(design).inverse.inside(poses, ("1",)).any()
    assert 3 <= claimed <= 11
