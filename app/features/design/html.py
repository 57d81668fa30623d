"""What the Design tab says: where the design comes from, what is worth knowing, and its numbers."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import groupby

from app.features.design.state import Milestone
from app.language import tr
from app.review.units import minus
from app.scene import palette
from app.widgets.texts import box, chip, edged, esc, faint, table, tone
from kinematics.answers.solutions import Finding
from kinematics.machine import machine_of
from kinematics.mechanism import Design, DesignField

LIMB = "Limb "  # how the groups of limbs begin


@lru_cache(maxsize=32)
def findings(design: Design) -> tuple[Finding, ...]:
    """What is worth knowing about a design, kept while it is on the page."""
    return machine_of(design).findings


def about_html(design: Design) -> str:
    """Its title, its source, and what was found in it."""
    lines = [f"<b>{esc(design.title or design.name)}</b>"]
    if design.source:
        lines.append(faint(esc(design.source)))
    colors = {"warning": tone("bad")}
    found = "".join(
        edged(
            f"<b>{esc(finding.title)}</b><br>{esc(finding.text)}",
            colors.get(finding.severity, tone("quiet")),
            "margin-top:0.4em",
        )
        for finding in findings(design)
    )
    return box("<br>".join(lines) + found)


def numbers_html(fields: Iterable[DesignField]) -> str:
    """The design's numbers as boxes: a row for each limb, and for each number of the whole."""
    limbs: dict[str, list[DesignField]] = defaultdict(list)
    others: dict[str, list[DesignField]] = defaultdict(list)
    for field in fields:
        one = field.group.removeprefix(LIMB).isdigit()
        (limbs if one else others)[field.group].append(field)
    parts = [_limbs(limbs)] if limbs else []
    parts += [_listed(group, fields) for group, fields in others.items()]
    return "".join(parts)


def milestones_html(kept: Sequence[Milestone], design: Design) -> str:
    """A row for each milestone, the present state marked, with what can be done with it."""
    rows, looks = [], []
    for n, milestone in enumerate(kept):
        presses = "".join(
            f'<button type="button" data-send="{what} {n}" '
            f'aria-label="{esc(tr(f"design.{what}_named", name=milestone.name))}">'
            f"{esc(tr(f'design.{what}'))}</button>"
            for what in ("compare", "restore", "write", "drop")
        )
        rows.append((esc(milestone.name), presses))
        looks.append("aria-current" if milestone.design == design else "")
    return table(rows, ("", "text-align:right;white-space:nowrap"), looks=looks)


def shown(field: DesignField) -> float:
    """A number of the design in the page's unit."""
    return math.degrees(field.value) if field.unit == "rad" else field.value


def inner(field: DesignField, value: float) -> float:
    """A number in the page's unit as the design has it."""
    return math.radians(value) if field.unit == "rad" else value


def key(field: DesignField) -> str:
    """What a box sends of which number it is."""
    return ".".join(map(str, field.path))


def _limbs(groups: dict[str, list[DesignField]]) -> str:
    first = next(iter(groups.values()))
    heads = _heads([f.label.split(maxsplit=1) for f in first])
    rows = []
    for group, fields in groups.items():
        n = int(group.removeprefix(LIMB))
        cells = "".join(f"<td>{_box(group, field)}</td>" for field in fields)
        rows.append(f"<tr><td>{chip(palette.limb_color(n))}{n}</td>{cells}</tr>")
    units = {"mm" if f.unit == "mm" else "°" for f in first if f.unit}
    told = faint(tr("design.units", units=", ".join(sorted(units))))
    return (
        f'<table class="bo-table bo-design">{heads}{"".join(rows)}</table>'
        f'<div class="bo-says">{told}</div>'
    )


def _heads(labels: list[list[str]]) -> str:
    """Two rows of heads: what neighbours share stands over all of them, "base" over x, y, z."""
    above, below = [], []
    for first, same in groupby(labels, key=lambda words: words[0]):
        words = list(same)
        above.append(f"<th colspan={len(words)}>{esc(first)}</th>")
        below += [f"<th>{esc(rest[-1] if len(rest) > 1 else '')}</th>" for rest in words]
    first_row = f"<th>{tr('page.limb_head')}</th>{''.join(above)}"
    return f"<tr>{first_row}</tr><tr><th></th>{''.join(below)}</tr>"


def _listed(group: str, fields: list[DesignField]) -> str:
    rows = "".join(
        f"<tr><td>{esc(f.label)}</td><td>{_box(group, f)}</td><td>{_unit(f)}</td></tr>"
        for f in fields
    )
    return (
        f'<table class="bo-table bo-design"><tr><th colspan=3>{esc(group)}</th></tr>{rows}</table>'
    )


def _box(group: str, field: DesignField) -> str:
    name = f"{group}: {field.label}" + (f" ({_unit(field)})" if field.unit else "")
    value = shown(field)
    whole = minus(f"{round(value, 9) + 0.0:.12g}")
    return (
        f'<input type="text" inputmode="decimal" data-edit="{esc(key(field))}" '
        f'data-of="{_unit(field)}" value="{minus(f"{value + 0.0:.4g}")}" data-whole="{whole}" '
        f'aria-label="{esc(name)}" title="{esc(name)}: {whole}">'
    )


def _unit(field: DesignField) -> str:
    return {"mm": "mm", "rad": "°"}.get(field.unit, "")
