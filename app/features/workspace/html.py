"""What the Workspace tab says: volumes, pieces, areas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from app.features.section.compute import Modes, Sections
from app.features.workspace.compute import (
    Built,
    Laying,
    Solids,
    inside,
    piece_around,
    region_colors,
)
from app.features.workspace.state import ASPECTS, Workspace
from app.review.state import Review
from app.review.units import area_text, minus, plural, spaced, tenths, volume_text
from app.review.view import mode_text
from app.scene import palette
from app.terminal.tables import surface_text
from app.widgets.texts import NUMERIC, aged, bar, box, chip, esc, faint, red, styled, table, tone
from kinematics.facets.solids import SolidSpec
from kinematics.machine import Machine

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

MOST = 8  # pieces that are told


def report_html(review: Review, solids: Solids, sections: Sections | None) -> str:
    """How large the workspace is and of which pieces, whether the machine is in it, and what the
    mesh on display is; ``sections`` where a machine has exact ones.
    """
    parts = [_where(review)]
    shown = [w for w in solids.wishes if w.spec.limb is None and w.spec.key != ASPECTS]
    if sections is not None:
        parts.append(_exact(sections))
    for wish in shown:
        key = wish.spec.key
        built, old = solids.built.get(key), solids.old.get(key)
        if built is not None:
            here = piece_around(review, built) if review.posture.reachable else None
            parts.append(_solid(built, here, exact=sections))
        elif old is not None:
            parts.append(aged(_solid(old, None, exact=sections), True))
    return box("".join(parts))


def _where(review: Review) -> str:
    """Whether the machine is in the workspace."""
    if not inside(review):
        return styled("O′ outside", f"float:right;color:{tone('bad')}")
    told = styled("O′ inside ✓", f"float:right;color:{tone('good')}")
    if not review.posture.reachable:
        mode = mode_text(review.machine, review.mode)
        told += styled(f"but not in {mode}, which the machine is in", f"color:{tone('bad')}", "div")
    return told


def _exact(sections: Sections) -> str:
    """The volume by exact sections."""
    if sections.trouble:
        return red(sections.trouble)
    volume = sections.volume or sections.old_volume
    if volume is None:
        return "<div>The exact volume is on its way …</div>"
    exact = f"{spaced(volume.value)} ± {volume.error:,.2g} mm³".replace(",", " ")
    told = _answer(volume.value, volume.error, ", exact", exact)
    return aged(told, sections.volume is None)


def _answer(value: float, error: float, what: str, exact: str) -> str:
    """A number as the answer of a tab."""
    number, _, rest = volume_text(value, error).partition(" ")
    return f'<div title="{exact}"><b class="bo-answer">{number}</b> {rest}{what}</div>'


def _solid(built: Built, here: int | None, exact: Sections | None) -> str:
    """The pieces of a solid, and what its mesh is."""
    solid = built.solid
    lines = []
    if solid.pieces and exact is None:
        lines.append(_answer(solid.volume, solid.volume_error, "", f"{spaced(solid.volume)} mm³"))
    if solid.pieces:
        lines.append(_pieces(solid, here))
    elif built.resolution == "fine" and not solid.note:
        lines.append("<div>At this orientation the workspace is empty.</div>")
    elif built.resolution != "fine":
        text = "Nothing is large enough to be seen yet; a finer look is on its way."
        lines.append(f"<div>{text}</div>")
    if built.wish.branch:
        lines.append(f"<div>The branch of {esc(built.wish.branch)}</div>")
    if solid.note:
        lines.append(f"<div>{esc(solid.note)}</div>")
    made = f"mesh: {built.resolution}, {solid.triangles} triangles, "
    made += volume_text(solid.volume, solid.volume_error)
    if exact is not None and exact.volume is not None and exact.volume.value > 0.0:
        share = 100.0 * (solid.volume / exact.volume.value - 1.0)
        made += f", {minus(f'{share:+.2g}')} % beside the exact volume"
    lines.append(faint(f"{made}; {surface_text(solid)}", "div"))
    return "".join(lines)


def _pieces(solid: BuiltSolid, here: int | None) -> str:
    """A row for each piece, that of the machine marked."""
    rows, looks = [], []
    largest = max(piece.volume for piece in solid.pieces)
    for n, piece in enumerate(solid.pieces[:MOST]):
        where = "the machine is here" if n == here else ""
        share = f"{100.0 * piece.volume / solid.volume:.0f} %"
        color = "var(--bo-work)" if n == here else "var(--bo-bar)"
        length = bar(piece.volume / largest, color, "5px")
        rows.append((f"{n + 1}", where, volume_text(piece.volume), share, length))
        looks.append("aria-current" if n == here else "")
    if (left := len(solid.pieces) - MOST) > 0:
        rows.append(("", f"and {left} smaller", "", "", ""))
    styles = ("width:1.4em", "", NUMERIC, f"{NUMERIC};width:3.4em", "width:30%")
    return table(rows, styles, heads=("piece", "", "volume", "share", ""), looks=looks)


PARTS = {
    "whole": "whole",
    "H1": "H₁",
    "H2": "H₂",
    "H3": "H₃",
    "body": "body",
    "plus": "+",
    "minus": "−",
}
"""Of a limb's vertex space, as the heads of their columns."""


