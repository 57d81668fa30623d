"""What the page says of control, as small pieces of HTML."""

from __future__ import annotations

import math
import time

import numpy as np

from app.features.singularities.compute import Controlled, Here, Logged
from app.features.workspace.compute import Solids, piece_here
from app.features.workspace.state import ASPECTS
from app.language import tr
from app.review.state import Options, Review
from app.review.units import how_far, minus, page_unit, volume_text
from app.review.view import Fact, short_title
from app.scene import painting, palette
from app.widgets.texts import (
    NUMERIC,
    aged,
    bar,
    box,
    chip,
    edged,
    esc,
    faint,
    quiet,
    red,
    styled,
    table,
    tone,
    track,
)
from kinematics.answers.bounds import named
from kinematics.answers.clearances import Clearance, Remedy
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.singularities import AT, Measure, Singularity

LISTED = 8  # pieces that the page lists
TOLD = 9  # clearances
LINES = 20  # of the log
WAYS = 5
"""in which the design may change."""
ROUNDING = 1e-9  # of a measure in its unit: less is nothing


def held_fact(here: Here | None) -> Fact | None:
    """How far it is to where control is lost; None where nothing is known of it."""
    if here is None:
        return None
    if kinds := {s.kind: None for s in here.singular if s.measure <= AT}:
        return Fact(tr("singularities.singular"), ", ".join(kinds))
    nearest = here.nearest("parallel", "constraint")
    return None if nearest is None else Fact(how_far(nearest), tr("page.to_singularity"))


def here_html(controlled: Controlled) -> str:
    """Whether the platform is held, and how well."""
    here = controlled.here
    if controlled.trouble:
        return red(controlled.trouble)
    if here is None:
        return box(tr("page.looking"))
    parts = [_card(s) for s in here.singular]
    if here.wrenches is None:
        parts.append(tr("singularities.nothing_holds"))
    elif here.remedy is not None:
        parts.append(tr("singularities.out_of_reach"))
    elif not here.singular:
        held = styled(tr("singularities.is_held"), f"font-size:14px;color:{tone('good')}", "b")
        parts.append(f"{held} {tr('singularities.independent')}")
    return box("".join(parts))


def measures_html(here: Here | None) -> str:
    """How well the platform is held."""
    if here is None:
        return ""
    rows = [_measure(m, v) for m, v in here.measures if math.isfinite(v)]
    return box(table(rows, ("", NUMERIC, "width:36%"))) if rows else ""


def _card(singular: Singularity) -> str:
    text = tr(
        "singularities.near" if singular.measure > AT else "singularities.at", kind=singular.kind
    )
    head = styled(esc(text), f"color:{palette.BEYOND}", "b")
    why = styled(esc(singular.cause), "opacity:.8")
    return edged(f"{head}<br>{esc(singular.text)}<br>{why}", palette.BEYOND, "margin-bottom:.4em")


def _measure(measure: Measure, value: float) -> tuple[str, str, str]:
    low, high = measure.limits
    share = ""
    if low is not None and high is not None:
        share = bar((value - low) / (high - low), palette.WORKSPACE)
    return esc(measure.title), esc(measure_text(measure, value)), share


def measure_text(measure: Measure, value: float) -> str:
    """ "0.707", "146 N"; what is rounding is 0."""
    unit = f" {measure.unit}" if measure.unit else ""
    return f"{value if abs(value) >= ROUNDING else 0.0:.3g}{unit}"


def clearances_html(here: Here | None) -> str:
    if here is None or not here.clearances:
        return ""
    ways = here.clearances[:TOLD]
    most = max((abs(way.distance) for way in ways if way.angle is None), default=0.0)
    rows = []
    for way in ways:
        color, what, far = limit(way, 2)
        along = way.angle is None and most > 0.0  # a turn is not compared with a distance
        length = bar(abs(way.distance) / most, "var(--bo-bar)", "5px") if along else ""
        rows.append((f'<span title="{esc(way.text)}">{chip(color)}{esc(what)}</span>', far, length))
    heads = (tr("singularities.nearest_head"), "", "")
    return box(table(rows, ("", NUMERIC, "width:24%"), heads=heads))


def limit(way: Clearance, decimals: int = 1) -> tuple[str, str, str]:
    """A limit's colour, what it is, and how far it is."""
    lost = way.kind in ("parallel", "constraint")
    limb = palette.limb_color(way.limb) if way.limb else palette.WORKSPACE
    whose = f"{tr('page.limb', n=way.limb)}, " if way.limb else ""
    turned = tr("singularities.by_turning") if way.angle is not None else way.along
    end = "" if way.bound in ("", "link") else f" ({named(way.bound)})"
    what = f"{whose}{tr(f'limits.{way.kind}')}{end} {turned}".rstrip()
    return palette.BEYOND if lost else limb, what, how_far(way, decimals)


