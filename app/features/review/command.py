"""`bohemia serve`, `bohemia designs` and `bohemia schema`."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from app.language import VARIABLE, use
from app.terminal import tables, values
from app.terminal.command import Answer, command, load, warn
from app.terminal.options import argument, design, flag, option, preset_names
from kinematics.designs.assets import asset_folder
from kinematics.errors import InputError
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


FILES = ("design", "path", "session")


def _schemas(machine: object = None) -> list[str]:
    """What there is a JSON Schema of: files, and answers of commands."""
    return [*FILES, *sorted(path.stem for path in asset_folder("schemas").glob("*.json"))]


@command("schema")
def schema(
    name: str = argument("NAME", _schemas),
    of: str | None = option("DESIGN", "of a path: whose it is", known=preset_names, files=True),
) -> None:
    """The JSON Schema of a kind of file, or of what a command prints with --json.

    NAME is design, path or session, or a command, as ik. A design file is meant as parsed TOML, a
    path file as its rows under plain keys.
    """
    if name not in _schemas():
        raise InputError(f"there is no schema {name!r}; there are {', '.join(_schemas())}")
    if of is not None and name != "path":
        raise InputError("--of: only a path is of one machine")
    click.echo(schema_text(name, of))


def schema_text(name: str, of: str | None = None) -> str:
    """A JSON Schema that there is; of a path ``of`` names the design."""
    if name not in FILES:
        return (asset_folder("schemas") / f"{name}.json").read_text(encoding="utf-8").rstrip()
    from app.review import session
    from kinematics.designs import json_schemas

    machine = None if of is None else load(of)
    axes = () if machine is None else (machine.coordinates, machine.dependent)
    makers = {
        "design": json_schemas.design_schema,
        "path": lambda: json_schemas.path_schema(*axes),
        "session": session.json_schema,
    }
    return json.dumps(makers[name](), indent=1, ensure_ascii=False)


@command("designs")
def designs() -> Answer:
    """The presets."""
    from kinematics.designs.files import presets

    keys = ("name", "mechanism", "title", "source")
    found = [tables.record(preset, *keys) for preset in presets()]
    return Answer({"designs": found}, [tables.records(found, *zip(keys, keys, strict=True))])
