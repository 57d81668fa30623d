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
from app.language import tr
from app.review.changes import Change
from app.review.state import Review
from app.review.units import page_unit, pose_text, sentence, tenths
from app.review.view import Moment
from app.scene.painting import Scale
from app.widgets.boxes import Typed, rates_box
from app.widgets.desk import Client, Group, Panel, Sheet, explain
from app.widgets.header import Elsewhere
from app.widgets.texts import box, esc
from kinematics.answers.clearances import Remedy
from kinematics.machine import Machine


class SingularitiesPanel(Panel):
    """Control at the present place, around it, and all over the workspace of the mode."""

    TITLE = "singularities.tab"

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return bool(machine.measures.specs)

    def build(self, review: Review) -> None:
        gui, desk, sheet, machine = self.gui, self.desk, self.sheet, review.machine
        part = self._part = desk.part(ControlPart)
        self._elsewhere = Elsewhere(gui)
        self._here = gui.add_html("")
        self._swing = self.asks("singularities.swing", part.swing, 0, visible=False)
        self._clearances = gui.add_html("")
        self.switch("singularities.clearances", Control, "clearances")
        self.switch("singularities.wrenches", Control, "wrenches")
        self._out = gui.add_folder(tr("singularities.ways_out"), visible=False)
        with self._out:
            self._remedy = gui.add_html("")
            self._escape = self.asks_for("singularities.escape", part.escape)
            self._offers = gui.add_html("")
            self._way = gui.add_dropdown(
                tr("singularities.way"), (tr("page.none"),), hint=tr("singularities.way_hint")
            )
            self._change = self.button("singularities.change_design", self._change_design)
        if any(spec.key == ASPECTS for spec in machine.solid_specs):
            self.groups.append(AspectsFolder(desk, sheet))
        with self.folder("singularities.held"):
            self._measures = gui.add_html("")
        if specs(machine):
            self.groups.append(ChartFolder(desk, sheet))
        if machine.circles is not None:
            self.groups.append(ProfileFolder(desk, sheet))
        self.groups += [LoadFolder(desk, sheet), MotionFolder(desk, sheet)]
        with self.folder("singularities.log", open=False):
            self._log = gui.add_html(html.log_html(()))
            self.asks("singularities.clear", part.clear_log)
        explain(gui, "singularities", machine)

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
        with self.folder("singularities.aspects"):
            self._pieces = gui.add_html("")
            self.toggle(("aspects", "A"), _shown, partial(Show, ASPECTS))
            self.bind(self.tick("singularities.show"), _shown, partial(Show, ASPECTS))
            self.switch("singularities.locus", Control, "locus")
            slider = gui.add_slider(tr("workspace.opacity"), 0.05, 1.0, 0.05, 0.5)
            self.bind(slider, _opacity, partial(Fade, (ASPECTS,)))
            self.menu("singularities.shade", {tr("page.nothing"): ""} | measures, Control, "shade")
            self._legend = gui.add_html("")
        # A ball is one of places.
        axes = {c.key for c in review.machine.coordinates}
        with gui.add_folder(tr("singularities.free"), visible={"x", "y", "z"} <= axes):
            about = self.tick("singularities.about_platform", True)
            self.button("singularities.find_free", lambda _: desk.ask(part.find_free, about.value))
            self._ball = gui.add_html("")
            self._go = self.asks_for("singularities.to_free", part.go_to_free, visible=False)
            self._hide = self.asks("singularities.hide", part.forget_free, visible=False)
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
                text = tr("singularities.seeking") if seeking else ""
                if ball is not None:
                    center = ", ".join(map(tenths, ball.center))
                    text = tr("singularities.ball", radius=ball.radius, center=center)
                self.say(self._ball, box(text) if text else "")
                self.see(ball is not None, self._go, self._hide)

    def _scale(self, scale: Scale | None) -> str:
        shade = self.review[Control].shade
        specs = self.review.machine.measures.specs
        measure = next((m for m in specs if m.key == shade), None)
        if measure is None:
            return ""
        if scale is None:
            return box(tr("singularities.scale_later", measure=esc(measure.title)))
        return box(html.legend_html(measure, scale))


class LoadFolder(Group):
    """The load on the platform, and what the limbs push and pull under it."""

    def build(self, review: Review) -> None:
        gui = self.gui
        zero = (0.0, 0.0, 0.0)
        with self.folder("singularities.load", open=False):
            self._force = gui.add_vector3(
                tr("singularities.force"), zero, step=1.0, hint=tr("singularities.force_hint")
            )
            self._moment = gui.add_vector3(tr("singularities.moment"), zero, step=100.0)
            self.bind(self._force, lambda review: review[Control].load[:3], self._load)
            self.bind(self._moment, lambda review: review[Control].load[3:], self._load)
            self.switch("singularities.arrow", Control, "arrow")
            self.switch("singularities.forces", Control, "forces")
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
        with self.folder("singularities.motion", open=False):
            for name, label, hint in (
                ("rates", tr("singularities.rates"), tr("singularities.rates_hint", units=units)),
                (
                    "accelerations",
                    tr("singularities.accelerations"),
                    tr("singularities.accelerations_hint"),
                ),
            ):
                text = gui.add_text(label, "", hint=hint)
                typed = rates_box(self.desk, text, axes, label.lower())
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
