"""Facets or the true surface: the choice in a review, in its file, on the page's wishes, in a
command.
"""

from __future__ import annotations

import json

import pytest

from app.features.design.state import UseDesign
from app.features.workspace import compute as view
from app.features.workspace.state import ChooseSurface, Workspace
from app.review import session
from app.review.changes import change
from app.review.history import History
from app.review.state import new_review
from app.terminal.tables import surface_text
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.facets.solids import RESOLUTIONS, build_solid


@pytest.fixture
def review():
    return new_review(load_design("rpur-table1"))


def test_the_choice_is_undone_and_survives_another_design(review):
    assert review[Workspace].surface == "facets"
    history, _ = History(review).apply(ChooseSurface("true"), 0.0)
    assert history.present[Workspace].surface == "true"
    assert history.undo().present == review
    other, _ = change(history.present, UseDesign(load_design("rpur-table2")))
    assert other[Workspace].surface == "true"


def test_the_choice_is_saved_and_read_again(review):
    chosen, _ = change(review, ChooseSurface("true"))
    assert session.from_text(session.to_text(chosen), origin="a") == chosen
    content = json.loads(session.to_text(chosen))
    del content["workspace_surface"]  # as before there was a choice
    assert session.from_text(json.dumps(content), origin="a") == review
    content["workspace_surface"] = "smooth"
    with pytest.raises(InputError, match="workspace_surface is one of 'facets', 'true'"):
        session.from_text(json.dumps(content), origin="a")


def test_another_surface_is_another_wish(review):
    chosen, _ = change(review, ChooseSurface("true"))
    facets, true = view.wishes(review)[0], view.wishes(chosen)[0]
    assert facets.what != true.what
    solids = {r: build_solid(true.requests[r]) for r in RESOLUTIONS if r != "fine"}
    assert solids["preview"].residual is None  # quick while the hand moves
    assert surface_text(solids["preview"]) == "facets, right on the average"
    assert solids["normal"].residual is not None
    assert "of the exact surfaces" in surface_text(solids["normal"])


def test_the_command_says_what_its_solid_is_made_of(bohemia):
    command = ("workspace", "rpur-mpa1", "--phi", "10", "--json")
    true, facets = (
        bohemia(*command, "--surface", "true", "-o", "a.stl").json,
        bohemia(*command).json,
    )
    assert (true["surface"], facets["surface"]) == ("true", "facets")
    assert facets["surface_residual_mm"] is None
    assert 0.0 < true["surface_residual_mm"] < 1e-9
    assert true["surface_unplaced"] < 0.01 * true["triangles"]
    off = abs(true["volume_mm3"] - facets["volume_mm3"])
    assert off <= true["volume_error_mm3"] + facets["volume_error_mm3"]
    assert "true: vertices within" in bohemia(*command[:-1], "--surface", "true").stdout
    refused = bohemia(*command, "--surface", "smooth")
    assert refused.code == 2
    assert "smooth" in refused.stderr
