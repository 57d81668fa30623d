"""`bohemia serve` and `bohemia designs`."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.language import VARIABLE, use
from app.terminal import tables, values
from app.terminal.command import Answer, command, load, warn
from app.terminal.options import design, flag, option
from kinematics.storage import exists

if TYPE_CHECKING:
    from kinematics.machine import Machine

DEFAULT_DESIGN = "rpur-table1"


@command("serve")
def serve(
    machine: Machine[Any] | None = design(required=False),
    host: str = option("ADDRESS", "address to listen on", default="127.0.0.1"),
    port: int = option(
        "N", "port to listen on", values.counted("a port", 0, 65535), default="8080"
    ),
    allow_host: tuple[str, ...] = option(
        "NAME",
        "answer under this name too, as that of this machine in its network; may be given often. "
        "Without it only under the address listened on",
        multiple=True,
    ),
    session: str | None = option(
        "FILE",
        "keep the review in this file: opened from it, and saved while it is changed",
        files=True,
    ),
    language: str | None = option(
        "NAME", f"language of the page, where a translation is known; else as ${VARIABLE} says"
    ),
    no_browser: bool = flag("do not open a browser"),
) -> None:
    """The page, in the browser. DESIGN is rpur-table1 if none is named."""
    opened = (machine or load(DEFAULT_DESIGN)).design
    from app.server import run

    use(language)

    file = None if session is None else Path(session)
    if machine is not None and file is not None and exists(file):
        warn(f"{file} holds a review, which is opened instead of {opened.name}")
    with suppress(KeyboardInterrupt):  # the usual way to stop a server
        run(
            opened,
            host=host,
            port=port,
            session=file,
            open_browser=not no_browser,
            allowed=allow_host,
        )


@command("designs")
def designs() -> Answer:
    """The presets."""
    from kinematics.designs.files import presets

    keys = ("name", "mechanism", "title", "source")
    found = [tables.record(preset, *keys) for preset in presets()]
    return Answer({"designs": found}, [tables.records(found, *zip(keys, keys, strict=True))])
