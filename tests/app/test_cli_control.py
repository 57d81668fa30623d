"""`bohemia velocity`, `statics` and `singularity`: what they answer, write and refuse."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.features.singularities import files
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.arrays import Array
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.mechanism import FiveRPUR
from tests.conftest import Finished, answered, refused

Run = Callable[..., Finished]

DESIGN = load_design("rpur-table1")
MACHINE = machine_of(DESIGN)
POSE = "90,110,430,5,-3"
MODE = "+++++"
AT = ("rpur-table1", "--pose", POSE, "--mode", MODE)
INNER = np.array([90, 110, 430, np.radians(5), np.radians(-3)])


def lengths(pose: Any) -> Array:
    return np.array(machine_of(DESIGN).inverse.posture(pose, MODE).joints)


# --- velocity ------------------------------------------------------------------------------


def test_joint_rates_are_the_change_of_the_lengths(bohemia: Run) -> None:
    answer = answered(bohemia("velocity", *AT, "--rates", "-10,20,5,3,-4", "--json"))
    rates = np.array([-10, 20, 5, np.radians(3), np.radians(-4)])
    step = 1e-4
    ahead, here, behind = (lengths(INNER + k * step * rates) for k in (1, 0, -1))
    first, second = (ahead - behind) / (2 * step), (ahead - 2 * here + behind) / step**2
    assert answer["joint_rates"] == pytest.approx(first, abs=1e-6)
    assert answer["joint_accelerations"] == pytest.approx(second, abs=1e-3)
    assert answer["joints"] == pytest.approx(here)
    assert answer["working_mode"] == MODE
    assert answer["pose"] == {"x": 90, "y": 110, "z": 430, "phi_deg": 5, "theta_deg": -3}
    assert answer["rates"] == pytest.approx(
        {"x": -10, "y": 20, "z": 5, "phi_deg": 3, "theta_deg": -4}
    )
    assert set(answer["accelerations"].values()) == {0.0}
    assert answer["twist"]["v"] == pytest.approx([-10, 20, 5])
    e2 = np.array([np.cos(INNER[4]), 0, -np.sin(INNER[4])])
    omega = 3 * e2 + np.array([0, -4, 0])
    assert answer["twist"]["omega_deg"] == pytest.approx(omega)
    assert answer["reasons"] == []


def test_both_ways_round(here: Run) -> None:
    there = answered(
        here("velocity", *AT, "--rates", "1,2,3,4,5", "--accelerations", "-1,0,2,-3,1", "--json")
    )
    back = answered(
        here(
            *("velocity", *AT, "--json"),
            *("--joint-rates", ",".join(map(repr, there["joint_rates"]))),
            *("--joint-accelerations", ",".join(map(repr, there["joint_accelerations"]))),
        )
    )
    assert list(back["rates"].values()) == pytest.approx([1, 2, 3, 4, 5])
    assert list(back["accelerations"].values()) == pytest.approx([-1, 0, 2, -3, 1], abs=1e-8)
    for key in ("omega_deg", "v"):
        assert back["twist"][key] == pytest.approx(there["twist"][key])
    for key in ("alpha_deg", "a"):
        assert back["twist_rate"][key] == pytest.approx(there["twist_rate"][key], abs=1e-8)


def test_without_a_mode_it_is_that_of_the_home_posture(here: Run) -> None:
    done = here("velocity", "rpur-table1", "--pose", POSE, "--rates", "1,0,0,0,0", "--json")
    assert done.json["working_mode"] == machine_of(DESIGN).home.mode
    table = here("statics", "rpur-table1", "--pose", POSE, "--load", "0,0,-10,0,0,0")
    assert f"working mode {machine_of(DESIGN).home.mode}" in table.stdout


def test_velocity_table_is_readable(here: Run) -> None:
    done = here("velocity", *AT, "--rates", "-10,20,5,3,-4")
    assert done.code == 0
    assert done.stderr == ""
    assert "Pose x = 90 mm, y = 110 mm, z = 430 mm, φ = 5°, θ = -3°, working mode +++++" in (
        done.stdout
    )
    assert re.search(r"^θ \(°\) +-4 +0$", done.stdout, re.M)
    assert re.search(r"^ρ₅ \(mm\) +-?[\d.]+ +-?[\d.]+$", done.stdout, re.M)
    assert "ω = (" in done.stdout


def test_a_pose_that_does_not_close_has_no_rates_and_says_why(bohemia: Run) -> None:
    arguments = ("velocity", "rpur-table1", "--pose", "0,900,300,0,0", "--rates", "1,0,0,0,0")
    answer = answered(bohemia(*arguments, "--json"))
    assert answer["joint_rates"] == [None] * 5
    assert any("limb 5 cannot reach" in reason for reason in answer["reasons"])
    assert answer["within_stroke"] is False
    table = bohemia(*arguments)
    assert table.code == 0
    assert "limb 5 cannot reach" in table.stdout
    assert "–" in table.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "give either --rates or --joint-rates"),
        (["--rates", "1,2,3,4,5", "--joint-rates", "1,2,3,4,5"], "give either --rates or"),
        (["--rates", "1,2"], r"--rates needs 5 numbers .*θ \(degrees\); got 2"),
        (["--rates", "1,2,3,4,fast"], "--rates: θ must be a number, got 'fast'"),
        (
            ["--rates", "1,2,3,4,5", "--joint-accelerations", "1,2,3,4,5"],
            "--joint-accelerations with --joint",
        ),
        (["--joint-rates", "1,2,3,4,5", "--accelerations", "1,2,3,4,5"], "goes with --rates"),
        (["--joint-rates", "1,2,3,4,nan"], "ρ₅ must be a finite number"),
        (["--rates", "1,2,3,4,5", "--mode", "+-"], r"--mode: '\+-' is not a working mode"),
        (["--rates", "1,2,3,4,5", "--mode", "?++++"], "are 2 modes; name one of them"),
    ],
)
def test_broken_velocities(here: Run, arguments: list[str], said: str) -> None:
    assert re.search(said, refused(here("velocity", "rpur-table1", "--pose", POSE, *arguments)))


# --- statics -------------------------------------------------------------------------------


def test_forces_do_the_work_of_the_load(bohemia: Run) -> None:
    load = [10.0, -20.0, -50.0, 300.0, 400.0, -500.0]
    answer = answered(bohemia("statics", *AT, "--load", ",".join(map(str, load)), "--json"))
    assert answer["load"] == {"force_N": load[:3], "moment_Nmm": load[3:]}
    assert answer["residual"] < 1e-12
    forces = answer["forces"]
    assert [force["limb"] for force in forces] == [1, 2, 3, 4, 5, None]
    assert [force["kind"] for force in forces] == ["actuation"] * 5 + ["constraint"]
    assert [force["unit"] for force in forces] == ["N"] * 5 + ["N mm"]
    pushed = np.array([force["value"] for force in forces[:5]])
    step = 1e-5
    for k, work in enumerate(load[:3]):
        move = step * np.eye(5)[k]
        given = pushed @ (lengths(INNER + move) - lengths(INNER - move)) / (2 * step)
        assert given + work == pytest.approx(0.0, abs=1e-5)


def test_out_of_reach_the_reasons_come_first_and_no_table_of_nothing(here: Run) -> None:
    away = ("rpur-table1", "--pose", "900,0,0,0,0")
    held = here("statics", *away, "--load", "0,0,10,0,0,0").stdout
    assert "limb 3 cannot reach" in held
    assert "force" not in held
    moved = here("velocity", *away, "--rates", "1,0,0,0,0").stdout
    assert 0 < moved.index("limb 3 cannot reach") < moved.index("rate /s")


def test_statics_table_is_readable(here: Run) -> None:
    done = here("statics", *AT, "--load", "-0,0,-10,0,0,0")
    assert done.code == 0
    assert done.stderr == ""
    assert len(re.findall(r"^F[₁-₅] +actuation +-?[\d.e-]+ +N$", done.stdout, re.M)) == 5
    assert re.search(r"^M +constraint +-?[\d.e-]+ +N·mm$", done.stdout, re.M)


def test_nothing_is_held_where_limbs_coincide(here: Run, tmp_path: Path) -> None:
    limb = "[[limb]]\nbase = [0, 0, 0]\nplatform = [0, 0, 0]\nlink = 150\nstroke = [250, 400]\n"
    (tmp_path / "same.toml").write_text('mechanism = "five_rpur"\n' + 5 * limb, encoding="utf-8")
    arguments = ("same.toml", "--pose", "10,40,400,0.5,1", "--mode", MODE)
    done = here("statics", *arguments, "--load", "1,2,3,4,5,6", "--json")
    assert done.code == 0
    assert [force["value"] for force in done.json["forces"]] == [None] * 6
    assert done.json["residual"] is None
    assert any("Architectural singularity" in reason for reason in done.json["reasons"])
    lost = here("singularity", *arguments, "--json").json
    assert lost["singular"] is True
    assert lost["kinds"] == ["architectural"]


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ("1,2,3", r"--load needs 6 numbers .*Fx, Fy, Fz, Tx, Ty, Tz \(N and N·mm\); got 3"),
        ("1,2,3,4,5,x", "--load: Tz must be a number"),
        ("1,2,3,4,5,inf", "--load: Tz must be a finite number"),
    ],
)
def test_broken_loads(here: Run, load: str, said: str) -> None:
    assert re.search(said, refused(here("statics", *AT, "--load", load)))


# --- singularity ---------------------------------------------------------------------------


def test_an_ordinary_posture_is_held(bohemia: Run) -> None:
    answer = answered(bohemia("singularity", *AT, "--json"))
    assert answer["singular"] is False
    assert answer["kinds"] == answer["singularities"] == []
    held = answer["conditioning"]
    system = machine_of(DESIGN).statics.wrenches(INNER, MODE)
    assert held["determinant"] == pytest.approx(float(system.determinant))
    assert held["smallest_singular_value"] > 0.0
    assert held["condition"] > 1.0
    assert held["characteristic_length_mm"] == machine_of(DESIGN).length
    assert answer["reasons"] == []
    assert answer["remedy"] is None
    for each in answer["clearances"]:
        assert each["text"]
        assert len(each["point_mm"]) == 3


def test_the_reference_fold_is_named(here: Run) -> None:
    import json

    from tests.conftest import ROOT

    path = ROOT / "tests" / "reference" / "rpur_folds.json"
    fold = json.loads(path.read_text(encoding="utf-8"))["folds"][0]
    pose = [*fold["pose_fold"][:3], *np.degrees(fold["pose_fold"][3:]).tolist()]
    (mode,) = (
        m
        for m in MACHINE.modes
        if np.allclose(
            machine_of(DESIGN).inverse.posture(fold["pose_fold"], m).joints,
            fold["rho_fold"],
            atol=1e-6,
        )
    )
    arguments = ("singularity", "rpur-table1", "--pose", ",".join(map(repr, pose)), "--mode", mode)
    answer = here(*arguments, "--json").json
    assert answer["singular"] is True
    assert answer["kinds"] == ["parallel"]
    (found,) = answer["singularities"]
    assert found["limbs"] == [1, 2, 3, 4, 5]
    assert "general linear complex" in found["cause"]
    assert found["measure"] < 1e-9
    assert set(found["motion"]) == {"x", "y", "z", "phi_deg", "theta_deg"}
    assert len(found["twist"]["omega_deg"]) == len(found["twist"]["v"]) == 3
    shown = here(*arguments).stdout
    assert found["text"] in shown
    assert found["cause"] in shown

    near = ",".join(repr(v + 1.0) for v in pose)
    there = ("singularity", "rpur-table1", "--pose", near, "--mode", mode, "--json")
    assert here(*there).json["singularities"] == []
    (found,) = here(*there, "--tolerance", "0.05").json["singularities"]
    assert found["text"].startswith("Near a parallel singularity")
    assert here(*there, "--tolerance", "0.05").json["singular"] is False


def test_a_pose_out_of_reach_says_why(here: Run) -> None:
    arguments = ("singularity", "rpur-table1", "--pose", "0,900,300,0,0", "--mode", MODE)
    answer = here(*arguments, "--json").json
    assert answer["singular"] is None
    assert answer["within_stroke"] is False
    assert any("cannot reach" in reason for reason in answer["reasons"])
    assert answer["conditioning"]["determinant"] is None
    table = here(*arguments)
    assert table.code == 0
    assert "Not reachable:" in table.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--tolerance", "2"], "--tolerance must lie between 0 and 1, got 2"),
        (["--tolerance", "0"], "--tolerance must lie between 0 and 1"),
        (["-o", "a.csv"], "-o goes with --chart"),
        (["--at", "-5"], "--at goes with --chart"),
        (["--chart", "map", "--tolerance", "0.1"], "--tolerance is about one pose"),
        (["--chart", "map", "-o", "a.pdf"], r"ending \.pdf; a chart is written as one of \.csv"),
    ],
)
def test_broken_questions(here: Run, arguments: list[str], said: str) -> None:
    assert re.search(said, refused(here("singularity", *AT, *arguments)))


def test_a_question_needs_a_pose(here: Run) -> None:
    assert "required: --pose" in refused(here("velocity", "rpur-table1", "--rates", "1,2,3,4,5"))


# --- charts --------------------------------------------------------------------------------

TILTS = LocusSpec("tilts", "Singular orientations", ("φ", "θ"), ("rad", "rad"))
POLAR = LocusSpec("polar", "Tilts", ("tilt", "azimuth"), ("rad", "rad"), polar=True)
PLANE = LocusSpec("section", "Section", ("y′", "z′"), ("mm", "mm"))


def made_curves() -> LocusCurves:
    """A closed curve and an open one."""
    points = np.array([[0.1, 0.2], [0.3, 0.2], [0.1, 0.2], [0.5, -0.5], [0.6, -0.4]])
    return LocusCurves(
        points=points,
        start=np.array([0, 3, 5]),
        kinds=("parallel", "serial"),
        limb=np.array([0, 4]),
        residual=np.array([1e-12, 2e-12, 1e-12, 3e-12, 0.0]),
        bounds=np.array([[-1.0, 1.0], [-0.7, 0.7]]),
    )


@pytest.fixture
def charted(here: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """A mechanism with three charts, whatever the 5-RPUR has."""

    def locus(self: Any, key: str, pose: Any, mode: str, at: float | None = None) -> LocusCurves:
        assert mode == MODE
        assert (at == -5.0) == (key == "section")
        found = made_curves()
        if key == "polar":
            return replace(found, points=np.abs(found.points), bounds=np.abs(found.bounds))
        return found

    monkeypatch.setattr(type(MACHINE.singularities), "loci", (TILTS, POLAR, PLANE))
    monkeypatch.setattr(type(MACHINE.singularities), "locus", locus)
    return here


def test_a_chart_in_degrees(charted: Run) -> None:
    answer = answered(charted("singularity", *AT, "--chart", "tilts", "--json"))
    assert answer["coordinates"] == ["phi_deg", "theta_deg"]
    one, two = answer["curves"]
    assert (one["kind"], one["limb"], one["closed"]) == ("parallel", None, True)
    assert (two["kind"], two["limb"], two["closed"]) == ("serial", 4, False)
    assert np.array(two["points"]) == pytest.approx(np.degrees([[0.5, -0.5], [0.6, -0.4]]))
    assert answer["bounds"] == [
        pytest.approx(np.degrees([-1.0, 1.0])),
        pytest.approx(np.degrees([-0.7, 0.7])),
    ]
    assert answer["residual"] == pytest.approx(np.degrees(3e-12))
    assert answer["file"] is None


def test_a_chart_as_csv(charted: Run, tmp_path: Path) -> None:
    done = charted("singularity", *AT, "--chart", "tilts", "-o", "loci.csv")
    assert done.code == 0
    assert "loci.csv" in done.stdout
    rows = list(csv.reader(io.StringIO((tmp_path / "loci.csv").read_text(encoding="utf-8"))))
    assert rows[0] == ["curve", "kind", "limb", "phi_deg", "theta_deg", "residual_deg"]
    assert [row[:3] for row in rows[1:]] == [["1", "parallel", ""]] * 3 + [["2", "serial", "4"]] * 2
    values = np.array([row[3:5] for row in rows[1:]], dtype=float)
    np.testing.assert_allclose(values, np.degrees(made_curves().points))


@pytest.mark.parametrize("key", ["tilts", "polar", "section"])
def test_a_chart_as_svg(charted: Run, tmp_path: Path, key: str) -> None:
    arguments = ["--chart", key, "-o", f"{key}.svg"] + (["--at", "-5"] if key == "section" else [])
    done = charted("singularity", *AT, *arguments, "--json")
    assert answered(done)["file"] == f"{key}.svg"
    text = (tmp_path / f"{key}.svg").read_text(encoding="utf-8")
    assert text.count("<svg") == 1
    assert "parallel" in text
    assert "serial, limb 4" in text
    again = charted("singularity", *AT, *arguments, "--json")
    assert again.code == 0
    assert (tmp_path / f"{key}.svg").read_text(encoding="utf-8") == text


def test_a_section_chart_stands_where_it_is_put(charted: Run) -> None:
    answer = answered(charted("singularity", *AT, "--chart", "section", "--at", "-5", "--json"))
    assert answer["coordinates"] == ["y_mm", "z_mm"]
    assert answer["at_mm"] == -5.0


def test_charts_that_are_not_there(charted: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    said = refused(charted("singularity", *AT, "--chart", "nowhere"))
    assert said == "--chart must be one of tilts, polar, section, got 'nowhere'"
    monkeypatch.setattr(type(MACHINE.singularities), "loci", ())
    said = refused(charted("singularity", *AT, "--chart", "tilts"))
    assert "has no charts of loci" in said


def test_an_empty_chart() -> None:
    nothing = LocusCurves(
        np.empty((0, 2)), np.array([0]), (), np.empty(0, int), np.empty(0), np.ones((2, 2))
    )
    assert files.curves(nothing, TILTS) == []
    assert files.locus_csv(nothing, PLANE) == "curve,kind,limb,y_mm,z_mm,residual_mm\n"
    bounded = replace(nothing, bounds=np.array([[0.0, 1.0], [0.0, 1.0]]))
    assert b"no singularity here" in files.locus_bytes(bounded, TILTS, "svg")
    with pytest.raises(InputError, match="a chart is written as csv or svg"):
        files.locus_bytes(nothing, TILTS, "png")


# --- modes and coordinates of other mechanisms ---------------------------------------------


@pytest.fixture
def other(here: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """A mechanism with operation modes, whose z may be left out."""

    def complete(
        self: Any, pose: Any, mode: str, moved: int | None = None, dependent: int | None = None
    ) -> tuple[float, ...]:
        free = [n for n, value in enumerate(pose) if value != value]
        if free != [2]:
            raise InputError("only z may be left out")
        if mode.startswith("-"):
            raise InputError("there is no such z")
        return (*pose[:2], 430.0 + 10.0 * (mode == "+++++"), *pose[3:])

    monkeypatch.setattr(FiveRPUR, "mode_noun", "operation mode")
    monkeypatch.setattr(FiveRPUR, "complete_pose", complete)
    return here


def test_a_coordinate_that_is_left_out_is_found_in_each_mode(other: Run) -> None:
    answer = answered(other("ik", "rpur-table1", "--pose", "90,110,-,5,-3", "--json"))
    found = {one["operation_mode"]: one for one in answer["solutions"]}
    assert len(found) == 16  # where z exists
    assert "working_mode" not in answer["solutions"][0]
    assert found["+++++"]["pose"]["z"] == 440.0
    assert found["+-+++"]["pose"]["z"] == 430.0
    for one in found.values():
        assert one["transform"][2][3] == one["pose"]["z"]
    one = answered(
        other("ik", "rpur-table1", "--pose", "90,110,−,5,-3", "--mode", "+++++", "--json")
    )
    assert one["pose"]["z"] == 440.0
    assert len(one["solutions"]) == 1
    shown = other("ik", "rpur-table1", "--pose", "90,110,-,5,-3", "--mode", "+++++").stdout
    assert "z = 440 mm" in shown
    assert "operation mode" in shown


def test_a_pose_is_completed_for_every_command(other: Run) -> None:
    arguments = ("rpur-table1", "--pose", "90,110,-,5,-3", "--mode", MODE, "--json")
    for command in (
        ("statics", *arguments, "--load", "0,0,-1,0,0,0"),
        ("velocity", *arguments, "--rates", "1,0,0,0,0"),
        ("singularity", *arguments),
    ):
        answer = answered(other(*command))
        assert answer["pose"]["z"] == 440.0
        assert answer["operation_mode"] == MODE


def test_coordinates_that_cannot_be_left_out(other: Run) -> None:
    said = refused(other("ik", "rpur-table1", "--pose", "-,110,430,5,-3"))
    assert said == "only z may be left out"
    said = refused(other("ik", "rpur-table1", "--pose", "-,110,-,5,-3"))
    assert said == "--pose: only one coordinate may be -, got 2"
    said = refused(other("ik", "rpur-table1", "--pose", "90,110,-,5,-3", "--mode", "-++++"))
    assert said == "there is no such z"
    said = refused(other("ik", "rpur-table1", "--pose", "90,110,430,5,-3", "--mode", "1"))
    assert "'1' is not an operation mode" in said


def test_the_5_rpur_leaves_no_coordinate_out(here: Run) -> None:
    said = refused(here("velocity", *AT, "--rates", "1,2,-,4,5"))
    assert said == "the rates of a pose must be finite numbers, got NaN or infinity"
    said = refused(here("velocity", *AT, "--rates", "1,-,-,4,5"))
    assert said == "--rates: only one coordinate may be -, got 2"
    said = refused(here("ik", "rpur-table1", "--pose", "90,110,-,5,-3"))
    assert said == "every coordinate of the pose must be given"


def test_one_mode_of_all_working_modes(here: Run) -> None:
    every = answered(here("ik", "rpur-table1", "--pose", POSE, "--json"))
    one = answered(here("ik", "rpur-table1", "--pose", POSE, "--mode", "-+-++", "--json"))
    (solution,) = one["solutions"]
    assert solution["working_mode"] == "-+-++"
    assert solution in every["solutions"]
    assert one["reachable"] is solution["within_stroke"]


def test_a_mechanism_with_one_mode_names_none(here: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(FiveRPUR, "mode_noun", "")
    answer = answered(here("ik", "rpur-table1", "--pose", POSE, "--json"))
    assert not {"working_mode", "operation_mode", ""} & set(answer["solutions"][0])
    said = refused(here("ik", "rpur-table1", "--pose", POSE, "--mode", "+++++"))
    assert "has only one mode; leave --mode out" in said
    shown = here("ik", "rpur-table1", "--pose", POSE).stdout
    assert "mode" not in shown
    assert shown.rstrip().endswith("Reachable.")


def test_numbers_next_to_a_singularity_come_with_a_warning(here: Run) -> None:
    # The parallel singularity nearest to home; the inverse rates are as good there as elsewhere.
    beside = "326.7075,94.7561,168.7774,0,0"
    arguments = ("rpur-table1", "--pose", beside)
    done = here("statics", *arguments, "--load", "0,0,-10,0,0,0", "--json")
    (warning,) = json.loads(done.stdout)["warnings"]
    assert re.search(r"a parallel singularity to within \de-\d+", warning)
    assert warning in done.stderr
    done = here("velocity", *arguments, "--joint-rates", "1,0,0,0,0", "--json")
    assert json.loads(done.stdout)["warnings"] == [warning]
    answer = answered(here("velocity", *arguments, "--rates", "1,0,0,0,0", "--json"))
    assert answer["warnings"] == []


def test_a_singularity_that_is_near_is_named(here: Run) -> None:
    done = here("singularity", "rpur-table1", "--pose", "326.7,94.7,169,0,0")
    assert "Not singular." in done.stdout
    assert re.search(r"Near a parallel singularity, measure 0\.00017: the lines of", done.stdout)
