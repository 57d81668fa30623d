"""The Singularities tab: what holds the platform, what is near, where control is lost."""

from __future__ import annotations

from functools import partial
from typing import Any

from app.features.singularities import html
from app.features.singularities.charts_panel import ChartFolder, ProfileFolder, specs
from app.features.singularities.compute import Controlled
from app.features.singularities.part import ControlPart
from app.features.singularities.state import Control, SetControl
from app.features.workspace.compute import Solids
from app.features.workspace.state import ASPECTS, Fade, Show, Workspace
from app.review.changes import Change
from app.review.state import Review
from app.review.units import page_unit, pose_text, sentence
from app.review.view import Moment
from app.scene.painting import Scale
from app.widgets.boxes import Typed, rates_box
from app.widgets.desk import Client, Group, Panel, Sheet, explain
from app.widgets.header import Elsewhere
from app.widgets.texts import box, esc
from kinematics.answers.clearances import Remedy
from kinematics.machine import Machine

NOTHING = "Nothing"

HELP = """
**Clearance** is how far the platform may move at its present orientation until it meets a
singularity, the boundary of the workspace, the end of a stroke or the change of a limb's mode.
**Wrench lines** are the lines along which limbs push the platform with their actuators locked, in
the limbs' colours; a two-headed arrow is a couple. Where they become dependent the platform is
free to move a little: *Show the free motion* swings a ghost of it, larger than life.

**Aspects** are the parts of the workspace of one mode between its **singular surfaces**
(red-orange): within one of them the machine keeps control. These are slices, at one orientation,
of the aspects, which live in all coordinates together: two pieces that are apart here may be joined
through other orientations.

The **curves** show where control is lost as two coordinates vary and all others stay. Point at
them to put the machine there.
"""


class SingularitiesPanel(Panel):
    """Control at the present place, around it, and all over the workspace of the mode."""

    TITLE = "Singularities"

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return bool(machine.measures.specs)

    def build(self, review: Review) -> None:
        gui, desk, sheet, machine = self.gui, self.desk, self.sheet, review.machine
        part = self._part = desk.part(ControlPart)
        self._elsewhere = Elsewhere(gui)
        self._here = gui.add_html("")
        self._swing = self.asks("Show the free motion", part.swing, 0, visible=False)
        self._clearances = gui.add_html("")
        self.switch("Nearest limits", Control, "clearances", "Lines to them in the scene")
        self.switch("Wrench lines", Control, "wrenches", "What holds the platform")
        self._out = gui.add_folder("The ways out", visible=False)
        with self._out:
            self._remedy = gui.add_html("")
            self._escape = self.asks_for("Go to that pose", part.escape)
            self._offers = gui.add_html("")
            self._way = gui.add_dropdown("Change", ("none",), hint="Which of these")
            self._change = self.button("Change the design so", self._change_design)
        if any(spec.key == ASPECTS for spec in machine.solid_specs):
            self.groups.append(AspectsFolder(desk, sheet))
        with self.folder("How well it is held"):
            self._measures = gui.add_html("")
        if specs(machine):
            self.groups.append(ChartFolder(desk, sheet))
        if machine.circles is not None:
            self.groups.append(ProfileFolder(desk, sheet))
        self.groups += [LoadFolder(desk, sheet), MotionFolder(desk, sheet)]
        with self.folder("What happened on the way", open=False):
            self._log = gui.add_html(html.log_html(()))
            self.asks("Clear", part.clear_log)
        explain(gui, machine.text("singularities"), HELP)

    def told(self, sheet: Sheet, news: Any) -> None:
        super().told(sheet, news)
        match news:
            case Moment(away=away):
                self._elsewhere.draw(away)
            case Controlled(here=here, stale=stale):
                self.say(self._here, html.here_html(news), stale)
                swings = here is not None and any(s.motion is not None for s in here.singular)
                self.see(swings, self._swing)
                self.say(self._measures, html.measures_html(here), stale)
                self.say(self._clearances, html.clearances_html(here), stale)
                self._draw_remedy(None if here is None else here.remedy)
                self.say(self._log, html.log_html(news.log))

    def _draw_remedy(self, remedy: Remedy | None) -> None:
        self.see(remedy is not None, self._out)
        if remedy is None:
            return
        lines = [esc(sentence(remedy.text))]
        if remedy.nearest is not None:
            lines.append(esc(pose_text(self.review.machine.coordinates, remedy.nearest.pose)))
        self.say(self._remedy, box("<br>".join(lines)))
        self.see(remedy.nearest is not None, self._escape)
        ways = tuple(f"{n + 1}" for n in range(min(len(remedy.changes), html.WAYS)))
        self.say(self._offers, html.ways_html(remedy))
        self.see(bool(ways), self._way, self._change)
        if ways and tuple(self._way.options) != ways:
            self._way.options = ways

    def _change_design(self, client: Client) -> None:
        options = tuple(self._way.options)
        if self._way.value in options:
            self.desk.ask(self._part.change_design, options.index(self._way.value), client)


