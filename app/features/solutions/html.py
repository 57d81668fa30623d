"""What the Solutions tab says: the list as a table, and sentences."""

from __future__ import annotations

from collections.abc import Sequence

from app.features.solutions.compute import Ahead, Known, Listed, Row, partner
from app.features.solutions.state import Only, Sort
from app.language import tr
from app.review.state import Review
from app.review.units import joint_text, minus, pose_text, tenths
from app.scene import palette
from app.terminal.tables import condition_text
from app.widgets.svg import line, tag
from app.widgets.texts import Tone, aged, box, esc, faint, quiet, red, styled, table, tone, track
from kinematics.answers.modes import Mode
from kinematics.mechanism import Coordinate

TICKS = 18.0  # px, the height of a mode's picture
STEP = 7.0  # px from tick to tick


def table_html(
    listed: Listed, most: int, axes: Sequence[Coordinate], order: Sort, *, signs: bool
) -> str:
    """The solutions as a table whose rows can be pressed; ``signs``: they have modes.

    Args:
        most: so many of them.
        order: by what they are sorted.
    """
    rows = listed.rows[:most]
    if not rows:
        return ""
    heads: list[tuple[str, Sort | None]] = [(tr("modes.mode"), "mode")] if signs else []
    heads += [(c.symbol, "height" if c.key == "z" else None) for c in axes]
    heads += [("Δ", "distance"), (tr("solutions.condition_head"), "condition"), ("", None)]
    titles = "".join(_head(text, sort, order) for text, sort in heads)
    body = "".join(row_html(row, axes, signs=signs) for row in rows)
    return (
        f'<table class="bo-table bo-list"><thead><tr>{titles}</tr></thead>'
        f"<tbody>{body}</tbody></table>"
    )


def _head(text: str, sort: Sort | None, order: Sort) -> str:
    side = "" if sort == "mode" else ' class="n"'
    if sort is None:
        return f"<th{side}>{esc(text)}</th>"
    mark = " ▴" if sort == order else ""
    return (
        f'<th{side}><button type="button" data-send="sort {sort}" '
        f'title="{esc(tr(f"solutions.sort_by.{sort}"))}">{esc(text)}{mark}</button></th>'
    )


def row_html(row: Row, axes: Sequence[Coordinate], *, signs: bool = True) -> str:
    """One solution: its mode as ticks, its pose, how far it is and how well it is held."""
    numbers = [tenths(c.outer(v)) for c, v in zip(axes, row.pose, strict=True)]
    numbers += [
        tr("solutions.here") if row.here else tenths(row.distance),
        condition_text(row.condition),
    ]
    cells = [f"<td>{ticks(row.mode)}</td>"] if signs else []
    cells += [f'<td class="n">{text}</td>' for text in numbers]
    cells.append(f"<td>{_marks(row)}</td>")
    current = " aria-current" if row.here else ""
    said = esc(spoken(row, axes))
    return (
        f'<tr class="sol" data-send="go {row.identity}" tabindex="0" role="button"{current} '
        f'title="{said}" aria-label="{said}">{"".join(cells)}</tr>'
    )


def _marks(row: Row) -> str:
    """What is particular about it, in a word or two."""
    told: list[tuple[str, Tone, str]] = []
    told += [(tr("solutions.new"), "good", tr("solutions.new_hint"))] if row.new else []
    told += [] if row.within_stroke else [(tr("solutions.out"), "bad", tr("solutions.beyond_hint"))]
    told += [("×2", "near", row.remark)] if row.remark else []
    return " ".join(
        f'<small style="color:{tone(level)}" title="{esc(title)}">{text}</small>'
        for text, level, title in told
    )


def spoken(row: Row, axes: Sequence[Coordinate]) -> str:
    """All that is known of it as a sentence: "Go to solution #12, mode +−: x 50.0 …"."""
    what = tr("solutions.the_present" if row.here else "solutions.go_to", identity=row.identity)
    mode = f", {tr('modes.mode')} {minus(row.mode)}" if row.mode else ""
    lengths = [
        f"{c.symbol} {tenths(c.outer(v))}"
        for c, v in zip(axes, row.pose, strict=True)
        if c.unit == "mm"
    ]
    angles = [
        f"{c.symbol} {tenths(c.outer(v))}°"
        for c, v in zip(axes, row.pose, strict=True)
        if c.unit == "rad"
    ]
    where = " ".join([*lengths, *(["mm"] if lengths else []), *angles])
    parts = [
        where,
        "" if row.here else tr("solutions.farthest", distance=tenths(row.distance)),
        tr("solutions.condition", condition=condition_text(row.condition)),
        "" if row.within_stroke else tr("solutions.beyond"),
        row.remark,
        tr("solutions.new") if row.new else "",
    ]
    return f"{what}{mode}: {', '.join(filter(None, parts))}"


