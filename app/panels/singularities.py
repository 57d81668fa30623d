"""The Singularities tab: what holds the platform, what is near, where control is lost."""

from __future__ import annotations

import math
import time

import numpy as np
import viser

from app import painting, palette
from app.atlas import pose_text
from app.changes import Fade, Place, SetControl, Show
from app.controller import Here
from app.panels import loci
from app.panels.desk import (
    Controlled,
    Desk,
    Logged,
    Panel,
    Sheet,
    answer,
    box,
    button,
    chip,
    clicked,
    esc,
    explain,
    put,
    put_prop,
    red,
    tone,
    volume_text,
)
from app.panels.plots import Plot
from app.requests import (
    ChangeDesign,
    ClearLog,
    Escape,
    FindFree,
    GoToFree,
    SaveLoci,
    Swing,
)
from app.worker import Built
from kinematics.mechanism import Design, Mechanism
from kinematics.motion import Statics
from kinematics.singularities import Clearance, LocusSpec, Measure, Remedy, Singularity

ASPECTS = "aspects"
NONE = "Nothing"
LISTED = 8  # pieces that the page lists
TOLD = 9  # clearances
LINES = 20  # of the log
WAYS = 5  # in which the design may change

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
        kind, design = review.mechanism, review.design
        self._desk = desk
        self._sheet = sheet
        self._controlled: Controlled | None = None
        self._here = gui.add_html(box("Looking …"))
        self._swing = button(desk, "Show the free motion", lambda _: desk.ask(Swing(0)))
        self._swing.visible = False
        self._wrenches = self._switch("Wrench lines", "wrenches", "What holds the platform")
        self._ways = self._switch("Nearest limits", "clearances", "Lines to them in the scene")
        self._clearances = gui.add_html("")
        self._out = gui.add_folder("The ways out", visible=False)
        with self._out:
            self._remedy = gui.add_html("")
            self._escape = button(
                desk, "Go to the nearest reachable pose", lambda client: desk.ask(Escape(client))
            )
            self._offers = gui.add_html("")
            self._way = gui.add_dropdown("Change", (NONE,), hint="Which of these")
            self._change = button(desk, "Change the design so", self._change_design)
        self._measures = {m.title: m for m in kind.measures(design)}
        # What lies in the plane of a section is drawn there.
        charts = [spec for spec in kind.locus_specs(design) if spec.key != "section"]
        self._specs = {spec.title: spec for spec in charts}
        self._solid = next((s for s in kind.solids(design) if s.key == ASPECTS), None)
        if self._solid is not None:
            self._offer_aspects(sheet)
            self._offer_ball()
        if self._specs:
            self._offer_curves()
        self._offer_load(sheet)
        with gui.add_folder("What happened on the way", expand_by_default=False):
            self._log = gui.add_html(_log(()))
            button(desk, "Clear", lambda _: desk.ask(ClearLog()))
        explain(gui, kind.about("singularities"), HELP)

    @staticmethod
    def serves(kind: Mechanism, design: Design) -> bool:
        return bool(kind.measures(design))

    # --- what there is

    def _switch(self, label: str, name: str, hint: str) -> viser.GuiInputHandle[bool]:
        made = self._desk.gui.add_checkbox(
            label, getattr(self._sheet.view.review.control, name), hint=hint
        )
        answer(self._desk, made, lambda on, client: self._desk.send(SetControl(name, on), client))
        return made

    def _offer_aspects(self, sheet: Sheet) -> None:
        gui, desk, review = self._desk.gui, self._desk, sheet.view.review
        with gui.add_folder("Aspects of the present mode"):
            shown = review.shown(ASPECTS)
            self._aspects = gui.add_checkbox("Show", shown is not None, hint="Hotkey A")
            answer(desk, self._aspects, lambda on, client: desk.send(Show(ASPECTS, on), client))
            self._locus = self._switch("Singular surface", "locus", "Where control is lost")
            self._opacity = gui.add_slider(
                "Opacity", 0.05, 1.0, 0.05, 0.5 if shown is None else shown.opacity
            )
            answer(
                desk,
                self._opacity,
                lambda value, client: desk.send(Fade((ASPECTS,), value), client),
            )
            self._shade = gui.add_dropdown(
                "Colour by",
                (NONE, *self._measures),
                initial_value=self._title(review.control.shade),
                hint="Of the present mode, on the aspects and on the workspace",
            )
            answer(desk, self._shade, self._choose_shade)
            self._legend = gui.add_html("")
            self._pieces = gui.add_html("")

    def _offer_ball(self) -> None:
        gui, desk = self._desk.gui, self._desk
        with gui.add_folder("Largest ball without a singularity"):
            about = gui.add_checkbox(
                "About the platform", True, hint="Otherwise wherever the most room is"
            )
            button(desk, "Find the ball", lambda client: desk.ask(FindFree(about.value, client)))
            self._ball = gui.add_html("")
            self._go = button(
                desk, "Platform to its centre", lambda client: desk.ask(GoToFree(client))
            )
            self._hide = button(desk, "Hide it", lambda _: desk.ask(FindFree(None)))
            self._go.visible = self._hide.visible = False

    def _offer_curves(self) -> None:
        gui, desk = self._desk.gui, self._desk
        with gui.add_folder("Singular curves"):
            self._chart = gui.add_dropdown("Chart", (NONE, *self._specs))
            answer(desk, self._chart, self._choose_chart)
            self._plot = Plot(desk, self._pointed)
            self._plotted: object = None
            self._curves = gui.add_html("")
            self._save = gui.add_button_group("Save as", ("CSV", "SVG"))
            clicked(
                desk,
                self._save,
                lambda client: desk.ask(SaveLoci(self._save.value.lower(), client)),
            )

    def _offer_load(self, sheet: Sheet) -> None:
        gui, desk, load = self._desk.gui, self._desk, sheet.view.review.control.load
        with gui.add_folder("Load on the platform", expand_by_default=False):
            self._force = gui.add_vector3(
                "Force (N)", (load[0], load[1], load[2]), step=1.0, hint="At O′, base frame"
            )
            self._moment = gui.add_vector3("Moment (N·mm)", (load[3], load[4], load[5]), step=100.0)
            for handle in (self._force, self._moment):
                answer(desk, handle, self._set_load)
            self._forces = gui.add_html("")

    # --- drawing

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        review = sheet.view.review
        control = review.control
        put(self._desk, self._wrenches, control.wrenches)
        put(self._desk, self._ways, control.clearances)
        put(self._desk, self._force, control.load[:3])
        put(self._desk, self._moment, control.load[3:])
        if self._solid is not None:
            shown = review.shown(ASPECTS)
            put(self._desk, self._aspects, shown is not None)
            if shown is not None:
                put(self._desk, self._opacity, shown.opacity)
            put(self._desk, self._locus, control.locus)
            put(self._desk, self._shade, self._title(control.shade))
            self.draw_solids(sheet)
        if self._specs:
            titles = {spec.key: title for title, spec in self._specs.items()}
            put(self._desk, self._chart, titles.get(control.chart, NONE))
            self._draw_cross()

    def draw_solids(self, sheet: Sheet) -> None:
        if self._solid is not None:
            put_prop(self._pieces, "content", _pieces(sheet))

    def draw_control(self, sheet: Sheet, controlled: Controlled) -> None:
        self._sheet, self._controlled = sheet, controlled
        here = controlled.here
        put_prop(self._here, "content", _here(controlled))
        swings = here is not None and any(s.motion is not None for s in here.singular)
        put_prop(self._swing, "visible", swings)
        put_prop(self._clearances, "content", _clearances(here))
        put_prop(self._forces, "content", _forces(None if here is None else here.statics))
        self._draw_remedy(None if here is None else here.remedy)
        if self._solid is not None:
            put_prop(self._legend, "content", self._scale(controlled))
            self._draw_ball(controlled)
        if self._specs:
            self._draw_curves(sheet, controlled)
        put_prop(self._log, "content", _log(controlled.log))

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
        put_prop(self._offers, "content", _ways(remedy))
        put_prop(self._way, "visible", bool(ways))
        put_prop(self._change, "visible", bool(ways))
        if ways and tuple(self._way.options) != ways:
            self._way.options = ways

    def _draw_ball(self, controlled: Controlled) -> None:
        ball = controlled.ball
        text = "Seeking …" if controlled.seeking else ""
        if ball is not None:
            x, y, z = (f"{v:.1f}".replace("-", "−") for v in ball.center)
            text = f"Radius <b>{ball.radius:.2f} mm</b> about {x}, {y}, {z} mm"
        put_prop(self._ball, "content", box(text) if text else "")
        put_prop(self._go, "visible", ball is not None)
        put_prop(self._hide, "visible", ball is not None)

    def _draw_curves(self, sheet: Sheet, controlled: Controlled) -> None:
        spec, curves = self._spec(sheet), controlled.curves
        put_prop(self._save, "visible", curves is not None)
        if spec is None:
            self._plot.draw(None)
            self._plot.mark("")
            put_prop(self._curves, "content", "")
            return
        if curves is None:
            if self._plotted is None:
                put_prop(self._curves, "content", box("Tracing the curves …"))
            return
        if curves is not self._plotted:
            self._plotted = curves
            self._plot.draw(loci.figure(spec, curves))
            worst = float(curves.residual.max(initial=0.0))
            size = f"{math.degrees(worst):.0e}°" if spec.units[0] == "rad" else f"{worst:.0e} mm"
            count = len(curves.kinds)
            put_prop(
                self._curves,
                "content",
                box(
                    f"{count} curve{'' if count == 1 else 's'}, every point exact to {size}"
                    if count
                    else "No singularity in this chart."
                ),
            )
        self._draw_cross()

    def _draw_cross(self) -> None:
        spec, figure = self._spec(self._sheet), self._plot.figure
        if spec is None or figure is None:
            return
        at = _chart_place(self._sheet, spec)
        self._plot.mark("" if at is None else loci.mark(spec, figure.axes, at))

    def _scale(self, controlled: Controlled) -> str:
        shade = self._sheet.view.review.control.shade
        measure = next((m for m in self._measures.values() if m.key == shade), None)
        if measure is None:
            return ""
        if controlled.scale is None:
            return box(f"{esc(measure.title)}: shown when aspects or workspace are on display")
        return box(_legend(measure, controlled.scale))

    # --- what a person asks for

    def _title(self, key: str) -> str:
        return next((title for title, m in self._measures.items() if m.key == key), NONE)

    def _spec(self, sheet: Sheet) -> LocusSpec | None:
        chart = sheet.view.review.control.chart
        return next((spec for spec in self._specs.values() if spec.key == chart), None)

    def _choose_shade(self, title: str, client: viser.ClientHandle | None) -> None:
        key = "" if title == NONE else self._measures[title].key
        self._desk.send(SetControl("shade", key), client)

    def _choose_chart(self, title: str, client: viser.ClientHandle | None) -> None:
        self._plotted = None
        key = "" if title == NONE else self._specs[title].key
        self._desk.send(SetControl("chart", key), client)

    def _change_design(self, client: viser.ClientHandle | None) -> None:
        options = tuple(self._way.options)
        if self._way.value in options:
            self._desk.ask(ChangeDesign(options.index(self._way.value), client))

    def _set_load(self, _: object, client: viser.ClientHandle | None) -> None:
        load = (*self._force.value, *self._moment.value)
        self._desk.send(SetControl("load", tuple(float(v) for v in load)), client)

    def _pointed(self, x: float, y: float, client: viser.ClientHandle | None) -> None:
        spec = self._spec(self._sheet)
        if spec is None:
            return
        review = self._sheet.view.review
        pose = list(review.pose)
        axes = review.mechanism.pose_coordinates(review.design)
        for symbol, value in zip(spec.axes, loci.from_units(spec, x, y), strict=True):
            index = next((n for n, c in enumerate(axes) if c.symbol == symbol), None)
            if index is None:
                return
            pose[index] = value
        self._desk.send(Place(tuple(pose), gesture=f"chart {spec.key}"), client)


