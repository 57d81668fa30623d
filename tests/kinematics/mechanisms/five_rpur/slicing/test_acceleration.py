"""The kernel compiled and in plain Python: the same numbers, and nobody waits for a compiler."""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kinematics.designs.files import load_design
from kinematics.mechanisms.five_rpur.slicing import acceleration, boundary, integral, measures
from tests.kinematics.mechanisms.five_rpur.machines import map_cells, section, volume

MEASURED = """
import json, sys
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.slicing import acceleration, cutter
sections, pose = machine_of(load_design("rpur-table1")).sections, (0.0, 0.0, 0.0, 0.3, -0.2)
cuts = [sections.at(pose, None, x) for x in (-150.0, 40.0, 210.0)]
exact = sections.volume(pose, ["+-+-+"], relative=1e-2)
print(json.dumps({
    "areas": [cut.area for cut in cuts],
    "sweeps": [cut.sweep.tolist() for cut in cuts],
    "volume": exact.value, "pieces": exact.pieces,
    "compiled": acceleration.is_compiled(), "numba": "numba" in sys.modules,
}))
"""


def run(code, **environment):
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=150,
    )
    return json.loads(done.stdout)


@pytest.mark.usefixtures("compiled")
def test_plain_python_gives_the_same():
    plain = run(MEASURED, NUMBA_DISABLE_JIT="1")
    assert not plain["compiled"]
    design = load_design("rpur-table1")
    cuts = [section(design, 0.3, -0.2, x) for x in (-150.0, 40.0, 210.0)]
    exact = volume(design, 0.3, -0.2, ["+-+-+"], relative=1e-2)
    assert acceleration.is_compiled()
    assert plain["areas"] == pytest.approx([cut.area for cut in cuts], rel=1e-12)
    for told, cut in zip(plain["sweeps"], cuts, strict=True):
        assert told == pytest.approx(cut.sweep.tolist(), abs=1e-9)
    assert plain["volume"] == pytest.approx(exact.value, rel=1e-12)
    assert plain["pieces"] == pytest.approx(exact.pieces, rel=1e-12)


def test_a_section_never_waits_for_the_compiler(tmp_path):
    code = """
import json, sys
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
cut = machine_of(load_design("rpur-table1")).sections.at((0.0,) * 5, None, 50.0)
print(json.dumps({"area": cut.area, "numba": "numba" in sys.modules}))
"""
    told = run(code, XDG_CACHE_HOME=str(tmp_path))
    assert list(tmp_path.rglob("*.nb?")) == []
    assert told["area"] == pytest.approx(46_318.5898, rel=1e-8)
    assert not told["numba"]


def test_the_first_volume_on_a_machine_does_not_wait_for_the_compiler(tmp_path, root):
    """Exact, with its pieces, within 3 s of processor time, all imports among them."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, "-m", "app", "volume", "rpur-table1", "--json"],
        env={**os.environ, "XDG_CACHE_HOME": str(tmp_path)},
        cwd=root,
        capture_output=True,
        text=True,
        check=True,
        timeout=150,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    told = json.loads(done.stdout)
    assert told["volume_mm3"] == pytest.approx(24_501_399, rel=2e-6)
    assert len(told["piece_volumes_mm3"]) == 4
    assert list(tmp_path.rglob("*.nb?")) == []
    assert after.ru_utime - before.ru_utime < 3.0


WATCHED = """
import json, sys
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.slicing import acceleration
acceleration._LOADING = {loading}
acceleration._LOOK = 0.0
sections = machine_of(load_design("rpur-table1")).sections
exact = sections.volume((0.0, 0.0, 0.0, 0.1, 0.2), relative=1e-4)
print(json.dumps({{
    "value": exact.value, "pieces": exact.pieces, "spent": acceleration._Plain.spent,
    "compiled": acceleration.is_compiled(), "numba": "numba" in sys.modules,
}}))
"""


@pytest.mark.usefixtures("compiled")
def test_work_that_goes_on_takes_the_kernel_as_soon_as_it_is_there():
    told = run(WATCHED.format(loading=1e-6))
    assert told["compiled"]
    assert told["spent"] > 1e-6  # it had begun without
    exact = volume(load_design("rpur-table1"), 0.1, 0.2, relative=1e-4)
    assert told["value"] == pytest.approx(exact.value, rel=1e-12)
    assert told["pieces"] == pytest.approx(exact.pieces, rel=1e-12)


@pytest.mark.usefixtures("compiled")
def test_work_that_is_soon_done_takes_nothing():
    told = run(WATCHED.format(loading=60.0))
    assert not told["compiled"]
    assert not told["numba"]


def test_work_without_a_kernel_to_take_goes_on_without(tmp_path):
    told = run(WATCHED.format(loading=1e-6), XDG_CACHE_HOME=str(tmp_path))
    assert not told["compiled"]
    assert not told["numba"]


@pytest.mark.usefixtures("compiled")
def test_a_kernel_that_is_ready_for_others_is_not_loaded():
    code = """
