"""What panels share: the way to send a change, and widgets that never answer themselves."""

from __future__ import annotations

import html
import logging
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import viser

from app.features.review.files import ExportedFile
from app.features.section.compute import Drawn, Region
from app.features.singularities.compute import Here
from app.features.solutions.atlas import Known, Listed
from app.features.solutions.folds import Ahead
from app.features.trajectory.compute import Computed, Reach
from app.features.workspace.compute import Laid, SolidWish
from app.jobs.worker import Built
from app.review.changes import Change
from app.review.requests import Request
from app.review.view import View
from app.scene import palette
from app.scene.painting import Scale
from kinematics.answers.circles import Profile
from kinematics.answers.loci import LocusCurves
from kinematics.answers.sections import Box, Sphere, Volume
from kinematics.errors import BohemiaError
from kinematics.facets.map_sweeps import Map
from kinematics.machine import Machine
from kinematics.mechanism import Design
from kinematics.trajectories import Fits

log = logging.getLogger(__name__)

DIGITS = 1  # of mm and of degrees that are computed
TYPED = 4  # and that can be typed
QUIET = palette.rgb(palette.PLATFORM)  # buttons


@dataclass(frozen=True, slots=True)
class Save:
    """A person asked for a shown solid as a file."""

    key: str
    kind: str
    resolution: str
    client: viser.ClientHandle | None
    part: str = ""


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


class Desk(Protocol):
    """What a panel may ask of the server; none of it blocks."""

    @property
    def gui(self) -> viser.GuiApi: ...
    @property
    def address(self) -> str: ...
    @property
    def hands(self) -> Hands: ...
    def send(self, change: Change, client: viser.ClientHandle | None = None) -> None: ...
    def undo(self) -> None: ...
    def redo(self) -> None: ...
    def fit_view(self) -> None: ...
    def cancel(self) -> None: ...
    def ask(self, request: Request) -> None: ...
    def export(self, save: Save) -> None: ...
    def download(self, file: ExportedFile, client: viser.ClientHandle | None) -> None: ...
    def picture(self, client: viser.ClientHandle | None) -> None: ...
    def scene_page(self, client: viser.ClientHandle | None) -> None: ...
    def complain(self, text: str, client: viser.ClientHandle | None = None) -> None: ...


@dataclass(frozen=True, eq=False, slots=True)
class Sheet:
    """What panels draw: the view, and the solids that stand on display."""

    view: View
    wishes: tuple[SolidWish, ...]
    built: dict[str, Built]
    notes: tuple[str, ...]
    can_undo: bool
    can_redo: bool


@dataclass(frozen=True, eq=False, slots=True)
class Solutions:
    """The forward solutions as panels draw them.

    ``ahead`` is empty while the folds are being looked for; ``fold`` is the one that is told of;
    ``trouble`` and ``fold_trouble`` say why there are none of them, if that is so.
    """

    atlas: Listed
    known: Known | None
    ahead: tuple[Ahead, ...]
    fold: Ahead | None
    trouble: str
    fold_trouble: str


@dataclass(frozen=True, eq=False, slots=True)
class Sections:
    """What is known of the workspace's sections and measures, as panels draw it.

    Attributes:
        region: the present workspace; the next two may be of the one before.
        drawn: the newest section.
        volume, volume_of: the newest volume, and of what it is.
        ball, box: the largest ones in the present workspace, if a person asked for them.
        trouble: what could not be computed.
    """

    region: Region
    drawn: Drawn | None
    volume: Volume | None
    volume_of: Region | None
    ball: Sphere | None
    box: Box | None
    trouble: str

    @property
    def current(self) -> bool:
        """The volume is of the present workspace."""
        return self.volume_of == self.region


@dataclass(frozen=True, eq=False, slots=True)
class Charted:
    """The map as panels draw it.

    Attributes:
        map: of the chosen quantity, if something is known of it, else the newest one.
        of: tells apart what maps are of.
        stale: it is of another design or of other working modes.
        running: the title of what is being computed, "" for nothing; ``share`` of it is done
            after ``seconds``.
        trouble: why the last one was given up.
    """

    map: Map | None
    of: object
    stale: bool
    running: str
    share: float
    seconds: float
    trouble: str


@dataclass(frozen=True, slots=True)
class Logged:
    """Something that happened on the way: when (s since the epoch), in words, and of which kind."""

    at: float
    text: str
    kind: str


