"""The Workspace tab: the workspace solid, the limbs' vertex spaces, regions in a plane."""

from __future__ import annotations

from functools import partial
from typing import Any

from app.features.section.compute import Sections
from app.features.section.part import SectionPart
from app.features.workspace import html
from app.features.workspace.compute import Laying, Solids
from app.features.workspace.part import RegionsPart
from app.features.workspace.state import ASPECTS, ChooseModes, Fade, Flat, Show, Workspace
from app.review.changes import Change
from app.review.state import Review
from app.widgets.boxes import ModesMenu
from app.widgets.desk import Client, Group, Panel, Sheet, explain
from app.widgets.markup import Markup
from kinematics.answers.modes import matching
from kinematics.facets.solids import SolidSpec, SurfaceKind
from kinematics.machine import Machine

MADE_OF: dict[str, SurfaceKind] = {"Facets": "facets", "The true surface": "true"}
KINDS = ("SVG", "DXF", "CSV")

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
    """How large the workspace is, what of it can be used, and what is shown of it."""

    TITLE = "Solid"
    TAB = "Workspace"

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
        modes = {"All working modes together": "all", "The current working mode": "current"}
        visible = of_modes and len(machine.modes) > 1
        own, hint = ("A chosen set", "Modes"), "Working modes"
        self._modes = ModesMenu(self, modes, own, self._chosen, hint=hint, visible=visible)
        self._report = gui.add_html("")
        if machine.section_spec is not None:
            self.groups.append(UsableFolder(desk, sheet))
        self._limbs(specs)
        if alone:
            with self.folder("Look", "shown or not, opacity, facets", open=len(alone) > 1):
                self._look(alone)
        command = "Workspace", "Show or hide the workspace solid", "W"
        self.toggle(command, partial(_shown, "workspace"), partial(Show, "workspace"))
        explain(gui, machine.text("workspace"), HELP)
        self._solids = Solids((), {}, {}, None)
        self._measured: Sections | None = None

    def _look(self, alone: list[SolidSpec]) -> None:
        """How the workspace is shown, or each of several."""
        for spec in alone:
            self._display(spec, "Show" if len(alone) == 1 else spec.title)
        self._opacity(tuple(s.key for s in alone), 0.35)
        self.menu(
            "Made of",
            MADE_OF,
            Workspace,
            "surface",
            hint="Facets are right on the average; of the true surface every vertex is exact, "
            "which takes longer and many more triangles",
            visible=any("true" in spec.surfaces for spec in alone),
        )

    def _limbs(self, specs: tuple[SolidSpec, ...]) -> None:
        """The limbs' vertex spaces and their parts as a table of switches."""
        self._of_limbs = tuple(s for s in specs if s.limb is not None)
        if not self._of_limbs:
            return
        with self.folder("Vertex spaces", "the surfaces that bound it", open=False):
            self._switches = Markup(self.desk, self._toggle)
            self._whole = [s.key for s in self._of_limbs if s.key.endswith("/whole")]
            self._all = self.gui.add_checkbox("All limbs", False)
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
        self._draw_solids()

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

        slider = self.gui.add_slider("Opacity", 0.05, 1.0, 0.05, value)
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
        with self.folder("Largest inside", "ball and box"):
            here = gui.add_checkbox(
                "About the platform",
                False,
                hint="Centred where the platform is; otherwise wherever the most room is",
            )
            together = gui.add_checkbox(
                "Modes together",
                False,
                hint="In all modes at once; otherwise in the present one, as a machine "
                "cannot change its mode on the way",
                visible=len(review.machine.modes) > 1,
            )

            def find(what: str, _: Client) -> None:
                desk.ask(part.inscribe, what, here.value, together.value)

            self.button("Largest ball", partial(find, "ball"))
            self.button("Largest box", partial(find, "box"))
            self._told = gui.add_html("")
            self._go = self.asks_for(
                "Platform to the ball's centre", part.go_to_ball, visible=False
            )
            self._hide = self.asks("Hide them", part.forget_inscribed, visible=False)

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Sections):
            self.say(self._told, html.inscribed_html(self.review.machine, news))
            self.set(self._hide, visible=news.ball is not None or news.box is not None)
            self.set(self._go, visible=news.ball is not None)


class RegionsFolder(Group):
    """A switch, the choice of regions, and what is on display."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        part = desk.part(RegionsPart)
        titles = {s.title: s.key for s in review.machine.region_specs}
        with self.folder("In its plane"):
            self.switch("Show", Flat, "on")
            self.menu("Regions", titles, Flat, "key", visible=len(titles) > 1)
            self.switch("Singular curves", Flat, "locus", "Of the present mode, red-orange")
            self._report = gui.add_html("")
            self.saving(KINDS, part.save_regions)

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, Laying):
            self.say(self._report, html.regions_html(news), news.stale)


def _shown(key: str, review: Review) -> bool:
    return review[Workspace].shown(key) is not None
