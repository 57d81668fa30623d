"""`bohemia volume`, `section` and `map`: what they answer, write and refuse."""

from __future__ import annotations

import csv
import io
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from app import cli
from app.jobs import executors
from kinematics.designs.files import load_design
from kinematics.facets import map_sweeps
from kinematics.machine import machine_of
from tests.app.made_sections import area_by_edge
from tests.conftest import Finished, answered, command_environment, refused

Run = Callable[..., Finished]

DESIGN = load_design("rpur-table1")
MACHINE = machine_of(DESIGN)
VOLUME = 24_501_399.0  # mm³ at φ = θ = 0, by quadrature over closed-form slice areas
ALL = ("volume_mm3", "pieces", "largest_piece_mm3", "sphere_mm", "stroke_percent")


@pytest.fixture
def here(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Run:
    """As `bohemia`, but in this process; maps are computed in a thread of it."""
    monkeypatch.chdir(tmp_path)

    @contextmanager
    def threads(jobs: int | None = None, meanwhile: object = None) -> Iterator[executors.Workers]:
        with ThreadPoolExecutor(1) as pool:
            yield executors.Workers(pool, 1, "one thread", lambda: None)

    monkeypatch.setattr(executors, "local_workers", threads)

    def run(*arguments: str) -> Finished:
        code = cli.main(arguments)
        return Finished(code, *capsys.readouterr())

    return run


def inside(points: Any, theta: float, phi: float) -> Any:
    """Whether points (N, 3) in x', y', z' belong to the workspace, by their limbs' lengths."""
    frame = machine_of(DESIGN).sections.frame((0, 0, 0, phi, theta))
    poses = np.zeros((len(points), 5))
    poses[:, :3] = np.asarray(points) @ frame[:3, :3].T
    poses[:, 3:] = phi, theta
    return machine_of(DESIGN).inverse(poses).within_stroke.any(axis=1)


# --- volume --------------------------------------------------------------------------------


def test_volume_is_exact_within_its_error(bohemia: Run) -> None:
    answer = answered(bohemia("volume", "rpur-table1", "--phi", "0", "--theta", "0", "--json"))
    assert abs(answer["volume_mm3"] - VOLUME) <= answer["error_mm3"] + 0.5
    assert answer["error_mm3"] <= 1e-6 * VOLUME
    assert answer["pieces"] == len(answer["piece_volumes_mm3"]) > 1
    assert sum(answer["piece_volumes_mm3"]) == pytest.approx(answer["volume_mm3"], rel=1e-5)
    assert answer["modes"] == "all"
    assert len(answer["centroid_mm"]) == 3
    assert answer["sections"] > 0
    assert "sphere" not in answer


def test_volume_in_words(here: Run) -> None:
    done = here("volume", "rpur-table1", "--modes", "+++++", "--tolerance", "1e-4")
    assert done.code == 0
    assert done.stderr == ""
    head, where, *lines = done.stdout.splitlines()
    assert head == "rpur-table1: General 5-RPUR, Table 1 (journal)"
    assert where == "φ = 0°, θ = 0°, working mode +++++"
    assert [line.split()[0] for line in lines] == ["volume", "pieces", "centroid", "sections"]
    assert "±" in lines[0]


def test_a_looser_tolerance_takes_fewer_sections(here: Run) -> None:
    loose, tight = (
        answered(here("volume", "rpur-table1", "--phi", "10", "--tolerance", tolerance, "--json"))
        for tolerance in ("1e-3", "1e-7")
    )
    assert loose["sections"] < tight["sections"]
    assert tight["error_mm3"] <= 1e-7 * tight["volume_mm3"]
    difference = abs(loose["volume_mm3"] - tight["volume_mm3"])
    assert difference <= loose["error_mm3"] + tight["error_mm3"]


def test_a_volume_without_its_pieces_is_the_same_volume(here: Run) -> None:
    asked = ("volume", "rpur-table1", "--phi", "10", "--json")
    whole, alone = answered(here(*asked)), answered(here(*asked, "--no-pieces"))
    # The kernel may come between the two; it rounds otherwise than numpy.
    assert alone["volume_mm3"] == pytest.approx(whole["volume_mm3"], rel=1e-13)
    assert set(whole) - set(alone) == {"pieces", "piece_volumes_mm3"}
    lines = here(*asked[:-1], "--no-pieces").stdout.splitlines()
    assert not any(line.startswith("pieces") for line in lines)


def test_an_empty_workspace_has_no_volume_and_no_centroid(here: Run) -> None:
    empty = ("volume", "rpur-table1", "--modes", "++--+")
    answer = answered(here(*empty, "--json"))
    assert answer["volume_mm3"] == 0.0
    assert answer["error_mm3"] < 1e-6
    assert answer["centroid_mm"] is None
    assert answer["pieces"] == 0
    done = here(*empty, "--usable")
    assert done.code == 0
    assert "centroid" not in done.stdout
    assert done.stdout.endswith("sphere    none\nbox       none\n")


def test_the_usable_workspace_is_inside(here: Run) -> None:
    answer = answered(here("volume", "rpur-table1", "--theta", "20", "--usable", "--json"))
    sphere, box = answer["sphere"], answer["box"]
    directions = np.random.default_rng(1).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    back = machine_of(DESIGN).sections.frame((0, 0, 0, 0, radians(20)))[:3, :3]
    points = np.array(sphere["center_mm"]) + (1 - 1e-6) * sphere["radius_mm"] * directions
    assert inside(points @ back, radians(20), 0.0).all()
    low, high = np.array(box["low_mm"]), np.array(box["high_mm"])
    shares = np.random.default_rng(2).uniform(size=(200, 3))
    assert inside((low + shares * (high - low)) @ back, radians(20), 0.0).all()
    assert box["volume_mm3"] == pytest.approx(np.prod(high - low))


def test_the_usable_workspace_about_a_point(here: Run) -> None:
    center = machine_of(DESIGN).home.pose[:3]
    typed = ",".join(map(str, center))
    answer = answered(here("volume", "rpur-table1", "--around", typed, "--json"))
    assert answer["sphere"]["center_mm"] == list(center)
    middle = np.add(answer["box"]["low_mm"], answer["box"]["high_mm"]) / 2
    np.testing.assert_allclose(middle, center, atol=1e-9)
    far = here("volume", "rpur-table1", "--around", "-5000,0,0")
    assert far.code == 0
    assert "(-5000.0000, 0.0000, 0.0000) mm, which is not inside" in far.stdout


# --- section -------------------------------------------------------------------------------


def test_a_sections_loops_close_and_enclose_its_area(bohemia: Run) -> None:
    done = bohemia("section", "rpur-table1", "--phi", "45", "--theta", "45", "--x", "50", "--json")
    answer = answered(done)
    assert answer["x_mm"] == 50.0
    area = perimeter = 0.0
    for loop, loop_area in zip(answer["loops"], answer["loop_areas_mm2"], strict=True):
        total = 0.0
        for edge, after in zip(loop, loop[1:] + loop[:1], strict=True):
            assert set(edge) == {
                *("kind", "limb", "bound", "from", "to", "center", "radius", "sweep_deg")
            }
            assert edge["to"] == pytest.approx(after["from"], abs=1e-9)
            assert edge["limb"] in {1, 2, 3, 4, 5}
            assert edge["bound"] in {"rho_min", "rho_max", "link"}
            assert (edge["bound"] == "link") == (edge["kind"] == "line")
            start, end = complex(*edge["from"]), complex(*edge["to"])
            turn = radians(edge["sweep_deg"])
            total += area_by_edge(start, end, turn)
            if edge["kind"] == "arc":
                for point in (start, end):
                    assert abs(point - complex(*edge["center"])) == pytest.approx(edge["radius"])
                perimeter += edge["radius"] * abs(turn)
            else:
                assert edge["center"] is edge["radius"] is None
                perimeter += abs(end - start)
        assert total == pytest.approx(loop_area, rel=1e-9)
        area += total
    assert area == pytest.approx(answer["area_mm2"], rel=1e-9)
    assert perimeter == pytest.approx(answer["perimeter_mm"], rel=1e-9)
    assert answer["pieces"] == len(set(answer["loop_pieces"])) >= 1
    low, high = answer["range_mm"]
    assert low < 50 < high
    assert set(answer["second_moments_mm4"]) == {"yy", "zz", "yz"}


def test_the_workspace_lies_to_the_left_of_every_edge(here: Run) -> None:
    where = ("--phi", "45", "--theta", "45", "--x", "50")
    answer = answered(here("section", "rpur-table1", *where, "--json"))
    left, right = [], []
    for edge in (edge for loop in answer["loops"] for edge in loop):
        start, end = complex(*edge["from"]), complex(*edge["to"])
        if edge["kind"] == "line":
            middle, normal = (start + end) / 2, 1j * (end - start) / abs(end - start)
        else:
            center, turn = complex(*edge["center"]), radians(edge["sweep_deg"])
            along = (start - center) * complex(cos(turn / 2), sin(turn / 2))
            middle = center + along
            normal = -along / abs(along) * (1 if turn > 0 else -1)
        for side, sign in ((left, 1), (right, -1)):
            point = middle + sign * 1e-6 * normal
            side.append((50.0, point.real, point.imag))
    assert inside(left, radians(45), radians(45)).all()
    assert not inside(right, radians(45), radians(45)).any()


def test_an_empty_section_is_an_answer(here: Run) -> None:
    answer = answered(here("section", "rpur-table1", "--x", "-5000", "--json"))
    assert answer["loops"] == []
    assert answer["area_mm2"] == answer["perimeter_mm"] == 0.0
    assert answer["pieces"] == 0
    assert answer["centroid_mm"] is None
    assert answer["second_moments_mm4"] is None
    done = here("section", "rpur-table1", "--x", "-5000")
    assert done.code == 0
    low, high = (f"{value:.4f}" for value in answer["range_mm"])
    assert f"empty; the workspace lies between x′ = {low} mm and {high} mm" in done.stdout


def test_sections_are_written_as_files(here: Run, tmp_path: Path) -> None:
    answers = [
        answered(here("section", "rpur-table2", "--x", "20", "-o", f"cut.{kind}", "--json"))
        for kind in ("svg", "csv", "dxf")
    ]
    edges = sum(map(len, answers[0]["loops"]))
    assert [answer["file"] for answer in answers] == ["cut.svg", "cut.csv", "cut.dxf"]
    text = (tmp_path / "cut.svg").read_text(encoding="utf-8")
    assert "x′ = 20 mm" in text
    assert len((tmp_path / "cut.csv").read_text(encoding="utf-8").splitlines()) == 1 + edges
    drawing = ezdxf.readfile(tmp_path / "cut.dxf")
    assert len(drawing.modelspace()) == edges
    assert not drawing.audit().has_errors


def test_a_section_in_words_tells_its_file(here: Run) -> None:
    done = here("section", "rpur-table1", "--x", "50", "-o", "cut.svg", "--modes", "+++++,-----")
    assert done.code == 0
    assert "working modes +++++, -----" in done.stdout or "empty" in done.stdout
    assert done.stdout.splitlines()[-1] == "file       cut.svg (mm)"


# --- map -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_maps_csv_agrees_with_the_volumes(bohemia: Run, here: Run, tmp_path: Path) -> None:
    where = ("--phi", "-20:20:3", "--theta", "-30")
    done = bohemia("map", "rpur-table1", *where, "--jobs", "2", "-o", "map.csv")
    assert done.code == 0, done.stderr
    assert done.stderr == ""
    assert "map.csv" in done.stdout
    text = (tmp_path / "map.csv").read_text(encoding="utf-8")
    assert text.splitlines()[0] == "phi_deg,theta_deg,volume_mm3,error_mm3"
    rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(io.StringIO(text))]
    assert [(row["phi_deg"], row["theta_deg"]) for row in rows] == [(-20, -30), (0, -30), (20, -30)]
    for row in rows:
        assert row["error_mm3"] <= 1e-4 * row["volume_mm3"]
        exact = answered(
            here("volume", "rpur-table1", "--phi", str(row["phi_deg"]), "--theta", "-30", "--json")
        )
        difference = abs(row["volume_mm3"] - exact["volume_mm3"])
        assert difference <= row["error_mm3"] + exact["error_mm3"]


