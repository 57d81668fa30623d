"""The Move tab: the pose, the actuators, the working mode."""

from __future__ import annotations

import math
import time
from functools import partial
from typing import Any

import viser

from app.features.move.state import Drive, Flip, GiveWay, GoHome, Move, Place
from app.review.modes import page_mode
from app.review.units import from_page_units, in_page_units, page_unit
from app.review.view import JointRow
from app.scene import palette
from app.widgets.desk import (
    Desk,
    Moment,
    Panel,
    Sheet,
    Slider,
    answer,
    box,
    button,
    chip,
    esc,
    explain,
    put,
    put_prop,
    tone,
)
from kinematics.answers.modes import Mode
from kinematics.answers.singularities import ModeChange
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate

STEP = {"mm": 0.1, "rad": 0.1}  # on the page: mm and degrees

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

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, view = desk.gui, sheet.view
        self._desk = desk
        machine = view.review.machine
        with gui.add_folder("Pose of the platform"):
            self._pose = [
                self._slider(desk, c, partial(self._move, desk, n, c), value)
                for n, (c, value) in enumerate(
                    zip(machine.coordinates, view.posture.pose, strict=True)
                )
            ]
            self._way: viser.GuiDropdownHandle[str] | None = None
            axes = machine.coordinates
            self._ways = {axes[n].symbol: axes[n].key for n in machine.dependent}
            if self._ways:
                self._way = gui.add_dropdown(
                    "Gives way",
                    (FREE, *self._ways),
                    hint="The coordinate that follows from the others",
                )
                answer(desk, self._way, self._give_way)
        with gui.add_folder("Actuators"):
            self._joints = [
                self._slider(desk, c, partial(self._drive, desk, n, c), row.value)
                for n, (c, row) in enumerate(zip(machine.joints, view.joints, strict=True))
            ]
            self._table = gui.add_html(_table(view.joints))
            self._residual = gui.add_html(_residual(sheet))
        self._modes: list[viser.GuiCheckboxHandle] = []
        self._choice: viser.GuiDropdownHandle[str] | None = None
        if machine.mode_noun:
            with gui.add_folder(machine.mode_noun.capitalize()):
                self._offer_modes(desk, machine, view.posture.mode)
                self._other = gui.add_html(_other_modes(sheet))
                self._change = gui.add_html("")
                self._go = button(desk, "Go where modes meet", self._go_to_change)
                self._meeting: ModeChange | None = None
        button(
            desk,
            "Home position",
            lambda client: desk.send(GoHome(), client),
            hint="Back to the design's home pose (hotkey H)",
        )
        explain(gui, machine.text("move"), HELP)
        self._mode = machine.mechanism.mode(view.posture.mode)
        self._followed = 0.0

    def _offer_modes(self, desk: Desk, machine: Machine[Any], mode: str) -> None:
        """A list of operation modes, a switch for each limb that has a sign, or both."""
        present = machine.mechanism.mode(mode)
        if present.operation:
            known = tuple(dict.fromkeys(each.operation for each in machine.modes))
            self._choice = desk.gui.add_dropdown("Mode", known, initial_value=present.operation)
            answer(desk, self._choice, partial(self._operate, desk))
        hint = machine.text("mode")
        self._modes = [
            desk.gui.add_checkbox(f"Limb {n + 1} on +", sign == "+", hint=hint or None)
            for n, sign in enumerate(present.signs)
        ]
        for n, switch in enumerate(self._modes):
            answer(desk, switch, partial(self._flip, desk, n))

    def draw(self, sheet: Sheet) -> None:
        view, machine = sheet.view, sheet.view.review.machine
        self._draw_machine(sheet)
        if self._way is not None:
            symbols = {key: symbol for symbol, key in self._ways.items()}
            put(self._desk, self._way, symbols.get(view.review.gives_way, FREE))
        self._mode = machine.mechanism.mode(view.posture.mode)
        if self._choice is not None:
            put(self._desk, self._choice, self._mode.operation)
        for switch, sign in zip(self._modes, self._mode.signs, strict=True):
            put(self._desk, switch, sign == "+")
        if machine.mode_noun:
            put_prop(self._other, "content", _other_modes(sheet))
            self._meeting = machine.singularities.mode_change(view.posture)
            text = "" if self._meeting is None else box(esc(self._meeting.text))
            put_prop(self._change, "content", text)
            away = self._meeting is not None and not self._meeting.here
            put_prop(self._go, "visible", away)

    def draw_moment(self, sheet: Sheet, moment: Moment) -> None:
        now = time.monotonic()
        if moment.away and (not moment.playing or now - self._followed > FOLLOWING):
            self._followed = now
            self._draw_machine(sheet)

    def _draw_machine(self, sheet: Sheet) -> None:
        """Pose and actuators, be it on a trajectory."""
        view = sheet.view
        axes = view.review.machine.coordinates
        for slider, c, value in zip(self._pose, axes, view.posture.pose, strict=True):
            slider.draw(
                in_page_units(c, c.lower), in_page_units(c, c.upper), in_page_units(c, value)
            )
        for slider, row in zip(self._joints, view.joints, strict=True):
            slider.draw(row.low, row.high, row.value)
        put_prop(self._table, "content", _table(view.joints))
        put_prop(self._residual, "content", _residual(sheet))

    @staticmethod
    def _slider(desk: Desk, c: Coordinate, act: object, value: float) -> Slider:
        low, high = in_page_units(c, c.lower), in_page_units(c, c.upper)
        shown = value if c.limb else in_page_units(c, value)
        return Slider(
            desk,
            f"{c.symbol} ({page_unit(c)})",
            low,
            high,
            STEP[c.unit],
            shown,
            act,  # type: ignore[arg-type]
        )

    @staticmethod
    def _move(
        desk: Desk, n: int, c: Coordinate, value: float, client: viser.ClientHandle | None
    ) -> None:
        desk.send(Move(n, from_page_units(c, value)), client)

    @staticmethod
    def _drive(
        desk: Desk, n: int, c: Coordinate, value: float, client: viser.ClientHandle | None
    ) -> None:
        desk.send(Drive(n, from_page_units(c, value)), client)

    def _give_way(self, symbol: str, client: viser.ClientHandle | None) -> None:
        self._desk.send(GiveWay(self._ways.get(symbol, "")), client)

    def _go_to_change(self, client: viser.ClientHandle | None) -> None:
        if self._meeting is not None:
            self._desk.send(Place(self._meeting.at.pose, gesture=""), client)

    def _flip(self, desk: Desk, n: int, on: bool, client: viser.ClientHandle | None) -> None:
        self._mode = self._mode.with_sign(n + 1, "+" if on else "-")
        desk.send(Flip(self._mode), client)

    def _operate(self, desk: Desk, operation: str, client: viser.ClientHandle | None) -> None:
        self._mode = Mode(operation, self._mode.signs)
        desk.send(Flip(self._mode), client)


