"""The Singularities tab: what holds the platform, what is near, where control is lost."""

from __future__ import annotations

from typing import Any

import viser

from app.features.singularities.aspects_panel import AspectsFolder
from app.features.singularities.charts_panel import ChartFolder, ProfileFolder, specs
from app.features.singularities.html import (
    ASPECTS,
    WAYS,
    clearances_html,
    forces_html,
    here_html,
    log_html,
    ways_html,
)
from app.features.singularities.rates_panel import MotionFolder
from app.features.singularities.state import Control, SetControl
from app.features.solutions.atlas import pose_text
from app.review.requests import ChangeDesign, ClearLog, Escape, Swing
from app.widgets.desk import (
    Controlled,
    Desk,
    Elsewhere,
    Moment,
    Panel,
    Sheet,
    answer,
    box,
    button,
    esc,
    explain,
    put,
    put_prop,
)
from kinematics.answers.clearances import Remedy
from kinematics.machine import Machine

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

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        machine = review.machine
        self._desk = desk
        self._sheet = sheet
        self._elsewhere = Elsewhere(gui)
        self._here = gui.add_html(box("Looking …"))
        self._swing = button(desk, "Show the free motion", lambda _: desk.ask(Swing(0)))
        self._swing.visible = False
        self._wrenches = self._switch("Wrench lines", "wrenches", "What holds the platform")
        self._ways = self._switch("Nearest limits", "clearances", "Lines to them in the scene")
        self._clearances = gui.add_html("")
        self._out = gui.add_folder("The ways out", visible=False)
        with self._out:
            self._remedy = gui.add_html("")
            self._escape = button(desk, "Go to that pose", lambda client: desk.ask(Escape(client)))
            self._offers = gui.add_html("")
            self._way = gui.add_dropdown("Change", ("none",), hint="Which of these")
            self._change = button(desk, "Change the design so", self._change_design)
        has_aspects = any(spec.key == ASPECTS for spec in machine.solid_specs)
        self._aspects = AspectsFolder(desk, sheet) if has_aspects else None
        self._chart = ChartFolder(desk, sheet) if specs(sheet) else None
        self._profile = ProfileFolder(desk, sheet) if machine.circles is not None else None
        load = review[Control].load
        with gui.add_folder("Load on the platform", expand_by_default=False):
            self._force = gui.add_vector3(
                "Force (N)", (load[0], load[1], load[2]), step=1.0, hint="At O′, base frame"
            )
            self._moment = gui.add_vector3("Moment (N·mm)", (load[3], load[4], load[5]), step=100.0)
            for handle in (self._force, self._moment):
                answer(desk, handle, self._set_load)
            self._arrow = self._switch("Arrow to drag", "arrow", "The force, in the scene")
            self._on_limbs = self._switch("Forces on the limbs", "forces", "Push or pull, in N")
            self._forces = gui.add_html("")
        self._motion = MotionFolder(desk, sheet)
        with gui.add_folder("What happened on the way", expand_by_default=False):
            self._log = gui.add_html(log_html(()))
            button(desk, "Clear", lambda _: desk.ask(ClearLog()))
        explain(gui, machine.text("singularities"), HELP)

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return bool(machine.measures.specs)

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        control = sheet.view.review[Control]
        put(self._desk, self._wrenches, control.wrenches)
        put(self._desk, self._ways, control.clearances)
        put(self._desk, self._force, control.load[:3])
        put(self._desk, self._moment, control.load[3:])
        put(self._desk, self._arrow, control.arrow)
        put(self._desk, self._on_limbs, control.forces)
        self._motion.draw(sheet)
        for folder in (self._aspects, self._chart, self._profile):
            if folder is not None:
                folder.draw(sheet)

    def draw_solids(self, sheet: Sheet) -> None:
        if self._aspects is not None:
            self._aspects.draw_solids(sheet)

    def draw_moment(self, sheet: Sheet, moment: Moment) -> None:
        self._elsewhere.draw(moment)

    def draw_control(self, sheet: Sheet, controlled: Controlled) -> None:
        self._sheet = sheet
        here = controlled.here
        put_prop(self._here, "content", here_html(controlled))
        swings = here is not None and any(s.motion is not None for s in here.singular)
        put_prop(self._swing, "visible", swings)
        put_prop(self._clearances, "content", clearances_html(here))
        put_prop(self._forces, "content", forces_html(here))
        self._motion.draw_control(controlled)
        self._draw_remedy(None if here is None else here.remedy)
        for folder in (self._aspects, self._chart, self._profile):
            if folder is not None:
                folder.draw_control(controlled)
        put_prop(self._log, "content", log_html(controlled.log))

    def _draw_remedy(self, remedy: Remedy | None) -> None:
        put_prop(self._out, "visible", remedy is not None)
        if remedy is None:
            return
        lines = [esc(remedy.text[:1].upper() + remedy.text[1:])]
        if remedy.nearest is not None:
            lines.append(esc(pose_text(self._sheet.view.review, remedy.nearest.pose)))
        put_prop(self._remedy, "content", box("<br>".join(lines)))
        put_prop(self._escape, "visible", remedy.nearest is not None)
        ways = tuple(f"{n + 1}" for n in range(min(len(remedy.changes), WAYS)))
        put_prop(self._offers, "content", ways_html(remedy))
        put_prop(self._way, "visible", bool(ways))
        put_prop(self._change, "visible", bool(ways))
        if ways and tuple(self._way.options) != ways:
            self._way.options = ways

    def _switch(self, label: str, name: str, hint: str) -> viser.GuiInputHandle[bool]:
        made = self._desk.gui.add_checkbox(
            label, getattr(self._sheet.view.review[Control], name), hint=hint
        )
        answer(self._desk, made, lambda on, client: self._desk.send(SetControl(name, on), client))
        return made

    def _change_design(self, client: viser.ClientHandle | None) -> None:
        options = tuple(self._way.options)
        if self._way.value in options:
            self._desk.ask(ChangeDesign(options.index(self._way.value), client))

    def _set_load(self, _: object, client: viser.ClientHandle | None) -> None:
        load = (*self._force.value, *self._moment.value)
        self._desk.send(SetControl("load", tuple(float(v) for v in load)), client)
