"""The top of the panel, above the tabs: status, legend, progress."""

from __future__ import annotations

import math
import time
from functools import partial
from typing import Any

from app.jobs.lane import Busy
from app.review.state import Options, Review
from app.review.units import sentence
from app.review.view import Clear, Legend, Moment
from app.scene import palette
from app.scene.camera import Look
from app.scene.ground import ground_cell
from app.widgets.boxes import TYPED_WHEN_LEFT
from app.widgets.desk import Group, Sheet, put_prop
from app.widgets.plots import PLOTTED
from app.widgets.texts import AGED_STYLE, aged, bar, box, chip, esc, faint, styled, tone

LOOKS: dict[Look, str] = {
    "isometric": "From the front right above",
    "plan": "From above, x to the right",
    "front": "Along y, x to the right",
    "side": "From the right, along x",
}
"""Views that have a key of their own, 1 to 4, and from where each is."""
PATIENCE = 0.6  # s; work that ends sooner is not worth a progress bar


class Header(Group):
    """A line that is always true, what the colours mean, and what is being computed."""

    def build(self, review: Review) -> None:
        self.gui.add_html(TYPED_WHEN_LEFT + AGED_STYLE + PLOTTED)
        self._status = self.gui.add_html("")
        self._legend = self.gui.add_html("")
        self._doing = self.gui.add_html(_doing("", 0.0))
        self._cancel = self.gui.add_button("Cancel", visible=False, color="gray")
        self.clicked(self._cancel, lambda _: self.desk.cancel())
        desk = self.desk
        self.key("Undo", "Take back the last change", "ctrl+Z", desk.undo)
        self.key("Redo", "Do it again", "ctrl+Y", desk.redo)
        self.key("Fit the view", "Show the machine and its solids whole", "F", desk.fit_view)
        for n, (name, what) in enumerate(LOOKS.items(), 1):
            self.key(f"{sentence(name)} view", what, str(n), partial(desk.look, name))
        self._clear = Clear("", stale=False)
        self._away = False  # the machine is not shown where the review has it
        self._more: tuple[tuple[str, str], ...] = ()

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self.say(self._status, _status(sheet, self._clear))
        self.say(self._legend, _legend(sheet, self._more))

    def told(self, sheet: Sheet, news: Any) -> None:
        match news:
            case Clear():
                self._clear = news
                if not self._away:
                    self.say(self._status, _status(sheet, news))
            case Moment(away=away, distance=near):
                self._away = away
                if away:  # of where the machine is shown
                    text = f"{near:.1f} mm to a singularity" if math.isfinite(near) else ""
                    self.say(self._status, _status(sheet, Clear(text, stale=False)))
            case Legend(entries):
                self._more = entries
                self.say(self._legend, _legend(sheet, entries))

    def draw_work(self, work: Busy | None) -> None:
        """Show what takes longer than a moment, with a way to stop it."""
        waited = 0.0 if work is None else time.monotonic() - work.since
        show = work is not None and work.title is not None and waited > PATIENCE
        self.see(show, self._cancel)
        self.set(self._doing, content=_doing(work.title or "" if show and work else "", waited))


class Elsewhere:
    """A line at the head of what is told of the review's pose, while the machine is not there."""

    def __init__(self, gui: Any) -> None:
        text = "Of the pose that the review holds: the trajectory shows the machine elsewhere."
        self._note = gui.add_html(box(faint(text, "i")), visible=False)

    def draw(self, away: bool) -> None:
        put_prop(self._note, "visible", away)


_SLOT = """<style>div:has(>.work)+div:has(>button){position:relative;height:0;top:-30px;
width:6.4em;left:calc(100% - 7em);margin:0!important;padding:0!important}
div:has(>.work)+div>button{height:22px!important}</style>"""


def _doing(title: str, waited: float) -> str:
    """What is being computed, in a slot of its own height: the tabs below never jump.

    The button beside it, to cancel, is put into the slot too.
    """
    text = ""
    if title:
        # How long a boolean takes is not known beforehand: approach the end, never reach it.
        share = bar(round(waited / (waited + 1.5), 2), "#0072B2", "4px")
        text = (
            '<div style="white-space:nowrap;overflow:hidden;text-overflow:ellipsis">Computing '
            f"{esc(title)} · {waited:.0f} s</div>{share}"
        )
    return (
        f'{_SLOT}<div class="work" style="height:32px;padding:0 7.5em 0 .75em;font-size:.82em">'
        f"{text}</div>"
    )


# Of one height whatever is told, and in sight while the panel scrolls; what is too long is whole
# under the pointer. viser's containers between it and the scroll area must not clip it. Nothing
# lies under the scroll bar.
_STATUS = """<style>.status{height:5.8em;overflow:hidden;padding-left:.6em;border-left:4px solid}
.status>div{display:-webkit-box;-webkit-box-orient:vertical;-webkit-line-clamp:2;overflow:hidden;
overflow-wrap:anywhere}
.legend{height:4.35em;overflow:hidden}
.mantine-ScrollArea-content{padding-right:5px}
.mantine-ScrollArea-content div:has(.status),.mantine-ScrollArea-content [data-dock-group],
.mantine-ScrollArea-content div:has(>[data-dock-group]){overflow:visible!important}
div:has(>div>.status),div:has(>div>div>.status){position:sticky;top:0;z-index:20;
background:var(--mantine-color-body)}</style>"""


def _status(sheet: Sheet, clear: Clear) -> str:
    """The sentence; what of it is still that of a pose before is faint."""
    status = sheet.view.status
    text, whole = esc(status.text), status.text
    if clear.text and sheet.view.posture.closes:
        text += aged(f" · {esc(clear.text)}", clear.stale, "span")
        whole += f" · {clear.text}"
    notes = " ".join(filter(None, (status.remedy, *map(sentence, sheet.notes))))
    return box(
        f'{_STATUS}<div class="status" style="border-color:{tone(status.level)}" '
        f'title="{esc(f"{whole} {notes}".strip())}"><div style="font-weight:600">{text}</div>'
        f'<div style="color:{tone("near")}">{esc(notes)}</div></div>'
    )


def _legend(sheet: Sheet, more: tuple[tuple[str, str], ...]) -> str:
    limbs = sorted({row.limb for row in sheet.view.joints})
    entries = (
        (palette.NEAR, "near its end"),
        (palette.BEYOND, "singular, beyond a limit"),
        (palette.WORKSPACE, "workspace"),
        *more,
    )
    cell = f"grid {ground_cell(sheet.view.drawing):g} mm"
    grid = [cell] if sheet.view.review[Options].grid else []
    chips = "".join(f"{chip(palette.limb_color(n))}{n} " for n in limbs)
    words = [f"limbs {chips}", *(chip(color) + esc(text) for color, text in entries), *grid]
    spans = " ".join(styled(each, "white-space:nowrap;margin-right:0.9em") for each in words)
    return box(f'<div class="legend" style="opacity:0.85">{spans}</div>')
