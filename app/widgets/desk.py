"""What panels share: the way to send a change, and widgets that never answer themselves."""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, ParamSpec, Protocol, TypeVar

import viser

from app.jobs.parts import Client as Client
from app.jobs.parts import Room
from app.language import about, hint, tr
from app.review.changes import Change, SetOne
from app.review.history import History
from app.review.state import Review, Slice
from app.review.view import View
from app.scene import palette
from app.scene.camera import Look
from app.scene.pointer import Pointer
from app.widgets.texts import aged, esc, prose
from kinematics.errors import BohemiaError
from kinematics.machine import Machine

log = logging.getLogger(__name__)

DIGITS = 1  # of mm and of degrees that are computed
TYPED = 4  # and that can be typed
QUIET = palette.rgb(palette.PLATFORM)  # buttons

A = ParamSpec("A")
P = TypeVar("P")
Said = tuple[str, str]
"""Of a command: its name, and its key."""
Setter = Callable[[str, Any], Change]
"""From a field's name and its value to the change that sets it."""


class Hands:
    """Which widgets a person has touched since the loop last looked into its inbox.

    Writing the state into a slider whose newer value still waits in the inbox would pull it out
    of the hand that drags it; such a widget is left alone until its own change has been taken.
    """

    def __init__(self) -> None:
        self._touched: dict[int, float] = {}
        self._looked = 0.0
        self.owed = False  # a widget was left alone, so the panels must be drawn again

    def touch(self, handle: object) -> None:
        """A person changed this widget; called on the event loop before the change is sent."""
        self._touched[id(handle)] = time.monotonic()

    def look(self) -> None:
        """The loop is about to empty its inbox."""
        self._looked = time.monotonic() - 0.005  # between touching and sending
        self.owed = False

    def hold(self, handle: object) -> bool:
        """Whether a person's newer value for this widget is still to be taken."""
        held = self._touched.get(id(handle), -math.inf) > self._looked
        self.owed |= held
        return held


class Desk(Room, Protocol):
    """The page as its panels see it."""

    @property
    def gui(self) -> viser.GuiApi: ...
    @property
    def address(self) -> str:
        """Where the review is served."""

    @property
    def aside(self) -> str:
        """Where one only looks on."""

    @property
    def hands(self) -> Hands: ...
    def send(self, change: Change, client: Client = None) -> None: ...
    def undo(self, looks: bool = False, times: int = 1) -> None:
        """Take back the newest changes, of how the review is shown or of the rest of it."""

    def redo(self, looks: bool = False) -> None: ...
    def cancel(self) -> None: ...
    def point(self, pointer: Pointer) -> None:
        """Where a person's pointer is."""

    def look(self, name: Look, client: Client = None) -> None:
        """Show everything from one side, in one browser or in all."""


@dataclass(frozen=True, eq=False, slots=True)
class Sheet:
    """What panels draw."""

    view: View
    notes: tuple[str, ...]
    history: History

    @property
    def can_undo(self) -> bool:
        return bool(self.history.titles(False, 1))


@dataclass(frozen=True, slots=True)
class Command:
    """An entry of the command palette, and the key that does the same: "Z", "ctrl+Z"."""

    name: str
    key: str
    act: Callable[[Client], object]

    @property
    def label(self) -> str:
        return tr(f"keys.{self.name}")

    @property
    def description(self) -> str:
        return tr(f"keys.{self.name}_hint")


class Folder:
    """A group under a heading; its note says at the right of that what is inside."""

    def __init__(self, gui: viser.GuiApi, title: str, note: str, open: bool) -> None:
        self._note = gui.add_html("")
        self._folder = gui.add_folder(title, expand_by_default=open)
        self.note(note)

    def note(self, text: str) -> None:
        """Say something else there."""
        put_prop(self._note, "content", f'<div class="bo-note">{esc(text)}</div>' if text else "")

    def see(self, on: bool) -> None:
        """Show it or hide it."""
        put_prop(self._note, "visible", on)
        put_prop(self._folder, "visible", on)

    def __enter__(self) -> Folder:
        self._folder.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._folder.__exit__(*error)