def test_a_map_as_json_with_every_quantity(here: Run) -> None:
    where = ("--phi", "-10:10:2", "--theta", "0:20:3", "--quantity", "all")
    answer = answered(here("map", "rpur-table1", *where, "--tolerance", "1e-3", "--json"))
    assert answer["phi_deg"] == [-10.0, 10.0]
    assert answer["theta_deg"] == [0.0, 10.0, 20.0]
    for name in ALL:
        assert np.array(answer[name]).shape == (2, 3)
        assert (np.array(answer[name]) > 0).all()
    assert (np.array(answer["largest_piece_mm3"]) <= np.array(answer["volume_mm3"])).all()
    assert answer["points"] == answer["done"] == 6
    assert np.max(np.array(answer["error_mm3"]) / np.array(answer["volume_mm3"])) <= 1e-3


def test_a_map_in_words(here: Run) -> None:
    done = here("map", "rpur-table1", "--phi", "0:10:2", "--theta", "0", "--quantity", "pieces")
    assert done.code == 0
    assert "φ from 0° to 10°" in done.stdout
    assert "2 × 1 orientations" in done.stdout
    assert [line.split()[0] for line in done.stdout.splitlines()[4:6]] == ["Volume", "Number"]


@pytest.mark.parametrize("kind", ["png", "svg", "npz"])
def test_a_map_is_written_as(here: Run, tmp_path: Path, kind: str) -> None:
    where = ("--phi", "0:10:2", "--theta", "0:10:2", "--tolerance", "0.01")
    answer = answered(here("map", "rpur-table1", *where, "-o", f"map.{kind}", "--json"))
    assert answer["file"] == f"map.{kind}"
    start = {"png": b"\x89PNG", "svg": b"<?xml", "npz": b"PK"}[kind]
    assert (tmp_path / f"map.{kind}").read_bytes().startswith(start)


