"""What frames the page: the bar and the status above the tabs, the foot below, and what floats over
the scene.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from functools import partial
from typing import Any

from app.jobs.lane import Busy
from app.jobs.parts import Client
from app.review.changes import SetOption
from app.review.state import Options, Review
from app.review.units import sentence
from app.review.view import Clear, Fact, Legend, Moment, Size
from app.scene import palette
from app.scene.camera import Look
from app.scene.ground import ground_cell
from app.widgets.desk import Command, Group, Sheet, put_prop
from app.widgets.front import FRONT
from app.widgets.icons import icon_button
from app.widgets.markup import Markup
from app.widgets.texts import aged, box, chip, esc, faint, styled, tone

LOOKS: dict[Look, str] = {
    "isometric": "From the front right above",
    "plan": "From above, x to the right",
    "front": "Along y, x to the right",
    "side": "From the right, along x",
}
"""Views that have a key of their own, 1 to 4, and from where each is."""
PATIENCE = 0.6  # s; work that ends sooner is not worth a line of progress
BAR = {"Home position": "home", "Save the review": "save"}
"""Commands that have an icon in the bar."""


class Header(Group):
    """A line that is always true, what the colours mean, and what is being computed."""

    def build(self, review: Review) -> None:
        self.gui.add_html(FRONT)
        desk = self.desk
        self.key("Undo", "Take back the last change", "ctrl+Z", lambda _: desk.undo())
        self.key("Redo", "Do it again", "ctrl+Y", lambda _: desk.redo())
        self.key("Fit the view", "Show the machine whole", "F", lambda _: desk.fit_view())
        for n, (name, what) in enumerate(LOOKS.items(), 1):
            self.key(f"{sentence(name)} view", what, str(n), partial(desk.look, name))
        legend = "Legend", "Show or hide what the colours mean", "K"
        self.toggle(legend, lambda r: r[Options].legend, lambda on: SetOption("legend", on))
        self._commands: dict[str, Command] = {}
        self._bar = Markup(desk, self._pressed)
        self._status = Markup(desk, lambda _, client: self._go_back(client))
        self._work = Markup(desk, lambda _, __: desk.cancel())
        self._views = Markup(desk, self._pressed)
        self._legend = self.gui.add_html("")
        self._foot = self.gui.add_html("")
        self._clear = Clear(None, stale=False)
        self._size = Size(None, stale=False)
        self._away = False  # the machine is not shown where the review has it
        self._entries: dict[str, Legend] = {}

    def equip(self, commands: Iterable[Command]) -> None:
        """These can be done with a key, and some of them in the bar."""
        self._commands = {command.label: command for command in commands}
        self._draw_bar(self.sheet)
        self._draw_foot(self.sheet)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self._draw_bar(sheet)
        self._draw_status(sheet, self._clear)
        self._draw_legend(sheet)
        self._draw_foot(sheet)

    def told(self, sheet: Sheet, news: Any) -> None:
        match news:
            case Clear():
                self._clear = news
                if not self._away:
                    self._draw_status(sheet, news)
            case Size():
                self._size = news
                self._draw_status(sheet, self._clear)
            case Moment(away=away, distance=near):
                self._away = away
                if away:  # of where the machine is shown
                    known = math.isfinite(near)
                    fact = Fact(f"{near:.1f} mm", "to a singularity") if known else None
                    self._draw_status(sheet, Clear(fact, stale=False))
            case Legend():
                self._entries[news.of] = news
                self._draw_legend(sheet)

    def draw_work(self, work: Busy | None) -> None:
        """Show what takes longer than a moment, with a way to stop it."""
        waited = 0.0 if work is None else time.monotonic() - work.since
        show = work is not None and work.title and waited > PATIENCE
        self._work.say(_doing(work.title or "", waited) if show and work else "")

    def _draw_bar(self, sheet: Sheet) -> None:
        done, undone = sheet.history.titles(False, 1), sheet.history.undone(False)
        design = sheet.view.review.design
        undo = f"Undo: {done[0]}" if done else "Nothing to undo"
        redo = f"Redo: {undone}" if undone else "Nothing to redo"
        icons = [
            icon_button("undo", "Undo", undo, disabled=not done),
            icon_button("redo", "Redo", redo, disabled=not undone),
        ]
        icons += [
            icon_button(name, label, _hint(self._commands[label]))
            for label, name in BAR.items()
            if label in self._commands
        ]
        title = esc(design.title or design.name)
        self._bar.say(
            f'<div class="bo-name" title="{title}">{title}</div>'
            f'<div class="bo-bar">{"".join(icons)}</div>'
        )
        on = sheet.view.review[Options].legend
        views = [
            icon_button(name, label, _hint(self._commands[label]), pressed=pressed)
            for label, name, pressed in (
                *((f"{sentence(name)} view", name, None) for name in LOOKS),
                ("Fit the view", "fit", None),
                ("Legend", "legend", on),
            )
            if label in self._commands
        ]
        self._views.say(f'<div class="bo-views">{"".join(views)}</div>')

    def _draw_status(self, sheet: Sheet, clear: Clear) -> None:
        self._status.say(_status(sheet, clear, self._size))

    def _draw_legend(self, sheet: Sheet) -> None:
        shown = sheet.view.review[Options].legend
        self.say(self._legend, _legend(sheet, self._entries.values()) if shown else "")

    def _draw_foot(self, sheet: Sheet) -> None:
        cell = ground_cell(sheet.view.drawing)
        self.say(self._foot, _foot(self._commands.values(), cell))

    def _pressed(self, label: str, client: Client) -> None:
        if label in self._commands:
            self._commands[label].act(client)

    def _go_back(self, client: Client) -> None:
        if self._clear.back is not None:
            self.desk.ask(self._clear.back, client)


class Elsewhere:
    """A line at the head of what is told of the review's pose, while the machine is not there."""

    def __init__(self, gui: Any) -> None:
        text = "Of the pose that the review holds: the trajectory shows the machine elsewhere."
        self._note = gui.add_html(box(faint(text, "i")), visible=False)

    def draw(self, away: bool) -> None:
        put_prop(self._note, "visible", away)


