"""Nothing absolute decides: a machine of any size gives the answers of the usual one, scaled."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kinematics as kin
from app import cli
from kinematics.designs import files
from kinematics.facets.reach import reach
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from tests.conformance.machines import ONE_EACH, held, machine
from tests.conftest import rarely

FACTORS = (1e-6, *map(rarely, (1e-3, 1e3)), 1e6)

each = pytest.mark.parametrize("name", ONE_EACH)
by_factor = pytest.mark.parametrize("factor", FACTORS)


@pytest.fixture(autouse=True)
def larger_than_files_may_say(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MAX_MAGNITUDE", 1e12)


@cache
def scaled(name: str, factor: float) -> kin.Machine[Any]:
    """A preset with every length times a factor."""
    table = dict(machine(name).table)
    for field in sorted(machine(name).fields, key=lambda f: len(f.path)):
        if field.unit == "mm":
            table = _changed(table, field.path, factor)
    kind = mechanism_class(machine(name).kind)
    return machine_of(kind.read_design(table, origin="the scaled one", name=""))


def _changed(value: Any, path: Any, factor: float) -> Any:
    if not path:
        return value * factor
    if isinstance(value, dict):
        return {k: _changed(v, path[1:], factor) if k == path[0] else v for k, v in value.items()}
    return [_changed(v, path[1:], factor) if k == path[0] else v for k, v in enumerate(value)]


def lengths(axes: Any, factor: float) -> np.ndarray:
    return np.array([factor if axis.unit == "mm" else 1.0 for axis in axes])


@each
@by_factor
def test_it_starts_where_the_usual_one_does(name: str, factor: float) -> None:
    usual, other = machine(name), scaled(name, factor)
    by = lengths(usual.coordinates, factor)
    size = np.where(by == 1.0, 1.0, usual.length * factor)
    assert other.home.reachable
    assert other.home.mode == usual.home.mode
    assert np.abs((np.array(other.home.pose) - by * usual.home.pose) / size).max() < 0.02


@each
@by_factor
def test_postures_margins_and_singularities(name: str, factor: float) -> None:
    usual, other = machine(name), scaled(name, factor)
    by, joints_by = lengths(usual.coordinates, factor), lengths(usual.joints, factor)
    for one in held(name):
        there = other.posture(by * one.pose, one.mode)
        assert there.reachable
        np.testing.assert_allclose(there.joints, joints_by * one.joints, rtol=1e-9)
        singular = [m.singularities.at(p, 1e-3) for m, p in ((usual, one), (other, there))]
        assert [each.kind for each in singular[1]] == [each.kind for each in singular[0]]


@each
@by_factor
def test_where_coordinates_can_go(name: str, factor: float) -> None:
    usual, other = machine(name), scaled(name, factor)
    by = lengths(usual.coordinates, factor)
    here = usual.home
    before = reach(usual.inverse, here.pose, here.mode)
    after = reach(other.inverse, (by * here.pose).tolist(), here.mode)
    for axis, scale, one, two in zip(usual.coordinates, by, before, after, strict=True):
        assert len(one) == len(two)
        within = (axis.upper - axis.lower) / 1000
        assert np.abs(two / scale - one).max(initial=0.0) <= within


@each
@by_factor
def test_assembly_modes(name: str, factor: float) -> None:
    usual, other = machine(name), scaled(name, factor)
    joints_by = lengths(usual.joints, factor)
    before, after = usual.forward(usual.home.joints), other.forward(joints_by * usual.home.joints)
    assert (after.complete, len(after)) == (before.complete, len(before))
    placed = [
        np.array([m.transform(pose, mode)[:3] for pose, mode in zip(f.poses, f.modes, strict=True)])
        for m, f in ((usual, before), (other, after))
    ]
    for at, length in zip(placed, (usual.length, usual.length * factor), strict=True):
        at[..., 3] /= length
    apart = np.abs(placed[0][:, None] - placed[1]).max(axis=(-1, -2))
    assert (apart.min(axis=1, initial=np.inf) < 1e-5).all()


@each
@by_factor
def test_workspaces(name: str, factor: float) -> None:
    usual, other = machine(name), scaled(name, factor)
    if usual.regions is not None:
        one, two = (m.workspace(usual.home.mode or None).section().area for m in (usual, other))
        assert two == pytest.approx(one * factor**2, rel=1e-9)
    for spec in usual.solid_specs:
        if not spec.key.startswith("workspace"):
            continue
        one, two = (
            m.workspace((usual.home.mode or None) if spec.of_present_mode else None)
            .solid("preview", key=spec.key)
            .built
            for m in (usual, other)
        )
        assert two.volume > 0.0
        assert two.watertight
        assert len(two.pieces) == len(one.pieces)
        power = round(np.log(two.volume / one.volume) / np.log(factor))
        expected, error = one.volume * factor**power, one.volume_error * factor**power
        assert abs(two.volume - expected) <= 0.2 * error
        assert two.volume_error == pytest.approx(error, rel=0.1)
    if usual.sections is not None:
        one, two = (m.workspace().volume(1e-4) for m in (usual, other))
        assert two.value == pytest.approx(one.value * factor**3, rel=1e-6)
        assert len(two.pieces) == len(one.pieces)


@each
@pytest.mark.parametrize("factor", [1e-6, *map(rarely, (1e-3, 1e3))])
def test_commands_say_the_same_of_any_size(
    name: str, factor: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Their JSON has the same keys, words and lengths of lists; numbers are numbers in both."""
    usual, other = machine(name), scaled(name, factor)
    file = tmp_path / "scaled.toml"
    file.write_text(kin.write(other), encoding="utf-8")
    posture = held(name)[1]
    mode = [f"--mode={posture.mode}"] if posture.mode else []

    def asked(m: kin.Machine[Any], design: str) -> list[Any]:
        by = lengths(m.coordinates, factor if m is other else 1.0)
        there = m.at(by * posture.pose, posture.mode)
        pose = "--pose=" + ",".join(map(repr, there.pose.to_dict().values()))
        joints = "--joints=" + ",".join(
            repr(axis.outer(v)) for axis, v in zip(m.joints, there.posture.joints, strict=True)
        )
        commands = [
            ["ik", design, pose],
            ["fk", design, joints],
            ["singularity", design, pose, *mode],
            ["statics", design, pose, *mode, "--load=1,0,0,0,0,0"],
        ]
        if m.solids is not None or m.regions is not None:
            commands.append(["workspace", design, "--resolution=preview"])
        if m.sections is not None:
            commands.append(["volume", design])
        said = []
        for command in commands:
            code = cli.main([*command, "--json"])
            out = capsys.readouterr()
            assert code == 0, (command, out.err)
            said.append(json.loads(out.out))
        return said

    for one, two in zip(asked(usual, name), asked(other, str(file)), strict=True):
        assert form(two) == form(one)


def form(value: Any, key: str = "") -> Any:
    """Of an answer what does not change with the machine's size."""
    if isinstance(value, dict):
        return {k: form(v, k) for k, v in value.items() if k not in _OF_THE_FILE}
    if isinstance(value, list):
        return [form(v, key) for v in value]
    if isinstance(value, str):
        return re.sub(r"[-−+]?\d[\d.]*(e[-+]?\d+)?", "#", value)
    return "number" if isinstance(value, int | float) and not isinstance(value, bool) else value


_OF_THE_FILE = ("design", "name", "title", "source", "notes", "triangles", "seconds", "file")