def ways_html(remedy: Remedy) -> str:
    if not remedy.changes:
        return ""
    rows = (
        (f"{n}", "<br>".join(esc(change.text) for change in way))
        for n, way in enumerate(remedy.changes[:WAYS], 1)
    )
    listed = table(rows, ("vertical-align:top;padding-right:.6em;width:1%",))
    return box(f"{tr('singularities.or_change')}{listed}")


def forces_html(here: Here | None) -> str:
    if here is None or here.statics is None:
        return ""
    statics, units = here.statics, here.force_units
    values = np.asarray(statics.forces)
    if not np.isfinite(values).all():
        return red(tr("singularities.no_forces"))
    rows = []
    for name, value, unit in zip(statics.names, values.tolist(), units, strict=True):
        # Bars of forces and of moments beside them are not to one scale.
        largest = max(abs(v) for v, u in zip(values.tolist(), units, strict=True) if u == unit)
        largest = max(largest, 1e-12)
        color = palette.limb_color(name.limb) if name.limb else palette.STEEL
        ends = sorted((0.5, 0.5 + 0.5 * value / largest))
        shown = minus(f"{value if abs(value) > ROUNDING * largest else 0.0:.4g}")
        rows.append(
            (
                f"{chip(color)}{esc(name.symbol)}",
                f"{shown} {unit}",
                track([(ends[0], ends[1], color), (0.5, None, "currentColor")]),
            )
        )
    forces = table(rows, ("", f"{NUMERIC};padding:0 .6em", "width:45%"), "border-spacing:0 2px")
    return box(forces + faint(tr(_POSITIVE[units[0]])))


_POSITIVE = {"N": "singularities.pushes", "N·mm": "singularities.turns"}


def pieces_html(review: Review, solids: Solids) -> str:
    """The aspects, and in which of them the machine is."""
    built = solids.built.get(ASPECTS) or solids.old.get(ASPECTS)
    if built is None:
        return ""
    solid = built.solid
    if not solid.pieces:
        return box(esc(solid.note) or tr("singularities.empty"))
    here = piece_here(review, built) if ASPECTS in solids.built else None
    scheme = palette.scheme(review[Options].dark)
    colors = painting.piece_colors([piece.sign for piece in solid.pieces], scheme)
    signs = {1: "det &gt; 0", -1: "det &lt; 0", 0: ""}
    rows = [
        (
            f"{chip(color)}{n + 1}",
            signs[piece.sign],
            *_sized(piece.volume, piece.volume_error),
            f"<b>{tr('workspace.machine_here')}</b>" if n == here else "",
        )
        for n, (piece, color) in enumerate(zip(solid.pieces, colors, strict=True))
        if n < LISTED or n == here
    ]
    looks = ["aria-current" if n == here else "" for n in range(len(solid.pieces))]
    more = len(solid.pieces) - len(rows)
    tail = f"<br>{tr('singularities.smaller', n=more)}" if more > 0 else ""
    exact = ""
    if solid.locus_residual is not None:
        exact = tr("singularities.locus_exact", error=solid.locus_residual)
        rim = solid.locus_unplaced
        exact += tr("singularities.but_for", n=rim) if rim else ""
    volume = volume_text(solid.volume, solid.volume_error)
    told = tr("singularities.pieces", volume=volume, exact=exact, kind=built.resolution)
    told = f"{told} {esc(solid.note)}"
    heads = ("#", tr("singularities.sign_head"), tr("workspace.volume_head"), "±", "")
    listed = table(rows, ("", "", NUMERIC, NUMERIC, ""), heads=heads, looks=looks)
    return box(aged(f"{listed}{tail}{faint(told, 'div')}", ASPECTS in solids.old))


def _sized(volume: float, error: float | None) -> tuple[str, str]:
    """A volume and its error, each a text."""
    value, _, unit = volume_text(volume, error).rpartition(" ")
    number, _, off = value.partition(" ± ")
    return f"{number} {unit}", off


def circles_html(here: Here | None) -> str:
    if here is None or not here.circles:
        return ""
    rows = (
        f"{chip(_LIMIT[c.limit])}<b>{math.degrees(c.radius):.4f}°</b> {esc(c.text)}"
        for c in here.circles
    )
    return box("".join(styled(row, "padding:.1em 0", "div") for row in rows))


_LIMIT = {
    "parallel": palette.BEYOND,
    "constraint": palette.BEYOND,
    "stroke": palette.WORKSPACE,
}


