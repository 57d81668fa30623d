"""Limbs that are equal but for a little: closed solids, volumes within their errors, in time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from kinematics.errors import ComputationError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.offsets import merged_limbs, offset_points
from kinematics.mechanisms.five_rpur.slicing import tracing
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter
from kinematics.mechanisms.five_rpur.workspace import workspace as solids
from kinematics.solids import meshes
from tests.kinematics.mechanisms.five_rpur.machines import volume
from tests.kinematics.mechanisms.five_rpur.nearly_equal import (
    KINDS,
    Case,
    case,
    exactly,
    wrong_solids,
    wrong_volumes,
)


def alike(bases, platform) -> FiveRPURDesign:
    limbs = (Limb(tuple(base), tuple(platform), 150.0, (250.0, 400.0)) for base in bases)
    return FiveRPURDesign(tuple(limbs))


SOLID_1 = alike(
    [
        [88.69868910029652, 4.667927116894052, -86.85781299668584],
        [88.69868978941052, 4.66792516039703, -86.85781227923808],
        [88.69869134618558, 4.667926420104162, -86.85781236604608],
        [88.69869065749444, 4.667926966155238, -86.85781334424307],
        [88.69869098566188, 4.667926972925557, -86.85781311958505],
    ],
    [7.077276992605093, 0.5943258201586659, 34.113251613333375],
)
SOLID_2 = alike(
    [
        [-33.211778911460414, 99.99715487663929, -44.28457585644053],
        [-33.21178097480278, 99.99716049118773, -44.28457720778796],
        [-33.21178288862826, 99.99715560080224, -44.28456920928891],
        [-33.21178888381703, 99.99715985462095, -44.284569910543695],
        [-33.21177931191141, 99.99715840749512, -44.284567476379145],
    ],
    [55.86391685528851, 20.936608496084162, -18.01706809419734],
)
ENDLESS = alike(
    [
        [48.88743470972301, -49.176388979108786, -45.21103847184673],
        [48.88743470990357, -49.176388978714265, -45.21103847144769],
        [48.887434709261264, -49.17638897963399, -45.211038472024754],
        [48.88743470977011, -49.1763889788919, -45.21103847274067],
        [48.88743471022439, -49.17638897968498, -45.21103847252004],
    ],
    [9.739951842881538, 43.72422425556813, 45.69936315552415],
)


@pytest.mark.parametrize(
    ("design", "phi"), [(SOLID_1, 2.518555884813399), (SOLID_2, -118.80045507301857)]
)
def test_solids_that_once_leaked_are_closed(design, phi):
    this = Case(0, design, np.radians(phi), 0.0, None, "base", 1e-8)
    assert list(wrong_solids(this, [*KINDS, ("fine", "facets")], exactly(this))) == []


def test_a_volume_that_once_had_no_end_ends():
    this = Case(0, ENDLESS, np.radians(630.0), np.pi, None, "base", 1e-12)
    exact = exactly(this)
    assert exact[0] == pytest.approx(159_552_177, rel=2e-6)
    assert list(wrong_volumes(this, exact)) == []


@pytest.mark.parametrize("seed", range(16))
def test_a_sweep_over_nearly_equal_limbs_finds_nothing_wrong(seed):
    this = case(seed)
    exact = exactly(this)
    assert [*wrong_volumes(this, exact), *wrong_solids(this, KINDS, exact)] == []


def test_the_sections_that_pieces_take_are_bounded_in_number(monkeypatch):
    """However much seems to be alone: here everything is, whatever the distance of sections."""
    cutter = Cutter(ENDLESS, 0.3, 0.2, None)
    x = np.linspace(*cutter.range, 40)
    taken = []
    runs = Cutter.runs

    def unlike(self, at):
        found = runs(self, at)
        taken.append(len(at))
        found.tells[:] = np.arange(len(found.tells)) + sum(taken)  # no two are built alike
        found.marks[found.marks != 0] = np.arange(np.count_nonzero(found.marks)) + 1 + sum(taken)
        found.spans[:] = np.arange(len(found.spans))[:, None] + 1e6 * sum(taken)  # nor overlap
        return found

    monkeypatch.setattr(Cutter, "runs", unlike)
    cutter.pieces(x, np.ones((len(x), 2)))
    assert 2 < len(taken) <= tracing.BETWEEN + 1
    assert len(x) < sum(taken) <= (1 + tracing.MOST) * len(x) + tracing.FEW


# --- what limbs are merged by ----------------------------------------------------------------


@pytest.mark.parametrize("seed", range(40))
def test_surfaces_are_moved_no_farther_than_told(seed):
    this = case(seed)
    same = 10.0 ** -(3 + seed % 6)
    merged = merged_limbs(this.design, this.phi, this.theta, same)
    w = offset_points(this.design, this.phi, this.theta)
    u, v = np.random.default_rng(seed).normal(size=(2, 500, 1, 3))
    u, v = (a / np.linalg.norm(a, axis=-1, keepdims=True) for a in (u, v))
    for end in range(2):
        before = w + this.design.stroke[:, end, None] * u + this.design.link[:, None] * v
        after = merged.offset + merged.stroke[:, end, None] * u + merged.link[:, None] * v
        way = np.linalg.norm(after - before, axis=-1).max()
        assert way <= merged.moved * (1.0 + 1e-9) + 1e-13 * np.abs(w).max()
    size = float((this.design.link + this.design.stroke[:, 1]).min())
    assert merged.moved <= 4.0 * (np.sqrt(3.0) + 2.0) * same * size
    assert (merged.stroke[:, 0] < merged.stroke[:, 1]).all()


def test_limbs_that_are_merged_boldly_cost_an_error_that_holds(monkeypatch):
    """Half a thousandth of the limbs' size: far more than facets are off by."""
    apart = 0.25
    design = FiveRPURDesign(
        tuple(
            Limb((apart * n, 0.0, apart * n), (0.0,) * 3, 150.0, (250.0, 400.0)) for n in range(5)
        )
    )
    exact = volume(design, 0.0, 0.0, relative=1e-8, pieces=False).value
    plain = solids.workspace(design, 0.0, 0.0, resolution="fine")
    monkeypatch.setattr(solids, "_MERGED", (1e-3,))
    bold = solids.workspace(design, 0.0, 0.0, resolution="fine")
    assert abs(plain.volume - exact) <= plain.volume_error
    assert abs(bold.volume - exact) <= bold.volume_error
    assert abs(bold.volume - exact) > plain.volume_error  # which would not have held
    true = solids.workspace(design, 0.0, 0.0, surface="true")
    moved = merged_limbs(design, 0.0, 0.0, 1e-3).moved
    assert moved <= true.residual <= moved + 1e-6


