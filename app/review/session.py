"""A review as one file: what is saved on every settled change, handed to a colleague, reopened."""

from __future__ import annotations

import json
import math
import tempfile
from dataclasses import fields
from pathlib import Path
from typing import Any

from app.features.trajectory.session import plan_from_table, plan_table
from app.review.state import (
    Atlas,
    Chart,
    Control,
    Cut,
    Flat,
    Options,
    Review,
    Shown,
    Span,
    checked,
    checked_chart,
    checked_control,
    checked_flat,
    checked_way,
    new_review,
    within_reach,
)
from kinematics.designs.files import read_design, write_design
from kinematics.errors import InputError
from kinematics.facets.solids import SURFACES, SurfaceKind
from kinematics.mechanism import Coordinate

VERSION = 1
MAX_BYTES = 1 << 20


def to_text(review: Review) -> str:
    """The review as JSON; angles in degrees, the design as it would stand in its own file."""
    coordinates = review.machine.coordinates
    pose = {_key(c): _outward(c, v) for c, v in zip(coordinates, review.pose, strict=True)}
    content = {
        "bohemia_session": VERSION,
        "design_name": review.design.name,
        "design": write_design(review.design),
        "pose": pose,
        "working_mode": review.mode,
        "workspace_modes": review.modes,
        "workspace_surface": review.surface,
        "solids": {s.key: s.opacity for s in review.solids},
        "options": {f.name: getattr(review.options, f.name) for f in fields(Options)},
        "solutions": {f.name: getattr(review.atlas, f.name) for f in fields(Atlas)},
        "section": {"on": review.cut.on, "at": review.cut.at},
        "gives_way": review.gives_way,
        "regions": {f.name: getattr(review.flat, f.name) for f in fields(Flat)},
        "control": {f.name: getattr(review.control, f.name) for f in fields(Control)},
        "trajectory": plan_table(review),
    }
    axes = _map_axes(review)
    if axes:
        spans = zip(axes, (review.chart.first, review.chart.second), strict=True)
        content["map"] = {"quantity": review.chart.quantity} | {
            _key(c): [_outward(c, span.low), _outward(c, span.high), span.count]
            for c, span in spans
        }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def from_text(text: str, *, origin: str) -> Review:
    """The review that `to_text` wrote.

    Raises:
        InputError: it is not a session file, or something in it cannot be used; one sentence.
    """
    if len(text) > MAX_BYTES:
        raise InputError(f"{origin}: a session file is smaller than {MAX_BYTES // 1024} kB")
    try:
        content = json.loads(text)
    except ValueError as error:
        raise InputError(f"{origin}: not a session file ({error})") from None
    if not isinstance(content, dict) or content.get("bohemia_session") != VERSION:
        raise InputError(
            f"{origin}: not a session file of this version; it needs 'bohemia_session': {VERSION}"
        )
    design_text = _typed(content, "design", str, origin)
    design = read_design(
        design_text, origin=f"{origin}, design", name=_typed(content, "design_name", str, origin)
    )
    review = new_review(design)
    machine = review.machine
    pose = _pose(_typed(content, "pose", dict, origin), review, origin)
    mode = _typed(content, "working_mode", str, origin)
    modes = content.get("workspace_modes", "all")
    if isinstance(modes, list):
        modes = tuple(modes)
    chosen = modes if isinstance(modes, tuple) else ()
    if mode not in machine.modes or any(m not in machine.modes for m in chosen):
        noun = machine.mode_noun or "working mode"
        raise InputError(f"{origin}: a {noun} is one of {', '.join(map(repr, machine.modes))}")
    if not isinstance(modes, tuple) and modes not in ("all", "current"):
        raise InputError(f"{origin}: workspace_modes is 'all', 'current' or a list of modes")
    known = {spec.key for spec in machine.solid_specs}
    solids = tuple(
        Shown(str(key), min(max(_number(value, f"solids: {key}", origin), 0.0), 1.0))
        for key, value in _typed(content, "solids", dict, origin).items()
        if key in known
    )
    given = _typed(content, "options", dict, origin)
    options = Options(**{f.name: bool(given.get(f.name, f.default)) for f in fields(Options)})
    return Review(
        design,
        pose,
        mode,
        modes,
        solids,
        options,
        _atlas(content, review, origin),
        _cut(content, review, origin),
        _chart(content, review, origin),
        _surface(content, origin),
        _control(content, review, origin),
        _way(content, review, origin),
        _flat(content, review, origin),
        plan_from_table(content.get("trajectory", {}), review, origin),
    )


