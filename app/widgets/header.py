"""The top of the panel, above the tabs: status, legend, progress."""

from __future__ import annotations

import math
import time

from app.features.singularities.compute import Here
from app.features.solutions.state import Atlas
from app.jobs.worker import Busy
from app.review.units import how_far
from app.review.view import View
from app.scene import palette
from app.widgets.boxes import NUMBERS_GO_BACK
from app.widgets.desk import (
    Controlled,
    Desk,
    Moment,
    Panel,
    Sheet,
    box,
    chip,
    clicked,
    esc,
    put_prop,
    tone,
)
from kinematics.answers.singularities import AT

PATIENCE = 0.6  # s; work that ends sooner is not worth a progress bar


class Header(Panel):
    """A line that is always true, what the colours mean, and what is being computed."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui = desk.gui
        gui.add_html(NUMBERS_GO_BACK)
        self._status = gui.add_html(_status(sheet, "", False))
        self._legend = gui.add_html(_legend(sheet.view))
        self._doing = gui.add_html(_doing("", 0.0))
        self._cancel = gui.add_button("Cancel", visible=False, color="gray")
        clicked(desk, self._cancel, lambda _: desk.cancel())

        self._here: Here | None = None

    def draw(self, sheet: Sheet) -> None:
        put_prop(self._status, "content", _status(sheet, held_text(self._here), self._late(sheet)))
        put_prop(self._legend, "content", _legend(sheet.view))

    def draw_control(self, sheet: Sheet, controlled: Controlled) -> None:
        self._here = controlled.here
        put_prop(self._status, "content", _status(sheet, held_text(self._here), self._late(sheet)))

    def _late(self, sheet: Sheet) -> bool:
        """What is known of control is of a pose before."""
        review = sheet.view.review
        place = None if self._here is None else self._here.place
        return place is None or (place.design, place.pose, place.mode) != (
            review.design,
            review.pose,
            review.mode,
        )

    def draw_moment(self, sheet: Sheet, moment: Moment) -> None:
        held, late = held_text(self._here), self._late(sheet)
        if moment.away:  # of where the machine is shown
            near = moment.distance
            held = f"{near:.1f} mm to a singularity" if math.isfinite(near) else ""
            late = False
        put_prop(self._status, "content", _status(sheet, held, late))

    def draw_work(self, work: Busy | None) -> None:
        """Show what takes longer than a moment, with a way to stop it."""
        waited = 0.0 if work is None else time.monotonic() - work.since
        show = work is not None and work.title is not None and waited > PATIENCE
        put_prop(self._cancel, "visible", show)
        put_prop(self._doing, "content", _doing(work.title or "" if show and work else "", waited))


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
        share = round(100.0 * waited / (waited + 1.5))
        text = (
            f'<div style="white-space:nowrap;overflow:hidden;text-overflow:ellipsis">Computing '
            f'{esc(title)} · {waited:.0f} s</div><div style="height:4px;border-radius:2px;'
            'background:rgba(128,138,150,.25)"><div style="height:4px;border-radius:2px;'
            f'width:{share}%;background:#0072B2"></div></div>'
        )
    return (
        f'{_SLOT}<div class="work" style="height:32px;padding:0 7.5em 0 .75em;font-size:.82em">'
        f"{text}</div>"
    )


def held_text(here: Here | None) -> str:
    """How far it is to where control is lost; "" where nothing is known of it."""
    if here is None:
        return ""
    kinds = {s.kind: None for s in here.singular if s.measure <= AT}
    if kinds:
        return f"singular ({', '.join(kinds)})"
    nearest = here.nearest("parallel", "constraint")
    return "" if nearest is None else f"{how_far(nearest)} to a singularity"


def _status(sheet: Sheet, held: str, late: bool) -> str:
    """The sentence; what of it is still that of a pose before is faint."""
    status = sheet.view.status
    text = esc(status.text)
    if held and sheet.view.posture.closes:
        text += f'<span style="opacity:{0.35 if late else 1}"> · {esc(held)}</span>'
    color = tone(status.level)
    lines = [
        f'<div style="border-left:4px solid {color};padding-left:0.6em;font-weight:600">'
        f"{text}</div>"
    ]
    if status.remedy:
        lines.append(f'<div style="padding-left:calc(0.6em + 4px)">{esc(status.remedy)}</div>')
    lines += [
        f'<div style="padding-left:calc(0.6em + 4px);color:{tone("near")}">'
        f"{esc(_sentence(note))}</div>"
        for note in sheet.notes
    ]
    # The height is kept so that the tabs below do not jump as the sentence changes.
    return box(f'<div style="min-height:4.2em">{"".join(lines)}</div>')


def _sentence(note: str) -> str:
    """With a capital letter, unless it begins with a symbol, as z."""
    return note if note[1:2] == " " else note[:1].upper() + note[1:]


def _legend(view: View) -> str:
    limbs = sorted({row.limb for row in view.joints})
    items = [f"{chip(palette.limb_color(n))}limb {n}" for n in limbs]
    items.append(f"{chip(palette.NEAR)}near its end")
    items.append(f"{chip(palette.BEYOND)}singular, beyond a limit")
    items.append(f"{chip(palette.WORKSPACE)}workspace")
    if view.review[Atlas].ghosts:
        items.append(f"{chip(palette.GHOST)}other solutions")
    spans = "".join(
        f'<span style="white-space:nowrap;margin-right:0.9em">{i}</span>' for i in items
    )
    return box(f'<div style="opacity:0.85">{spans}</div>')
