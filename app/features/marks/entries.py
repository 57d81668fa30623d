"""Marks in a session file: entries of its lists, written and read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from app.features.marks.model import (
    KINDS,
    NEVER,
    POINT,
    Anchor,
    Dimension,
    M,
    Note,
    Point,
    SavedView,
    look_of,
    named,
    shows,
    sound,
)
from app.language import tr
from app.review import content as session
from app.review.state import Review
from app.scene.camera import Camera
from kinematics.errors import InputError


def view_entry(view: SavedView, review: Review) -> dict[str, Any]:
    """A saved view as it stands in the file."""
    looks: dict[str, Any] = {}
    for piece in view.looks:
        content = piece.written(review)
        kept = content.get(piece.filed_as)
        if isinstance(kept, dict):
            names = piece.LOOKS - NEVER
            content[piece.filed_as] = {k: v for k, v in kept.items() if k in names}
        looks |= content
    return {
        "name": view.text,
        "camera": _camera_entry(view.camera),
        "looks": looks,
        **_pose_entry(view, review),
    }


def note_entry(note: Note, review: Review) -> dict[str, Any]:
    """A note as it stands in the file."""
    entry: dict[str, Any] = {"text": note.text, **_pose_entry(note, review)}
    if note.anchor is not None:
        entry["at"] = _anchor_entry(note.anchor)
    if note.camera is not None:
        entry["camera"] = _camera_entry(note.camera)
    return entry


def dimension_entry(dimension: Dimension) -> dict[str, Any]:
    """A dimension as it stands in the file."""
    between = [_anchor_entry(anchor) for anchor in dimension.anchors]
    return {"name": dimension.text, "between": between}


def view_of(entry: dict[str, Any], review: Review, what: str) -> SavedView:
    """A saved view from its entry; ``review`` is a fresh one of the file's design.

    Raises:
        InputError: something in it cannot be used; the sentence begins with ``what``.
    """
    looks = session.table(entry, "looks", what)
    kinds = [type(piece) for piece in review.slices if shows(piece)] if looks else []
    pieces = tuple(look_of(kind.read(looks, review, f"{what}: looks")) for kind in kinds)
    camera = _camera_of(session.table(entry, "camera", what), f"{what}: camera")
    made = SavedView("", camera, pieces, *_pose_of(entry, review, what))
    return _texted(made, entry.get("name"), f"{what}: name")


def note_of(entry: dict[str, Any], review: Review, what: str) -> Note:
    """A note from its entry, likewise."""
    at, seen = entry.get("at"), entry.get("camera")
    pose, mode = _pose_of(entry, review, what)
    if not pose:
        raise InputError(tr("session.missing", what=f"{what}: 'pose'"))
    anchor = None if at is None else _anchor_of(at, f"{what}: at")
    camera = (
        None
        if seen is None
        else _camera_of(session.table(entry, "camera", what), f"{what}: camera")
    )
    return _texted(Note("", pose, mode, anchor, camera), entry.get("text"), f"{what}: text")


def dimension_of(entry: dict[str, Any], review: Review, what: str) -> Dimension:
    """A dimension from its entry, likewise."""
    between = session.typed(entry, "between", list, what)
    anchors = tuple(_anchor_of(each, f"{what}: between") for each in between)
    return _texted(Dimension("", anchors), entry.get("name", ""), f"{what}: name")


def _texted(mark: M, text: object, what: str) -> M:
    if not isinstance(text, str):
        raise InputError(tr("session.wrong_kind", what=what))
    try:
        return named(mark, text)
    except InputError as error:
        raise InputError(f"{what}: {error}") from None


def _pose_entry(mark: SavedView | Note, review: Review) -> dict[str, Any]:
    if not mark.pose:
        return {}
    axes = zip(review.machine.coordinates, mark.pose, strict=True)
    return {"pose": {session.key_of(c): c.outer(v) for c, v in axes}, "mode": mark.mode}


def _pose_of(entry: dict[str, Any], review: Review, what: str) -> tuple[tuple[float, ...], str]:
    given = session.table(entry, "pose", what)
    if not given:
        return (), ""
    pose = []
    for c in review.machine.coordinates:
        key = session.key_of(c)
        pose.append(c.inner(session.number(given.get(key), f"{what}: pose: {key}")))
    mode = session.typed(entry, "mode", str, what)
    session.checked_modes((mode,), review.machine, what)
    return tuple(pose), mode


def _camera_entry(camera: Camera) -> dict[str, Any]:
    return {
        "position": list(camera.position),
        "look_at": list(camera.look_at),
        "up": list(camera.up),
        "fov_deg": math.degrees(camera.fov),
        "aspect": camera.aspect,
    }


def _camera_of(entry: dict[str, Any], what: str) -> Camera:
    position, look_at, up = (
        _place(entry.get(key), f"{what}: {key}") for key in ("position", "look_at", "up")
    )
    fov = math.radians(session.number(entry.get("fov_deg"), f"{what}: fov_deg"))
    aspect = session.number(entry.get("aspect", 0.0), f"{what}: aspect")
    camera = Camera(position, look_at, up, fov, aspect)
    if not camera.sound:
        raise InputError(tr("marks.no_camera", what=what))
    return camera


def _anchor_entry(anchor: Anchor) -> dict[str, Any]:
    return {anchor.kind: anchor.name or list(anchor.at)}


def _anchor_of(entry: object, what: str) -> Anchor:
    given = entry if isinstance(entry, Mapping) else {}
    for kind in KINDS:
        value = given.get(kind)
        if isinstance(value, str):
            made = Anchor(kind, value[:100])
        elif kind == POINT and value is not None:
            made = Anchor(kind, at=_place(value, what))
        else:
            continue
        if sound(made):
            return made
    raise InputError(tr("session.wrong_kind", what=what))


def _place(value: object, what: str) -> Point:
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(tr("session.wrong_kind", what=what))
    x, y, z = (session.number(v, what) for v in value)
    return x, y, z
