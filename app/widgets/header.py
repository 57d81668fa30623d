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
from app.language import tr
from app.review.changes import SetOption
from app.review.state import Options, Review
from app.review.units import sentence
from app.review.view import Clear, Fact, Legend, Moment, People, Size
from app.scene import palette
from app.scene.camera import Look
from app.scene.pointer import POINTER, PRESSED, Pointer
from app.scene.shapes import ground_cell
from app.widgets.desk import Command, Group, Sheet, put_prop
from app.widgets.front import FRONT
from app.widgets.icons import icon_button
from app.widgets.markup import Markup
from app.widgets.once import Once
from app.widgets.texts import aged, box, chip, esc, faint, styled, tone
from kinematics.mechanism import Design

LOOKS: tuple[Look, ...] = ("isometric", "plan", "front", "side")
"""Views that have a key of their own, 1 to 4."""
PATIENCE = 0.6  # s; work that ends sooner is not worth a line of progress
BAR = ("home", "save")
"""Commands that have an icon in the bar."""


class Header(Group):
    """A line that is always true, what the colours mean, and what is being computed."""

    def build(self, review: Review) -> None:
        self.gui.add_html(FRONT)
        desk = self.desk
        self.key("undo", "ctrl+Z", lambda _: desk.undo())
        self.key("redo", "ctrl+Y", lambda _: desk.redo())
        self.key("fit", "F", lambda _: desk.fit_view())
        for n, name in enumerate(LOOKS, 1):
            self.key(name, str(n), partial(desk.look, name))
        legend = "legend", "K"
        self.toggle(legend, lambda r: r[Options].legend, lambda on: SetOption("legend", on))
        self._commands: dict[str, Command] = {}
        self._bar = Markup(desk, self._pressed)
        self._status = Markup(desk, lambda _, client: self._go_back(client))
        self._work = Markup(desk, lambda _, __: desk.cancel())
        self._views = Markup(desk, self._pressed)
        Markup(desk, self._pointed, POINTER).say('<div class="bo-pointer"></div>')
        self._legend = self.gui.add_html("")
        self._people = self.gui.add_html("")
        self._foot = self.gui.add_html("")
        self._clear = Clear(None, stale=False)
        self._size = Size(None, stale=False)
        self._away = False  # the machine is not shown where the review has it
        self._entries: dict[str, Legend] = {}
        self._buttons = Once(self._draw_bar)
        self._looks = Once(self._draw_views)
        self._ground = Once(self._draw_foot)

    def equip(self, commands: Iterable[Command]) -> None:
        """These can be done with a key, and some of them in the bar."""
        self._commands = {command.name: command for command in commands}
        self._draw_frame(self.sheet)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self._draw_frame(sheet)
        self._draw_status(sheet, self._clear)
        self._draw_legend(sheet)

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
                    fact = Fact(f"{near:.1f} mm", tr("page.to_singularity")) if known else None
                    self._draw_status(sheet, Clear(fact, stale=False))
            case People():
                self.say(self._people, _people(news))
            case Legend():
                self._entries[news.of] = news
                self._draw_legend(sheet)

    def draw_work(self, work: Busy | None) -> None:
        """Show what takes longer than a moment, with a way to stop it."""
        waited = 0.0 if work is None else time.monotonic() - work.since
        show = work is not None and work.title and waited > PATIENCE
        self._work.say(_doing(work.title or "", waited) if show and work else "")

    def _draw_frame(self, sheet: Sheet) -> None:
        """The bar, the views over the scene and the foot."""
        review, commands = sheet.view.review, tuple(self._commands.values())
        done = next(iter(sheet.history.titles(False, 1)), "")
        self._buttons(commands, review.design, done, sheet.history.undone(False))
        self._looks(commands, on=review[Options].legend)
        self._ground(commands, ground_cell(sheet.view.drawing))

    def _draw_bar(self, _: object, design: Design, done: str, undone: str) -> None:
        undo = tr("page.undo", what=done) if done else tr("page.nothing_to_undo")
        redo = tr("page.redo", what=undone) if undone else tr("page.nothing_to_redo")
        icons = [
            icon_button("undo", tr("keys.undo"), undo, disabled=not done),
            icon_button("redo", tr("keys.redo"), redo, disabled=not undone),
        ]
        icons += map(self._icon, BAR)
        title = esc(design.title or design.name)
        self._bar.say(
            f'<div class="bo-name" title="{title}">{title}</div>'
            f'<div class="bo-bar">{"".join(icons)}</div>'
        )

    def _draw_views(self, _: object, *, on: bool) -> None:
        views = [*map(self._icon, (*LOOKS, "fit")), self._icon("legend", on)]
        self._views.say(f'<div class="bo-views">{"".join(views)}</div>')

    def _icon(self, name: str, pressed: bool | None = None) -> str:
        """The button of a command, if there is that command already."""
        command = self._commands.get(name)
        if command is None:
            return ""
        return icon_button(
            name, command.label, f"{command.description} ({_key(command)})", pressed=pressed
        )

    def _draw_status(self, sheet: Sheet, clear: Clear) -> None:
        self._status.say(_status(sheet, clear, self._size))

    def _draw_legend(self, sheet: Sheet) -> None:
        shown = sheet.view.review[Options].legend
        self.say(self._legend, _legend(sheet, self._entries.values()) if shown else "")

    def _draw_foot(self, commands: Iterable[Command], cell: float) -> None:
        self.say(self._foot, _foot(commands, cell))

    def _pointed(self, text: str, client: Client) -> None:
        """ "0 412 97": of the first tab, px; or "0 - -"; or "0 412 97 pressed"."""
        tab, x, y, *more = text.split()
        at = None if x == "-" else (float(x), float(y))
        self.desk.point(Pointer(client, int(tab), at, PRESSED in more))

    def _pressed(self, name: str, client: Client) -> None:
        if name in self._commands:
            self._commands[name].act(client)

    def _go_back(self, client: Client) -> None:
        if self._clear.back is not None:
            self.desk.ask(self._clear.back, client)


