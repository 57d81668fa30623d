"""SVG as text, for the page and for files alike. Knows no viser."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import cycle
from math import floor, log10
from xml.etree import ElementTree

from app.scene.palette import INK
from app.widgets.texts import esc

# What the page's style sheet sets for light and dark; in a file the light colour that is named.
TEXT, DIM = "var(--bo-ink,#1F2933)", "var(--bo-dim,#5B6672)"
EDGE, RULE = "var(--bo-line,#7F8996)", "var(--bo-rule,#DDE2E8)"
FIELD, BACK = "var(--bo-field,#FFFFFF)", "var(--bo-bg,#FBFCFD)"
LOST, BAD = "var(--bo-singular,#D55E00)", "var(--bo-bad,#B04A00)"
AREA = "var(--bo-work,#54677C)"
TAGGED = {"paint_order": "stroke", "stroke": FIELD, "stroke_width": 3.0}  # of a text over lines
FONT = "system-ui, Segoe UI, Helvetica, Arial, sans-serif"
SIZE = 11.0  # px of a letter, which is about 0.56 of it wide
Entry = tuple[str, str, str | None]
"""Of a legend: a text, and the colour and the dashes of a line."""


def tag(name: str, content: str = "", /, **look: object) -> str:
    """An element; ``content`` and ``look`` are SVG already.

    Attributes have _ for - and behind a word of Python's; None leaves one out. Numbers are written
    to a hundredth of a px.
    """
    written = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{_plain(value)}"'
        for key, value in look.items()
        if value is not None
    )
    return f"<{name}{written}>{content}</{name}>" if content else f"<{name}{written}/>"


def _plain(value: object) -> object:
    return f"{round(value, 2) + 0.0:.10g}" if isinstance(value, float) else value


def line(
    d: str, stroke: str = "currentColor", width: float | None = None, /, **look: object
) -> str:
    """A path that is not filled; nothing for none."""
    return tag("path", d=d, fill="none", stroke=stroke, stroke_width=width, **look) if d else ""


def label(x: float, y: float, text: str, anchor: str = "middle", /, **look: object) -> str:
    """A text, in the page's own colour as a rule; nothing for none."""
    looks = {"text_anchor": anchor, "fill": "currentColor"} | look
    return tag("text", esc(text), x=x, y=y, **looks) if text else ""


def heading(x: float, y: float, title: str, unit: str = "") -> str:
    """A plot's title with its unit; nothing for none."""
    said = {"font_size": SIZE, "font_weight": 400, "fill": DIM, "dx": 8}
    whole = esc(title) + (tag("tspan", esc(unit), **said) if unit else "")
    look = {"font_size": 12, "font_weight": 600, "fill": TEXT}
    return tag("text", whole, class_="title", x=x, y=y, **look) if title else ""


def plain(picture: str) -> str:
    """A picture with the light colours, for a file, which knows no style sheet."""
    return re.sub(r"var\(--[\w-]+,([^()]*)\)", r"\1", picture)


def legend(entries: Sequence[Entry], width: float, height: float) -> tuple[str, float]:
    """What colours and dashes mean, in rows at the foot of a picture; and how high they are."""
    widths = [42 + 0.56 * SIZE * len(text) for text, _, _ in entries]
    rows: list[list[int]] = [[]]
    for n, wide in enumerate(widths):
        if rows[-1] and sum(widths[k] for k in rows[-1]) + wide > width - 24:
            rows.append([])
        rows[-1].append(n)
    high = SIZE + 7.0
    drawn: list[str] = []
    for r, row in enumerate(rows):
        x = max((width - sum(widths[n] for n in row)) / 2, 12.0)
        y = height - (len(rows) - r) * high + 5.0
        for text, color, dash in (entries[n] for n in row):
            drawn.append(line(f"M{x:.1f} {y:.1f}h22", color, 2.4, stroke_dasharray=dash))
            drawn.append(label(x + 28, y + 0.35 * SIZE, text, "start"))
            x += 42 + 0.56 * SIZE * len(text)
    return "".join(drawn), len(rows) * high + 4.0


