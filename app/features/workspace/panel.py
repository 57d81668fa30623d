"""The Workspace tab: the workspace solid and the limbs' vertex spaces."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app.features.singularities.html import ASPECTS
from app.features.solutions.atlas import number as signed
from app.features.workspace.compute import inside
from app.features.workspace.regions_panel import RegionsFolder
from app.features.workspace.state import ChooseModes, ChooseSurface, Fade, Show, Workspace
from app.jobs.worker import Built
from app.review.modes import matching, page_mode
from app.review.requests import Forget, GoToBall, Inscribe
from app.scene import palette
from app.terminal.tables import surface_text
from app.widgets.desk import (
    Desk,
    Laying,
    Panel,
    Sections,
    Sheet,
    answer,
    box,
    button,
    chip,
    esc,
    explain,
    put,
    put_prop,
    red,
    tone,
    volume_text,
)
from kinematics.answers.sections import Volume
from kinematics.facets.solids import SolidSpec, SurfaceKind
from kinematics.machine import Machine

ALL, CURRENT, CHOSEN = "All working modes together", "The current working mode", "A chosen set"
MADE_OF: dict[SurfaceKind, str] = {"facets": "Facets", "true": "The true surface"}

HELP = """
Its solid is **made of** facets that are right on the average, or of the **true surface**: every
vertex on the exact surfaces that meet there, chords between them; it is inscribed where the
surface bulges outwards, so its volume is a little smaller.

While a slider moves the solid is coarse, when the hand rests it becomes fine. The first volume is
that of the solid shown, with an estimate of its error; pieces are parts that do not touch. The
**exact** volume is the integral of exact section areas (see the Section tab).

