"""Design files of five-bars: what they may say, and what is refused."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

from kinematics.designs.files import load_design, read_design, write_design
from kinematics.errors import DesignError, InputError
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_bar.design import FiveBarDesign

PLAIN = 'mechanism = "five_bar"\nproximal = 480\ndistal = [300.0, 350.0]\nhalf_base = 240.0\n'
M = mechanism_class("five_bar")


def read(text: str) -> FiveBarDesign:
    found = read_design(text, origin="here.toml")
    assert isinstance(found, FiveBarDesign)
    return found


def test_one_number_or_two() -> None:
    design = read(PLAIN)
    assert design.proximal.tolist() == [480.0, 480.0]
    assert design.distal.tolist() == [300.0, 350.0]
    assert not design.limited
    assert np.isinf(design.joint_range).all()


@pytest.mark.parametrize(
    ("written", "ranges"),
    [
        ("[-30, 210]", [(-30.0, 210.0), (-30.0, 210.0)]),
        ("[[-30, 210], [0, 90]]", [(-30.0, 210.0), (0.0, 90.0)]),
        ("[[], [0, 90]]", [None, (0.0, 90.0)]),
    ],
)
def test_ranges(written: str, ranges: list[tuple[float, float] | None]) -> None:
    design = read(f"{PLAIN}joint_range_deg = {written}\n")
    assert [limb.joint_range_deg for limb in design.limbs] == ranges
    assert read(write_design(design)) == design


def test_the_preset_is_the_paper_s_and_reads_back() -> None:
    design = load_design("five-bar")
    assert isinstance(design, FiveBarDesign)
    assert [*design.proximal, *design.distal, design.half_base] == [480, 480, 480, 480, 240]
    again = read_design(write_design(design), origin="", name=design.name)
    assert again == design
    assert hash(again) == hash(design)


def test_fields_change_one_number() -> None:
    design = read(f"{PLAIN}joint_range_deg = [[-30, 210], [0, 90]]\n")
    fields = machine_of(design).fields
    assert len(fields) == 9
    assert len({field.path for field in fields}) == 9
    for field in fields:
        value = field.value + (0.1 if field.unit == "rad" else 1.0)
        changed = machine_of(design).edited(field.path, value).design
        (now,) = (f.value for f in machine_of(changed).fields if f.path == field.path)
        assert now == pytest.approx(value, abs=1e-13)
        others = [f for f in machine_of(changed).fields if f.path != field.path]
        assert others == [f for f in fields if f.path != field.path]
    with pytest.raises(InputError, match="no number"):
        machine_of(design).edited(("distal", 2), 1.0)
    with pytest.raises(DesignError, match="full turn"):
        machine_of(design).edited(("joint_range_deg", 1, 1), radians(-1.0))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("proximal = 480", "proximal = 0"), "line 2: proximal must be a positive length"),
        (("350.0]", "-350.0]"), "line 3: distal: number 2 must be a positive length"),
        (("350.0]", "350.0, 1]"), "distal must have 2 numbers"),
        (("half_base = 240.0", "half_base = nan"), "half_base must be a finite number"),
        (("half_base = 240.0", ""), "the key 'half_base' is missing"),
        (("half_base", "half_bas"), "unknown key 'half_bas'; did you mean 'half_base'"),
        (("half_base = 240.0", "half_base = true"), "half_base must be a number"),
        (("\nproximal", "\njoint_range_deg = [20, 10]\nproximal"), "min < max"),
        (("\nproximal", "\njoint_range_deg = [0, 360]\nproximal"), "less than a full turn"),
        (("\nproximal", "\njoint_range_deg = 7\nproximal"), "must be [min, max]"),
    ],
)
def test_mistakes_are_one_sentence(change: tuple[str, str], said: str) -> None:
    with pytest.raises(DesignError) as refusal:
        read(PLAIN.replace(*change))
    assert said in str(refusal.value)
    assert str(refusal.value).startswith("here.toml")


def test_findings() -> None:
    (empty,) = (
        f
        for f in machine_of(read(PLAIN.replace("240.0", "900"))).findings
        if f.severity == "warning"
    )
    assert "no common place" in empty.text
    titles = {finding.title for finding in machine_of(load_design("five-bar")).findings}
    assert titles == {
        "Limb 1 folds onto its base",
        "Limb 2 folds onto its base",
        "Equal distal links",
    }


def test_a_joint_range_can_be_given_narrowed_and_taken_away() -> None:
    free = load_design("five-bar")
    fields = {f.path: f.value for f in machine_of(free).fields}
    assert fields["joint_range_deg", 0, 0] == pytest.approx(-np.pi)
    assert fields["joint_range_deg", 1, 1] == pytest.approx(np.pi)
    held = machine_of(free).edited(("joint_range_deg", 0, 1), np.radians(150.0)).design
    assert held.limbs[0].joint_range_deg == (-180.0, 150.0)
    assert held.limbs[1].joint_range_deg is None
    assert machine_of(held).edited(("joint_range_deg", 0, 1), np.pi).design == free