# --- what leaks all the same -----------------------------------------------------------------


def leaking(monkeypatch, times: float) -> list[int]:
    """Let the next so many surfaces seem open; returns what is asked."""
    asked: list[int] = []

    def looks_closed(v, f):
        asked.append(len(f))
        return len(asked) > times

    monkeypatch.setattr(meshes, "closed_by_position", looks_closed)
    return asked


def test_where_a_solid_leaks_more_is_merged(monkeypatch):
    asked = leaking(monkeypatch, 2)
    design = alike([[n * 2e-4, n * 3e-3, 0.0] for n in range(5)], (0.0, 0.0, 0.0))
    built = solids.workspace(design, 0.1, 0.2, resolution="preview")
    assert len(asked) == 3
    exact = volume(design, 0.1, 0.2, pieces=False)
    assert abs(built.volume - exact.value) <= built.volume_error


def test_merging_that_merges_no_more_is_not_tried_again(monkeypatch):
    asked = leaking(monkeypatch, np.inf)
    far = alike([[100.0 * n, 10.0 * n * n, 0.0] for n in range(5)], (0.0, 0.0, 0.0))
    with pytest.raises(ComputationError):
        solids.workspace(far, 0.0, 0.0, resolution="preview")
    assert len(asked) == 1


def test_a_solid_that_leaks_is_refused_and_never_written(monkeypatch, tmp_path: Path, capsys):
    leaking(monkeypatch, np.inf)
    path = tmp_path / "solid.stl"
    assert main(["workspace", "rpur-table1", "--resolution", "preview", "-o", str(path)]) == 1
    told = capsys.readouterr()
    assert told.out == ""
    assert "could not be closed" in told.err
    assert told.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
