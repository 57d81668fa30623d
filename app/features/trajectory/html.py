"""What the Trajectory tab tells in words and numbers. Only text that passed `esc` goes in."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite, nan

import numpy as np

from app.features.trajectory.compute import Computed, Moved
from app.features.trajectory.files import polynomial
from app.features.trajectory.playing import first_wrong
from app.features.trajectory.state import Pose
from app.language import tr
from app.review.units import minus, page_unit, sentence, tenths
from app.scene import palette
from app.widgets.svg import BACK, BAD, DIM, EDGE, FIELD, LOST, RULE, TEXT
from app.widgets.texts import (
    NUMERIC,
    Tone,
    aged,
    box,
    chip,
    esc,
    faint,
    red,
    styled,
    table,
    tone,
)
from kinematics.mechanism import Coordinate
from kinematics.trajectories import Event, Fits

MOST = 40  # warnings that are listed
PACES = (0.25, 0.5, 1.0, 4.0)  # of the play bar's buttons
# The window over the scene's foot, as wide as the scene; in it the play bar is one row.
_WINDOW, _ROW = "[data-floating-window]:has(.bo-play)", "div:has(>div>.bo-play)"
_BUTTONS = f"{_ROW}>div:nth-child(-n+6) button"
AT_FOOT = f"""
{_WINDOW}{{left:0!important;top:auto!important;bottom:0!important;border-radius:0!important;
width:var(--bo-free,calc(100vw - 420px))!important;height:min(352px,50vh)!important;
box-shadow:none!important;border-top:1px solid {RULE};background:{BACK}}}
{_WINDOW}>[data-dock-resize],
{_WINDOW} :is([data-dock-griphandle],[data-dock-strip]){{display:none!important}}
body:has([data-floating-window] .bo-play) .bo-legend{{bottom:calc(min(352px,50vh) + 12px)}}
{_ROW}{{display:flex;flex-wrap:wrap;align-items:center;align-content:flex-start;
padding:4px 8px 0!important}}
{_ROW}>div{{padding:0 4px!important;margin:0;flex:0 0 auto}}
{_ROW}>div:has(>.bo-play){{padding:0!important}}
{_ROW}>div:nth-child(3){{flex:1 1 0;padding-right:18px!important}}
{_ROW}>div:nth-child(n+7){{flex:0 0 100%;padding:0!important}}
{_BUTTONS}{{width:auto;height:26px;min-height:26px;padding:0 8px;font-size:12px;font-weight:400;
color:{TEXT};background:{FIELD};border:1px solid {EDGE};border-radius:4px}}
{_BUTTONS}:disabled{{opacity:.5}}
{_ROW}>div:nth-child(2) button{{width:36px;padding:0}}
{_ROW}>div:nth-child(2) .mantine-Button-label{{position:absolute;opacity:0}}
{_ROW}>div:nth-child(2) .mantine-Button-inner{{justify-content:center;width:100%}}
{_ROW}>div:nth-child(2) .mantine-Button-section{{margin:0!important}}
{_ROW}>div:nth-child(2) svg{{position:static;transform:none;margin:0}}
{_ROW}>div:nth-child(-n+4)>.mantine-Flex-root>div:first-child{{opacity:0;overflow:hidden;
position:absolute!important;width:1px!important;height:1px;white-space:nowrap}}
{_ROW}>div:nth-child(4) button{{border-color:transparent!important;padding:0 7px;min-width:34px;
background:transparent!important;color:{TEXT}!important}}
{_ROW}>div:nth-child(3) .mantine-Slider-markLabel{{display:none}}
{_ROW}>div:nth-child(3) .mantine-NumberInput-root{{width:64px!important;position:relative}}
{_ROW}>div:nth-child(3) .mantine-NumberInput-root::after{{content:"s";position:absolute;right:-12px;
top:6px;font-size:12px;color:{DIM}}}
{_ROW} .mantine-Slider-track::after{{content:"";position:absolute;inset:0;border-radius:inherit}}
"""


def summary_html(moved: Moved) -> str:
    """What goes wrong first, all else that does, and how long the way is and takes."""
    if moved.missing:
        return box(esc(moved.missing))
    if moved.trouble:
        return red(sentence(moved.trouble))
    computed = moved.computed
    if computed is None:
        return box(tr("page.computing_now"))
    found = computed.found
    head = tr(
        "trajectory.travels",
        n=len(found.times),
        travel=found.travel,
        duration=computed.law.duration,
        law=tr(f"trajectory.by_law.{computed.law.kind}"),
    )
    head += _moving(found.moving_ends)
    told = (
        f"{_first(found.events)}{_events(moved, found.events)}<div>{head}{_nearest(computed)}</div>"
    )
    return box(aged(told, moved.stale))


def _first(events: Sequence[Event]) -> str:
    """What goes wrong first, in a few words."""
    if not events or first_wrong(events).kind == "near":
        return ""
    event = first_wrong(events)
    text = tr("trajectory.first", what=tr(f"trajectory.firsts.{event.kind}"), at=event.start)
    look = f"font-size:14px;line-height:20px;font-weight:600;color:{BAD}"
    return styled(text, look, "div")


def ends_html(ends: Iterable[tuple[str, Pose]], axes: Sequence[Coordinate]) -> str:
    """The ends of the straight way, a row each: numbers to type into, and a button that takes the
    present pose. Of an end that is not chosen yet they are empty.
    """
    rows = []
    for name, pose in ends:
        title = tr("trajectory.from" if name == "start" else "trajectory.to")
        cells = []
        for n, c in enumerate(axes):
            value = c.outer(pose[n]) if pose else None
            short, whole = (
                "" if value is None else minus(f"{round(value, 9) + 0.0:.{digits}g}")
                for digits in (5, 12)
            )
            cells.append(
                f'<td><input type="text" inputmode="decimal" data-edit="{name}.{n}" '
                f'data-line="{name}.line" '
                f'data-of="{page_unit(c)}" value="{short}" data-whole="{whole}" '
                f'aria-label="{esc(f"{title}: {c.symbol} ({page_unit(c)})")}" title="{whole}"></td>'
            )
        here = tr(f"trajectory.ends.{name}")
        button = f'<button class="bo-button" data-send="{name}">{esc(here)}</button>'
        rows.append(f"<tr><th>{esc(title)}</th>{''.join(cells)}<td>{button}</td></tr>")
    heads = "".join(f"<th>{esc(c.symbol)} {page_unit(c)}</th>" for c in axes)
    return (
        f'<table class="bo-table bo-design bo-ends"><tr><th></th>{heads}<th></th></tr>'
        f"{''.join(rows)}</table>"
    )


def most_html(computed: Computed) -> str:
    """The largest rate, acceleration and force of each actuator."""
    of, found = computed.asked, computed.found
    joints = of.machine.joints
    unit, force = ("°", "N·mm") if joints[0].unit == "rad" else ("mm", "N")
    forces = dict(
        zip(
            [(name.kind, name.limb) for name in found.names], found.largest("force")[0], strict=True
        )
    )
    rows = []
    for n, joint in enumerate(joints):
        limb = joint.limb or n + 1
        sizes = [joint.outer(float(found.largest(what)[0][n])) for what in ("rate", "acceleration")]
        held = forces.get(("actuation", limb), nan)
        cells = [*map(tenths, sizes), tenths(float(held))]
        rows.append((f"{chip(palette.limb_color(limb))}{esc(joint.symbol)}", *cells))
    load = " ".join(f"{v:g}" for v in of.load[:3])
    note = faint(tr("trajectory.load", load=minus(load)), "div")
    heads = ("", f"{unit}/s", f"{unit}/s²", force)
    return box(table(rows, ("", *[NUMERIC] * 3), heads=heads) + note)


def bar_html(computed: Computed | None, pace: float) -> str:
    """The look of the play bar: where on the time line something is beyond, and which speed it is.

    viser has no state of a chosen button and no marks on a track: style sheets have.
    """
    spans = []
    if computed is not None:
        whole = computed.law.duration
        wrong = [e for e in computed.found.events if e.kind != "near"]
        for event in sorted(wrong, key=lambda event: event.start):
            low, high = (100.0 * t / whole for t in (event.start, event.end))
            high = max(high, low + 0.6)
            spans.append(
                f"linear-gradient(to right,transparent {low:.2f}%,{LOST} {low:.2f}%,"
                f"{LOST} {high:.2f}%,transparent {high:.2f}%)"
            )
    marked = ",".join(spans) or "none"
    chosen = PACES.index(pace) + 1 if pace in PACES else 0
    return (
        f'<div class="bo-play"></div><style>{AT_FOOT}'
        f"{_ROW} .mantine-Slider-track::after{{background:{marked}}}"
        f"{_ROW}>div:nth-child(4) button:nth-of-type({chosen}){{background:{FIELD}!important;"
        f"border-color:{EDGE}!important;font-weight:600}}</style>"
    )


def _moving(ends: tuple[bool, bool]) -> str:
    known = {(True, True): "both", (True, False): "start", (False, True): "end"}
    return f", {tr(f'trajectory.at_speed.{known[ends]}')}" if ends in known else ""


def _nearest(computed: Computed) -> str:
    distance = computed.found.distance
    known = np.isfinite(distance)
    if not known.any() or any(e.kind == "singularity" for e in computed.found.events):
        return ""
    n = int(np.argmin(np.where(known, distance, np.inf)))
    at = computed.found.times[n]
    return "<br>" + tr("trajectory.nearest", distance=distance[n], at=at)


def _events(moved: Moved, events: Sequence[Event]) -> str:
    if not events:
        level: Tone = "good" if moved.share >= 1.0 else "quiet"
        near = "" if moved.share >= 1.0 else " " + tr("trajectory.not_all_known")
        text = tr("trajectory.all_well")
        return styled(text + near, f"color:{tone(level)}", "div")
    rows = []
    for event in events[:MOST]:
        color = palette.PLATFORM if event.kind == "near" else palette.BEYOND
        text = sentence(event.text)
        rows.append(styled(f"{chip(color)}{esc(text)}.", "margin-top:.3em", "div"))
    if len(events) > MOST:
        rows.append(f"<div>{tr('trajectory.more', n=len(events) - MOST)}</div>")
    return styled("".join(rows), "max-height:11em;overflow-y:auto", "div")


def fits_html(
    fits: Fits | None, trouble: str, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> str:
    """The polynomials with their coefficients, and the true error of the machine that follows."""
    if trouble:
        return red(sentence(trouble))
    if fits is None:
        return box(tr("page.computing_now"))
    lines = []
    for joint, row in zip(joints, fits.coefficients.tolist(), strict=True):
        color = palette.limb_color(joint.limb) if joint.limb else palette.INK
        name = styled(esc(joint.symbol) + "(t)", f"color:{color}", "b")
        terms = _superscripts(polynomial(row, digits=fits.digits))
        look = "margin-bottom:.4em;overflow-wrap:anywhere"
        lines.append(styled(f"{name} = {terms} {joint.unit}", look, "div"))
    deviation, largest = fits.deviation, fits.largest
    rows = []
    for n, axis in enumerate(axes):
        values = (deviation[0][n], largest[0][n], deviation[1][n], deviation[2][n])
        sizes = (_size(axis.outer(float(v))) for v in values)
        rows.append((f"{esc(axis.symbol)} ({page_unit(axis)})", *sizes))
    note = esc(tr("trajectory.digits_lost")) if not fits.carried else ""
    if fits.trouble:
        note = f"{esc(fits.trouble[:1].upper() + fits.trouble[1:])}."
    note = styled(note, "margin-top:.3em", "div") if note else ""
    heads = ("", "σ", tr("trajectory.largest_head"), "σ /s", "σ /s²")
    return box(
        f"{''.join(lines)}{tr('trajectory.fit_error')}"
        f"{table(rows, style='text-align:right', heads=heads)}{note}"
    )


def _size(value: float) -> str:
    return minus(f"{value:.3g}") if isfinite(value) else "–"


def _superscripts(text: str) -> str:
    words = []
    for word in minus(esc(text)).split(" "):
        base, power, exponent = word.partition("^")
        words.append(f"{base}<sup>{exponent}</sup>" if power else word)
    return " ".join(words)