def _chart_place(sheet: Sheet, spec: LocusSpec) -> tuple[float, float] | None:
    """Where the machine stands in a chart; None if it has not these coordinates."""
    review = sheet.view.review
    known = {
        c.symbol: v
        for c, v in zip(review.mechanism.pose_coordinates(review.design), review.pose, strict=True)
    }
    if not all(symbol in known for symbol in spec.axes):
        return None
    return known[spec.axes[0]], known[spec.axes[1]]


# --- HTML ----------------------------------------------------------------------------------


def _here(controlled: Controlled) -> str:
    here = controlled.here
    if controlled.trouble:
        return red(controlled.trouble)
    if here is None:
        return box("Looking …")
    parts = [_card(s) for s in here.singular]
    if here.wrenches is None:
        parts.append("The limbs do not close here, so nothing holds the platform.")
    elif here.remedy is not None:
        parts.append("This pose is out of reach; the ways out are below.")
    elif not here.singular:
        parts.append(
            f'<div style="border-left:4px solid {tone("good")};padding-left:.6em">'
            "<b>The platform is held</b>: the wrenches are independent here.</div>"
        )
    rows = "".join(_measure(m, v) for m, v in here.measures if math.isfinite(v))
    if rows:
        parts.append(
            f'<table style="width:100%;border-spacing:0 2px;margin-top:.4em">{rows}</table>'
        )
    return box("".join(parts))


