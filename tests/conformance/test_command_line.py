"""The commands work for every kind, and say the same as the library."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app import cli
from tests.conformance.machines import ONE_EACH, held, machine
from tests.conftest import Finished, answered

Run = Callable[..., dict[str, Any]]


@pytest.fixture
def run(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """A command in this process: its JSON, once it has worked in words as well."""
    monkeypatch.chdir(tmp_path)

    def commanded(*arguments: str) -> dict[str, Any]:
        told = Finished(cli.main(arguments), *capsys.readouterr())
        assert told.code == 0, told.stderr
        assert told.stdout.strip()
        return answered(Finished(cli.main((*arguments, "--json")), *capsys.readouterr()))

    return commanded


def at(name: str, n: int = 1) -> tuple[str, ...]:
    """A pose and a mode as options."""
    m, posture = machine(name), held(name)[n]
    pose = ",".join(repr(v) for v in m.at(posture).pose.to_dict().values())
    return f"--pose={pose}", *([f"--mode={posture.mode}"] if posture.mode else [])


@pytest.mark.parametrize("name", ONE_EACH)
def test_ik_and_fk_undo_each_other(name: str, run: Run) -> None:
    m, posture = machine(name), held(name)[1]
    (solution,) = run("ik", name, *at(name))["solutions"]
    assert solution["within_stroke"] is True
    joints = [axis.outer(v) for axis, v in zip(m.joints, posture.joints, strict=True)]
    assert solution["joints"] == pytest.approx(joints, abs=1e-9)
    answer = run("fk", name, f"--joints={','.join(map(repr, solution['joints']))}")
    assert answer["complete"] is True
    wanted = m.transform(posture.pose, posture.mode)
    off = [np.abs(np.array(one["transform"]) - wanted).max() for one in answer["solutions"]]
    assert min(off) < 1e-6 * m.length


@pytest.mark.parametrize("name", ONE_EACH)
def test_velocity_and_statics(name: str, run: Run) -> None:
    m, posture = machine(name), held(name)[1]
    rates = ",".join(["1.5"] * len(m.joints))
    answer = run("velocity", name, *at(name), f"--joint-rates={rates}")
    inner = [1.5 if axis.unit == "mm" else np.radians(1.5) for axis in m.joints]
    found = m.motion.forward(posture.pose, posture.mode, inner)
    said = answer["twist"]["v_mm_per_s"]
    assert said == pytest.approx(found.twist[3:].tolist(), rel=1e-6, abs=1e-9)
    said = np.radians(answer["twist"]["omega_deg_per_s"])
    assert said == pytest.approx(found.twist[:3], rel=1e-6, abs=1e-9)
    answer = run("statics", name, *at(name), "--load=1,-2,0,0,0,30")
    held_by = m.statics.forces(posture.pose, posture.mode, [1, -2, 0, 0, 0, 30])
    said = [each["value"] for each in answer["forces"]]
    assert said == pytest.approx(held_by.forces.tolist(), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ONE_EACH)
def test_singularity_and_workspace(name: str, run: Run) -> None:
    m = machine(name)
    answer = run("singularity", name, *at(name))
    assert answer["singularities"] == []
    if m.solids is None and m.regions is None:
        return
    answer = run("workspace", name, "--resolution=preview")
    assert max(answer["volume_mm3"], answer.get("area_mm2", 0.0)) > 0.0
    assert answer["mechanism"] == m.kind
    assert answer["schema"].startswith("bohemia/workspace/")