The **largest ball** and the **largest box** along x, y, z inside the workspace are what one can use
of it; a mechanism's data sheet quotes them.
"""


class WorkspacePanel(Panel):
    """A switch and an opacity for every solid, its volume and its pieces."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._known = review.machine.modes
        self._switches: dict[str, viser.GuiCheckboxHandle] = {}
        self._opacities: list[tuple[tuple[str, ...], viser.GuiSliderHandle[float]]] = []
        self._regions = RegionsFolder(desk, sheet) if review.machine.region_specs else None
        specs = review.machine.solid_specs
        alone = [s for s in specs if s.limb is None and s.key != ASPECTS]
        for spec in alone:
            gui.add_html(box(f"<b>{esc(spec.title)}</b>"))
            self._switch(spec, "Show", sheet)
        if alone:
            self._opacity(tuple(s.key for s in alone), "Opacity", 0.35)
        of_modes = any(spec.uses_modes for spec in alone) or any(
            spec.uses_modes for spec in review.machine.region_specs
        )
        self._choice = gui.add_dropdown(
            "Of",
            (ALL, CURRENT, CHOSEN),
            initial_value=_choice(sheet),
            hint="Working modes",
            visible=of_modes and len(self._known) > 1,
        )
        answer(desk, self._choice, self._choose)
        self._set = gui.add_text(
            "Modes",
            _set_text(sheet),
            hint="One sign a limb, ? for either; several separated by commas: +?+++, −−+++",
            visible=_choice(sheet) == CHOSEN,
        )
        answer(desk, self._set, self._choose_set)
        self._surface = gui.add_dropdown(
            "Made of",
            tuple(MADE_OF.values()),
            initial_value=MADE_OF[review[Workspace].surface],
            hint="Facets are right on the average; of the true surface every vertex is exact, "
            "which takes longer and many more triangles",
            visible=any("true" in spec.surfaces for spec in alone),
        )
        answer(desk, self._surface, self._choose_surface)
        self._report = gui.add_html(_report(sheet))
        self._measured: Sections | None = None
        self._exact = gui.add_html("")
        if review.machine.section_spec is not None:
            self._usable(desk)
        self._whole = [s.key for s in specs if s.key.endswith("/whole")]
        self._all: viser.GuiCheckboxHandle | None = None
        if self._whole:
            gui.add_html(box("<b>Vertex spaces of the limbs</b>"))
            self._all = gui.add_checkbox("All limbs", False)
            answer(desk, self._all, partial(self._show_all, specs))
        for limb in sorted({s.limb for s in specs if s.limb is not None}):
            own = [s for s in specs if s.limb == limb]
            with gui.add_folder(f"Limb {limb}", expand_by_default=False):
                for spec in own:
                    title = spec.title.partition(": ")[2]
                    figure = f" ({spec.figure})" if spec.figure else ""
                    self._switch(spec, title[:1].upper() + title[1:] + figure, sheet)
                self._opacity(tuple(s.key for s in own), "Opacity", 0.25)
        self._parts = gui.add_html(_parts(sheet))
        explain(gui, review.machine.text("workspace"), HELP)

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return bool(machine.solid_specs or machine.region_specs)

    def draw(self, sheet: Sheet) -> None:
        review = sheet.view.review
        for key, switch in self._switches.items():
            put(self._desk, switch, review[Workspace].shown(key) is not None)
        for keys, slider in self._opacities:
            shown = next((s for s in review[Workspace].solids if s.key in keys), None)
            if shown is not None:
                put(self._desk, slider, shown.opacity)
        choice = _choice(sheet)
        put(self._desk, self._choice, choice)
        put_prop(self._set, "visible", choice == CHOSEN)
        if choice == CHOSEN:
            put(self._desk, self._set, _set_text(sheet))
        put(self._desk, self._surface, MADE_OF[review[Workspace].surface])
        if self._all is not None:
            put(self._desk, self._all, all(review[Workspace].shown(key) for key in self._whole))
        if self._regions is not None:
            self._regions.draw(sheet)
        self.draw_solids(sheet)

    def draw_regions(self, sheet: Sheet, laying: Laying) -> None:
        if self._regions is not None:
            self._regions.draw_regions(laying)

    def draw_sections(self, sheet: Sheet, sections: Sections) -> None:
        self._measured = sections
        put_prop(self._exact, "content", _exact(sheet, sections))
        put_prop(self._inscribed, "content", _inscribed(sections))
        shown = sections.ball is not None or sections.box is not None
        put_prop(self._hide, "visible", shown)
        put_prop(self._go, "visible", sections.ball is not None)

    def _usable(self, desk: Desk) -> None:
        with desk.gui.add_folder("Usable workspace"):
            self._here = desk.gui.add_checkbox(
                "About the platform",
                False,
                hint="Centred where the platform is; otherwise wherever the most room is",
            )
            button(desk, "Largest ball", lambda _: desk.ask(Inscribe("ball", self._here.value)))
            button(desk, "Largest box", lambda _: desk.ask(Inscribe("box", self._here.value)))
            self._inscribed = desk.gui.add_html("")
            self._go = button(
                desk, "Platform to the ball's centre", lambda client: desk.ask(GoToBall(client))
            )
            self._hide = button(desk, "Hide them", lambda _: desk.ask(Forget()))
            self._go.visible = self._hide.visible = False

    def draw_solids(self, sheet: Sheet) -> None:
        put_prop(self._report, "content", _report(sheet))
        if self._measured is not None:
            put_prop(self._exact, "content", _exact(sheet, self._measured))
        put_prop(self._parts, "content", _parts(sheet))

    def _switch(self, spec: SolidSpec, title: str, sheet: Sheet) -> None:
        switch = self._desk.gui.add_checkbox(
            title, sheet.view.review[Workspace].shown(spec.key) is not None
        )
        answer(self._desk, switch, lambda on, client: self._desk.send(Show(spec.key, on), client))
        self._switches[spec.key] = switch

    def _opacity(self, keys: tuple[str, ...], label: str, value: float) -> None:
        slider = self._desk.gui.add_slider(label, 0.05, 1.0, 0.05, value)
        answer(
            self._desk, slider, lambda opacity, client: self._desk.send(Fade(keys, opacity), client)
        )
        self._opacities.append((keys, slider))

    def _choose(self, choice: str, client: viser.ClientHandle | None) -> None:
        self._set.visible = choice == CHOSEN
        if choice == CHOSEN:
            self._choose_set(self._set.value, client)
        else:
            self._desk.send(ChooseModes("all" if choice == ALL else "current"), client)

    def _choose_set(self, text: str, client: viser.ClientHandle | None) -> None:
        self._desk.send(ChooseModes(matching(text, self._known)), client)

    def _choose_surface(self, text: str, client: viser.ClientHandle | None) -> None:
        surface = next(kind for kind, title in MADE_OF.items() if title == text)
        self._desk.send(ChooseSurface(surface), client)

    def _show_all(
        self, specs: tuple[SolidSpec, ...], on: bool, client: viser.ClientHandle | None
    ) -> None:
        for key in self._whole:
            self._desk.send(Show(key, on), client)


def _choice(sheet: Sheet) -> str:
    modes = sheet.view.review[Workspace].modes
    return ALL if modes == "all" else CURRENT if modes == "current" else CHOSEN


