"""Design files of the 3-RPS and 3-SPR."""

from __future__ import annotations

import pytest

from kinematics.designs.files import (
    load_design,
    read_design,
    write_design,
)
from kinematics.errors import DesignError
from kinematics.machine import machine_of
from kinematics.mechanisms.tripods.design import KINDS, TripodDesign

GOOD = 'mechanism = "three_rps"\nbase_radius = 100\nplatform_radius = 50.0\nstroke = [80, 200]\n'


@pytest.mark.parametrize("kind", KINDS)
def test_a_design_reads_back(kind: str) -> None:
    design = read_design(GOOD.replace("three_rps", kind), origin="x.toml", name="x")
    assert design == TripodDesign(kind, 100.0, 50.0, (80.0, 200.0), name="x")  # type: ignore[arg-type]
    again = read_design(write_design(design), origin="x.toml", name="x")
    assert again == design
    assert hash(again) == hash(design)
    assert len(machine_of(design).fields) == 4
    assert machine_of(design).edited(("stroke", 1), 250.0).design.stroke == (80.0, 250.0)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("base_radius = 100", "base_radius = -1", "line 2: base_radius must be a positive length"),
        ("platform_radius = 50.0", "platform_radius = nan", "line 3: .*finite"),
        ("platform_radius = 50.0", "platform_radus = 50.0", "did you mean 'platform_radius'"),
        ("[80, 200]", "[200, 80]", "ρ_min < ρ_max"),
        ("[80, 200]", "[-5, 80]", "must not be negative"),
        ("[80, 200]", "[80]", "2 numbers"),
        ("base_radius = 100\n", "", "'base_radius' is missing"),
    ],
)
def test_broken_files_are_told(old: str, new: str, message: str) -> None:
    with pytest.raises(DesignError, match=message):
        read_design(GOOD.replace(old, new), origin="x.toml")


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_the_presets(name: str) -> None:
    design = load_design(name)
    assert design.mechanism == {"rps-3": "three_rps", "spr-3": "three_spr"}[name]
    assert "Nayak" in design.source
