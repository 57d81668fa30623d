"""The Trajectory tab: a path and a time law, what they ask of the actuators, and playing it."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import viser

from app.features.trajectory.compute import Moved, leaves_at
from app.features.trajectory.html import bar_html, fits_html, most_html, summary_html
from app.features.trajectory.part import TrajectoryPart
from app.features.trajectory.paths_panel import WayFolder
from app.features.trajectory.plot import figure, mark
from app.features.trajectory.state import MOST_SAMPLES, Plan, set_plan, step_plan
from app.language import menu, tr
from app.review.state import Review
from app.review.view import Moment
from app.widgets.boxes import Typing, limits_box
from app.widgets.desk import TYPED, Client, Panel, Sheet, explain
from app.widgets.plots import Plot
from app.widgets.texts import box
from kinematics.machine import Machine
from kinematics.trajectories.fits import HIGHEST

KINDS = ("CSV", "SVG")
PACES = {"¼×": 0.25, "½×": 0.5, "1×": 1.0, "4×": 4.0}
WINDOW = 860, 352  # px of the plots over the scene
STEPS = 1000  # of the scrub bar


class TrajectoryPanel(Panel):
    """What runs where and when, its plots in a panel of their own, and what is told of it."""

    TITLE = "trajectory.tab"

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return bool(machine.joints)

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        self._moved: Moved | None = None
        part = self._part = desk.part(TrajectoryPart)
        self.switch("trajectory.show", Plan, "on", ("trajectory", "T"))
        self.key("play", "P", lambda _: desk.ask(part.playing.play))
        self._summary = gui.add_html("")
        self._wrong = gui.add_button_group(
            tr("trajectory.wrong"), (tr("trajectory.to_first"), tr("trajectory.to_next"))
        )
        self.clicked(self._wrong, self._go_there)
        self._cut = self.asks_for("trajectory.cut", part.cut, visible=False)
        self._progress = gui.add_progress_bar(0.0, visible=False)
        self._give_up = self.asks("trajectory.cancel_distances", part.measure, False)
        self._go_on = self.asks("trajectory.find_distances", part.measure, True)
        self.groups.append(WayFolder(desk, self.sheet))
        self._add_time()
        with gui.add_folder(tr("trajectory.most")):
            self._most = gui.add_html("")
        self._add_limits(review)
        self._add_playback()
        with gui.add_folder(tr("trajectory.fits"), expand_by_default=False):
            degrees = {tr("page.none"): 0} | {f"{n}": n for n in range(1, HIGHEST + 1)}
            self.menu("trajectory.degree", degrees, Plan, "degree")
            self._fits = gui.add_html("")
        self.saving(KINDS, part.save_trajectory)
        explain(gui, "trajectory", review.machine)
        self._add_window(review)
        self._moment = Moment(0.0, playing=False, away=False, distance=float("nan"))

    def _add_time(self) -> None:
        gui = self.gui
        with gui.add_folder(tr("trajectory.time")):
            laws = {tr("trajectory.own_law"): ""} | menu("trajectory.laws")
            self.menu("trajectory.law", laws, Plan, "law")
            label, hint = tr("trajectory.duration"), tr("trajectory.duration_hint")
            self._duration = gui.add_number(label, 0.0, min=0.0, step=0.1, hint=hint)
            self.bind(self._duration, self._lasts, partial(step_plan, "duration"))
            self._ramps = [
                self.number(f"trajectory.{name}", Plan, name, step_plan, min=0.001, step=1.0)
                for name in ("speed", "acceleration")
            ]
            samples = self.gui.add_number(
                tr("trajectory.samples"), 2, min=2, max=MOST_SAMPLES, step=1
            )
            self.field(samples, Plan, "samples", step_plan, round)
        for typed in (self._duration, *self._ramps):
            self.set(typed, precision=TYPED)

    def _lasts(self, review: Review) -> float:
        """The duration that was chosen, or the one that the path has of its own, if it is known."""
        plan, moved = review[Plan], self._moved
        if plan.duration or not plan.on or moved is None or moved.stale or moved.computed is None:
            return plan.duration
        return float(moved.computed.law.duration)

    def _add_limits(self, review: Review) -> None:
        gui, desk, joints = self.gui, self.desk, review.machine.joints
        unit, force = ("°", "N·mm") if joints[0].unit == "rad" else ("mm", "N")
        hint = tr("trajectory.limits_hint")
        with gui.add_folder(tr("trajectory.limits"), expand_by_default=False):
            self._limits = {
                name: limits_box(
                    desk,
                    gui.add_text(title, "", hint=hint),
                    joints,
                    title,
                    turning=name != "forces",
                )
                for name, title in (
                    ("rates", tr("trajectory.rates", unit=unit)),
                    ("accelerations", tr("trajectory.accelerations", unit=unit)),
                    ("forces", tr("trajectory.forces", unit=force)),
                )
            }
            self._typing = Typing(desk)
            self.asks_for("trajectory.shorten", self._part.shorten)
        for name, typed in self._limits.items():
            self._typing.watch(typed, partial(self._limit, name))

    def _limit(self, name: str, value: Any, client: Client) -> None:
        self.desk.send(step_plan(name, value), client)

    def _add_playback(self) -> None:
        with self.gui.add_folder(tr("trajectory.playing"), expand_by_default=False):
            self.menu("trajectory.plot", menu("trajectory.plots"), Plan, "plot")
            self.menu("trajectory.playback", menu("trajectory.playbacks"), Plan, "playback")
            self.switch("trajectory.halt", Plan, "halt")

    def _add_window(self, review: Review) -> None:
        """The play bar, and the plots below it, over the foot of the scene."""
        gui, desk, playing = self.gui, self.desk, self._part.playing
        self._window, tab = self.window(tr("trajectory.window"), *WINDOW, visible=review[Plan].on)
        with tab:
            self._bar = gui.add_html(bar_html(None, review[Plan].pace))
            self._play = gui.add_button(
                tr("keys.play"), icon=viser.Icon.PLAYER_PLAY, hint=tr("trajectory.play_hint")
            )
            self._scrub = gui.add_slider(tr("trajectory.at"), 0.0, 1.0, 0.001, 0.0)
            self.set(self._scrub, precision=3)
            self._paces = gui.add_button_group(tr("trajectory.pace"), tuple(PACES))
            self._stop = self.asks_for("trajectory.stop_here", playing.stop_here)
            self._back = self.asks("trajectory.back", playing.go_back)
            self._plot = Plot(
                desk, lambda t, _, client: desk.ask(playing.scrub, t, client), alone=True
            )
        self.answer(self._scrub, lambda at, client: desk.ask(playing.scrub, float(at), client))
        self.clicked(self._play, lambda _: desk.ask(playing.play))
        self.clicked(self._paces, self._pace)

    def _pace(self, client: Client) -> None:
        self.desk.send(set_plan("pace", PACES[self._paces.value]), client)

    def _go_there(self, client: Client) -> None:
        first = self._wrong.value == tr("trajectory.to_first")
        self.desk.ask(self._part.playing.to_warning, client, first=first)

    # --- what is drawn

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        plan = self.review[Plan]
        trapezoid = plan.law == "trapezoidal"
        self.see(not trapezoid, self._duration)
        self.see(trapezoid, *self._ramps)
        for name, box_ in self._limits.items():
            self._typing.draw(box_, getattr(plan, name))
        if not plan.on:
            self.see(False, self._window, self._wrong, self._cut)

    def told(self, sheet: Sheet, news: Any) -> None:
        super().told(sheet, news)
        match news:
            case Moved():
                self._moved = news
                self.put(self._duration, self._lasts(self.review))
                self._draw_trajectory(news)
            case Moment():
                self._moment = news
                self.put(self._scrub, round(news.at, 3))
                icon = viser.Icon.PLAYER_PAUSE if news.playing else viser.Icon.PLAYER_PLAY
                self.set(
                    self._play,
                    label=tr("trajectory.pause" if news.playing else "keys.play"),
                    icon=icon,
                )
                for button in (self._stop, self._back):
                    self.set(button, disabled=not news.away)
                self._draw_cursor()

    def _draw_trajectory(self, moved: Moved) -> None:
        plan, computed, machine = self.review[Plan], moved.computed, self.review.machine
        self.say(self._summary, summary_html(moved) if plan.on else box(tr("trajectory.none_yet")))
        there = plan.on and computed is not None and not moved.stale
        measuring = there and moved.measuring
        self.see(plan.on and not moved.missing, self._window)
        self.see(measuring, self._progress, self._give_up)
        self.set(self._progress, value=round(100.0 * moved.share, 1))
        self.see(there and not moved.measuring and moved.share < 1.0, self._go_on)
        events = () if computed is None else computed.found.events
        self.see(there and bool(events), self._wrong)
        leaves = leaves_at(computed) if there and computed is not None else None
        label = tr("trajectory.cut_at", at=leaves or 0.0)
        self.set(self._cut, visible=leaves is not None, label=label)
        self.say(self._most, most_html(computed) if plan.on and computed else "", moved.stale)
        self.set(self._bar, content=bar_html(computed if there else None, plan.pace))
        fits = ""
        if plan.degree and there:
            axes, joints = machine.coordinates, machine.joints
            fits = fits_html(moved.fits, moved.fit_trouble, axes, joints)
        self.say(self._fits, fits)
        self.set(self._play, disabled=not there)
        if computed is None:
            self._plot.draw(None)
        else:
            # While distances come in they are left to the cursor: the drawing stays.
            of = (computed.found.events if measuring else computed, plan.plot, measuring)
            drawn = partial(figure, computed, plan.plot, measuring=measuring)
            self._plot.draw(of, drawn, stale=moved.stale)
            duration = computed.law.duration
            most = math.ceil(duration * 1e3) / 1e3
            self.set(self._scrub, max=most, step=duration / STEPS)
        self._draw_cursor()

    def _draw_cursor(self) -> None:
        moved = self._moved
        computed = None if moved is None else moved.computed
        if moved is None or computed is None or not self._moment.there:
            self._plot.mark()
            return
        plot, at = self.review[Plan].plot, self._moment.at
        measuring = moved.measuring and not moved.stale
        self._plot.mark(lambda figure: mark(computed, plot, figure.axes, at, measuring=measuring))
