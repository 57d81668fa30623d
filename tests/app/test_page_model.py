"""Whatever happens on the way: at rest a page shows what a fresh page of the same review shows.

Random changes, undo and redo, questions of a person, answers that come late, out of order or never,
and processes that die. BOHEMIA_MODEL=300 tries so many ways a machine.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.features.design.state import EditDesign, UseDesign
from app.features.marks.model import Anchor, Dimension, Note, SavedView, looks_of
from app.features.marks.state import AddMark, DropMark, NameMark, Recall, SetMarks
from app.features.move.state import Drive, Flip, GiveWay, GoHome, Move
from app.features.section.part import SectionPart
from app.features.section.state import MoveCut, SetCut
from app.features.singularities.part import ControlPart
from app.features.singularities.state import SetControl
from app.features.solutions.part import SolutionsPart
from app.features.solutions.state import SetAtlas
from app.features.trajectory.part import TrajectoryPart
from app.features.trajectory.state import SetPlan
from app.features.workspace.state import ChooseModes, Fade, SetFlat, Show
from app.review.changes import Change, SetOption
from app.review.state import Review, new_review
from app.review.view import view
from app.scene.camera import Camera
from kinematics.designs.files import load_design
from tests.app.models import Seated, _open, differences, servers
from tests.conftest import rarely

MACHINES = ("five-bar", "rpur-table1", *map(rarely, ("rps-3", "sps-spr", "rpur-a3a3")))
OTHERS = {"five-bar": "rps-3", "rps-3": "spr-3", "spr-3": "rps-3", "sps-spr": "five-bar"}
TRIES = int(os.environ.get("BOHEMIA_MODEL", "4"))
DIED = "The process at work on it stopped; change something, and it is tried again."

_design = cache(load_design)


@cache
def _start(name: str) -> Review:
    return new_review(_design(name))


@cache
def changes(name: str) -> tuple[Change, ...]:
    """Some of each kind, few enough that the same reviews come again and again."""
    review = _start(name)
    machine, home = review.machine, review.pose
    turns = [n for n, c in enumerate(machine.coordinates) if c.unit == "rad"]
    made: list[Change] = [
        Move(0, home[0] * 0.98),
        Move(0, home[0]),
        *(Move(n, home[n] + by) for n in turns[:2] for by in (0.0, 0.15)),
        Drive(0, review.posture.joints[0] * 1.01),
        *(Flip(mode) for mode in (machine.modes[0], review.mode)),
        GoHome(),
        GiveWay(machine.coordinates[machine.dependent[-1]].key if machine.dependent else ""),
        UseDesign(review.design),
        UseDesign(_design(OTHERS.get(name, "rpur-table2"))),
        SetOption("dark", True),
        SetOption("labels", True),
        SetAtlas("ghosts", True),
        SetAtlas("sort", "height"),
        SetAtlas("modes", "same"),
        ChooseModes("current"),
        ChooseModes("all"),
        Fade(("workspace",), 0.6),
        SetControl("wrenches", True),
        SetControl("clearances", True),
        SetControl("forces", True),
        SetControl("rates", tuple(1.0 for _ in home)),
        SetControl("compare", True),
        SetControl("shade", machine.measures.specs[0].key),
        SetControl("shade", ""),
        *(SetControl("chart", spec.key) for spec in machine.singularities.loci[-1:]),
        SetPlan((("on", True), ("way", "straight"), ("samples", 5), ("end", _near(review)))),
        SetPlan((("on", True), ("duration", 3.0), ("degree", 3))),
        SetPlan((("on", False),)),
        SetCut("on", True),
        SetCut("on", False),
        *_marks(review),
        MoveCut(12.5),
        MoveCut(-40.0),
    ]
    made += [EditDesign(((field.path, 1.02 * field.value),)) for field in machine.fields[1:2]]
    solids = [spec.key for spec in machine.solid_specs if spec.limb in (None, 1)][:3]
    made += [Show(key, on) for key in solids for on in (True, False)]
    made += [SetFlat("key", spec.key) for spec in machine.region_specs]
    return tuple(made)


def _marks(review: Review) -> tuple[Change, ...]:
    """Of each kind one, the newest removed, and a view recalled."""
    camera = Camera((900.0, 0.0, 900.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.5)
    joint = Anchor("point", view(review).drawing.points[0].name)
    seen = SavedView("v", camera, looks_of(review), review.pose, review.mode)
    return (
        AddMark("notes", Note("n", review.pose, review.mode, joint)),
        AddMark("dimensions", Dimension("", (joint, Anchor("plane", "platform")))),
        AddMark("views", seen),
        DropMark("dimensions", 0),
        NameMark("notes", 0, "m"),
        SetMarks("shown", False),
        SetMarks("shown", True),
        Recall(seen),
    )


def _near(review: Review) -> tuple[float, ...]:
    return tuple(
        v + (5.0 if c.unit == "mm" else 0.03)
        for c, v in zip(review.machine.coordinates, review.pose, strict=True)
    )


def _ask(page: Seated, n: int) -> None:
    """Something that a person asks for."""
    section, control = page.page.part(SectionPart), page.page.part(ControlPart)
    playing = page.page.part(TrajectoryPart).playing
    requests: tuple[tuple[Any, ...], ...] = (
        (section.inscribe, "ball", True),
        (section.inscribe, "box", False),
        (section.forget_inscribed,),
        (section.go_to_ball, None),
        (control.find_free, False),
        (control.forget_free,),
        (control.escape, None),
        (page.page.part(SolutionsPart).find_again,),
        (playing.scrub, 0.4),
        (playing.go_back,),
        (page.page.part(TrajectoryPart).measure, False),
    )
    act, *arguments = requests[n % len(requests)]
    page.call(act, *arguments)


class Way:
    """What happens to a page until it comes to rest."""

    def __init__(self, page: Seated, menu: tuple[Change, ...]) -> None:
        self.page = page
        self.menu = menu
        self.outstanding: list[tuple[Any, Any]] = []  # whatever was wanted and did not come

    def step(self, kind: str, n: int) -> None:
        page = self.page
        steps: dict[str, Callable[[], None]] = {
            "change": lambda: page.send(self.menu[n % len(self.menu)]),
            "undo": page.page.undo,
            "redo": page.page.redo,
            "ask": lambda: _ask(page, n),
            "answer": lambda: self._come(n, None),
            "lose": lambda: self._come(n, (DIED, "")[n % 2]),
            "turn": page.turn,
        }
        steps[kind]()
        known = {job.key for _, job in self.outstanding}
        for lane in page.lanes:
            self.outstanding += [(lane, j) for j in _open(lane) if j.key not in known]

    def _come(self, n: int, text: str | None) -> None:
        if not self.outstanding:
            return
        lane, job = self.outstanding.pop(n % len(self.outstanding))
        if text is None:
            self.page.deliver(lane, job)
        else:
            self.page.lose(lane, job, text)


STEPS = st.tuples(
    st.sampled_from(
        ["change"] * 5 + ["turn"] * 4 + ["answer"] * 6 + ["undo"] * 2 + ["redo", "ask", "lose"]
    ),
    st.integers(0, 10_000),
)


@pytest.mark.parametrize("name", MACHINES)
@settings(
    max_examples=TRIES,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(steps=st.lists(STEPS, min_size=4, max_size=40))
def test_at_rest_a_page_shows_what_a_fresh_one_shows(
    name: str, steps: list[tuple[str, int]]
) -> None:
    _at_rest(name, steps)


def _at_rest(name: str, steps: list[tuple[str, int]]) -> None:
    with servers(2) as (first, second):
        page = Seated(first, _start(name))
        way = Way(page, changes(name))
        for kind, n in steps:
            way.step(kind, n)
        page.settle()
        page.quiet()
        fresh = Seated(second, page.review)
        fresh.asked_for(page)
        fresh.settle()
        fresh.quiet()
        assert fresh.review == page.review
        found = differences(page.shown(), fresh.shown())
        assert not found, "\n".join(found)
