"""A page with a person before it, without browser and processes.

The page, its panels and its scene are the true ones, on a true server that nobody connects to.
What lanes would compute in their processes is computed at once, where a test asks for the lane.
"""

from __future__ import annotations

import asyncio
import html
import queue
import re
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser
import viser.transforms as tf

from app.features.review.files import ExportedFile
from app.features.section.part import SectionPart
from app.jobs.lane import Done, Job, Lane, Lost
from app.loop import Page
from app.review.changes import Change
from app.review.state import Review, new_review
from app.scene.camera import FIELD_OF_VIEW, ISOMETRIC, axes_of, frame
from app.scene.pointer import Pointer, on_screen
from app.server import make_server
from app.widgets.desk import safely
from kinematics.arrays import Array
from kinematics.designs.files import load_design
from kinematics.errors import BohemiaError

INLINE = ("control", "loci", "regions")  # lanes; others do nothing
ROUNDS = 50  # of the loop; only a change that goes round in circles is caught by it


class Seat:
    """Somebody who uses the page, and what they were told."""

    def __init__(self, server: viser.ViserServer, review: Review) -> None:
        self.told: list[str] = []
        self.files: list[ExportedFile] = []
        self.server = server
        self.page = Page(server, review, "http://127.0.0.1:1", None)
        page: Any = self.page
        page.complain = self._complained
        page.download = lambda file, client: self.files.append(file)
        page.apart = lambda client, act: safely(page, client, act, "The file could not be made")
        self.browser: Any = SimpleNamespace(client_id=1)  # in which widgets are used
        self.page._publish()
        self.settle()

    def _complained(self, text: str, client: object = None) -> None:
        self.told.append(text)
        self.page.put("redraw")

    # --- doing

    def settle(self) -> None:
        """Let the loop go on until nothing is left to do."""
        for _ in range(ROUNDS):
            items: list[Any] = []
            if self.page.hands.owed:  # a widget that was touched a moment ago
                time.sleep(0.006)
                items.append("redraw")
            while True:
                try:
                    items.append(self.page._inbox.get_nowait())
                except queue.Empty:
                    break
            self.page.hands.look()
            self.page._take(items)
            if not items:
                return
        raise AssertionError("the page never comes to rest")

    def do(self, *changes: Change) -> Review:
        """Send changes; the review then."""
        for change in changes:
            self.page.send(change)
            self.settle()
        return self.review

    def ask(self, act: Callable[..., object], *arguments: Any) -> None:
        """Have the loop call a method of a part."""
        self.page.ask(act, *arguments)
        self.settle()

    def open(self, name: str) -> Review:
        """Choose a preset, as in the Design tab."""
        self.put("Design", name)
        assert self.review.design.name == name
        return self.review

    def put(self, label: str, value: Any) -> None:
        """Give a widget another value, as a browser would."""
        if label not in self.labels():
            self._put_html(label, value)
            return
        handle = self.widget(label)
        value = str(value) if isinstance(value, str) else value  # a browser sends plain text
        assert type(value) is type(handle.value), (label, handle.value)
        handle._impl.value = value
        self._tell(handle)

    def press(self, label: str, option: str | None = None) -> None:
        """Press a button, or one of a group."""
        if option is None and label not in self.labels():
            self._press_html(label)
            return
        handle = self.widget(label, option)
        assert handle.visible, label
        if option is not None:
            handle._impl.value = option
        self._tell(handle)

    def paste(self, label: str, text: str) -> None:
        """Type all numbers of a row into one of its boxes."""
        self._press(self._in_html("input", f'{label}: [^"]*', "data-line"), f" {text}")

    def write(self, label: str, text: str) -> None:
        """Type a text into a box that is a piece of HTML."""
        self._press(self._in_html("(?:input|textarea)", re.escape(label), "data-write"), f" {text}")

    def _put_html(self, label: str, value: float) -> None:
        """Type a number into a box that is a piece of HTML."""
        edited = self._in_html("input", f'[^"]*{re.escape(label)}', "data-edit")
        self._press(edited, f" {value!r}")

    def _press_html(self, label: str) -> None:
        """Press a button that is a piece of HTML."""
        self._press(self._in_html("button", re.escape(label), "data-send"))

    def _in_html(self, tag: str, label: str, sends: str) -> tuple[int, str]:
        """Which handle has an element with a label that matches, and what it sends."""
        for n, handle in enumerate(self._handles()):
            for element in re.findall(rf"<{tag}[^>]*>", _html(handle)):
                if re.search(rf'aria-label="{label}"', element):
                    assert " disabled" not in element, label
                    sent = re.search(rf'{sends}="([^"]*)"', element)
                    assert sent is not None, label
                    return n, html.unescape(sent[1])
        raise AssertionError(f"no {tag} {label!r}")

    def _press(self, sent: tuple[int, str], more: str = "") -> None:
        """Have the hidden box behind a piece of HTML tell what a browser would."""
        n, text = sent
        box = next(h for h in self._handles()[n:] if getattr(h, "label", "") == "Pressed")
        box._impl.value = f"{text}{more} {time.monotonic()}"
        self._tell(box)

    def point(self, title: str, x: float, y: float) -> None:
        """Point at a place of the plot with this name, of several the first."""
        handles = self._handles()
        plot = next(n for n, h in enumerate(handles) if f'aria-label="{title}' in _html(h))
        box = next(h for h in handles[plot:] if getattr(h, "label", "") == "Pointed at")
        box._impl.value = f"{x!r} {y!r} {len(self.told)}"
        self._tell(box)

    def click(self, client: Any, at: Array) -> None:
        """Move a browser's pointer to where a point (3,) mm is in its picture, and click there."""
        x, y = on_screen(client.camera, np.asarray(at, dtype=float)[None])[0][0].tolist()
        for pressed in (False, True):
            self.page.point(Pointer(client, 6, (round(x), round(y)), pressed))
            self.settle()

    def drag(self, node: str, position: Sequence[float], phase: str = "update") -> None:
        """Take hold of a handle in the scene."""
        handle: Any = self.node(node)
        handle._impl.position = np.array(position, dtype=float)
        for callback in handle._impl_aux.update_cb:
            asyncio.run(callback(SimpleNamespace(target=handle, client_id=1, phase=phase)))
        self.settle()

    def _tell(self, handle: Any) -> None:
        event = SimpleNamespace(client=self.browser, client_id=1, target=handle)
        for callback in list(handle._impl.update_cb):
            asyncio.run(callback(event))
        self.settle()

    # --- seeing

    @property
    def review(self) -> Review:
        return self.page._history.present

    @property
    def tabs(self) -> list[str]:
        """The titles of the tabs, and of the views of those that have several."""
        groups = [h for h in self._handles() if isinstance(h, viser.GuiTabGroupHandle)]
        return [str(label) for group in groups for label in group._tab_labels]

    def text(self) -> str:
        """All the visible HTML of the panels, without its tags."""
        pieces = [_html(h) for h in self._handles() if getattr(h, "visible", False)]
        bare = re.sub(r"<style>.*?</style>|<[^>]*>", " ", " ".join(pieces), flags=re.DOTALL)
        return re.sub(r"\s+", " ", html.unescape(bare))

    def html(self) -> list[str]:
        """The HTML of the panels, piece by piece."""
        return [_html(h) for h in self._handles() if _html(h)]

    def widget(self, label: str, option: str | None = None) -> Any:
        """The input with this label, of several the first that is visible."""
        found = [
            h
            for h in self._handles()
            if getattr(h, "label", None) == label
            and not hasattr(h, "_children")
            and (option is None or option in getattr(h, "options", ()))
        ]
        assert found, (label, sorted({str(getattr(h, "label", "")) for h in self._handles()}))
        return next((h for h in found if h.visible), found[0])

    def labels(self) -> set[str]:
        """The labels of all inputs."""
        return {str(getattr(h, "label", "")) for h in self._handles()}

    def node(self, name: str) -> Any:
        """The scene node of this name."""
        return self.server.scene._handle_from_node_name[name]

    def seen(self, prefix: str) -> list[str]:
        """The nodes whose names begin so and that are to be seen: they and all above them."""
        nodes = self.server.scene._handle_from_node_name
        hidden = tuple(f"{name}/" for name, node in nodes.items() if not node.visible)
        return sorted(
            name
            for name, node in nodes.items()
            if name.startswith(prefix) and node.visible and not name.startswith(hidden)
        )

    def _handles(self) -> list[Any]:
        """All widgets, folders and tab groups, in the order in which they were made."""
        return list(_below(self.server.gui._container_handle_from_uuid["root"]))


