"""What the Move tab draws beside its sliders."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from app.language import tr
from app.review.state import Review
from app.review.units import joint_text, minus
from app.review.view import JointRow, Limits, mode_noun
from app.scene import palette
from app.widgets.svg import line, tag
from app.widgets.texts import NUMERIC, box, chip, esc, quiet, styled, table, tone
from kinematics.answers.solutions import InverseSolutions
from kinematics.arrays import Array
from kinematics.mechanism import Coordinate

FOOT, TIP = (5.0, 25.0), (29.0, 25.0)  # of a limb's picture, px
ELBOW = {"+": (19.0, 7.0), "-": (19.0, 43.0)}


def reach_html(axis: Coordinate, spans: Array | None, low: float, high: float) -> str:
    """Where a coordinate can go, on the track of its slider from ``low`` to ``high``."""
    bands = []
    for span in np.empty((0, 2)) if spans is None else spans:
        left, right = (
            min(max((axis.outer(v) - low) / (high - low), 0.0), 1.0) for v in span.tolist()
        )
        width = max(right - left, 0.004)
        bands.append(f'<i style="left:{100 * left:.2f}%;width:{100 * width:.2f}%"></i>')
    return f'<div class="bo-reach">{"".join(bands)}</div>'


def limb_html(limb: int) -> str:
    """What gives the slider after it the colour of a limb."""
    return f'<div class="bo-limb{(limb - 1) % len(palette.LIMBS) + 1}"></div>'


def joints_html(rows: Sequence[JointRow]) -> str:
    """What is worth saying of actuators; nothing while all is well."""
    told = [
        f"{chip(palette.limb_color(row.limb))}{esc(row.symbol)} "
        f"{styled(esc(row.note), f'color:{tone(row.level)}')}"
        for row in rows
        if row.note
    ]
    return box(" &nbsp; ".join(told)) if told else ""


def limits_html(limits: Limits, most: int) -> str:
    """The nearest limits."""
    if not limits.rows:
        return quiet(tr("page.looking" if limits.stale else "move.no_limit"))
    rows = ((f"{chip(color)}{esc(what)}", far) for color, what, far in limits.rows[:most])
    return box(table(rows, ("", NUMERIC)))


def picker_html(review: Review, answered: InverseSolutions) -> str:
    """The mode as a small picture of each limb, or a button for each operation mode.

    Args:
        answered: of the review's pose.
    """
    machine = review.machine
    mode = machine.mechanism.mode(review.mode)
    known = [str(each) for each in answered.modes]
    parts = []
    if mode.operation:
        for operation in sorted({each.operation for each in answered.modes}):
            other = next(m for m in answered.modes if m.operation == operation)
            there = bool(answered.within_stroke[known.index(str(other))])
            name = f"{mode_noun(machine)} {operation}"
            hint = tr("move.reaches" if there else "move.reaches_not", mode=name)
            chosen = str(operation == mode.operation).lower()
            parts.append(
                f'<button class="bo-button" data-send="{esc(operation)}" aria-pressed="{chosen}" '
                f'aria-label="{esc(name)}" title="{esc(hint)}">{esc(name)}</button>'
            )
    for n, sign in enumerate(mode.signs):
        other = mode.with_sign(n + 1, "-" if sign == "+" else "+", machine.modes)
        at = known.index(str(other))
        value, axis = float(answered.joints[at][n]), machine.joints[n]
        free = bool(answered.within_stroke[at])
        where = joint_text(axis, value) if math.isfinite(value) else tr("move.not_closed")
        hint = tr(
            "move.flip" if free else "move.flip_beyond",
            limb=n + 1,
            sign=minus(other.signs[n]),
            joint=axis.symbol,
            value=where,
        )
        color = palette.limb_color(n + 1)
        parts.append(
            f'<button type="button" data-send="{n}" title="{esc(hint)}" '
            f'{"" if free else "data-far "}aria-label="{esc(hint)}">{_limb(sign, color)}'
            f"{n + 1} {minus(sign)}</button>"
        )
    words = tr("move.picker")
    return f'<div class="bo-modes">{"".join(parts)}{f"<p>{words}</p>" if mode.signs else ""}</div>'


def _limb(sign: str, color: str) -> str:
    (x, y), (u, v), (a, b) = FOOT, TIP, ELBOW[sign]
    ends = line(f"M{x:g} {y:g}L{u:g} {v:g}", "var(--bo-line)", 1.0)
    bars = line(f"M{x:g} {y:g}L{a:g} {b:g}L{u:g} {v:g}", color, 4.0, stroke_linejoin="round")
    foot = tag("circle", cx=x, cy=y, r=3.4, fill="var(--bo-ink)")
    elbow = tag("circle", cx=a, cy=b, r=3.6, fill="var(--bo-bg)", stroke=color, stroke_width=2.0)
    return tag("svg", ends + bars + foot + elbow, viewBox="0 0 34 50", aria_hidden="true")


def reaching_text(review: Review, answered: InverseSolutions) -> str:
    """ "1 of 32 reaches this pose"."""
    able = int(np.count_nonzero(answered.within_stroke))
    return tr("move.reaching", n=able, of=len(answered.modes))


def closure_text(residual: float) -> str:
    """ "loop closure to 6e-14 mm"."""
    if not math.isfinite(residual):
        return tr("move.open")
    return tr("move.closed_to", residual=residual) if residual else tr("move.closed")
