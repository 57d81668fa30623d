"""The aspects of the present mode in the Singularities tab, and the largest ball within them."""

from __future__ import annotations

import viser

from app.features.singularities.html import ASPECTS, legend_html, pieces_html
from app.features.singularities.state import Control, SetControl
from app.features.workspace.state import Fade, Show, Workspace
from app.review.requests import FindFree, GoToFree
from app.widgets.desk import Controlled, Desk, Sheet, answer, box, button, esc, put, put_prop

NOTHING = "Nothing"


class AspectsFolder:
    """Whether and how aspects are shown, what they are, and the ball."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._sheet = sheet
        self._measures = {m.title: m for m in review.machine.measures.specs}
        shown = review[Workspace].shown(ASPECTS)
        with gui.add_folder("Aspects of the present mode"):
            self._aspects = gui.add_checkbox("Show", shown is not None, hint="Hotkey A")
            answer(desk, self._aspects, lambda on, client: desk.send(Show(ASPECTS, on), client))
            self._locus = gui.add_checkbox(
                "Singular surface", review[Control].locus, hint="Where control is lost"
            )
            answer(desk, self._locus, lambda on, client: desk.send(SetControl("locus", on), client))
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
                (NOTHING, *self._measures),
                initial_value=self._title(review[Control].shade),
                hint="Of the present mode, on the aspects and on the workspace",
            )
            answer(desk, self._shade, self._choose_shade)
            self._legend = gui.add_html("")
            self._pieces = gui.add_html("")
        # A ball is one of places.
        axes = {c.key for c in review.machine.coordinates}
        with gui.add_folder("Largest ball without a singularity", visible={"x", "y", "z"} <= axes):
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

    def draw(self, sheet: Sheet) -> None:
        self._sheet = sheet
        review = sheet.view.review
        shown = review[Workspace].shown(ASPECTS)
        put(self._desk, self._aspects, shown is not None)
        if shown is not None:
            put(self._desk, self._opacity, shown.opacity)
        put(self._desk, self._locus, review[Control].locus)
        put(self._desk, self._shade, self._title(review[Control].shade))
        self.draw_solids(sheet)

    def draw_solids(self, sheet: Sheet) -> None:
        put_prop(self._pieces, "content", pieces_html(sheet))

    def draw_control(self, controlled: Controlled) -> None:
        put_prop(self._legend, "content", self._scale(controlled))
        ball = controlled.ball
        text = "Seeking …" if controlled.seeking else ""
        if ball is not None:
            x, y, z = (f"{v:.1f}".replace("-", "−") for v in ball.center)
            text = f"Radius <b>{ball.radius:.2f} mm</b> about {x}, {y}, {z} mm"
        put_prop(self._ball, "content", box(text) if text else "")
        put_prop(self._go, "visible", ball is not None)
        put_prop(self._hide, "visible", ball is not None)

    def _scale(self, controlled: Controlled) -> str:
        shade = self._sheet.view.review[Control].shade
        measure = next((m for m in self._measures.values() if m.key == shade), None)
        if measure is None:
            return ""
        if controlled.scale is None:
            return box(f"{esc(measure.title)}: shown when aspects or workspace are on display")
        return box(legend_html(measure, controlled.scale))

    def _title(self, key: str) -> str:
        return next((title for title, m in self._measures.items() if m.key == key), NOTHING)

    def _choose_shade(self, title: str, client: viser.ClientHandle | None) -> None:
        key = "" if title == NOTHING else self._measures[title].key
        self._desk.send(SetControl("shade", key), client)
