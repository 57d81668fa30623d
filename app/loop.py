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
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import viser

from app.features.design.panel import DesignPanel
from app.features.map.panel import MapPanel
from app.features.map.part import Mapping
from app.features.move.panel import MovePanel
from app.features.move.state import Place, Visit
from app.features.review.files import ExportedFile, build_file, solid_name
from app.features.review.panel import ReviewPanel
from app.features.section.panel import SectionPanel
from app.features.section.part import Slicing
from app.features.singularities.compute import beside
from app.features.singularities.panel import SingularitiesPanel
from app.features.singularities.part import Controlling
from app.features.singularities.state import Control
from app.features.solutions.panel import SolutionsPanel
from app.features.solutions.part import Solving
from app.features.trajectory.panel import TrajectoryPanel
from app.features.trajectory.part import Moving
from app.features.workspace.compute import SolidWish, modes_of, wishes
from app.features.workspace.panel import WorkspacePanel
from app.features.workspace.part import Regioning
from app.jobs.parts import Part
from app.jobs.worker import Built, Busy, Event, Failed, Worker
from app.review import session
from app.review import view as compute
from app.review.changes import Change
from app.review.history import History
from app.review.requests import Request
from app.review.state import Options, Review, is_planar
from app.scene.machine import FIELD_OF_VIEW, Scene, machine_bounds
from app.scene.morph import Morph
from app.widgets.desk import Hands, Panel, Save, Sheet, safely
from app.widgets.header import Header
from app.widgets.hotkeys import add_hotkeys
from kinematics.errors import InputError

log = logging.getLogger(__name__)

TICK = 0.25  # s between looks at the clock while nothing happens
MOMENT = 0.03  # s, the same while a widget waits to be brought up to date
FRAME = 0.02  # s, the same while the machine glides to another solution
SETTLED = 0.8  # s without a change before the session is saved
PANEL_WIDTH = 400  # px

TABS: tuple[tuple[str, type[Panel]], ...] = (
    ("Move", MovePanel),
    ("Solutions", SolutionsPanel),
    ("Workspace", WorkspacePanel),
    ("Section", SectionPanel),
    ("Singularities", SingularitiesPanel),
    ("Map", MapPanel),
    ("Trajectory", TrajectoryPanel),
    ("Design", DesignPanel),
    ("Review", ReviewPanel),
)


@dataclass(frozen=True, slots=True)
class _Asked:
    """A change, and who asked for it."""

    change: Change
    client: viser.ClientHandle | None


