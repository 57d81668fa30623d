"""What every command answers on every preset: the form of its JSON, units in keys, one sentence."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.jobs import executors
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.conformance.machines import PRESETS
from tests.conftest import Finished, refused

Run = Callable[..., Finished]

SCALE = {"mm": 1.0, "rad": degrees(1.0)}

UNIT = r"(mm|mm2|mm3|mm4|deg|s|N|Nmm|rad|percent)(_per_s2?)?"
# What has no unit: counts, shares, ratios and measures without dimension.
PLAIN = {
    *("complex_count", "condition", "conditioning", "degree", "determinant", "deviation", "digits"),
    *("direction", "done", "edges", "expected_count", "group", "heights", "holes", "identity"),
    *("largest", "limb", "limbs", "locus_unplaced", "loop_pieces", "measure", "multiplicity"),
    *("pieces", "pieces_error", "points", "ratios", "real_count", "residual", "sections", "share"),
    *("sign", "smallest_singular_value", "surface_unplaced", "tolerance", "triangles"),
}
# Named by the contract, with units said there: mm (degrees have a key that says so).
AGREED = {
    *("bounds", "center", "from", "joints", "radius", "seconds", "to", "transform", "x", "y", "z"),
}
# What came first, and what says the same with its unit.
FORMER = {
    "rates": "pose_rates",
    "accelerations": "pose_accelerations",
    "joint_rates": "actuator_rates",
    "joint_accelerations": "actuator_accelerations",
    "v": "v_mm_per_s",
    "a": "a_mm_per_s2",
    "value": "unit",
}


def unnamed(data: Any, key: str = "") -> Iterator[str]:
    """The keys under which numbers stand that have a unit, or may have one, and do not say it."""
    if isinstance(data, dict):
        for name, value in data.items():
            if not has_whole_name(name, data):
                yield from unnamed(value, key if re.search(rf"_{UNIT}$", key) else name)
    elif isinstance(data, list):
        for each in data:
            yield from unnamed(each, key)
    elif not isinstance(data, bool | str | None):
        told = re.search(rf"_{UNIT}$", key) or key in PLAIN | AGREED
        yield from () if told else (key,)


def has_whole_name(key: str, within: Mapping[str, Any]) -> bool:
    """Whether the same is said in the same object under a key that names its unit."""

    def bare(name: str) -> str:
        return re.sub(r"_(mm|N|Nmm|s|rad)(?=_per_s|$)", "", name)

    whole = [name for name in within if name != key and bare(name) == bare(key)]
    return FORMER.get(key) in within or any(within[name] == within[key] for name in whole)


def questions(preset: str) -> Iterator[tuple[str, ...]]:
    """Each command that takes a design, asked something about its home posture."""
    machine = machine_of(load_design(preset))
    home, axes, joints = machine.home, machine.coordinates, machine.joints
    lengths = ",".join(repr(v * SCALE[j.unit]) for v, j in zip(home.joints, joints, strict=True))
    at, last = pose_of(preset), "-" if machine.dependent else "1"
    yield "ik", preset, *at
    yield "ik", preset, f"--{axes[0].key}", at[1].split(",")[0]
    yield "fk", preset, "--joints", lengths
    yield "velocity", preset, *at, "--rates", ",".join(["1"] * (len(axes) - 1) + [last])
    yield "velocity", preset, *at, "--joint-rates", ",".join(["1"] * len(joints))
    yield "statics", preset, *at, "--load", "1,2,-30,4,5,6"
    yield "singularity", preset, *at
    yield "singularity", preset, "--resolution", "preview"
    yield "singularity", preset
    yield "workspace", preset, "--resolution", "preview"
    for spec in machine.region_specs:
        yield "workspace", preset, "--regions", spec.key
    yield "vertex-space", preset, "--limb", "1", "--resolution", "preview"
    yield "volume", preset, "--tolerance", "0.01", "--mode", "home"
    yield "volume", preset, "--tolerance", "0.1", "--mode", "home", "--usable"
    yield "section", preset, "--x", "20"
    yield "map", preset, "--phi", "0", "--theta", "0:10:2", "--quantity", "all"
    for spec in machine.singularities.loci:
        cut = ("--at", "5") if spec.key == "section" else ()
        yield "singularity", preset, *at, "--chart", spec.key, *cut
    for path in machine.paths.named():
        load = ("--load", "0,0,-9,0,0,0")
        yield "trajectory", preset, path.name, "--samples", "5", *load, "--fit", "3"


# Where there is nothing of the kind, that is said: of planes no volumes, of one limb no parts …
LACKING = r"has no|lies in a plane|is for all positions together|the map runs over|unrecognized"


@pytest.fixture
def ask(here: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Maps are computed in a thread of this process."""

    @contextmanager
    def threads(jobs: int | None = None, meanwhile: object = None) -> Iterator[executors.Workers]:
        with ThreadPoolExecutor(1) as pool:
            yield executors.Workers(pool, 1, "one thread", lambda: None)

    monkeypatch.setattr(executors, "local_workers", threads)
    return here


