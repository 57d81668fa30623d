"""A set called complete is complete and closes, whatever the machine's size and its lengths."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.homotopy.assembly_sets import CLOSES, not_closed
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import posing
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind, TripodDesign
from kinematics.mechanisms.tripods.limbs import limb_lengths


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("radius", "stroke", "lengths"),
    [
        (1e6, (1e-9, 0.956), (0.47795, 0.47795, 0.47795)),
        (1e6, (1e-9, 0.956), (0.47, 0.48, 0.5)),
        (100.0, (0.0, 1.04e-5), (5.2e-6, 5.2e-6, 5.2e-6)),
        (100.0, (0.0, 1.04e-5), (5.2e-6, 4.9e-6, 5.5e-6)),
    ],
)
def test_limbs_of_a_millionth_of_the_machine_are_solved_to_their_own_size(
    kind: Kind, radius: float, stroke: tuple[float, float], lengths: tuple[float, ...]
) -> None:
    found = machine_of(TripodDesign(kind, radius, radius, stroke)).forward(list(lengths))
    assert found.complete
    assert found.complex_count == 16
    assert len(found) == 8  # near level, where all limbs are as they please
    assert (found.multiplicity == 1).all()
    assert found.residual.max() < 1e-9 * min(lengths)


def machines(rng: np.random.Generator) -> tuple[TripodDesign, float]:
    """A machine of 1e-6 to 1e6 mm, and what part of it its motions are; also with equal radii."""
    size, part = 10.0 ** rng.uniform(-6, 6), 1.0
    first, second = size * 10.0 ** rng.uniform(-1.5, 1.5, 2)
    if rng.random() < 0.5:
        part = 10.0 ** rng.uniform(-8, 0)
        second = first * (1.0 + 0.1 * part * rng.normal() * (rng.random() < 0.5))
    kind = KINDS[int(rng.integers(2))]
    return TripodDesign(kind, float(first), float(second), (1e-9 * size, 1e9 * size)), part


@pytest.mark.parametrize("seed", range(8))
def test_poses_of_machines_of_any_size_are_found_or_the_set_is_not_complete(seed: int) -> None:
    rng = np.random.default_rng(seed)
    whole = 0
    for _ in range(25):
        design, part = machines(rng)
        size = max(design.base_radius, design.platform_radius)
        tilt = abs(rng.normal()) * part if part < 1.0 else rng.uniform(0.05, 3.0)
        pose = np.array([size * rng.normal() * part, tilt, rng.uniform(-3.1, 3.1)])
        mode = MODES[int(rng.integers(2))]
        lengths = limb_lengths(design, pose, mode)
        if not (np.isfinite(lengths) & (lengths > 0.0)).all():
            continue
        found = machine_of(design).forward(lengths.tolist())
        off = np.inf
        same = [n for n, other in enumerate(found.modes) if other == mode]
        if same:
            there = posing.transform(design, found.poses[same], mode)
            apart = np.abs(there - posing.transform(design, pose, mode))
            apart[:, :3, 3] /= size
            off = float(apart.max(axis=(1, 2)).min())
        assert off < 1e-5 or not found.complete, (design, pose, mode, found.notes)
        if found.complete:
            whole += 1
            assert found.residual.max(initial=0.0) <= CLOSES * min(size, lengths.min())
        else:
            assert found.notes
    assert whole > 15


def test_what_does_not_close_is_not_complete() -> None:
    """Limbs that no pose in double precision can have: said, and not counted as whole."""
    for kind in KINDS:
        design = TripodDesign(kind, 1e6, 0.7e6, (1e-12, 1e6))
        pose = np.array([3e5, 0.4, 0.3])
        lengths = limb_lengths(design, pose, "2")
        assert machine_of(design).forward(lengths.tolist()).complete
        short = TripodDesign(kind, 1e6, 1e6, (1e-12, 1e6))
        found = machine_of(short).forward([1e-9, 1.1e-9, 0.9e-9])
        assert not found.complete or found.residual.max(initial=0.0) <= CLOSES * 0.9e-9


def test_residuals_are_judged_by_the_machine_and_by_the_shortest_length() -> None:
    residual = np.array([1e-9, 3e-8])
    assert not_closed(residual, 100.0, np.array([50.0, 0.5])) == ()
    assert not_closed(residual, 0.1, np.array([50.0, 0.5]))
    (said,) = not_closed(residual, 100.0, np.array([50.0, 1e-3]))
    assert "off by up to 3e-08 mm" in said
    assert not_closed(np.zeros(0), 100.0, np.array([1.0])) == ()
