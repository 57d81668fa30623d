"""Where a design comes from: one that was edited no longer says that it is its origin."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from kinematics.designs.files import load_design, presets
from kinematics.mechanism import Design

MARK = "-edited"
"""What the name of an edited design ends with."""


def as_edited(design: Design) -> Design:
    """A design whose numbers were just changed, with what it may say of itself.

    One that has a source is said to be edited, and from what, by its name, title and source; once
    its numbers are those of its preset again, it is the preset again. One without a source is
    whoever's it was.
    """
    name = design.name.removesuffix(MARK)
    known = _preset(name)
    if known is not None and _numbers(design) == _numbers(known):
        return known
    if design.name.endswith(MARK) or not design.source:
        return design
    return _told(design, name)


def as_written(design: Design) -> Design:
    """A design with what its file may say: one that claims to be a preset and is none is edited."""
    known = _preset(design.name)
    if known is None or known == design:
        return design
    claims = (design.title, design.source) == (known.title, known.source)
    return as_edited(design) if claims else design


def _told(design: Any, name: str) -> Design:
    title = f"{design.title or name} (edited)"
    source = f"edited from {name or 'a design without a name'}; that is from: {design.source}"
    told: Design = replace(design, name=f"{name}{MARK}", title=title, source=source)
    return told


def _preset(name: str) -> Design | None:
    return load_design(name) if any(preset.name == name for preset in presets()) else None


def _numbers(design: Any) -> Design:
    """The design without what it says of itself."""
    bare: Design = replace(design, name="", title="", source="")
    return bare
