"""The command line among other programs: what a shell completes, where its output may go."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import click
import pytest

from app import cli
from app.terminal.options import preset_names
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.conftest import ROOT, Finished, answered, command_environment, refused

Run = Callable[..., Finished]


# --- starting ------------------------------------------------------------------------------


def test_importing_the_command_line_is_quick_and_loads_nothing_slow() -> None:
    code = (
        "import time; began = time.process_time(); import sys, app.cli\n"
        "print(time.process_time() - began, [m for m in ('numpy', 'scipy') if m in sys.modules])"
    )
    told = [_python(code).split(" ", 1) for _ in range(3)]
    assert {slow for _, slow in told} == {"[]\n"}
    assert min(float(seconds) for seconds, _ in told) < 0.1


@pytest.mark.parametrize(
    "words",
    [
        ["designs"],
        ["ik", "rpur-table1", "--pose", "-10,100,450,5,-3"],
        ["ik", "sps-spr", "--pose", "-,20,560,5,2,3"],
        ["ik", "rps-3", "--pose", "283,0,0"],
        ["ik", "five-bar", "--pose", "0,700"],
    ],
)
def test_what_is_asked_often_starts_without_scipy(words: list[str]) -> None:
    code = f"import sys, app.cli\napp.cli.main({words!r})\n" + (
        "print([m for m in ('scipy', 'numba', 'viser', 'trimesh') if m in sys.modules])"
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


# --- where output goes ---------------------------------------------------------------------

posix = pytest.mark.skipif(os.name != "posix", reason="needs a shell")
full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a disk that is full")
WORDS = ("designs", "--help", "ik rpur-table1 --pose 0,100,450,0,0 --json")


def _shell(words: str, redirected: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["sh", "-c", f'exec "{sys.executable}" -m app {words} {redirected}'],
        cwd=ROOT,
        env=command_environment(),
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@posix
@full
@pytest.mark.parametrize("words", WORDS)
@pytest.mark.parametrize("where", [">/dev/full", ">&-"])
def test_an_answer_that_cannot_be_written_is_one_sentence(words: str, where: str) -> None:
    done = _shell(words, where)
    assert done.returncode == 1
    said = "No space left" if "full" in where else "standard output is closed"
    assert re.fullmatch(rf"bohemia: .*{said}.*\n", done.stderr)


@posix
def test_a_closed_stderr_takes_nothing_from_the_answer() -> None:
    assert _shell("designs --json", "2>&-").stdout.startswith('{"schema": "bohemia/designs/1"')
    beyond = _shell("fk rpur-table1 --joints 320,360,345,305,410.5 --json", "2>&-")
    assert beyond.stdout.startswith("{")
    assert _shell("ik rpur-table1 --pose 1", "2>&-").returncode == 2


# --- what the shell completes --------------------------------------------------------------


@pytest.fixture
def completed(monkeypatch: pytest.MonkeyPatch, here: Run) -> Callable[..., list[str]]:
    """What is offered for the last of some words, as bash asks; "file" where files are."""

    def offered(*words: str) -> list[str]:
        monkeypatch.setenv(cli.COMPLETE, "bash_complete")
        monkeypatch.setenv("COMP_WORDS", " ".join(("bohemia", *words)))
        monkeypatch.setenv("COMP_CWORD", str(len(words)))
        done = here()
        assert (done.code, done.stderr) == (0, "")
        lines = [line.split(",", 1) for line in done.stdout.split()]
        return ["file" if kind == "file" else value for kind, value in lines]

    return offered


def test_commands_presets_and_files_are_completed(completed: Callable[..., list[str]]) -> None:
    every = completed("")
    assert set(cli.COMMANDS) < set(every)
    assert {"file", *preset_names()} < set(every)
    assert completed("si") == ["file", "singularity"]
    assert completed("rpur-t") == completed("ik", "rpur-t")
    assert completed("ik", "rpur-t") == ["file", "rpur-table1", "rpur-table1-icee", "rpur-table2"]
    assert completed("workspace", "rps-3", "-o", "") == ["file"]
    assert completed("trajectory", "five-bar", "") == ["file", "line", "rest-to-rest"]
    assert completed("trajectory", "no-such-design", "") == ["file"]


def test_modes_are_completed_though_they_begin_as_options_do(
    completed: Callable[..., list[str]],
) -> None:
    assert completed("ik", "five-bar", "--mode", "") == ["++", "+-", "-+", "--", "home", "all"]
    assert completed("ik", "five-bar", "--mode", "-") == ["-+", "--"]
    assert completed("ik", "rpur-table1", "--mode", "+-++") == ["+-+++", "+-++-"]
    assert completed("workspace", "rpur-table1", "--modes", "-----,+++++,-+--") == [
        "-----,+++++,-+--+",
        "-----,+++++,-+---",
    ]
    assert completed("volume", "rps-3", "--mode", "") == ["1", "2", "home", "all"]


def test_options_and_names_are_completed(completed: Callable[..., list[str]]) -> None:
    assert completed("ik", "sps-spr", "--al") == ["--alpha"]
    assert completed("section", "rpur-table1", "--") == [
        *("--pose", "--x", "--modes", "--mode", "--output", "--units", "--json", "--help"),
        *("--y", "--z", "--phi", "--theta"),
    ]
    assert completed("workspace", "five-bar", "--regions", "") == ["workspace", "modes", "aspects"]
    assert completed("workspace", "rps-3", "--resolution", "f") == ["fine"]
    assert completed("vertex-space", "rpur-table1", "--limb", "") == list("12345")
    assert completed("vertex-space", "rps-3", "--limb", "") == []
    assert completed("map", "rpur-table1", "--quantity", "pieces,s") == [
        "pieces,sphere",
        "pieces,stroke",
    ]


@posix
@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_that_the_help_names_completes(shell: str, tmp_path: Path, here: Run) -> None:
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell}")
    program = tmp_path / "bohemia"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m app "$@"\n')
    program.chmod(0o755)
    source = f'eval "$({cli.COMPLETE}={shell}_source bohemia)"'
    asked = {
        "bash": f"{source}; COMP_WORDS=(bohemia ik rpur-table1 --mode -); COMP_CWORD=4; "
        "_bohemia_completion bohemia; printf '%s\\n' \"${COMPREPLY[@]}\"",
        "zsh": f"compdef() {{ :; }}; compadd() {{ print -l -- $completions; }}; {source}; "
        "words=(bohemia ik rpur-table1 --mode -); CURRENT=5; _bohemia_completion",
        "fish": f"{cli.COMPLETE}=fish_source bohemia | source; "
        "complete -C 'bohemia ik rpur-table1 --mode -'",
    }
    done = subprocess.run(
        [shell, "-c", asked[shell]],
        env={**command_environment(), "PATH": f"{tmp_path}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    modes = [mode for mode in machine_of(load_design("rpur-table1")).modes if mode[0] == "-"]
    assert done.stdout.split() == modes, done.stderr


# --- what is said of options ---------------------------------------------------------------


def _options(name: str) -> set[str]:
    command = cli.bohemia.get_command(click.Context(cli.bohemia), name)
    assert command is not None
    return {option for param in command.params for option in param.opts} | {"--help", "-h"}


def test_every_option_in_the_readme_exists() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (part,) = re.findall(r"^## The command line\n(.*?)^## ", text, re.M | re.S)
    coordinates = {
        f"--{axis.key}"
        for preset in preset_names()
        for axis in machine_of(load_design(preset)).coordinates
    }
    known = coordinates.union({"--version"}, *map(_options, cli.COMMANDS))
    told = set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", part))
    assert told >= {"--pose", "--mode", "--modes", "--json", "--phi"}
    assert told <= known
    for line in re.findall(r"^bohemia (.*)$", part, re.M):
        command, *words = line.split("#")[0].split()
        used = {word.partition("=")[0] for word in words if re.match(r"--?[a-z]", word)}
        assert used <= _options(command) | coordinates, line


def test_every_command_tells_what_it_does(here: Run, capsys: pytest.CaptureFixture[str]) -> None:
    for name in cli.COMMANDS:
        with pytest.raises(SystemExit):
            cli.main([name, "--help"])
        told = capsys.readouterr().out
        assert told.startswith(f"Usage: bohemia {name} ")
        named = {name for name in _options(name) if name.startswith("-")}
        assert named <= set(re.findall(r"--?[\w-]+", told))
    with pytest.raises(SystemExit):
        cli.main(["ik", "sps-spr", "--help"])
    assert "--gamma DEG" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["ik", "five-bar", "--mod", "++"], "unrecognized arguments: --mod; did you mean --mode"),
        (["ik", "sps-spr", "--gama", "3"], "--gama; did you mean --gamma"),
        (["ik", "rpur-table1", "--x"], "--x: expected one argument"),
        (["ik", "rpur-table1", "--x", "far"], "--x: x must be a number, got 'far'"),
        (["ik", "rpur-table1", "--json=3"], "--json: no argument is taken"),
        (["ik", "sps-spr", "--x", "-", "--y", "-"], "only one coordinate may be -"),
        (["ik", "rpur-table1", "--pose", "1,2,3,4,5", "--phi", "1"], "leave it or --pose out"),
        (["designs", "rpur-table1"], "unexpected extra argument"),
        (["workspace", "rpur-table1", "--x", "3"], "--x: what is asked is of all values of x"),
        (["workspace", "rps-3", "--tilt", "3"], "of all values of θ; leave --tilt out"),
        (["workspace", "sps-spr", "--modes", "+"], "has only one mode; leave --modes out"),
        (["map", "rpur-table1", "--x", "3"], "the map runs over --phi and --theta"),
        (["map", "rpur-table1", "--phi", "0:9:999999999999"], "at most 1000000"),
        (["trajectory", "rpur-table1", "line"], "there is no such path 'line' of a 5-RPUR"),
        (["trajectory", "five-bar", "lines"], "paths by name are line, rest-to-rest"),
        (["trajectory", "five-bar", "lines.csv"], "there is no file 'lines.csv'"),
        (["trajectory", "five-bar", "/dev/zero"], "/dev/zero: cannot be read (no regular file"),
    ],
)
def test_mistakes_name_the_remedy(here: Run, words: list[str], said: str) -> None:
    assert said in refused(here(*words))


# --- poses and modes alike in all commands -------------------------------------------------


def test_a_pose_may_be_told_coordinate_by_coordinate(here: Run) -> None:
    apart = ("--x", "-10", "--y=100", "--z", "450", "--phi", "5", "--theta", "-3")
    whole = ("--pose", "-10,100,450,5,-3")
    for words in (
        ("ik", "rpur-table1"),
        ("singularity", "rpur-table1"),
        ("statics", "rpur-table1", "--load", "0,0,-1,0,0,0"),
        ("velocity", "rpur-table1", "--rates", "1,2,3,4,5"),
    ):
        assert answered(here(*words, *apart, "--json")) == answered(here(*words, *whole, "--json"))
    for words in (("volume", "rpur-table1"), ("section", "rpur-table1", "--x", "50")):
        one = answered(here(*words, "--phi", "5", "--theta", "-3", "--json"))
        two = answered(here(*words, *whole, "--json"))
        assert {**one, "seconds": 0} == {**two, "seconds": 0}


def test_what_is_not_told_of_a_pose_is_home_s_and_one_follows(here: Run) -> None:
    home = machine_of(load_design("sps-spr")).home.pose
    answer = answered(here("ik", "sps-spr", "--alpha", "10", "--json"))
    pose = answer["pose"]
    assert pose["alpha_deg"] == 10.0
    assert [pose[key] for key in ("y", "z")] == list(home[1:3])
    assert pose["x"] == pytest.approx(-121.099, abs=1e-3)
    assert answer["reachable"]
    lost = answered(here("singularity", "sps-spr", "--alpha", "10", "--json"))
    assert lost["chart"] == "plane"
    assert lost["pose"] == pose
    assert len(answered(here("singularity", "five-bar", "--json"))["curves"]) > 0


def test_a_workspace_of_one_mode_is_of_the_home_mode(here: Run) -> None:
    words = ("workspace", "rps-3", "--resolution", "preview", "--json")
    answer = answered(here(*words))
    assert answer["modes"] == [machine_of(load_design("rps-3")).home.mode] == ["2"]
    assert answer["volume_mm3"] == answered(here(*words, "--mode", "2"))["volume_mm3"] > 0.0
    assert answered(here(*words, "--modes", "1"))["modes"] == ["1"]
    assert "tilt_deg" not in answer