import json, sys
from kinematics.mechanisms.five_rpur.slicing import cutter
print(json.dumps([cutter.prepare(here=False), "numba" in sys.modules]))
"""
    assert run(code) == [False, False]


def test_kernels_of_other_builds_go_when_nobody_uses_them(tmp_path):
    now = time.time()

    def kernel(name: str, days: float, *, ready: bool = True) -> Path:
        folder = tmp_path / name
        folder.mkdir()
        mark = folder / "ready"
        if ready:
            mark.touch()
            os.utime(mark, (now - 86400.0 * days,) * 2)
        os.utime(folder, (now - 86400.0 * days,) * 2)
        return folder

    mine, old, broken = kernel("mine", 30), kernel("old", 8), kernel("broken", 8, ready=False)
    recent = [kernel(f"recent{n}", n) for n in range(1, 6)]
    acceleration._tidy(mine)
    assert mine.exists()
    assert now - (mine / "ready").stat().st_mtime < 60.0  # it is in use
    assert not old.exists()
    assert not broken.exists()
    assert [folder.exists() for folder in recent] == [True, True, True, False, False]
    acceleration._tidy(mine)
    assert sorted(tmp_path.iterdir()) == sorted([mine, *recent[:3]])


@pytest.mark.usefixtures("compiled")
def test_nothing_is_compiled_a_second_time_in_ordinary_use():
    design = load_design("rpur-table2")
    section(design, 0.1, 0.2, 30.0, ["+++++", "-----"])
    volume(design, 0.1, 0.2, relative=1e-3)
    volume(design, 0.1, 0.2, ["+++++"], relative=1e-3, between=(0.0, 50.0))
    map_cells(design, [[0.0, 0.0, 0.0, 0.1, 0.2]], ("+++++",), ("volume", "pieces", "stroke"))
    section(design, 0.1, 0.2, 1e6)
    for modes in ((), ("+++++", "--+-+", "+-+++")):
        volume(design, 0.1, 0.2, modes, relative=1e-3)
    for function in (
        measures.measure,
        measures.runs_of,
        boundary.outline,
        boundary.describe,
        integral.integral,
    ):
        assert len(function.signatures) == 1, function


BROKEN = {
    "at once": "def njit(function, **options): raise numba.NumbaError('no')",
    "when called": """
def njit(function, **options):
    def call(*arguments): raise numba.NumbaError('no')
    return call
""",
}


@pytest.mark.parametrize("when", BROKEN)
def test_a_numba_that_cannot_is_done_without(when, tmp_path):
    code = f"""
import json, numba
{BROKEN[when]}
numba.njit = njit
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.slicing import acceleration, cutter
prepared = cutter.prepare()
cut = machine_of(load_design("rpur-table1")).sections.at((0.0,) * 5, None, 50.0)
print(json.dumps([prepared, cutter.prepare(), acceleration.is_compiled(), cut.area]))
"""
    *compiled, area = run(code, XDG_CACHE_HOME=str(tmp_path))
    assert compiled == [False, False, False]
    assert area == pytest.approx(46_318.5898, rel=1e-8)


@pytest.mark.parametrize("when", BROKEN)
def test_a_volume_does_without_a_numba_that_cannot(when, tmp_path):
    """What had been put in its place is put back."""
    code = f"""
import json, numba
{BROKEN[when]}
numba.njit = njit
from kinematics.designs.files import load_design
from kinematics.mechanisms.five_rpur.slicing import acceleration, cutter
from kinematics.machine import machine_of
sections = machine_of(load_design("rpur-table1")).sections
cutter.prepare()
exact = sections.volume((0.0,) * 5, ["+-+-+"], relative=0.1)
print(json.dumps([acceleration.is_compiled(), exact.value, exact.error, list(exact.pieces)]))
"""
    compiled, value, error, pieces = run(code, XDG_CACHE_HOME=str(tmp_path))
    assert not compiled
    exact = volume(load_design("rpur-table1"), 0.0, 0.0, ("+-+-+",))
    assert abs(value - exact.value) <= error + exact.error
    assert sum(pieces) == pytest.approx(value)


def test_what_is_kept_is_told_apart_by_its_text(root, tmp_path):
    """Another copy of the same text has what was compiled; one line more, and it has nothing."""
    copy = tmp_path / "copy"
    for name in ("kinematics", "assets"):
        shutil.copytree(root / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    code = """
import json, sys
sys.path.insert(0, {!r})
from kinematics.mechanisms.five_rpur.slicing import acceleration, cutter
print(json.dumps(str(acceleration._folder())))
"""

    def folder(place):
        return run(code.format(str(place)), XDG_CACHE_HOME=str(tmp_path))

    here = folder(root)
    assert Path(here).is_relative_to(tmp_path)
    assert (folder(copy) == here) is acceleration._by_text()
    with (copy / "kinematics/mechanisms/five_rpur/slicing/sweep.py").open("a") as text:
        text.write("\n# another build\n")
    assert folder(copy) != here
