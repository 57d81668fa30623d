"""Two pages and the lanes between them and their answers, for the test of what is shown at rest.

Nothing is computed beside the loop here: a lane only notes what is wanted, and the test decides
which answer comes when, be it no longer wanted, or whether it is lost. What is shown of a page is
read from its widgets and its scene, as a browser would have them.
"""

from __future__ import annotations

import queue
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import viser

from app.features.section import compute as sections
from app.features.section.part import SectionPart
from app.features.section.plot import Picture
from app.features.singularities.part import ControlPart
from app.features.solutions.compute import SOLUTIONS
from app.features.solutions.part import SolutionsPart
from app.features.trajectory.part import TrajectoryPart
from app.features.workspace import compute as workspace
from app.jobs.answers import Key
from app.jobs.lane import Done, Job, Lane, Lost
from app.loop import Page
from app.review.changes import Change
from app.review.state import Review
from app.server import make_server
from kinematics.answers.sections import Box, Section, SectionSpec, Sphere, Volume
from kinematics.errors import BohemiaError
from kinematics.facets.solids import SolidRequest, build_solid
from kinematics.machine import machine_of
from tests.app.made_sections import LENS, RING, TWO

# What a person chose in a widget and not in the review, and what is told of the way to it.
OF_THE_PERSON = {"Solid", "Format", "Resolution", "About the platform", "Change"}
OF_THE_WAY = "Changes"  # folders that list what was done
ROUNDS = 400


class Seated:
    """A page without a person: things happen to it, and it is looked at."""

    def __init__(self, server: viser.ViserServer, review: Review) -> None:
        self.server = server
        self.page = Page(server, review, "http://127.0.0.1:1", None)
        page: Any = self.page
        page._notify = lambda text, client: None
        self.page._publish()
        self.lost: dict[Any, str] = {}

    @property
    def review(self) -> Review:
        return self.page.review

    @property
    def lanes(self) -> list[Lane]:
        return [lane for part in self.page._parts for lane in part.lanes.values()]

    def turn(self) -> None:
        """One turn of the page's loop."""
        items: list[Any] = []
        while True:
            try:
                items.append(self.page._inbox.get_nowait())
            except queue.Empty:
                break
        self.page.hands.look()
        self.page._take(items)

    def send(self, change: Change) -> None:
        self.page.send(change)

    def call(self, act: Callable[..., object], *arguments: object) -> None:
        self.page.ask(act, *arguments)

    def deliver(self, lane: Lane, job: Job) -> None:
        """The answer to a job arrives, whoever wants it still."""
        try:
            lane._report(Done(job, answer(job)))
        except BohemiaError as error:
            lane._report(Lost(job, str(error)))
        _forget(lane, job)

    def lose(self, lane: Lane, job: Job, text: str) -> None:
        """A job is given up, or its process dies."""
        lane._report(Lost(job, text))
        _forget(lane, job)

    def settle(self) -> None:
        """Let everything come that is wanted, and the loop go on until nothing is left to do."""
        for _ in range(ROUNDS):
            for part in self.page._parts:
                if isinstance(getattr(part, "_from", None), float):
                    part._from = 0.0  # no pause for the eye
            self.turn()
            wanted = [(lane, job) for lane in self.lanes for job in _open(lane)]
            for lane, job in wanted[:1]:
                text = self._lost_before(job)
                if text is None:
                    self.deliver(lane, job)
                else:
                    self.lose(lane, job, text)
            busy = wanted or not self.page._inbox.empty() or any(p.late for p in self.page._parts)
            if not busy:
                return
        raise AssertionError("the page never comes to rest")

    def _lost_before(self, job: Job) -> str | None:
        key = job.key
        assert isinstance(key, Key)
        if key.question is SOLUTIONS:
            return self.lost.get(SOLUTIONS)
        return self.lost.get((key.question, key.request))

    # --- what a fresh page must be told to be the same

    def quiet(self) -> None:
        """What is of the way here and not of the review is taken back."""
        self.call(self.page.part(TrajectoryPart).playing.go_back)
        self.call(self.page.part(ControlPart).clear_log)
        explorer = self.page.part(SolutionsPart)._explorer
        if explorer.known is not None:  # nobody is new
            explorer.known = replace(explorer.known, appeared=frozenset(), merged=())
        self.call(self.page.part(SolutionsPart).redraw)
        self.settle()
        self.page._notes = ()
        self.page.put("redraw")
        self.settle()

    def asked_for(self, other: Seated) -> None:
        """Ask for what a person asked for on another page of the same review."""
        for part in other.page._parts:
            for (question, request), text in part.answers._lost.items():
                self.lost[SOLUTIONS if question is SOLUTIONS else (question, request)] = text
        mine: Any = self.page.part
        theirs: Any = other.page.part
        mine(SectionPart)._asked = dict(theirs(SectionPart)._asked)
        mine(SectionPart)._region = theirs(SectionPart)._region
        mine(ControlPart)._free = theirs(ControlPart)._free
        mine(TrajectoryPart)._given_up = theirs(TrajectoryPart)._given_up
        mine(TrajectoryPart)._asked = theirs(TrajectoryPart)._asked
        explorer = theirs(SolutionsPart)._explorer
        mine(SolutionsPart)._explorer._driven = explorer._driven
        mine(SolutionsPart)._explorer._chosen = explorer._chosen
        self.page.put("redraw")

    # --- looking

    def shown(self) -> dict[str, Any]:
        """All that can be seen, by its name."""
        return dict(_widgets(self.server)) | dict(_nodes(self.server))


