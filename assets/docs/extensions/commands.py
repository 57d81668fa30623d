"""`{commands}`: every command with its help, as the program itself says it."""

from __future__ import annotations

import click
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from app.cli import COMMANDS, bohemia

WIDTH = 88


def help_of(name: str) -> str:
    """What ``bohemia NAME --help`` prints."""
    with click.Context(bohemia, info_name="bohemia", max_content_width=WIDTH) as group:
        command = bohemia if not name else bohemia.get_command(group, name)
        assert command is not None, name
        if not name:
            return command.get_help(group)
        with click.Context(command, info_name=name, parent=group, terminal_width=WIDTH) as ctx:
            return command.get_help(ctx)


class Commands(SphinxDirective):
    def run(self) -> list[nodes.Node]:
        parts = [_fenced("")]
        parts += [f"(command-{n})=\n\n## bohemia {n}\n\n{_fenced(n)}" for n in COMMANDS]
        return self.parse_text_to_nodes("\n\n".join(parts), allow_section_headings=True)


def _fenced(name: str) -> str:
    return f"```text\n{help_of(name)}\n```"


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
