"""Pictures of machines, drawn by Bohemia when the documentation is built.

`{machine} NAME` shows a preset with what its numbers are, `{moving} NAME MODE` lets it move, and
`{gallery}` shows all presets.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

from docutils import nodes
from moving import moving
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import kinematics as kin
from app.features.report import drawing
from app.review.state import new_review
from app.review.view import view

TITLES = {
    "five_rpur": "5-RPUR",
    "four_sps_spr": "4-SPS + 1-SPR",
    "three_rps": "3-RPS",
    "three_spr": "3-SPR",
    "five_bar": "Planar five-bar",
    "parallel": "Machines described by their limbs",
}


def _figure(svg: str, caption: str, name: str = "") -> list[nodes.Node]:
    start = f'<figure class="machine"{f" id={name!r}" if name else ""}>{svg}'
    return [nodes.raw("", f"{start}<figcaption>{caption}</figcaption></figure>", format="html")]


class Machine(SphinxDirective):
    """A preset at home with the symbols of its numbers, at one of its limbs."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        machine = kin.open(name)
        svg, limb = drawing.dimensioned(view(new_review(machine.design)), name)
        known = [d for d in machine.drawing(machine.home).dimensions if d.limb in (None, limb)]
        said = ", ".join(dict.fromkeys(f"{d.symbol} {d.text}" for d in known))
        return _figure(svg, f"<code>{name}</code> at home: {said}")


class Moving(SphinxDirective):
    """A preset that runs round in its workspace."""

    required_arguments = 2

    def run(self) -> list[nodes.Node]:
        return _figure(*moving(*self.arguments))


class Gallery(SphinxDirective):
    """All presets, by kind."""

    def run(self) -> list[nodes.Node]:
        kinds = defaultdict(list)
        for preset in kin.presets():
            kinds[preset.mechanism].append(preset)
        text = []
        for kind, title in TITLES.items():
            text.append(f"## {title}")
            for preset in kinds.pop(kind):
                text.append(
                    f"### {preset.name}\n\n{preset.title}.\n\n```{{portrait}} {preset.name}\n```"
                )
                text.append(f"*{preset.source}*")
        assert not kinds, f"name {', '.join(kinds)} in TITLES"
        return self.parse_text_to_nodes("\n\n".join(text), allow_section_headings=True)


class Portrait(SphinxDirective):
    """A preset at home on its ground, and what it is in a line."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        name = self.arguments[0]
        machine = kin.open(name)
        sheet = drawing.Sheet(view(new_review(machine.design)))
        svg = sheet.page(sheet.ground(float("inf")) + sheet.machine(), name)
        moved = ", ".join(axis.symbol for axis in machine.coordinates)
        many = (
            f"{len(machine.modes)} {machine.mode_noun}s" if len(machine.modes) > 1 else "one mode"
        )
        driven = ", ".join(axis.symbol for axis in machine.joints)
        return _figure(svg, f"moves {moved} by {driven}; {many}")


def _colours(app: Sphinx, exception: Exception | None) -> None:
    """The colours of the scene, light and dark, for the pictures in the pages."""
    if exception is not None or app.builder.format != "html":
        return
    dark = f"{{{drawing.theme_css(dark=True)}}}"
    css = f"body{{{drawing.theme_css(dark=False)}}}\n"
    css += f"@media(prefers-color-scheme:dark){{body:not([data-theme=light]){dark}}}\n"
    css += f"body[data-theme=dark]{dark}\n"
    (Path(app.outdir) / "_static" / "scene.css").write_text(css, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    for name, directive in (
        ("machine", Machine),
        ("moving", Moving),
        ("gallery", Gallery),
        ("portrait", Portrait),
    ):
        app.add_directive(name, directive)
    app.add_css_file("scene.css")
    app.connect("build-finished", _colours, priority=100)  # before the links are checked
    return {"parallel_read_safe": True, "parallel_write_safe": True}
