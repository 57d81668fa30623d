"""The workspace of every kind: what it holds, how large it is, and that it is saved."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import kinematics as kin
from kinematics.facets.solids import build_solid
from kinematics.facets.spaces import ShownSolid, Space
from tests.conformance.machines import ONE_EACH, held, machine


def space_of(name: str) -> Space[object]:  # type: ignore[type-var]
    """A solid one where there is one: with the last angle following, if one has to."""
    m = machine(name)
    following = [spec.follows for spec in m.solid_specs if spec.follows is not None]
    left = {m.coordinates[following[-1]].key: None} if following else {}
    return m.workspace(m.home.mode or None, **left)


@pytest.mark.parametrize("name", ONE_EACH)
def test_it_holds_home_and_not_what_is_far(name: str) -> None:
    m, space = machine(name), space_of(name)
    if m.solids is None and m.regions is None:
        with pytest.raises(kin.InputError):
            space.volume()
        with pytest.raises(kin.InputError):
            space.section()
        return
    if m.solids is None:
        place = m.transform(m.home.pose, m.home.mode)[:3, 3]
    else:
        spec = next(s for s in m.solid_specs if s.key.partition("/")[0] == "workspace")
        place = m.solids.point(spec.key, m.home.pose, m.home.mode)
    assert space.contains(place)
    far = np.array([[1e5, 0.0, 0.0], [0.0, 3e4, 2e4]])
    assert not space.contains(far).any()


@pytest.mark.parametrize("name", ONE_EACH)
def test_its_size_has_an_error_and_its_files_are_written(name: str, tmp_path: Path) -> None:
    m, space = machine(name), space_of(name)
    if m.solids is None and m.regions is None:
        pytest.skip("a mechanism without a workspace that is drawn")
    if m.solids is None:
        section = space.section()
        assert section.area > 0.0
        saved = section.save(tmp_path / "plane.dxf")
    else:
        solid = space.solid("preview")
        assert solid.built.watertight
        assert solid.volume > 0.0
        volume = space.volume(1e-3, pieces=False)
        allowed = volume.error + solid.built.volume_error
        assert solid.volume == pytest.approx(volume.value, abs=allowed)
        saved = solid.save(tmp_path / "workspace.stl")
        with pytest.raises(kin.InputError):
            solid.save(tmp_path / "workspace.txt")
        assert sorted(tmp_path.iterdir()) == [saved]
    assert saved.stat().st_size > 500


@pytest.mark.parametrize("name", ONE_EACH)
def test_its_aspects_are_told_or_refused(name: str) -> None:
    m, space = machine(name), space_of(name)
    if "aspects" not in {spec.key for spec in (*m.solid_specs, *m.region_specs)}:
        with pytest.raises(kin.InputError, match=r"aspects|plane"):
            space.aspects("preview")
        return
    found = space.aspects("preview")
    if isinstance(found, ShownSolid):
        assert {piece.sign for piece in found.built.pieces} <= {-1, 0, 1}
        assert found.built.pieces
    else:
        assert all(region.section.area > 0.0 for region in found)


@pytest.mark.parametrize("name", ONE_EACH)
def test_a_machine_at_a_posture_answers_everything(name: str) -> None:
    m = machine(name)
    here = m.at(held(name)[1].pose, m.home.mode)
    assert here.reachable
    assert here.singularities() == ()
    assert here.drawing().bars
    assert here.pose.to_dict().keys() == {axis.json_key for axis in m.coordinates}
    assert here.to_dict()["within_stroke"] is True
    moved = here.velocity(joint_rates={m.joints[0].key: 1.0})
    assert moved.joint_rates[0] == pytest.approx(1.0)
    for result in (moved, here.forces([0.0, 0.0, -1.0, 0.0, 0.0, 0.0]), m.forward(here.joints)):
        plain = json.loads(json.dumps(result.to_dict(), allow_nan=False))
        assert plain.keys() >= {"joint_rates"} or plain.keys() >= {"forces"} or plain["poses"]
    assert here.follow({m.joints[0].key: here.joints[0]}).posture.reachable
    for clearance in here.clearances():
        assert clearance.text
    away = m.at([1.5 * axis.upper for axis in m.coordinates], m.home.mode)
    assert not away.reachable
    assert away.nearest_pose().text
    for text in (here, away, m, m.workspace(), m.home, m.inverse(m.home.pose)):
        assert 10 < len(repr(text)) < 600


@pytest.mark.parametrize("name", ONE_EACH)
def test_the_sign_of_an_aspect_is_that_of_the_determinant(name: str) -> None:
    m = machine(name)
    if m.solids is None or all(spec.key != "aspects" for spec in m.solid_specs):
        pytest.skip("a mechanism without aspects as solids")
    home = np.array(m.home.pose)
    low, high = (np.array([getattr(c, end) for c in m.coordinates]) for end in ("lower", "upper"))
    # A solid that depends on a coordinate is of its value at home.
    for n, step in enumerate(0.01 * np.eye(len(home))):
        one, two = (
            m.solids.request("aspects", p.tolist(), (m.home.mode,), "normal")
            for p in (home, home + step)
        )
        if one.arguments != two.arguments:
            low[n] = high[n] = home[n]
    rng = np.random.default_rng(4)
    for mode in dict.fromkeys((m.home.mode, *m.mechanism.modes[:2])):
        poses = rng.uniform(low, high, (200_000, len(low)))
        poses = poses[m.inverse.inside(poses, (mode,))][:40]
        if not len(poses):
            continue
        built = build_solid(m.solids.request("aspects", poses[0].tolist(), (mode,), "normal"))
        back = np.linalg.inv(m.solids.placement("aspects", poses[0].tolist()))
        told = 0
        for pose in poses:
            point = np.append(m.solids.point("aspects", pose.tolist(), mode), 1.0)
            piece = built.piece_at((back @ point)[:3])
            determinant = float(m.statics.wrenches(pose, mode).determinant)
            if piece is not None and abs(determinant) > 1e-3:  # else a chord may lie between
                assert np.sign(determinant) == built.pieces[piece].sign
                told += 1
        assert told > 10
