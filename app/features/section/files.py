"""Sections as files: SVG as the page draws it, and what `kinematics.plane.files` writes."""

from __future__ import annotations

from collections.abc import Sequence

from app.features.section.plot import section_svg
from app.scene.painting import piece_colors
from app.scene.palette import limb_color, mixed, rgb
from app.terminal.files import format_known
from kinematics.answers.sections import Region, Section, SectionSpec
from kinematics.plane.files import section_csv, section_dxf, section_loops

__all__ = ["FORMATS", "section_bytes", "section_loops"]

FORMATS: tuple[str, ...] = ("svg", "dxf", "csv")


def section_bytes(
    section: Section,
    spec: SectionSpec,
    kind: str,
    *,
    title: str = "",
    parts: Sequence[Region] = (),
    unit: str = "mm",
) -> bytes:
    """A section as the content of a file; drawings are in mm and of true size.

    Args:
        parts: regions of which it consists, each drawn on a layer and in a colour of its own.
        unit: of a DXF's lengths.

    Raises:
        InputError: ``kind`` is not one of `FORMATS`.
    """
    if format_known(kind, FORMATS, "a section is") == "csv":
        return section_csv(section, spec).encode()
    parts = parts if len(parts) > 1 else ()
    colors = _apart(piece_colors([region.sign for region in parts]))
    if kind == "svg":
        fills = [(region.section, color) for region, color in zip(parts, colors, strict=True)]
        drawing = section_svg(
            section, spec, width=900, height=720, true_size=True, title=title, fills=fills
        )
    else:
        layers = [
            (f"{n} {region.title}", rgb(color), region.section)
            for n, (region, color) in enumerate(zip(parts, colors, strict=True), start=1)
        ]
        drawing = section_dxf(
            section,
            spec,
            title=title,
            color=lambda limb: rgb(limb_color(limb)),
            layers=layers,
            unit=unit,
        )
    return drawing.encode()


def _apart(colors: Sequence[str]) -> list[str]:
    """Colours of which none comes twice: what comes again is lighter each time."""
    seen: dict[str, int] = {}
    shown = []
    for color in colors:
        again = seen[color] = seen.get(color, -1) + 1
        shown.append(mixed(color, 0.8 * again / (again + 3)))
    return shown
