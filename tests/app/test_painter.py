"""Coats of solids as the page asks for them, and a measure's values as they come."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.features.move.state import Place
from app.features.singularities import compute
from app.features.singularities.painter import Painter
from app.features.singularities.part import spot_of
from app.features.singularities.state import SetControl
from app.features.workspace.compute import SolidWish, wishes
from app.features.workspace.state import Show
from app.jobs.worker import Built
from app.review.changes import change
from app.review.state import Review, new_review
from app.scene import painting, palette
from kinematics.designs.files import load_design
from kinematics.facets.solids import build_solid
from kinematics.machine import machine_of


@pytest.fixture(scope="module")
def review() -> Review:
    fresh = new_review(load_design("rps-3"))
    shown = change(fresh, Show("aspects", True))[0]
    return change(shown, Show("workspace", True))[0]


@pytest.fixture(scope="module")
def built(review: Review) -> dict[str, tuple[SolidWish, Any]]:
    """Both solids, coarse."""
    return {
        wish.spec.key: (wish, Built(wish, "preview", build_solid(wish.requests["preview"])))
        for wish in wishes(review)
    }


def test_coats_are_kept_while_nothing_changes(review: Review, built: dict[str, Any]) -> None:
    painter = Painter()
    wish, solid = built["aspects"]
    first = painter.coats(review, wish, solid)
    assert painter.coats(review, wish, solid) is first
    assert not painter.wants
    bare, _ = change(review, SetControl("locus", False))
    other = painter.coats(bare, wish, solid)
    assert palette.BEYOND not in [coat.color for coat in other]
    plain = painter.coats(review, *built["workspace"])
    assert [coat.color for coat in plain] == [palette.WORKSPACE]


def test_a_measure_is_asked_for_once_and_then_painted(
    review: Review, built: dict[str, Any]
) -> None:
    painter = Painter()
    shaded, _ = change(review, SetControl("shade", "conditioning"))
    for key in ("workspace", "aspects"):
        painter.coats(shaded, *built[key])
    assert painter.wants
    assert painter.scale(shaded) is None
    jobs = painter.jobs(shaded, spot_of(shaded))
    assert len(jobs) == 2
    assert not painter.wants
    for job in jobs:
        values = job.function(*job.arguments)
        assert len(values) == len(job.arguments[-1])
        painter.take(job.key, values)
    assert painter.jobs(shaded, spot_of(shaded)) == []
    coats = painter.coats(shaded, *built["workspace"])
    assert len(coats) > 3
    steps = painter.scale(shaded)
    assert steps is not None
    ramp = {steps.color(n) for n in range(painting.STEPS)}
    assert {coat.color for coat in coats} <= ramp | {palette.WORKSPACE}
    assert painter.coats(shaded, *built["workspace"]) is coats
    # Another measure has other steps; none has no colours.
    other, _ = change(shaded, SetControl("shade", "singular_value"))
    painter.coats(other, *built["workspace"])
    assert painter.scale(other) is None
    assert painter.wants
    assert painter.scale(review) is None


def test_the_load_counts_for_measures_that_need_it(review: Review, built: dict[str, Any]) -> None:
    painter = Painter()
    forces, _ = change(review, SetControl("shade", "largest_force"))
    painter.coats(forces, *built["workspace"])
    (job,) = painter.jobs(forces, spot_of(forces))
    heavy, _ = change(forces, SetControl("load", (0.0, 0.0, -200.0, 0.0, 0.0, 0.0)))
    (more,) = painter.jobs(heavy, spot_of(heavy))
    assert job.key != more.key
    one, two = (j.function(*j.arguments) for j in (job, more))
    known = np.isfinite(one)
    assert known.any()
    assert two[known] == pytest.approx(2.0 * one[known])
    bare, _ = change(review, SetControl("shade", "conditioning"))
    light, _ = change(bare, SetControl("load", (0.0, 0.0, -1.0, 0.0, 0.0, 0.0)))
    assert painter.jobs(bare, spot_of(bare))[0].key == painter.jobs(light, spot_of(light))[0].key


def test_few_values_are_kept(review: Review) -> None:
    painter = Painter()
    for n in range(20):
        painter.take(("field", n), np.zeros(1))
    assert len(painter._fields) <= 6


def test_what_cannot_be_measured_keeps_the_plain_colour(
    review: Review, built: dict[str, Any]
) -> None:
    painter = Painter()
    shaded, _ = change(review, SetControl("shade", "conditioning"))
    wish, solid = built["workspace"]
    painter.coats(shaded, wish, solid)
    (job,) = painter.jobs(shaded, spot_of(shaded))
    painter.take(job.key, np.full(len(job.arguments[-1]), np.nan))
    assert [c.color for c in painter.coats(shaded, wish, solid)] == [palette.WORKSPACE]
    empty = SimpleNamespace(
        solid=SimpleNamespace(triangles=0, shaded=None), wish=wish, resolution="preview"
    )
    assert Painter().coats(shaded, wish, empty) == ()  # type: ignore[arg-type]


MACHINES = ("rpur-table1", "five-bar", "rps-3", "spr-3", "sps-spr")


@pytest.mark.parametrize("name", MACHINES)
def test_points_of_a_solid_stand_for_poses_and_back(name: str) -> None:
    review = new_review(load_design(name))
    design = review.design
    for spec in machine_of(design).solid_specs[:3]:
        at = machine_of(design).solids.point(spec.key, review.pose, review.mode)
        points = at + np.array([[0.0, 0.0, 0.0], [7.0, -4.0, 2.0], [-3.0, 5.0, 4.0]])
        poses = machine_of(design).solids.poses(spec.key, review.pose, review.mode, points)
        assert poses[0] == pytest.approx(review.pose, abs=1e-9)
        for point, pose in zip(points, poses, strict=True):
            again = machine_of(design).solids.point(spec.key, pose.tolist(), review.mode)
            assert again == pytest.approx(point, abs=1e-9)
            assert machine_of(design).inverse.posture(tuple(pose.tolist()), review.mode).closes


@pytest.mark.parametrize("name", MACHINES)
def test_a_field_is_the_measure_point_by_point(name: str) -> None:
    review = new_review(load_design(name))
    design = review.design
    for spec in machine_of(design).solid_specs[:1]:
        at = machine_of(design).solids.point(spec.key, review.pose, review.mode)
        points = at + np.array([[0.0, 0.0, 0.0], [6.0, 4.0, 1.0]])
        poses = machine_of(design).solids.poses(spec.key, review.pose, review.mode, points)
        for measure in machine_of(design).measures.specs:
            values = compute.field(spot_of(review), measure.key, spec.key, points)
            here, there = (
                next(v for m, v in compute.look(place).measures if m.key == measure.key)
                for place in (
                    spot_of(review),
                    replace(spot_of(review), pose=tuple(poses[1].tolist())),
                )
            )
            assert values == pytest.approx([here, there], rel=1e-9, nan_ok=True)


def test_a_field_where_there_is_no_pose_is_nothing() -> None:
    review = new_review(load_design("sps-spr"))
    values = compute.field(
        spot_of(review),
        "conditioning",
        "workspace/beta",
        np.array([[0.0, 0.0, 569.0], [0.0, 1e6, 569.0]]),
    )
    assert np.isfinite(values).tolist() == [True, False]


@pytest.mark.parametrize("name", ["rps-3", "spr-3"])
def test_the_platform_is_in_the_piece_of_its_sign(name: str) -> None:
    """The solid of a tripod is of orientations: where the platform stands is none of its places."""
    review, _ = change(new_review(load_design(name)), Show("aspects", True))
    tilted, _ = change(review, Place((review.pose[0], 0.3, 1.0)))
    design = review.design
    (wish,) = (w for w in wishes(tilted) if w.spec.key == "aspects")
    solid = build_solid(wish.requests["preview"])
    at = machine_of(design).solids.point("aspects", tilted.pose, tilted.mode)
    piece = solid.piece_at(at)
    assert piece is not None
    determinant = float(machine_of(design).statics.wrenches(tilted.pose, tilted.mode).determinant)
    middle = machine_of(design).solids.poses(
        "aspects", tilted.pose, tilted.mode, np.array(solid.pieces[piece].centroid)[None]
    )[0]
    other = float(machine_of(design).statics.wrenches(middle, tilted.mode).determinant)
    assert determinant * other > 0.0


def test_what_the_way_passes_is_told() -> None:
    review = new_review(load_design("rpur-table1"))
    spot = spot_of(review)
    down = (*review.pose[:2], 120.0, *review.pose[3:])
    found = compute.passed(spot, down)
    wanted = review.machine.paths.passed(review.posture, replace(review, pose=down).posture)
    assert found == wanted
    assert found
    assert compute.passed(spot, review.pose) == ()
