"""A section as a picture: SVG with true arcs, for files and for the page alike (Fig. 17).

Kept edges are strong in their limb's colour, the circles and lines of which they are parts faint;
how a line is dashed says which bound it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from math import atan2, ceil, cos, hypot, isfinite, pi, sin

import numpy as np

from app.scene.painting import Scale
from app.scene.palette import BEYOND, INK, INK_DARK, WORKSPACE, limb_color
from app.widgets.axes import Axes, runs, scales, ticks
from kinematics.answers.sections import BOUNDS, Construction, EdgeBound, Section, SectionSpec
from kinematics.arrays import Array

Bounds = tuple[tuple[float, float], tuple[float, float]]
"""From and to, mm, of the first and of the second axis."""

BOUND_TITLES: dict[EdgeBound, str] = {
    "rho_max": "{} max",
    "rho_min": "{} min",
    "link": "reach of the link",
    "parallel": "parallel singularity",  # of regions that are parts between singularities
}
DASHES: dict[EdgeBound, str] = {"rho_max": "", "rho_min": "6 4", "link": "1.5 3", "parallel": ""}

_PARALLEL = BOUNDS.index("parallel")
PAPER, PAPER_DARK = "#FFFFFF", "#1A1D21"
LEFT = 58.0  # px
FONT = 11.0  # px; a letter is about 0.56 of it wide
MARGIN = 0.06  # of the region's size, left free around it
LARGEST_TURN = 2.0  # rad; longer arcs are several, as SVG's flags are unsure near half a turn


@dataclass(frozen=True, eq=False, slots=True)
class Shade:
    """A measure over the plane: ``values`` (rows upwards, columns), NaN where there is none, over
    ``bounds``, coloured by ``steps``; of the section only ``part`` has it (None: all).
    """

    values: Array
    bounds: Bounds
    steps: Scale
    part: Section | None = None


def section_svg(
    section: Section,
    spec: SectionSpec,
    *,
    width: float,
    height: float,
    dark: bool = False,
    faint: bool = True,
    standalone: bool = True,
    mark: Sequence[float] | None = None,
    title: str = "",
    bounds: Bounds | None = None,
    curves: Sequence[Array] = (),
    beyond: Sequence[Array] = (),
    shade: Shade | None = None,
) -> str:
    """A section as SVG text, equal scale in both directions.

    Args:
        width, height: px of the whole picture, legend and labels included.
        dark: for a dark page.
        faint: also the curves that made the section.
        standalone: a file of its own, with background; otherwise to be put into HTML.
        mark: (2,) mm, the platform point in the plane, drawn as a small cross.
        bounds: mm to be seen at least; None to fit the section. Keeps the picture still while
            the plane moves.
        curves: each (N, 2) mm, where control is lost.
        beyond: likewise, where the machine does not come; drawn faint.
        shade: a measure to colour the section by.
    """
    ink = INK_DARK if dark else INK
    limbs = sorted({*section.limb.tolist(), *section.construction.circle_limb.tolist()})
    # An edge where control is lost, or a curve of it: in its own colour, if there is any.
    lost = bool(len(curves) or len(beyond)) or bool((section.bound == _PARALLEL).any())
    legend, legend_height = _legend(limbs, width, height, ink, spec.joint, lost=lost)
    top = 32.0 if title else 14.0
    frame = _axes(bounds or section_bounds(section), width, height, top, 44.0 + legend_height)
    inner = [_grid(frame)]
    if section.loops and shade is not None:
        inner.append(_shaded(section, frame, shade, dark))
    elif section.loops:
        inner.append(
            f'<path class="region" d="{_region(section, frame)}" fill="{WORKSPACE}" '
            f'fill-opacity="{0.5 if dark else 0.38}" fill-rule="evenodd" stroke="none"/>'
        )
    if faint:
        inner += _faint(section.construction, frame)
    inner += _strong(section, frame)
    inner += [_curve(run, frame, faint=True) for run in beyond]
    inner += [_curve(run, frame) for run in curves]
    if mark is not None:
        inner.append(_cross(frame.px(*mark), ink))
    wide, high = frame.inner
    first, second = (f"{axis} (mm)" for axis in spec.axes)
    name = escape(title or f"{spec.title} = {section.at:g} mm")
    background = f'<rect width="100%" height="100%" fill="{PAPER_DARK if dark else PAPER}"/>'
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>' if standalone else "",
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" '
        f'viewBox="0 0 {width:g} {height:g}" role="img" aria-label="{name}" color="{ink}" '
        f'font-family="system-ui, Segoe UI, Helvetica, Arial, sans-serif" font-size="{FONT:g}">',
        background if standalone else "",
        _text((LEFT, 20.0), title, ink, size=13, weight=600) if title else "",
        frame.clipped("".join(inner)),
        scales(frame, first, second, _ticks(frame.x, wide), _ticks(frame.y, high)),
        "" if section.loops else _nothing(frame, ink),
        *legend,
        "</svg>",
    ]
    return "\n".join(part for part in parts if part) + ("\n" if standalone else "")


def section_bounds(section: Section) -> Bounds:
    """What a picture of the section shows as a rule: the section, or what failed to make one."""
    if section.loops:
        points = np.concatenate([section.polyline(n, np.inf) for n in range(section.loops)])
    else:
        made = section.construction
        points = np.concatenate(
            [
                made.center - made.radius[:, None],
                made.center + made.radius[:, None],
                made.line.reshape(-1, 2),
            ]
        )
    if not len(points):
        return (-1.0, 1.0), (-1.0, 1.0)
    low, high = points.min(axis=0), points.max(axis=0)
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))


# --- axes, legend --------------------------------------------------------------------------


def _axes(bounds: Bounds, width: float, height: float, top: float, bottom: float) -> Axes:
    """Equal scale both ways, the second axis upwards, the whole panel used."""
    (u0, u1), (v0, v1) = bounds
    right = 14.0
    wide, high = max(width - LEFT - right, 20.0), max(height - top - bottom, 20.0)
    across, up = max(u1 - u0, 1e-6), max(v1 - v0, 1e-6)
    scale = (1.0 - 2 * MARGIN) * min(wide / across, high / up)
    x, y = (
        (0.5 * (low + high_) - 0.5 * size / scale, 0.5 * (low + high_) + 0.5 * size / scale)
        for (low, high_), size in zip(bounds, (wide, high), strict=True)
    )
    return Axes(LEFT + wide + right, top + high + bottom, LEFT, top, right, bottom, x, y)


def _scale(axes: Axes) -> float:
    """px a mm."""
    return axes.inner[0] / (axes.x[1] - axes.x[0])


def _ticks(span: tuple[float, float], pixels: float) -> list[float]:
    """Round numbers about 60 px apart."""
    return ticks(*span, max(int(pixels / 60.0), 1))


def _grid(axes: Axes) -> str:
    wide, high = axes.inner
    lines = [
        f"M{axes.px(x, 0.0)[0]:.2f} {axes.top:.2f}v{high:.2f}" for x in _ticks(axes.x, wide)
    ] + [f"M{axes.left:.2f} {axes.px(0.0, y)[1]:.2f}h{wide:.2f}" for y in _ticks(axes.y, high)]
    return f'<path d="{"".join(lines)}" fill="none" stroke="currentColor" stroke-opacity="0.1"/>'


def _nothing(frame: Axes, ink: str) -> str:
    place = frame.left + frame.inner[0] / 2, frame.top + 24
    return _text(place, "The section is empty here.", ink, anchor="middle", size=13)


def _legend(
    limbs: Sequence[int], width: float, height: float, ink: str, joint: str, *, lost: bool
) -> tuple[list[str], float]:
    """Which colour is which limb and which dash which bound, in rows; and how high they are."""
    entries = [(f"limb {limb}", limb_color(limb), "") for limb in limbs]
    entries += [
        (BOUND_TITLES[bound].format(joint), BEYOND if bound == "parallel" else ink, dash)
        for bound, dash in DASHES.items()
        if lost or bound != "parallel"
    ]
    rows: list[list[tuple[str, str, str]]] = [[]]
    used = 0.0
    for entry in entries:
        wide = _entry_width(entry[0])
        if rows[-1] and used + wide > width - 24:
            rows.append([])
            used = 0.0
        rows[-1].append(entry)
        used += wide
    line = FONT + 7.0
    drawn: list[str] = []
    for n, row in enumerate(rows):
        x = max((width - sum(_entry_width(text) for text, _, _ in row)) / 2, 12.0)
        y = height - (len(rows) - n) * line + 5.0
        for text, color, dash in row:
            drawn.append(
                f'<path d="M{x:.1f} {y:.1f}h22" fill="none" stroke="{color}" stroke-width="2.4"'
                f"{_dashed(dash)}/>"
            )
            drawn.append(_text((x + 28, y + 0.35 * FONT), text, ink))
            x += _entry_width(text)
    return drawn, len(rows) * line + 4.0


def _entry_width(text: str) -> float:
    return 28 + 0.56 * FONT * len(text) + 14


def _text(
    place: tuple[float, float],
    text: str,
    ink: str,
    *,
    anchor: str = "start",
    size: float = FONT,
    weight: int = 400,
    extra: str = "",
) -> str:
    bold = f' font-weight="{weight}"' if weight != 400 else ""
    other = f' font-size="{size:g}"' if size != FONT else ""
    return (
        f'<text x="{place[0]:.2f}" y="{place[1]:.2f}" fill="{ink}" text-anchor="{anchor}"'
        f"{other}{bold}{extra}>{escape(text)}</text>"
    )


# --- the section itself --------------------------------------------------------------------


def _region(section: Section, frame: Axes) -> str:
    """All loops as one path; holes are left out by the even-odd rule."""
    path: list[str] = []
    for loop in range(section.loops):
        edges = range(int(section.loop_start[loop]), int(section.loop_start[loop + 1]))
        path.append(_move(frame, section.start[edges[0]]))
        path += [_to(section, edge, frame) for edge in edges]
        path.append("Z")
    return "".join(path)


def _shaded(section: Section, frame: Axes, shade: Shade, dark: bool) -> str:
    """The measure's cells in steps of colour, and over all that does not have it paper, or what
    the region is else drawn with.
    """
    (u0, u1), (v0, v1) = shade.bounds
    rows, columns = shade.values.shape
    left, low = frame.px(u0, v0)
    right, top = frame.px(u1, v1)
    wide, high = (right - left) / columns, (low - top) / rows
    step = np.searchsorted(shade.steps.edges[1:-1], np.nan_to_num(shade.values, nan=0.0))
    step[~np.isfinite(shade.values)] = -1
    parts = []
    for n in range(len(shade.steps.edges) - 1):
        path = "".join(
            f"M{left + c * wide:.2f} {low - (r + 1) * high:.2f}h{count * wide + 0.3:.2f}"
            f"v{high + 0.3:.2f}h{-count * wide - 0.3:.2f}z"
            for r, c, count in runs(step == n)
        )
        if path:
            parts.append(f'<path class="shade" d="{path}" fill="{shade.steps.color(n)}"/>')
    part = section if shade.part is None else shade.part
    paper = PAPER_DARK if dark else PAPER
    across, up = frame.inner
    outside = f"M{frame.left - 1:g} {frame.top - 1:g}h{across + 2:g}v{up + 2:g}h{-across - 2:g}z"
    parts.append(
        f'<path class="paper" d="{outside}{_region(part, frame)}" fill="{paper}" '
        'fill-rule="evenodd" stroke="none"/>'
    )
    if shade.part is not None:
        parts.append(
            f'<path class="region" d="{_region(section, frame)}{_region(part, frame)}" '
            f'fill="{WORKSPACE}" fill-opacity="{0.5 if dark else 0.38}" fill-rule="evenodd" '
            'stroke="none"/>'
        )
    return "".join(parts)


def _curve(points: Array, frame: Axes, *, faint: bool = False) -> str:
    """One of the curves where control is lost."""
    line = "L".join("{:.2f} {:.2f}".format(*frame.px(*p)) for p in points.tolist())
    how = 'stroke-width="1.2" stroke-opacity="0.45"' if faint else 'stroke-width="2.2"'
    name = "lost-beyond" if faint else "lost"
    return f'<path class="{name}" d="M{line}" fill="none" stroke="{BEYOND}" {how}/>'


def _strong(section: Section, frame: Axes) -> Iterator[str]:
    """The kept edges, one path for each limb and bound; neighbours run on without a break."""
    for limb in np.unique(section.limb).tolist():
        for n, bound in enumerate(BOUNDS):
            edges = np.flatnonzero((section.limb == limb) & (section.bound == n)).tolist()
            if not edges:
                continue
            path: list[str] = []
            for before, edge in zip([None, *edges], edges, strict=False):
                if before is None or (section.end[before] != section.start[edge]).any():
                    path.append(_move(frame, section.start[edge]))
                path.append(_to(section, edge, frame))
            yield (
                f'<path class="edge limb{limb} {bound}" d="{"".join(path)}" fill="none" '
                f'stroke="{limb_color(limb)}" stroke-width="2.4"{_dashed(DASHES[bound])}/>'
            )


def _faint(made: Construction, frame: Axes) -> Iterator[str]:
    """The curves that made the section, where they can be seen."""
    look = 'fill="none" stroke-width="1" stroke-opacity="0.45"'
    for center, radius, limb, n in zip(
        made.center.tolist(),
        made.radius.tolist(),
        made.circle_limb.tolist(),
        made.circle_bound.tolist(),
        strict=True,
    ):
        bound = BOUNDS[n]
        kind = f'class="made limb{limb} {bound}" {look} stroke="{limb_color(limb)}"'
        yield from (
            f'<path {kind} d="{path}"{_dashed(DASHES[bound])}/>'
            for path in _visible_circle(center, radius, frame)
        )
    for (start, end), limb in zip(made.line.tolist(), made.line_limb.tolist(), strict=True):
        (x0, y0), (x1, y1) = frame.px(*start), frame.px(*end)
        yield (
            f'<path class="made limb{limb} link" {look} stroke="{limb_color(limb)}" '
            f'd="M{x0:.2f} {y0:.2f}L{x1:.2f} {y1:.2f}"{_dashed(DASHES["link"])}/>'
        )


def _visible_circle(center: Sequence[float], radius: float, frame: Axes) -> Iterator[str]:
    """A circle as a path, none if it cannot be seen; of a huge one only the part that can.

    Renderers are unsure about circles of very many pixels.
    """
    away = [0.5 * sum(span) - c for span, c in zip((frame.x, frame.y), center, strict=True)]
    distance = hypot(*away)
    reach = hypot(*frame.inner) / _scale(frame) / 2
    if abs(distance - radius) > reach or not isfinite(radius):
        return
    start, turn = 0.0, 2 * pi
    if radius > 8 * reach:
        turn = 5 * reach / radius
        start = atan2(away[1], away[0]) - turn / 2
    first = center[0] + radius * cos(start), center[1] + radius * sin(start)
    yield _move(frame, first) + _arc(center, radius, start, turn, frame)


def _move(frame: Axes, point: Sequence[float]) -> str:
    x, y = frame.px(*point)
    return f"M{x:.3f} {y:.3f}"


def _to(section: Section, edge: int, frame: Axes) -> str:
    """The path's next part: along an edge to its end."""
    radius = float(section.radius[edge])
    if not isfinite(radius):
        x, y = frame.px(*section.end[edge].tolist())
        return f"L{x:.3f} {y:.3f}"
    center = section.center[edge].tolist()
    across, up = (section.start[edge] - section.center[edge]).tolist()
    return _arc(center, radius, atan2(up, across), float(section.sweep[edge]), frame)


def _arc(center: Sequence[float], radius: float, start: float, turn: float, frame: Axes) -> str:
    parts = max(1, ceil(abs(turn) / LARGEST_TURN))
    r = radius * _scale(frame)
    flag = 0 if turn > 0 else 1  # upwards on the plane is downwards in pixels
    angles = (start + turn * n / parts for n in range(1, parts + 1))
    ends = (frame.px(center[0] + radius * cos(a), center[1] + radius * sin(a)) for a in angles)
    return "".join(f"A{r:.3f} {r:.3f} 0 0 {flag} {x:.3f} {y:.3f}" for x, y in ends)


def _cross(place: tuple[float, float], ink: str) -> str:
    x, y = place
    path = f"M{x - 5:.2f} {y:.2f}h10M{x:.2f} {y - 5:.2f}v10"
    return f'<path class="mark" d="{path}" fill="none" stroke="{ink}" stroke-width="1.6"/>'


def _dashed(dash: str) -> str:
    return f' stroke-dasharray="{dash}"' if dash else ""
