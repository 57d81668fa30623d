"""SVG as text, for the page and for files alike. Knows no viser."""

from __future__ import annotations

from app.scene.palette import INK
from app.widgets.texts import esc

FONT = "system-ui, Segoe UI, Helvetica, Arial, sans-serif"
SIZE = 11.0  # px of a letter


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
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{drawn}\n' if paper else drawn
