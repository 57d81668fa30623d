"""MICR: the stored table, the paper's figures, a brute-force scan, and what the paper claims."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.facets import circles
from kinematics.mechanisms.tripods import micr, polynomial
from kinematics.mechanisms.tripods.design import KINDS, MODES, Kind, mode_sign
from tests.kinematics.mechanisms.tripods.machines import NAMES, stored

STORED = stored("micr_table.json")
RATIOS = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
HEIGHTS = np.linspace(0.05, 4.0, 80)


def tables() -> dict[Kind, np.ndarray]:
    """Degrees (2, 8, 80) of both machines; 180 where no tilt is singular."""
    found = {}
    for kind in KINDS:
        radius = circles.micr(kind, 1.0, np.array(RATIOS)[:, None], HEIGHTS).radius
        found[kind] = np.where(np.isnan(radius), 180.0, np.degrees(radius))
    return found


@pytest.mark.parametrize("row", STORED["table"], ids=lambda t: f"{t['mech']}-{t['mode']}-{t['h2']}")
def test_the_stored_table(row: dict) -> None:
    found = micr.micr(NAMES[row["mech"]], row["h1"], row["h2"], row["Z"], str(row["mode"]))
    degrees = np.where(np.isnan(found.radius), 180.0, np.degrees(found.radius))
    off = np.abs(degrees - row["micr_deg"])
    # At Z = h1/2 a 3-SPR has a threefold zero at 90°: the stored value has five digits there.
    threefold = (row["mech"] == "SPR") & (np.abs(np.array(row["Z"]) - 0.5 * row["h1"]) < 1e-9)
    assert off[~threefold].max() < 1e-8
    assert (off[threefold] < 1e-3).all()


@pytest.mark.parametrize("case", STORED["anchors"], ids=lambda a: f"{a['mech']}-{a['mode']}")
def test_the_papers_example(case: dict) -> None:
    found = micr.micr(NAMES[case["mech"]], case["h1"], case["h2"], case["Z"], str(case["mode"]))
    assert np.degrees(found.radius) == pytest.approx(case["micr_deg"], abs=1e-11)
    assert found.contact == pytest.approx(case["contact_sin3phi"])
    assert float(micr.as_printed(found.radius)) == pytest.approx(case["paper_style"], abs=1e-7)


def test_what_the_paper_prints_is_its_grid_and_its_pi() -> None:
    one, two = circles.micr("three_spr", 1.0, 2.0, 1.0).radius
    assert np.degrees(one) == pytest.approx(25.180332377705, abs=1e-11)
    assert np.degrees(two) == pytest.approx(30.0, abs=1e-12)
    printed = circles.micr("three_spr", 1.0, 2.0, 1.0).printed
    assert [f"{value:.2f}" for value in printed] == ["25.22", "30.38"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("mode", MODES)
def test_a_brute_force_scan_finds_nothing_else(
    kind: Kind, mode: str, rng: np.random.Generator
) -> None:
    count, step = 60, np.pi / 900
    ratio, height = np.exp(rng.uniform(-1.6, 1.6, count)), np.exp(rng.uniform(-3.0, 2.0, count))
    found = micr.micr(kind, 1.0, ratio, height, mode)
    tilt, w = np.arange(1, 900) * step, np.linspace(-1.0, 1.0, 201)
    for n in range(count):
        a = polynomial.in_w(kind, 1.0, mode_sign(mode) * ratio[n], height[n], tilt)[:, None, :]
        value = a[..., 0] + w * (a[..., 1] + w * (a[..., 2] + w * a[..., 3]))
        other = (np.sign(value) != np.sign(value[0, 0])).any(axis=1)
        first = tilt[other.argmax()] if other.any() else np.pi
        exact = np.pi if np.isnan(found.radius[n]) else found.radius[n]
        # The scan sees it at the next tilt, or two later where it only just begins to cross.
        assert -1e-9 < first - exact < 2.5 * step


def test_interior_tangencies_count() -> None:
    """RPS mode 1 is met first inside the range of w, which w = ± 1 alone misses."""
    ratio = np.linspace(1.0, 1.5, 200)
    found = micr.micr("three_rps", 1.0, ratio, 3.0, "1")
    inner = np.abs(found.contact) < 0.999
    assert inner.any()
    at, w, ratio = found.radius[inner], found.contact[inner], ratio[inner]
    a = polynomial.in_w("three_rps", 1.0, -ratio, 3.0, at)
    slope = a[:, 1] + 2.0 * w * a[:, 2]
    assert (np.abs(slope) / np.abs(a).sum(axis=1)).max() < 1e-7
    for end in (1.0, -1.0):
        assert (np.abs(polynomial.value("three_rps", 1.0, -ratio, 3.0, at, end)) > 1e-6).all()


def test_what_the_comparison_shows() -> None:
    """The facts, whatever the paper claims of them."""
    found = tables()
    rps, spr = found["three_rps"], found["three_spr"]
    assert (spr[1] >= spr[0] - 1e-3).all()  # SPR: mode 2 is never smaller (90° to five digits)
    assert spr[0].max() == pytest.approx(131.2, abs=0.1)  # "0 to 130° in mode 1"
    ones = RATIOS.index(1.0)
    assert (spr[1, ones, HEIGHTS >= 1.0] == 180.0).all()  # no singularity at all
    assert rps.max() < 90.0
    assert np.abs(rps[0] - rps[1]).max() > 12.0  # "rarely any difference" does not hold
    larger = [n for n, ratio in enumerate(RATIOS) if ratio > 1.0]
    smaller = spr[:, larger] < rps[:, larger]  # "3-SPR has the larger MICR" does not hold
    assert smaller.any()
    assert HEIGHTS[np.where(smaller.any(axis=(0, 1)))].max() < 2.5
    barred = circles.micr("three_spr", 1.0, np.array(RATIOS)[:, None], HEIGHTS).barred
    assert (barred == (spr > 90.0)).all()
    assert not circles.micr("three_rps", 1.0, np.array(RATIOS)[:, None], HEIGHTS).barred.any()


@given(
    kind=st.sampled_from(KINDS),
    mode=st.sampled_from(MODES),
    ratio=st.sampled_from([0.25, 0.5, 1.0, 1.0 + 1e-9, 2.0, 2.0 - 1e-7, 5.0]),
    height=st.sampled_from([1e-3, 0.25, 0.5 - 1e-8, 0.5, 0.5 + 1e-10, 1.0, 1.0 + 1e-7, 2.0, 40.0]),
)
def test_special_ratios_and_heights(kind: Kind, mode: str, ratio: float, height: float) -> None:
    """P keeps its sign before the radius found, also where several of its zeros coincide."""
    found = micr.micr(kind, 1.0, ratio, height, mode)
    radius = np.pi if np.isnan(found.radius) else float(found.radius)
    tilt = np.linspace(0.0, max(radius - 1e-4, 0.0), 200)[:, None]
    tilt = tilt[np.abs(tilt[:, 0] - 0.5 * np.pi) > 1e-3]
    value = polynomial.value(
        kind, 1.0, mode_sign(mode) * ratio, height, tilt, np.linspace(-1.0, 1.0, 41)
    )
    assert (np.sign(value) == np.sign(value[0, 0])).all()


def test_scale_and_sign_of_the_altitude_do_not_matter() -> None:
    one = micr.micr("three_spr", 1.0, 1.3, 0.7, "1")
    other = micr.micr("three_spr", 250.0, 325.0, -175.0, "1")
    assert float(one.radius) == pytest.approx(float(other.radius), abs=1e-14)


def test_constraint_singularities_never_limit_it() -> None:
    assert micr.constraint_micr("1") == micr.constraint_micr("2") == pytest.approx(np.pi)


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="altitude must not be 0"):
        micr.micr("three_rps", 1.0, 1.0, 0.0, "1")
    with pytest.raises(InputError, match="base radius must be positive"):
        micr.micr("three_rps", -1.0, 1.0, 1.0, "1")
    with pytest.raises(InputError, match="finite"):
        micr.micr("three_rps", 1.0, np.nan, 1.0, "1")
    with pytest.raises(InputError, match="has no maximum inscribed"):
        circles.micr("five_rpur", 1.0, 1.0, 1.0)


@pytest.mark.parametrize("contact", [-1.0, -0.7, -1e-3, 0.0, 0.4, 1.0])
def test_contacts_are_all_azimuths_of_their_sine_once(contact: float) -> None:
    found = np.array(micr.contact_azimuths(contact))
    assert len(found) == (3 if abs(contact) == 1.0 else 6)
    assert (np.diff(found) > 0.1 * (1.0 - abs(contact)) ** 0.5 + 1e-9).all()
    assert (found > -np.pi).all()
    assert (found <= np.pi).all()
    np.testing.assert_allclose(np.sin(3.0 * found), contact, atol=1e-14 + 1e-8 * abs(contact))


def test_a_table_tells_the_azimuths_of_its_contacts() -> None:
    found = circles.micr("three_rps", 1.0, np.array([0.5, 1.3, 2.0])[:, None], [0.3, 0.8, 2.5])
    for n, mode in enumerate(MODES):
        one = micr.micr("three_rps", 1.0, np.array([0.5, 1.3, 2.0])[:, None], [0.3, 0.8, 2.5], mode)
        np.testing.assert_allclose(np.sin(3.0 * found.contact[n]), one.contact, atol=1e-7)
        assert (np.abs(found.contact[n]) <= np.pi / 6.0 + 1e-12)[np.isfinite(one.contact)].all()


def test_a_root_at_a_tilt_of_a_half_turn_is_none() -> None:
    """By rounding q of that root is a little more than 1 here, and there is no such tilt."""
    found = micr.micr("three_spr", 1.0, 0.9997873936585564, 0.15490446164737828, "2")
    assert float(found.radius) == pytest.approx(0.155564, abs=1e-6)
    assert float(found.contact) == -1.0