def test_the_default_map_covers_what_the_paper_shows(
    here: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[map_sweeps.MapRequest] = []

    def stop(request: map_sweeps.MapRequest, *_: Any, **__: Any) -> map_sweeps.Map:
        asked.append(request)
        nothing = np.full((1, *request.shape), np.nan)
        return map_sweeps.Map(request, nothing, nothing.copy(), np.zeros(request.shape, dtype=bool))

    monkeypatch.setattr(map_sweeps, "sweep", stop)
    here("map", "rpur-table1")
    (request,) = asked
    assert request.shape == (37, 37)
    np.testing.assert_allclose(np.degrees(request.first), np.linspace(-90, 90, 37))
    assert request.first == request.second
    assert [quantity.key for quantity in request.quantities] == ["volume"]


def test_ctrl_c_keeps_what_is_done(
    here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep = map_sweeps.sweep

    def interrupted(*arguments: Any, on_cells: Any, **options: Any) -> map_sweeps.Map:
        def pressed(indices: Any, cells: Any) -> None:
            on_cells(indices, cells)
            signal.raise_signal(signal.SIGINT)

        options |= {"chunk": 2, "in_flight": 1}
        return sweep(*arguments, on_cells=pressed, **options)

    monkeypatch.setattr(map_sweeps, "sweep", interrupted)
    before = signal.getsignal(signal.SIGINT)
    done = here("map", "rpur-table1", "--phi", "0:40:5", "--theta", "0", "-o", "part.csv")
    assert signal.getsignal(signal.SIGINT) is before
    assert done.code == 130
    assert done.stderr == "bohemia: stopped after 2 of 5 orientations; part.csv holds those\n"
    assert len((tmp_path / "part.csv").read_text(encoding="utf-8").splitlines()) == 1 + 2


# --- all of them ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["volume"], "required: DESIGN"),
        (["volume", "rpur-table1", "--phi", "steep"], "must be a number, got 'steep'"),
        (["volume", "rpur-table1", "--tolerance", "0"], "'0' does not lie between 1e-12 and 1"),
        (["volume", "rpur-table1", "--tolerance", "nan"], "finite number"),
        (["volume", "rpur-table1", "--modes", "+++"], "'+++' is not a working mode"),
        (["volume", "rpur-table1", "--around", "1,2"], "--around needs 3 numbers"),
        (["volume", "rpur-table1", "--around", "-1,b,2"], "--around: y must be a number"),
        (["section", "rpur-table1"], "required: --x"),
        (["section", "rpur-table1", "--x", "left"], "--x must be a number, got 'left'"),
        (["section", "rpur-table1", "--x", "-inf"], "--x must be a finite number"),
        (["section", "rpur-table1", "--x", "0", "-o", "a.pdf"], "written as one of .svg, .dxf"),
        (["section", "rpur-table1", "--x", "0", "-o", "a"], "'a' has no ending"),
        (["section", "rpur-table1", "--x", "0", "-o", "no/a.svg"], "there is no folder 'no'"),
        (["map", "rpur-table1", "--phi", "1:2"], "--phi must be from:to:count, as -90:90:37"),
        (["map", "rpur-table1", "--phi", "-1:2:0"], "count must be a whole number from 1 on"),
        (["map", "rpur-table1", "--phi", "1:2:2.5"], "count must be a whole number from 1 on"),
        (["map", "rpur-table1", "--theta", "-1:-1:3"], "write --theta -1"),
        (["map", "rpur-table1", "--theta", "a:b:3"], "--theta must be a number, got 'a'"),
        (["map", "rpur-table1", "--phi", "0:9:9999", "--theta", "0:9:9999"], "is too large"),
        (["map", "rpur-table1", "--quantity", "mass"], "there is no 'mass'; it is one of volume"),
        (["map", "rpur-table1", "--jobs", "0"], "'0' is not a number of processes"),
        (["map", "rpur-table1", "--jobs", "1", "--scheduler", "tcp://a:1"], "give one of them"),
        (["map", "rpur-table1", "--scheduler", "a:1"], "'a:1' is not a scheduler's address"),
        (["map", "rpur-table1", "-o", "map.xlsx"], "written as one of .csv, .npz, .png, .svg"),
        (["map", "no-such-design"], "no-such-design"),
    ],
)
def test_bad_input_is_one_sentence(here: Run, arguments: list[str], said: str) -> None:
    assert said in refused(here(*arguments))