def switches_html(review: Review, specs: Sequence[SolidSpec]) -> str:
    """A row for each limb, a switch for each part of its vertex space."""
    parts = [part for part in PARTS if any(spec.key.endswith(f"/{part}") for spec in specs)]
    known = {spec.key: spec for spec in specs}
    rows = []
    for limb in sorted({spec.limb for spec in specs if spec.limb is not None}):
        cells = [f"{chip(palette.limb_color(limb))}limb {limb}"]
        for part in parts:
            spec = known.get(f"limb{limb}/{part}")
            cells.append("" if spec is None else _switch(review, spec))
        rows.append(cells)
    heads = ["limb", *(PARTS[part] for part in parts)]
    told = table(rows, ("", *["text-align:center"] * len(parts)), heads=heads)
    return box(told + faint("More than one limb: outlines, so that the machine stays in sight."))


def _switch(review: Review, spec: SolidSpec) -> str:
    on = review[Workspace].shown(spec.key) is not None
    title = spec.title + (f" ({spec.figure})" if spec.figure else "")
    return (
        f'<button type="button" class="bo-check" role="checkbox" aria-checked="{str(on).lower()}" '
        f'data-send="{esc(spec.key)}" title="{esc(title)}" aria-label="{esc(title)}"></button>'
    )


def parts_html(solids: Solids) -> str:
    """The limbs' solids."""
    rows = []
    for wish in solids.wishes:
        known = solids.built.get(wish.spec.key) or solids.old.get(wish.spec.key)
        if known is None or wish.spec.limb is None:
            continue
        solid = known.solid
        text = (
            volume_text(solid.volume, solid.volume_error)
            if solid.pieces
            else "does not exist for this limb"
        )
        line = f"{chip(palette.solid_color(wish.spec))}{esc(wish.spec.title)}: {text}"
        rows.append(aged(line, wish.spec.key in solids.old, "span"))
    return box("<br>".join(rows)) if rows else ""


def inscribed_html(machine: Machine[Any], sections: Sections) -> str:
    """The largest ball and box, and of which modes they are."""
    lines = []
    if sections.ball is not None:
        ball, modes = sections.ball
        center = ", ".join(map(tenths, ball.center))
        text = f"Ball: radius <b>{ball.radius:.2f} mm</b> about {center} mm"
        lines.append(f"{text}, {_of_modes(machine, modes)}")
    if sections.box is not None:
        box_, modes = sections.box
        sides = " × ".join(f"{v:.1f}" for v in box_.high - box_.low)
        center = ", ".join(map(tenths, 0.5 * (box_.low + box_.high)))
        text = f"Box: <b>{sides} mm</b> about {center} mm, {volume_text(box_.volume)}"
        lines.append(f"{text}, {_of_modes(machine, modes)}")
    return box("<br>".join(lines)) if lines else ""


def _of_modes(machine: Machine[Any], modes: Modes) -> str:
    if modes is not None and len(modes) == 1:
        return mode_text(machine, modes[0])
    count = "all" if modes is None else f"{len(modes)}"
    return f"{count} {machine.mode_noun}s together: no machine goes from one to another in it"


def regions_html(laying: Laying) -> str:
    """The regions of a plane, each with its area."""
    laid = laying.laid
    if laying.trouble:
        return red(laying.trouble)
    if laid is None:
        return ""
    if not any(region.section.loops for region in laid.regions):
        return box("At this orientation the workspace is empty.")
    drawn = [len(fill.faces) > 0 for fill in laid.fills]
    rows = []
    for region, color, shown in zip(laid.regions, region_colors(laid.regions), drawn, strict=True):
        section = region.section
        exact = f"{spaced(section.area, 6)} ± {section.area_error:.1g} mm²"
        rows.append(
            (
                f"{chip(color if shown else 'transparent')}{esc(region.title)}",
                f'<span title="{exact}">{area_text(section.area)}</span>',
                plural(section.pieces, "piece"),
                f"group {region.group}" if region.group else "",
            )
        )
    worst = max(region.deviation for region in laid.regions)
    exactly = "exact arcs" if worst == 0.0 else f"edges within {worst:.0e} mm of the true ones"
    groups = any(region.group for region in laid.regions)
    joined = " Regions of one group join through serial singularities." if groups else ""
    some = "" if all(drawn) else " Drawn are those of one mode, as others lie over them."
    curves = (
        f"<br>{chip(palette.BEYOND)}where control is lost in the present mode"
        if len(laid.locus)
        else ""
    )
    quiet = "opacity:.75;white-space:nowrap"
    told = faint(f"{exactly}.{joined}{some}")
    return box(f"{table(rows, ('', NUMERIC, quiet, quiet))}{told}{curves}")
