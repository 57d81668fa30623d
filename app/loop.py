"""The one loop of a review: takes what people did, newest first, and brings the page to it.

Widgets and lanes only put things into the inbox; this thread alone changes the state, the scene
and the panels, so nothing here needs a lock.
"""

from __future__ import annotations

import contextlib
import logging
import queue
import sys
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ParamSpec, TypeVar, cast

import viser
import viser._messages

from app.features import each
from app.features.review.files import ExportedFile
from app.jobs.lane import Busy, Done, Lost
from app.jobs.parts import Part
from app.language import tr
from app.review import view as compute
from app.review.changes import Change
from app.review.history import History
from app.review.keeping import Keeper
from app.review.state import Options, Review
from app.scene.camera import Aims, Camera, Look, look, turn_to
from app.scene.machine import Scene
from app.scene.pointer import Pointer
from app.widgets.desk import Client, Command, Desk, Group, Hands, Panel, Sheet, safely
from app.widgets.header import Header
from kinematics.errors import InputError

log = logging.getLogger(__name__)

TICK = 0.25  # s between looks at the clock while nothing happens
HAND_OVER = 0.004  # s to wait at most for what was set to be taken for sending
MOMENT = 0.03  # s, the same while something waits to be brought up to date
PANEL_WIDTH = 416  # px; with its edge 420

A = ParamSpec("A")
P = TypeVar("P")


@dataclass(frozen=True, slots=True)
class _Asked:
    """A change, and who asked for it."""

    change: Change
    client: viser.ClientHandle | None


