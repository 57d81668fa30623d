"""The Workspace tab: the workspace solid, the limbs' vertex spaces, regions in a plane."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app.features.review.files import FORMATS
from app.features.section.compute import Sections
from app.features.section.part import SectionPart
from app.features.workspace import html
from app.features.workspace.compute import Laying, Solids, SolidWish
from app.features.workspace.part import RegionsPart, SolidsPart
from app.features.workspace.state import ASPECTS, ChooseModes, Fade, Flat, Show, Workspace
from app.language import menu, tr
from app.review.changes import Change
from app.review.state import Review
from app.terminal.tables import LOCUS
from app.widgets.boxes import ModesMenu
from app.widgets.desk import Client, Group, Panel, Sheet, explain
from app.widgets.markup import Markup
from kinematics.answers.modes import matching
from kinematics.errors import InputError
from kinematics.facets.solids import RESOLUTIONS, SolidSpec
from kinematics.machine import Machine

KINDS = ("SVG", "DXF", "CSV")
PIECES = 12  # of one solid that can be saved alone


class WorkspacePanel(Panel):
    """How large the workspace is, what of it can be used, and what is shown of it."""

    TITLE = "workspace.solid"
    TAB = "workspace.tab"

    @staticmethod
    def serves(machine: Machine[Any]) -> bool:
        return bool(machine.solid_specs or machine.region_specs)

    def build(self, review: Review) -> None:
        gui, desk, sheet, machine = self.gui, self.desk, self.sheet, review.machine
        if machine.region_specs:
            self.groups.append(RegionsFolder(desk, sheet))
        specs = machine.solid_specs
        alone = [s for s in specs if s.limb is None and s.key != ASPECTS]
        of_modes = any(s.uses_modes for s in alone) or any(
            s.uses_modes for s in machine.region_specs
        )
        modes = menu("workspace.modes")
        visible = of_modes and len(machine.modes) > 1
        self._modes = ModesMenu(
            self,
            modes,
            "workspace.own",
            self._chosen,
            hint=tr("workspace.modes_hint"),
            visible=visible,
        )
        self._report = gui.add_html("")
        if machine.section_spec is not None:
            self.groups.append(UsableFolder(desk, sheet))
        self._limbs(specs)
        if alone:
            with self.folder("workspace.look", open=len(alone) > 1 or not alone[0].places):
                self._look(alone)
        if specs:
            self.groups.append(SaveFolder(desk, sheet))
        self.toggle(("workspace", "W"), partial(_shown, "workspace"), partial(Show, "workspace"))
        explain(gui, "workspace", machine)
        self._solids = Solids((), {}, {}, None)
        self._measured: Sections | None = None

    def _look(self, alone: list[SolidSpec]) -> None:
        """How the workspace is shown, or each of several."""
        for spec in alone:
            self._display(spec, tr("workspace.show") if len(alone) == 1 else spec.title)
        self._opacity(tuple(s.key for s in alone), 0.35)
        self.menu(
            "workspace.made_of",
            menu("workspace.made"),
            Workspace,
            "surface",
            visible=any("true" in spec.surfaces for spec in alone),
        )

    def _limbs(self, specs: tuple[SolidSpec, ...]) -> None:
        """The limbs' vertex spaces and their parts as a table of switches."""
        self._of_limbs = tuple(s for s in specs if s.limb is not None)
        if not self._of_limbs:
            return
        with self.folder("workspace.limbs", open=False):
            self._switches = Markup(self.desk, self._toggle)
            self._whole = [s.key for s in self._of_limbs if s.key.endswith("/whole")]
            self._all = self.gui.add_checkbox(tr("workspace.all_limbs"), False)
            self.answer(self._all, self._show_all)
            self._opacity(tuple(s.key for s in self._of_limbs), 0.25)
            self._parts = self.gui.add_html("")

    def _toggle(self, key: str, client: Client) -> None:
        self.desk.send(Show(key, self.review[Workspace].shown(key) is None), client)

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        wanted = self.review[Workspace]
        self._modes.draw(wanted.modes)
        if self._of_limbs:
            self.put(self._all, all(wanted.shown(key) for key in self._whole))
            self._switches.say(html.switches_html(self.review, self._of_limbs))

    def told(self, sheet: Sheet, news: Any) -> None:
        super().told(sheet, news)
        match news:
            case Solids():
                self._solids = news
                self._draw_solids()
            case Sections():
                self._measured = news
                self._draw_solids()

    def _draw_solids(self) -> None:
        self.say(self._report, html.report_html(self.review, self._solids, self._measured))
        if self._of_limbs:
            self.say(self._parts, html.parts_html(self._solids))

    # --- widgets

    def _display(self, spec: SolidSpec, title: str) -> None:
        made = self.gui.add_checkbox(title, False)
        self.bind(made, partial(_shown, spec.key), partial(Show, spec.key))

    def _opacity(self, keys: tuple[str, ...], value: float) -> None:
        def shown(review: Review) -> float:
            return next((s.opacity for s in review[Workspace].solids if s.key in keys), value)

        slider = self.gui.add_slider(tr("workspace.opacity"), 0.05, 1.0, 0.05, value)
        self.bind(slider, shown, partial(Fade, keys))

    def _chosen(self, choice: str) -> Change:
        named = choice in ("all", "current")
        return ChooseModes(choice if named else matching(choice, self.review.machine.modes))

    def _show_all(self, on: bool, client: Client) -> None:
        for key in self._whole:
            self.desk.send(Show(key, on), client)


