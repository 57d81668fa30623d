"""`bohemia serve` and `bohemia designs`."""

from __future__ import annotations

import argparse
import sys
from contextlib import suppress
from pathlib import Path

from app.terminal import common, tables

DEFAULT_DESIGN = "rpur-table1"


def register(command: common.AddCommand) -> None:
    serve = command("serve", _serve, "The page, in the browser.")
    serve.add_argument(
        "design", metavar="DESIGN", nargs="?", help=f"what to open (default {DEFAULT_DESIGN})"
    )
    serve.add_argument("--host", default="127.0.0.1", help="address to listen on (%(default)s)")
    serve.add_argument("--port", type=_port, default=8080, help="port to listen on (%(default)s)")
    serve.add_argument("--session", type=Path, metavar="FILE", help="keep the review in this file")
    serve.add_argument("--no-browser", action="store_true", help="do not open a browser")

    designs = command("designs", _designs, "The presets.")
    common.add_json(designs)


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is not a port from 0 to 65535")
    return int(text)


def _serve(arguments: argparse.Namespace) -> None:
    design = common.load(arguments.design or DEFAULT_DESIGN).design
    from app.server import run

    if arguments.design and arguments.session is not None and arguments.session.exists():
        print(
            f"bohemia: warning: {arguments.session} holds a review, which is opened instead of "
            f"{arguments.design}",
            file=sys.stderr,
        )
    with suppress(KeyboardInterrupt):  # the usual way to stop a server
        run(
            design,
            host=arguments.host,
            port=arguments.port,
            session=arguments.session,
            open_browser=not arguments.no_browser,
        )


def _designs(arguments: argparse.Namespace) -> None:
    from kinematics.designs.files import presets

    found = presets()
    if arguments.json:
        keys = ("name", "mechanism", "title", "source")
        common.print_json(
            {"designs": [{key: getattr(preset, key) for key in keys} for preset in found]}
        )
        return
    rows = [(preset.name, preset.mechanism, preset.title, preset.source) for preset in found]
    print(tables.table(("name", "mechanism", "title", "source"), rows))