def _card(singular: Singularity) -> str:
    color = palette.BEYOND
    return (
        f'<div style="border-left:4px solid {color};padding-left:.6em;margin-bottom:.4em">'
        f'<b style="color:{color}">{esc(singular.kind.capitalize())} singularity</b><br>'
        f'{esc(singular.text)}<br><span style="opacity:.8">{esc(singular.cause)}</span></div>'
    )


def _measure(measure: Measure, value: float) -> str:
    unit = f" {measure.unit}" if measure.unit else ""
    bar = ""
    low, high = measure.limits
    if low is not None and high is not None:
        share = 100.0 * min(max((value - low) / (high - low), 0.0), 1.0)
        bar = (
            '<div style="height:.5em;border-radius:3px;background:rgba(128,138,150,.25)">'
            f'<div style="height:100%;width:{share:.1f}%;border-radius:3px;'
            f'background:{palette.WORKSPACE}"></div></div>'
        )
    return (
        f"<tr><td>{esc(measure.title)}</td>"
        f'<td style="text-align:right;padding:0 .6em;white-space:nowrap;'
        f'font-variant-numeric:tabular-nums">{value:.3g}{esc(unit)}</td>'
        f'<td style="width:36%">{bar}</td></tr>'
    )


_WHAT = {
    "parallel": "parallel singularity",
    "constraint": "constraint singularity",
    "boundary": "end of the workspace",
    "stroke": "end of a stroke",
    "mode": "change of mode",
}
_ENDS = {"rho_min": " (ρ min)", "rho_max": " (ρ max)", "link": ""}


