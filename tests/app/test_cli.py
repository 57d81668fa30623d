"""The command line as a process: what it answers, and what it says when it cannot."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.conftest import ROOT, Finished, answered, command_environment, refused

Run = Callable[..., Finished]

POSE = "-10,100,450,5,-3"  # within reach of Table 1
JOINTS = "320,360,345,305,375"  # within its strokes


# --- the command itself --------------------------------------------------------------------


def test_help_names_every_command(bohemia: Run) -> None:
    done = bohemia("--help")
    assert done.code == 0
    assert done.stderr == ""
    for command in ("serve", "designs", "ik", "fk", "workspace", "vertex-space"):
        assert re.search(rf"^ +{command}\b", done.stdout, re.M), command
        assert bohemia(command, "--help").code == 0


def test_help_and_mistakes_load_nothing_slow() -> None:
    code = (
        "import sys, contextlib, app.cli\n"
        "with contextlib.suppress(SystemExit): app.cli.main(['--help'])\n"
        "app.cli.main(['ik'])\n"
        "print([m for m in ('numpy', 'scipy', 'viser', 'trimesh', 'manifold3d') "
        "if m in sys.modules])"
    )
    assert _python(code).splitlines()[-1] == "[]"


@pytest.mark.parametrize(
    ("command", "absent"),
    [
        (["ik", "rpur-table1", "--pose", POSE], ("viser", "trimesh", "manifold3d")),
        (["fk", "rpur-a1a1", "--joints", JOINTS], ("viser", "trimesh", "manifold3d")),
        (["workspace", "rpur-table1", "--resolution", "preview"], ("viser", "trimesh")),
    ],
)
def test_commands_load_only_what_they_need(command: list[str], absent: tuple[str, ...]) -> None:
    code = f"import sys, app.cli\napp.cli.main({command!r})\n" + (
        f"print([m for m in {absent!r} if m in sys.modules])"
    )
    assert _python(code).splitlines()[-1] == "[]"


def _python(code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=command_environment(),
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    return done.stdout


def test_version(bohemia: Run) -> None:
    done = bohemia("--version")
    assert done.code == 0
    assert re.fullmatch(r"bohemia (\d+\.\d+\.\d+|\(not installed\))\n", done.stdout)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["ikk"], "there is no command 'ikk'; did you mean 'ik'"),
        (["rpur-tabel1"], "there is no command 'rpur-tabel1'; did you mean 'rpur-table1'"),
        (["qqq"], "there are serve, designs, ik, fk, workspace, vertex-space"),
        (["ik"], "required: DESIGN, --pose"),
        (["ik", "--json", "--modes", "..", "--pose", "-"], "required: DESIGN"),
        (["ik", "rpur-table1"], "required: --pose"),
        (["ik", "rpur-table1", "--pose"], "--pose: expected one argument"),
        (["designs", "--frobnicate"], "unrecognized arguments: --frobnicate"),
        (["serve", "--port", "99999"], "'99999' is not a port from 0 to 65535"),
        (["serve", "--port", "-1"], "is not a port|expected one argument"),
        (["--port", "http"], "'http' is not a port"),
        (["serve", "no-such-design"], "no-such-design"),
        (["workspace", "rpur-table1", "--resolution", "superb"], "preview"),
        (["workspace", "rpur-table1", "--phi", "nan"], "--phi: .* finite number, got nan"),
        (["workspace", "rpur-table1", "--theta", "-inf"], "--theta: .* finite number, got -inf"),
        (["workspace", "rpur-table1", "--phi", "1e300"], "--phi: .* within ±1e.09"),
        (["workspace", "rpur-table1", "--phi", "steep"], "must be a number, got 'steep'"),
        (["workspace", "rpur-table1", "--modes", "--++"], r"'--\+\+' is not a working mode"),
        (["workspace", "rpur-table1", "-o", "a.step"], "a.step"),
        (["ik", "rpur-table1", "--pose", "-1,2"], "needs 5 numbers"),
        (["fk", "rpur-table1"], "required: --joints"),
        (["fk", "rpur-table1", "--joints", "1,2"], "--joints needs 5 numbers"),
        (["vertex-space", "rpur-table1", "--limb", "6"], "--limb must be one of"),
    ],
)
def test_usage_mistakes_are_one_sentence(bohemia: Run, arguments: list[str], said: str) -> None:
    assert re.search(said, refused(bohemia(*arguments)))


def test_a_reader_that_stops_early_is_no_error() -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "designs", "--json"],
        env=command_environment(),
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == ""
    process.stderr.close()
    process.wait(timeout=60)


# --- designs -------------------------------------------------------------------------------


def test_designs_lists_every_preset(bohemia: Run) -> None:
    listed = answered(bohemia("designs", "--json"))["designs"]
    files = {path.stem for path in (ROOT / "assets" / "designs").glob("*.toml")}
    assert {design["name"] for design in listed} == files
    for design in listed:
        assert set(design) == {"name", "mechanism", "title", "source"}
        assert all(isinstance(value, str) and value for value in design.values())
    table = bohemia("designs").stdout
    assert all(re.search(rf"^{name} ", table, re.M) for name in files)


def test_a_design_may_be_a_file(here: Run, tmp_path: Path) -> None:
    text = (ROOT / "assets" / "designs" / "rpur-table1.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    mine = answered(here("ik", "mine.toml", "--pose", POSE, "--json"))
    preset = answered(here("ik", "rpur-table1", "--pose", POSE, "--json"))
    assert mine["design"] == "mine"
    assert mine["solutions"] == preset["solutions"]


def test_broken_designs_are_one_sentence(here: Run, tmp_path: Path) -> None:
    said = refused(here("ik", "rpur-tabel1", "--pose", POSE))
    assert "'rpur-tabel1'" in said
    assert "rpur-table1" in said

    text = (ROOT / "assets" / "designs" / "rpur-table1.toml").read_text(encoding="utf-8")
    broken = tmp_path / "broken.toml"
    broken.write_text(text.replace("link = 150.0", "link = -150.0", 1), encoding="utf-8")
    said = refused(here("workspace", "broken.toml"))
    assert "broken.toml" in said
    assert "limb 1" in said
    assert "link" in said

    broken.write_bytes(b"\xff\xfe\x00")
    assert "broken.toml" in refused(here("ik", "broken.toml", "--pose", POSE))
    assert "folder" in refused(here("ik", "folder", "--pose", POSE))


# --- inverse kinematics --------------------------------------------------------------------


def _limb_lengths(pose: tuple[float, ...], mode: str) -> list[float]:
    """ρ of Table 1 from spec geometry in the base frame, written apart from the library."""
    design: Any = load_design("rpur-table1")
    x, y, z, phi, theta = (*pose[:3], *np.radians(pose[3:]))
    c, s, ct, st = np.cos(phi), np.sin(phi), np.cos(theta), np.sin(theta)
    q = np.array([[ct, st * s, st * c], [0.0, c, -s], [-st, ct * s, ct * c]])
    lengths = []
    for limb, sign in zip(design.limbs, mode, strict=True):
        a = np.array(limb.base)
        point = np.array([x, y, z]) + q @ limb.platform
        # C − B has no e2 component and B lies in the plane y = y_A.
        dy = point[1] - a[1]
        h = np.sqrt(limb.link**2 - dy**2) * (1 if sign == "+" else -1)
        b = point - np.array([0.0, dy, 0.0]) - h * np.array([st, 0.0, ct])
        lengths.append(float(np.linalg.norm(b - a)))
    return lengths


def test_ik_gives_all_working_modes(bohemia: Run) -> None:
    answer = answered(bohemia("ik", "rpur-table1", "--pose", POSE, "--json"))
    assert answer["pose"] == {"x": -10, "y": 100, "z": 450, "phi_deg": 5, "theta_deg": -3}
    assert answer["reachable"] is True
    assert answer["reasons"] == []
    solutions = answer["solutions"]
    assert {s["working_mode"] for s in solutions} == set(map("".join, product("+-", repeat=5)))
    assert any(s["within_stroke"] for s in solutions)
    assert not all(s["within_stroke"] for s in solutions)
    pose = tuple(map(float, POSE.split(",")))
    for solution in solutions:
        expected = _limb_lengths(pose, solution["working_mode"])
        assert solution["joints"] == pytest.approx(expected, rel=1e-12)
        within = all(250 <= rho <= 400 for rho in expected)
        assert solution["within_stroke"] is within
        assert bool(solution["reasons"]) is not within
        for limb, rho in enumerate(expected, start=1):
            named = any(f"limb {limb} " in reason.lower() for reason in solution["reasons"])
            assert named is not (250 <= rho <= 400)
        transform = np.array(solution["transform"])
        assert transform[:3, 3] == pytest.approx(pose[:3])
        assert transform[3].tolist() == [0, 0, 0, 1]
        assert transform[:3, 0] == pytest.approx(
            [np.cos(np.radians(-3)), 0, -np.sin(np.radians(-3))]  # e2
        )


def test_both_spellings_of_negative_values(bohemia: Run) -> None:
    apart = bohemia("ik", "rpur-table1", "--pose", POSE, "--json")
    joined = bohemia("ik", "--json", f"--pose={POSE}", "rpur-table1")
    spaced = bohemia("ik", "rpur-table1", "--json", "--pose", POSE.replace(",", ", "))
    assert answered(apart) == answered(joined) == answered(spaced)


def test_a_pose_that_no_limb_can_close_has_no_solutions(bohemia: Run) -> None:
    answer = answered(bohemia("ik", "rpur-table1", "--pose", "0,900,300,0,0", "--json"))
    assert answer["solutions"] == []
    assert answer["reachable"] is False
    assert any("limb 5" in reason.lower() and "mm" in reason for reason in answer["reasons"])
    table = bohemia("ik", "rpur-table1", "--pose", "0,900,300,0,0")
    assert table.code == 0
    assert "Not reachable" in table.stdout
    assert all(reason in table.stdout for reason in answer["reasons"])


def test_a_pose_out_of_reach_is_told_of_the_modes_asked_for(bohemia: Run) -> None:
    at = ("ik", "rpur-table1", "--pose", POSE, "--mode")
    told = bohemia(*at, "home").stdout
    assert "Not reachable in working mode +-+-+.\n" in told
    assert told.endswith("Reachable in working mode +++++.\n")
    answer = answered(bohemia(*at, "home", "--json"))
    assert (answer["modes"], answer["reachable_in_other_modes"]) == (["+-+-+"], ["+++++"])
    several = bohemia(*at, "+-+?+").stdout
    assert "Not reachable in any of the working modes +-+++, +-+-+. The nearest " in several
    nowhere = bohemia("ik", "rpur-table1", "--pose", "900,0,0,0,0", "--mode", "+++++").stdout
    assert "Not reachable in working mode +++++, nor in any other.\n" in nowhere


def test_a_pose_beyond_every_stroke_says_why(bohemia: Run) -> None:
    answer = answered(bohemia("ik", "rpur-table1", "--pose", "5000,20,300,0,0", "--json"))
    assert answer["reachable"] is False
    assert len(answer["solutions"]) == 32
    assert not any(s["within_stroke"] for s in answer["solutions"])
    assert all(s["reasons"] for s in answer["solutions"])
    assert answer["reasons"] in [s["reasons"] for s in answer["solutions"]]


def test_ik_table_is_readable(here: Run) -> None:
    done = here("ik", "rpur-table1", "--pose", POSE)
    assert done.code == 0
    assert "x = -10 mm" in done.stdout
    assert "θ = -3°" in done.stdout
    assert "ρ₁ (mm)" in done.stdout
    assert len(re.findall(r"^[+-]{5} ", done.stdout, re.M)) == 32
    rho = _limb_lengths(tuple(map(float, POSE.split(","))), "+-+++")
    row = re.search(r"^\+-\+\+\+ .*", done.stdout, re.M)
    assert row is not None
    assert [float(v) for v in row[0].split()[1:6]] == pytest.approx(rho, abs=5e-5)


@pytest.mark.parametrize(
    ("pose", "said"),
    [
        ("1,2,3", r"needs 5 numbers .*x \(mm\).*θ \(degrees\).*got 3"),
        ("1,2,3,4,5,6", "needs 5 numbers .*got 6"),
        ("", "needs 5 numbers"),
        ("a,2,3,4,5", "x must be a number, got 'a'"),
        ("1,2,3,,5", "φ must be a number, got ''"),
        ("nan,2,3,4,5", "x must be a finite number, got nan"),
        ("-inf,2,3,4,5", "x must be a finite number, got -inf"),
        ("1,2,3,4,1e200", r"θ must lie within ±1e\+09"),
    ],
)
def test_broken_poses(here: Run, pose: str, said: str) -> None:
    assert re.search(said, refused(here("ik", "rpur-table1", "--pose", pose)))


# --- forward kinematics ---------------------------------------------------------------------

FK_KEYS = {"solutions", "complex_count", "complete", "method"}  # the contract's
FK_SOLUTION_KEYS = {"pose", "working_mode", "residual", "condition", "transform"}


def test_fk_gives_all_assembly_modes_and_each_has_the_lengths(bohemia: Run) -> None:
    answer = answered(bohemia("fk", "rpur-table1", "--joints", JOINTS, "--json"))
    assert set(answer) >= FK_KEYS
    assert answer["complex_count"] == answer["expected_count"] == 1560
    assert answer["complete"] is True
    assert answer["method"]
    assert answer["seconds"] > 0
    solutions = answer["solutions"]
    assert len(solutions) == answer["real_count"] > 20
    wanted = [float(v) for v in JOINTS.split(",")]
    for solution in solutions:
        assert set(solution) >= FK_SOLUTION_KEYS
        pose = tuple(solution["pose"][k] for k in ("x", "y", "z", "phi_deg", "theta_deg"))
        lengths = _limb_lengths(pose, solution["working_mode"])
        assert lengths == pytest.approx(wanted, abs=1e-7)
        assert solution["joints"] == wanted
        assert solution["residual"] < 1e-9
        assert solution["condition"] is None or solution["condition"] >= 1
        assert solution["within_stroke"] is True
        assert np.array(solution["transform"])[:3, 3] == pytest.approx(pose[:3])
    places = {tuple(round(v, 6) for v in s["pose"].values()) for s in solutions}
    assert len(places) == len(solutions)


def test_fk_finds_the_pose_that_ik_began_from(here: Run) -> None:
    inverse = answered(here("ik", "rpur-table2", "--pose", POSE, "--json"))["solutions"]
    wanted = next(s for s in inverse if s["working_mode"] == "+++++")
    joints = ",".join(repr(v) for v in wanted["joints"])
    forward = here("fk", "rpur-table2", "--joints", joints, "--json").json["solutions"]
    pose = [float(v) for v in POSE.split(",")]
    found = [s for s in forward if list(s["pose"].values()) == pytest.approx(pose, abs=1e-6)]
    assert [s["working_mode"] for s in found] == ["+++++"]


def test_fk_holds_whatever_mode_ik_does(here: Run) -> None:
    """Nothing in the file says that limbs are merged, so all 32 modes count."""
    arguments = ("--pose", "190,30,180,20,-35", "--mode", "+-+-+", "--json")
    (wanted,) = answered(here("ik", "rpur-table2", *arguments))["solutions"]
    joints = (
        "288.65110866805077,316.3266882632849,337.70032158986197,375.37892838430844,"
        "337.1526647066503"
    )
    assert wanted["joints"] == pytest.approx([float(v) for v in joints.split(",")], abs=1e-9)
    found = answered(here("fk", "rpur-table2", "--joints", joints, "--json"))
    assert found["complete"]
    assert found["complex_count"] == 1120
    pose = pytest.approx([190.0, 30.0, 180.0, 20.0, -35.0], abs=1e-6)
    same = [s for s in found["solutions"] if list(s["pose"].values()) == pose]
    assert [s["working_mode"] for s in same] == ["+-+-+"]


def test_merged_limbs_are_in_one_mode_for_every_command(here: Run) -> None:
    there = ("--pose=-30,20,330,2,-3", "--json")
    both = here("ik", "rpur-a1a1", *there).json["solutions"]
    modes = {solution["working_mode"] for solution in both}
    assert modes == {m for m in map("".join, product("+-", repeat=5)) if m[0:3:2] == m[1:4:2]}
    volume, section = (
        answered(here(*words, "--json"))
        for words in (("volume", "rpur-a1a1"), ("section", "rpur-a1a1", "--x", "-30"))
    )
    named = "+++++,++++-,++--+,++---,--+++,--++-,----+,-----"
    for words, found in (
        (("volume", "rpur-a1a1", "--modes", named), volume),
        (("section", "rpur-a1a1", "--x", "-30", "--modes", named), section),
    ):
        again = answered(here(*words, "--json"))
        (key,) = {"volume_mm3", "area_mm2"} & set(found)
        assert again[key] == pytest.approx(found[key], rel=1e-6)
    for command in ("ik", "volume", "workspace", "section", "singularity", "map"):
        option = "--mode" if command in ("ik", "singularity") else "--modes"
        more = {"ik": ("--pose", POSE), "section": ("--x", "0")}.get(command, ())
        refused = here(command, "rpur-a1a1", *more, option, "+-+++")
        assert refused.code == 2
        assert "has no working mode '+-+++'" in refused.stderr


def test_fk_of_a_merged_design_with_and_without_mixed_modes(here: Run) -> None:
    arguments = ("fk", "rpur-a1a1", "--joints", "340,330,330,320,330", "--json")
    few, many = answered(here(*arguments)), answered(here(*arguments, "--mixed-modes"))
    assert few["complex_count"] == few["expected_count"] == 96
    assert many["complex_count"] > 1000
    assert few["complete"]
    assert many["complete"]
    for solution in few["solutions"]:
        pose = pytest.approx(list(solution["pose"].values()), abs=1e-6)
        assert any(list(other["pose"].values()) == pose for other in many["solutions"])
    assert len(many["solutions"]) > len(few["solutions"])


def test_lengths_beyond_the_strokes_are_answered_with_a_warning(bohemia: Run) -> None:
    joints = ("--joints", "320,360,345,305,410.5")
    done = bohemia("fk", "rpur-table1", *joints, "--json")
    assert done.code == 0
    assert done.stderr == ("bohemia: warning: ρ₅ = 410.5 mm is outside its stroke, 250 to 400 mm\n")
    assert done.json["solutions"]
    assert not any(s["within_stroke"] for s in done.json["solutions"])
    none = bohemia("fk", "rpur-table1", *joints, "--within-stroke", "--json")
    assert none.code == 0
    assert none.json["solutions"] == []
    assert none.json["complex_count"] == 1560


def test_no_solution_is_an_answer_that_says_why(here: Run) -> None:
    joints = ("--joints", "100,100,100,100,2000")
    done = here("fk", "rpur-table2", *joints, "--json")
    assert done.code == 0
    assert done.json["solutions"] == []
    assert done.json["notes"]
    table = here("fk", "rpur-table2", *joints)
    assert table.code == 0
    assert all(note in table.stdout for note in done.json["notes"])
    assert re.search(r"^0 real of \d+ complex solutions", table.stdout, re.M)


def test_fk_table_is_readable(here: Run) -> None:
    done = here("fk", "rpur-a1a1", "--joints", "340,330,330,320,330")
    assert done.code == 0
    assert done.stderr == ""
    assert "Joints ρ₁ = 340 mm" in done.stdout
    assert "θ (°)" in done.stdout
    rows = re.findall(r"^\d+ +([+-]{5}) .* yes", done.stdout, re.M)
    counted = re.search(
        r"^(\d+) real of 96 complex solutions \(complete: .*\); .*; [\d.]+ m?s$",
        done.stdout,
        re.M,
    )
    assert counted is not None
    assert len(rows) == int(counted[1])
    order = list(map("".join, product("+-", repeat=5)))
    assert rows == sorted(rows, key=order.index)


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        ("1,2,3", r"--joints needs 5 numbers .*ρ₁ \(mm\).*got 3"),
        ("1,2,3,4,5,6", "needs 5 numbers .*got 6"),
        ("300,300,300,300,long", "ρ₅ must be a number, got 'long'"),
        ("300,300,nan,300,300", "ρ₃ must be a finite number, got nan"),
        ("300,300,300,1e200,300", r"ρ₄ must lie within ±1e\+09"),
        ("-300,300,300,300,300", "must be positive"),
        ("300,0,300,300,300", "must be positive"),
    ],
)
def test_broken_joints(here: Run, joints: str, said: str) -> None:
    assert re.search(said, refused(here("fk", "rpur-table1", "--joints", joints)))


# --- solids --------------------------------------------------------------------------------

SOLID_KEYS = {"volume_mm3", "pieces", "triangles", "watertight", "file"}  # the contract's


def test_workspace_volume_is_the_reference(bohemia: Run) -> None:
    answer = answered(bohemia("workspace", "rpur-table1", "--phi", "0", "--theta", "0", "--json"))
    assert set(answer) >= SOLID_KEYS
    assert answer["volume_mm3"] == pytest.approx(24_501_399, rel=1e-3)
    assert abs(answer["volume_mm3"] - 24_501_399) <= answer["volume_error_mm3"]
    assert answer["pieces"] == len(answer["piece_volumes_mm3"]) > 1
    assert sum(answer["piece_volumes_mm3"]) == pytest.approx(answer["volume_mm3"], rel=1e-6)
    assert answer["triangles"] > 1000
    assert answer["watertight"] is True
    assert answer["file"] is None
    assert answer["modes"] == "all"


def test_resolutions_refine(here: Run) -> None:
    answers = [
        answered(here("workspace", "rpur-table1", "--resolution", name, "--json"))
        for name in ("preview", "normal", "fine")
    ]
    triangles = [answer["triangles"] for answer in answers]
    assert triangles == sorted(set(triangles))
    for answer, bound in zip(answers, (1e-2, 1e-3, 1e-4), strict=True):
        assert answer["volume_mm3"] == pytest.approx(24_501_399, rel=bound)


@pytest.mark.parametrize("ending", ["stl", "3mf", "ply", "glb", "OBJ"])
def test_workspace_files(here: Run, tmp_path: Path, ending: str) -> None:
    turned = ("--phi", "-20", "--theta=30")
    answer = answered(here("workspace", "rpur-table1", *turned, "-o", f"solid.{ending}", "--json"))
    assert answer["file"] == f"solid.{ending}"
    assert answer["phi_deg"] == -20
    assert answer["theta_deg"] == 30
    assert (tmp_path / f"solid.{ending}").stat().st_size > 10_000


def test_the_written_workspace_is_in_base_coordinates(bohemia: Run, tmp_path: Path) -> None:
    # Just below the surface the inverse kinematics closes within the strokes, just above not.
    answer = answered(
        bohemia("workspace", "rpur-table1", "--phi", "-2e1", "--theta=30", "-o", "a.stl", "--json")
    )
    solid = trimesh.load(tmp_path / "a.stl")
    assert isinstance(solid, trimesh.Trimesh)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(answer["volume_mm3"], rel=1e-5)
    design = load_design("rpur-table1")
    angles = np.radians([-20.0, 30.0])
    large = solid.area_faces > np.median(solid.area_faces)
    centres, normals = solid.triangles_center[large], solid.face_normals[large]
    for step, expected in ((-1.0, True), (1.0, False)):
        points = centres + step * normals
        poses = np.column_stack([points, np.broadcast_to(angles, (len(points), 2))])
        inside = machine_of(design).inverse(poses).within_stroke.any(axis=-1)
        assert np.mean(inside == expected) > 0.98


def test_working_modes(here: Run, bohemia: Run) -> None:
    def volume(*modes: str) -> float:
        answer = answered(
            here("workspace", "rpur-table1", "--resolution", "preview", *modes, "--json")
        )
        return float(answer["volume_mm3"])

    single = volume("--modes", "--+-+")
    apart = bohemia(
        "workspace", "rpur-table1", "--resolution", "preview", "--modes", "--+-+", "--json"
    )
    assert single == pytest.approx(answered(apart)["volume_mm3"], rel=1e-9)
    assert single == volume("--modes=--+-+") == volume("--modes", "−−+-+")
    every = volume("--modes", "all")
    assert every == volume() == volume("--modes", "?????")
    assert 0 < single < every
    both = volume("--modes", "--+-+, +-+-+")
    assert both == volume("--modes", "?-+-+") == volume("--modes", "+-+-+,--+-+,--+-+")
    assert single < both < every
    assert 0 < volume("--modes", "-----") < every


def test_modes_are_said(here: Run) -> None:
    arguments = ("workspace", "rpur-table1", "--resolution", "preview", "--modes", "+-+++")
    assert answered(here(*arguments, "--json"))["modes"] == ["+-+++"]
    assert "working mode +-+++" in here(*arguments).stdout


@pytest.mark.parametrize("modes", ["+-++", "+-++++", "+-+x+", "", "+-+++,", "none"])
def test_broken_modes(here: Run, modes: str) -> None:
    said = refused(here("workspace", "rpur-table1", "--modes", modes))
    assert "is not a working mode" in said
    assert "5 limbs" in said


def test_solid_table_is_readable(here: Run) -> None:
    done = here("workspace", "rpur-table1", "--phi", "15", "-o", "out.ply")
    assert done.code == 0
    assert done.stderr == ""
    assert "φ = 15°, θ = 0°" in done.stdout
    assert "mm³ ±" in done.stdout
    assert "out.ply (mm, base coordinates)" in done.stdout


APART = """mechanism = "five_rpur"
title = "Limbs too far apart to meet"
""" + "\n".join(
    f"""[[limb]]
