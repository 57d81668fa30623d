"""The Move tab: the pose, the actuators, the working mode."""

from __future__ import annotations

import math
import time
from typing import Any

from app.features.move import html
from app.features.move.state import Drive, Flip, GiveWay, GoHome, Move, Place
from app.language import about, tr
from app.review.state import Review
from app.review.units import page_unit, sentence
from app.review.view import Limits, Moment, Reach, mode_noun
from app.widgets.boxes import Slider, pose_box
from app.widgets.desk import Client, Folder, Panel, Sheet, explain
from app.widgets.markup import Markup
from app.widgets.texts import box, esc
from kinematics.answers.modes import Mode
from kinematics.answers.singularities import ModeChange
from kinematics.mechanism import Coordinate

STEP = 0.1  # mm and degrees
LIMITS = 3  # that are told
FOLLOWING = 0.12  # s between two looks at a machine that plays its trajectory


class MovePanel(Panel):
    """Sliders for everything that moves, and where each actuator stands in its stroke."""

    TITLE = "move.tab"

    def build(self, review: Review) -> None:
        gui, machine, posture = self.gui, review.machine, self.sheet.view.posture
        axes = machine.coordinates
        self._bands: list[Any] = []
        with self.folder("move.pose"):
            self._pose = []
            for n, (c, value) in enumerate(zip(axes, posture.pose, strict=True)):
                self._bands.append(gui.add_html(""))
                self._pose.append(self._slider(Move, n, c, value))
            text = gui.add_text(tr("move.typed"), "", hint=tr("move.typed_hint"))
            self._typed = pose_box(self.desk, text, axes, tr("move.a_pose"))
            self.answer(text, self._type)
            if machine.dependent:
                self.choice(
                    "move.gives_way",
                    {tr("move.free"): ""}
                    | {axes[n].symbol: axes[n].key for n in machine.dependent},
                    lambda review: review.gives_way,
                    GiveWay,
                )
        self._actuators = self.folder("move.actuators")
        with self._actuators:
            self._joints = []
            for n, (c, value) in enumerate(zip(machine.joints, posture.joints, strict=True)):
                gui.add_html(html.limb_html(c.limb or n + 1))
                self._joints.append(self._slider(Drive, n, c, value))
            self._told = gui.add_html("")
        self._meeting: ModeChange | None = None
        self._has_modes = bool(machine.mode_noun)
        if self._has_modes:
            self._modes = Folder(gui, sentence(mode_noun(machine)), "", open=True)
            with self._modes:
                self._picker = Markup(self.desk, self._flip)
                self._change = gui.add_html("")
                self._go = self.button("move.go_to_change", self._go_to_change)
        with self.folder("move.limits"):
            self._limits = gui.add_html("")
        send = self.desk.send
        self.key("home", "H", lambda client: send(GoHome(), client))
        explain(gui, "move", machine, *about(review.design.mechanism, "mode"))
        self._reach = Reach((), stale=False)
        self._followed = 0.0

    def _slider(self, change: type[Move | Drive], n: int, c: Coordinate, value: float) -> Slider:
        def send(value: float, client: Client) -> None:
            self.desk.send(change(n, c.inner(value)), client)

        low, high, shown = (c.outer(v) for v in (c.lower, c.upper, value))
        shown = shown if math.isfinite(shown) else low
        label, free = f"{c.symbol} ({page_unit(c)})", change is Move
        return Slider(self.desk, label, low, high, STEP, shown, send, free=free)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self._draw_machine(sheet)
        self._typed.draw(self.review.pose)
        if not self._has_modes:
            return
        machine = self.review.machine
        answered = machine.inverse(self.review.pose)
        self._picker.say(html.picker_html(self.review, answered))
        self._modes.note(html.reaching_text(self.review, answered))
        self._meeting = machine.singularities.mode_change(sheet.view.posture)
        self.say(
            self._change, "" if self._meeting is None else box(esc(sentence(self._meeting.text)))
        )
        self.set(self._go, visible=self._meeting is not None and not self._meeting.here)

    def told(self, sheet: Sheet, news: Any) -> None:
        now = time.monotonic()
        match news:
            case Moment(away=True, playing=playing) if (
                not playing or now - self._followed > FOLLOWING
            ):
                self._followed = now
                self._draw_machine(sheet)
            case Reach():
                self._reach = news
                self._draw_bands()
            case Limits(stale=stale):
                self.say(self._limits, html.limits_html(news, LIMITS), stale and bool(news.rows))

    def _draw_machine(self, sheet: Sheet) -> None:
        """Pose and actuators, be it on a trajectory."""
        view = sheet.view
        axes = view.review.machine.coordinates
        for slider, c, value in zip(self._pose, axes, view.posture.pose, strict=True):
            slider.draw(*(c.outer(v) for v in (c.lower, c.upper, value)))
        for slider, row in zip(self._joints, view.joints, strict=True):
            slider.draw(row.low, row.high, row.value)
        self.say(self._told, html.joints_html(view.joints))
        self._actuators.note(html.closure_text(view.posture.residual))
        self._draw_bands()

    def _draw_bands(self) -> None:
        axes = self.review.machine.coordinates
        spans = self._reach.spans or (None,) * len(axes)
        if len(spans) != len(axes):
            return  # of the machine before
        for handle, slider, axis, known in zip(self._bands, self._pose, axes, spans, strict=True):
            self.say(handle, html.reach_html(axis, known, *slider.reach), self._reach.stale)

    def _type(self, _: str, client: Client) -> None:
        pose = self._typed.read()
        if pose and pose != self.review.pose:
            self.desk.send(Place(pose, gesture=""), client)

    def _go_to_change(self, client: Client) -> None:
        if self._meeting is not None:
            self.desk.send(Place(self._meeting.at.pose, gesture=""), client)

    def _flip(self, pressed: str, client: Client) -> None:
        mechanism, known = self.review.machine.mechanism, self.review.machine.modes
        mode = mechanism.mode(self.review.mode)
        if mode.operation and pressed in {each.operation for each in known}:
            self.desk.send(Flip(Mode(pressed, mode.signs)), client)
            return
        n = int(pressed)
        other = "-" if mode.signs[n] == "+" else "+"
        self.desk.send(Flip(mode.with_sign(n + 1, other, known)), client)