def load(path: Path) -> Review:
    """The review in a file.

    Raises:
        InputError: it cannot be read, or is not a session file.
    """
    try:
        return from_text(path.read_text(encoding="utf-8"), origin=str(path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a session file (it is not text)") from None


def save(review: Review, path: Path) -> None:
    """Write the review so that a crash on the way leaves the old file whole.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", dir=path.parent, prefix=f".{path.name}.", delete=False
        ) as file:
            file.write(to_text(review))
        Path(file.name).replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None


def _pose(given: dict[str, Any], review: Review, origin: str) -> tuple[float, ...]:
    values = []
    for c in review.machine.coordinates:
        key = _key(c)
        if key not in given:
            raise InputError(f"{origin}: pose has no {key}")
        value = _inward(c, _number(given[key], f"pose: {key}", origin))
        values.append(min(max(value, c.lower), c.upper))
    return tuple(values)


def _atlas(content: dict[str, Any], review: Review, origin: str) -> Atlas:
    """How solutions are shown; sessions saved before there were any have nothing of it."""
    given = content.get("solutions", {})
    if not isinstance(given, dict):
        raise InputError(f"{origin}: 'solutions' is not of the right kind")
    values = {f.name: given.get(f.name, f.default) for f in fields(Atlas)}
    for f in fields(Atlas):
        if not isinstance(values[f.name], type(f.default)):
            raise InputError(f"{origin}: solutions: {f.name} is not of the right kind")
    try:
        return checked(Atlas(**values), review.machine)
    except InputError as error:
        raise InputError(f"{origin}: solutions: {error}") from None


def _control(content: dict[str, Any], review: Review, origin: str) -> Control:
    """What is shown of control; sessions saved before there was any have nothing of it."""
    given = content.get("control", {})
    if not isinstance(given, dict):
        raise InputError(f"{origin}: 'control' is not of the right kind")
    values: dict[str, Any] = {}
    for f in fields(Control):
        value = given.get(f.name, getattr(review.control, f.name))
        if isinstance(value, list):
            value = tuple(_number(v, f"control: {f.name}", origin) for v in value)
        if not isinstance(value, type(f.default)):
            raise InputError(f"{origin}: control: {f.name} is not of the right kind")
        values[f.name] = value
    try:
        return checked_control(Control(**values), review)
    except InputError as error:
        raise InputError(f"{origin}: control: {error}") from None


def _flat(content: dict[str, Any], review: Review, origin: str) -> Flat:
    """How plane regions are shown; sessions saved before there were any have nothing of it."""
    given = content.get("regions", {})
    if not isinstance(given, dict):
        raise InputError(f"{origin}: 'regions' is not of the right kind")
    values = {f.name: given.get(f.name, f.default) for f in fields(Flat)}
    for f in fields(Flat):
        if not isinstance(values[f.name], type(f.default)):
            raise InputError(f"{origin}: regions: {f.name} is not of the right kind")
    try:
        return checked_flat(Flat(**values), review)
    except InputError as error:
        raise InputError(f"{origin}: regions: {error}") from None


def _way(content: dict[str, Any], review: Review, origin: str) -> str:
    """Which coordinate gives way; sessions saved before there was a choice leave it open."""
    given = content.get("gives_way", "")
    if not isinstance(given, str):
        raise InputError(f"{origin}: 'gives_way' is not of the right kind")
    try:
        return checked_way(given, review)
    except InputError as error:
        raise InputError(f"{origin}: gives_way: {error}") from None


def _surface(content: dict[str, Any], origin: str) -> SurfaceKind:
    """What the workspace is made of; sessions saved before there was a choice have facets."""
    given = content.get("workspace_surface", SURFACES[0])
    for surface in SURFACES:
        if given == surface:
            return surface
    raise InputError(f"{origin}: workspace_surface is {' or '.join(map(repr, SURFACES))}")


def _cut(content: dict[str, Any], review: Review, origin: str) -> Cut:
    """The section's plane; sessions saved before there were any have none."""
    given = content.get("section", {})
    if not isinstance(given, dict) or not isinstance(given.get("on", False), bool):
        raise InputError(f"{origin}: 'section' is not of the right kind")
    at = _number(given.get("at", review.cut.at), "section: at", origin)
    return Cut(given.get("on", False), within_reach(review, at)[0])


def _chart(content: dict[str, Any], review: Review, origin: str) -> Chart:
    """What the map shows; sessions saved before there were any have nothing of it."""
    given = content.get("map", {})
    axes = _map_axes(review)
    if not isinstance(given, dict):
        raise InputError(f"{origin}: 'map' is not of the right kind")
    if not axes or not given:
        return review.chart
    quantity = given.get("quantity", review.chart.quantity)
    spans = []
    for c, usual in zip(axes, (review.chart.first, review.chart.second), strict=True):
        span = given.get(_key(c), [_outward(c, usual.low), _outward(c, usual.high), usual.count])
        if not isinstance(span, list) or len(span) != 3 or type(span[2]) is not int:
            raise InputError(f"{origin}: map: {_key(c)} is [from, to, how many]")
        low, high = (_inward(c, _number(v, f"map: {_key(c)}", origin)) for v in span[:2])
        spans.append(Span(low, high, span[2]))
    try:
        return checked_chart(Chart(quantity, *spans), review)
    except InputError as error:
        raise InputError(f"{origin}: map: {error}") from None


def _map_axes(review: Review) -> tuple[Coordinate, ...]:
    spec = review.machine.map_spec
    coordinates = review.machine.coordinates
    return () if spec is None else tuple(coordinates[n] for n in spec.axes)


def _key(c: Coordinate) -> str:
    """What a coordinate is called in the file."""
    return c.key if c.unit == "mm" else f"{c.key}_deg"


def _outward(c: Coordinate, value: float) -> float:
    return value if c.unit == "mm" else math.degrees(value)


def _inward(c: Coordinate, value: float) -> float:
    return value if c.unit == "mm" else math.radians(value)


def _typed(content: dict[str, Any], key: str, kind: type, origin: str) -> Any:
    value = content.get(key)
    if not isinstance(value, kind):
        raise InputError(f"{origin}: {key!r} is missing or not of the right kind")
    return value


def _number(value: Any, what: str, origin: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{origin}: {what} must be a finite number")
    return float(value)