def _open(lane: Lane) -> list[Job]:
    return [job for job in lane._jobs if job.key not in lane._answered]


def _forget(lane: Lane, job: Job) -> None:
    """As a lane does once a job is done."""
    if job.key in {each.key for each in lane._jobs}:
        lane._answered.add(job.key)


def _want(lane: Lane, jobs: Sequence[Job]) -> None:
    lane._jobs = tuple(jobs)
    lane._answered &= {job.key for job in jobs}


def _widgets(server: viser.ViserServer) -> Iterator[tuple[str, Any]]:
    root: Any = server.gui._container_handle_from_uuid["root"]
    names: dict[str, int] = {}
    tab = ""
    for handle in _seen(root):
        if isinstance(handle, viser.GuiTabGroupHandle):
            tab = "tabs"
        label = str(getattr(handle, "label", ""))
        if label in OF_THE_PERSON:
            continue
        name = f"{tab} {type(handle).__name__} {label}"
        names[name] = names.get(name, 0) + 1
        yield f"{name} {names[name]}", _worth(handle)


def _seen(container: Any) -> Iterator[Any]:
    """All that is visible, in order."""
    for child in list(container._children.values()):
        if not getattr(child, "visible", True):
            continue
        if str(getattr(child, "label", "")).startswith(OF_THE_WAY):
            continue
        yield child
        if isinstance(child, viser.GuiTabGroupHandle):
            for tab in child._tab_handles:
                yield from _seen(tab)
        elif hasattr(child, "_children"):
            yield from _seen(child)


def _worth(handle: Any) -> Any:
    if isinstance(handle, viser.GuiHtmlHandle):
        return _plain(handle.content)
    told = [getattr(handle, name, None) for name in ("value", "options", "disabled", "min", "max")]
    icon = getattr(handle, "_icon_html", None)
    if isinstance(handle, viser.GuiButtonHandle):
        told[0] = _plain(icon or "")
    return [round(v, 6) if isinstance(v, float) else v for v in told]


def _plain(content: str) -> str:
    """HTML without what tells the way to a set of solutions, and how long it took."""
    content = re.sub(r"#\d+", "#", content)
    content = re.sub(r'<div class="bo-bar">.*?</div>', "", content)  # what may be taken back
    content = re.sub(r'data-send="go \d+"|New \d+|, new(?=")', "", content)
    content = re.sub(r"<small[^>]*>new</small> ?", "", content)
    content = re.sub(r"<div[^>]*>[^<]*(appeared|merged) on the way:[^<]*</div>", "", content)
    content = re.sub(r"· [^·<]* in (\d|less)[^<·]*s\b", "", content)
    return content if re.search(r"<svg|<style|>[^<]", content) else ""


# Of handles that a hand drags only the place counts, and of the camera nothing.
_PROPS = (
    *("position", "wxyz", "scale", "vertices", "faces", "points", "colors", "color", "opacity"),
    *("text", "shaft_radius", "head_radius", "head_length", "axes_length", "point_size"),
    *("batched_wxyzs", "batched_positions", "batched_scales", "batched_colors"),
)


def _nodes(server: viser.ViserServer) -> Iterator[tuple[str, Any]]:
    nodes = server.scene._handle_from_node_name
    hidden = tuple(f"{name}/" for name, node in nodes.items() if not node.visible)
    for name, node in nodes.items():
        if not node.visible or name.startswith(hidden):
            continue
        props = {prop: getattr(node, prop, None) for prop in _PROPS}
        if props["text"] is not None:
            props["text"] = _plain(props["text"])
        if props["batched_scales"] is not None:
            props |= _copies(props)
        yield name, {prop: np.asarray(value) for prop, value in props.items() if value is not None}


