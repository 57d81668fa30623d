"""The five-bar and trajectories on the command line."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.features.move.state import Drive, Visit
from app.review import view
from app.review.changes import change
from app.review.state import new_review
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.conftest import Finished, answered, refused

Run = Callable[..., Finished]


def test_ik_fk_and_singularity(here: Run) -> None:
    found = answered(here("ik", "five-bar", "--pose", "0,738.644", "--json"))
    modes = {each["working_mode"]: each["joints"] for each in found["solutions"]}
    np.testing.assert_allclose(modes["+-"], [108.0, 72.0], atol=1e-4)
    assert len(modes) == 4
    joints = ",".join(map(repr, modes["+-"]))
    both = answered(here("fk", "five-bar", "--joints", joints, "--json"))
    assert both["complex_count"] == 2
    assert both["complete"]
    assert any(abs(each["pose"]["y"] - 738.644) < 1e-9 for each in both["solutions"])
    assert both["solutions"][0]["transform"][2] == [0.0, 0.0, 1.0, 0.0]
    lost = answered(here("singularity", "five-bar", "--pose", "0,738.644", "--json"))
    assert lost["working_mode"] == "+-"
    chart = here(
        "singularity", "five-bar", "--pose", "0,700", "--chart", "plane", "-o", "chart.svg"
    )
    assert chart.code == 0, chart.stderr


def test_workspace_is_a_plane_region(bohemia: Run, tmp_path: Path) -> None:
    found = answered(bohemia("workspace", "five-bar", "--json", "-o", "plane.dxf"))
    assert f"{found['area_mm2'] / 100:.6f}" == "19833.838618"
    assert (found["volume_mm3"], found["triangles"], found["watertight"]) == (0.0, 0, False)
    (region,) = found["regions"]
    assert [edge["kind"] for edge in region["loops"][0]] == ["arc"] * 3
    assert (tmp_path / "plane.dxf").read_text().count("ARC") >= 3


def test_aspects_by_mode(here: Run, tmp_path: Path) -> None:
    found = answered(
        here("workspace", "five-bar", "--regions", "aspects", "--modes", "+-", "--json")
    )
    assert len(found["regions"]) == 3
    assert found["area_mm2"] == pytest.approx(1983383.86178738)
    assert {region["sign"] for region in found["regions"]} == {1, -1}
    for name in ("a.svg", "a.csv", "a.dxf"):
        done = here("workspace", "five-bar", "--regions", "aspects", "--modes", "+-", "-o", name)
        assert done.code == 0, done.stderr
        assert "group" in done.stdout
        assert (tmp_path / name).stat().st_size > 1000
    rows = list(csv.DictReader(io.StringIO((tmp_path / "a.csv").read_text())))
    assert {row["bound"] for row in rows} == {"link", "parallel"}
    assert len({row["piece"] for row in rows}) == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("workspace", "five-bar", "--regions", "solid"), "--regions must be one of"),
        (("workspace", "five-bar", "-o", "a.stl"), ".svg, .dxf, .csv"),
        (("workspace", "five-bar", "--modes", "+"), "--modes"),
        (("vertex-space", "five-bar", "--limb", "1"), "no vertex spaces"),
        (("ik", "five-bar", "--pose", "1,2,3"), "--pose needs 2 numbers"),
        (("trajectory", "five-bar", "circle"), "paths by name are line, rest-to-rest"),
        (("trajectory", "five-bar", "line", "--law", "septic"), "no time law 'septic'"),
        (("trajectory", "five-bar", "line", "--duration", "0"), "a duration must lie between"),
        (("trajectory", "five-bar", "line", "--samples", "1"), "samples"),
        (("trajectory", "five-bar", "line", "--samples", "x"), "--samples must be a whole number"),
        (("trajectory", "five-bar", "line", "--load", "1,2"), "--load needs 6 numbers"),
        (("trajectory", "five-bar", "line", "--blend", "3"), "--through lines"),
        (("trajectory", "five-bar", "line", "--max-forces", "3,3"), "goes with --load"),
        (
            ("trajectory", "five-bar", "line", "--max-rates", "3,"),
            "--max-rates: θ₂ must be a number",
        ),
        (("trajectory", "five-bar", "line", "--max-rates", "3,4,5"), "θ₂ (degrees/s); got 3"),
        (("volume", "five-bar"), "bohemia workspace five-bar gives its area"),
        (("section", "five-bar", "--x", "3"), "lies in a plane"),
        (("trajectory", "five-bar", "line", "--mode", "+++"), "--mode"),
        (("trajectory", "five-bar", "line", "-o", "a.txt"), ".csv"),
        (("trajectory", "five-bar", "line", "--fit", "99"), "degree"),
    ],
)
def test_mistakes_are_one_sentence(here: Run, arguments: tuple[str, ...], said: str) -> None:
    assert said in refused(here(*arguments))


def test_the_paper_s_trajectory_as_a_process(bohemia: Run, tmp_path: Path) -> None:
    done = bohemia(
        "trajectory", "five-bar", "rest-to-rest", "--fit", "8", "--samples", "201",
        "--load", "0,-100,0,0,0,0", "--json", "-o", "way.csv",
    )  # fmt: skip
    found = answered(done)
    assert found["working_mode"] == "+-"
    assert found["sound"]
    assert found["events"] == []
    samples = found["samples"]
    assert len(samples["t"]) == 201
    assert samples["theta1_deg"][0] == pytest.approx(108.0, abs=1e-4)
    assert min(samples["singularity_mm"]) == pytest.approx(102.834, abs=1e-3)
    assert len(samples["force_actuation1_Nmm"]) == 201
    fit = found["fit"]
    assert f"{fit['coefficients']['theta2'][8]:.6f}" == "0.009799"
    assert fit["error"]["x"]["deviation"] == pytest.approx(0.0192158, rel=1e-5)
    assert fit["error"]["y_per_s2"]["deviation"] == pytest.approx(57.095236, rel=1e-6)
    rows = list(csv.DictReader(io.StringIO((tmp_path / "way.csv").read_text())))
    assert len(rows) == 201
    assert float(rows[-1]["y"]) == pytest.approx(450.0)
    again = answered(bohemia("trajectory", "five-bar", "way.csv", "--samples", "201", "--json"))
    np.testing.assert_allclose(
        again["samples"]["theta1_deg_per_s"], samples["theta1_deg_per_s"], atol=2e-2
    )
    assert again["duration_s"] == 2.0


def test_points_from_a_file(here: Run, tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("\ufeffx;y\n0;700\n100;600\n\n200;650\n")
    spline = answered(here("trajectory", "five-bar", "p.csv", "--json"))
    assert spline["law"] == "quintic"
    assert spline["duration_s"] == pytest.approx(spline["length_mm"] / 100.0)
    lines = answered(
        here("trajectory", "five-bar", "p.csv", "--through", "lines", "--blend", "20",
             "--law", "trapezoidal", "--duration", "4", "--mode", "++", "--json")
    )  # fmt: skip
    assert lines["length_mm"] < spline["length_mm"]
    assert lines["duration_s"] == 4.0
    assert lines["working_mode"] == "++"
    (tmp_path / "far.csv").write_text("x,y\n0,700\n0,1500\n")
    done = here("trajectory", "five-bar", "far.csv")
    assert done.code == 0
    assert "leaves the workspace" in done.stdout
    out = answered(here("trajectory", "five-bar", "far.csv", "--json"))
    assert not out["sound"]
    assert out["samples"]["theta1_deg"][-1] is None
    assert out["events"][0]["kind"] == "outside"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "must name a column x"),
        ("x,z\n1,2\n3,4\n", "must name a column y"),
        ("x,y\n1,2\n", "at least two points"),
        ("x,y\n1,2\n3\n", "line 3: 2 columns are named, found 1"),
        ("x,y\n1,2\n3,up\n", "line 3: y must be a number, got 'up'"),
        ("x,y\n1,2\n3,inf\n", "line 3: y must be a finite number"),
        ("t,x,y\n0,1,2\n0,3,4\n", "line 3: t must increase"),
        ("x,y\n0,700\n0,700\n", "line 3: point 2 of the path is the same"),
        ("x,y\n0,700\n\n9,700\n9,700.0\n", "line 5: point 3 of the path is the same"),
    ],
)
def test_broken_files(here: Run, tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "p.csv").write_text(text)
    assert said in refused(here("trajectory", "five-bar", "p.csv"))


def test_times_choose_the_law(here: Run, tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("t,x,y\n0,0,700\n1,50,650\n3,100,640\n")
    found = answered(here("trajectory", "five-bar", "p.csv", "--json"))
    assert found["duration_s"] == 3.0
    assert found["samples"]["x"][0] == 0.0
    assert "no law to choose" in refused(here("trajectory", "five-bar", "p.csv", "--law", "cubic"))


def test_degrees_in_files_of_the_5_rpur(here: Run, tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("x,y,z,phi_deg,theta\n-10,100,450,5,-3\n-5,95,455,6,-2\n")
    found = answered(
        here("trajectory", "rpur-table1", "p.csv", "--mode", "+-+-+", "--samples", "5", "--json")
    )
    np.testing.assert_allclose(
        [found["samples"][key][-1] for key in ("phi_deg", "theta_deg")], [6.0, -2.0]
    )


def test_a_dependent_coordinate_may_be_left_out(here: Run, tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text("x,y,z,alpha,beta\n0,0,569,0,0\n10,5,575,3,2\n")
    found = answered(here("trajectory", "sps-spr", "p.csv", "--samples", "9", "--json"))
    assert found["sound"]
    assert found["samples"]["beta_deg"][-1] == pytest.approx(2.0)
    assert None not in found["samples"]["gamma_deg"]
    (tmp_path / "q.csv").write_text("x,y,z,alpha\n0,0,569,0\n10,5,575,3\n")
    assert "must name a column beta_deg" in refused(here("trajectory", "sps-spr", "q.csv"))


@pytest.mark.parametrize("degree", [3, 8, 20])
def test_printed_polynomials_are_as_good_as_their_error(here: Run, degree: int) -> None:
    from kinematics.designs.files import load_design

    words = ("trajectory", "five-bar", "rest-to-rest", "--fit", str(degree), "--samples", "201")
    text = here(*words).stdout
    whole = answered(here(*words, "--json"))
    times = np.array(whole["samples"]["t"])
    joints = []
    for symbol in ("θ₁", "θ₂"):
        (line,) = [line for line in text.splitlines() if line.startswith(f"{symbol}(t) = ")]
        formula = line.partition(" = ")[2].removesuffix(" rad").replace("^", "**")
        formula = re.sub(r"(\d)t", r"\1*t", formula)
        joints.append(eval(formula, {"t": times}))  # what is printed is a formula
    design = load_design("five-bar")
    poses = np.column_stack([whole["samples"]["x"], whole["samples"]["y"]])
    error = []
    for pose, row in zip(poses.tolist(), np.stack(joints, axis=1).tolist(), strict=True):
        posture = machine_of(design).inverse.posture(pose, "+-")
        error.append(
            np.subtract(machine_of(design).following.follow(posture, row).posture.pose, pose)
        )
    told = [whole["fit"]["error"][key]["deviation"] for key in "xy"]
    np.testing.assert_allclose(
        np.std(error, axis=0, ddof=1), told, rtol=0.0101 if degree < 20 else 0.05
    )
    if degree == 8:  # eqs. 18 and 19: what the paper prints is there, and more
        assert "0.0389033" in text
        assert "0.0097993" in text


def test_why_there_is_no_true_error(here: Run) -> None:
    words = ("trajectory", "five-bar", "rest-to-rest", "--fit", "1")
    text = here(*words).stdout
    assert "No true error: driven by these polynomials the machine does not come through" in text
    assert "parallel singularity" in answered(here(*words, "--json"))["fit"]["trouble"]


@pytest.mark.parametrize("form", [("{}", "--"), ("{}=--",), ("{}", "−−"), ("{}", " --")])
def test_the_mode_of_two_minus_signs(here: Run, tmp_path: Path, form: tuple[str, ...]) -> None:
    """argparse would take it for the end of the options."""
    mode = [word.format("--mode") for word in form]
    modes = [word.format("--modes") for word in form]
    (tmp_path / "p.csv").write_text("x,y\n0,804\n100,700\n")
    found = answered(here("workspace", "five-bar", *modes, "--json"))
    assert f"{found['area_mm2'] / 100:.6f}" == "19833.838618"
    assert found["modes"] == ["--"]
    found = answered(here("trajectory", "five-bar", "p.csv", *mode, "--samples", "5", "--json"))
    assert found["working_mode"] == "--"
    for command in ("singularity", "velocity", "statics"):
        extra = {"velocity": ["--rates", "1,-2"], "statics": ["--load", "0,-5,0,0,0,0"]}
        found = answered(
            here(command, "five-bar", "--pose", "0,700", *mode, *extra.get(command, []), "--json")
        )
        assert found["working_mode"] == "--"
    (one,) = answered(here("ik", "five-bar", *mode, "--pose", "0,700", "--json"))["solutions"]
    assert one["working_mode"] == "--"


def test_modes_that_begin_with_minus_signs(here: Run) -> None:
    pose = ("--pose", "-10,100,450,5,-3")
    for mode in ("-++++", "-----", "--+--"):
        for words in (("--mode", mode), (f"--mode={mode}",)):
            (one,) = answered(here("ik", "rpur-table1", *pose, *words, "--json"))["solutions"]
            assert one["working_mode"] == mode
    found = answered(here("volume", "rpur-table1", "--modes", "-----", "--json"))
    assert found["modes"] == ["-----"]
    assert "'--phi=3' is not a working mode" in refused(
        here("volume", "rpur-table1", "--modes", "--phi=3")
    )
    assert "--pose needs 2 numbers" in refused(here("ik", "five-bar", "--pose", "--"))
    assert "--pose: x" in refused(here("ik", "five-bar", "--pose=--,3"))


def test_the_mode_of_two_minus_signs_as_a_process(bohemia: Run) -> None:
    done = bohemia("workspace", "five-bar", "--modes", "--", "--json")
    assert answered(done)["modes"] == ["--"]
    done = bohemia("trajectory", "five-bar", "line", "--mode=--", "--samples", "3", "--json")
    assert answered(done)["working_mode"] == "--"


def test_a_path_with_corners_and_where_it_is_fastest(here: Run, tmp_path: Path) -> None:
    (tmp_path / "good.csv").write_text("x,y\n0,804\n100,700\n-100,600\n")
    words = ("trajectory", "five-bar", "good.csv", "--through", "lines", "--law", "linear")
    text = here(*words, "--max-accelerations", "100,100").stdout
    assert "sharp corner at t = 1.4428 s, x = 100.00 mm, y = 700.00 mm" in text
    assert "∞ at 1.443 s" in text
    assert "at speed at t = 0 s and t = 3.67884 s" in text
    assert "no limit exceeded" not in text
    found = answered(here(*words, "--json"))
    assert [event["kind"] for event in found["events"]] == ["corner"]
    assert found["largest"]["theta1_deg_per_s2"]["value"] is None
    assert found["largest"]["theta2_deg_per_s"]["value"] == pytest.approx(14.0466, abs=1e-4)
    assert found["moving_at_ends"] == [True, True]
    assert not found["sound"]
    load = ("--load", "0,-100,0,0,0,0", "--max-forces", "100")
    found = answered(here("trajectory", "five-bar", "rest-to-rest", *load, "--json"))
    forces = [abs(v) for v in found["samples"]["force_actuation1_Nmm"]]
    assert found["largest"]["force_actuation1_Nmm"]["value"] >= max(forces)
    assert found["largest"]["theta2_deg_per_s"]["t"] == pytest.approx(1.0354, abs=1e-3)
    assert found["moving_at_ends"] == [False, False]


def test_one_limit_for_all_joints(here: Run) -> None:
    one = here("trajectory", "five-bar", "rest-to-rest", "--max-rates", "30", "--json")
    each = here("trajectory", "five-bar", "rest-to-rest", "--max-rates", "30,30", "--json")
    assert answered(one)["events"] == answered(each)["events"]
    (event,) = answered(one)["events"]
    assert event["kind"] == "rate"
    assert "its limit, 30 °/s" in event["text"]
    assert event["start_s"] < event["worst_at_s"] < event["end_s"]


def test_what_the_head_says_of_a_path(here: Run, tmp_path: Path) -> None:
    def head(*words: str) -> str:
        return here("trajectory", "five-bar", *words).stdout.splitlines()[1]

    assert head("rest-to-rest") == "Straight line from rest to rest, quintic, working mode +-, 2 s"
    assert head("rest-to-rest", "--law", "cubic") == (
        "The way of rest-to-rest, working mode +-, cubic, 2 s"
    )
    (tmp_path / "p.csv").write_text("t,x,y\n0,0,700\n1,-50,650\n3,100,640\n")
    assert head("p.csv") == "p.csv, working mode +-, by its times, 3 s"
    (tmp_path / "out.csv").write_text("x,y\n-69.65,804\n-69.65,3000\n")
    assert "x = −69.65 mm" in here("trajectory", "five-bar", "out.csv").stdout


RANGED = """
mechanism = "five_bar"
title = "Ranged"
proximal = 480.0
distal = 480.0
half_base = 240.0
joint_range_deg = [[0.0, 90.0], [75.0, 180.0]]
"""


def test_angles_beyond_their_range_are_told_in_degrees(here: Run, tmp_path: Path) -> None:
    (tmp_path / "ranged.toml").write_text(RANGED)
    text = here("ik", "ranged.toml", "--pose", "0,738.644").stdout
    (line,) = [line for line in text.splitlines() if line.startswith("+- ")]
    assert line.endswith("θ₁ 18.0° beyond its range, θ₂ 3.0° below its range")
    assert "too long" not in text
    assert "too short" not in text


def test_a_joint_that_a_pose_leaves_free(here: Run) -> None:
    done = here("ik", "five-bar", "--pose=-240,0")
    assert done.stdout.count("yes, θ₁ is free") == 4
    assert done.stderr.startswith("bohemia: warning: at this pose θ₁ is free")
    assert "limb 1 may turn as it likes" in done.stderr
    found = here("ik", "five-bar", "--pose=-240,0", "--json").json
    assert [each["free_joints"] for each in found["solutions"]] == [["theta1"]] * 4
    (warning,) = found["warnings"]
    assert "θ₁ is free" in warning
    # Stretched it is not free, nor anywhere else.
    for pose in ("0,929.5160030897801", "10,700", "-240,1e-3"):
        found = answered(here("ik", "five-bar", "--pose", pose, "--json"))
        assert found["warnings"] == []
        assert not any(each["free_joints"] for each in found["solutions"])


def test_how_far_a_machine_gets_that_is_driven_along_a_path(here: Run, tmp_path: Path) -> None:
    (tmp_path / "down.csv").write_text("x,y\n0,804\n0,300\n")
    answer = answered(here("trajectory", "five-bar", "down.csv", "--json"))
    driven = answer["driven"]
    assert driven["stop"] == "singularity"
    assert driven["pose"]["y"] == pytest.approx((480.0**2 - 240.0**2) ** 0.5, abs=0.01)
    assert driven["share"] == pytest.approx((804.0 - driven["pose"]["y"]) / 504.0, abs=1e-6)
    assert "A machine driven along it stops at" in here("trajectory", "five-bar", "down.csv").stdout
    (tmp_path / "fine.csv").write_text("x,y\n0,804\n100,700\n")
    assert answered(here("trajectory", "five-bar", "fine.csv", "--json"))["driven"] is None


def test_a_crank_without_a_range_has_no_stroke_to_be_outside_of(
    here: Run, tmp_path: Path, root: Path
) -> None:
    turned = answered(here("fk", "five-bar", "--joints", "190,-370", "--json"))
    assert turned["warnings"] == []
    assert "stroke" not in here("fk", "five-bar", "--joints", "190,-10").stderr
    text = (root / "assets/designs/five-bar.toml").read_text()
    (tmp_path / "ranged.toml").write_text(f"joint_range_deg = [[-179, 180], [0, 175]]\n{text}")
    ranged = json.loads(here("fk", "ranged.toml", "--joints", "190,176", "--json").stdout)
    assert ["θ₁ = 190°" in each for each in ranged["warnings"]] == [True, False]
    home = new_review(load_design("five-bar"))
    (found,) = home.machine.forward([(math.radians(178.0), math.radians(140.0))])
    there, _ = change(home, Visit(tuple(found.poses[0].tolist()), found.modes[0]))
    on, note = change(there, Drive(0, math.radians(185.0)))
    assert note == ""
    for review in (there, on):
        row = view.joint_rows(home.machine, review.posture)[0]
        assert abs(row.value) > 174.0
        assert (row.level, row.note) == ("good", "")
