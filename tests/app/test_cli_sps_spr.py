"""The commands on the 4-SPS + 1-SPR, as processes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import ROOT, Finished, answered, refused

Run = Callable[..., Finished]
REFERENCE = ROOT / "tests" / "reference"
CASES = json.loads((REFERENCE / "sps_spr_forward.json").read_text(encoding="utf-8"))["cases"]
SAMPLES = json.loads((REFERENCE / "sps_spr_samples.json").read_text(encoding="utf-8"))["samples"]


def design_text(base, platform, axis, stroke) -> str:
    limbs = "".join(
        f"[[limb]]\nbase = {list(a)}\nplatform = {list(b)}\nstroke = {stroke}\n"
        for a, b in zip(base, platform, strict=True)
    )
    return f'mechanism = "four_sps_spr"\nrevolute_axis = {list(axis)}\n{limbs}'


@pytest.fixture
def pentagons(tmp_path: Path) -> Path:
    """The samples' machine: base and platform two regular pentagons."""
    turns = np.radians(72.0 * np.arange(5))
    unit = np.column_stack([np.cos(turns), np.sin(turns), np.zeros(5)])
    axis = (-np.sin(turns[4]), np.cos(turns[4]), 0.0)
    path = tmp_path / "pentagons.toml"
    text = design_text(
        (400.0 * unit).tolist(), (100.0 * unit).tolist(), map(float, axis), [450.0, 900.0]
    )
    path.write_text(text, encoding="utf-8")
    return path


def test_ik_and_fk_are_each_others(bohemia: Run) -> None:
    there = answered(bohemia("ik", "sps-spr", "--pose", "-,20,560,5,2,3", "--json"))
    assert there["reachable"]
    (solution,) = there["solutions"]
    assert "working_mode" not in solution
    assert set(there["pose"]) == {"x", "y", "z", "alpha_deg", "beta_deg", "gamma_deg"}
    assert there["pose"]["gamma_deg"] == pytest.approx(3.0)
    joints = ",".join(map(repr, solution["joints"]))
    found = answered(bohemia("fk", "sps-spr", "--joints", joints, "--json"))
    assert found["complex_count"] == found["expected_count"] == 40
    assert found["complete"] is True
    apart = [
        np.abs(np.subtract(each["transform"], solution["transform"])).max()
        for each in found["solutions"]
    ]
    assert min(apart) < 1e-8
    # Every one of them, written with all digits, is a pose that the constraint allows.
    pose = ",".join(repr(value) for value in found["solutions"][0]["pose"].values())
    again = answered(bohemia("ik", "sps-spr", "--pose", pose, "--json"))
    assert again["solutions"][0]["joints"] == pytest.approx(solution["joints"], abs=1e-8)


@pytest.mark.parametrize("index", range(6))
def test_any_of_the_six_may_follow(bohemia: Run, index: int) -> None:
    full = answered(bohemia("ik", "sps-spr", "--pose", "-,20,560,50,10,20", "--json"))
    values = list(full["pose"].values())
    words = [repr(value) for value in values]
    words[index] = "-"
    found = answered(bohemia("ik", "sps-spr", "--pose", ",".join(words), "--json"))
    # An angle may have a second value, which is nearer to zero.
    if index < 3:
        assert list(found["pose"].values()) == pytest.approx(values, abs=1e-6)
    else:
        assert abs(list(found["pose"].values())[index]) <= abs(values[index]) + 1e-6
    assert found["solutions"]


def test_a_pose_off_the_constraint_says_so(bohemia: Run) -> None:
    found = answered(bohemia("ik", "sps-spr", "--pose", "10,20,560,5,2,3", "--json"))
    assert found["solutions"] == []
    assert not found["reachable"]
    assert "off the plane normal to its revolute axis" in found["reasons"][0]
    assert "only one" in refused(bohemia("ik", "sps-spr", "--pose", "-,-,560,5,2,3"))
    why = refused(bohemia("ik", "sps-spr", "--pose", "0,0,-,0,0,0"))
    assert "z cannot follow" in why


@pytest.mark.parametrize("case", [CASES[0], CASES[-1]], ids=lambda case: case["kind"])
def test_fk_of_the_reference_cases(bohemia: Run, tmp_path: Path, case) -> None:
    flat = [[[*point, 0.0] for point in case[key]] for key in ("A", "b")]
    path = tmp_path / "case.toml"
    path.write_text(design_text(*flat, [*case["n6"], 0.0], [3.0, 15.0]), encoding="utf-8")
    joints = ",".join(map(repr, case["lengths"]))
    done = bohemia("fk", path, "--joints", joints, "--json")
    assert done.code == 0
    found = done.json
    assert found["complex_count"] == case["n_complex"]
    assert found["real_count"] == case["n_real"]
    for known in case["real_solutions"]:
        transform = np.column_stack([np.array(known["R"]).reshape(3, 3), known["p"]])
        apart = [
            np.abs(np.array(each["transform"])[:3] - transform).max() for each in found["solutions"]
        ]
        assert min(apart) < 1e-8