def comparison_html(here: Here | None, beside: Here | None) -> str:
    """Two machines in numbers; the better one of each in bold."""
    if here is None or beside is None:
        return ""
    names = [short_title(h.place.machine) for h in (here, beside)]
    rows = []
    for (measure, one), (_, two) in zip(here.measures, beside.measures, strict=False):
        better = one > two if measure.better == "high" else one < two
        if abs(one - two) > 1e-9 * max(abs(one), abs(two), 1.0):  # else it tells nothing
            rows.append(_pair(measure.title, f"{one:.4g}", f"{two:.4g}", better))
    for kind in ("parallel", "stroke"):
        found = [next((c for c in h.circles if c.limit == kind), None) for h in (here, beside)]
        if found[0] is not None and found[1] is not None:
            one, two = (math.degrees(c.radius) for c in found if c is not None)
            rows.append(_pair(tr(f"circles.{kind}"), f"{one:.3f}°", f"{two:.3f}°", one > two))
    head = "".join(styled(esc(name), "text-align:right", "th") for name in names)
    return box(f'<table style="width:100%"><tr><th></th>{head}</tr>{"".join(rows)}</table>')


def _pair(title: str, one: str, two: str, better: bool) -> str:
    cells = "".join(
        styled(esc(text), f"{NUMERIC};{'font-weight:600' if bold else ''}", "td")
        for text, bold in ((one, better), (two, not better))
    )
    return f"<tr><td>{esc(title)}</td>{cells}</tr>"


def legend_html(measure: Measure, steps: painting.Scale) -> str:
    shades = [f"background:{steps.color(n)};height:.7em" for n in range(painting.STEPS)]
    unit = f" {measure.unit}" if measure.unit else ""
    ends = "".join(styled(f"{v:.3g}{esc(unit)}", "") for v in steps.edges[[0, -1]].tolist())
    spread = styled(ends, "display:flex;justify-content:space-between", "div")
    return f"{esc(measure.title)}{table([[''] * len(shades)], shades, 'border-spacing:0')}{spread}"


def log_html(lines: tuple[Logged, ...]) -> str:
    if not lines:
        return quiet(tr("singularities.nothing_yet"))
    rows = []
    for line in lines[:LINES]:
        at = time.strftime("%H:%M:%S", time.localtime(line.at))
        rows.append(f"{styled(at, 'opacity:.6')} {esc(line.text)}")
    return box("<br>".join(rows))


def motion_html(here: Here | None) -> str:
    """What the rates asked for ask of the actuators, and which of them is another one."""
    if here is None or here.motion is None:
        return ""
    motion, machine = here.motion, here.place.machine
    axes, joints = machine.coordinates, machine.joints
    rates, accelerations = np.asarray(motion.joint_rates), np.asarray(motion.joint_accelerations)
    rows = [
        (
            f"{chip(palette.limb_color(c.limb or n + 1))}{esc(c.symbol)}",
            f"{_finite(c.outer(float(v)))} {page_unit(c)}/s",
            f"{_finite(c.outer(float(a)))} {page_unit(c)}/s²",
        )
        for n, (c, v, a) in enumerate(zip(joints, rates, accelerations, strict=True))
    ]
    speed, gain = (
        float(np.linalg.norm(np.asarray(t)[3:])) for t in (motion.twist, motion.twist_rate)
    )
    rows.append((f"{chip(palette.VELOCITY)}O′", f"{_finite(speed)} mm/s", f"{_finite(gain)} mm/s²"))
    # Which rate is not the one that was typed, as it follows from the others.
    followed = [
        tr(
            "singularities.follows",
            axis=c.symbol,
            value=_finite(c.outer(float(v))),
            unit=page_unit(c),
        )
        for c, v, typed in zip(axes, np.asarray(motion.pose_rates), here.place.rates, strict=False)
        if abs(float(v) - typed) > 1e-9 * max(1.0, abs(typed))
    ]
    told = box(table(rows, ("", NUMERIC, NUMERIC)))
    return told + (quiet("; ".join(followed)) if followed else "")


def _finite(value: float) -> str:
    return minus(f"{value:.4g}") if np.isfinite(value) else "none"


def exactness(spec: LocusSpec, curves: LocusCurves) -> str:
    """How many curves a chart has, and how exact they are."""
    if not curves.kinds:
        return tr("singularities.none_in_chart")
    worst = float(curves.residual.max(initial=0.0))
    size = f"{math.degrees(worst):.0e}°" if spec.units[0] == "rad" else f"{worst:.0e} mm"
    return tr("singularities.exact_to", n=len(curves.kinds), size=size)
