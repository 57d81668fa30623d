"""`bohemia micr`, and ik, fk, velocity, statics and singularity of the 3-RPS and 3-SPR."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app import cli
from tests.conftest import Finished, answered, refused

Run = Callable[..., Finished]


@pytest.fixture
def here(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Run:
    """As `bohemia`, but in this process."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> Finished:
        code = cli.main(arguments)
        return Finished(code, *capsys.readouterr())

    return run


EXAMPLE = ("--base", "100", "--platform", "200", "--altitude", "100")


def test_micr_as_a_process(bohemia: Run) -> None:
    found = answered(bohemia("micr", "three_spr", *EXAMPLE, "--json"))
    assert found["mode1_deg"] == pytest.approx(25.180332377705, abs=1e-11)
    assert found["mode2_deg"] == pytest.approx(30.0, abs=1e-12)
    rps = answered(bohemia("micr", "three_rps", *EXAMPLE, "--json"))
    assert rps["mode1_deg"] == pytest.approx(27.338882090732, abs=1e-11)
    assert rps["mode2_deg"] == pytest.approx(39.219478757478, abs=1e-11)


def test_micr_tells_of_the_paper(here: Run) -> None:
    told = here("micr", "three_spr", *EXAMPLE).stdout
    assert "25.180332378" in told
    assert "25.22" in told
    assert "30.38" in told
    assert "0.01 rad" in told


def test_no_singular_tilt_is_null(here: Run) -> None:
    found = answered(
        here("micr", "three_spr", "--base", "1", "--platform", "1", "--altitude", "1.5", "--json")
    )
    assert found["mode2_deg"] is None
    assert found["mode2_crosses_ring"]


def test_curves_as_files(here: Run, tmp_path: Path) -> None:
    run = ("micr", "three_rps", "--curves", "--ratios", "0.5,2", "--heights", "0.5:1.5:11")
    found = answered(here(*run, "-o", "c.csv", "--json"))
    rows = list(csv.DictReader(io.StringIO((tmp_path / "c.csv").read_text())))
    assert len(rows) == 2 * 2 * 11
    row = next(
        r
        for r in rows
        if (r["mode"], r["h2_over_h1"]) == ("1", "2.0") and float(r["z_over_h1"]) == 1.0
    )
    assert float(row["micr_deg"]) == pytest.approx(27.338882090732, abs=1e-11)
    assert np.shape(found["mode1_deg"]) == (2, 11)
    assert here(*run, "-o", "c.svg").code == 0
    assert (tmp_path / "c.svg").read_text().lstrip().startswith("<?xml")
    assert "c.svg" in here(*run, "-o", "c.svg").stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("micr", "three_rps"), "--base, --platform and --altitude are needed"),
        (("micr", "three_xps", *EXAMPLE), "there is no mechanism 'three_xps'"),
        (("micr", "five_rpur", *EXAMPLE), "no maximum inscribed circle"),
        (("micr", "three_rps", *EXAMPLE[:5], "0"), "altitude must not be 0"),
        (("micr", "three_rps", "--base", "-3", *EXAMPLE[2:]), "must be positive"),
        (("micr", "three_rps", *EXAMPLE, "-o", "x.csv"), "-o goes with --curves"),
        (("micr", "three_rps", "--curves", "--base", "1"), "leave it out with --curves"),
        (("micr", "three_rps", "--curves", "--heights", "1:2"), "from:to:count"),
        (("micr", "three_rps", "--curves", "--ratios", "0"), "must be positive"),
        (("micr", "three_rps", "--curves", "-o", "x.pdf"), "written as one of"),
        (("ik", "spr-3", "--pose", "100,20"), "needs 3 numbers"),
        (("ik", "spr-3", "--pose", "100,20,0", "--mode", "3"), "not an operation mode"),
    ],
)
def test_what_is_refused(here: Run, arguments: tuple[str, ...], message: str) -> None:
    assert message in refused(here(*arguments))