@dataclass(frozen=True, eq=False, slots=True)
class Controlled:
    """What is known of control, as panels draw it.

    Attributes:
        here: of the present place, or while ``stale`` of one shortly before.
        curves: of the chosen chart; None while they are traced.
        profiles: of the machine and of its counterparts, each with its design.
        beside, curves_beside: the counterpart's, where it is compared with.
        ball: the largest one without a singularity, if a person asked for it; ``seeking`` it.
        log: what happened on the way, the newest first.
        scale: the steps of the measure that colours show.
        trouble: what could not be computed.
    """

    here: Here | None
    stale: bool
    curves: LocusCurves | None
    profiles: tuple[tuple[Design, Profile], ...]
    beside: Here | None
    curves_beside: LocusCurves | None
    ball: Sphere | None
    seeking: bool
    log: tuple[Logged, ...]
    scale: Scale | None
    trouble: str


@dataclass(frozen=True, eq=False, slots=True)
class Laying:
    """The plane regions as panels draw them; ``trouble`` says why there are none."""

    laid: Laid | None
    trouble: str


@dataclass(frozen=True, eq=False, slots=True)
class Moved:
    """The trajectory as panels draw it.

    Attributes:
        computed: the newest; ``stale`` while another one is wanted.
        missing: what a person has to do until there is a path.
        share: of the distances to singularities that are known; ``measuring`` the others.
        fits: polynomials of the wanted degree; None while there are none.
        fit_trouble: why there are none.
        reach: where a stroke can run; None while it is not known.
        trouble: what could not be computed.
    """

    computed: Computed | None
    stale: bool
    missing: str
    share: float
    measuring: bool
    fits: Fits | None
    fit_trouble: str
    reach: Reach | None
    trouble: str


@dataclass(frozen=True, slots=True)
class Moment:
    """Where on its trajectory the machine is shown.

    ``away``: that is not where the review has it. ``distance`` to a singularity, mm, NaN if it is
    not known. ``there``: the machine is where the trajectory has it at that time.
    """

    at: float
    playing: bool
    away: bool
    distance: float
    there: bool = True


class Panel:
    """One tab: made once for a mechanism, then redrawn. What a tab shows nothing of it ignores."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        raise NotImplementedError

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        """Whether a mechanism has any use for this tab; others do not show it."""
        return True

    def draw(self, sheet: Sheet) -> None:
        """Bring every widget to the view."""

    def draw_solids(self, sheet: Sheet) -> None:
        """Only solids came since the last `draw`."""

    def draw_solutions(self, sheet: Sheet, solutions: Solutions) -> None:
        """The solutions changed, or their distances from here."""

    def draw_sections(self, sheet: Sheet, sections: Sections) -> None:
        """A section, a volume, a ball or a box came."""

    def draw_map(self, sheet: Sheet, charted: Charted) -> None:
        """More of the map came, or it began or ended."""

    def draw_regions(self, sheet: Sheet, laying: Laying) -> None:
        """Plane regions came, or went."""

    def draw_control(self, sheet: Sheet, controlled: Controlled) -> None:
        """More is known of control."""

    def draw_trajectory(self, sheet: Sheet, moved: Moved) -> None:
        """More is known of the trajectory."""

    def draw_moment(self, sheet: Sheet, moment: Moment) -> None:
        """The machine moves along its trajectory; the sheet's view shows it there."""


def answer(desk: Desk, handle: Any, act: Callable[[Any, viser.ClientHandle | None], None]) -> None:
    """Call ``act(value, client)`` when a person, not the program, changes a widget.

    ``act`` runs on the event loop, so it may only pass the value on. What it raises becomes a
    notification.
    """

    async def changed(event: Any) -> None:
        if event.client is not None:
            desk.hands.touch(event.target)
            safely(desk, event.client, lambda: act(event.target.value, event.client))

    handle.on_update(changed)


def clicked(desk: Desk, handle: Any, act: Callable[[viser.ClientHandle | None], None]) -> None:
    """Call ``act(client)`` when a person presses a button; what it raises is shown to them."""

    async def pressed(event: Any) -> None:
        safely(desk, event.client, lambda: act(event.client))

    handle.on_click(pressed)


def safely(
    desk: Desk,
    client: viser.ClientHandle | None,
    act: Callable[[], None],
    trouble: str = "Something went wrong in the page itself",
) -> None:
    """Do what a person asked for; whatever goes wrong becomes a notification to them."""
    try:
        act()
    except BohemiaError as error:
        desk.complain(str(error), client)
    except Exception as error:
        log.exception("a person's request failed")
        desk.complain(f"{trouble}: {error}", client)


def put(desk: Desk, handle: Any, value: Any) -> None:
    """Show a value in a widget, unless it shows it already to the digits that matter."""
    if desk.hands.hold(handle):
        return
    shown = handle.value
    if isinstance(value, float):
        if not _close(shown, value):
            handle.value = value
    elif isinstance(value, tuple) and len(value) == len(shown):
        if not all(_close(a, b) for a, b in zip(shown, value, strict=True)):
            handle.value = value
    elif shown != value:
        handle.value = value