class Browser:
    """Somebody's browser with a picture of 800 × 600 px of points (N, 3), from a direction (3,)."""

    def __init__(
        self, points: Array, toward: Array = ISOMETRIC, fov: float = FIELD_OF_VIEW
    ) -> None:
        self.client_id = 7
        self.scripts: list[str] = []
        position, target = frame(points, toward, fov, 800 / 600)
        right, up, back = axes_of(toward)
        turn = tf.SO3.from_matrix(np.stack([right, -up, -back], axis=1))
        self.camera = SimpleNamespace(
            position=position,
            look_at=target,
            up_direction=np.array([0.0, 0.0, 1.0]),
            wxyz=turn.wxyz,
            fov=fov,
            aspect=800 / 600,
            far=1e5,
            image_width=800,
            image_height=600,
        )
        self._websock_connection = SimpleNamespace(
            queue_message=lambda message: self.scripts.append(message.source)
        )

    def atomic(self) -> AbstractContextManager[None]:
        return nullcontext()


def _below(container: Any) -> Iterator[Any]:
    for child in list(container._children.values()):
        yield child
        if isinstance(child, viser.GuiTabGroupHandle):
            for tab in child._tab_handles:
                yield from _below(tab)
        elif hasattr(child, "_children"):
            yield from _below(child)


@lru_cache(maxsize=256)  # tests begin at the same places again and again
def _called(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)


def _computed(job: Job) -> Any:
    try:
        return _called(job.function, *job.arguments)
    except TypeError:  # arrays
        return job.function(*job.arguments)


def _html(handle: Any) -> str:
    return handle.content if isinstance(handle, viser.GuiHtmlHandle) else ""


@contextmanager
def seat(name: str = "rpur-table1") -> Iterator[Seat]:
    """A page on this design for as long as this lasts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Lane, "want", _want)
        patch.setattr(SectionPart, "_make_ready", lambda self, *_: None)
        server = make_server("127.0.0.1", 0)
        try:
            yield Seat(server, new_review(load_design(name)))
        finally:
            server.stop()


def _want(lane: Lane, jobs: Sequence[Job]) -> None:
    """Do these at once, each once while it is wanted."""
    known: dict[Any, Any] = lane.__dict__.setdefault("known", {})
    wanted = {job.key for job in jobs}
    for key in [key for key in known if key not in wanted]:
        del known[key]
    for job in jobs if lane.name in INLINE else ():
        if job.key in known:
            continue
        known[job.key] = True
        try:
            lane._report(Done(job, _computed(job)))
        except BohemiaError as error:
            lane._report(Lost(job, str(error)))