def _copies(props: dict[str, Any]) -> dict[str, Any]:
    """Those copies that have a size, in an order of their own."""
    names = [prop for prop in _PROPS if prop.startswith("batched")]
    seen = (np.asarray(props["batched_scales"]) > 0).any(axis=1)
    rows = np.concatenate([np.asarray(props[n], dtype=float)[seen] for n in names], axis=1)
    return dict.fromkeys(names) | {"copies": rows[np.lexsort(rows.T)]}


def differences(one: dict[str, Any], two: dict[str, Any]) -> list[str]:
    """In what two pages differ, in words."""
    found = [f"only one page has {name}" for name in sorted(one.keys() ^ two.keys())]
    return found + [
        f"{name}: {str(one[name])[:600]} ≠ {str(two[name])[:600]}"
        for name in one.keys() & two.keys()
        if not _same(one[name], two[name])
    ]


def _same(one: Any, two: Any) -> bool:
    if isinstance(one, dict):
        return one.keys() == two.keys() and all(_same(one[k], two[k]) for k in one)
    if isinstance(one, np.ndarray):
        if one.shape != two.shape:
            return False
        if one.dtype.kind not in "fiu":
            return bool((one == two).all())
        return bool(np.allclose(one, two, rtol=1e-6, atol=1e-5, equal_nan=True))
    return bool(one == two)


# --- answers ----------------------------------------------------------------------------------

_answers: dict[Any, Any] = {}


def answer(job: Job) -> Any:
    """What a job's function returns; what takes long is made up, always the same for a request."""
    key = job.key
    assert isinstance(key, Key)
    known = key.question, key.request
    if known not in _answers:
        function = MADE.get(job.function, job.function)
        _answers[known] = function(*job.arguments)
    return _answers[known]


def _number(of: object) -> float:
    """A number from 0 to 1 that belongs to a request."""
    return (hash(of) % 1009) / 1009.0


def made_volume(of: sections.Region) -> Volume:
    value = 1e7 * (1.0 + _number(of))
    at = np.linspace(-100.0, 100.0 + 50.0 * _number(of), 21)
    return Volume(
        value, 5.0, np.zeros(3), (value,), at, np.full(21, 3e4), np.array([at[0], at[-1]]), 21
    )


def made_section(wish: sections.Wish) -> sections.Drawn:
    section: Section = (RING, LENS, TWO)[hash(wish.region) % 3]
    lines, limbs = sections.edges(section)
    raised = np.concatenate([np.full((*lines.shape[:-1], 1), wish.at), lines], axis=-1)
    across = sections.section_bounds(section)
    return sections.Drawn(
        wish,
        replace(section, at=wish.at),
        sections.Extent((-100.0, 100.0 * (1.0 + _number(wish.region))), across),
        raised,
        limbs,
        np.concatenate([raised[:4], raised[:4, :1] + 1.0], axis=1),
        raised[:0],
        Picture(section, _spec(wish), mark=wish.mark, bounds=across),
    )


def _spec(wish: sections.Wish) -> SectionSpec:
    spec = machine_of(wish.region.design).section_spec
    assert spec is not None
    return spec


def made_ball(of: sections.Region, center: object) -> tuple[Sphere, ...]:
    return (Sphere(np.full(3, 100.0 * _number(of)), 20.0 + 10.0 * _number((of, center)), 1e-3),)


def made_box(of: sections.Region, center: object) -> tuple[Box, ...]:
    low = np.full(3, -50.0 * _number((of, center)))
    return (Box(low, low + 40.0, 64000.0),)


@cache
def _coarse(request: SolidRequest) -> Any:
    return build_solid(replace(request, resolution="preview"))


MADE: dict[Any, Callable[..., Any]] = {
    sections.measure: made_volume,
    sections.draw: made_section,
    sections.sphere: made_ball,
    sections.box: made_box,
    workspace.build: _coarse,
}


@contextmanager
def servers(count: int) -> Iterator[list[viser.ViserServer]]:
    """Servers that nobody connects to, whose pages have lanes as above."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Lane, "want", _want)
        patch.setattr(SectionPart, "_make_ready", lambda self, *_: None)
        made = [make_server("127.0.0.1", 0) for _ in range(count)]
        try:
            yield made
        finally:
            for server in made:
                server.stop()
