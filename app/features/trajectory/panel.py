"""The Trajectory tab: a path and a time law, what they ask of the actuators, and playing it."""

from __future__ import annotations

import math
from typing import Any

import viser

from app.features.trajectory.compute import Computed
from app.features.trajectory.html import fits_html, summary_html
from app.features.trajectory.paths_panel import WayFolder
from app.features.trajectory.plot import figure, mark
from app.features.trajectory.state import MOST_SAMPLES, SPEEDS, Plan, SetPlan
from app.review.requests import (
    Distances,
    LeaveWay,
    NextWarning,
    Play,
    SaveTrajectory,
    Scrub,
    Shortest,
    StopHere,
)
from app.widgets.desk import (
    TYPED,
    Desk,
    Moment,
    Moved,
    Panel,
    Sheet,
    answer,
    box,
    button,
    clicked,
    explain,
    put,
    put_prop,
    red,
)
from app.widgets.plots import Plot
from app.widgets.pose_boxes import LimitsBox
from kinematics.errors import InputError
from kinematics.machine import Machine
from kinematics.trajectories.fits import HIGHEST

KINDS = ("CSV", "SVG")
LAWS = {
    "The path's own": "",
    "Constant velocity": "linear",
    "Cubic, rest to rest": "cubic",
    "Quintic, rest to rest": "quintic",
    "Trapezoidal": "trapezoidal",
}
PLAYBACKS = {"Again and again": "loop", "Once": "once", "To and fro": "swing"}
PLOTS = {
    "Everything": "all",
    "Joints": "joints",
    "Rates": "rates",
    "Accelerations": "accelerations",
    "Forces": "forces",
    "Distance to a singularity": "distance",
}
PACES = {f"{speed:g}×": speed for speed in SPEEDS}
NO_FIT = "none"
LIMITS = ("rates", "accelerations", "forces")
WIDTH = 410  # px of the plots' own panel
STEPS = 1000  # of the scrub bar

HELP = """
A **path** of the platform and a **time law** on it, run in the present working mode. The plots show
what that asks of the actuators; forces hold the load of the Singularities tab, quasi-statically.
Bands mark where the path leaves the workspace, is singular or exceeds a limit (red-orange), grey
ones where a singularity is near; the same places are marked on the path in the scene.

**Play** moves the machine in the scene, and the review stays where it is: *Stop here* puts it where
it is shown, and so does the scrub bar, or a click on a plot, once the hand rests. Undo takes it
back. Playing stops where the platform is not held, as a machine could not be driven on. Where
coordinates depend on each other, one of them follows along the way.

A **polynomial fit** replaces each joint's curve; its true error is that of the machine that the
polynomials drive, solved again. CSV files have the same columns as `bohemia trajectory` writes.
"""


