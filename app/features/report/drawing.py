"""The machine as a drawing of lines and areas: with its workspace, and with what its numbers are.

Seen from afar, so that lengths along one direction compare; on paper as sharp as the printer is.
Knows no viser.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from app.review.state import is_planar
from app.review.view import View
from app.scene import palette
from app.scene.camera import axes_of, toward_of
from app.scene.labels import labels
from app.scene.painting import PLAIN, Shells
from app.scene.palette import DARK, LIGHT
from app.scene.shapes import ball, base_floor, ground_cell
from app.widgets.svg import DIM, FIELD, TEXT, document, label, line, tag
from kinematics.answers.drawings import Bar, Body, Dimension, Drawing
from kinematics.arrays import Array

WIDTH = 640.0  # px, as wide as the text
MARGIN = 26.0
PIECE = 0.12  # of the machine's size: bars are drawn in pieces no longer, the farthest first
LONGEST = 0.8  # of the width is the height at the most
ARROW = 7.0  # px, the head of a dimension
SHADE, GLOSS = -0.22, 0.45  # of the outline of a bar, and of the light on it
FAINT = 0.28  # opacity of what a drawing is not about
ROLES = {
    "rod": "steel",
    "cylinder": "steel",
    "link": "steel",
    "rail": "steel",
    "joint": "joint",
    "stop": "joint",
    "platform": "platform",
    "base": "base",
    "gap": "beyond",
}
"""Which of a scheme's colours a bar has that is of no limb."""

THEMED = (
    "workspace",
    "counterpart",
    "edge",
    "silhouette",
    "section",
    *dict.fromkeys(ROLES.values()),
)


@dataclass(frozen=True, eq=False, slots=True)
class Shape:
    """A solid or a region in the scene; mm, base frame.

    Attributes:
        key, title: by which it is shown and hidden; ``on`` at first.
        vertices, faces: (V, 3) and (F, 3), turned outwards.
        lines: (S, 2, 3) its edges.
        color, edge: on a light and on a dark page.
        shells: the opacities of its far and of its near side.
    """

    key: str
    title: str
    on: bool
    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]
    lines: NDArray[np.float64]
    color: tuple[str, str]
    edge: tuple[str, str]
    shells: Shells = PLAIN


def themed(name: str) -> str:
    """A colour of the scheme as CSS, light where no style sheet says more."""
    return f"var(--sc-{name},{getattr(LIGHT, name)})"


def theme_css(*, dark: bool) -> str:
    """What those are on a page."""
    scheme = DARK if dark else LIGHT
    return "".join(f"--sc-{name}:{getattr(scheme, name)};" for name in THEMED)


def _paint(pair: tuple[str, str]) -> str:
    """A colour by light and dark as CSS, where a scheme has it."""
    names = (n for n in THEMED if (getattr(LIGHT, n), getattr(DARK, n)) == pair)
    name = next(names, "")
    return themed(name) if name else pair[0]


def bar_paint(bar: Bar) -> str:
    """The colour of a bar as CSS."""
    light, dark = (palette.bar_color(bar, "good", of) for of in (LIGHT, DARK))
    return light if light == dark else themed(ROLES[bar.role])


class Eye:
    """Looks at points from a direction and puts them on a sheet of a width, px."""

    def __init__(self, points: Array, toward: Array, *, flat: bool, width: float = WIDTH) -> None:
        right, up, back = axes_of(toward, flat=flat)
        self.turn = np.stack([right, -up, back])  # y downwards, as on the sheet
        seen = points @ self.turn.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        across, tall = (high - low)[:2]
        wide, most = width - 2 * MARGIN, LONGEST * width - 2 * MARGIN
        self.scale = float(min(wide / max(across, 1e-9), most / max(tall, 1e-9)))
        self.size = width, float(self.scale * tall + 2 * MARGIN)
        middle = 0.5 * (low + high)[:2] * self.scale
        self.shift = np.array(self.size) / 2 - middle

    def px(self, points: Array) -> Array:
        """Points (..., 3) on the sheet, (..., 2)."""
        placed: Array = self.scale * (np.asarray(points) @ self.turn[:2].T) + self.shift
        return placed

    def depth(self, points: Array) -> Array:
        """How near points (..., 3) are, mm."""
        nearness: Array = np.asarray(points) @ self.turn[2]
        return nearness