class Page:
    """A review on a viser server; every method but `run` only puts something into the inbox."""

    def __init__(
        self, server: viser.ViserServer, review: Review, address: str, session_file: Path | None
    ) -> None:
        self.server = server
        self.gui = server.gui
        self.address = address
        self.hands = Hands()
        self._session_file = session_file
        self._history = History(review)
        self._inbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.scene = Scene(server)
        self._control = Controlling(self)
        self._regions = Regioning(self)
        self._moving = Moving(self)
        self._parts: tuple[Part, ...] = (
            Solving(self),
            Slicing(self),
            Mapping(self),
            self._regions,
            self._control,
            self._moving,
        )
        self._morph: Morph | None = None
        self._view: compute.View | None = None
        self._wishes: tuple[SolidWish, ...] = ()
        self._header: Header | None = None
        self.panels: list[Panel] = []  # the header first
        self._built: dict[str, Built] = {}
        self._busy: dict[str, Busy] = {}
        self._notes: tuple[str, ...] = ()
        self._dragging: set[int] = set()
        self._grips = 0
        self._unsaved = False
        self._changed_at = 0.0
        self._kind = ""
        self._framed: object = None
        self._framed_with_solids = False
        self._dark: bool | None = None
        self._stopping = threading.Event()
        self.worker = Worker(self._inbox.put)

    # --- what panels ask for (Desk)

    def send(self, change: Change, client: viser.ClientHandle | None = None) -> None:
        self._inbox.put(_Asked(change, client))

    def undo(self) -> None:
        self._inbox.put("undo")

    def redo(self) -> None:
        self._inbox.put("redo")

    def fit_view(self) -> None:
        self._inbox.put("fit")

    def cancel(self) -> None:
        busy = self._longest_work()
        part = next((p for p in self._parts if busy is not None and busy.lane in p.lanes), None)
        if part is None or busy is None:
            self.worker.cancel()
        else:
            part.cancel(busy.lane)

    def ask(self, request: Request) -> None:
        self._inbox.put(request)

    def complain(self, text: str, client: viser.ClientHandle | None = None) -> None:
        """Tell the person who asked, or everybody, what is wrong."""
        self._notify(text, client)
        self._inbox.put("redraw")  # widgets go back to what is true

    def _notify(self, text: str, client: viser.ClientHandle | None) -> None:
        for each in [client] if client is not None else self.server.get_clients().values():
            each.add_notification("Bohemia", text, color="red", auto_close_seconds=12.0)

    def download(self, file: ExportedFile, client: viser.ClientHandle | None) -> None:
        for each in [client] if client is not None else self.server.get_clients().values():
            each.send_file_download(file.name, file.data, save_immediately=True)

    def export(self, save: Save) -> None:
        self._inbox.put(save)

    def picture(self, client: viser.ClientHandle | None) -> None:
        if client is None:
            raise InputError("a picture is taken of one browser's view; press the button there")
        self.apart(client, lambda: self.download(self._picture(client), client))

    def scene_page(self, client: viser.ClientHandle | None) -> None:
        self.apart(client, lambda: self.download(self._scene_page(), client))

    # --- what parts ask for (Stage)

    @property
    def view(self) -> compute.View:
        assert self._view is not None
        return self._view

    def put(self, item: object) -> None:
        self._inbox.put(item)

    def apart(self, client: viser.ClientHandle | None, act: Callable[[], None]) -> None:
        """Do something that takes a while in a thread of its own; its failure is told."""

        def work() -> None:
            safely(self, client, act, "The file could not be made")

        threading.Thread(target=work, daemon=True).start()

    # --- the loop

    def run(self) -> None:
        """Serve the review until `stop`."""
        # Threads hand over to each other within a frame: the lanes must not wait for a drawing.
        sys.setswitchinterval(0.0005)
        self.worker.start()
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
        self._save_session()
        self.worker.stop()
        for part in self._parts:
            part.stop()

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
        if self._morph is not None:
            return FRAME
        if (due := self._moving.due) is not None:
            return due
        return MOMENT if owing or any(part.late for part in self._parts) else TICK

    def _take(self, items: Sequence[Any]) -> None:
        redraw = solids = False
        for n, item in enumerate(items):
            match item:
                case _Asked(change, client):
                    if not _superseded(item, items[n + 1 :]):
                        redraw |= self.apply(change, client)
                case "undo" | "redo":
                    history = self._history
                    self._history = history.undo() if item == "undo" else history.redo()
                    redraw = True
                    self._touched(())
                case "redraw":
                    redraw = True
                case "fit":
                    self._fit()
                case Save():
                    self._export(item)
                case Built() | Failed() | Busy():
                    solids |= self._worked(item)
                case ("drag", phase, client_id, pose):
                    redraw |= self._drag(phase, client_id, pose)
                case _:
                    for part in self._parts:
                        redraw |= part.take(item)
        if redraw:
            self._publish()
        elif solids:
            self._publish_solids()
        self._glide()
        for part in self._parts:
            part.catch_up()
        self._show_work()
        if self._unsaved and time.monotonic() - self._changed_at > SETTLED:
            self._save_session()

    def apply(self, change: Change, client: viser.ClientHandle | None) -> bool:
        """Take a change; true when the page has to be brought to it."""
        before = self._history.present
        try:
            self._history, note = self._history.apply(change, time.monotonic())
        except InputError as error:
            self.complain(str(error), client)
            return True
        self._touched((note,) if note else ())
        for part in self._parts:
            part.applied(change, before, note)
        if isinstance(change, Visit) and self._view is not None:
            after = compute.view(self._history.present)
            self._morph = Morph(self._shown(), after, time.monotonic())
        return True

    def _touched(self, notes: tuple[str, ...]) -> None:
        self._notes = notes
        self._morph = None
        self._unsaved = True
        self._changed_at = time.monotonic()

    def _worked(self, event: Event) -> bool:
        """A lane reported; true when the page has to change."""
        match event:
            case Busy(lane):
                self._busy[lane] = event
                return False
            case Failed(what, resolution, text):
                if text:
                    self.complain(text)
                    self._notes = (text,)  # whoever opens the page later reads it too
                if resolution == "preview":  # better no solid than one of another pose
                    for wish in wishes(self._history.present):
                        if wish.what == what:
                            self._built.pop(wish.spec.key, None)
                return bool(text)
            case Built(wish, resolution):
                before = self._built.get(wish.spec.key)
                ranks = ("preview", "normal", "fine")
                if (
                    before is not None
                    and before.wish.what == wish.what
                    and ranks.index(before.resolution) >= ranks.index(resolution)
                ):
                    return False
                if all(w.what != wish.what for w in wishes(self._history.present)):
                    return False  # the hand has moved on
                self._built[wish.spec.key] = event
                if not self._framed_with_solids:
                    self._framed_with_solids = True
                    self._fit()
                return True

    # --- showing

    def _publish(self) -> None:
        """Bring everything to the present review."""
        review = self._history.present
        view = self._view = replace(compute.view(review), beside=beside(review))
        self._wishes = wishes(review)
        self.worker.want(self._wishes)
        with self.server.atomic():
            if review.design.mechanism != self._kind:
                self._assemble(self.sheet())
            self._theme(review)
            self.scene.show(self._shown(), dragging=bool(self._dragging))
            self._show_solids(view)
            self._draw_panels()
            framed = review.design, review[Control].compare
            if self._framed != framed:
                # Again when the first solid is there: it is larger than the machine.
                self._framed, self._framed_with_solids = framed, not self._wishes
                self._fit()
            for part in self._parts:
                part.follow()
        self.server.flush()

    def _shown(self) -> compute.View:
        """The view that the scene has, or is to have now: on the way to a solution, or there."""
        assert self._view is not None
        if self._morph is None:
            return self._moving.shown(self._view)
        return self._morph.at(time.monotonic())

    def _glide(self) -> None:
        """One more picture of the machine on its way to a solution."""
        if self._morph is None:
            return
        with self.server.atomic():
            self.scene.show(self._shown(), dragging=bool(self._dragging))
        self.server.flush()
        if self._morph.over(time.monotonic()):
            self._morph = None

    def _publish_solids(self) -> None:
        """Only solids came: the machine stands as it stood."""
        assert self._view is not None
        with self.server.atomic():
            self._show_solids(self._view)
            sheet = self.sheet()
            for panel in self.panels:
                panel.draw_solids(sheet)
        self.server.flush()

    def sheet(self) -> Sheet:
        assert self._view is not None
        return Sheet(
            self._view,
            self._wishes,
            dict(self._built),
            self._notes,
            bool(self._history.past),
            bool(self._history.future),
        )

    def _draw_panels(self) -> None:
        sheet = self.sheet()
        for panel in self.panels:
            panel.draw(sheet)

    def _show_solids(self, view: compute.View) -> None:
        wished = {wish.spec.key: wish for wish in self._wishes}
        for spec in view.review.machine.solid_specs:
            wish, built = wished.get(spec.key), self._built.get(spec.key)
            if wish is None:
                self.scene.hide_solid(spec.key)
                self._built.pop(spec.key, None)
            elif built is None:
                self.scene.hide_solid(spec.key)
            elif built.wish.what == wish.what:
                coats = self._control.coats(view, wish, built)
                if not self.scene.shows(wish, built.solid, coats):
                    self.scene.show_solid(wish, built.solid, coats)
                else:
                    self.scene.fade_solid(wish)
            else:  # the new solid is on its way; until then the old one stays where it was
                self.scene.fade_solid(wish)

    def _assemble(self, sheet: Sheet) -> None:
        """Make the panel and the scene's fixed parts for the mechanism of a review."""
        review = sheet.view.review
        self._kind = review.design.mechanism
        self._built.clear()
        self.gui.reset()
        self.scene.clear()
        self._dark = None
        self._theme(review)
        add_hotkeys(self, lambda: self._history.present)
        self.gui.main_panel.dock_right()
        self.gui.main_panel.set_width(PANEL_WIDTH)
        self.gui.set_panel_label("Bohemia")
        for part in self._parts:
            part.prepare()
        self.scene.prepare(
            review.machine.solid_specs,
            sheet.view.drawing.size,
            review.machine.coordinates,
        )
        self._header = Header(self, sheet)
        self.panels = [self._header]
        tabs = self.gui.add_tab_group()
        for title, panel in TABS:
            if panel.serves(review.machine):
                with tabs.add_tab(title):
                    self.panels.append(panel(self, sheet))
        handle = self.scene.handle
        assert handle is not None

        async def dragged(event: viser.TransformControlsEvent) -> None:
            rotation = viser.transforms.SO3(np.array(event.target.wxyz)).as_matrix()
            placed = np.eye(4)
            placed[:3, :3], placed[:3, 3] = rotation, event.target.position
            self._inbox.put(("drag", event.phase, event.client_id, placed))

        handle.on_update(dragged)

    def _drag(self, phase: str, client_id: int | None, placed: np.ndarray) -> bool:
        who = -1 if client_id is None else client_id
        if phase == "end":
            self._dragging.discard(who)
            self.scene.release_handle()
            return True
        if not self._dragging:
            self._grips += 1
        self._dragging.add(who)
        if not np.isfinite(placed).all():
            return False
        review = self._history.present
        pose = review.machine.pose_from_transform(placed, review.mode)
        return self.apply(Place(pose, held=self._grips), None)

    def _theme(self, review: Review) -> None:
        if review[Options].dark == self._dark:
            return
        self._dark = review[Options].dark
        self.gui.configure_theme(
            dark_mode=self._dark,
            show_logo=False,
            show_share_button=False,
            brand_color=(0, 114, 178),
        )

    def _show_work(self) -> None:
        if self._header is not None:
            self._header.draw_work(self._longest_work())

    def _longest_work(self) -> Busy | None:
        """What a person waits for; the coarse lane is too quick to be worth a bar."""
        lanes = (busy for lane, busy in self._busy.items() if lane != "coarse")
        at_work = [busy for busy in lanes if busy.title]  # "" has a bar of its own
        return min(at_work, key=lambda busy: busy.since, default=None)

    def _fit(self) -> None:
        review = self._history.present
        drawing = review.machine.drawing(review.posture)
        other = beside(review)
        low, high = machine_bounds(drawing, *([] if other is None else [other.drawing]))
        for built in self._built.values():
            if built.solid.triangles:
                placed = built.solid.mesh.vertices @ built.wish.placement[:3, :3].T
                placed = placed + built.wish.placement[:3, 3]
                low, high = np.minimum(low, placed.min(0)), np.maximum(high, placed.max(0))
        for more in (self._regions.bounds, self._moving.bounds):
            if more is not None:
                low, high = np.minimum(low, more[0]), np.maximum(high, more[1])
        planar = is_planar(review.machine)
        position, target = self.scene.frame((low, high), from_above=planar)
        first = self.server.initial_camera
        first.near, first.far = drawing.size / 100.0, drawing.size * 80.0
        first.fov = FIELD_OF_VIEW
        first.position, first.look_at = position, target
        for client in self.server.get_clients().values():
            with client.atomic():
                client.camera.near, client.camera.far = first.near, first.far
                client.camera.fov = first.fov
                aspect = client.camera.aspect
                seen = self.scene.frame((low, high), from_above=planar, aspect=aspect)
                client.camera.position, client.camera.look_at = seen

    # --- files

    def _export(self, save: Save) -> None:
        review = self._history.present
        wish = next((w for w in wishes(review) if w.spec.key == save.key), None)
        if wish is None:
            self.complain("that solid is not shown any more", save.client)
            return
        angles = tuple(
            (c, v)
            for c, v in zip(review.machine.coordinates, review.pose, strict=True)
            if c.unit == "rad"
        )
        modes = modes_of(review, wish.spec)
        name = solid_name(review.design, save.key, angles, modes)
        request = next(r for res, r in wish.requests.items() if res == save.resolution)

        def save_it() -> None:
            file = self.worker.apart(
                build_file, request, wish.placement, save.kind, name, save.part
            )
            self.download(file, save.client)

        self.apart(save.client, save_it)

    def _picture(self, client: viser.ClientHandle) -> ExportedFile:
        import imageio.v3 as iio

        height, width = client.camera.image_height, client.camera.image_width
        scale = max(1.0, 1600.0 / max(width, 1))
        image = client.get_render(int(height * scale), int(width * scale), transport_format="png")
        name = f"{solid_name(self._history.present.design, 'view', ())}.png"
        return ExportedFile(name, iio.imwrite("<bytes>", image, extension=".png"), "image/png")

    def _scene_page(self) -> ExportedFile:
        page = self.server.scene.as_html()
        name = f"{solid_name(self._history.present.design, 'scene', ())}.html"
        return ExportedFile(name, page.encode(), "text/html")

    def _save_session(self) -> None:
        if self._session_file is None or not self._unsaved:
            self._unsaved = False
            return
        self._unsaved = False
        try:
            session.save(self._history.present, self._session_file)
        except InputError as error:
            self.complain(f"The session could not be saved: {error}")


def _superseded(item: _Asked, later: Sequence[Any]) -> bool:
    """A newer value of the same slider waits already: this one need not be computed."""
    gesture = item.change.gesture
    return bool(gesture) and any(
        isinstance(other, _Asked)
        and type(other.change) is type(item.change)
        and other.change.gesture == gesture
        for other in later
    )
