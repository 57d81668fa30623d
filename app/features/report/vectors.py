"""SVG of the page's plot family as a drawing for a PDF: paths and letters, no pixels.

Only what `app.widgets.svg` writes is understood, which is a small part of SVG.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any
from xml.etree import ElementTree

from reportlab.graphics import shapes
from reportlab.lib.colors import Color, HexColor
from reportlab.pdfbase.pdfmetrics import stringWidth

from app.widgets.svg import plain

NARROW = 0.9  # of a text's size: the PDF's letters are wider than those of screens
FONT, BOLD = "Report", "Report-Bold"
_WORD = re.compile(r"[A-Za-z]|-?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?")
_TURN = re.compile(r"rotate\(([^)]*)\)")
_COUNT = {"M": 2, "L": 2, "H": 1, "V": 1, "A": 7, "C": 6, "Z": 0}
Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Look:
    """What elements inherit."""

    fill: str = "#000000"
    stroke: str = "none"
    width: float = 1.0
    opacity: float = 1.0
    fill_opacity: float = 1.0
    stroke_opacity: float = 1.0
    dashes: str = ""
    rule: str = "nonzero"
    size: float = 11.0
    weight: str = "400"
    anchor: str = "start"
    color: str = "#1F2933"
    join: str = "miter"
    halo: bool = False


_NAMES = {
    "fill": "fill",
    "stroke": "stroke",
    "stroke-dasharray": "dashes",
    "fill-rule": "rule",
    "font-weight": "weight",
    "text-anchor": "anchor",
    "color": "color",
    "stroke-linejoin": "join",
}
_NUMBERS = {
    "stroke-width": "width",
    "fill-opacity": "fill_opacity",
    "stroke-opacity": "stroke_opacity",
    "font-size": "size",
}


def drawing(svg: str, width: float) -> shapes.Drawing:
    """A picture, so wide (pt)."""
    root = ElementTree.fromstring(plain(svg))
    left, top, wide, high = _box(root)
    scale = width / wide
    made = shapes.Drawing(width, scale * high)
    # From y downwards to y upwards.
    group = shapes.Group(transform=(scale, 0, 0, -scale, -scale * left, scale * (top + high)))
    for part in _children(root, _inherited(root, Look())):
        group.add(part)
    made.add(group)
    return made


def _box(element: ElementTree.Element) -> tuple[float, float, float, float]:
    left, top, wide, high = map(float, element.get("viewBox", "0 0 1 1").split())
    return left, top, wide, high


def _inherited(element: ElementTree.Element, look: Look) -> Look:
    given: dict[str, Any] = {}
    for key, value in element.attrib.items():
        if key in _NAMES:
            given[_NAMES[key]] = value
        elif key in _NUMBERS:
            given[_NUMBERS[key]] = float(value)
        elif key == "opacity":
            given["opacity"] = look.opacity * float(value)
        elif key == "paint-order":
            given["halo"] = True
    return replace(look, **given)


def _children(element: ElementTree.Element, look: Look) -> Iterator[Any]:
    for child in element:
        yield from _shape(child, _inherited(child, look))


def _shape(element: ElementTree.Element, look: Look) -> Iterator[Any]:
    get = element.get

    def number(name: str, usual: float = 0.0) -> float:
        return float(get(name, usual))

    match element.tag.rpartition("}")[2]:
        case "g":
            group = shapes.Group()
            for part in _children(element, look):
                group.add(part)
            yield group
        case "svg":
            yield _clipped(element, look)
        case "path":
            yield from _painted(path_of(get("d", "")), look)
        case "polyline":
            points = [float(word) for word in _WORD.findall(get("points", ""))]
            if points:
                runs = [("M", points[:2])]
                runs += [("L", points[n : n + 2]) for n in range(2, len(points) - 1, 2)]
                yield from _painted(runs, look)
        case "rect":
            if get("width", "").endswith("%"):
                return
            yield from _painted(_rect(*map(number, ("x", "y", "width", "height"))), look)
        case "circle":
            yield from _painted(_round(*map(number, ("cx", "cy", "r"))), look)
        case "text":
            yield from _text(element, look)


def _clipped(element: ElementTree.Element, look: Look) -> shapes.Group:
    """A picture within a picture, which shows no more than its box."""
    left, top, wide, high = _box(element)
    group = shapes.Group()
    clip = _path(_rect(left, top, wide, high))
    clip.isClipPath = 1
    clip.fillColor = clip.strokeColor = None
    group.add(clip)
    for part in _children(element, look):
        group.add(part)
    return group


def _rect(x: float, y: float, wide: float, high: float) -> list[tuple[str, list[float]]]:
    corners = [(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)]
    return [("M" if n == 0 else "L", [*at]) for n, at in enumerate(corners)] + [("Z", [])]


def _round(x: float, y: float, r: float) -> list[tuple[str, list[float]]]:
    half = [("C", curve) for curve in _curves((x - r, y), r, True, (x + r, y), False)]
    rest = [("C", curve) for curve in _curves((x + r, y), r, True, (x - r, y), False)]
    return [("M", [x - r, y]), *half, *rest, ("Z", [])]


def path_of(d: str) -> list[tuple[str, list[float]]]:
    """A path as absolute moves, lines and cubic curves."""
    words = _WORD.findall(d)
    made: list[tuple[str, list[float]]] = []
    at, start, n, verb = (0.0, 0.0), (0.0, 0.0), 0, ""
    while n < len(words):
        if words[n].isalpha():
            verb = words[n]
            n += 1
        count = _COUNT[verb.upper()]
        values = [float(word) for word in words[n : n + count]]
        n += count
        own = verb.islower()
        match verb.upper():
            case "Z":
                made.append(("Z", []))
                at = start
            case "H":
                at = (at[0] + values[0] if own else values[0], at[1])
                made.append(("L", [*at]))
            case "V":
                at = (at[0], at[1] + values[0] if own else values[0])
                made.append(("L", [*at]))
            case "A":
                end = (values[5], values[6])
                end = (at[0] + end[0], at[1] + end[1]) if own else end
                turns = _curves(at, values[0], bool(values[4]), end, bool(values[3]))
                made += [("C", curve) for curve in turns]
                at = end
            case "C":
                made.append(("C", values))
                at = (values[4], values[5])
            case kind:
                at = (at[0] + values[0], at[1] + values[1]) if own else (values[0], values[1])
                made.append((kind, [*at]))
                if kind == "M":
                    start, verb = at, "l" if own else "L"
    return made


def _curves(
    start: Point, radius: float, sweep: bool, end: Point, large: bool
) -> Iterator[list[float]]:
    """An arc of a circle as cubic curves, each of no more than a quarter."""
    (x0, y0), (x1, y1) = start, end
    half = math.hypot(x1 - x0, y1 - y0) / 2
    if half < 1e-9 or radius <= 0.0:
        yield [x0, y0, x1, y1, x1, y1]
        return
    radius = max(radius, half)
    away = math.sqrt(max(radius**2 - half**2, 0.0)) * (-1.0 if large == sweep else 1.0)
    nx, ny = -(y1 - y0) / (2 * half), (x1 - x0) / (2 * half)
    cx, cy = (x0 + x1) / 2 + away * nx, (y0 + y1) / 2 + away * ny
    first = math.atan2(y0 - cy, x0 - cx)
    turn = math.atan2(y1 - cy, x1 - cx) - first
    turn += (2 * math.pi if turn < 0 else 0.0) if sweep else (-2 * math.pi if turn > 0 else 0.0)
    count = max(1, math.ceil(abs(turn) / (math.pi / 2) - 1e-9))
    step = turn / count
    k = 4 / 3 * math.tan(step / 4)
    for n in range(count):
        a, b = first + n * step, first + (n + 1) * step
        ax, ay, bx, by = math.cos(a), math.sin(a), math.cos(b), math.sin(b)
        ends = [cx + radius * bx, cy + radius * by]
        one = [cx + radius * (ax - k * ay), cy + radius * (ay + k * ax)]
        yield [*one, cx + radius * (bx + k * by), cy + radius * (by - k * bx), *ends]


def _path(runs: Sequence[tuple[str, list[float]]]) -> shapes.Path:
    path = shapes.Path()
    for kind, values in runs:
        match kind:
            case "M":
                path.moveTo(*values)
            case "L":
                path.lineTo(*values)
            case "C":
                path.curveTo(*values)
            case "Z":
                path.closePath()
    return path


def _color(code: str, look: Look, opacity: float) -> Color | None:
    code = look.color if code == "currentColor" else code
    if not code.startswith("#"):
        return None
    found, left = HexColor(code), min(max(look.opacity, 0.0), 1.0)
    # What is faint as a whole lets paper through, and not what is behind it of its own.
    red, green, blue = (1.0 - left * (1.0 - part) for part in found.rgb())
    return Color(red, green, blue, min(max(opacity, 0.0), 1.0))


def _painted(runs: Sequence[tuple[str, list[float]]], look: Look) -> Iterator[shapes.Path]:
    if not runs:
        return
    path = _path(runs)
    path.fillColor = _color(look.fill, look, look.fill_opacity)
    path.strokeColor = _color(look.stroke, look, look.stroke_opacity)
    path.strokeWidth = look.width
    path.strokeLineJoin = 1 if look.join == "round" else 0
    path.fillMode = 0 if look.rule == "evenodd" else 1
    path.strokeDashArray = [float(v) for v in look.dashes.split()] or None
    yield path


def _text(element: ElementTree.Element, look: Look) -> Iterator[Any]:
    """Letters, which stand upright in the drawing that is upside down."""
    x, y = float(element.get("x", 0.0)), float(element.get("y", 0.0))
    pieces = [(element.text or "", look, 0.0)]
    for child in element:
        pieces.append((child.text or "", _inherited(child, look), float(child.get("dx", 0.0))))
        pieces.append((child.tail or "", look, 0.0))
    widths = []
    for text, of, gap in pieces:
        widths.append(gap + stringWidth(text, _font(of), NARROW * of.size))
    shift = {"middle": -0.5, "end": -1.0}.get(look.anchor, 0.0) * sum(widths)
    turn = (1.0, 0.0, 0.0, -1.0, x, y)
    if found := _TURN.search(element.get("transform", "")):
        angle, *about = (float(v) for v in found.group(1).split())
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        px, py = about if about else (0.0, 0.0)
        u, v = px + c * (x - px) - s * (y - py), py + s * (x - px) + c * (y - py)
        turn = (c, s, s, -c, u, v)
    group = shapes.Group(transform=turn)
    for (text, of, gap), wide in zip(pieces, widths, strict=True):
        if text:
            at = shift + gap
            if of.halo:
                paper = _color(of.stroke, of, 1.0) or Color(1, 1, 1)
                tall = NARROW * of.size
                back = shapes.Rect(at - 1, -0.24 * tall, wide - gap + 2, 1.05 * tall, rx=1, ry=1)
                back.fillColor, back.strokeColor = Color(*paper.rgb(), alpha=0.75), None
                group.add(back)
            color = _color(of.fill, of, of.fill_opacity) or Color(0, 0, 0)
            made = shapes.String(at, 0, text, fontName=_font(of), fontSize=NARROW * of.size)
            made.fillColor = color
            group.add(made)
        shift += wide
    yield group


def _font(look: Look) -> str:
    return BOLD if look.weight in ("600", "700", "bold") else FONT
