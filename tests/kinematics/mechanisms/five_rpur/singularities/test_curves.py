"""Singular curves: dependent wrenches on them, one sign between them, links at their reach."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.errors import ComputationError, InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.inverse import joint_points
from kinematics.mechanisms.five_rpur.singularities.curves import Loci
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from tests.kinematics.mechanisms.five_rpur.asked import wrench_matrix
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.mechanisms.five_rpur.singularities.cases import (
    always_singular,
    closing_points,
    poses,
    random_case,
)

TABLE_1 = preset("rpur-table1")


def curves_of(found):
    for n, (first, last) in enumerate(zip(found.start[:-1], found.start[1:], strict=True)):
        yield found.kinds[n], found.limb[n], slice(first, last)


def poses_of(key, found, pose, at):
    """All points of the curves as poses."""
    if key == "orientation":
        return np.column_stack([np.tile(pose[:3], (len(found.points), 1)), found.points])
    points = np.insert(found.points, 0, at, axis=1)
    return poses(None, pose[3], pose[4], points)


@settings(max_examples=12)
@given(st.integers(0, 10**6), st.sampled_from([spec.key for spec in Loci.loci]))
def test_every_point_is_singular_as_it_is_said_to_be(seed: int, key: str) -> None:
    design, phi, theta, mode = random_case(seed)
    determinant = Determinant.at(design, phi, theta, mode)
    if not determinant.closes:
        return
    center = closing_points(determinant, 1, seed)[0]
    pose = poses(design, phi, theta, [center])[0]
    at = float(center[0]) + 1.0 if key == "section" else None
    try:
        found = machine_of(design).singularities.locus(key, pose, mode, at)
    except ComputationError:
        return
    where = poses_of(key, found, pose, at)
    a, b, c = joint_points(design, where, mode)
    rho = np.linalg.norm(b - a, axis=-1)
    for kind, limb, curve in curves_of(found):
        reach = np.abs((c - b)[curve, :, 1])
        if kind == "serial":
            assert reach[:, limb - 1] == pytest.approx(design.link[limb - 1], rel=1e-7)
            assert (reach <= design.link * (1 + 1e-9)).all()
            continue
        assert kind == "parallel"
        assert limb == 0
        matrix = wrench_matrix(design, where[curve], mode, length=100.0)
        force = np.linalg.norm(matrix[:, :5, :3], axis=-1)
        # Where an actuator has no length, or stands across a link at its reach, so that any force
        # passes, the line of the wrench is undetermined.
        sure = (rho[curve] > 1e-3).all(axis=-1) & (force > 1e-4).all(axis=-1)
        unit = matrix[sure] / np.linalg.norm(matrix[sure], axis=-1, keepdims=True)
        sizes = np.linalg.svd(unit, compute_uv=False)
        assert sizes[:, -1].max(initial=0.0) < 1e-5
    parallel = np.concatenate(
        [np.empty(0), *(found.residual[c] for k, _, c in curves_of(found) if k == "parallel")]
    )
    assert parallel.size == 0 or np.median(parallel) < 1e-9
    low, high = found.bounds.T
    assert (found.points >= low - 1e-9).all()
    assert (found.points <= high + 1e-9).all()


def test_between_the_curves_of_a_section_the_sign_stays() -> None:
    """Along lines z′ the determinant changes its sign where they cross a curve, and only there."""
    pose, mode = [50.0, 90.0, -200.0, 0.3, -0.4], "+++++"
    determinant = Determinant.at(TABLE_1, 0.3, -0.4, mode)
    at = 30.0
    found = machine_of(TABLE_1).singularities.locus("section", pose, mode, at)
    (low, high), (bottom, top) = found.bounds
    for y in np.linspace(low, high, 9)[1:-1]:
        z = np.linspace(bottom, top, 4001)
        line = np.column_stack([np.full_like(z, at), np.full_like(z, y), z])
        changes = np.flatnonzero(np.diff(np.sign(determinant.value(line))))
        crossed = []
        for kind, _, curve in curves_of(found):
            if kind == "parallel":
                v, w = found.points[curve].T
                k = np.flatnonzero((v[:-1] - y) * (v[1:] - y) < 0.0)
                part = (y - v[k]) / (v[k + 1] - v[k])
                crossed += (w[k] + part * (w[k + 1] - w[k])).tolist()
        assert apart(crossed) == pytest.approx(apart(z[changes]), abs=2.0)


def apart(places, gap=6.0):
    """Sorted, without pairs closer than the nodes of the grid that the curves are found on."""
    found: list[float] = []
    for at in sorted(places):
        if found and at - found[-1] < gap:
            found.pop()
        else:
            found.append(float(at))
    return found


def test_orientations_are_those_of_sections() -> None:
    """A singular orientation of a position has the position in its singular section."""
    pose, mode = np.array([50.0, 90.0, -200.0, 0.3, -0.4]), "+-+-+"
    found = machine_of(TABLE_1).singularities.locus("orientation", pose, mode)
    assert set(found.kinds) == {"serial", "parallel"}
    _, _, curve = next(c for c in curves_of(found) if c[0] == "parallel")
    for phi, theta in found.points[curve][::40]:
        determinant = Determinant.at(TABLE_1, phi, theta, mode)
        value, gradient = determinant.value_and_gradient(pose[:3] @ determinant.turn)
        assert abs(value) <= 1e-6 * np.linalg.norm(gradient) + 1e-16


def test_nothing_closes_no_curves() -> None:
    away = [0.0, 900.0, 0.0, 0.0, 0.0]
    assert machine_of(TABLE_1).singularities.locus("orientation", away, "+++++").start.tolist() == [
        0
    ]


def test_what_cannot_be_drawn_is_told() -> None:
    pose = [50.0, 90.0, -200.0, 0.3, -0.4]
    always = always_singular(TABLE_1)
    for key, where in (("section", "of this section"), ("orientation", "at this position")):
        with pytest.raises(ComputationError, match=where):
            machine_of(always).singularities.locus(key, pose, "+++++")
    with pytest.raises(InputError, match="no chart 'tilt'"):
        machine_of(TABLE_1).singularities.locus("tilt", pose, "+++++")
    with pytest.raises(InputError):
        machine_of(TABLE_1).singularities.locus("section", pose[:4], "+++++")
    with pytest.raises(InputError):
        machine_of(TABLE_1).singularities.locus("section", pose, "+++++", float("nan"))


def test_behind_the_shared_interface() -> None:
    pose = [50.0, 90.0, -200.0, 0.3, -0.4]
    for spec in machine_of(TABLE_1).singularities.loci:
        found = machine_of(TABLE_1).singularities.locus(spec.key, pose, "+++++")
        assert "parallel" in found.kinds
