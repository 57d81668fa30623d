"""The examples in docstrings and in the README work as they stand."""

from __future__ import annotations

import doctest
import pkgutil
from importlib import import_module
from pathlib import Path

import pytest

import kinematics
from tests.examples import ROOT, dialogue

PACKAGES = ("kinematics", "kinematics.answers", "kinematics.facets", "kinematics.trajectories")


def documented() -> list[str]:
    names = ["kinematics", "kinematics.machine", "kinematics.mechanism"]
    for package in PACKAGES[1:]:
        path = import_module(package).__path__
        names += [module.name for module in pkgutil.iter_modules(path, f"{package}.")]
    return names


@pytest.mark.parametrize("name", documented())
def test_the_examples_of_a_module_work(name: str) -> None:
    found = doctest.testmod(import_module(name))
    assert found.failed == 0


def test_the_readmes_dialogue_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    said = dialogue(text, "README")
    assert len(said.examples) > 20
    assert doctest.DocTestRunner().run(said).failed == 0
    assert (tmp_path / "workspace.stl").stat().st_size > 10_000


def test_the_public_names_are_there_and_explained() -> None:
    for name in kinematics.__all__:
        assert getattr(kinematics, name).__doc__, name
        assert name in dir(kinematics)
