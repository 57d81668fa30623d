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
from app.language import tr
from app.review.state import Review
from app.review.units import area_text, minus, spaced, tenths, volume_text
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
    if not (shown or sections):
        parts.append(faint(esc(tr("workspace.switched_off"))))
    return box("".join(parts))


def _where(review: Review) -> str:
    """Whether the machine is in the workspace."""
    if not inside(review):
        return styled(tr("workspace.outside"), f"float:right;color:{tone('bad')}")
    told = styled(tr("workspace.inside_here"), f"float:right;color:{tone('good')}")
    if not review.posture.reachable:
        mode = mode_text(review.machine, review.mode)
        told += styled(tr("workspace.not_in_mode", mode=mode), f"color:{tone('bad')}", "div")
    return told


def _exact(sections: Sections) -> str:
    """The volume by exact sections."""
    if sections.trouble:
        return red(sections.trouble)
    volume = sections.volume or sections.old_volume
    if volume is None:
        return f"<div>{tr('workspace.volume_comes')}</div>"
    exact = f"{spaced(volume.value)} ± {volume.error:,.2g} mm³".replace(",", " ")
    told = _answer(volume.value, volume.error, tr("workspace.exactly"), exact)
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
        lines.append(f"<div>{tr('workspace.empty')}</div>")
    elif built.resolution != "fine":
        lines.append(f"<div>{tr('workspace.finer_comes')}</div>")
    if built.wish.branch:
        lines.append(f"<div>{esc(tr('workspace.branch', of=built.wish.branch))}</div>")
    if solid.note:
        lines.append(f"<div>{esc(solid.note)}</div>")
    volume = volume_text(solid.volume, solid.volume_error)
    made = tr("workspace.mesh", kind=built.resolution, count=solid.triangles, volume=volume)
    if exact is not None and exact.volume is not None and exact.volume.value > 0.0:
        share = 100.0 * (solid.volume / exact.volume.value - 1.0)
        made += tr("workspace.beside_exact", share=minus(f"{share:+.2g}"))
    lines.append(faint(f"{made}; {surface_text(solid)}", "div"))
    return "".join(lines)


def _pieces(solid: BuiltSolid, here: int | None) -> str:
    """A row for each piece, that of the machine marked."""
    rows, looks = [], []
    largest = max(piece.volume for piece in solid.pieces)
    for n, piece in enumerate(solid.pieces[:MOST]):
        where = tr("workspace.machine_here") if n == here else ""
        share = f"{100.0 * piece.volume / solid.volume:.0f} %"
        color = "var(--bo-work)" if n == here else "var(--bo-bar)"
        length = bar(piece.volume / largest, color, "5px")
        rows.append((f"{n + 1}", where, volume_text(piece.volume), share, length))
        looks.append("aria-current" if n == here else "")
    if (left := len(solid.pieces) - MOST) > 0:
        rows.append(("", tr("workspace.smaller", n=left), "", "", ""))
    styles = ("width:1.4em", "", NUMERIC, f"{NUMERIC};width:3.4em", "width:30%")
    return table(
        rows,
        styles,
        heads=(
            tr("workspace.piece_head"),
            "",
            tr("workspace.volume_head"),
            tr("workspace.share_head"),
            "",
        ),
        looks=looks,
    )


PARTS = ("whole", "H1", "H2", "H3", "body", "plus", "minus")
"""Of a limb's vertex space, in the order of their columns."""


def switches_html(review: Review, specs: Sequence[SolidSpec]) -> str:
    """A row for each limb, a switch for each part of its vertex space."""
    parts = [part for part in PARTS if any(spec.key.endswith(f"/{part}") for spec in specs)]
    known = {spec.key: spec for spec in specs}
    rows = []
    for limb in sorted({spec.limb for spec in specs if spec.limb is not None}):
        cells = [f"{chip(palette.limb_color(limb))}{tr('page.limb', n=limb)}"]
        for part in parts:
            spec = known.get(f"limb{limb}/{part}")
            cells.append("" if spec is None else _switch(review, spec))
        rows.append(cells)
    heads = [tr("page.limb_head"), *(tr(f"workspace.parts.{part}") for part in parts)]
    told = table(rows, ("", *["text-align:center"] * len(parts)), heads=heads)
    return box(told + faint(tr("workspace.outlines")))


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
            else tr("workspace.no_solid")
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
        text = tr("workspace.ball_is", radius=ball.radius, center=center)
        lines.append(f"{text}, {_of_modes(machine, modes)}")
    if sections.box is not None:
        box_, modes = sections.box
        sides = " × ".join(f"{v:.1f}" for v in box_.high - box_.low)
        center = ", ".join(map(tenths, 0.5 * (box_.low + box_.high)))
        text = tr("workspace.box_is", sides=sides, center=center)
        lines.append(f"{text}, {volume_text(box_.volume)}, {_of_modes(machine, modes)}")
    return box("<br>".join(lines)) if lines else ""


def _of_modes(machine: Machine[Any], modes: Modes) -> str:
    if modes is not None and len(modes) == 1:
        return mode_text(machine, modes[0])
    if modes is None:
        return tr("workspace.of_all_modes")
    return tr("workspace.of_modes", n=len(modes))


def regions_html(laying: Laying) -> str:
    """The regions of a plane, each with its area."""
    laid = laying.laid
    if laying.trouble:
        return red(laying.trouble)
    if laid is None:
        return ""
    if not any(region.section.loops for region in laid.regions):
        return box(tr("workspace.empty"))
    drawn = [len(fill.faces) > 0 for fill in laid.fills]
    rows = []
    for region, color, shown in zip(laid.regions, region_colors(laid.regions), drawn, strict=True):
        section = region.section
        exact = f"{spaced(section.area, 6)} ± {section.area_error:.1g} mm²"
        rows.append(
            (
                f"{chip(color if shown else 'transparent')}{esc(region.title)}",
                f'<span title="{exact}">{area_text(section.area)}</span>',
                tr("page.pieces", n=section.pieces),
                tr("workspace.group", group=region.group) if region.group else "",
            )
        )
    worst = max(region.deviation for region in laid.regions)
    exactly = (
        tr("workspace.exact_arcs") if worst == 0.0 else tr("workspace.edges_within", worst=worst)
    )
    groups = any(region.group for region in laid.regions)
    joined = f" {tr('workspace.groups')}" if groups else ""
    some = "" if all(drawn) else f" {tr('workspace.one_drawn')}"
    lost = f"<br>{chip(palette.BEYOND)}{tr('workspace.lost')}"
    curves = lost if len(laid.locus) else ""
    quiet = "opacity:.75;white-space:nowrap"
    told = faint(f"{exactly}.{joined}{some}")
    return box(f"{table(rows, ('', NUMERIC, quiet, quiet))}{told}{curves}")