class TrajectoryPanel(Panel):
    """What runs where and when, its plots in a panel of their own, and what is told of it."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._sheet = sheet
        self._axes = review.machine.coordinates
        self._joints = review.machine.joints
        plan = review[Plan]
        self._on = gui.add_checkbox(
            "Show the trajectory", plan.on, hint="In the scene and as plots (hotkey T)"
        )
        answer(desk, self._on, lambda on, client: self._do(client, on=on))
        self._summary = gui.add_html("")
        self._progress = gui.add_progress_bar(0.0, visible=False)
        self._give_up = button(
            desk, "Cancel the distances", lambda _: desk.ask(Distances(on=False))
        )
        self._go_on = button(
            desk, "Find distances to singularities", lambda _: desk.ask(Distances(on=True))
        )
        self._next = button(
            desk, "To the next warning", lambda client: desk.ask(NextWarning(client))
        )
        self._way = WayFolder(desk, sheet)
        self._add_time()
        self._add_limits()
        with gui.add_folder("Polynomials for the joints", expand_by_default=False):
            degrees = (NO_FIT, *map(str, range(1, HIGHEST + 1)))
            self._degree = gui.add_dropdown("Degree", degrees)
            answer(desk, self._degree, self._choose_degree)
            self._fits = gui.add_html("")
        self._save = gui.add_button_group("Save as", KINDS)
        clicked(desk, self._save, self._saved)
        explain(gui, review.machine.text("trajectory"), HELP)
        self._add_window(sheet)
        self._computed: Computed | None = None
        self._measuring = False
        self._moment = Moment(0.0, playing=False, away=False, distance=float("nan"))

    def _add_time(self) -> None:
        gui, desk, plan = self._desk.gui, self._desk, self._sheet.view.review[Plan]
        with gui.add_folder("Time"):
            self._law = gui.add_dropdown("Time law", tuple(LAWS))
            self._duration = gui.add_number(
                "Duration (s)",
                plan.duration,
                min=0.0,
                step=0.1,
                hint="0: the path's own, else at 100 mm/s",
            )
            self._speed = gui.add_number("Speed (mm/s)", plan.speed, min=0.001, step=1.0)
            self._acceleration = gui.add_number(
                "Acceleration (mm/s²)", plan.acceleration, min=0.001, step=1.0
            )
            self._samples = gui.add_number("Samples", plan.samples, min=2, max=MOST_SAMPLES, step=1)
        for typed in (self._duration, self._speed, self._acceleration):
            put_prop(typed, "precision", TYPED)
        answer(desk, self._law, lambda title, client: self._do(client, law=LAWS[title]))
        answer(desk, self._duration, lambda v, client: self._set(client, duration=float(v)))
        answer(desk, self._speed, lambda v, client: self._set(client, speed=float(v)))
        answer(desk, self._acceleration, lambda v, client: self._set(client, acceleration=float(v)))
        answer(desk, self._samples, lambda v, client: self._set(client, samples=round(v)))

    def _add_limits(self) -> None:
        gui, desk = self._desk.gui, self._desk
        unit = "°" if self._joints[0].unit == "rad" else "mm"
        force = "N·mm" if unit == "°" else "N"
        hint = "One number for all actuators, or one for each; empty for none"
        with gui.add_folder("Limits of the actuators", expand_by_default=False):
            self._limits = {
                name: LimitsBox(
                    desk,
                    gui.add_text(title, "", hint=hint),
                    self._joints,
                    title,
                    turning=name != "forces",
                )
                for name, title in (
                    ("rates", f"Rates ({unit}/s)"),
                    ("accelerations", f"Accelerations ({unit}/s²)"),
                    ("forces", f"Forces ({force})"),
                )
            }
            self._wrong = gui.add_html("")
            button(
                desk,
                "Shortest duration that keeps them",
                lambda client: desk.ask(Shortest(client)),
                hint="Rates and accelerations; forces hold the load at any speed",
            )
        self._wrongs: dict[str, str] = {}
        for name, typed in self._limits.items():
            answer(desk, typed.handle, self._typing(name, typed))

    def _add_window(self, sheet: Sheet) -> None:
        gui, desk, plan = self._desk.gui, self._desk, sheet.view.review[Plan]
        self._window = gui.add_panel(visible=plan.on)
        self._window.dock_left()
        self._window.set_width(WIDTH)
        with self._window.add_tab("Along the trajectory"):
            self._plot = Plot(desk, self._pointed)
            self._scrub = gui.add_slider("Time (s)", 0.0, 1.0, 0.001, 0.0)
            put_prop(self._scrub, "precision", 3)
            self._play = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY, hint="Hotkey P")
            self._stop = button(
                desk, "Stop here", lambda client: desk.ask(StopHere(client)), icon=viser.Icon.FLAG
            )
            self._back = button(
                desk,
                "Back to where it was",
                lambda _: desk.ask(LeaveWay()),
                icon=viser.Icon.ARROW_BACK,
            )
            self._pace = gui.add_dropdown("Speed", tuple(PACES), initial_value="1×")
            self._playback = gui.add_dropdown("Playback", tuple(PLAYBACKS))
            self._halts = gui.add_checkbox(
                "Stop where singular", plan.halt, hint="No machine is driven across a singularity"
            )
            self._shown = gui.add_dropdown("Plot", tuple(PLOTS))
        answer(desk, self._halts, lambda on, client: self._do(client, halt=on))
        answer(desk, self._scrub, lambda at, client: desk.ask(Scrub(float(at), client)))
        clicked(desk, self._play, lambda _: desk.ask(Play()))
        answer(desk, self._pace, lambda title, client: self._do(client, pace=PACES[title]))
        answer(
            desk,
            self._playback,
            lambda title, client: self._do(client, playback=PLAYBACKS[title]),
        )
        answer(desk, self._shown, lambda title, client: self._do(client, plot=PLOTS[title]))

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return bool(machine.joints)

    # --- what a person does

    def _set(self, client: viser.ClientHandle | None, **values: Any) -> None:
        """One of the steps of typing a number."""
        self._desk.send(SetPlan(tuple(values.items()), gesture=f"plan {[*values]}"), client)

    def _do(self, client: viser.ClientHandle | None, **values: Any) -> None:
        self._desk.send(SetPlan(tuple(values.items())), client)

    def _typing(self, name: str, typed: LimitsBox) -> Any:
        def changed(_: str, client: viser.ClientHandle | None) -> None:
            self._wrongs.pop(name, None)
            try:
                value = typed.read()
            except InputError as error:
                self._wrongs[name] = str(error)
            else:
                self._set(client, **{name: value})
            wrong = next(iter(self._wrongs.values()), "")
            put_prop(self._wrong, "content", red(wrong) if wrong else "")

        return changed

    def _choose_degree(self, title: str, client: viser.ClientHandle | None) -> None:
        self._do(client, degree=0 if title == NO_FIT else int(title))

    def _pointed(self, t: float, _: float, client: viser.ClientHandle | None) -> None:
        self._desk.ask(Scrub(t, client))

    def _saved(self, client: viser.ClientHandle | None) -> None:
        self._desk.ask(SaveTrajectory(self._save.value.lower(), client))

    # --- what is drawn

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        desk, plan = self._desk, sheet.view.review[Plan]
        put(desk, self._on, plan.on)
        self._way.draw(sheet)
        put(desk, self._law, next(t for t, kind in LAWS.items() if kind == plan.law))
        put(desk, self._duration, plan.duration)
        put(desk, self._speed, plan.speed)
        put(desk, self._acceleration, plan.acceleration)
        put(desk, self._samples, plan.samples)
        trapezoid = plan.law == "trapezoidal"
        put_prop(self._duration, "visible", not trapezoid)
        put_prop(self._speed, "visible", trapezoid)
        put_prop(self._acceleration, "visible", trapezoid)
        for name, typed in self._limits.items():
            if name not in self._wrongs:
                typed.draw(getattr(plan, name))
        put(desk, self._degree, str(plan.degree) if plan.degree else NO_FIT)
        put(desk, self._pace, next((t for t, v in PACES.items() if v == plan.pace), "1×"))
        put(desk, self._playback, next(t for t, v in PLAYBACKS.items() if v == plan.playback))
        put(desk, self._halts, plan.halt)
        put(desk, self._shown, next(t for t, v in PLOTS.items() if v == plan.plot))
        if not plan.on:
            put_prop(self._window, "visible", False)

    def draw_trajectory(self, sheet: Sheet, moved: Moved) -> None:
        plan = sheet.view.review[Plan]
        computed = self._computed = moved.computed
        hint = box("Show the trajectory to have it computed, drawn and plotted.")
        put_prop(self._summary, "content", summary_html(moved) if plan.on else hint)
        put_prop(self._window, "visible", plan.on and not moved.missing)
        there = plan.on and computed is not None and not moved.stale
        put_prop(self._progress, "visible", there and moved.measuring)
        put_prop(self._progress, "value", round(100.0 * moved.share, 1))
        put_prop(self._give_up, "visible", there and moved.measuring)
        put_prop(self._go_on, "visible", there and not moved.measuring and moved.share < 1.0)
        events = () if computed is None else computed.found.events
        put_prop(self._next, "visible", there and bool(events))
        fits = ""
        if plan.degree and there:
            fits = fits_html(moved.fits, moved.fit_trouble, self._axes, self._joints)
        put_prop(self._fits, "content", fits)
        self._way.draw_trajectory(moved)
        self._measuring = moved.measuring
        drawn = None
        if computed is not None:
            drawn = figure(computed, plan.plot, measuring=moved.measuring)
        self._plot.draw(drawn)
        if computed is not None:
            duration = computed.law.duration
            put_prop(self._scrub, "max", math.ceil(duration * 1e3) / 1e3)
            put_prop(self._scrub, "step", duration / STEPS)
        put_prop(self._play, "disabled", not there)
        self._draw_cursor()

    def draw_moment(self, sheet: Sheet, moment: Moment) -> None:
        self._moment = moment
        put(self._desk, self._scrub, round(moment.at, 3))
        playing = moment.playing
        put_prop(self._play, "label", "Pause" if playing else "Play")
        icon = viser.Icon.PLAYER_PAUSE if playing else viser.Icon.PLAYER_PLAY
        put_prop(self._play, "icon", icon)
        put_prop(self._stop, "disabled", not moment.away)
        put_prop(self._back, "disabled", not moment.away)
        self._draw_cursor()

    def _draw_cursor(self) -> None:
        computed, drawn = self._computed, self._plot.figure
        if computed is None or drawn is None or not self._moment.there:
            self._plot.mark("")
            return
        plot = self._sheet.view.review[Plan].plot
        at, measuring = self._moment.at, self._measuring
        self._plot.mark(mark(computed, plot, drawn.axes, at, measuring=measuring))
