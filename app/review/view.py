"""State → view: everything a page shows of a review, as plain values. Knows no viser."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

import numpy as np

from app.review.modes import page_mode
from app.review.state import Review
from kinematics.answers.clearances import Clearance
from kinematics.answers.drawings import Body, Drawing
from kinematics.answers.singularities import ModeChange
from kinematics.answers.solutions import Finding, Margin, Posture
from kinematics.arrays import Array
from kinematics.facets.solids import RESOLUTIONS, Resolution, SolidRequest, SolidSpec
from kinematics.machine import Machine, machine_of
from kinematics.mechanism import Coordinate, Design

OTHER = 5 * 4  # limbs of a counterpart are counted from here; its colours are the same again
APART = 3.4  # of the machine's size: how far it stands away
NEAR = 0.05  # of the stroke: closer to its end than this is "near"

Level = Literal["good", "near", "bad"]


@dataclass(frozen=True, slots=True)
class JointRow:
    """One actuated joint: where it stands between its bounds, in the page's units."""

    limb: int
    symbol: str
    value: float
    low: float
    high: float
    unit: str
    level: Level
    note: str


@dataclass(frozen=True, slots=True)
class Status:
    """The sentence at the top of the page."""

    level: Level
    text: str
    remedy: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class SolidWish:
    """One solid to show: what to compute for it, where to put it, how to draw it."""

    spec: SolidSpec
    requests: dict[Resolution, SolidRequest]
    placement: Array
    opacity: float

    @property
    def what(self) -> tuple[object, ...]:
        """Equal while the same solid is wished, at whatever resolution."""
        return self.requests["preview"].arguments


@dataclass(frozen=True, eq=False, slots=True)
class Beside:
    """The counterpart of a machine at the same coordinates and in the same mode.

    ``joints`` and ``drawing`` count its limbs from `OTHER` + 1; the drawing stands in the base
    frame as a whole, ``offset`` (3,) mm away from where it belongs.
    """

    design: Design
    posture: Posture
    drawing: Drawing
    joints: tuple[JointRow, ...]
    offset: Array


@dataclass(frozen=True, eq=False, slots=True)
class View:
    """What a page shows; ``platform`` is the 4x4 from platform to base coordinates."""

    review: Review
    posture: Posture
    drawing: Drawing
    platform: Array
    status: Status
    joints: tuple[JointRow, ...]
    wishes: tuple[SolidWish, ...]
    inside: bool
    findings: tuple[Finding, ...]
    mode_change: ModeChange | None
    beside: Beside | None


def view(review: Review) -> View:
    """The view of a review; a few milliseconds, no solids."""
    machine, design = review.machine, review.design
    posture = review.posture
    rows = joint_rows(machine, posture)
    return View(
        review=review,
        posture=posture,
        drawing=machine.drawing(posture),
        platform=machine.transform(review.pose, review.mode),
        status=status(review, posture),
        joints=rows,
        wishes=wishes(review),
        inside=machine.inverse.inside(review.pose, review.solver_modes),
        findings=findings(design),
        mode_change=machine.singularities.mode_change(posture),
        beside=beside(review),
    )


def beside(review: Review) -> Beside | None:
    """The counterpart, where it is to be compared with."""
    if not review.control.compare:
        return None
    design = next(iter(review.machine.counterparts), None)
    if design is None:
        return None
    machine = machine_of(design)
    posture = machine.inverse.posture(review.pose, review.mode)
    drawing = machine.drawing(posture)
    platform = machine.transform(posture.pose, posture.mode)
    offset = np.array([APART * drawing.size, 0.0, 0.0])

    def moved(point: tuple[float, ...]) -> tuple[float, float, float]:
        x, y, z = (np.asarray(point) + offset).tolist()
        return x, y, z

    def fixed(body: Body) -> Body:
        points = np.array(body.points)
        if body.frame == "platform":
            points = points @ platform[:3, :3].T + platform[:3, 3]
        return replace(
            body, name=f"other {body.name}", points=tuple(map(moved, points.tolist())), frame="base"
        )

    bars = tuple(
        replace(
            bar,
            name=f"other {bar.name}",
            start=moved(bar.start),
            end=moved(bar.end),
            limb=None if bar.limb is None else bar.limb + OTHER,
        )
        for bar in drawing.bars
    )
    rows = joint_rows(machine, posture)
    return Beside(
        design,
        posture,
        replace(drawing, bars=bars, bodies=tuple(map(fixed, drawing.bodies)), points=(), axes=()),
        tuple(replace(row, limb=row.limb + OTHER) for row in rows),
        offset,
    )


def in_page_units(coordinate: Coordinate, value: float) -> float:
    """mm stay, radians become degrees."""
    return value if coordinate.unit == "mm" else math.degrees(value)


def how_far(way: Clearance, decimals: int = 1) -> str:
    """ "47.5 mm", or of a way that is a turn "53.7°"."""
    value, unit = way.distance, " mm"
    if way.angle is not None:
        value, unit = math.copysign(math.degrees(way.angle), way.distance), "°"
    return f"{round(value, decimals) + 0.0:.{decimals}f}{unit}".replace("-", "−")