class AspectsFolder(Group):
    """Whether and how aspects are shown, what they are, and the largest ball within them."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        part = desk.part(ControlPart)
        measures = {m.title: m.key for m in review.machine.measures.specs}
        with self.folder("Aspects of the present mode", "slices at this orientation"):
            self._pieces = gui.add_html("")
            command = "Aspects", "Show or hide the aspects of the present mode", "A"
            self.toggle(command, _shown, partial(Show, ASPECTS))
            show = gui.add_checkbox("Show", False, hint="Hotkey A")
            self.bind(show, _shown, partial(Show, ASPECTS))
            self.switch("Singular surface", Control, "locus", "Where control is lost")
            self.bind(
                gui.add_slider("Opacity", 0.05, 1.0, 0.05, 0.5), _opacity, partial(Fade, (ASPECTS,))
            )
            hint = "Of the present mode, on the aspects and on the workspace"
            self.menu("Colour by", {NOTHING: ""} | measures, Control, "shade", hint=hint)
            self._legend = gui.add_html("")
        # A ball is one of places.
        axes = {c.key for c in review.machine.coordinates}
        with gui.add_folder("Largest ball without a singularity", visible={"x", "y", "z"} <= axes):
            about = gui.add_checkbox(
                "About the platform", True, hint="Otherwise wherever the most room is"
            )
            self.button("Find the ball", lambda _: desk.ask(part.find_free, about.value))
            self._ball = gui.add_html("")
            self._go = self.asks_for("Platform to its centre", part.go_to_free, visible=False)
            self._hide = self.asks("Hide it", part.forget_free, visible=False)
        self._solids = Solids((), {}, {}, None)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        self.say(self._pieces, html.pieces_html(self.review, self._solids))

    def told(self, sheet: Sheet, news: Any) -> None:
        match news:
            case Solids(scale=scale):
                self._solids = news
                self.say(self._pieces, html.pieces_html(self.review, news))
                self.say(self._legend, self._scale(scale))
            case Controlled(ball=ball, seeking=seeking):
                text = "Seeking …" if seeking else ""
                if ball is not None:
                    x, y, z = (f"{v:.1f}".replace("-", "−") for v in ball.center)
                    text = f"Radius <b>{ball.radius:.2f} mm</b> about {x}, {y}, {z} mm"
                self.say(self._ball, box(text) if text else "")
                self.see(ball is not None, self._go, self._hide)

    def _scale(self, scale: Scale | None) -> str:
        shade = self.review[Control].shade
        specs = self.review.machine.measures.specs
        measure = next((m for m in specs if m.key == shade), None)
        if measure is None:
            return ""
        if scale is None:
            return box(f"{esc(measure.title)}: shown when aspects or workspace are on display")
        return box(html.legend_html(measure, scale))


class LoadFolder(Group):
    """The load on the platform, and what the limbs push and pull under it."""

    def build(self, review: Review) -> None:
        gui = self.gui
        zero = (0.0, 0.0, 0.0)
        with self.folder("Load on the platform", open=False):
            self._force = gui.add_vector3("Force (N)", zero, step=1.0, hint="At O′, base frame")
            self._moment = gui.add_vector3("Moment (N·mm)", zero, step=100.0)
            self.bind(self._force, lambda review: review[Control].load[:3], self._load)
            self.bind(self._moment, lambda review: review[Control].load[3:], self._load)
            self.switch("Arrow to drag", Control, "arrow", "The force, in the scene")
            self.switch("Forces on the limbs", Control, "forces", "Push or pull, in N")
            self._forces = gui.add_html("")

    def _load(self, _: object) -> Change:
        load = (*self._force.value, *self._moment.value)
        return SetControl("load", tuple(float(v) for v in load))

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Controlled):
            self.say(self._forces, html.forces_html(news.here), news.stale)


class MotionFolder(Group):
    """Rates and accelerations of the pose coordinates, and what they ask of the actuators."""

    def build(self, review: Review) -> None:
        gui, axes = self.gui, review.machine.coordinates
        units = ", ".join(f"{c.symbol} ({page_unit(c)}/s)" for c in axes)
        self._boxes: dict[str, Typed] = {}
        with self.folder("Velocity and acceleration", open=False):
            for label, name, hint in (
                ("Rates", "rates", f"{units}, with commas"),
                ("Accelerations", "accelerations", "Likewise, by s²; empty for none"),
            ):
                typed = rates_box(self.desk, gui.add_text(label, "", hint=hint), axes, name)
                self.answer(typed.handle, partial(self._set, name, typed))
                self._boxes[name] = typed
            self._told = gui.add_html("")

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        for name, typed in self._boxes.items():
            typed.draw(getattr(self.review[Control], name))

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Controlled):
            self.say(self._told, html.motion_html(news.here), news.stale)

    def _set(self, name: str, typed: Typed, _: str, client: Client) -> None:
        self.desk.send(SetControl(name, typed.read()), client)


def _shown(review: Review) -> bool:
    return review[Workspace].shown(ASPECTS) is not None


def _opacity(review: Review) -> float:
    shown = review[Workspace].shown(ASPECTS)
    return 0.5 if shown is None else shown.opacity
