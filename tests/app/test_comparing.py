"""Designs side by side on the page: chosen, drawn, measured, swapped, taken away and kept.

With five-bars, whose workspaces are plane and quickly known.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from dataclasses import replace

import pytest

import kinematics as kin
from app.features.compare.compute import Request, compare, request_of
from app.features.compare.plot import sections_figure
from app.features.compare.state import Beside, PutBeside, SetBeside
from app.features.design.state import Milestones
from app.review import session
from app.review.changes import change
from app.review.state import new_review
from app.review.units import area_text
from kinematics.designs.files import load_design, read_design
from kinematics.errors import InputError
from tests.app import seats
from tests.app.seats import Seat, seat


def drawn(page: Seat) -> list[str]:
    """What the scene shows of the comparison, without the frames that viser puts above it."""
    ends = "back", "front", "edges", "bars", "bodies"
    return [name for name in page.seen("/compare/") if name.endswith(ends)]


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Iterator[Seat]:
    monkeypatch.setattr(seats, "INLINE", ("compare", "parts"))
    with seat("five-bar") as made:
        yield made


def test_a_design_is_put_beside_and_everything_is_told(page: Seat) -> None:
    assert "Choose a design" in page.text()
    assert drawn(page) == []
    page.put("Compare with", "five-bar")
    assert [design.name for design in page.review[Beside].designs] == ["five-bar"]
    assert "No number of the designs differs" in page.text()
    page.put("Limb 1: proximal r₁ (mm)", 420.0)
    told = page.text()
    assert "reached by A, B" in told
    assert told.count("100.0 %") == 1  # the smaller one lies within the other
    assert "◂" in told
    assert "/compare/part0/edges" in drawn(page)
    page.put("Scene shows", "The machines")
    assert drawn(page) == ["/compare/machine0/bars", "/compare/machine0/bodies"]
    edited = page.review.design
    page.press("Swap A and B")
    assert page.review.design.name == "five-bar"
    assert page.review[Beside].designs == (edited,)
    page.press("Save as", "ZIP")
    with zipfile.ZipFile(io.BytesIO(page.files[-1].data)) as pack:
        assert {"sizes.csv", "measures.csv", "common.dxf"} <= set(pack.namelist())
    page.press(f"Take {edited.name} away")
    assert page.review[Beside].designs == ()
    assert drawn(page) == []


@pytest.mark.slow
def test_other_coordinates_are_told(page: Seat) -> None:
    page.put("Compare with", "rpur-a1a1")
    assert "cannot be put over one another" in page.text()
    assert drawn(page) == []


def test_the_designs_beside_are_kept_in_a_session() -> None:
    review = new_review(load_design("five-bar"))
    for name in ("rpur-a1a1", "five-bar"):
        review, _ = change(review, PutBeside(load_design(name)))
    review, _ = change(review, SetBeside("shown", "machines"))
    text = session.to_text(review)
    assert session.from_text(text, origin="x") == review
    full, _ = change(review, PutBeside(load_design("five-bar")))
    with pytest.raises(InputError, match="at most 3 designs"):
        change(full, PutBeside(load_design("five-bar")))


def test_what_is_asked_follows_the_review() -> None:
    """The same numbers as of the command's request: orientation, modes and pose of the review."""
    review = new_review(load_design("rpur-table1"))
    assert request_of(review) is None
    review, _ = change(review, PutBeside(load_design("rpur-table1")))
    request = request_of(review)
    assert request is not None
    assert dict(request.held) == {"phi": review.pose[3], "theta": review.pose[4]}
    found = compare(request, 1e-3, measured=False)
    assert found.common is not None
    assert found.common.value == pytest.approx(found.sizes[0].value, rel=1e-3)
    assert not found.differences
    assert [one.posture is not None and one.posture.reachable for one in found.asked] == [True] * 2


def test_milestones_are_kept_compared_restored_and_saved(page: Seat) -> None:
    page.put("Name", "before longer links")
    page.press("Keep this state")
    before = page.review.design
    page.put("Limb 1: proximal r₁ (mm)", 500.0)
    page.put("Name", "longer")
    page.press("Keep this state")
    assert [m.name for m in page.review[Milestones].kept] == ["before longer links", "longer"]
    text = session.to_text(page.review)
    assert session.from_text(text, origin="x")[Milestones] == page.review[Milestones]
    page.press("Compare with before longer links")
    assert page.review[Beside].designs == (before,)
    page.press("Save longer as a design file")
    file = page.files[-1]
    assert file.name == "longer.toml"
    saved = read_design(file.data.decode(), origin=file.name, name="longer")
    assert saved.source.startswith("edited from five-bar")
    page.press("Restore before longer links")
    assert page.review.design == before
    page.press("Forget longer")
    assert [m.name for m in page.review[Milestones].kept] == ["before longer links"]
    page.put("Name", "  ")
    page.press("Keep this state")
    assert page.told[-1] == "a milestone needs a name"


def test_sections_by_one_plane_lie_over_one_another() -> None:
    names, held = ("rpur-table1", "rpur-table2"), (("phi", 0.1), ("theta", 0.0))
    machines = [kin.open(name) for name in names]
    home = machines[0].home
    designs = tuple(m.design for m in machines)
    request = Request(designs, held, ("+-+-+",), home.pose, home.mode, 320.0)
    found = compare(request, 1e-2, measured=False)
    areas = [m.workspace("+-+-+", **dict(held)).section(320.0).area for m in machines]
    assert [one.area for one in found.outlines if one is not None] == pytest.approx(areas)
    figure = sections_figure(found)
    assert figure is not None
    assert figure.content.count("<path") >= 4
    assert f"A {area_text(areas[0])}" in figure.idle
    through = compare(replace(request, at=None), 1e-2, measured=False)
    assert machines[0].sections is not None
    frame = machines[0].sections.frame(home.pose)
    place = machines[0].transform(home.pose, home.mode)[:3, 3]
    assert through.at == pytest.approx(frame[:3, 0] @ (place - frame[:3, 3]))