def from_page_units(coordinate: Coordinate, value: float) -> float:
    """mm stay, degrees become radians."""
    return value if coordinate.unit == "mm" else math.radians(value)


def page_unit(coordinate: Coordinate) -> str:
    """The unit that stands behind a number on the page."""
    return "mm" if coordinate.unit == "mm" else "°"


def joint_rows(machine: Machine[Any], posture: Posture) -> tuple[JointRow, ...]:
    """The actuated joints with what is worth saying about each."""
    rows = []
    for n, (c, value) in enumerate(zip(machine.joints, posture.joints, strict=True)):
        limb = c.limb or n + 1
        reason = next((r for r in posture.reasons if r.limb == limb), None)
        margin = min((value - c.lower, c.upper - value)) if math.isfinite(value) else -math.inf
        level: Level = "good"
        note = ""
        if reason is not None:
            level = "bad"
            note = (
                "cannot close"
                if reason.bound == "link"
                else f"{amount_text(reason.amount, reason.unit)} beyond"
            )
        elif margin < NEAR * (c.upper - c.lower):
            level, note = "near", "near its end"
        rows.append(
            JointRow(
                limb,
                c.symbol,
                in_page_units(c, value),
                in_page_units(c, c.lower),
                in_page_units(c, c.upper),
                page_unit(c),
                level,
                note,
            )
        )
    return tuple(rows)


def amount_text(amount: float, unit: str) -> str:
    """A distance to a bound in the page's units: "12.3 mm", "4.1°"."""
    value = round(amount if unit == "mm" else math.degrees(amount), 1) + 0.0  # no "-0.0"
    return f"{value:.1f} mm" if unit == "mm" else f"{value:.1f}°"


_BOUNDS = {"rho_min": "ρ min", "rho_max": "ρ max", "link": "link"}


def _bound(margin: Margin) -> str:
    return f"limb {margin.limb}, {_BOUNDS.get(margin.bound, margin.bound)}"


def short_title(machine: Machine[Any]) -> str:
    """ "3-RPS" of "3-RPS (one translation, two rotations)"."""
    return machine.title.partition(" (")[0]


def mode_text(machine: Machine[Any], mode: str) -> str:
    """ "mode ++−+−", "operation mode 1"; "" for a mechanism that has but one."""
    if not machine.mode_noun:
        return ""
    noun = "mode" if machine.mode_noun == "working mode" else machine.mode_noun
    return f"{noun} {page_mode(mode)}"


def status(review: Review, posture: Posture) -> Status:
    """Reachable or not, in which mode, how far from the nearest limit; and the way out."""
    mode = mode_text(review.machine, posture.mode)
    if posture.reachable:
        nearest = posture.nearest
        limit = (
            ""
            if nearest is None
            else f"{amount_text(nearest.amount, nearest.unit)} left of travel ({_bound(nearest)})"
        )
        strokes = [m.amount for m in posture.margins if m.bound != "link"]
        span = min(c.upper - c.lower for c in review.machine.joints)
        near = bool(strokes) and min(strokes) < NEAR * span
        return Status("near" if near else "good", _joined("Reachable", mode, limit))
    worst = max(posture.reasons, key=lambda r: r.amount)
    more = len(posture.reasons) - 1
    text = _joined("Not reachable", mode, worst.text)
    if more:
        text += f" · and {more} more limit{'s' if more > 1 else ''} exceeded"
    return Status("bad", text, _other_mode(review, posture))


def _joined(*parts: str) -> str:
    return " · ".join(filter(None, parts))


def reaching_mode(review: Review, pose: Sequence[float]) -> str | None:
    """The working mode that reaches a pose with the fewest limbs flipped; None if none does."""
    answer = review.machine.inverse(pose)
    able = [m for m, ok in zip(answer.modes, answer.within_stroke, strict=True) if ok]
    return min(
        able,
        key=lambda m: sum(a != b for a, b in zip(m, review.mode, strict=True)),
        default=None,
    )


def _other_mode(review: Review, posture: Posture) -> str:
    noun = review.machine.mode_noun
    nearest = reaching_mode(review, posture.pose)
    if nearest is None:
        return f"No {noun} reaches this pose." if noun else ""
    return f"Within reach in {mode_text(review.machine, nearest)}."


def wishes(review: Review) -> tuple[SolidWish, ...]:
    """The solids on display with what each depends on."""
    machine = review.machine
    if machine.solids is None:
        return ()
    solids = machine.solids
    specs = {spec.key: spec for spec in solids.specs}
    return tuple(
        SolidWish(
            specs[s.key],
            {
                r: solids.request(
                    s.key, review.pose, modes_of(review, specs[s.key]), r, review.surface
                )
                for r in RESOLUTIONS
            },
            solids.placement(s.key, review.pose),
            s.opacity,
        )
        for s in review.solids
    )


def modes_of(review: Review, spec: SolidSpec) -> tuple[str, ...] | None:
    """The modes that a solid is of: None for all of them, or where they do not matter."""
    if spec.of_present_mode:
        return (review.mode,)
    return review.solver_modes if spec.uses_modes else None


@lru_cache(maxsize=32)
def findings(design: Design) -> tuple[Finding, ...]:
    """What is worth knowing about a design, kept while it is on the page."""
    return machine_of(design).findings
