"""Figures of merit of a machine at one orientation and in one mode, to compare designs by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from typing import Any, Literal

from kinematics.answers.solutions import Posture
from kinematics.facets.configurations import Configuration
from kinematics.facets.spaces import ShownSolid, Space

EXACT, ROUGH = 1e-6, 0.5  # of volumes: by exact sections, and of a mesh at normal resolution


@dataclass(frozen=True, slots=True)
class Figure:
    """One number of a machine, and what it is of.

    Attributes:
        key: "volume", "largest_piece", …, or the key of a measure.
        title: as "Workspace, working mode +-+++".
        value: NaN where there is none.
        error: an estimate from above; NaN where it is of rounding only.
        unit: "mm³", "mm²", "mm", "N" or "".
        better: which way is good; "" where neither is.
    """

    key: str
    title: str
    value: float
    error: float
    unit: str
    better: Literal["high", "low", ""]


def figures(space: Space[Any], posture: Posture | None) -> tuple[Figure, ...]:
    """What a design is worth: the workspace and what is in it, and how well a pose is held.

    Args:
        space: the workspace at one orientation.
        posture: the pose that is asked of the machine; its mode is that of the largest ball and of
            the aspects. None: there is no pose, and the mode is that of the home posture.
    """
    mode = space.machine.home.mode if posture is None else posture.mode
    return (*_sizes(space, mode), *(() if posture is None else _held(space, posture)))


def _sizes(space: Space[Any], mode: str) -> Iterator[Figure]:
    machine = space.machine
    noun = machine.mode_noun
    together = f"all {noun}s" if space.modes is None else f"{noun} {', '.join(space.modes)}"
    told = f", {together}" if noun else ""
    own = f", {noun} {mode}" if noun else ""
    one = Space(machine, space.pose, (mode,) if noun else None, space.follows)
    if machine.regions is not None and space.follows is None:
        section, aspects = space.section(), one.regions("aspects") if noun else ()
        yield Figure("area", f"Workspace{told}", section.area, section.area_error, "mm²", "high")
        largest = max(aspects, key=lambda region: region.section.area, default=None)
        if largest is not None:
            part = largest.section
            yield Figure(
                "largest_aspect", f"Largest aspect{own}", part.area, part.area_error, "mm²", "high"
            )
        return
    if machine.solids is None:
        return
    volume = space.volume(EXACT if machine.sections is not None else ROUGH)
    yield Figure("volume", f"Workspace{told}", volume.value, volume.error, "mm³", "high")
    if len(volume.pieces) > 1:
        error = volume.error
        yield Figure(
            "largest_piece", f"Largest piece{told}", volume.pieces[0], error, "mm³", "high"
        )
    if machine.sections is not None:
        ball = one.largest_ball()
        radius, error = (0.0, 0.0) if ball is None else (ball.radius, ball.error)
        yield Figure("largest_ball", f"Largest ball{own}, radius", radius, error, "mm", "high")
    if any(spec.key == "aspects" for spec in machine.solid_specs):
        found = one.aspects()
        if isinstance(found, ShownSolid):
            pieces = sorted(found.built.pieces, key=lambda piece: -piece.volume)
            value, error = (0.0, found.built.volume_error)
            if pieces:
                known = pieces[0].volume_error
                value, error = pieces[0].volume, error if known is None else known
            yield Figure("largest_aspect", f"Largest aspect{own}", value, error, "mm³", "high")


def _held(space: Space[Any], posture: Posture) -> Iterator[Figure]:
    """Of the pose; nothing of one that is not within reach."""
    here, nan = Configuration(space.machine, posture), float("nan")
    ways = here.clearances() if here.reachable else ()
    stroke = next((way for way in ways if way.kind in ("boundary", "stroke")), None)
    lost = here.nearest_singularity if here.reachable else None
    for key, title, way in (
        ("boundary", "Distance to the workspace boundary at the pose", stroke),
        ("singularity", "Distance to a singularity at the pose", lost),
    ):
        value, error = (nan, nan) if way is None else (way.distance, way.error)
        yield Figure(key, title, value, error, "mm", "high")
    for spec in space.machine.measures.specs:
        if not spec.needs_load:
            value = here.measure(spec.key) if here.reachable else nan
            value = value if isfinite(value) else nan
            yield Figure(spec.key, f"{spec.title} at the pose", value, nan, spec.unit, spec.better)


def best(values: list[float], better: str) -> list[int]:
    """Which of some values is the best, by their numbers; several where they are equal."""
    known = [value for value in values if value == value]
    if not better or len(known) < 2:
        return []
    wanted = max(known) if better == "high" else min(known)
    if all(value == wanted for value in known):
        return []
    return [n for n, value in enumerate(values) if value == wanted]