class UsableFolder(Group):
    """The largest ball and the largest box in the workspace."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        part = desk.part(SectionPart)
        with self.folder("workspace.inside"):
            here = self.tick("workspace.about_platform")
            together = self.tick("workspace.together", visible=len(review.machine.modes) > 1)

            def find(what: str, _: Client) -> None:
                desk.ask(part.inscribe, what, here.value, together.value)

            self.button("workspace.ball", partial(find, "ball"))
            self.button("workspace.box", partial(find, "box"))
            self._told = gui.add_html("")
            self._go = self.asks_for("workspace.to_centre", part.go_to_ball, visible=False)
            self._hide = self.asks("workspace.hide", part.forget_inscribed, visible=False)

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Sections):
            self.say(self._told, html.inscribed_html(self.review.machine, news))
            self.set(self._hide, visible=news.ball is not None or news.box is not None)
            self.set(self._go, visible=news.ball is not None)


class SaveFolder(Group):
    """Solids on display, and parts of them, as files."""

    def build(self, review: Review) -> None:
        gui = self.gui
        with self.folder("review.solids", open=False):
            self._solid = gui.add_dropdown(tr("review.solid"), (tr("review.no_solid"),))
            self._format = gui.add_dropdown(tr("review.format"), tuple(f.upper() for f in FORMATS))
            self._resolution = gui.add_dropdown(
                tr("review.resolution"), RESOLUTIONS, initial_value="fine"
            )
            self._save = self.button("review.save", self._export, icon=viser.Icon.DOWNLOAD)
        self._keys: dict[str, tuple[str, str]] = {}  # the solid's, and which part of it

    def told(self, sheet: Sheet, news: Any) -> None:
        if not isinstance(news, Solids):
            return
        self._keys = {wish.spec.title: (wish.spec.key, "") for wish in news.wishes}
        for wish in news.wishes:
            self._keys |= _parts(wish, news)
        self.offer(self._solid, self._keys, tr("review.no_solid"))
        self.set(self._save, disabled=not self._keys)

    def _export(self, client: Client) -> None:
        chosen = self._keys.get(self._solid.value)
        if chosen is None:
            raise InputError(tr("review.show_a_solid"))
        key, part = chosen
        kind, resolution = self._format.value.lower(), self._resolution.value
        solids = self.desk.part(SolidsPart)
        self.desk.ask(solids.save_solid, key, kind, resolution, part, client)


class RegionsFolder(Group):
    """A switch, the choice of regions, and what is on display."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        part = desk.part(RegionsPart)
        titles = {s.title: s.key for s in review.machine.region_specs}
        with self.folder("workspace.plane"):
            self.switch("workspace.show", Flat, "on")
            self.menu("workspace.regions", titles, Flat, "key", visible=len(titles) > 1)
            self.switch("workspace.curves", Flat, "locus")
            self._report = gui.add_html("")
            self.saving(KINDS, part.save_regions)

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Laying):
            self.say(self._report, html.regions_html(news), news.stale)


def _parts(wish: SolidWish, solids: Solids) -> dict[str, tuple[str, str]]:
    """Each piece of a solid that singularities part, and where they do."""
    key = wish.spec.key
    built = solids.built.get(key)
    if built is None or built.solid.piece_of is None:
        return {}
    surface = {tr("review.locus"): (key, LOCUS)}
    parts = surface if built.solid.on_locus is not None else {}
    return parts | {
        tr("review.aspect", n=n + 1): (key, str(n + 1))
        for n in range(min(len(built.solid.pieces), PIECES))
    }


def _shown(key: str, review: Review) -> bool:
    return review[Workspace].shown(key) is not None