class Sheet:
    """A drawing of one machine, from one side."""

    def __init__(self, view: View, more: Iterable[Array] = (), *, plan: bool = False) -> None:
        self.view, self.drawing = view, view.drawing
        self.flat = is_planar(view.review.machine)
        ends = np.array([p for bar in self.drawing.bars for p in (bar.start, bar.end)])
        around = [self.cloud(body) for body in self.drawing.bodies]
        toward = toward_of(self.flat, "plan" if plan or self.flat else None)
        points = np.concatenate([ends, *around, *more])
        self.eye = Eye(points, toward, flat=self.flat)

    @cached_property
    def _ball(self) -> Array:
        return ball(6, 12)

    def cloud(self, body: Body) -> Array:
        """Points (N, 3) mm around a body, base frame."""
        points = np.array(body.points, dtype=float)
        if body.frame == "platform":
            points = points @ self.view.platform[:3, :3].T + self.view.platform[:3, 3]
        return (points[:, None] + body.radius * self._ball[None]).reshape(-1, 3)

    # --- what is drawn

    def ground(self, lowest: float) -> str:
        """A grid of round cells below everything, as far as the sheet is wide."""
        cell, eye = ground_cell(self.drawing), self.eye
        floor = float(np.floor((min(lowest, base_floor(self.drawing)) - 0.1 * cell) / cell) * cell)
        # Where the corners of the sheet are on the ground.
        wide, high = eye.size
        corners = (np.array([[0, 0], [wide, 0], [wide, high], [0, high]]) - eye.shift) / eye.scale
        basis = eye.turn[:2, :2]
        if abs(float(np.linalg.det(basis))) < 1e-3:
            return ""
        flat = (corners - floor * eye.turn[:2, 2]) @ np.linalg.inv(basis).T
        low, top = np.floor(flat.min(axis=0) / cell), np.ceil(flat.max(axis=0) / cell)
        path = []
        for axis in (0, 1):
            for n in np.arange(low[axis], top[axis] + 1).tolist():
                ends = np.full((2, 3), floor)
                ends[:, axis] = n * cell
                ends[:, 1 - axis] = low[1 - axis] * cell, top[1 - axis] * cell
                (x0, y0), (x1, y1) = eye.px(ends).tolist()
                path.append(f"M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}")
        inner = line("".join(path), themed("section"), 0.7, stroke_opacity=0.8)
        view = f"0 0 {wide:g} {high:.1f}"
        return tag("svg", inner, x=0, y=0, width=wide, height=high, viewBox=view)

    def machine(self, opacity: float = 1.0, limb: int | None = None) -> str:
        """All bars and bodies, the farthest first; of one ``limb`` those at full strength."""
        eye = self.eye
        parts: list[tuple[float, str, int | None]] = []
        for body in self.drawing.bodies:
            cloud = self.cloud(body)
            near = -np.inf if body.frame == "base" else float(eye.depth(cloud).mean())
            parts.append((near, self._body(body, cloud), None))
        for bar in self.drawing.bars:
            parts += [(near, piece, bar.limb) for near, piece in self._bar(bar)]
        faint: list[str] = []
        strong: list[str] = []
        for _, piece, of in sorted(parts, key=lambda part: part[0]):
            (strong if limb is None or of == limb else faint).append(piece)
        pale = tag("g", "".join(faint), opacity=FAINT) if faint else ""
        whole = "".join(strong)
        return pale + (tag("g", whole, opacity=opacity) if opacity < 1.0 else whole)

    def _body(self, body: Body, cloud: Array) -> str:
        seen = self.eye.px(cloud)
        try:
            ring = seen[ConvexHull(seen).vertices]
        except QhullError:  # no area
            return ""
        path = f"{_path(ring)}Z"
        fill = themed("platform" if body.role == "platform" else "base")
        look = {"stroke": themed("silhouette"), "stroke_width": 0.8, "stroke_linejoin": "round"}
        return tag("path", d=path, fill=fill, **look)

    def _bar(self, bar: Bar) -> Iterator[tuple[float, str]]:
        start, end = np.array(bar.start), np.array(bar.end)
        length = float(np.linalg.norm(end - start))
        if length < 1e-9 * self.drawing.size:
            return
        eye, color = self.eye, bar_paint(bar)
        radius = (0.55 if bar.role == "rail" else 1.0) * bar.radius * eye.scale
        count = max(1, int(np.ceil(length / (PIECE * self.drawing.size))))
        knots = start + np.linspace(0.0, 1.0, count + 1)[:, None] * (end - start)
        places = eye.px(knots)
        along = places[-1] - places[0]
        across = float(np.hypot(*along))
        if across < 0.3 * length * eye.scale:  # seen along its axis
            x, y = (0.5 * (places[0] + places[-1])).tolist()
            round_ = {"cx": x, "cy": y, "r": max(radius, 0.5), "fill": color}
            shown = tag("circle", **round_, stroke=themed("silhouette"), stroke_width=0.6)
            yield float(eye.depth(0.5 * (start + end))) + bar.radius, shown
            return
        side = np.array([along[1], -along[0]]) / across
        side = side if side[1] < 0 or (side[1] == 0 and side[0] < 0) else -side  # lit from above
        for a, b, p, q in zip(places, places[1:], knots, knots[1:], strict=False):
            path = _path([a, b])
            thin = 2.0 * radius
            drawn = line(path, themed("silhouette"), thin + 1.0) if thin > 1.6 else ""
            drawn += line(path, color, max(thin, 0.9))
            if thin > 3.0:
                shift = 0.4 * radius * side
                light = {"stroke_opacity": GLOSS}
                drawn += line(_path([a + shift, b + shift]), "#FFFFFF", 0.45 * thin, **light)
            yield float(eye.depth(0.5 * (p + q))), drawn

    def solid(self, shape: Shape) -> tuple[str, str]:
        """A solid: its area, to be drawn before the machine, and its edges, to be drawn after."""
        eye = self.eye
        corners = eye.px(shape.vertices)[shape.faces]
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        # Those turned to the eye wind one way, so that together they cover each place once.
        near = corners[one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0] < 0.0]
        if not len(near):
            near = corners
        path = "".join(
            f"M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}L{e:.1f} {f:.1f}Z"
            for (a, b), (c, d), (e, f) in near.tolist()
        )
        color = _paint(shape.color)
        look = {"fill": color, "fill_opacity": 0.2, "fill_rule": "nonzero"}
        area = tag("path", class_="solid", d=path, **look)
        ends = eye.px(shape.lines)
        edges = "".join(f"M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}" for (a, b), (c, d) in ends.tolist())
        return area, line(edges, _paint(shape.edge), 0.8, class_="edges", stroke_opacity=0.8)

    def names(self, limb: int | None = None) -> str:
        """The names of the joints beside them; of one ``limb`` those in ink."""
        drawing, origin = self.drawing, self.view.platform[:3, 3]
        known = {mark.name: mark for mark in drawing.points}
        parts = []
        for name, shown in labels(drawing, origin, 0.0, flat=self.flat).items():
            x, y = self.eye.px(shown.at).tolist()
            over, beside = shown.anchor.split("-")
            dy = {"top": 12.0, "center": 3.9, "bottom": -5.0}[over]
            anchor = {"left": "start", "center": "middle", "right": "end"}[beside]
            dx = {"left": 5.0, "center": 0.0, "right": -5.0}[beside]
            own = limb is None or known[name].limb == limb
            look = {"fill": TEXT if own else DIM, **_HALO}
            parts.append(label(x + dx, y + dy, shown.text, anchor, **look))
        return "".join(parts)

    def page(self, content: str, name: str) -> str:
        """All of it as a picture."""
        return document(self.eye.size, content, name=name)


