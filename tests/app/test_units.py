"""--units: the same answers in another unit, printed and in files."""

from __future__ import annotations

import csv
import io
import json
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from app.terminal.lengths import csv_in, line_in
from kinematics.lengths import UNITS
from tests.conftest import Finished

Run = Callable[..., Finished]
OTHERS = [unit for unit in UNITS if unit != "mm"]
SIZE = {unit: float(mm) for unit, mm in UNITS.items()}
SOLID = ("workspace", "rps-3", "--modes", "1", "--resolution", "preview")


# --- what is printed -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("Pose x = 25.4 mm, y = -508 mm, φ = 5°", "Pose x = 1 inch, y = -20 inch, φ = 5°"),
        ("volume 6\u202f001\u202f738 mm³ ± 4.4 mm³", "volume 366.2485 inch³ ± 0.000269 inch³"),
        ("area 100.00 cm²", "area 15.5 inch²"),
        ("centroid (25.4000, 0.0000, -50.8000) mm", "centroid (1, 0, -2) inch"),
        ("edges 25.4 × 50.8 × 76.2 mm", "edges 1 × 2 × 3 inch"),
        ("between 25.4 mm and 50.8 mm", "between 1 inch and 2 inch"),
        ("v = (25.4, 0, 1) mm/s", "v = (1, 0, 0.0393701) inch/s"),
        ("torque 3.5 N·mm of 2 N, 4 limbs", "torque 3.5 N·mm of 2 N, 4 limbs"),
        ("7 commas, limb 2", "7 commas, limb 2"),
        ("exact to 2.5e-07 mm", "exact to 9.84e-09 inch"),
    ],
)
def test_numbers_before_a_unit_are_turned_over(line: str, told: str) -> None:
    assert line_in(line, "mm") == line
    assert line_in(line, "inch") == told


@given(st.text(st.sampled_from("0123456789 .,-e±×()mc²³ /\n"), max_size=60))
def test_no_line_is_too_strange(line: str) -> None:
    line_in(line, "m")


COMMANDS = {
    "ik": "ik rpur-table1 --pose 326,73,211,0,0 --mode home",
    "fk": "fk rps-3 --joints 300,310,320",
    "section": "section rpur-table1 --phi 0 --theta 0 --x 50",
    "regions": "workspace five-bar --regions modes",
    "velocity": "velocity rps-3 --pose 300,5,0 --rates 1,2,3",
    "statics": "statics five-bar --pose 100,300 --load 1,2,0,0,0,0",
    "singularity": "singularity five-bar --pose 100,300",
    "solid": " ".join(SOLID),
    "trajectory": "trajectory five-bar way.csv",
}
NUMBER = re.compile(r"[-−]?\d[\d\u202f,]*(?:\.\d+)?(?:e[+-]?\d+)?")


def _numbers(text: str) -> list[float]:
    return [float(re.sub("[\u202f,]", "", n).replace("−", "-")) for n in NUMBER.findall(text)]


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_each_printed_number_is_the_same_or_in_the_unit(here: Run, words: str) -> None:
    """Times that were taken aside, each number is the one of mm times a power of the factor."""
    Path("way.csv").write_text("x,y\n-60,250\n60,260\n0,300\n", encoding="utf-8")
    one = re.sub(r"[\d.]+ m?s\b", "", here(*words.split()).stdout)
    two = re.sub(r"[\d.]+ m?s\b", "", here(*words.split(), "--units", "cm").stdout)
    assert "mm" in one
    assert not re.search(r"\bmm|[( ]mm[²³]?\b(?!·)", two.replace("N·mm", ""))
    first, second = _numbers(one), _numbers(two)
    assert len(first) == len(second)
    changed = 0
    for a, b in zip(first, second, strict=True):
        fits = [a * 10.0**-power for power in (0, 1, 2, 3)] + [a]  # cm² stay cm²
        assert any(b == pytest.approx(f, rel=6e-3, abs=1e-9) for f in fits), (a, b)
        changed += a != b
    assert changed


@pytest.mark.parametrize("words", ["volume rpur-table1 --phi 0 --theta 0", COMMANDS["section"]])
def test_json_is_in_mm_as_its_keys_say(here: Run, words: str) -> None:
    one, two = (
        json.loads(here(*words.split(), *more, "--json").stdout)
        for more in ((), ("--units", "inch"))
    )
    assert two.pop("file_units", "inch") == "inch"
    for answer in (one, two):
        answer.pop("seconds", None)
    keys = ("volume_mm3", "area_mm2", "perimeter_mm")
    assert [one.get(k) for k in keys] == pytest.approx([two.get(k) for k in keys], nan_ok=True)


@pytest.mark.parametrize("unit", ["feet", "", "MMM"])
def test_an_unknown_unit_is_refused(here: Run, unit: str) -> None:
    done = here("volume", "rpur-table1", "--units", unit)
    assert done.code == 2
    assert "is none of mm, cm, m, inch" in done.stderr