@pytest.mark.parametrize("preset", PRESETS)
def test_every_answer_has_a_schema_and_units_and_finite_numbers(ask: Run, preset: str) -> None:
    asked = set()
    for question in questions(preset):
        done = ask(*question, "--json")
        if done.code:
            assert re.search(LACKING, refused(done)), question
            continue
        answer = done.json  # NaN and infinity are refused
        assert answer["schema"] == f"bohemia/{question[0]}/1", question
        assert answer["design"] == preset
        assert answer["mechanism"] == load_design(preset).mechanism
        assert sorted(set(unnamed(answer))) == [], question
        asked.add(question[0])
    assert asked >= {"ik", "fk", "velocity", "statics", "singularity", "workspace"}


def test_answers_without_a_design_have_a_schema_too(here: Run) -> None:
    sizes = ("--base", "100", "--platform", "200", "--altitude", "100")
    curves = ("--curves", "--ratios", "1,2", "--heights", "1:2:3")
    for question in (("designs",), ("micr", "three_spr", *sizes), ("micr", "three_rps", *curves)):
        answer = here(*question, "--json").json
        assert answer["schema"] == f"bohemia/{question[0]}/1"
        assert set(unnamed(answer)) <= {"base", "platform", "altitude"}
    assert {answer["note"] != "", "mode1_deg" in answer} == {True}


def test_a_trajectory_of_a_file_says_its_units(here: Run, tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("x,y,z,alpha,beta\n0,0,569,0,0\n10,5,575,3,2\n")
    words = ("trajectory", "sps-spr", "p.csv", "--samples", "5", "--load", "0,9,-9,0,0,0")
    answer = here(*words, "--json").json
    assert sorted(set(unnamed(answer))) == []
    samples = answer["samples"]
    assert samples["l1_mm_per_s"] == samples["l1_per_s"]
    assert samples["force_constraint5_N"] == samples["force_constraint5"]
    (held,) = (each for each in answer["wrenches"] if each["kind"] == "constraint")
    assert held["key"] == "force_constraint5_N"
    assert np.shape(held["direction"]) == np.shape(held["point_mm"]) == (5, 3)


@pytest.mark.parametrize("preset", ["rpur-table1", "sps-spr", "rps-3", "five-bar"])
def test_wrenches_have_their_lines(here: Run, preset: str) -> None:
    machine = machine_of(load_design(preset))
    home = machine.home
    words = ("statics", preset, *pose_of(preset), "--load", "1,2,3,4,5,6", "--json")
    answer = here(*words)
    system = machine.statics.wrenches(home.pose, home.mode)
    origin = machine.transform(home.pose, home.mode)[:3, 3]
    for force, row in zip(answer.json["forces"], system.rows, strict=True):
        along = np.array(force["direction"])
        assert np.linalg.norm(along) == pytest.approx(1.0)
        if force["point_mm"] is None:  # a couple
            assert row[:3].tolist() == [0.0, 0.0, 0.0]
            np.testing.assert_allclose(np.cross(along, row[3:]), 0.0, atol=1e-9)
            continue
        size = np.linalg.norm(row[:3])
        np.testing.assert_allclose(size * along, row[:3], atol=1e-12)
        moment = np.cross(np.array(force["point_mm"]) - origin, size * along)
        np.testing.assert_allclose(moment, row[3:], atol=1e-6)


def pose_of(preset: str) -> tuple[str, str]:
    """--pose of the home posture."""
    machine = machine_of(load_design(preset))
    shown = zip(machine.home.pose, machine.coordinates, strict=True)
    return "--pose", ",".join(repr(v * SCALE[axis.unit]) for v, axis in shown)