_HALO = {"paint_order": "stroke", "stroke": FIELD, "stroke_width": 3.0}


def picture(
    view: View,
    shapes: Sequence[Shape],
    name: str,
    over: Callable[[Sheet], str] = lambda sheet: "",
) -> str:
    """The machine with its workspace on the ground, and ``over`` all of it something more."""
    shapes = [shape for shape in shapes if shape.on]
    sheet = Sheet(view, [shape.vertices for shape in shapes])
    solids = [sheet.solid(shape) for shape in shapes]
    lowest = min([np.inf, *(float(shape.vertices[:, 2].min()) for shape in shapes)])
    content = [sheet.ground(lowest), *(area for area, _ in solids), sheet.machine()]
    content += [*(edges for _, edges in solids), over(sheet)]
    return sheet.page("".join(content), name)


def dimensioned(view: View, name: str) -> tuple[str, int]:
    """The machine with what its numbers are, at one limb that shows them well; and which it is."""
    drawing = view.drawing
    axis = 0.22 * drawing.size
    places = [np.array([d.start, d.end]) for d in drawing.dimensions]
    tips = [axis * np.eye(3), view.platform[:3, 3] + axis * view.platform[:3, :3].T]
    sheet = Sheet(view, [*places, *tips])
    limb = _clearest(sheet, drawing)
    shown = [d for d in drawing.dimensions if d.limb in (None, limb)]
    others = [d for d in drawing.dimensions if d.kind == "direction" and d.limb != limb]
    content = [sheet.machine(limb=limb), sheet.names(limb)]
    content += [_frame(sheet, np.eye(4), "O", axis), _frame(sheet, view.platform, "O′", axis)]
    taken: list[Array] = []
    content += [_dimension(sheet, d, taken) for d in [*shown, *others]]
    return sheet.page("".join(content), name), limb