def test_the_volume_is_that_of_the_solid(here: Run) -> None:
    found = answered(here("volume", "rps-3", "--tolerance", "0.01", "--json"))
    solid = answered(here("workspace", "rps-3", "--json"))
    assert found["modes"] == solid["modes"] == ["2"]
    for key, other in (("volume_mm3", "volume_mm3"), ("error_mm3", "volume_error_mm3")):
        assert found[key] == solid[other] > 0.0
    assert found["pieces"] == 2
    assert sum(found["piece_volumes_mm3"]) == pytest.approx(found["volume_mm3"])
    assert "3-RPS" in refused(here("volume", "rps-3", "--usable"))


def test_inverse_and_forward_kinematics_close(bohemia: Run) -> None:
    ik = answered(bohemia("ik", "rps-3", "--pose", "283,20,30", "--mode", "2", "--json"))
    (solution,) = ik["solutions"]
    assert solution["operation_mode"] == "2"
    assert solution["within_stroke"]
    joints = ",".join(repr(r) for r in solution["joints"])
    fk = answered(bohemia("fk", "rps-3", "--joints", joints, "--json"))
    assert fk["complex_count"] == 16
    assert fk["complete"]
    assert {s["operation_mode"] for s in fk["solutions"]} <= {"1", "2"}
    apart = [
        np.abs(np.array(s["transform"]) - np.array(solution["transform"])).max()
        for s in fk["solutions"]
        if s["operation_mode"] == "2"
    ]
    assert min(apart) < 1e-8


def test_both_modes_are_told_with_their_own_transforms(here: Run) -> None:
    found = answered(here("ik", "rps-3", "--pose", "283,0,0", "--json"))
    one, two = (np.array(s["transform"])[:3, :3] for s in found["solutions"])
    np.testing.assert_allclose(one, np.diag([-1.0, -1.0, 1.0]), atol=1e-12)
    np.testing.assert_allclose(two, np.eye(3), atol=1e-12)


def test_an_altitude_without_a_position_is_an_answer(here: Run) -> None:
    found = answered(here("ik", "spr-3", "--pose", "100,90,30", "--json"))
    assert found["solutions"] == []
    assert "X and Y go to infinity" in found["reasons"][0]


def test_singularity_of_a_pose_and_as_curves(here: Run, tmp_path: Path) -> None:
    found = answered(here("singularity", "spr-3", "--pose", "100,30,-30", "--mode", "2", "--json"))
    assert found["singular"]
    assert found["kinds"] == ["parallel"]
    over = answered(here("singularity", "rps-3", "--pose", "283,180,10", "--mode", "1", "--json"))
    assert over["kinds"] == ["constraint"]
    chart = ("singularity", "spr-3", "--pose", "100,0,0", "--mode", "2", "--chart", "orientation")
    curves = answered(here(*chart, "-o", "l.svg", "--json"))
    assert curves["residual"] < 1e-6
    assert {c["kind"] for c in curves["curves"]} == {"parallel", "constraint"}
    assert min(p[0] for c in curves["curves"] for p in c["points"]) == pytest.approx(30.0)
    assert (tmp_path / "l.svg").exists()


def test_velocity_and_statics(here: Run) -> None:
    pose = ("--pose", "283,15,40", "--mode", "2", "--json")
    moved = answered(here("velocity", "rps-3", *pose, "--rates", "10,5,-8"))
    rates = ",".join(repr(v) for v in moved["joint_rates"])
    back = answered(here("velocity", "rps-3", *pose, "--joint-rates", rates))
    assert back["rates"]["z"] == pytest.approx(10.0)
    assert back["rates"]["tilt_deg"] == pytest.approx(5.0)
    held = answered(here("statics", "rps-3", *pose, "--load", "0,0,-100,0,0,0"))
    assert len(held["forces"]) == 6
    assert held["residual"] < 1e-12
