"""While a hand moves: the machine first, the newest solid, and nothing left behind."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from app.features.move.state import Move
from app.features.workspace.compute import SOLIDS
from app.features.workspace.part import SolidsPart
from app.jobs.answers import Key
from app.jobs.lane import Busy, Done, Lost
from app.loop import Page
from app.review.state import Review, new_review
from app.server import make_server
from kinematics.designs.files import load_design
from tests.app import seats

PATIENCE = 120.0  # s; only a hang is caught by it
EVENTS = 1000
TOGETHER = 4  # events that the loop finds in its inbox at once


class Watched(Page):
    """A page that notes what its lanes reported."""

    reports: list[Busy | Done | Lost]

    def put(self, item: object) -> None:
        if isinstance(item, Busy | Done | Lost):
            self.reports.append(item)
        super().put(item)

    def built(self, resolution: Any, since: int = 0) -> list[Any]:
        """What solids at a resolution were built of, after so many reports."""
        return [
            report.job.key.request.arguments
            for report in self.reports[since:]
            if isinstance(report, Done)
            and isinstance(report.job.key, Key)
            and report.job.key.question is SOLIDS[resolution]
        ]

    def turn(self) -> None:
        """Wait until the loop has taken all that it was sent."""
        taken = threading.Event()
        self.ask(taken.set)
        assert taken.wait(PATIENCE)

    def settle(self) -> None:
        """Wait until nothing is at work."""
        end = time.monotonic() + PATIENCE
        while not all(lane.idle for part in self._parts for lane in part.lanes.values()):
            assert time.monotonic() < end, "lanes are still at work"
            time.sleep(0.02)
        self.turn()


@contextmanager
def running(review: Review) -> Iterator[Watched]:
    """A page at work, with its lanes and their processes."""
    Watched.reports = []
    server = make_server("127.0.0.1", 0)
    page = Watched(server, review, "test", None)
    thread = threading.Thread(target=page.run)
    thread.start()
    try:
        yield page
    finally:
        page.stop()
        thread.join()
        server.stop()


@pytest.mark.slow
def test_a_drag_leaves_no_work_behind() -> None:
    review = new_review(load_design("rpur-table1"))
    with running(review) as page:
        page.settle()
        buffer = page.server._websock_server._broadcast_buffer
        begun, kept, angle = len(page.reports), 0, 0.0
        for n in range(EVENTS):
            angle = review.pose[3] + 0.3 * (n + 1) / EVENTS
            page.send(Move(3, angle))
            if n % TOGETHER == TOGETHER - 1:
                page.turn()
            if n == EVENTS // 5:
                kept = len(buffer.message_from_id)
        last = len(page.reports)
        page.settle()
        part = page.part(SolidsPart)
        (wish,) = part._wishes
        assert page.review.pose[3] == angle
        # One that was at work when the last event came may end; then only the newest is built.
        for resolution, most in (("preview", 2), ("normal", 1), ("fine", 1)):
            after = page.built(resolution, last)
            assert after[-1:] in ([], [wish.requests["preview"].arguments])
            assert len(after) <= most
        assert page.built("fine")[-1] == wish.requests["fine"].arguments
        assert part._built()["workspace"].resolution == "fine"
        # A turn asks for one solid at most, and no solid is built twice.
        previews = page.built("preview", begun)
        assert len(previews) == len(set(previews)) <= EVENTS // TOGETHER
        assert page._inbox.empty()
        # Nothing grows by the turn: messages for browsers that come later, answers, steps of undo.
        assert len(buffer.message_from_id) <= kept + EVENTS // TOGETHER // 2
        for each in page._parts:
            for question, answers in each.answers._kept.items():
                assert len(answers) <= question.kept + 3
        assert len(page._history.past) == 1


def test_a_burst_is_one_move(monkeypatch: pytest.MonkeyPatch) -> None:
    with seats.seat() as seat:
        drawn: list[float] = []
        publish = Page._publish
        monkeypatch.setattr(
            Page, "_publish", lambda page: (publish(page), drawn.append(page.review.pose[3]))
        )
        for n in range(EVENTS):
            seat.page.send(Move(3, 1e-4 * n))
        seat.settle()
        assert drawn == [1e-4 * (EVENTS - 1)]


def test_the_machine_is_sent_before_the_panels_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    with seats.seat() as seat:
        page, happened = seat.page, []
        show, flush = page.show_machine, seat.server.flush
        monkeypatch.setattr(page, "show_machine", lambda: (show(), happened.append("machine")))
        monkeypatch.setattr(seat.server, "flush", lambda: (flush(), happened.append("flush")))
        for panel in page._panels:
            draw = panel.draw
            monkeypatch.setattr(
                panel, "draw", lambda sheet, draw=draw: (draw(sheet), happened.append("panel"))
            )
        seat.do(Move(3, 0.1))
        assert happened[: happened.index("panel")] == ["machine", "flush"]


def test_what_comes_goes_before_what_is_late_and_all_is_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with seats.seat() as seat:
        page, drawn = seat.page, []
        for part in page._parts:
            show = part.show
            monkeypatch.setattr(
                part, "show", lambda sheet, part=part, show=show: (drawn.append(part), show(sheet))
            )
        page.apply(Move(3, 0.1), None)
        page._publish()
        solids = page.part(SolidsPart)
        page.put("redraw")  # something waits all the time
        page._catch_up([solids])
        assert drawn[0] is solids
        assert len(drawn) == 2
        late = [part for part in page._parts if part.late]
        for _ in late:
            page._catch_up([])
        assert not any(part.late for part in late if part.due == 0.0)
        assert len(drawn) == len(set(drawn))
