"""Loci as curves: exact points, and as many crossings on every ray as P has zeros."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.answers.loci import LocusCurves
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods import loci, micr, polynomial
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind, TripodDesign, mode_sign
from tests.kinematics.mechanisms.tripods.machines import machine

MACHINES = [
    (kind, mode, ratio, height)
    for kind in KINDS
    for mode in MODES
    for ratio, height in ((2.0, 1.0), (0.5, 0.3), (1.87, 0.18), (0.62, 0.33), (1.0, 1.2))
]


def parts(found: LocusCurves) -> list[np.ndarray]:
    return [found.points[a:b] for a, b in zip(found.start, found.start[1:], strict=False)]


def crossings(found: LocusCurves, azimuth: float) -> int:
    """How often actuation curves cross a ray from the centre."""
    count = 0
    for part, kind in zip(parts(found), found.kinds, strict=True):
        if kind == "constraint":
            continue
        side, front = np.sin(part[:, 1] - azimuth), np.cos(part[:, 1] - azimuth)
        count += int(((side[1:] * side[:-1] < 0.0) & (front[1:] > 0.0)).sum())
    return count


@pytest.mark.parametrize(("kind", "mode", "ratio", "height"), MACHINES)
def test_curves_are_exact_and_none_is_missing(
    kind: Kind, mode: str, ratio: float, height: float
) -> None:
    design = TripodDesign(kind, 100.0, 100.0 * ratio, (0.0, 999.0))
    found = machine_of(design).singularities.locus(loci.ORIENTATION, (100.0 * height,), mode)
    assert found.residual.max() < 1e-6
    assert found.kinds[-1] == "constraint"
    assert found.barriers == (() if kind == "three_rps" else (0.5 * np.pi,))
    tilt = np.linspace(1e-6, np.pi - 1e-6, 3001)
    k = mode_sign(mode) * ratio
    special = kind == "three_rps" and ratio == 2.0 and mode == "1"  # a fivefold zero at 90°
    for azimuth in np.linspace(-np.pi, np.pi, 31) + 0.01:
        signs = np.sign(polynomial.value(kind, 1.0, k, height, tilt, np.sin(3.0 * azimuth)))
        zeros = int((signs[1:] != signs[:-1]).sum())
        assert crossings(found, azimuth) == zeros or special


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", MODES)
def test_the_innermost_point_is_the_micr(kind: Kind, mode: str, rng: np.random.Generator) -> None:
    for ratio, height in np.exp(rng.uniform(-1.0, 1.0, (15, 2))).tolist():
        design = TripodDesign(kind, 100.0, 100.0 * ratio, (0.0, 999.0))
        found = machine_of(design).singularities.locus(loci.ORIENTATION, (100.0 * height,), mode)
        inner = [p[:, 0].min() for p, k in zip(parts(found), found.kinds, strict=True)]
        exact = float(micr.micr(kind, 1.0, ratio, height, mode).radius)
        assert min(inner) == pytest.approx(np.pi if np.isnan(exact) else exact, abs=1e-9)


def test_points_lie_near_each_other_and_closed_curves_close() -> None:
    design = machine("three_spr", 100.0, 200.0)
    found = machine_of(design).singularities.locus(loci.ORIENTATION, (100.0,), "2")
    closed = 0
    for part in parts(found):
        flat = part[:, :1] * np.stack([np.cos(part[:, 1]), np.sin(part[:, 1])], axis=-1)
        assert np.linalg.norm(np.diff(flat, axis=0), axis=1).max() < 0.12
        closed += bool((part[0] == part[-1]).all())
    assert closed == 3  # about the centre, about it again, and the rim


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", KINDS)
def test_in_the_base_plane_every_third_azimuth_is_singular(kind: Kind, mode: str) -> None:
    found = machine_of(machine(kind)).singularities.locus(loci.ORIENTATION, (0.0,), mode)
    assert len(found.kinds) >= 7
    assert np.isfinite(found.points).all()
    assert found.residual.max() < 1e-6


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="there is no chart"):
        machine_of(machine("three_rps")).singularities.locus("plane", (1.0,), "1")
    with pytest.raises(InputError, match="finite"):
        machine_of(machine("three_rps")).singularities.locus(loci.ORIENTATION, (np.inf,), "1")
    (spec,) = machine_of(load_design("rps-3")).singularities.loci
    assert spec.polar