def document(
    size: tuple[float, float],
    content: str,
    *,
    name: str | None = None,
    ink: str = INK,
    paper: str = "",
    top: float = 0.0,
) -> str:
    """A whole picture of a size (px), as a file of its own where it has ``paper``.

    Args:
        name: for who does not see it.
        top: px above zero.
    """
    wide, high = size
    background = tag("rect", y=-top, width="100%", height="100%", fill=paper) if paper else ""
    drawn = tag(
        "svg",
        background + content,
        xmlns="http://www.w3.org/2000/svg",
        width=wide,
        height=high + top,
        viewBox=f"0 {-top + 0.0:g} {wide:g} {high + top:g}",
        role=name and "img",
        aria_label=name and esc(name),
        color=ink,
        font_family=FONT,
        font_size=SIZE,
    )
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{plain(drawn)}\n' if paper else drawn


_WORD = re.compile(r"[A-Za-z]|-?\d*\.?\d+(?:e[+-]?\d+)?")
_PARTS = {"M": "xy", "L": "xy", "H": "x", "V": "y", "A": "ll---xy", "h": "l", "v": "l", "l": "ll"}
"""What the numbers of a path are: places, lengths, or neither."""


def in_mm(picture: str, unit: float, edge: float, roof: float) -> str:
    """A picture of something in true size: its user unit is a mm, and so is what it measures.

    Args:
        picture: a `document` in pixels.
        unit: mm that a pixel shows.
        edge, roof: where its left and top are to be, mm.
    """
    digits = min(max(5 - floor(log10(unit)), 3), 15)

    def written(value: float) -> str:
        return f"{value:.{digits}f}".rstrip("0").rstrip(".")

    def at(kind: str, text: str) -> str:
        return written({"x": edge, "y": roof, "l": 0.0}[kind] + unit * float(text))

    def path(d: str) -> str:
        said: list[str] = []
        kinds: Iterator[str] = iter("")
        for word in _WORD.findall(d):
            if word.isalpha():
                parts = _PARTS.get(word, "")
                kinds = cycle(parts) if parts else iter("")
                said.append(word)
            else:
                kind, gap = next(kinds), "" if said[-1].isalpha() else " "
                said.append(f"{gap}{word if kind == '-' else at(kind, word)}")
        return "".join(said)

    svg = "{http://www.w3.org/2000/svg}"
    ElementTree.register_namespace("", svg[1:-1])
    root = ElementTree.fromstring(picture)
    for element in root.iter():
        look = element.attrib
        if look.get("width") == "100%":  # all of the picture
            sizes = zip(("x", "y", "width", "height"), root.get("viewBox", "").split(), strict=True)
            look |= {name: at("l" if "h" in name else name, text) for name, text in sizes}
            continue
        for name, kind in _MEASURES.items():
            if name in look and not (element is root and kind in "xy"):
                look[name] = at(kind, look[name])
        if "d" in look:
            look["d"] = path(look["d"])
        if "stroke-dasharray" in look:
            dashes = look["stroke-dasharray"].split()
            look["stroke-dasharray"] = " ".join(at("l", dash) for dash in dashes)
        if "transform" in look:  # turned about a place
            angle, x, y = look["transform"].removeprefix("rotate(").removesuffix(")").split()
            look["transform"] = f"rotate({angle} {at('x', x)} {at('y', y)})"
        if element is not root and "viewBox" in look:
            look["viewBox"] = " ".join(map(at, "xyll", look["viewBox"].split()))
    left, top, wide, high = map(at, "xyll", root.get("viewBox", "").split())
    root.set("viewBox", f"{left} {top} {wide} {high}")
    root.set("width", f"{wide}mm")
    root.set("height", f"{high}mm")
    root.set("stroke-width", written(unit))
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


_MEASURES = {
    **dict.fromkeys(("x", "x1", "x2", "cx"), "x"),
    **dict.fromkeys(("y", "y1", "y2", "cy"), "y"),
    **dict.fromkeys(("width", "height", "r", "stroke-width", "font-size"), "l"),
}
