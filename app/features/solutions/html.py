"""What the Solutions tab says: rows of the list as small pictures, and sentences.

A viser button shows the HTML of its icon, so a whole row of the list stands in one: it can be
clicked and reached with the keyboard as every button.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from app.features.solutions.compute import Ahead, Known, Listed, Row, partner
from app.review.state import Review
from app.review.units import joint_text, minus, pose_text, tenths
from app.scene import palette
from app.terminal.tables import condition_text
from app.widgets.texts import box, edged, esc, quiet, red, styled, table, tone, track
from kinematics.answers.modes import Mode
from kinematics.mechanism import Coordinate

HEIGHT = 26  # px of a glyph
STEP = 7  # px from tick to tick
DIAL = 10  # px, the radius of a dial

_LIMBS = "".join(f".sol .l{n + 1}{{stroke:{color}}}" for n, color in enumerate(palette.LIMBS))

_STYLE = f"""
button:has(.sol){{height:auto!important;padding:3px 4px;background:transparent!important;
color:inherit!important;border:1px solid rgba(128,138,150,.35);font-weight:400;cursor:pointer}}
button:has(.sol):hover,button:has(.sol):focus-visible{{background:rgba(86,150,220,.16)!important}}
button:has(.sol.here){{border-color:currentColor;border-width:2px}}
button:has(.sol) .mantine-Button-inner{{justify-content:flex-start}}
button:has(.sol) .mantine-Button-section,button:has(.sol) .mantine-Button-section>div{{
width:100%;height:auto;margin:0;position:static}}
div:has(>button .sol){{margin:0 4px!important;padding-bottom:3px!important}}
div:has(>div>button .sol){{max-height:19.5rem;overflow-y:auto;scrollbar-width:thin;
padding-top:8px!important}}
.sol{{display:flex;align-items:center;gap:4px;text-align:left;line-height:1.35;font-size:10.5px;
white-space:normal;font-variant-numeric:tabular-nums}}
.sol svg{{position:static!important;transform:none!important;flex:none;
height:{HEIGHT}px!important;width:auto!important;fill:none;stroke:currentColor;stroke-width:1}}
.sol .t{{stroke-width:3.5}}.sol .a{{opacity:.35}}.sol .h{{stroke-width:2}}
.sol .d{{fill:currentColor;stroke:none}}.sol q{{quotes:none;opacity:.6}}
.sol b{{font-weight:600}}.sol i{{font-style:normal;color:{tone("bad")}}}
.sol u{{text-decoration:none;border:1px solid currentColor;border-radius:3px;padding:0 3px}}
.sol .n{{position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%)}}
{_LIMBS}"""


def style(*, stale: bool) -> str:
    """What rows look like; all fade while they belong to other actuators than the present ones."""
    return f"<style>{_STYLE}{'.sol{opacity:.5}' if stale else ''}</style>"


def row_html(row: Row, axes: Sequence[Coordinate]) -> str:
    """One solution: mode, angles and place as a picture, then in numbers."""
    names = "sol here" if row.here else "sol"
    where = [c for c in axes if c.unit == "mm"]
    turned = [c for c in axes if c.unit == "rad"]
    value = {c.key: c.outer(v) for c, v in zip(axes, row.pose, strict=True)}
    first = " ".join(f"<q>{esc(c.symbol)}</q>\xa0{tenths(value[c.key])}" for c in where)
    first += "\xa0<q>mm</q> " if where else ""
    first += " ".join(f"<q>{esc(c.symbol)}</q>\xa0{tenths(value[c.key])}°" for c in turned)
    marks = (
        "<u>here</u> "
        if row.here
        else f"<q>farthest point</q> {tenths(row.distance)} <q>mm away</q> "
    )
    marks += "<u>new</u> " if row.new else ""
    second = (
        f"<q>#{row.identity}</q> {marks}<q>condition</q> {condition_text(row.condition)}"
        f"{'' if row.within_stroke else ' <i>beyond stroke</i>'}"
        f"{f' <i>{esc(row.remark)}</i>' if row.remark else ''}"
    )
    what = "The present solution" if row.here else "Go to solution"
    hint = f"{what} #{row.identity}" + (f", mode {minus(row.mode)}" if row.mode else "")
    return (
        f'<div class="{names}" title="{esc(hint)}">{glyph(row, axes)}'
        f'<div><span class="n">{esc(hint)}: </span>{first}<br>{second}</div></div>'
    )


def glyph(row: Row, axes: Sequence[Coordinate]) -> str:
    """Ticks for the working mode, a dial for each angle, a map with a dot for the place."""
    x = 3.0
    parts: list[str] = []
    middle = HEIGHT / 2
    mode = Mode.read(row.mode)
    for digit in mode.operation:
        parts.append(f'<text class="d" x="{x:g}" y="{middle + 4:g}">{esc(digit)}</text>')
        x += STEP
    for limb, sign in enumerate(mode.signs):
        end = 3 if sign == "+" else HEIGHT - 3
        parts.append(f'<path class="t l{limb % 5 + 1}" d="M{x:g} {middle:g}V{end}"/>')
        x += STEP
    if row.mode:
        parts.append(f'<path class="a" d="M0 {middle:g}H{x - STEP + 3:g}"/>')
    for axis, value in zip(axes, row.pose, strict=True):
        if axis.unit == "rad":
            x += DIAL
            tip = (x + DIAL * math.sin(value), middle - DIAL * math.cos(value))
            parts.append(f'<circle class="a" cx="{x:g}" cy="{middle:g}" r="{DIAL}"/>')
            parts.append(f'<path class="h" d="M{x:g} {middle:g}L{tip[0]:.1f} {tip[1]:.1f}"/>')
            x += DIAL + 4
    places = [
        min(max((v - c.lower) / (c.upper - c.lower), 0.0), 1.0)
        for c, v in zip(axes, row.pose, strict=True)
        if c.unit == "mm"
    ]
    side = HEIGHT - 4
    if len(places) >= 2:  # seen from above
        parts.append(f'<rect class="a" x="{x:g}" y="2" width="{side}" height="{side}"/>')
        dot = (x + side * places[0], 2 + side * (1 - places[1]))
        parts.append(f'<circle class="d" cx="{dot[0]:.1f}" cy="{dot[1]:.1f}" r="2.5"/>')
        x += side + 5
    if len(places) in (1, 3):  # how high
        level = 2 + side * (1 - places[-1])
        parts.append(f'<path class="a" d="M{x:g} 2V{2 + side}"/>')
        parts.append(f'<path class="h" d="M{x - 3:g} {level:.1f}h6"/>')
        x += 5
    return f'<svg viewBox="0 0 {x:g} {HEIGHT}" width="{x:g}">{"".join(parts)}</svg>'


def key_text(axes: Sequence[Coordinate], limbs: int) -> str:
    """What the pictures show, in the order in which they stand."""
    dials = ", ".join(c.symbol for c in axes if c.unit == "rad")
    places = [c.symbol for c in axes if c.unit == "mm"]
    parts = []
    if limbs:
        parts.append(f"ticks: side of limbs 1–{limbs}")
    if dials:
        parts.append(f"dials: {dials}")
    if len(places) >= 2:
        parts.append(f"map: {places[0]}, {places[1]}")
    if len(places) in (1, 3):
        parts.append(f"level: {places[-1]}")
    return " · ".join(parts)


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
    change = "Raising" if ahead.longer else "Lowering"
    text = (
        f"{change} {axis.symbol} by {joint_text(axis, abs(ahead.goal - ahead.start))}, to "
        f"{joint_text(axis, ahead.goal)}, ends this assembly mode at "
        f"{pose_text(review.machine.coordinates, fold.pose)}"
    )
    if fold.mode != review.mode:
        text += f" (by then in mode {minus(fold.mode)})"
    if fold.partner is None:
        return f"{text}. The branch that it merges with does not reach back to these lengths."
    of_this = known is not None and known.is_of(review)  # else of the machine before
    other = partner(known, fold.partner) if of_this else None
    name = "a solution" if other is None else f"solution #{other}"
    return f"{text}. There it merges with {name} (mode {minus(fold.partner.mode)})."


def count_html(atlas: Listed, trouble: str) -> str:
    if trouble:
        return red(trouble)
    if not atlas.count:
        return box("<b>Finding all solutions …</b>" if atlas.stale else "<b>No solutions</b>")
    color = tone("good" if atlas.complete else "near")
    late = " <b>for the lengths before</b>" if atlas.stale else ""
    head = styled(esc(atlas.count), "font-size:1.15em;font-weight:600")
    fade = "opacity:0.6" if atlas.stale else ""
    return box(edged(f"{head}{late}<br>{esc(atlas.how)}", color, fade))


def remarks_html(atlas: Listed) -> str:
    looks = {True: f"color:{palette.BEYOND}", False: "opacity:0.85"}
    lines = [
        styled(esc(text[:1].upper() + text[1:]), f"padding:0.1em 0;{looks[singular]}", "div")
        for text, singular in atlas.remarks
    ]
    return box("".join(lines)) if lines else ""


def empty_html(atlas: Listed) -> str:
    what = "the one solution" if atlas.hidden == 1 else f"all {atlas.hidden} solutions"
    return quiet(f"The filter leaves out {what}.")