def _close(shown: float, value: float) -> bool:
    return math.isfinite(shown) and abs(shown - value) < 1e-7 * max(1.0, abs(value))


def put_prop(handle: Any, name: str, value: Any) -> None:
    """Assign a property only when it differs: every assignment is a message to every client."""
    if getattr(handle, name) != value:
        setattr(handle, name, value)


class Slider:
    """A slider with its number box; a value outside its range stands at its end."""

    def __init__(
        self,
        desk: Desk,
        label: str,
        low: float,
        high: float,
        step: float,
        value: float,
        act: Callable[[float, viser.ClientHandle | None], None],
        hint: str | None = None,
        digits: int = DIGITS,
    ) -> None:
        self._desk = desk
        self._digits = digits
        self._handle = desk.gui.add_slider(
            label, low, high, step, round(min(max(value, low), high), digits), hint=hint
        )
        put_prop(self._handle, "precision", max(digits, TYPED))
        answer(desk, self._handle, act)

    def draw(self, low: float, high: float, value: float) -> None:
        put_prop(self._handle, "min", low)
        put_prop(self._handle, "max", high)
        if not math.isfinite(value):
            return
        value = min(max(value, low), high)
        # What was typed stays as it was typed; what was computed shows the digits that fit.
        if not _close(self._handle.value, value):
            put(self._desk, self._handle, round(value, self._digits))


class Elsewhere:
    """A line at the head of what is told of the review's pose, while the machine is not there."""

    def __init__(self, gui: viser.GuiApi) -> None:
        text = "Of the pose that the review holds: the trajectory shows the machine elsewhere."
        self._note = gui.add_html(box(f'<i style="opacity:.75">{text}</i>'), visible=False)

    def draw(self, moment: Moment) -> None:
        put_prop(self._note, "visible", moment.away)


def button(
    desk: Desk,
    label: str,
    act: Callable[[viser.ClientHandle | None], None],
    *,
    icon: Any = None,
    hint: str | None = None,
) -> viser.GuiButtonHandle:
    """A quiet button."""
    made = desk.gui.add_button(label, icon=icon, hint=hint, color=QUIET)
    clicked(desk, made, act)
    return made


def explain(gui: viser.GuiApi, *texts: str) -> None:
    """The "What am I looking at?" at the foot of a tab: of the mechanism, then of the page."""
    with gui.add_folder("What am I looking at?", expand_by_default=False):
        gui.add_markdown("\n\n".join(text.strip() for text in texts if text.strip()))


# --- small pieces of HTML. Only text that passed `esc` goes in ---------------------------


Tone = Literal["good", "near", "bad", "quiet"]
_TONES = {"good": "#009E73", "near": "#B59B00", "bad": palette.BEYOND, "quiet": "#7A828C"}


def esc(text: object) -> str:
    """Text that may come from a file or a person, harmless in HTML."""
    return html.escape(str(text))


def tone(level: Tone) -> str:
    """The CSS colour of a level."""
    return _TONES[level]


def box(content: str) -> str:
    """A block with the margins of the panel's other rows."""
    return f'<div style="padding:0.3em 0.75em;font-size:0.82em;line-height:1.45">{content}</div>'


def red(text: str) -> str:
    """A block that tells what is wrong."""
    return box(f'<b style="color:{palette.BEYOND}">{esc(text)}</b>')


def chip(color: str) -> str:
    """A small square of a colour."""
    return (
        f'<span style="display:inline-block;width:0.75em;height:0.75em;border-radius:2px;'
        f'background:{color};margin-right:0.35em;vertical-align:-0.05em"></span>'
    )


def volume_text(mm3: float, error: float | None = None) -> str:
    """A volume in the unit that reads best; with an error to the digits that it leaves."""
    unit, scale = ("dm³", 1e-6) if abs(mm3) >= 1e5 else ("cm³", 1e-3)
    value = mm3 * scale
    if error is None or error <= 0:
        return f"{value:.4g} {unit}" if abs(value) < 1000 else f"{value:,.0f} {unit}"
    return f"{with_error(value, error * scale, 9)} {unit}"


def with_error(value: float, error: float, most: int) -> str:
    """A number to the digits that its error leaves, ``most`` at the most, and that error."""
    decimals = min(max(0, math.ceil(-math.log10(error))), most)
    shown = math.ceil(error * 10**decimals) / 10**decimals  # never less than it is
    return f"{value:,.{decimals}f} ± {shown:.{decimals}f}"


def area_text(mm2: float) -> str:
    """An area in the unit that reads best."""
    value, unit = (mm2 * 1e-2, "cm²") if abs(mm2) >= 1e3 else (mm2, "mm²")
    return f"{value:.4g} {unit}" if abs(value) < 1000 else f"{value:,.1f} {unit}".replace(",", " ")