def ticks(mode: str) -> str:
    """A mode as a picture: its operation as a digit, a tick up or down for each limb."""
    known, x, middle = Mode.read(mode), 3.0, TICKS / 2
    parts = []
    for digit in known.operation:
        parts.append(f'<text x="{x:g}" y="{middle + 4:g}" fill="currentColor">{esc(digit)}</text>')
        x += STEP + 2
    for limb, sign in enumerate(known.signs):
        end = 1.0 if sign == "+" else TICKS - 1.0
        parts.append(line(f"M{x:g} {middle:g}V{end:g}", palette.limb_color(limb + 1), 5.0))
        x += STEP
    if known.signs:
        parts.append(line(f"M0 {middle:g}H{x - STEP + 3:g}", "currentColor", 0.6))
    return tag("svg", "".join(parts), viewBox=f"0 0 {x:g} {TICKS:g}", width=x, height=TICKS)


FILTERS: dict[Only, str] = {"": "all", "mode": "mode", "new": "new", "merging": "merging"}


def filter_html(atlas: Listed, chosen: Only, *, signs: bool) -> str:
    """A switch between all solutions, those of the present mode, new ones and merging ones."""
    parts = [
        f'<button type="button" data-send="only {only}" '
        f'aria-pressed="{str(only == chosen).lower()}">'
        f"{tr(f'solutions.only.{title}')} {atlas.counts.get(only, 0)}</button>"
        for only, title in FILTERS.items()
        if signs or only != "mode"
    ]
    return f'<div class="bo-switch" role="group">{"".join(parts)}</div>'


def strokes_html(spans: Sequence[tuple[Coordinate, float, float | None, float | None]]) -> str:
    """A line for each actuator: its stroke, where it stands, and the folds ahead of it.

    ``spans`` holds the coordinate, its value, and the values of the folds below and above.
    """
    styles = ("width:1.6em", "text-align:right;padding:0 .6em;width:4em", "", _AFTER)
    return table((_stroke(*s) for s in spans), styles, "table-layout:fixed;border-spacing:0 3px")


_AFTER = "padding-left:.6em;width:4em"


def _stroke(
    axis: Coordinate, value: float, below: float | None, above: float | None
) -> tuple[str, ...]:
    def at(v: float) -> float:
        return (v - axis.lower) / (axis.upper - axis.lower)

    low = at(axis.lower if below is None else below)
    high = at(axis.upper if above is None else above)
    left, right = ("free" if v is None else tenths(axis.outer(v - value)) for v in (below, above))
    folds = [(at(v), None, palette.BEYOND) for v in (below, above) if v is not None]
    color = palette.limb_color(axis.limb or 1)
    line = track([(low, high, color), *folds, (at(value), None, "currentColor")])
    return esc(axis.symbol), left, line, right


# --- sentences -----------------------------------------------------------------------------


def title(review: Review, ahead: Ahead) -> str:
    """ "ρ₃ +33.7 mm": short enough for a menu."""
    axis = review.machine.joints[ahead.index]
    way = joint_text(axis, ahead.goal - ahead.start)
    return f"{axis.symbol} {way if way.startswith('−') else f'+{way}'}"


def words(review: Review, ahead: Ahead, known: Known | None) -> str:
    """What happens there, in one or two sentences."""
    fold = ahead.fold
    if fold is None:
        return ""
    axis = review.machine.joints[ahead.index]
    text = tr(
        "solutions.raising" if ahead.longer else "solutions.lowering",
        joint=axis.symbol,
        way=joint_text(axis, abs(ahead.goal - ahead.start)),
        to=joint_text(axis, ahead.goal),
        pose=pose_text(review.machine.coordinates, fold.pose),
    )
    if fold.mode != review.mode:
        text += " " + tr("solutions.by_then", mode=minus(fold.mode))
    if fold.partner is None:
        return f"{text}. {tr('solutions.no_partner')}"
    of_this = known is not None and known.is_of(review)  # else of the machine before
    other = partner(known, fold.partner) if of_this else None
    name = tr("solutions.a_solution") if other is None else tr("solutions.solution", identity=other)
    mode = minus(fold.partner.mode)
    merges = tr("solutions.merges", name=name, mode=mode) if mode else ""
    return f"{text}. {merges or tr('solutions.merges_there', name=name)}"


def count_html(atlas: Listed, trouble: str) -> str:
    if trouble:
        return red(trouble)
    if not atlas.count:
        return box(f"<b>{tr('solutions.finding' if atlas.stale else 'solutions.none')}</b>")
    number, _, rest = atlas.count.partition(" ")
    late = f" <b>{tr('solutions.for_before')}</b>" if atlas.stale else ""
    known, _, how = atlas.how.partition(": ")
    verdict = styled(
        f"{esc(known)}{' ✓' if atlas.complete else ''}",
        f"float:right;color:{tone('good' if atlas.complete else 'near')}",
    )
    head = f'{verdict}<b class="bo-answer">{esc(number)}</b> {esc(rest)}{late}'
    told = box(f"{head}<br>{faint(esc(how))}")
    return aged(told, atlas.stale)


def remarks_html(atlas: Listed) -> str:
    looks = {True: f"color:{palette.BEYOND}", False: "opacity:0.85"}
    lines = [
        styled(esc(text[:1].upper() + text[1:]), f"padding:0.1em 0;{looks[singular]}", "div")
        for text, singular in atlas.remarks
    ]
    return box("".join(lines)) if lines else ""


def empty_html(atlas: Listed) -> str:
    what = tr("solutions.hidden", n=atlas.hidden)
    return quiet(tr("solutions.hides", what=what))