base = [{i * 5000.0}, 0.0, 0.0]
platform = [0.0, {i}.0, {i * i}.0]
link = 150.0
stroke = [250.0, 400.0]"""
    for i in range(5)
)


def test_an_empty_workspace_is_an_answer_but_no_file(bohemia: Run, tmp_path: Path) -> None:
    (tmp_path / "apart.toml").write_text(APART, encoding="utf-8")
    done = bohemia("workspace", "apart.toml", "--json")
    assert done.code == 0
    assert done.json["volume_mm3"] == 0
    assert done.json["pieces"] == 0
    assert done.json["piece_volumes_mm3"] == []
    assert done.json["triangles"] == 0

    done = bohemia("workspace", "apart.toml", "--json", "-o", "empty.stl")
    assert done.code == 1
    assert done.stdout == ""
    assert "empty" in done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "empty.stl").exists()


def test_a_bad_but_valid_design_warns_on_stderr_only(bohemia: Run, tmp_path: Path) -> None:
    limb = "[[limb]]\nbase = [0, 0, 0]\nplatform = [0, 0, 0]\nlink = 150\nstroke = [250, 400]\n"
    (tmp_path / "same.toml").write_text('mechanism = "five_rpur"\n' + 5 * limb, encoding="utf-8")
    done = bohemia("ik", "same.toml", "--pose", "0,0,450,0,0", "--json")
    assert done.code == 0
    assert done.json["reachable"] is True
    assert done.stderr.startswith("bohemia: warning: ")


@pytest.mark.parametrize(
    ("output", "said"),
    [
        ("solid.step", r"ending \.step; .*\.stl, \.3mf, \.ply, \.glb, \.obj"),
        ("solid", "has no ending; .*one of"),
        ("missing/solid.stl", "there is no folder 'missing'"),
        ("folder.stl", "it is a folder"),
    ],
)
def test_unwritable_files(here: Run, tmp_path: Path, output: str, said: str) -> None:
    (tmp_path / "folder.stl").mkdir()
    assert re.search(said, refused(here("workspace", "rpur-table1", "-o", output)))


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_one_sentence(bohemia: Run, tmp_path: Path) -> None:
    (tmp_path / "full.stl").symlink_to("/dev/full")
    done = bohemia("workspace", "rpur-table1", "--resolution", "preview", "-o", "full.stl")
    assert "cannot write 'full.stl'" in refused(done)


def test_vertex_space_and_its_parts(here: Run) -> None:
    def volume(part: str) -> float:
        answer = answered(
            here("vertex-space", "rpur-table1", "--limb", "3", "--part", part, "--json")
        )
        assert set(answer) >= SOLID_KEYS
        assert answer["watertight"] is True
        return float(answer["volume_mm3"])

    # Closed forms of spec and quadrature; see kinematics.five_rpur.solid.vertex_space.
    half = 2 * 150 * np.pi * (400**2 - 250**2)
    assert volume("plus") == pytest.approx(half, rel=1e-3)
    assert volume("minus") == pytest.approx(half, rel=1e-3)
    assert volume("whole") == pytest.approx(159_557_800, rel=1e-3)
    left = volume("body") - volume("h1") - volume("H2") - volume("H3")
    assert left == pytest.approx(volume("whole"), rel=2e-3)


def test_vertex_space_stands_about_its_limb(here: Run, tmp_path: Path) -> None:
    arguments = ("vertex-space", "rpur-table1", "--limb", "2", "-o", "b.stl", "--json")
    assert answered(here(*arguments))["solid"] == "limb2/whole"
    solid = trimesh.load(tmp_path / "b.stl")
    assert isinstance(solid, trimesh.Trimesh)
    # Symmetric about A_2 − s'_2 in all three directions: x ± ρ_max, y ± l, z ± (ρ_max + l).
    centre = np.array([245.0, 30.0, 50.0]) - np.array([50.0, 0.0, 0.0])
    reach = np.array([400.0, 150.0, 550.0])
    assert solid.bounds == pytest.approx(np.array([centre - reach, centre + reach]), abs=1.5)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--limb", "0"], "--limb must be one of 1, 2, 3, 4, 5, got '0'"),
        (["--limb", "6"], "--limb must be one of"),
        (["--limb", "two"], "--limb must be one of"),
        (["--limb", "1", "--part", "H4"], "--part must be one of whole, plus, minus, body, H1"),
        ([], "required: --limb"),
    ],
)
def test_broken_limbs_and_parts(here: Run, arguments: list[str], said: str) -> None:
    assert said in refused(here("vertex-space", "rpur-table1", *arguments))


@pytest.mark.skipif(os.name != "posix", reason="needs a pseudo-terminal")
def test_progress_is_shown_on_a_terminal_only() -> None:
    parent, child = os.openpty()
    done = subprocess.run(
        [sys.executable, "-m", "app", "workspace", "rpur-table1", "--json"],
        env=command_environment(),
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=child,
        timeout=120,
        check=True,
    )
    os.close(child)
    shown = os.read(parent, 4096).decode()
    os.close(parent)
    assert "workspace, normal …" in shown
    assert shown.endswith("\r\x1b[K")
    assert done.stdout.startswith(b"{")


# --- serve ---------------------------------------------------------------------------------


@contextmanager
def serving(tmp_path: Path, *arguments: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """`bohemia` with these arguments as a process, and the address that it prints."""
    log = tmp_path / "serve.log"
    with log.open("w", encoding="utf-8") as output:
        process = subprocess.Popen(
            [sys.executable, "-m", "app", *arguments],
            cwd=tmp_path,
            env={**command_environment(), "PYTHONWARNINGS": "default"},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            text=True,
        )
    try:
        while (found := re.search(r"http://\S+", log.read_text(encoding="utf-8"))) is None:
            assert process.poll() is None, log.read_text(encoding="utf-8")
            time.sleep(0.05)
        yield process, found[0]
    finally:
        process.kill()
        process.wait()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


@pytest.mark.parametrize(
    ("command", "stop"), [(("serve", "rpur-table2"), signal.SIGINT), ((), signal.SIGTERM)]
)
def test_serve_answers_and_stops(
    tmp_path: Path, command: tuple[str, ...], stop: signal.Signals
) -> None:
    port = free_port()
    with serving(tmp_path, *command, "--no-browser", "--port", str(port)) as (process, address):
        assert address == f"http://127.0.0.1:{port}"
        with urllib.request.urlopen(address, timeout=30) as answer:
            assert answer.status == 200
            assert b"<html" in answer.read().lower()
        process.send_signal(stop)
        assert process.wait(timeout=30) == 0


def test_serve_prints_the_port_that_it_really_has(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with serving(tmp_path, "--no-browser", "--port", str(port)) as (_, address):
            assert address != f"http://127.0.0.1:{port}"
            with urllib.request.urlopen(address, timeout=30) as answer:
                assert answer.status == 200


def test_serve_says_that_a_session_goes_before_a_design(tmp_path: Path) -> None:
    session = tmp_path / "review.json"
    session.write_text("not a session", encoding="utf-8")
    code = (
        "import sys, types, app.cli\n"
        "server = types.ModuleType('app.server')\n"
        "server.run = lambda *arguments, **options: None\n"
        "sys.modules['app.server'] = server\n"
        f"app.cli.main(['serve', 'rpur-table2', '--session', {str(session)!r}])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=command_environment(),
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert "review.json holds a review, which is opened instead of rpur-table2" in done.stderr


def test_a_design_alone_is_served(bohemia: Callable[..., Finished], tmp_path: Path) -> None:
    taken = bohemia("rpur-table2", "--port", "none")
    assert taken.code == 2
    assert "--port" in taken.stderr  # of serve, not of an unknown command
    missing = bohemia(str(tmp_path / "my.toml"), "--no-browser")
    assert missing.code == 2
    assert "my.toml" in missing.stderr
