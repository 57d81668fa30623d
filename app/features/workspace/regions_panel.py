"""Plane workspaces in the Workspace tab: which regions, their areas, their files."""

from __future__ import annotations

import viser

from app.features.workspace.compute import Laid
from app.features.workspace.part import region_colors
from app.features.workspace.state import Flat, SetFlat
from app.review.requests import SaveRegions
from app.scene import palette
from app.widgets.desk import (
    Desk,
    Laying,
    Sheet,
    answer,
    area_text,
    box,
    chip,
    clicked,
    esc,
    put,
    put_prop,
    red,
)

KINDS = ("SVG", "DXF", "CSV")


class RegionsFolder:
    """A switch, the choice of regions, and what is on display."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._titles = {s.title: s.key for s in review.machine.region_specs}
        with gui.add_folder("In its plane"):
            self._on = gui.add_checkbox("Show", review[Flat].on)
            answer(desk, self._on, lambda on, client: desk.send(SetFlat("on", on), client))
            self._which = gui.add_dropdown(
                "Regions",
                tuple(self._titles),
                initial_value=self._title(review[Flat].key),
                visible=len(self._titles) > 1,
            )
            answer(desk, self._which, self._choose)
            self._locus = gui.add_checkbox(
                "Singular curves", review[Flat].locus, hint="Of the present mode, red-orange"
            )
            answer(desk, self._locus, lambda on, client: desk.send(SetFlat("locus", on), client))
            self._report = gui.add_html("")
            self._save = gui.add_button_group("Save as", KINDS)
            clicked(
                desk,
                self._save,
                lambda client: desk.ask(SaveRegions(self._save.value.lower(), client)),
            )

    def draw(self, sheet: Sheet) -> None:
        flat = sheet.view.review[Flat]
        put(self._desk, self._on, flat.on)
        put(self._desk, self._which, self._title(flat.key))
        put(self._desk, self._locus, flat.locus)

    def draw_regions(self, laying: Laying) -> None:
        if laying.trouble:
            put_prop(self._report, "content", red(laying.trouble))
        else:
            put_prop(self._report, "content", "" if laying.laid is None else _report(laying.laid))

    def _title(self, key: str) -> str:
        return next((t for t, k in self._titles.items() if k == key), next(iter(self._titles)))

    def _choose(self, title: str, client: viser.ClientHandle | None) -> None:
        self._desk.send(SetFlat("key", self._titles[title]), client)


def _report(laid: Laid) -> str:
    if not any(region.section.loops for region in laid.regions):
        return box("At this orientation the workspace is empty.")
    rows = []
    drawn = [len(fill.faces) > 0 for fill in laid.fills]
    colors = region_colors(laid.regions)
    for region, color, shown in zip(laid.regions, colors, drawn, strict=True):
        section = region.section
        exact = f"{section.area:,.6f} ± {section.area_error:.1g} mm²".replace(",", " ")
        pieces = f"{section.pieces} piece{'' if section.pieces == 1 else 's'}"
        group = f"group {region.group}" if region.group else ""
        rows.append(
            f"<tr><td>{chip(color if shown else 'transparent')}{esc(region.title)}</td>"
            f'<td style="text-align:right;white-space:nowrap" title="{exact}">'
            f"{area_text(section.area)}</td>"
            f'<td style="opacity:.75;white-space:nowrap">{pieces}</td>'
            f'<td style="opacity:.75;white-space:nowrap">{group}</td></tr>'
        )
    worst = max(region.deviation for region in laid.regions)
    exactly = "exact arcs" if worst == 0.0 else f"edges within {worst:.0e} mm of the true ones"
    groups = any(region.group for region in laid.regions)
    joined = " Regions of one group join through serial singularities." if groups else ""
    curves = (
        f"<br>{chip(palette.BEYOND)}where control is lost in the present mode"
        if len(laid.locus)
        else ""
    )
    some = "" if all(drawn) else " Drawn are those of one mode, as others lie over them."
    return box(
        f'<table style="width:100%">{"".join(rows)}</table>'
        f'<span style="opacity:.75">{exactly}.{joined}{some}</span>{curves}'
    )
