"""Plane regions as files."""

from __future__ import annotations

from app.features.review.files import ExportedFile, sanitized
from app.features.section.files import section_bytes
from app.features.workspace.compute import Laid
from kinematics.answers.sections import together


def regions_file(laid: Laid, kind: str) -> ExportedFile:
    """The regions as a file."""
    design = laid.wish.design
    plane = laid.spec.plane
    whole = together([region.section for region in laid.regions])
    title = design.title or design.name
    data = section_bytes(whole, plane, kind, title=title, parts=laid.regions)
    name = f"{sanitized(design.name)}_{sanitized(laid.spec.key)}"
    return ExportedFile(f"{name}.{kind}", data)
