"""A section in numbers, and the area of sections against the place of the plane."""

from __future__ import annotations

from functools import partial

import numpy as np

from app.language import tr
from app.review.units import area_text, number, spaced, tenths
from app.scene import palette
from app.widgets.axes import MOST as MARKS
from app.widgets.axes import (
    WHOLE,
    Axes,
    Figure,
    Look,
    Table,
    grid,
    middles,
    sampled,
    scales,
    thinned,
    ticks,
    upright,
)
from app.widgets.svg import AREA, BACK, EDGE, RULE, TAGGED, TEXT, label, line, tag
from app.widgets.texts import box, chip, esc, faint, table
from kinematics.answers.sections import Section, SectionSpec, Volume

COLUMNS = 336  # places along x′ of which the profile tells the area, one a pixel
DIGITS = 1  # of mm, at which the plane is put where a person points
MOST = 600  # points of the profile that are drawn


def numbers_html(section: Section, spec: SectionSpec, along: tuple[float, float] | None) -> str:
    """A section in numbers; ``along`` says where the workspace is."""
    if not section.loops:
        if along is None:
            return box(tr("workspace.empty"))
        low, high = (number(round(end, 1)) for end in along)
        return box(esc(tr("section.empty_here", axis=spec.normal, low=low, high=high)))
    first, second = spec.axes
    holes = int((section.loop_area < 0).sum())
    loops = tr("section.loops", n=section.loops)
    loops += f" ({tr('section.holes', n=holes)})" if holes else ""
    exact = f"{spaced(section.area, 6)} mm²"
    limbs = " ".join(
        f'<span style="white-space:nowrap">{chip(palette.limb_color(n))}'
        f"{tr('page.limb', n=n)}</span>"
        for n in sorted(set(section.limb.tolist()))
    )
    rows = (
        (tr("section.cut_at"), f"{esc(spec.normal)} = {number(round(section.at, 4))} mm"),
        (tr("section.perimeter"), f"{section.perimeter:.1f} mm"),
        (
            tr("section.centroid", first=esc(first), second=esc(second)),
            f"{tenths(section.centroid[0])}, {tenths(section.centroid[1])} mm",
        ),
        (tr("section.in_all"), f"{tr('page.pieces', n=section.pieces)}, {loops}"),
        (tr("section.bounded_by"), limbs),
    )
    titled = "opacity:.75;padding-right:.9em;white-space:nowrap;width:1%"
    body = table(rows, (titled, "font-variant-numeric:tabular-nums"))
    moments = "<br>".join(
        f"I<sub>{name}</sub> = {moment:.6g}".replace("e-", "e−").replace("= -", "= −") + " mm⁴"
        for name, moment in zip(
            (2 * first, 2 * second, first + second), section.second_moments.tolist(), strict=True
        )
    )
    summary = f"I<sub>{first}{first}</sub> = ∫{first}² dA"
    exactly = f"{exact}<br>{tr('section.moments', what=summary)}<br>{moments}"
    details = faint(f"<summary>{tr('section.exactly')}</summary>{exactly}", "details")
    look = "font-size:20px;line-height:24px;font-weight:600"
    area = f'<span style="{look}" title="{exact}">{area_text(section.area)}</span>'
    return box(f"<div>{faint(tr('section.area'))} {area}</div>{body}{details}")


def largest(volume: Volume) -> float:
    """Where the section is largest, mm."""
    x, area = _curve(volume)
    return float(x[int(area.argmax())])


# The drawing lies over the lower left of the scene, above the plots of a trajectory if there are.
_CUT = "[data-floating-window]:has(.bo-cut)"
WINDOW_HTML = f"""<div class="bo-cut"></div><style>
{_CUT}{{left:0!important;top:auto!important;bottom:0!important;border-radius:0!important;
height:min(505px,70vh)!important;box-shadow:none!important;border:1px solid {RULE};
background:{BACK}}}
body:has([data-floating-window] .bo-play) {_CUT}{{bottom:min(352px,50vh)!important;
height:min(448px,50vh)!important}}
{_CUT} :is([data-dock-griphandle],[data-dock-strip]){{display:none!important}}
{_CUT}>[data-dock-resize]{{display:none}}
{_CUT} .bo-shut{{position:absolute;right:2px;top:-5px;z-index:2}}
body:has([data-floating-window] .bo-cut) .bo-legend{{left:396px}}</style>"""


