"""What the Workspace tab says: volumes, pieces, areas."""

from __future__ import annotations

from typing import Any

from app.features.section.compute import Modes, Sections
from app.features.workspace.compute import Built, Laying, Solids, inside, region_colors
from app.features.workspace.state import ASPECTS
from app.review.state import Review
from app.review.units import area_text, minus, plural, spaced, tenths, volume_text
from app.review.view import mode_text
from app.scene import palette
from app.terminal.tables import surface_text
from app.widgets.texts import NUMERIC, aged, box, chip, esc, faint, red, styled, table, tone
from kinematics.answers.sections import Volume
from kinematics.machine import Machine


def report_html(review: Review, solids: Solids) -> str:
    """Whether the machine is inside, and the solids that are no limb's."""
    where, color = ("inside", tone("good")) if inside(review) else ("outside", palette.BEYOND)
    text = f"The present position is {styled(where, f'color:{color}', 'b')} this workspace"
    if where == "inside" and not review.posture.reachable:
        text += f", but not in {mode_text(review.machine, review.mode)}, which the machine is in"
    lines = [f"{text}."]
    for wish in solids.wishes:
        key = wish.spec.key
        if wish.spec.limb is not None or key == ASPECTS:
            continue
        built, old = solids.built.get(key), solids.old.get(key)
        if built is not None:
            lines.append(_solid(built))
        elif old is not None:
            lines.append(aged(_solid(old), True, "span"))
    return box("<br>".join(lines))


def _solid(built: Built) -> str:
    solid = built.solid
    lines = []
    if solid.pieces:
        pieces = " · ".join(volume_text(p.volume) for p in solid.pieces[:8])
        whole = volume_text(solid.volume, solid.volume_error)
        head = styled(whole, "font-size:1.25em;font-weight:600")
        lines = [
            f"{head} in {plural(len(solid.pieces), 'piece')}",
            pieces + (" · …" if len(solid.pieces) > 8 else ""),
        ]
    elif built.resolution == "fine" and not solid.note:
        lines.append("At this orientation the workspace is empty.")
    elif built.resolution != "fine":
        lines.append("Nothing is large enough to be seen yet; a finer look is on its way.")
    if built.wish.branch:
        lines.append(f"The branch of {esc(built.wish.branch)}")
    if solid.note:
        lines.append(esc(solid.note))
    made = f"{built.resolution} solid · {spaced(solid.volume)} mm³ · {solid.triangles} triangles"
    lines.append(faint(f"{made}<br>{surface_text(solid)}"))
    return "<br>".join(lines)


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


def exact_html(solids: Solids, sections: Sections) -> str:
    """The volume by exact sections, beside that of the solid."""
    volume = sections.volume
    if sections.trouble:
        return red(sections.trouble)
    if volume is None:
        if sections.old_volume is None:
            return box("The exact volume is on its way …")
        return box(aged(_exact(sections.old_volume), True))
    lines = [_exact(volume)]
    built = solids.built.get("workspace")
    if built is not None and volume.value > 0.0:
        off = built.solid.volume - volume.value
        share = minus(f"{100 * off / volume.value:+.2g}")
        signed = minus(f"{off:+,.0f}".replace(",", " "))
        solid = f"the {built.resolution} solid differs by {signed} mm³ ({share} %)"
        lines.append(faint(solid))
    return box("<br>".join(lines))


def _exact(volume: Volume) -> str:
    exact = f"{volume.value:,.0f} ± {volume.error:,.2g} mm³".replace(",", " ")
    return f"Exact: <b>{volume_text(volume.value, volume.error)}</b> {faint(f'({exact})')}"


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
