"""What a person gets: the README's promises, and the wheel's layout with its assets."""

from __future__ import annotations

import importlib.metadata
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import ROOT, Finished
from tests.examples import blocks, commands

README = (ROOT / "README.md").read_text(encoding="utf-8")
NOT_READ_AT_RUN_TIME = {"docs", "readme"}


def _texts(language: str) -> list[str]:
    return [block.text for block in blocks(README, language)]


def test_a_wheel_finds_its_assets(tmp_path: Path) -> None:
    wheel = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"][
        "build"
    ]["targets"]["wheel"]
    for package in wheel["packages"]:
        shutil.copytree(ROOT / package, tmp_path / package)
    for source, target in wheel["force-include"].items():
        shutil.copytree(ROOT / source, tmp_path / target)
    done = subprocess.run(
        [sys.executable, "-m", "app", "designs", "--json"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    names = {design["name"] for design in json.loads(done.stdout)["designs"]}
    assert names == {path.stem for path in (ROOT / "assets" / "designs").glob("*.toml")}
    carried = {Path(source).name for source in wheel["force-include"]}
    folders = {path.name for path in (ROOT / "assets").iterdir() if path.is_dir()}
    assert folders - NOT_READ_AT_RUN_TIME == carried


def test_the_readme_names_the_commands_that_make_knows() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"\bmake ([a-z-]+)", README):
        assert re.search(rf"^{target}:", makefile, re.M), target
    assert commands(README)


def _marked() -> list[Any]:
    """What takes long has tests of its own."""
    long = re.compile(
        r"bohemia (report|paper|compare|map|singularity|fk rpur-a1a1|.*--usable|.*fine)"
    )
    rare = pytest.mark.slow
    return [pytest.param(c, marks=rare) if long.match(c) else c for c in commands(README)]


@pytest.mark.parametrize("command", _marked())
def test_the_readmes_commands_work(bohemia: Callable[..., Finished], command: str) -> None:
    done = bohemia(*shlex.split(command)[1:])
    assert done.code == 0, done.stderr
    assert done.stderr == ""
    assert done.stdout


def test_the_readmes_python_works() -> None:
    (code,) = _texts("python")
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"},
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    shape, modes, posture, *rooms, remedy, solutions, first, exact, chart, volume = (
        done.stdout.splitlines()
    )
    assert shape == "(2, 32, 5)"
    assert re.fullmatch(r"\[ *\d+ +\d+\]", modes)
    assert posture == "True []"
    assert [room.partition(" mm ")[0] for room in rooms] == ["47.5", "66.3", "66.3"]
    assert re.search(r"away.* of limb \d from [\d.]+ to [\d.]+ mm", remedy)
    assert solutions == "66 real of 1560, complete: True"
    assert re.fullmatch(r"\[.*\] [+-]{5} [\d.]+", first)
    sums = re.fullmatch(r"(\d+) mm³ ± (\d+); \d+ loops, [\d.]+ mm²", exact)
    assert sums is not None
    assert abs(float(sums[1]) - 24_501_399) <= float(sums[2]) + 1
    assert chart == "(2, 3, 3) True"
    found = re.fullmatch(r"(\d+\.\d\d) dm³ in \d pieces", volume)
    assert found is not None
    assert abs(float(found[1]) / 24.501399 - 1) < 1e-3


def test_the_readmes_design_is_valid(tmp_path: Path) -> None:
    from kinematics.designs.files import load_design, read_design

    text = next(block for block in _texts("toml") if "five_rpur" in block)
    head, limb = text.split("[[limb]]")
    design = read_design(head + 5 * f"[[limb]]{limb}", origin="README")
    first = load_design("rpur-table1")
    assert design.limbs[0] == first.limbs[0]  # type: ignore[attr-defined]
    other = next(block for block in _texts("toml") if '"parallel"' in block)
    assert read_design(other, origin="README").mechanism == "parallel"


def test_the_readmes_picture_and_links_exist() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        if not target.startswith("http"):
            assert (ROOT / target).is_file(), target


def test_one_version_stands_everywhere() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r"^version: (.*)$", citation, re.M)[1] == version  # type: ignore[index]
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    released = re.findall(r"^## \[(\d[^\]]*)\] - (\S+)$", changes, re.M)
    assert released[0][0] == version
    assert re.search(r"^date-released: (.*)$", citation, re.M)[1] == released[0][1]  # type: ignore[index]


def test_nobody_else_here_has_the_import_names() -> None:
    """The two packages have short names; the README says so."""
    owners = importlib.metadata.packages_distributions()
    for name in ("app", "kinematics"):
        assert set(owners.get(name, ["bohemia"])) == {"bohemia"}
        assert f"`{name}`" in README