class Group:
    """Widgets that show a review: a tab, or a folder of one; made once for a mechanism."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        self.desk = desk
        self.gui = desk.gui
        self.sheet = sheet
        self.groups: list[Group] = []
        self.keys: list[Command] = []
        self._bound: list[tuple[Any, Callable[[Review], Any]]] = []
        self.build(sheet.view.review)

    @property
    def review(self) -> Review:
        """The one that is shown."""
        return self.sheet.view.review

    def build(self, review: Review) -> None:
        """Make the widgets."""
        raise NotImplementedError

    def draw(self, sheet: Sheet) -> None:
        """Bring every widget to the review."""
        self.sheet = sheet
        for handle, read in self._bound:
            put(self.desk, handle, read(self.review))
        for group in self.groups:
            group.draw(sheet)

    def told(self, sheet: Sheet, news: Any) -> None:
        """Something came that panels show; what a group shows nothing of it ignores."""
        for group in self.groups:
            group.told(sheet, news)

    def commands(self) -> list[Command]:
        """What can be done with a key, too."""
        return [*self.keys, *(command for group in self.groups for command in group.commands())]

    def key(self, name: str, key: str, act: Callable[[Client], object]) -> None:
        """Something that can be done with a key, too."""
        self.keys.append(Command(name, key, act))

    def toggle(
        self, command: Said, read: Callable[[Review], bool], change: Callable[[bool], Change]
    ) -> None:
        """Something of the review that a key turns on and off."""
        self.key(*command, lambda who: self.desk.send(change(not read(self.review)), who))

    # --- widgets that stay true to the review; ``text`` is the key of their label and hint

    def bind(
        self, handle: Any, read: Callable[[Review], Any], change: Callable[..., Change]
    ) -> Any:
        """A widget whose value is something of the review; ``change`` makes of it another one."""
        self._bound.append((handle, read))
        put(self.desk, handle, read(self.review))
        answer(self.desk, handle, lambda value, client: self.desk.send(change(value), client))
        return handle

    def field(
        self,
        handle: Any,
        kind: type[Slice],
        name: str,
        setter: Setter | None = None,
        taken: Callable[[Any], Any] = lambda value: value,
    ) -> Any:
        """A widget whose value is a field of a slice, as ``taken`` makes it.

        ``setter`` makes the change; left out it sets the field.
        """
        change = setter or partial(SetOne, kind)
        return self.bind(
            handle, lambda review: getattr(review[kind], name), lambda v: change(name, taken(v))
        )

    def switch(
        self,
        text: str,
        kind: type[Slice],
        name: str,
        command: Said | None = None,
    ) -> Any:
        """A checkbox for a field of a slice; with a ``command`` a key does it, too."""
        if command is not None:
            change = partial(SetOne, kind, name)
            self.toggle(command, lambda review: getattr(review[kind], name), change)
        return self.field(self.tick(text), kind, name)

    def tick(self, text: str, on: bool = False, **look: Any) -> Any:
        """A checkbox of its own."""
        return self.gui.add_checkbox(tr(text), on, hint=hint(text), **look)

    def number(self, text: str, kind: type[Slice], name: str, setter: Setter, **look: Any) -> Any:
        """A number box for a field of a slice."""
        value = getattr(self.review[kind], name)
        made = self.gui.add_number(tr(text), value, hint=hint(text), **look)
        return self.field(made, kind, name, setter)

    def menu(
        self,
        text: str,
        options: Mapping[str, Any],
        kind: type[Slice],
        name: str,
        setter: Setter | None = None,
        **look: Any,
    ) -> Any:
        """A menu for a field of a slice: titles with what each of them stands for."""
        change = partial(setter or partial(SetOne, kind), name)
        return self.choice(text, options, lambda r: getattr(r[kind], name), change, **look)

    def choice(
        self,
        text: str,
        options: Mapping[str, Any],
        read: Callable[[Review], Any],
        change: Callable[[Any], Change],
        **look: Any,
    ) -> Any:
        """A menu of titles with what each of them stands for."""
        handle = self.gui.add_dropdown(tr(text), tuple(options), hint=hint(text), **look)
        first = next(iter(options))

        def title(review: Review) -> str:
            value = read(review)
            return next((title for title, known in options.items() if known == value), first)

        return self.bind(handle, title, lambda chosen: change(options[chosen]))

    def button(self, text: str, act: Callable[[Client], None], **look: Any) -> Any:
        """A quiet button."""
        made = self.gui.add_button(tr(text), color=QUIET, hint=hint(text), **look)
        clicked(self.desk, made, act)
        return made

    def asks(self, text: str, act: Callable[..., object], *arguments: Any, **look: Any) -> Any:
        """A quiet button that has the loop call ``act(*arguments)``."""
        return self.button(text, lambda _: self.desk.ask(act, *arguments), **look)

    def asks_for(self, text: str, act: Callable[[Client], object], **look: Any) -> Any:
        """A quiet button that has the loop call ``act(client)``."""
        return self.button(text, lambda client: self.desk.ask(act, client), **look)

    def saving(self, kinds: tuple[str, ...], save: Callable[[str, Client], object]) -> Any:
        """A button for each kind of file, with which the loop saves it."""
        made = self.gui.add_button_group(tr("page.save_as"), kinds)
        clicked(self.desk, made, lambda who: self.desk.ask(save, made.value.lower(), who))
        return made

    def answer(self, handle: Any, act: Callable[[Any, Client], None]) -> None:
        """Call ``act(value, client)`` when a person changes a widget."""
        answer(self.desk, handle, act)

    def clicked(self, handle: Any, act: Callable[[Client], None]) -> None:
        """Call ``act(client)`` when a person presses a button."""
        clicked(self.desk, handle, act)

    def folder(self, text: str, *, open: bool = True) -> Folder:
        """A group of widgets under a heading, with its hint as a note at its right."""
        return Folder(self.gui, tr(text), hint(text) or "", open)

    def upload(self, text: str, kinds: str, act: Callable[[Any, Client], None]) -> None:
        """A button with which a person chooses a file of these kinds (MIME)."""
        made = self.gui.add_upload_button(
            tr(text), mime_type=kinds, color=QUIET, icon=viser.Icon.UPLOAD, hint=hint(text)
        )
        uploaded(self.desk, made, act)

    def window(self, title: str, width: int, height: int, *, visible: bool) -> tuple[Any, Any]:
        """A panel of its own over the lower left of the scene, px, and its tab."""
        made = self.gui.add_panel(visible=visible)
        made.float(x=0, y=-1, width=width, height=height)
        return made, made.add_tab(title)

    def put(self, handle: Any, value: Any) -> None:
        """Show a value in a widget."""
        put(self.desk, handle, value)

    def set(self, handle: Any, **properties: Any) -> None:
        """Bring properties of a widget to these values."""
        for name, value in properties.items():
            put_prop(handle, name, value)

    def see(self, on: bool, *handles: Any) -> None:
        """Show widgets or hide them."""
        for handle in handles:
            put_prop(handle, "visible", on)

    def offer(self, menu: Any, options: Iterable[str], none: str) -> None:
        """Bring the options of a menu to these, or to ``none`` where there are none."""
        self.set(menu, options=tuple(options) or (none,))

    def say(self, handle: Any, content: str, stale: bool = False) -> None:
        """Bring a piece of HTML to what it is to say."""
        put_prop(handle, "content", aged(content, stale))


class Panel(Group):
    """One tab, or a view of one that has several.

    Attributes:
        TITLE: the key of the title of the tab, or of the view.
        TAB: of a view, that of the title of its tab.
    """

    TITLE: ClassVar[str]
    TAB: ClassVar[str] = ""

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        """Whether a mechanism has any use for this tab; others do not show it."""
        return True


def answer(desk: Desk, handle: Any, act: Callable[[Any, Client], None]) -> None:
    """Call ``act(value, client)`` when a person, not the program, changes a widget.

    ``act`` runs on the event loop, so it may only pass the value on. What it raises becomes a
    notification.
    """

    async def changed(event: Any) -> None:
        if event.client is not None:
            desk.hands.touch(event.target)
            safely(desk, event.client, lambda: act(event.target.value, event.client))

    handle.on_update(changed)


def clicked(desk: Desk, handle: Any, act: Callable[[Client], None]) -> None:
    """Call ``act(client)`` when a person presses a button; what it raises is shown to them."""

    async def pressed(event: Any) -> None:
        safely(desk, event.client, partial(act, event.client))

    handle.on_click(pressed)


def uploaded(desk: Desk, handle: Any, act: Callable[[Any, Client], None]) -> None:
    """Call ``act(file, client)`` with what a person chose, in a thread: reading may take long."""

    async def came(event: Any) -> None:
        act_on = partial(act, event.target.value, event.client)
        await asyncio.to_thread(safely, desk, event.client, act_on)

    handle.on_upload(came)


def safely(
    desk: Desk,
    client: Client,
    act: Callable[[], object],
    trouble: str = "",
) -> None:
    """Do what a person asked for; whatever goes wrong becomes a notification to them."""
    try:
        act()
    except BohemiaError as error:
        desk.complain(str(error), client)
    except Exception as error:
        log.exception("a person's request failed")
        desk.complain(f"{trouble or tr('page.broken')}: {error}", client)


def put(desk: Desk, handle: Any, value: Any) -> None:
    """Show a value in a widget, unless it shows it already to the digits that matter."""
    if desk.hands.hold(handle):
        return
    shown = handle.value
    if isinstance(value, float):
        if not close(shown, value):
            handle.value = value
    elif isinstance(value, tuple) and len(value) == len(shown):
        if not all(close(a, b) for a, b in zip(shown, value, strict=True)):
            handle.value = value
    elif shown != value:
        handle.value = value


def close(shown: float, value: float) -> bool:
    """Whether a widget shows a value to the digits that matter."""
    return math.isfinite(shown) and abs(shown - value) < 1e-7 * max(1.0, abs(value))


def put_prop(handle: Any, name: str, value: Any) -> None:
    """Assign a property only when it differs: every assignment is a message to every client."""
    if getattr(handle, name) != value:
        setattr(handle, name, value)


def explain(gui: viser.GuiApi, topic: str, machine: Machine[Any], *more: str) -> None:
    """The "What am I looking at?" at the foot of a tab: what is seen of the machine, where its
    paper has that, and what the page does.
    """
    kind = machine.design.mechanism
    texts = *about(kind, topic), *more, *about(kind, f"{topic}_paper"), tr(f"{topic}.help")
    gui.add_html(f'<div class="bo-help" role="note">{prose(*texts)}</div>')