# --- files ---------------------------------------------------------------------------------


def _mesh(path: Path) -> Any:
    return trimesh.load(path, force="mesh")


@pytest.mark.parametrize("kind", ["stl", "ply", "obj", "3mf"])
def test_a_solid_is_written_in_the_unit_and_says_so(here: Run, kind: str) -> None:
    plain = Path(f"mm.{kind}")
    assert here(*SOLID, "-o", str(plain)).code == 0
    for unit in OTHERS:
        path = Path(f"{unit}.{kind}")
        done = here(*SOLID, "-o", str(path), "--units", unit)
        assert f"{path} ({unit}, base coordinates)" in done.stdout
        one, two = _mesh(plain), _mesh(path)
        assert two.bounds * SIZE[unit] == pytest.approx(one.bounds, rel=1e-6)
        assert len(one.faces) == len(two.faces)
        if kind == "3mf":
            with zipfile.ZipFile(path) as packed:
                model = next(n for n in packed.namelist() if n.endswith(".model"))
                said = {"cm": "centimeter", "m": "meter", "inch": "inch"}[unit]
                assert f'unit="{said}"'.encode() in packed.read(model)
        else:
            assert f"unit {unit}".encode() in path.read_bytes()[:400]


def test_glb_is_in_metres_whatever_is_asked(here: Run) -> None:
    for unit in ("mm", "inch"):
        assert here(*SOLID, "-o", f"{unit}.glb", "--units", unit).code == 0
    assert Path("mm.glb").read_bytes() == Path("inch.glb").read_bytes()


@pytest.mark.parametrize("unit", OTHERS)
def test_a_dxf_is_in_the_unit_and_an_svg_of_true_size(here: Run, unit: str) -> None:
    words = ("workspace", "five-bar")
    for name, chosen in (("mm", "mm"), ("other", unit)):
        assert here(*words, "-o", f"{name}.dxf", "--units", chosen).code == 0
        assert here(*words, "-o", f"{name}.svg", "--units", chosen).code == 0
    one, two = ezdxf.readfile("mm.dxf"), ezdxf.readfile("other.dxf")
    assert two.header["$INSUNITS"] == {"cm": 5, "m": 6, "inch": 1}[unit]
    for end in ("$EXTMIN", "$EXTMAX"):
        there = np.array(two.header[end]) * SIZE[unit]
        assert there == pytest.approx(np.array(one.header[end]), rel=1e-9)
    assert Path("mm.svg").read_bytes() == Path("other.svg").read_bytes()


@pytest.mark.parametrize("unit", OTHERS)
def test_columns_are_turned_over_and_say_their_unit(unit: str) -> None:
    text = (
        "t,x,phi_deg,rho1_per_s,volume_mm3,force1_Nmm,kind\n"
        "1,25.4,5,50.8,16387.064,3,arc\n2,,,,,,\n"
    )
    rows = list(csv.DictReader(io.StringIO(csv_in(text, unit, {"x", "rho1"}))))
    assert [*rows[0]] == [
        "t",
        f"x_{unit}",
        "phi_deg",
        f"rho1_{unit}_per_s",
        f"volume_{unit}3",
        "force1_Nmm",
        "kind",
    ]
    size = SIZE[unit]
    assert float(rows[0][f"x_{unit}"]) == pytest.approx(25.4 / size, rel=1e-15)
    assert float(rows[0][f"rho1_{unit}_per_s"]) == pytest.approx(50.8 / size, rel=1e-15)
    assert float(rows[0][f"volume_{unit}3"]) == pytest.approx(16387.064 / size**3, rel=1e-15)
    assert (rows[0]["phi_deg"], rows[0]["force1_Nmm"], rows[0]["kind"]) == ("5", "3", "arc")
    assert set(rows[1].values()) == {"2", ""}
    assert csv_in(text, "mm") == text


def test_a_trajectory_in_inches_reads_back_as_the_same_way(here: Run) -> None:
    Path("way.csv").write_text("x,y\n-60,250\n60,260\n0,300\n", encoding="utf-8")
    assert here("trajectory", "five-bar", "way.csv", "-o", "mm.csv").code == 0
    assert here("trajectory", "five-bar", "way.csv", "-o", "in.csv", "--units", "inch").code == 0
    one, two = (
        json.loads(here("trajectory", "five-bar", name, "--json").stdout)["length_mm"]
        for name in ("mm.csv", "in.csv")
    )
    assert one == pytest.approx(two, rel=1e-9)


def test_titles_and_names_of_files_stay_as_they_are(here: Run) -> None:
    done = here("workspace", "five-bar", "-o", "a 25 mm.csv", "--units", "m")
    assert "a 25 mm.csv (m)" in done.stdout
    assert "r_a = 400 mm" in here("ik", "sps-spr", "--pose", "0,0,650,0,0,0", "--units", "m").stdout