def _set_text(sheet: Sheet) -> str:
    modes = sheet.view.review[Workspace].modes
    chosen = modes if isinstance(modes, tuple) else (sheet.view.posture.mode,)
    return ", ".join(page_mode(m) for m in chosen)


def _report(sheet: Sheet) -> str:
    view = sheet.view
    where = (
        f'<b style="color:{tone("good")}">inside</b>'
        if inside(view.review)
        else f'<b style="color:{palette.BEYOND}">outside</b>'
    )
    lines = [f"The present position is {where} this workspace."]
    for shown in view.review[Workspace].solids:
        built = sheet.built.get(shown.key)
        if built is None or built.wish.spec.limb is not None or shown.key == ASPECTS:
            continue
        solid = built.solid
        if not solid.pieces:
            lines.append(
                "At this orientation the workspace is empty."
                if built.resolution == "fine"
                else "Nothing is large enough to be seen yet; a finer look is on its way."
            )
        else:
            count = len(solid.pieces)
            lines.append(
                f'<span style="font-size:1.25em;font-weight:600">'
                f"{volume_text(solid.volume, solid.volume_error)}</span> in {count} "
                f"piece{'s' if count > 1 else ''}"
            )
            pieces = " · ".join(volume_text(p.volume) for p in solid.pieces[:8])
            lines.append(pieces + (" · …" if count > 8 else ""))
        lines.append(_quality(built))
    return box("<br>".join(lines))


def _quality(built: Built) -> str:
    exact = f"{built.solid.volume:,.0f} mm³".replace(",", " ")
    return (
        f'<span style="opacity:0.75">{built.resolution} solid · {exact} · '
        f"{built.solid.triangles} triangles<br>{surface_text(built.solid)}</span>"
    )


def _parts(sheet: Sheet) -> str:
    rows = []
    for key, built in sheet.built.items():
        spec = built.wish.spec
        if spec.limb is None or sheet.view.review[Workspace].shown(key) is None:
            continue
        text = (
            f"{volume_text(built.solid.volume, built.solid.volume_error)}"
            if built.solid.pieces
            else "does not exist for this limb"
        )
        rows.append(f"{chip(palette.solid_color(spec))}{esc(spec.title)}: {text}")
    return box("<br>".join(rows)) if rows else ""


def _exact(sheet: Sheet, sections: Sections) -> str:
    """The volume by exact sections, beside that of the solid."""
    volume = sections.volume
    if sections.trouble:
        return red(sections.trouble)
    if volume is None:
        return box("The exact volume is on its way …")
    if not sections.current:
        return box(f'<span style="opacity:.5">{_exact_text(volume)}</span>')
    lines = [_exact_text(volume)]
    built = sheet.built.get("workspace")
    # The solid may still be the one before.
    present = {wish.what for wish in sheet.wishes}
    if built is not None and volume.value > 0.0 and built.wish.what in present:
        off = built.solid.volume - volume.value
        share = f"{100 * off / volume.value:+.2g}".replace("-", "−")
        lines.append(
            f'<span style="opacity:.75">the {built.resolution} solid differs by '
            f"{_signed(off)} mm³ ({share} %)</span>"
        )
    return box("<br>".join(lines))


def _exact_text(volume: Volume) -> str:
    exact = f"{volume.value:,.0f} ± {volume.error:,.2g} mm³".replace(",", " ")
    return (
        f"Exact: <b>{volume_text(volume.value, volume.error)}</b> "
        f'<span style="opacity:.75">({exact})</span>'
    )


def _signed(value: float) -> str:
    return f"{value:+,.0f}".replace(",", " ").replace("-", "−")


def _inscribed(sections: Sections) -> str:
    lines = []
    if sections.ball is not None:
        x, y, z = sections.ball.center
        lines.append(
            f"Ball: radius <b>{sections.ball.radius:.2f} mm</b> about "
            f"{signed(x)}, {signed(y)}, {signed(z)} mm"
        )
    if sections.box is not None:
        sides = " × ".join(f"{v:.1f}" for v in sections.box.high - sections.box.low)
        x, y, z = 0.5 * (sections.box.low + sections.box.high)
        lines.append(
            f"Box: <b>{sides} mm</b> about {signed(x)}, {signed(y)}, {signed(z)} mm, "
            f"{volume_text(sections.box.volume)}"
        )
    return box("<br>".join(lines)) if lines else ""
