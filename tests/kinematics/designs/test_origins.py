"""What a design says of itself once it is edited."""

from __future__ import annotations

from dataclasses import replace

import pytest

import kinematics as kin
from kinematics.designs.files import load_design, presets
from kinematics.designs.origins import MARK, as_edited, as_written
from kinematics.machine import machine_of

NAMES = [preset.name for preset in presets()]


def _edited(name: str) -> kin.Machine:
    machine = kin.open(name)
    field = next(f for f in machine.fields if f.label.endswith("max") or f.value > 1.0)
    return machine.edited(field.path, field.value * 0.99)


@pytest.mark.parametrize("name", NAMES)
def test_an_edited_preset_says_so_and_from_what(name: str) -> None:
    preset, told = load_design(name), as_edited(_edited(name).design)
    assert told.name == f"{name}{MARK}"
    assert told.title == f"{preset.title} (edited)"
    assert told.source.startswith(f"edited from {name};")
    assert preset.source in told.source
    again = kin.read(kin.write(machine_of(told)), name=told.name)
    assert again.design == told


@pytest.mark.parametrize("name", NAMES)
def test_no_file_claims_to_be_a_preset_with_other_numbers(name: str) -> None:
    machine = _edited(name)
    assert machine.design.source == load_design(name).source
    assert "(edited)" in kin.write(machine)
    assert kin.read(kin.write(kin.open(name)), name=name).design == load_design(name)


def test_marks_do_not_pile_up_and_go_with_what_they_mark() -> None:
    first = kin.open("rpur-table1").fields[-1]
    once = kin.open("rpur-table1").edited(first.path, first.value * 0.99)
    machine = machine_of(as_edited(once.design))
    twice = as_edited(machine.edited(first.path, first.value * 0.98).design)
    assert twice.name == f"rpur-table1{MARK}"
    assert twice.title.count("(edited)") == twice.source.count("edited from") == 1
    back = machine.edited(first.path, first.value)
    assert as_edited(back.design) == load_design("rpur-table1")


def test_a_design_of_ones_own_stays_ones_own_and_a_copy_of_a_papers_does_not() -> None:
    own = replace(_edited("rps-3").design, name="mine", title="My tripod", source="")
    assert as_edited(own) == as_written(own) == own
    copy = replace(_edited("rps-3").design, name="copy")
    assert as_written(copy) == copy  # it may well be the file that says so
    told = as_edited(copy)
    assert (told.name, told.source[:17]) == (f"copy{MARK}", "edited from copy;")
