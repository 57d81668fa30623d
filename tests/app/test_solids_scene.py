"""Solids in the scene: two shells, from the inside out; sharp edges; a plane that cuts."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.features.singularities.state import SetControl
from app.features.workspace.compute import (
    Built,
    SolidWish,
    colour_key,
    others_asked,
    piece_here,
    wishes,
)
from app.features.workspace.part import SolidsPart
from app.features.workspace.state import ChooseModes, Fade, Show
from app.review.changes import SetOption, change
from app.review.state import new_review
from app.scene import painting, palette
from app.scene.painting import below, below_lines
from app.scene.shapes import cylinder
from app.scene.solids import HERE, Look, Solids
from kinematics.designs.files import load_design
from kinematics.facets.solids import build_solid
from kinematics.solids.edges import crease_lines
from tests.app.seats import Seat, seat


@pytest.fixture(scope="module")
def page() -> Iterator[Seat]:
    with seat("rps-3") as opened:
        yield opened


@pytest.fixture(scope="module")
def both() -> dict[str, tuple[SolidWish, Any]]:
    """Workspace and aspects of a 3-RPS, coarse."""
    review, _ = change(new_review(load_design("rps-3")), Show("aspects", True))
    review, _ = change(review, Show("workspace", True))
    return {w.spec.key: (w, build_solid(w.requests["preview"])) for w in wishes(review)}


def _show(
    page: Seat, key: str, both: dict[str, tuple[SolidWish, Any]], look: Look, **more: Any
) -> Any:
    scene: Solids = page.page.part(SolidsPart)._scene
    wish, solid = both[key]
    coats = painting.plain(solid, palette.WORKSPACE)
    if key == "aspects":
        coats = painting.pieces(solid, locus=True)
    scene.show(key, solid, wish.placement, coats, look, **more)
    return coats


def test_what_is_within_is_made_first_and_far_sides_before_near_ones(page: Seat) -> None:
    names = list(page.server.scene._handle_from_node_name)
    order = [n for n in names if n.startswith("/solids/") and n[-1].isdigit()]
    of = [n.split("/")[2] for n in order]
    assert of == sorted(of)  # aspects, then the workspace
    for key in ("aspects", "workspace"):
        sides = [n.split("/")[3].rstrip("0123456789") for n in order if n.split("/")[2] == key]
        assert sides == sorted(sides)  # back, then front
        assert len(set(sides)) == 2
    assert names.index("/grid") < names.index(order[0])
    assert names.index("/footprint") < names.index(order[0])


def test_the_two_shells_have_the_opacities_of_the_design(page: Seat, both: Any) -> None:
    _show(page, "workspace", both, Look())
    back, front = page.node("/solids/workspace/back0"), page.node("/solids/workspace/front0")
    assert (back.side, front.side) == ("back", "front")
    assert (back.opacity, front.opacity) == (pytest.approx(0.10), pytest.approx(0.16))
    assert np.array_equal(back.vertices, front.vertices)
    assert np.array_equal(back.faces, front.faces)
    assert page.node("/solids/workspace/edges").thickness == 1.0
    _show(page, "workspace", both, Look(power=0.0))
    assert (back.opacity, front.opacity) == (1.0, 1.0)
    _show(page, "workspace", both, Look(faint=0.5))
    assert front.opacity == pytest.approx(0.08)


def test_only_edges_stay_of_what_is_bare_and_nearly_so_of_what_is_outlined(
    page: Seat, both: Any
) -> None:
    scene = page.page.part(SolidsPart)._scene
    _show(page, "workspace", both, Look(bare=True))
    assert page.seen("/solids/workspace") == ["/solids/workspace", "/solids/workspace/edges"]
    _show(page, "workspace", both, Look(outlined=True))
    assert "/solids/workspace/back0" not in page.seen("/solids/")
    assert page.node("/solids/workspace/front0").opacity == pytest.approx(0.03)
    scene.hide("workspace")
    assert page.seen("/solids/workspace") == []


def test_the_piece_with_the_machine_stands_out(page: Seat, both: Any) -> None:
    coats = _show(page, "aspects", both, Look(here=1))
    assert coats[0].color == palette.BEYOND
    shown = [page.node(f"/solids/aspects/front{n}").opacity for n in range(len(coats))]
    assert shown[0] == pytest.approx(painting.LOCUS[1])
    assert shown[1] == pytest.approx(painting.ASPECT[1])
    assert shown[2] == pytest.approx(HERE * painting.ASPECT[1])
    wish, solid = both["aspects"]
    here = piece_here(page.review, Built(wish, "preview", solid))
    assert here is not None
    at = page.review.machine.solids.point("aspects", page.review.pose, page.review.mode)
    low, high = solid.pieces[here].bounds
    assert (low <= at).all()
    assert (at <= high).all()
    assert piece_here(page.review, Built(*_plain(both))) is None


def _plain(both: dict[str, tuple[SolidWish, Any]]) -> tuple[SolidWish, Any, Any]:
    return both["workspace"][0], "preview", SimpleNamespace(piece_of=None)


def test_the_slider_goes_from_nothing_to_opaque(both: Any) -> None:
    from app.features.workspace.part import _power

    review, _ = change(new_review(load_design("rps-3")), Show("workspace", True))
    for opacity, power in ((1.0, 0.0), (0.35, 1.0)):
        faded, _ = change(review, Fade(("workspace",), opacity))
        (wish,) = (w for w in wishes(faded) if w.spec.key == "workspace")
        assert _power(wish) == pytest.approx(power)
    faded, _ = change(review, Fade(("workspace",), 0.0))
    (wish,) = (w for w in wishes(faded) if w.spec.key == "workspace")
    assert 0.16 ** _power(wish) < 1e-6


def test_a_plane_takes_away_what_is_beyond_it(page: Seat, both: Any) -> None:
    normal = np.array([1.0, 0.0, 0.0])
    _, solid = both["workspace"]
    _show(page, "workspace", both, Look())
    front = page.node("/solids/workspace/front0")
    middle = float(np.median(front.vertices[:, 0]))
    whole = front.vertices[front.faces]
    _show(page, "workspace", both, Look(), cut=(normal, middle))
    cut = front.vertices[front.faces]
    assert cut[..., 0].max() == pytest.approx(middle, abs=1e-3)
    assert cut[..., 0].min() == whole[..., 0].min()
    assert page.node("/solids/workspace/edges").points[..., 0].max() <= middle + 1e-3
    _show(page, "workspace", both, Look())
    assert np.array_equal(front.vertices[front.faces], whole)
    assert len(solid.shaded.faces) == len(front.faces)


def test_limbs_are_named_where_each_stands_out() -> None:
    with seat("rpur-table1") as page:
        review = page.review
        for limb in (1, 3, 5):
            review, _ = change(review, Show(f"limb{limb}/whole", True))
        review, _ = change(review, Show("limb3/H1", True))
        scene = page.page.part(SolidsPart)._scene
        placed = {
            w.spec.key: (build_solid(w.requests["preview"]), w.placement) for w in wishes(review)
        }
        scene.name(placed)
        names = [n for n in page.seen("/labels/") if hasattr(page.node(n), "text")]
        texts = {page.node(n).text: page.node(n).position for n in names}
        assert set(texts) == {"limb 1", "limb 3", "limb 5", "H₁ limb 3"}
        places = np.array(list(texts.values()))
        gaps = np.linalg.norm(places[:, None] - places, axis=-1)[np.triu_indices(4, 1)]
        assert gaps.min() > 40.0
        scene.name({})
        assert not [n for n in page.seen("/labels/") if hasattr(page.node(n), "text")]


def _area(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, n]].astype(float) for n in range(3))
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def test_two_halves_are_the_whole() -> None:
    vertices, faces = cylinder(24)
    rng = np.random.default_rng(7)
    for normal in rng.normal(size=(20, 3)):
        at = float(rng.uniform(-0.5, 0.5))
        halves = below(vertices, faces, normal, at), below(vertices, faces, -normal, -at)
        assert sum(_area(*half) for half in halves) == pytest.approx(_area(vertices, faces))
        lines = rng.normal(size=(40, 2, 3)).astype(np.float32)
        length = sum(
            float(np.linalg.norm(np.diff(half, axis=1), axis=2).sum())
            for half in (below_lines(lines, normal, at), below_lines(lines, -normal, -at))
        )
        assert length == pytest.approx(
            np.linalg.norm(np.diff(lines, axis=1), axis=2).sum(), rel=1e-5
        )


def _roof(degrees: float) -> tuple[np.ndarray, np.ndarray]:
    """Two faces that meet at an edge, each with vertices of its own."""
    turn = np.radians(degrees)
    tip = [np.cos(turn), 0.0, np.sin(turn)]
    vertices = [[0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, 0], [0, 1, 0], tip]
    return np.array(vertices, np.float32), np.array([[0, 1, 2], [4, 3, 5]], np.uint32)


@pytest.mark.parametrize(("degrees", "edges"), [(5.0, 4), (20.0, 4), (28.0, 5), (90.0, 5)])
def test_an_edge_is_where_faces_meet_at_more_than_24_degrees(degrees: float, edges: int) -> None:
    assert len(crease_lines(*_roof(degrees))) == edges  # four of them are of one face only


def test_colours_of_a_page_follow_its_theme(page: Seat, both: Any) -> None:
    for dark in (True, False):
        page.do(SetOption("dark", dark))
        of = palette.scheme(dark)
        _show(page, "workspace", both, Look())
        assert tuple(page.node("/solids/workspace/edges").colors) == palette.rgb(of.edge)
        assert tuple(page.node("/machine/base").color) == palette.rgb(of.base)
        assert tuple(page.node("/machine/platform").color) == palette.rgb(of.platform)
        assert tuple(page.node("/grid").cell_color) == palette.rgb(of.cell)
        assert tuple(page.node("/lights/sky").ground_color) == palette.rgb(of.below)
        linear = {tuple(c) for c in page.node("/machine/bars").batched_colors}
        assert palette.linear(of.joint) in linear
        assert palette.linear(of.steel) in linear


@pytest.mark.parametrize("dark", [False, True])
def test_the_legend_tells_what_is_in_the_scene_in_its_colours(both: Any, dark: bool) -> None:
    review, _ = change(new_review(load_design("rps-3")), SetOption("dark", dark))
    of = palette.scheme(dark)
    solids = {key: solid for key, (_, solid) in both.items()}
    assert colour_key(review, {}) == ()
    ((color, text),) = colour_key(review, {"workspace": solids["workspace"]})
    assert color == of.workspace
    assert text.startswith("workspace")
    entries = dict(colour_key(review, {"aspects": solids["aspects"]}))
    assert entries == {
        of.aspects[1][0]: "det > 0",
        of.aspects[-1][0]: "det < 0",
        of.beyond: "singular surface",
    }
    bare, _ = change(review, SetControl("locus", False))
    assert of.beyond not in dict(colour_key(bare, solids))
    shaded, _ = change(review, SetControl("shade", "conditioning"))
    assert len(colour_key(shaded, solids)) == 1  # the measure has a scale of its own


def test_other_modes_are_pale_edges_once_they_are_known() -> None:
    review = new_review(load_design("rpur-table1"))
    asked = others_asked(review)
    assert asked is not None
    solid = asked.question.answer(*asked.arguments)
    assert solid.pieces[0].volume > 0.0
    with seat("rpur-table1") as page:
        scene: Solids = page.page.part(SolidsPart)._scene
        at = np.eye(4)
        at[:3, 3] = 1.0, 2.0, 3.0
        scene.beside(solid, at)
        node = page.node("/solids/others")
        assert node.visible
        np.testing.assert_allclose(node.points, solid.edges + at[:3, 3], atol=1e-3)
        scene.beside(None, at)
        assert not node.visible


@pytest.mark.parametrize(
    "what", [ChooseModes("all"), ChooseModes(("+++++",)), Show("workspace", False)]
)
def test_there_are_none_where_their_own_are_shown(what: Any) -> None:
    review = new_review(load_design("rpur-table1"))
    assert others_asked(change(review, what)[0]) is None
