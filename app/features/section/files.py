"""Sections as files: SVG as the page draws it, and what `kinematics.plane.files` writes."""

from __future__ import annotations

from app.features.section.plot import section_svg
from app.scene.palette import limb_color, rgb
from app.terminal.files import format_known
from kinematics.answers.sections import Section, SectionSpec
from kinematics.plane.files import section_csv, section_dxf, section_loops

__all__ = ["FORMATS", "section_bytes", "section_loops"]

FORMATS: tuple[str, ...] = ("svg", "dxf", "csv")


def section_bytes(section: Section, spec: SectionSpec, kind: str, *, title: str = "") -> bytes:
    """A section as the content of a file.

    Raises:
        InputError: ``kind`` is not one of `FORMATS`.
    """
    if format_known(kind, FORMATS, "a section is") == "svg":
        return section_svg(section, spec, width=900, height=720, title=title).encode()
    if kind == "csv":
        return section_csv(section, spec).encode()
    drawing = section_dxf(section, spec, title=title, color=lambda limb: rgb(limb_color(limb)))
    return drawing.encode()
