"""What the Trajectory tab tells in words and numbers. Only text that passed `esc` goes in."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from app.features.trajectory.compute import Computed, Moved
from app.features.trajectory.files import LOST, polynomial
from app.review.units import minus, page_unit, sentence
from app.scene import palette
from app.widgets.texts import Tone, aged, box, chip, esc, red, styled, table, tone
from kinematics.mechanism import Coordinate
from kinematics.trajectories import Event, Fits

MOST = 40  # warnings that are listed
LAWS = {
    "linear": "constant velocity",
    "cubic": "cubic",
    "quintic": "quintic",
    "trapezoidal": "trapezoidal",
}


def summary_html(moved: Moved) -> str:
    """How long the way is and takes, and what is wrong on it."""
    if moved.missing:
        return box(esc(moved.missing))
    if moved.trouble:
        return red(sentence(moved.trouble))
    computed = moved.computed
    if computed is None:
        return box("Computing …")
    found = computed.found
    head = (
        f"O′ travels {found.travel:.1f} mm in {computed.law.duration:.4g} s, "
        f"{LAWS[computed.law.kind]}, {len(found.times)} samples{_moving(found.moving_ends)}"
    )
    told = f"<div>{head}{_nearest(computed)}</div>{_events(moved, found.events)}"
    return box(aged(told, moved.stale))


def _moving(ends: tuple[bool, bool]) -> str:
    told = {(True, True): "starts and ends", (True, False): "starts", (False, True): "ends"}
    return f", {told[ends]} at speed" if ends in told else ""


def _nearest(computed: Computed) -> str:
    distance = computed.found.distance
    known = np.isfinite(distance)
    if not known.any() or any(e.kind == "singularity" for e in computed.found.events):
        return ""
    n = int(np.argmin(np.where(known, distance, np.inf)))
    at = computed.found.times[n]
    return f"<br>nearest to a singularity: {distance[n]:.1f} mm, at t = {at:.3f} s"


def _events(moved: Moved, events: Sequence[Event]) -> str:
    if not events:
        level: Tone = "good" if moved.share >= 1.0 else "quiet"
        near = "" if moved.share >= 1.0 else " Distances to singularities are not all known."
        text = (
            "Nothing on the way: inside the workspace, no singularity crossed, no limit exceeded."
        )
        return styled(text + near, f"color:{tone(level)}", "div")
    rows = []
    for event in events[:MOST]:
        color = palette.PLATFORM if event.kind == "near" else palette.BEYOND
        text = sentence(event.text)
        rows.append(styled(f"{chip(color)}{esc(text)}.", "margin-top:.3em", "div"))
    if len(events) > MOST:
        rows.append(f"<div>… and {len(events) - MOST} more</div>")
    return styled("".join(rows), "max-height:11em;overflow-y:auto", "div")


def fits_html(
    fits: Fits | None, trouble: str, axes: Sequence[Coordinate], joints: Sequence[Coordinate]
) -> str:
    """The polynomials with their coefficients, and the true error of the machine that follows."""
    if trouble:
        return red(sentence(trouble))
    if fits is None:
        return box("Computing …")
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
    note = esc(LOST) if not fits.carried else ""
    if fits.trouble:
        note = f"{esc(fits.trouble[:1].upper() + fits.trouble[1:])}."
    note = styled(note, "margin-top:.3em", "div") if note else ""
    heads = ("", "σ", "largest", "σ /s", "σ /s²")
    return box(
        f"{''.join(lines)}True error of the machine that follows them, FK(fit) − path:"
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
