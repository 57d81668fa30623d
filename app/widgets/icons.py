"""Icons as lines on 24 × 24, for HTML."""

from __future__ import annotations

from app.widgets.svg import tag
from app.widgets.texts import esc

_PATHS = {
    "undo": "M9 14L4 9l5-5M4 9h10a6 6 0 0 1 0 12h-3",
    "redo": "M15 14l5-5-5-5M20 9H10a6 6 0 0 0 0 12h3",
    "home": "M4 12l8-8 8 8M6 10.5V20h12v-9.5M10 20v-5h4v5",
    "save": "M12 4v11M7.5 11l4.5 4.5 4.5-4.5M4 19.5h16",
    "isometric": "M12 3l8 4.5v9L12 21l-8-4.5v-9zM12 12l8-4.5M12 12v9M12 12L4 7.5",
    "plan": "M4 4h16v16H4zM12 8v8M8 12h8",
    "front": "M3 6.5h18v11H3z",
    "side": "M7 4h10v16H7z",
    "fit": "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
    "legend": "M4 6h4M11 6h9M4 12h4M11 12h9M4 18h4M11 18h9",
    "cancel": "M7 7l10 10M17 7L7 17",
}


def icon(name: str) -> str:
    """An icon as an SVG element in the colour of the text around it."""
    return tag("svg", tag("path", d=_PATHS[name]), viewBox="0 0 24 24", aria_hidden="true")


def icon_button(
    name: str, label: str, hint: str, *, disabled: bool = False, pressed: bool | None = None
) -> str:
    """A button of `widgets.markup` with an icon, which sends its ``name``, with a ``hint``."""
    told = {"title": esc(hint), "aria_label": esc(label)}
    look = {"class_": "bo-icon", "data_send": name, **told}
    state = None if pressed is None else str(pressed).lower()
    off = "disabled" if disabled else None
    return tag("button", icon(name), type="button", aria_pressed=state, disabled=off, **look)
