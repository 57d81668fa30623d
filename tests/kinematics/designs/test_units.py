"""Design files in other units are the designs that they are in mm."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from decimal import Decimal

import pytest

import kinematics as kin
from kinematics.designs.files import load_design, presets, read_design, write_design
from kinematics.errors import DesignError
from kinematics.lengths import UNITS, from_mm, in_mm, unit_of
from kinematics.mechanism import mechanism_class

NAMES = [
    preset.name
    for preset in presets()
    if (schema := mechanism_class(preset.mechanism).schema).keys or schema.limb_keys
]
"""Of kinds whose lengths are known by their keys."""


def _in(unit: str, name: str) -> str:
    """A preset's file with all lengths in another unit, as a person would write them."""
    keys = mechanism_class(load_design(name).mechanism).schema
    lengths = {key.name for key in (*keys.keys, *keys.limb_keys) if key.unit == "mm"}
    lines = []
    for line in write_design(load_design(name)).split("\n"):
        key, _, value = line.partition(" = ")
        if key in lengths:
            value = re.sub(r"-?\d[\d.e+-]*", lambda m: f"{Decimal(m[0]) / UNITS[unit]:.20f}", value)
        lines.append(f"{key} = {value}" if value else line)
    return f'units = "{unit}"\n' + "\n".join(lines)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("name", NAMES)
def test_a_file_in_another_unit_is_the_same_design(name: str, unit: str) -> None:
    design = load_design(name)
    again = read_design(_in(unit, name), origin="x.toml", name=name)
    values = zip(kin.open(name).fields, kin.read(_in(unit, name)).fields, strict=True)
    assert all(b.value == pytest.approx(a.value, rel=1e-15, abs=1e-15) for a, b in values)
    if unit in ("mm", "cm", "m"):
        assert again == design


@pytest.mark.parametrize(
    ("unit", "text", "mm"),
    [("m", "0.57", 570.0), ("m", "0.28", 280.0), ("cm", "4.35", 43.5), ("inch", "0.1", 2.54)],
)
def test_lengths_are_rounded_once(unit: str, text: str, mm: float) -> None:
    assert in_mm(float(text), unit) == mm
    assert from_mm(mm, unit) == float(text)


def test_what_is_written_is_in_mm_and_says_so() -> None:
    machine = kin.read(_in("inch", "five-bar"), name="five-bar")
    text = write_design(machine.design)
    assert "lengths in mm" in text.split("\n")[0]
    assert "units" not in tomllib.loads(text)
    assert kin.read(text, name=machine.design.name).design == machine.design


BAR = 'mechanism = "five_bar"\nproximal = 0.48\ndistal = 0.48\nhalf_base = 0.24\n'


def test_angles_stay_degrees_and_directions_directions() -> None:
    bar = kin.read(f'units = "m"\n{BAR}joint_range_deg = [-30, 150]\n')
    assert bar.design.limbs[0].joint_range_deg == (-30.0, 150.0)
    assert bar.design.half_base == 240.0
    axis = load_design("sps-spr").revolute_axis  # type: ignore[attr-defined]
    assert read_design(_in("m", "sps-spr"), origin="").revolute_axis == axis  # type: ignore[attr-defined]


@pytest.mark.parametrize("said", ['"in"', '"inches"', '"INCH"', '" inch "'])
def test_an_inch_has_many_names(said: str) -> None:
    assert kin.read(f"units = {said}\n{BAR}").design.half_base == pytest.approx(0.24 * 25.4)


@pytest.mark.parametrize("said", ['"feet"', '""', "3", "true", "[]", '["mm"]', "{a = 1}", "1e400"])
def test_an_unknown_unit_is_refused_with_the_known_ones(said: str) -> None:
    with pytest.raises(DesignError, match=r"line 1: units must be one of 'mm', 'cm', 'm', 'inch'"):
        read_design(f"units = {said}\n{BAR}", origin="x.toml")


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("0.48", "1e308", 1),
        lambda text: text.replace("0.48", "1" + "0" * 400, 1),
        lambda text: text.replace("0.48", "nan", 1),
        lambda text: text.replace("0.48", '"long"', 1),
        lambda text: text.replace("0.48", "[0.48]", 1),
        lambda text: text.replace("0.24", "-0.24", 1),
        lambda text: text.replace("0.24", "true", 1),
        lambda text: text + "limb = 3\n",
    ],
)
@pytest.mark.parametrize("unit", UNITS)
def test_what_is_wrong_stays_wrong_in_every_unit(change: Callable[[str], str], unit: str) -> None:
    with pytest.raises(DesignError) as caught:
        read_design(change(f'units = "{unit}"\n{BAR}'), origin="x.toml")
    assert "\n" not in str(caught.value)


def test_a_length_out_of_range_says_that_it_is_told_in_mm() -> None:
    with pytest.raises(DesignError, match="the file's lengths are in m, told here in mm"):
        read_design(f'units = "m"\n{BAR}'.replace("0.24", "-0.24"), origin="x.toml")


def test_names_of_units() -> None:
    assert [unit_of(name) for name in ("mm", "In", '"', "metre", None)] == [
        "mm",
        "inch",
        "inch",
        "",
        "",
    ]