def _clearances(here: Here | None) -> str:
    if here is None or not here.clearances:
        return ""
    rows = "".join(_clearance(c) for c in here.clearances[:TOLD])
    return box(f'<table style="width:100%;border-spacing:0 1px">{rows}</table>')


def _clearance(way: Clearance) -> str:
    lost = way.kind in ("parallel", "constraint")
    mark = chip(
        palette.BEYOND if lost else palette.limb_color(way.limb) if way.limb else palette.WORKSPACE
    )
    whose = f"limb {way.limb}, " if way.limb else ""
    what = f"{whose}{_WHAT[way.kind]}{_ENDS.get(way.bound, '')}"
    return (
        f'<tr title="{esc(way.text)}"><td>{mark}{esc(what)}</td>'
        f'<td style="text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums">'
        f"{way.distance:.2f} mm</td></tr>".replace(">-", ">−")
    )


def _ways(remedy: Remedy) -> str:
    if not remedy.changes:
        return ""
    rows = "".join(
        f'<tr><td style="vertical-align:top;padding-right:.6em">{n + 1}</td>'
        f"<td>{'<br>'.join(esc(change.text) for change in way)}</td></tr>"
        for n, way in enumerate(remedy.changes[:WAYS])
    )
    return box(f"Or change the design, the pose as it is:<table>{rows}</table>")


