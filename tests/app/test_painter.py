"""Coats of solids as the page asks for them, and a measure's values as they come."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.features.move.state import Place
from app.features.singularities import compute
from app.features.singularities.compute import spot_of
from app.features.singularities.state import SetControl
from app.features.workspace.compute import FIELD, SolidWish, wishes
from app.features.workspace.painter import Painter
from app.features.workspace.state import Show
from app.jobs.answers import Answers
from app.jobs.lane import Done, Job
from app.review.changes import change
from app.review.state import Review, new_review
from app.scene import painting, palette
from app.scene.painting import Coat
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
    return {wish.spec.key: (wish, build_solid(wish.requests["preview"])) for wish in wishes(review)}


class Shop:
    """A painter with a store of values, and a lane that only notes what it is told."""

    def __init__(self) -> None:
        self.painter = Painter()
        self.wanted: list[Job] = []
        lane: Any = SimpleNamespace(want=self._want)
        self.answers = Answers({"colours": lane})

    def _want(self, jobs: list[Job]) -> None:
        self.wanted = list(jobs)

    def coats(self, review: Review, *solids: tuple[SolidWish, Any]) -> list[tuple[Coat, ...]]:
        asked = [self.painter.asked(review, *each) for each in solids]
        self.answers.want([each for each in asked if each is not None])
        values = [
            None if each is None else self.answers.of(each.question, each.request).now
            for each in asked
        ]
        return [self.painter.coats(review, *s, v) for s, v in zip(solids, values, strict=True)]

    def work(self) -> None:
        for job in self.wanted:
            self.answers.take(Done(job, job.function(*job.arguments)))


def test_coats_are_kept_while_nothing_changes(review: Review, built: dict[str, Any]) -> None:
    shop = Shop()
    (first,) = shop.coats(review, built["aspects"])
    assert shop.coats(review, built["aspects"])[0] is first
    assert not shop.wanted
    bare, _ = change(review, SetControl("locus", False))
    (other,) = shop.coats(bare, built["aspects"])
    assert palette.BEYOND not in [coat.color for coat in other]
    (plain,) = shop.coats(review, built["workspace"])
    assert [coat.color for coat in plain] == [palette.WORKSPACE]


def test_a_measure_is_asked_for_once_and_then_painted(
    review: Review, built: dict[str, Any]
) -> None:
    shop = Shop()
    both = built["workspace"], built["aspects"]
    shaded, _ = change(review, SetControl("shade", "conditioning"))
    shop.coats(shaded, *both)
    assert shop.painter.scale("workspace") is None
    assert len(shop.wanted) == 2
    for job in shop.wanted:
        assert len(job.function(*job.arguments)) == len(job.arguments[-1])
    shop.work()
    coats, _ = shop.coats(shaded, *both)
    assert shop.wanted == []
    assert len(coats) > 3
    steps = shop.painter.scale("workspace")
    assert steps is not None
    ramp = {steps.color(n) for n in range(painting.STEPS)}
    assert {coat.color for coat in coats} <= ramp | {palette.WORKSPACE}
    assert shop.coats(shaded, *both)[0] is coats
    # Another measure has other steps; none has no colours.
    other, _ = change(shaded, SetControl("shade", "singular_value"))
    shop.coats(other, *both)
    assert shop.painter.scale("workspace") is None
    assert shop.wanted
    shop.coats(review, *both)
    assert shop.painter.scale("workspace") is None


def test_the_load_counts_for_measures_that_need_it(review: Review, built: dict[str, Any]) -> None:
    shop = Shop()

    def asked(review: Review) -> Job:
        shop.coats(review, built["workspace"])
        (job,) = shop.wanted
        return job

    forces, _ = change(review, SetControl("shade", "largest_force"))
    heavy, _ = change(forces, SetControl("load", (0.0, 0.0, -200.0, 0.0, 0.0, 0.0)))
    job, more = asked(forces), asked(heavy)
    assert job.key != more.key
    one, two = (j.function(*j.arguments) for j in (job, more))
    known = np.isfinite(one)
    assert known.any()
    assert two[known] == pytest.approx(2.0 * one[known])
    bare, _ = change(review, SetControl("shade", "conditioning"))
    light, _ = change(bare, SetControl("load", (0.0, 0.0, -1.0, 0.0, 0.0, 0.0)))
    assert asked(bare).key == asked(light).key


def test_few_values_are_kept() -> None:
    answers = Answers({})
    for n in range(20):
        answers.put(FIELD, (n,), np.zeros(1))
    assert sum(answers.kept(FIELD((n,))) is not None for n in range(20)) <= 6


def test_what_cannot_be_measured_keeps_the_plain_colour(
    review: Review, built: dict[str, Any]
) -> None:
    shop = Shop()
    shaded, _ = change(review, SetControl("shade", "conditioning"))
    wish, _ = built["workspace"]
    shop.coats(shaded, built["workspace"])
    (job,) = shop.wanted
    shop.answers.take(Done(job, np.full(len(job.arguments[-1]), np.nan)))
    (coats,) = shop.coats(shaded, built["workspace"])
    assert [c.color for c in coats] == [palette.WORKSPACE]
    empty: Any = SimpleNamespace(triangles=0, shaded=None)
    assert Painter().coats(shaded, wish, empty, None) == ()


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
    faces = solid.mesh.faces[np.asarray(solid.piece_of) == piece]
    corners = solid.mesh.vertices[np.unique(faces)].astype(float)
    poses = machine_of(design).solids.poses("aspects", tilted.pose, tilted.mode, corners)
    there = machine_of(design).statics.wrenches(poses, tilted.mode).determinant * determinant
    # Corners stand on the singular surface too; a piece's centroid need not be inside it.
    assert np.nanmean(there > -0.1 * np.nanmax(there)) == 1.0
    assert np.nanmean(there > -1e-3 * np.nanmax(there)) > 0.9
