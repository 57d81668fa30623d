"""Workspaces in a plane as the page lays them out: the same areas as the library's, filled once."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest

from app.features.design.state import EditDesign
from app.features.move.state import Flip, Move
from app.features.workspace import compute
from app.features.workspace.compute import region_colors
from app.features.workspace.files import regions_file
from app.features.workspace.state import ChooseModes, Flat, SetFlat, Workspace
from app.review.changes import change
from app.review.state import Review, new_review
from app.scene import palette
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class

PAPERS_AREA = 1_983_383.8618  # mm², of the five-bar's workspace in all working modes


@cache
def _review(name: str) -> Review:
    """With the regions of all modes on display."""
    return change(new_review(load_design(name)), ChooseModes("all"))[0]


@cache
def _laid(name: str, key: str, modes: tuple[str, ...] | None = None) -> compute.Laid:
    review = _review(name)
    review, _ = change(review, SetFlat("key", key))
    if modes:
        review, _ = change(review, ChooseModes(modes))
    wanted = compute.wish(review)
    assert wanted is not None
    return compute.lay(wanted)


def _cases() -> list[tuple[str, str]]:
    found = []
    for name in ("five-bar", "sps-spr"):
        review = _review(name)
        found += [(name, s.key) for s in review.machine.region_specs]
    return found


def _area(fill: compute.Fill) -> float:
    a, b, c = (fill.vertices[fill.faces[:, n]].astype(float) for n in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


@pytest.mark.parametrize(("name", "key"), _cases())
def test_the_fills_are_as_large_as_the_librarys_regions(name: str, key: str) -> None:
    laid = _laid(name, key)
    review = _review(name)
    wanted = review.machine.regions.of(key, review.pose, None)
    assert [r.title for r in laid.regions] == [r.title for r in wanted]
    assert len(laid.fills) == len(wanted)
    for region, true, fill in zip(laid.regions, wanted, laid.fills, strict=True):
        assert region.section.area == pytest.approx(true.section.area, rel=1e-12)
        if region.mode not in ("", review.mode):  # it would lie over the present mode's
            assert len(fill.faces) == 0
            continue
        # Chords of STEP mm leave out or add a sliver beside the arcs.
        slack = true.section.perimeter * compute.STEP**2 / 8 / 50
        assert _area(fill) == pytest.approx(true.section.area, rel=2e-3, abs=slack)
    if (name, key) == ("five-bar", "workspace"):
        assert laid.regions[0].section.area == pytest.approx(PAPERS_AREA, rel=1e-9)


@pytest.mark.parametrize(("name", "key"), _cases())
def test_everything_lies_in_the_plane_and_edges_are_as_long_as_the_outline(
    name: str, key: str
) -> None:
    laid = _laid(name, key)
    normal, origin = laid.frame[:3, 2], laid.frame[:3, 3]
    for points in (laid.lines, laid.locus, *[fill.vertices for fill in laid.fills]):
        away = (points.reshape(-1, 3) - origin) @ normal
        assert np.abs(away).max(initial=0.0) < 1e-3
    lengths = np.linalg.norm(laid.lines[:, 1] - laid.lines[:, 0], axis=1)
    drawn = [r for r in laid.regions if r.mode in ("", _review(name).mode)]
    assert drawn
    perimeter = sum(r.section.perimeter for r in drawn)
    assert lengths.sum() == pytest.approx(perimeter, rel=1e-3)
    assert len(laid.line_limb) == len(laid.lines)
    assert set(laid.line_limb.tolist()) == {int(n) for r in drawn for n in r.section.limb.tolist()}


def test_where_the_present_mode_is_not_asked_for_the_first_one_is_drawn() -> None:
    review = _review("five-bar")
    review = review.having(Workspace(("-+", "--")), replace(review[Flat], key="modes"))
    wanted = compute.wish(review)
    assert wanted is not None
    laid = compute.lay(wanted)
    assert [r.mode for r in laid.regions] == ["-+", "--"]
    assert [len(fill.faces) > 0 for fill in laid.fills] == [True, False]


@pytest.mark.parametrize("name", ["five-bar", "sps-spr"])
def test_where_control_is_lost_it_is_lost(name: str) -> None:
    laid = _laid(name, "workspace")
    review = _review(name)
    design = review.design
    assert len(laid.locus)
    rng = np.random.default_rng(2)
    at = laid.locus[rng.choice(len(laid.locus), 12), 0]
    axes = machine_of(design).coordinates
    poses = np.tile(review.pose, (len(at), 1))
    for n, c in enumerate(axes):
        if c.key in ("x", "y", "z"):
            poses[:, n] = at[:, "xyz".index(c.key)]
    here = machine_of(design).measures(poses, review.mode, "conditioning")
    home = float(machine_of(design).measures(review.pose, review.mode, "conditioning"))
    known = here[np.isfinite(here)]
    assert len(known)
    assert known.max() < 0.02 * home


def test_modes_choose_the_five_bars_workspace() -> None:
    every, one = _laid("five-bar", "workspace"), _laid("five-bar", "workspace", ("++",))
    assert one.regions[0].section.area <= every.regions[0].section.area * (1 + 1e-12)
    each = _laid("five-bar", "modes", ("++", "--"))
    assert {r.mode for r in each.regions} == {"++", "--"}
    pieces = _laid("five-bar", "aspects", ("++",))
    assert {r.mode for r in pieces.regions} == {"++"}
    whole = _laid("five-bar", "modes", ("++",)).regions[0].section.area
    assert sum(r.section.area for r in pieces.regions) == pytest.approx(whole, rel=1e-6)


def test_what_does_not_matter_asks_for_nothing_new() -> None:
    bar, sps = _review("five-bar"), _review("sps-spr")
    there, _ = change(bar, Move(0, 100.0))
    assert compute.wish(there) == compute.wish(bar)
    there, _ = change(sps, Move(2, 600.0))
    assert compute.wish(there) == compute.wish(sps)
    for review, what in (
        (bar, SetFlat("key", "aspects")),
        (bar, ChooseModes("current")),
        (bar, EditDesign(((("half_base",), 250.0),))),
        (sps, Move(5, 0.1)),
        (bar, SetFlat("locus", False)),
    ):
        assert compute.wish(change(review, what)[0]) != compute.wish(review)
    assert compute.wish(change(bar, SetFlat("on", False))[0]) is None
    assert compute.wish(_review("rps-3")) is None
    current, _ = change(bar, ChooseModes("current"))
    flipped = replace(current, mode="++")
    assert compute.wish(flipped) != compute.wish(current)
    assert change(bar, Flip(bar.mode))[0] == bar


def test_turned_the_region_lies_in_another_plane() -> None:
    turned, _ = change(_review("sps-spr"), Move(5, 0.4))
    wanted = compute.wish(turned)
    assert wanted is not None
    laid = compute.lay(wanted)
    before = _laid("sps-spr", "workspace")
    assert not np.allclose(laid.frame[:3, 2], before.frame[:3, 2])
    point = laid.fills[0].vertices.mean(axis=0)
    assert abs((point - laid.frame[:3, 3]) @ laid.frame[:3, 2]) < 1e-3
    off = replace(wanted, locus=False)
    assert compute.lay(off).locus.shape == (0, 2, 3)


def test_colours_tell_aspects_apart() -> None:
    aspects = _laid("five-bar", "aspects")
    colors = region_colors(aspects.regions)
    assert len(colors) == len(aspects.regions) > 1
    for region, color in zip(aspects.regions, colors, strict=True):
        assert color in palette.ASPECTS[region.sign]
    assert region_colors(aspects.regions[:1]) == (palette.WORKSPACE,)


@pytest.mark.parametrize(("name", "key"), _cases())
def test_files_hold_all_regions(name: str, key: str) -> None:
    laid = _laid(name, key)
    svg = regions_file(laid, "svg")
    assert svg.name == f"{laid.wish.design.name}_{key}.svg"
    root = ElementTree.fromstring(svg.data.decode())
    assert root.tag.endswith("svg")
    rows = list(csv.reader(io.StringIO(regions_file(laid, "csv").data.decode())))
    edges = sum(len(r.section.limb) for r in laid.regions)
    assert len(rows) > edges
    assert b"EOF" in regions_file(laid, "dxf").data


def test_an_empty_workspace_is_laid_out_as_nothing() -> None:
    review = _review("five-bar")
    apart, _ = change(review, EditDesign(((("half_base",), 5000.0),)))
    wanted = compute.wish(apart)
    assert wanted is not None
    laid = compute.lay(wanted)
    assert sum(r.section.area for r in laid.regions) == 0.0
    assert len(laid.lines) == 0
    assert all(len(fill.faces) == 0 for fill in laid.fills)
    assert mechanism_class("five_bar").kind == "five_bar"
    assert not math.isnan(laid.frame.sum())
