"""What files share: which formats there are, and figures as pictures."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from kinematics.errors import InputError

if TYPE_CHECKING:  # loaded only where a figure is drawn
    from matplotlib.figure import Figure

DOTS = 200  # per inch


def format_known(kind: str, formats: Sequence[str], what: str) -> str:
    """The format, if it is one in which is written ``what``: "a map is".

    Raises:
        InputError: it is not.
    """
    if kind not in formats:
        known = f"{', '.join(formats[:-1])} or {formats[-1]}"
        raise InputError(f"there is no format {kind!r}; {what} written as {known}")
    return kind


def format_of(path: PurePath, formats: Sequence[str], what: str) -> str:
    """The format that a file's ending asks for; as above.

    Raises:
        InputError: it is of no format, or there is none.
    """
    kind = path.suffix.removeprefix(".").lower()
    if kind not in formats:
        got = f"has the ending .{kind}" if kind else "has no ending"
        endings = ", ".join(f".{each}" for each in formats)
        raise InputError(f"{str(path)!r} {got}; {what} written as one of {endings}")
    return kind


def picture(figure: Figure, kind: str) -> bytes:
    """A figure as "svg", the same each time, or as "png"."""
    import logging

    import matplotlib

    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it talks of its font cache
    written = io.BytesIO()
    metadata: Any = {"Date": None} if kind == "svg" else None
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "bohemia"}):
        figure.savefig(written, format=kind, dpi=DOTS, metadata=metadata)
    return written.getvalue()