def _forces(statics: Statics | None) -> str:
    if statics is None:
        return ""
    values = np.asarray(statics.forces)
    if not np.isfinite(values).all():
        return red("No finite forces hold this load here.")
    largest = max(float(np.abs(values).max()), 1e-12)
    rows = []
    for name, value in zip(statics.names, values.tolist(), strict=True):
        color = palette.limb_color(name.limb) if name.limb else palette.STEEL
        half = 50.0 * abs(value) / largest
        left = 50.0 if value >= 0 else 50.0 - half
        unit = "N" if name.kind == "actuation" else ""
        rows.append(
            f"<tr><td>{chip(color)}{esc(name.symbol)}</td>"
            f'<td style="text-align:right;padding:0 .6em;white-space:nowrap;'
            f'font-variant-numeric:tabular-nums">{value:.4g}'.replace("-", "−")
            + f' {unit}</td><td style="width:45%"><div style="position:relative;height:.55em;'
            'background:rgba(128,138,150,.18);border-radius:3px">'
            f'<div style="position:absolute;left:{left:.1f}%;width:{half:.1f}%;top:0;bottom:0;'
            f'background:{color}"></div><div style="position:absolute;left:50%;top:-2px;'
            'bottom:-2px;width:1px;background:currentColor"></div></div></td></tr>'
        )
    return box(
        f'<table style="width:100%;border-spacing:0 2px">{"".join(rows)}</table>'
        '<span style="opacity:.75">positive: the limb pushes the platform</span>'
    )


def _pieces(sheet: Sheet) -> str:
    built: Built | None = sheet.built.get(ASPECTS)
    if sheet.view.review.shown(ASPECTS) is None or built is None:
        return ""
    solid = built.solid
    if not solid.pieces:
        return box("The workspace of this mode is empty at this orientation.")
    point = np.linalg.inv(built.wish.placement) @ sheet.view.platform[:, 3]
    here = solid.piece_at(point[:3])
    colors = painting.piece_colors([piece.sign for piece in solid.pieces])
    rows = []
    for n, (piece, color) in enumerate(zip(solid.pieces, colors, strict=True)):
        if n >= LISTED and n != here:
            continue
        you = " <b>you are in this one</b>" if n == here else ""
        sign = {1: "det &gt; 0", -1: "det &lt; 0", 0: ""}[piece.sign]
        rows.append(
            f"<tr><td>{chip(color)}{n + 1}</td><td>{volume_text(piece.volume)}</td>"
            f'<td style="opacity:.75">{sign}</td><td>{you}</td></tr>'
        )
    more = len(solid.pieces) - len(rows)
    tail = f"<br>and {more} smaller ones" if more > 0 else ""
    exact = (
        f"; singular surface exact to {solid.locus_residual:.0e} mm"
        if solid.locus_residual is not None
        else ""
    )
    return box(
        f'<table style="width:100%">{"".join(rows)}</table>{tail}'
        f'<div style="opacity:.75">together {volume_text(solid.volume, solid.volume_error)}'
        f"{exact}. Slices at this orientation: pieces may be joined through others.</div>"
    )


def _legend(measure: Measure, steps: painting.Scale) -> str:
    cells = "".join(
        f'<td style="background:{steps.color(n)};height:.7em"></td>' for n in range(painting.STEPS)
    )
    low, high = float(steps.edges[0]), float(steps.edges[-1])
    unit = f" {measure.unit}" if measure.unit else ""
    return (
        f'{esc(measure.title)}<table style="width:100%;border-spacing:0"><tr>{cells}</tr></table>'
        f'<div style="display:flex;justify-content:space-between"><span>{low:.3g}{esc(unit)}</span>'
        f"<span>{high:.3g}{esc(unit)}</span></div>"
    )


def _log(lines: tuple[Logged, ...]) -> str:
    if not lines:
        return box('<span style="opacity:.75">Nothing yet.</span>')
    rows = []
    for line in lines[:LINES]:
        at = time.strftime("%H:%M:%S", time.localtime(line.at))
        rows.append(f'<div><span style="opacity:.6">{at}</span> {esc(line.text)}</div>')
    return box("".join(rows))