def _table(rows: tuple[JointRow, ...]) -> str:
    body = "".join(_row(row) for row in rows)
    return box(f'<table style="width:100%;border-spacing:0 2px">{body}</table>')


def _row(row: JointRow) -> str:
    span = row.high - row.low
    at = min(max((row.value - row.low) / span, 0.0), 1.0) if row.value == row.value else 0.0
    color = {"good": palette.limb_color(row.limb), "near": palette.NEAR, "bad": palette.BEYOND}[
        row.level
    ]
    bar = (
        '<div style="position:relative;height:0.55em;border-radius:3px;'
        'background:rgba(128,138,150,0.25)">'
        f'<div style="position:absolute;left:0;top:0;bottom:0;width:{100 * at:.1f}%;'
        f'border-radius:3px;background:{color}"></div></div>'
    )
    value = f"{row.value:.1f} {row.unit}" if row.value == row.value else "none"
    note = f'<span style="color:{tone(row.level)}">{esc(row.note)}</span>'
    return (
        f'<tr><td style="white-space:nowrap">{chip(palette.limb_color(row.limb))}'
        f"{esc(row.symbol)}</td>"
        '<td style="text-align:right;white-space:nowrap;padding:0 0.6em;'
        f'font-variant-numeric:tabular-nums">{value}</td><td style="width:38%">{bar}</td>'
        f'<td style="white-space:nowrap;padding-left:0.6em;width:7.5em">{note}</td></tr>'
    )


def _residual(sheet: Sheet) -> str:
    return box(
        f'<span style="opacity:0.75">loop closure {_closure(sheet.view.posture.residual)}</span>'
    )


def _other_modes(sheet: Sheet) -> str:
    view = sheet.view
    answered = view.review.machine.inverse(view.posture.pose)
    able = [m for m, ok in zip(answered.modes, answered.within_stroke, strict=True) if ok]
    noun = view.review.machine.mode_noun
    if not able:
        return box(f"No {noun} reaches this pose within the strokes.")
    some = ", ".join(page_mode(m) for m in able[:6]) + (" …" if len(able) > 6 else "")
    return box(f"{len(able)} of {len(answered.modes)} {noun}s reach this pose: {some}")


def _closure(residual: float) -> str:
    """ "to 6e-14 mm"."""
    if not math.isfinite(residual):
        return "impossible here"
    return f"to {residual:.0e} mm" if residual else "exact"