class Elsewhere:
    """A line at the head of what is told of the review's pose, while the machine is not there."""

    def __init__(self, gui: Any) -> None:
        self._note = gui.add_html(box(faint(tr("page.elsewhere"), "i")), visible=False)

    def draw(self, away: bool) -> None:
        put_prop(self._note, "visible", away)


def _key(command: Command) -> str:
    return command.key.replace("ctrl", tr("page.ctrl"))


def _doing(title: str, waited: float) -> str:
    """What is being computed, in the place of the third fact, and a line at the status's edge."""
    # How long a boolean takes is not known beforehand: approach the end, never reach it.
    share = 100.0 * waited / (waited + 1.5)
    told = esc(tr("page.computing", what=title, seconds=waited))
    return (
        f'<div class="bo-work"><div title="{told}">{told}</div>'
        f"{icon_button('cancel', tr('page.cancel'), tr('page.cancel_hint'))}</div>"
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
        text = tr("page.nearest_in_reach")
        facts.append(f'<button class="bo-button" data-send="back">{text}</button>')
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
    limbs = [
        (palette.limb_color(n), tr("page.limb", n=n)) for n in sorted({row.limb for row in rows})
    ]
    told = [entry for legend in more for entry in legend.entries]
    told += [(palette.NEAR, tr("page.near_end"))] * ("near" in levels)
    told += [(palette.BEYOND, tr("page.beyond_limit"))] * ("bad" in levels)
    lines = (
        "".join(f"<span>{chip(color)}{esc(text)}</span>" for color, text in line)
        for line in (limbs, told)
        if line
    )
    return f'<div class="bo-legend"><b>{tr("keys.legend")}</b><br>{"<br>".join(lines)}</div>'


def _people(people: People) -> str:
    """Who else is here; nothing for one alone."""
    if len(people.every) < 2:
        return ""
    rows = (f"<span>{chip(person.color)}{esc(person.text)}</span>" for person in people.every)
    return f'<div class="bo-people" role="status">{"".join(rows)}</div>'


def _foot(commands: Iterable[Command], cell: float) -> str:
    keys = "".join(f"<kbd>{esc(_key(c))}</kbd> {esc(c.label)} &nbsp; " for c in commands)
    return (
        '<div class="bo-foot"><button type="button" data-help>'
        f"{tr('page.help')}</button><span>{tr('page.units', cell=cell)}</span></div>"
        f'<div class="bo-keys" hidden><h2>{tr("page.keys")}</h2><p>{keys}</p></div>'
    )
