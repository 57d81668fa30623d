"""A review as one file: what is saved on every settled change, handed to a colleague, reopened."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from app.language import tr
from app.review import content as read
from app.review.state import Review, new_review
from app.review.units import within
from kinematics.designs.files import load_design, presets, read_design, write_design
from kinematics.designs.json_schemas import DIALECT
from kinematics.errors import InputError
from kinematics.mechanism import mechanism_kinds
from kinematics.storage import read_text, write_file

VERSION = 1
MAX_BYTES = 1 << 20


def to_text(review: Review) -> str:
    """The review as JSON; angles in degrees, the design as it would stand in its own file."""
    coordinates = review.machine.coordinates
    content = {
        "bohemia_session": VERSION,
        "design_name": review.design.name,
        "design": write_design(review.design),
        "pose": {read.key_of(c): c.outer(v) for c, v in zip(coordinates, review.pose, strict=True)},
        "working_mode": review.mode,
        "gives_way": review.gives_way,
    }
    for piece in review.slices:
        content |= piece.written(review)
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def from_text(text: str, *, origin: str) -> Review:
    """The review that `to_text` wrote; what an older session does not have is as in a new review.

    Raises:
        InputError: it is not a session file, or something in it cannot be used; one sentence.
    """
    if len(text) > MAX_BYTES:
        raise InputError(tr("review.too_large", file=origin, most=MAX_BYTES // 1024))
    try:
        content = json.loads(text)
    except ValueError as error:
        raise InputError(tr("session.no_session", file=origin, why=error)) from None
    except RecursionError:
        raise InputError(tr("session.too_deep", file=origin)) from None
    if not isinstance(content, dict) or content.get("bohemia_session") != VERSION:
        raise InputError(tr("session.version", file=origin, version=VERSION))
    name = read.typed(content, "design_name", str, origin)
    text = read.typed(content, "design", str, origin)
    fresh = new_review(read_design(text, origin=f"{origin}, design", name=name))
    given = read.typed(content, "pose", dict, origin)
    pose = []
    for c in fresh.machine.coordinates:
        key = read.key_of(c)
        if key not in given:
            raise InputError(tr("session.pose_lacks", file=origin, key=key))
        value = c.inner(read.number(given[key], f"{origin}: pose: {key}"))
        pose.append(within(c, value, beyond=1.0)[0])
    mode = read.typed(content, "working_mode", str, origin)
    read.checked_modes((mode,), fresh.machine, origin)
    gives_way = content.get("gives_way", "")
    if not isinstance(gives_way, str):
        raise InputError(tr("session.wrong_kind", what=f"{origin}: 'gives_way'"))
    pieces = tuple(type(piece).read(content, fresh, origin) for piece in fresh.slices)
    review = replace(fresh, pose=tuple(pose), mode=mode, slices=pieces)
    try:
        return review.giving_way(gives_way)
    except InputError as error:
        raise InputError(f"{origin}: gives_way: {error}") from None


def json_schema() -> dict[str, Any]:
    """Of a session file: what must be there, and what else is kept, of the kind that is written."""
    kept: dict[str, Any] = {}
    for kind in mechanism_kinds():
        preset = next(preset for preset in presets() if preset.mechanism == kind)
        kept |= json.loads(to_text(new_review(load_design(preset.name))))
    properties = {key: _kept(value) for key, value in kept.items()}
    properties["bohemia_session"] = {"const": VERSION}
    properties["pose"] = {"type": "object", "additionalProperties": {"type": "number"}}
    needed = ("design_name", "design", "working_mode")
    properties |= {key: {"type": "string"} for key in (*needed, "gives_way")}
    return {
        "$schema": DIALECT,
        "type": "object",
        "properties": properties,
        "required": ["bohemia_session", *needed, "pose", "solids"],
    }


def _kept(value: object) -> dict[str, Any]:
    """Values like one that is written; a text may stand for what is chosen otherwise by a list."""
    if isinstance(value, dict):
        return {"type": "object", "properties": {key: _kept(one) for key, one in value.items()}}
    if isinstance(value, bool):
        return {"type": "boolean"}
    if isinstance(value, int | float):
        return {"type": "number"}
    return {"type": "array"} if isinstance(value, list) else {}


def load(path: Path) -> Review:
    """The review in a file.

    Raises:
        InputError: it cannot be read, or is not a session file.
    """
    return from_text(read_text(path, MAX_BYTES, tr("session.a_file")), origin=str(path))


def save(review: Review, path: Path) -> None:
    """Write the review so that a crash on the way leaves the old file whole.

    Raises:
        InputError: the file cannot be written.
    """
    write_file(path, to_text(review).encode())
