"""The Move tab: the pose, the actuators, the working mode."""

from __future__ import annotations

import math
import time
from functools import partial
from typing import Any

from app.features.move.state import Drive, Flip, GiveWay, GoHome, Move, Place
from app.review.state import Review
from app.review.units import minus, page_unit
from app.review.view import JointRow, Moment
from app.scene import palette
from app.widgets.boxes import Slider
from app.widgets.desk import Client, Panel, Sheet, explain
from app.widgets.texts import NUMERIC, bar, box, chip, esc, quiet, table, tone
from kinematics.answers.modes import Mode
from kinematics.answers.singularities import ModeChange
from kinematics.mechanism import Coordinate

STEP = 0.1  # mm and degrees
FREE = "what suits best"
FOLLOWING = 0.12  # s between two looks at a machine that plays its trajectory

HELP = """
The mechanism at one pose. **Drag the coloured handle** on the platform, or move the **pose**
sliders: the inverse kinematics gives the actuators at once. Move an **actuator** slider and the
platform follows along its present assembly mode; at a parallel singularity or at the end of a
stroke it stops and says so. It never jumps to another branch.

A limb's rod turns yellow near the end of its stroke and red-orange beyond it; a red-orange bar
shows by how much a limb fails to reach its platform point.
"""


class MovePanel(Panel):
    """Sliders for everything that moves, and where each actuator stands in its stroke."""

    TITLE = "Move"

    def build(self, review: Review) -> None:
        gui, machine, posture = self.gui, review.machine, self.sheet.view.posture
        axes = machine.coordinates
        with gui.add_folder("Pose of the platform"):
            self._pose = [
                self._slider(Move, n, c, value)
                for n, (c, value) in enumerate(zip(axes, posture.pose, strict=True))
            ]
            if machine.dependent:
                self.choice(
                    "Gives way",
                    {FREE: ""} | {axes[n].symbol: axes[n].key for n in machine.dependent},
                    lambda review: review.gives_way,
                    GiveWay,
                    hint="The coordinate that follows from the others",
                )
        with gui.add_folder("Actuators"):
            self._joints = [
                self._slider(Drive, n, c, value)
                for n, (c, value) in enumerate(zip(machine.joints, posture.joints, strict=True))
            ]
            self._table = gui.add_html("")
            self._residual = gui.add_html("")
        self._meeting: ModeChange | None = None
        self._switches: list[Any] = []
        self._has_modes = bool(machine.mode_noun)
        if self._has_modes:
            with gui.add_folder(machine.mode_noun.capitalize()):
                self._offer_modes(review)
                self._other = gui.add_html("")
                self._change = gui.add_html("")
                self._go = self.button("Go where modes meet", self._go_to_change)
        hint = "Back to the design's home pose (hotkey H)"
        send = self.desk.send
        self.button("Home position", lambda client: send(GoHome(), client), hint=hint)
        self.key("Home position", "The design's home pose", "H", lambda: send(GoHome()))
        explain(gui, machine.text("move"), HELP)
        self._mode = machine.mechanism.mode(review.mode)
        self._followed = 0.0

    def _slider(self, change: type[Move | Drive], n: int, c: Coordinate, value: float) -> Slider:
        def send(value: float, client: Client) -> None:
            self.desk.send(change(n, c.inner(value)), client)

        low, high, shown = (c.outer(v) for v in (c.lower, c.upper, value))
        shown = shown if math.isfinite(shown) else low
        label, free = f"{c.symbol} ({page_unit(c)})", change is Move
        return Slider(self.desk, label, low, high, STEP, shown, send, free=free)

    def _offer_modes(self, review: Review) -> None:
        """A list of operation modes, a switch for each limb that has a sign, or both."""
        machine = review.machine
        of = machine.mechanism.mode
        if of(review.mode).operation:
            known = {each.operation: each.operation for each in machine.modes}
            self.choice(
                "Mode",
                known,
                lambda review: of(review.mode).operation,
                lambda operation: Flip(Mode(operation, self._mode.signs)),
            )
        hint = machine.text("mode") or None
        for n, sign in enumerate(of(review.mode).signs):
            switch = self.gui.add_checkbox(f"Limb {n + 1} on +", sign == "+", hint=hint)
            self.answer(switch, partial(self._flip, n))
            self._switches.append(switch)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self._draw_machine(sheet)
        self._mode = self.review.machine.mechanism.mode(self.review.mode)
        for switch, sign in zip(self._switches, self._mode.signs, strict=True):
            self.put(switch, sign == "+")
        if self._has_modes:
            self.say(self._other, _other_modes(self.review))
            machine = self.review.machine
            self._meeting = machine.singularities.mode_change(sheet.view.posture)
            self.say(self._change, "" if self._meeting is None else box(esc(self._meeting.text)))
            self.set(self._go, visible=self._meeting is not None and not self._meeting.here)

    def told(self, sheet: Sheet, news: Any) -> None:
        now = time.monotonic()
        match news:
            case Moment(away=True, playing=playing) if (
                not playing or now - self._followed > FOLLOWING
            ):
                self._followed = now
                self._draw_machine(sheet)

    def _draw_machine(self, sheet: Sheet) -> None:
        """Pose and actuators, be it on a trajectory."""
        view = sheet.view
        axes = view.review.machine.coordinates
        for slider, c, value in zip(self._pose, axes, view.posture.pose, strict=True):
            slider.draw(*(c.outer(v) for v in (c.lower, c.upper, value)))
        for slider, row in zip(self._joints, view.joints, strict=True):
            slider.draw(row.low, row.high, row.value)
        rows = table(map(_row, view.joints), _COLUMNS, "border-spacing:0 2px")
        self.say(self._table, box(rows))
        self.say(self._residual, quiet(f"loop closure {_closure(view.posture.residual)}"))

    def _go_to_change(self, client: Client) -> None:
        if self._meeting is not None:
            self.desk.send(Place(self._meeting.at.pose, gesture=""), client)

    def _flip(self, n: int, on: bool, client: Client) -> None:
        known = self.review.machine.modes
        self._mode = self._mode.with_sign(n + 1, "+" if on else "-", known)
        self.desk.send(Flip(self._mode), client)


_COLUMNS = (
    "white-space:nowrap",
    f"{NUMERIC};padding:0 0.6em",
    "width:38%",
    "white-space:nowrap;padding-left:0.6em;width:7.5em",
)


def _row(row: JointRow) -> tuple[str, str, str, str]:
    known = row.value == row.value
    at = (row.value - row.low) / (row.high - row.low) if known else 0.0
    limb = palette.limb_color(row.limb)
    color = {"good": limb, "near": palette.NEAR, "bad": palette.BEYOND}[row.level]
    return (
        f"{chip(limb)}{esc(row.symbol)}",
        f"{row.value:.1f} {row.unit}" if known else "none",
        bar(at, color, "0.55em"),
        f'<span style="color:{tone(row.level)}">{esc(row.note)}</span>',
    )


def _other_modes(review: Review) -> str:
    answered = review.machine.inverse(review.pose)
    able = [m for m, ok in zip(answered.modes, answered.within_stroke, strict=True) if ok]
    noun = review.machine.mode_noun
    if not able:
        return box(f"No {noun} reaches this pose within the strokes.")
    some = ", ".join(minus(m) for m in able[:6]) + (" …" if len(able) > 6 else "")
    return box(f"{len(able)} of {len(answered.modes)} {noun}s reach this pose: {some}")


def _closure(residual: float) -> str:
    """ "to 6e-14 mm"."""
    if not math.isfinite(residual):
        return "impossible here"
    return f"to {residual:.0e} mm" if residual else "exact"