def profile_axes(volume: Volume, look: Look = WHOLE) -> Axes | None:
    """The axes of the profile, area in cm²; None of an empty workspace."""
    if not len(volume.at) or volume.value <= 0.0:
        return None
    x, area = _curve(volume)
    span = (float(x[0]), float(x[-1]))
    return Axes(396, 158, 40, 28, 12, 36, span, (0.0, area.max() / 80.0)).seen(look)


def _curve(volume: Volume) -> tuple[np.ndarray, np.ndarray]:
    """x′ and area from end to end, where it is zero."""
    ends = (volume.at[0], volume.at[-1])
    if len(volume.events):
        ends = (min(ends[0], volume.events[0]), max(ends[1], volume.events[-1]))
    x = np.concatenate([[ends[0]], volume.at, [ends[1]]])
    return x, np.concatenate([[0.0], volume.area, [0.0]])


def profile_places(axes: Axes) -> np.ndarray:
    """The x′ (N,) of which the profile tells the area, and to which a click goes."""
    return np.round(middles(axes.x, COLUMNS), DIGITS)


def mark(volume: Volume, axes: Axes, at: float) -> str:
    """Where the plane stands on the profile; nothing beyond its ends."""
    if not axes.x[0] <= at <= axes.x[1]:
        return ""
    x, y = axes.px(at, float(np.interp(at, *_curve(volume))) / 100.0)
    return upright(axes, at) + tag("circle", cx=x, cy=y, r=3.5, fill=TEXT)


def profile(volume: Volume, spec: SectionSpec, look: Look = WHOLE) -> Figure | None:
    """The area of the sections against the place of the plane; None of an empty workspace."""
    axes = profile_axes(volume, look)
    if axes is None:
        return None
    x, area = _curve(volume)
    kept = thinned(len(x), MOST)
    path = axes.path(np.column_stack([x, 0.01 * area])[kept].tolist())[1:]
    base = axes.px(0.0, 0.0)[1]
    left, right = axes.px(x[0], 0.0)[0], axes.px(x[-1], 0.0)[0]
    events = "".join(f"M{axes.px(float(e), 0.0)[0]:.1f} {base:g}v-6" for e in volume.events)
    closed = f"M{left:.1f} {base:g}L{path}L{right:.1f} {base:g}Z"
    xs, ys = ticks(*axes.x, MARKS), ticks(*axes.y, 3)
    look_of = {"fill_opacity": 0.16, "stroke": AREA, "stroke_width": 1.8}
    content = tag("path", class_="curve", d=closed, fill=AREA, **look_of) + line(events, EDGE)
    places = profile_places(axes)
    areas = np.interp(places, x, area)
    return Figure(
        axes,
        grid(axes, (), ys)
        + axes.clipped(content)
        + _largest(axes, x, area)
        + scales(axes, f"{spec.normal} (mm)", "", xs, ys),
        [f"{spec.normal} = {number(round(p, 1))} mm: " for p in places.tolist()],
        ("",),
        [area_text(a) for a in areas.tolist()],
        tr("section.drag"),
        tr("section.area_name"),
        partial(_table, spec, x, area),
        title=tr("section.area_along", axis=spec.normal),
        unit="cm²",
    )


def _largest(axes: Axes, x: np.ndarray, area: np.ndarray) -> str:
    """The largest area and where it is, above the curve."""
    n = int(area.argmax())
    u, v = axes.px(float(x[n]), 0.01 * float(area[n]))
    if not axes.left <= u <= axes.width - axes.right:
        return ""
    text = tr("section.most", area=0.01 * area[n], at=number(round(float(x[n]), 1)))
    room = 0.5 * 5.8 * len(text)
    middle = min(max(u, axes.left + room), axes.width - axes.right - room)
    stem = line(f"M{u:.1f} {v:.1f}v-4", TEXT, 1)
    return stem + label(middle, v - 6, text, class_="largest", fill=TEXT, **TAGGED)


def _table(spec: SectionSpec, x: np.ndarray, area: np.ndarray) -> Table:
    rows = [(tenths(float(x[n])), f"{0.01 * area[n]:.2f}") for n in sampled(len(x))]
    return (f"{spec.normal} (mm)", tr("section.area_head")), rows