def test_a_scheduler_that_does_not_answer_is_one_sentence(
    here: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "REPLY", 0.3)
    said = refused(here("map", "rpur-table1", "--scheduler", "tcp://127.0.0.1:1"), code=1)
    assert "no Dask scheduler answered at tcp://127.0.0.1:1" in said


@pytest.mark.parametrize(
    ("command", "absent"),
    [
        (["volume", "rpur-table1", "--tolerance", "0.1"], ("manifold3d", "matplotlib", "ezdxf")),
        (["section", "rpur-table1", "--x", "0"], ("manifold3d", "matplotlib", "ezdxf")),
        (["map", "rpur-table1", "--phi", "1:2"], ("manifold3d", "matplotlib", "distributed")),
    ],
)
def test_commands_load_only_what_they_need(command: list[str], absent: tuple[str, ...]) -> None:
    code = f"import sys, app.cli\napp.cli.main({command!r})\n" + (
        f"print([m for m in ('viser', 'trimesh', *{absent!r}) if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=command_environment(),
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert done.stdout.splitlines()[-1] == "[]"


def test_help_names_the_commands(here: Run) -> None:
    with pytest.raises(SystemExit):
        here("--help")
    for command in ("volume", "section", "map"):
        with pytest.raises(SystemExit) as done:
            here(command, "--help")
        assert done.value.code == 0