def _hint(command: Command) -> str:
    return f"{command.description} ({command.key.replace('ctrl', 'Ctrl')})"


def _doing(title: str, waited: float) -> str:
    """What is being computed, in the place of the third fact, and a line at the status's edge."""
    # How long a boolean takes is not known beforehand: approach the end, never reach it.
    share = 100.0 * waited / (waited + 1.5)
    told = f"Computing {esc(title)} · {waited:.0f} s"
    return (
        f'<div class="bo-work"><div title="{told}">{told}</div>'
        f"{icon_button('cancel', 'Cancel', 'Give it up')}</div>"
        f'<div class="bo-line"><i style="width:{share:.0f}%"></i></div>'
    )


def _status(sheet: Sheet, clear: Clear, size: Size) -> str:
    """The verdict and three numbers; what is still of a pose before is faint."""
    status = sheet.view.status
    notes = " ".join(filter(None, (status.remedy, *map(sentence, sheet.notes))))
    facts, words = [_fact(fact) for fact in status.facts], [status.text]
    if sheet.view.posture.closes and clear.fact is not None:
        words.append(f"{clear.fact.value} {clear.fact.what}")
        facts += [_fact(clear.fact, clear.stale)] if len(facts) < 2 else []
    if status.level == "bad" and clear.back is not None:
        facts.append('<button class="bo-button" data-send="back">Nearest in reach</button>')
    elif size.fact is not None:
        facts.append(_fact(size.fact, size.stale))
    cells = "".join(f"<div>{fact}</div>" for fact in facts[:3])
    beside = (
        styled(esc(notes), f"color:{tone('near')}") if notes else f"<span>{esc(status.mode)}</span>"
    )
    whole = esc(" · ".join(words) + (f" {notes}" if notes else ""))
    return (
        f'<div class="bo-status" role="status" style="--bo-tone:{tone(status.level)}" '
        f'title="{whole}"><p class="bo-hidden">{whole}</p>'
        f'<div aria-hidden="true" class="bo-verdict"><b>{esc(status.verdict)}</b>{beside}</div>'
        f'<div class="bo-cells">{cells}</div></div>'
    )


def _fact(fact: Fact, stale: bool = False) -> str:
    text = f'<b>{esc(fact.value)}</b><small title="{esc(fact.what)}">{esc(fact.what)}</small>'
    return aged(text, stale)


def _legend(sheet: Sheet, more: Iterable[Legend]) -> str:
    """What is in the scene, each with its colour."""
    rows = sheet.view.joints
    levels = {row.level for row in rows}
    limbs = [(palette.limb_color(n), f"limb {n}") for n in sorted({row.limb for row in rows})]
    told = [entry for legend in more for entry in legend.entries]
    told += [(palette.NEAR, "near its end")] * ("near" in levels)
    told += [(palette.BEYOND, "beyond a limit")] * ("bad" in levels)
    lines = (
        "".join(f"<span>{chip(color)}{esc(text)}</span>" for color, text in line)
        for line in (limbs, told)
        if line
    )
    return f'<div class="bo-legend"><b>Legend</b><br>{"<br>".join(lines)}</div>'


def _foot(commands: Iterable[Command], cell: float) -> str:
    keys = "".join(
        f"<kbd>{esc(c.key.replace('ctrl', 'Ctrl'))}</kbd> {esc(c.label)} &nbsp; " for c in commands
    )
    return (
        '<div class="bo-foot"><button type="button" data-help>What am I looking at?</button>'
        f"<span>grid {cell:g} mm · lengths mm, angles °</span></div>"
        f'<div class="bo-keys" hidden><h2>Keys</h2><p>{keys}</p></div>'
    )