def test_statics_and_velocity_of_a_sample(bohemia: Run, pentagons: Path) -> None:
    sample = SAMPLES[0]
    r = np.array(sample["R"]).reshape(3, 3)
    alpha, gamma = np.arctan2(r[1, 0], r[0, 0]), np.arctan2(r[2, 1], r[2, 2])
    beta = np.arcsin(-r[2, 0])
    words = [*map(repr, sample["p"]), *(repr(float(np.degrees(a))) for a in (alpha, beta, gamma))]
    words[0] = "-"
    pose = ",".join(words)
    done = bohemia("statics", pentagons, "--pose", pose, "--load", "0,10,-10,10,0,10", "--json")
    assert "Singular at home" in done.stderr
    forces = [each["value"] for each in done.json["forces"]]
    assert forces == pytest.approx(sample["forces"], rel=1e-7)
    assert done.json["forces"][5]["kind"] == "constraint"
    rates, second = (",".join(map(repr, sample[key])) for key in ("ldot", "lddot"))
    done = bohemia(
        *("velocity", pentagons, "--pose", pose, "--joint-rates", rates),
        *("--joint-accelerations", second, "--json"),
    )
    twist = [*done.json["twist"]["v"], *np.radians(done.json["twist"]["omega_deg"])]
    assert twist == pytest.approx(sample["V"], rel=1e-7, abs=1e-8)
    bend = [*done.json["twist_rate"]["a"], *np.radians(done.json["twist_rate"]["alpha_deg"])]
    assert bend == pytest.approx(sample["A"], rel=1e-6, abs=1e-7)


def test_the_workspace_is_a_plane_region_or_a_solid(bohemia: Run, tmp_path: Path) -> None:
    done = bohemia(
        "workspace", "sps-spr", "--alpha", "10", "--gamma", "-4", "-o", "w.dxf", "--json"
    )
    flat = answered(done)
    assert flat["area_mm2"] > 1e5
    assert flat["pieces"] == 2
    assert flat["volume_mm3"] == 0.0
    assert (flat["alpha_deg"], flat["beta_deg"], flat["gamma_deg"]) == (10.0, 0.0, -4.0)
    assert (tmp_path / "w.dxf").stat().st_size > 1000
    # A corner of it, in the base frame, is reachable but for rounding.
    edge = flat["loops"][0][0]
    middle = np.array(edge["center"])
    place = (np.array(flat["transform"]) @ [*edge["from"], 0.0, 1.0])[:3]
    assert np.linalg.norm(np.array(edge["from"]) - middle) == pytest.approx(edge["radius"])
    pose = ",".join([*(repr(float(v)) for v in place), "10", "0", "-4"])
    there = answered(bohemia("ik", "sps-spr", "--pose", pose, "--json"))
    ends = [
        min(abs(joint - 450.0), abs(joint - 800.0)) for joint in there["solutions"][0]["joints"]
    ]
    assert min(ends) < 1e-6
    solid = bohemia(
        *("workspace", "sps-spr", "--gamma", "-", "--resolution", "preview", "-o", "w.stl"),
        "--json",
    )
    built = answered(solid)
    assert built["watertight"] is True
    assert built["gamma_deg"] is None
    assert 5e7 < built["volume_mm3"] < 1e8
    assert (tmp_path / "w.stl").stat().st_size == 84 + 50 * built["triangles"]


def test_what_cannot_be_asked_of_the_workspace(bohemia: Run) -> None:
    assert "--alpha, --beta, --gamma" in refused(bohemia("workspace", "sps-spr", "--phi", "3"))
    assert "no angle" in refused(bohemia("workspace", "rpur-table1", "--phi", "-"))
    assert ".svg, .dxf, .csv" in refused(bohemia("workspace", "sps-spr", "-o", "w.stl"))
    both = bohemia("workspace", "sps-spr", "--alpha", "-", "--beta", "-")
    assert "only one angle" in refused(both)


def test_singularity_of_a_pose_and_its_curve(bohemia: Run, pentagons: Path) -> None:
    found = bohemia("singularity", pentagons, "--pose", "0,0,560,0,0,0", "--json").json
    assert len(found["singularities"]) == 2
    assert {each["kind"] for each in found["singularities"]} == {"parallel"}
    fine = answered(bohemia("singularity", "sps-spr", "--pose", "-,20,560,5,2,3", "--json"))
    assert fine["singularities"] == []


def test_designs_lists_the_preset(bohemia: Run) -> None:
    found = answered(bohemia("designs", "--json"))["designs"]
    (mine,) = (each for each in found if each["name"] == "sps-spr")
    assert mine["mechanism"] == "four_sps_spr"


def test_the_other_angle_that_the_constraint_allows_is_told(bohemia: Run) -> None:
    pose = "--pose=-87.83033179790539,20,560,5,-,3"
    answer = answered(bohemia("ik", "sps-spr", pose, "--json"))
    assert answer["pose"]["beta_deg"] == pytest.approx(2.0, abs=1e-6)
    (other,) = answer["other_poses"]
    assert other["beta_deg"] == pytest.approx(121.036, abs=1e-3)
    there = ",".join(map(repr, other.values()))
    assert answered(bohemia("ik", "sps-spr", f"--pose={there}", "--json"))["reachable"]
    assert "The constraint holds as well at" in bohemia("ik", "sps-spr", pose).stdout
    assert (
        answered(bohemia("ik", "sps-spr", "--pose", "0,20,560,5,2,3", "--json"))["other_poses"]
        == []
    )