def _clearest(sheet: Sheet, drawing: Drawing) -> int:
    """The limb whose shortest dimension is longest on the sheet."""
    lengths: dict[int, float] = {}
    for d in drawing.dimensions:
        if d.limb is not None and d.kind != "direction":
            a, b = sheet.eye.px(np.array([d.start, d.end]))
            lengths[d.limb] = min(lengths.get(d.limb, np.inf), float(np.hypot(*(b - a))))
    return max(lengths, key=lengths.__getitem__, default=1)


def _frame(sheet: Sheet, at: Array, name: str, size: float) -> str:
    """Three axes at an origin with their names; of a plane two."""
    origin, parts = sheet.eye.px(at[:3, 3]), []
    mark = "′" if name.endswith("′") else ""
    for n, letter in enumerate("xyz"):
        if sheet.flat and (n == 2 or mark):
            continue
        tip = sheet.eye.px(at[:3, 3] + size * at[:3, n])
        if float(np.hypot(*(tip - origin))) < 6.0:
            continue
        parts.append(_arrow(origin, tip, DIM, 1.0))
        x, y = (tip + 9.0 * (tip - origin) / np.hypot(*(tip - origin))).tolist()
        parts.append(label(x, y + 3.5, f"{letter}{mark}", fill=DIM, font_size=10, **_HALO))
    x, y = origin.tolist()
    parts.append(tag("circle", cx=x, cy=y, r=2.4, fill=TEXT))
    if not (sheet.flat and mark):
        parts.append(label(x - 6, y + 13, name, "end", fill=TEXT, **_HALO))
    return "".join(parts)


def _dimension(sheet: Sheet, of: Dimension, taken: list[Array]) -> str:
    """An arrow with its symbol: both ends of a length or a stroke, else its tip."""
    a, b = sheet.eye.px(np.array([of.start, of.end]))
    long = float(np.hypot(*(b - a)))
    if long < 1.0:
        return ""
    unit = (b - a) / long
    normal = np.array([unit[1], -unit[0]])
    middle = np.array(sheet.eye.size) / 2
    if float(normal @ (0.5 * (a + b) - middle)) < 0.0:
        normal = -normal  # away from the machine
    drawn = ""
    if of.kind == "angle":
        turn = np.arctan2(-(b - a)[1], (b - a)[0])
        steps = np.linspace(0.0, turn, 24)
        radius = min(0.32 * long, 60.0)
        arc = a + radius * np.stack([np.cos(steps), -np.sin(steps)], axis=1)
        drawn = line(
            _path([a, a + np.array([1.5 * radius, 0.0])]), TEXT, 0.8, stroke_dasharray="3 3"
        )
        drawn += line(_path(arc), TEXT, 1.2) + _head(arc[-4], arc[-1], TEXT)
        spot = a + (radius + 13.0) * np.array([np.cos(turn / 2), -np.sin(turn / 2)])
        return drawn + _symbol(spot, of.symbol, taken)
    # Beside what it measures, with short lines across; a vector runs from point to point.
    off = 14.0 if of.kind in ("length", "stroke") else 0.0
    p, q = a + off * normal, b + off * normal
    if off:
        for end in (a, b):
            ends = [end + 3.0 * normal, end + (off + 4.0) * normal]
            drawn += line(_path(ends), TEXT, 0.7)
    drawn += _arrow(p, q, TEXT, 1.2, both=bool(off))
    places = [p + t * (q - p) + s * 10.0 * normal for t in (0.5, 0.38, 0.62) for s in (1, -1)]
    free = [x for x in places if all(np.abs(x - y).max() > 15.0 for y in taken)]
    return drawn + _symbol((free or places)[0], of.symbol, taken)


def _symbol(at: Array, text: str, taken: list[Array]) -> str:
    taken.append(at)
    x, y = at.tolist()
    look = {"fill": TEXT, "font_size": 13, "font_weight": 600, "class_": "dimension", **_HALO}
    return label(x, y + 4.5, text, **look)


def _arrow(a: Array, b: Array, color: str, width: float, *, both: bool = False) -> str:
    drawn = line(_path([a, b]), FIELD, width + 2.5, stroke_opacity=0.8)
    drawn += line(_path([a, b]), color, width) + _head(a, b, color)
    return drawn + (_head(b, a, color) if both else "")


def _head(a: Array, b: Array, color: str) -> str:
    """The head of an arrow from one point to another."""
    long = float(np.hypot(*(b - a)))
    if long < 1e-6:
        return ""
    unit = (b - a) / long
    side = np.array([unit[1], -unit[0]])
    back = b - ARROW * unit
    return tag("path", d=f"{_path([b, back + 0.32 * ARROW * side, back - 0.32 * ARROW * side])}Z",
               fill=color)  # fmt: skip


def _path(points: Iterable[Sequence[float] | Array]) -> str:
    return "M" + "L".join(f"{p[0]:.1f} {p[1]:.1f}" for p in points)