class Page:
    """A review on a viser server; every method but `run` only puts something into the inbox.

    It is the `Desk` of its panels and the `Stage` of its parts.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        review: Review,
        address: str,
        keeper: Keeper | None,
        aside: str = "",
    ) -> None:
        self.server = server
        self.gui = server.gui
        self.address, self.aside = address, aside
        self.keeper = keeper
        self.hands = Hands()
        self.scene = Scene(server)

        self._history = History(review)
        self._inbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._view = compute.view(review)
        self._notes: tuple[str, ...] = ()
        self._busy: dict[str, Busy] = {}
        self._header: Header | None = None
        self._panels: list[Group] = []  # the header first
        self._kind = ""
        self._framed: object = None
        self._aims: Aims = {}
        self._dark: bool | None = None
        self._stopping = threading.Event()
        self._parts = [kind(self) for kind in each("part", Part)]
        self._next = 0  # of them, whose turn it is to be drawn

    # --- what panels ask for (Desk)

    def send(self, change: Change, client: viser.ClientHandle | None = None) -> None:
        self._inbox.put(_Asked(change, client))

    def ask(self, act: Callable[A, object], *arguments: A.args, **options: A.kwargs) -> None:
        self._inbox.put(partial(act, *arguments, **options))

    def undo(self, looks: bool = False, times: int = 1) -> None:
        self._inbox.put(lambda: self._undo(looks, times))

    def redo(self, looks: bool = False) -> None:
        self._inbox.put(lambda: self._redo(looks))

    def look(self, name: Look, client: viser.ClientHandle | None = None) -> None:
        self._inbox.put(lambda: self._look(name, client))

    def fit_view(self) -> None:
        self.look("fit")

    def point(self, pointer: Pointer) -> None:
        for part in self._parts:
            self._inbox.put(partial(part.pointed, pointer))

    def cancel(self) -> None:
        busy = self._longest_work()
        for part in self._parts:
            if busy is not None and busy.lane in part.lanes:
                part.cancel(busy.lane)

    def complain(self, text: str, client: viser.ClientHandle | None = None) -> None:
        """Tell the person who asked, or everybody, what is wrong."""
        self._notify(text, client)
        self._inbox.put("redraw")  # widgets go back to what is true

    def _clients(self, client: viser.ClientHandle | None) -> list[viser.ClientHandle]:
        return [*self.server.get_clients().values()] if client is None else [client]

    def _notify(self, text: str, client: viser.ClientHandle | None) -> None:
        for each_one in self._clients(client):
            each_one.add_notification("Bohemia", text, color="red", auto_close_seconds=12.0)

    def download(self, file: ExportedFile, client: viser.ClientHandle | None) -> None:
        for each_one in self._clients(client):
            each_one.send_file_download(file.name, file.data, save_immediately=True)

    # --- what parts ask for (Stage)

    def run_script(self, source: str, client: viser.ClientHandle) -> None:
        connection = client._websock_connection
        connection.queue_message(viser._messages.RunJavascriptMessage(source=source))

    def turn(self, camera: Camera, client: viser.ClientHandle) -> None:
        self._aims.pop(client.client_id, None)  # it stays, whatever shape its picture takes
        turn_to(client, camera)

    @property
    def view(self) -> compute.View:
        return self._view

    @property
    def review(self) -> Review:
        return self._history.present

    def part(self, kind: type[P]) -> P:
        return next(part for part in self._parts if isinstance(part, kind))

    def put(self, item: object) -> None:
        self._inbox.put(item)

    def tell(self, news: object, view: compute.View | None = None) -> None:
        sheet = self.sheet() if view is None else replace(self.sheet(), view=view)
        for panel in self._panels:
            panel.told(sheet, news)

    def note(self, text: str) -> None:
        """Whoever opens the page later reads it, too."""
        self._notes = (text,)

    def apart(self, client: viser.ClientHandle | None, act: Callable[[], None]) -> None:
        """Do something that takes a while in a thread of its own; its failure is told."""

        def work() -> None:
            safely(self, client, act, tr("page.no_file"))

        threading.Thread(target=work, daemon=True).start()

    def shown(self) -> compute.View:
        """The view with the machine where it is to be seen now."""
        view = self._view
        for part in self._parts:
            view = part.shown(view)
        return view

    def show_machine(self) -> None:
        """Bring the machine in the scene to where it is to be seen now."""
        self.scene.show(self.shown(), dragging=self.scene.held)

    # --- the loop

    def run(self) -> None:
        """Serve the review until `stop`."""
        # Who comes has a picture of another shape, and may have missed what was fitted since.
        self.server.on_client_connect(self._came)
        self.server.on_client_disconnect(self._gone)
        # Threads hand over to each other within a frame: the lanes must not wait for a drawing.
        sys.setswitchinterval(0.0005)
        for part in self._parts:
            part.start()
        self._publish()
        while not self._stopping.is_set():
            items = ["redraw"] if self.hands.owed else []
            with contextlib.suppress(queue.Empty):
                items.append(self._inbox.get(timeout=self._patience(bool(items))))
            self.hands.look()
            while True:
                try:
                    items.append(self._inbox.get_nowait())
                except queue.Empty:
                    break
            self._turn(items)
        for part in self._parts:
            part.stop()

    def _came(self, who: viser.ClientHandle) -> None:
        """A browser has come; its picture takes its shape only when the panels are there."""
        self._inbox.put(partial(self._look, None, who))
        for part in self._parts:
            self._inbox.put(partial(part.joined, who))

        async def changed(camera: viser.CameraHandle) -> None:
            aim = self._aims.get(who.client_id)
            if aim is not None and not aim.reported and aim.confirmed(camera):
                self._aims[who.client_id] = replace(aim, reported=True)
            if self._outgrown(who):
                self._inbox.put(partial(self._refit, who))

        who.camera.on_update(changed)

    def _refit(self, who: viser.ClientHandle) -> None:
        if self._outgrown(who):
            self._look("fit", who)

    def _outgrown(self, who: viser.ClientHandle) -> bool:
        """Whether its picture is not of the shape any more for which it was made to look."""
        aim = self._aims.get(who.client_id)
        return aim is not None and aim.outgrown(who.camera)

    def _gone(self, _: viser.ClientHandle) -> None:
        for part in self._parts:
            self._inbox.put(part.left)

    def stop(self) -> None:
        """End `run`; the session is saved on the way out."""
        self._stopping.set()
        self._inbox.put("redraw")

    def _turn(self, items: Sequence[Any]) -> None:
        """Take what came; a change that fails, be it in drawing, is not kept."""
        before = self._history
        try:
            self._take(items)
        except Exception:
            self._history = before
            log.exception("the page's loop failed on %s", items)
            self._notify("Something went wrong in the page itself; the last change was lost.", None)
            if any(item != "redraw" for item in items):  # else it would fail for ever
                self._inbox.put("redraw")

    def _patience(self, owing: bool) -> float:
        """How long to wait for the next input, s."""
        due = [part.due for part in self._parts]
        soonest = min((s for s in due if s is not None), default=TICK)
        return min(max(soonest, 0.002), MOMENT if owing else TICK)

    def _take(self, items: Sequence[Any]) -> None:
        redraw = False
        for n, item in enumerate(items):
            match item:
                case _Asked(change, client):
                    if not _superseded(item, items[n + 1 :]):
                        redraw |= self.apply(change, client)
                case "redraw":
                    redraw = True
                case Busy(lane):
                    self._busy[lane] = item
                case Done() | Lost():
                    for part in self._parts:
                        redraw |= part.take(item)
                case _:
                    redraw |= bool(item())
        if redraw:
            self._publish()
        self._catch_up([part for part in self._parts if any(map(part.awaits, items))])
        if self._header is not None:
            self._header.draw_work(self._longest_work())

    def _catch_up(self, first: Sequence[Part]) -> None:
        """Draw what is late, where an answer has come first.

        Once something waits in the inbox it goes before the rest, which the next turn begins with;
        so all are drawn in the end, however many turns there are.
        """
        for part in first:
            part.catch_up()
        if first:
            self._hand_over()
        for _ in self._parts:
            part = self._parts[self._next]
            self._next = (self._next + 1) % len(self._parts)
            late = part.late
            part.catch_up()
            if late and not part.late and not self._inbox.empty():
                return

    def _hand_over(self) -> None:
        """Have what was set so far taken for sending, before more is set.

        From the next atomic block on nothing would be, and the event loop is seldom sooner.
        """
        self.server.flush()
        buffer = self.server._websock_server._broadcast_buffer
        last, end = buffer.message_counter - 1, time.monotonic() + HAND_OVER
        while min([*buffer.generator_cursors.values()], default=last) < last:
            if time.monotonic() >= end:  # a browser that is slow to take what it gets
                return
            time.sleep(0.0002)

    def apply(self, change: Change, client: viser.ClientHandle | None) -> bool:
        """Take a change; true when the page has to be brought to it."""
        before = self._history.present
        try:
            self._history, note = self._history.apply(change, time.monotonic())
        except InputError as error:
            self.complain(str(error), client)
            return True
        self._notes = (note,) if note else ()
        for part in self._parts:
            part.applied(change, before, note, client)
        return True

    def _undo(self, looks: bool, times: int) -> bool:
        undone = self._history.titles(looks, times)
        for _ in undone:
            self._history = self._history.undo(looks)
        self._notes = (f"Taken back: {'; '.join(undone)}",) if undone else ()
        return True

    def _redo(self, looks: bool) -> bool:
        before, self._history = self._history, self._history.redo(looks)
        done = self._history.titles(looks, 1)
        self._notes = (f"Done again: {done[0]}",) if self._history is not before else ()
        return True

    # --- showing

    def _publish(self) -> None:
        """Bring everything to the present review."""
        review = self._history.present
        self._view = compute.view(review)
        for part in self._parts:
            self._view = part.seen(self._view)
        with self.server.atomic():
            if review.design.mechanism != self._kind:
                self._assemble(review)
            self._theme(review)
            for part in sorted(self._parts, key=lambda part: not part.ASKS_FIRST):
                part.follow()
            self.show_machine()
        self._hand_over()  # the machine waits for no panel
        with self.server.atomic():
            sheet = self.sheet()
            for panel in self._panels:
                panel.draw(sheet)
            framed = review.design, self._view.beside is None
            if self._framed != framed:
                self._framed = framed
                self._look()
        self.server.flush()

    def sheet(self) -> Sheet:
        return Sheet(self._view, self._notes, self._history)

    def _assemble(self, review: Review) -> None:
        """Make the panel and the scene's fixed parts for the mechanism of a review."""
        self._kind = review.design.mechanism
        self.gui.reset()
        self.scene.clear()
        self._dark = None
        self._theme(review)
        self.gui.main_panel.dock_right()
        self.gui.main_panel.set_width(PANEL_WIDTH)
        self.gui.set_panel_label("Bohemia")
        self.scene.prepare(review.machine.coordinates)
        for part in sorted(self._parts, key=lambda part: part.DRAWN_LAST):
            part.answers.renew()
            part.prepare()
        sheet = self.sheet()
        self._header = Header(self, sheet)
        self._panels = [self._header]
        served = [kind for kind in each("panel", Panel) if kind.serves(review.machine)]
        tabs = self.gui.add_tab_group()
        for title in dict.fromkeys(kind.TAB or kind.TITLE for kind in served):
            views = [kind for kind in served if title in (kind.TAB, kind.TITLE)]
            with tabs.add_tab(tr(title)):
                if len(views) == 1:
                    self._panels.append(views[0](self, sheet))
                    continue
                switch = self.gui.add_tab_group()
                for kind in views:
                    with switch.add_tab(tr(kind.TITLE)):
                        self._panels.append(kind(self, sheet))
        commands = [command for panel in self._panels for command in panel.commands()]
        add_hotkeys(self, commands)
        self._header.equip(commands)

    def _theme(self, review: Review) -> None:
        if review[Options].dark == self._dark:
            return
        self._dark = review[Options].dark
        self.gui.configure_theme(
            dark_mode=self._dark,
            show_logo=False,
            show_share_button=False,
            brand_color=(95, 105, 117),
        )

    def _longest_work(self) -> Busy | None:
        """What a person waits for; previews are too quick to be worth a bar."""
        at_work = [busy for busy in self._busy.values() if busy.title]  # "" has one of its own
        return min(at_work, key=lambda busy: busy.since, default=None)

    def _look(self, name: Look | None = None, client: viser.ClientHandle | None = None) -> None:
        """Show all that there is, from one side or as at first."""
        more = [points for part in self._parts if (points := part.points) is not None]
        foot = max(part.covered for part in self._parts)
        left = max(part.covered_left for part in self._parts)
        look(self.server, self._view, more, name, client, (foot, left), self._aims)


def _superseded(item: _Asked, later: Sequence[Any]) -> bool:
    """A newer value of the same slider waits already: this one need not be computed."""
    gesture = item.change.gesture
    return bool(gesture) and any(
        isinstance(other, _Asked)
        and type(other.change) is type(item.change)
        and other.change.gesture == gesture
        for other in later
    )


def add_hotkeys(desk: Desk, commands: Iterable[Command]) -> None:
    """Put commands into the palette, with their keys."""
    for command in commands:
        *control, key = command.key.split("+")
        made = desk.gui.add_command(
            command.label,
            description=command.description,
            hotkey=cast(Any, key),
            modifier="cmd/ctrl" if control else None,
        )

        def triggered(event: Any, act: Callable[[Client], object] = command.act) -> None:
            safely(desk, event.client, lambda: act(event.client))

        made.on_trigger(triggered)
