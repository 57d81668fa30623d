"""State → view: everything a page shows of a review, as plain values. Knows no viser."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from app.language import tr
from app.review.state import Review
from app.review.units import page_unit
from kinematics.answers.drawings import Drawing
from kinematics.answers.solutions import Posture, Reason
from kinematics.arrays import Array
from kinematics.machine import Machine
from kinematics.mechanism import Design

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
class Fact:
    """A number that matters and what it is: "67.7 mm", "of travel left, limb 3 ρ min"."""

    value: str
    what: str


@dataclass(frozen=True, slots=True)
class Status:
    """What stands at the top of the page.

    Attributes:
        verdict: "Reachable", or what is beyond its limit and by how much.
        mode: in which, in words; "" for a mechanism that has but one.
        facts: numbers that belong to it.
        text: all of it as one line.
        remedy: what would help, a sentence.
    """

    level: Level
    verdict: str
    mode: str
    facts: tuple[Fact, ...]
    text: str
    remedy: str = ""


@dataclass(frozen=True, eq=False, slots=True)
class Beside:
    """The counterpart of a machine at the same coordinates and in the same mode.

    ``joints`` and ``drawing`` count its limbs from 21; the drawing stands in the base
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
    beside: Beside | None = None


@dataclass(frozen=True, slots=True)
class Moment:
    """Where on its trajectory the machine is shown.

    ``away``: that is not where the review has it. ``distance`` to a singularity, mm, NaN if it is
    not known. ``there``: the machine is where the trajectory has it at that time.
    """

    at: float
    playing: bool
    away: bool
    distance: float
    there: bool = True


@dataclass(frozen=True, slots=True)
class Clear:
    """How far it is to where control is lost, None where nothing is known of it.

    Attributes:
        stale: from a place before.
        back: what brings a pose that is out of reach back, for who pressed; None if nothing does.
    """

    fact: Fact | None
    stale: bool
    back: Callable[[Any], object] | None = None


@dataclass(frozen=True, slots=True)
class Size:
    """How large the workspace is; ``stale``: that of before. None where nothing is known of it."""

    fact: Fact | None
    stale: bool


@dataclass(frozen=True, eq=False, slots=True)
class Reach:
    """The intervals (K, 2) in which each coordinate of the pose can be held, the others as they
    are, mm and rad; none while nothing is known. ``stale``: about a pose before.
    """

    spans: tuple[Array, ...]
    stale: bool


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits nearest to a pose, the nearest first: each with its colour, what it is, and how
    far. ``stale``: of a pose before.
    """

    rows: tuple[tuple[str, str, str], ...]
    stale: bool


@dataclass(frozen=True, slots=True)
class Person:
    """Somebody at the review, by the number in which browsers came; ``did`` is their newest change
    while that is new.
    """

    number: int
    name: str
    color: str
    looks_on: bool
    did: str = ""

    @property
    def text(self) -> str:
        """Their name, and what they did."""
        return f"{self.name}: {self.did}" if self.did else self.name


@dataclass(frozen=True, slots=True)
class People:
    """Everybody at the review."""

    every: tuple[Person, ...]


@dataclass(frozen=True, slots=True)
class Legend:
    """Colours in the scene, each with what it stands for; ``of`` is whose they are."""

    of: str
    entries: tuple[tuple[str, str], ...]


def view(review: Review) -> View:
    """The view of a review; a few milliseconds."""
    machine, posture = review.machine, review.posture
    return View(
        review=review,
        posture=posture,
        drawing=machine.drawing(posture),
        platform=machine.transform(review.pose, review.mode),
        status=status(review, posture),
        joints=joint_rows(machine, posture),
    )


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
            amount = amount_text(reason.amount, reason.unit)
            beyond = tr("status.beyond", value=amount_text(value, reason.unit), amount=amount)
            note = tr("status.open") if reason.bound == "link" else beyond
        elif not c.free and margin < NEAR * (c.upper - c.lower):
            level, note = "near", tr("page.near_end")
        at, low, high = map(c.outer, (value, c.lower, c.upper))
        rows.append(JointRow(limb, c.symbol, at, low, high, page_unit(c), level, note))
    return tuple(rows)


def amount_text(amount: float, unit: str) -> str:
    """A distance to a bound in the page's units: "12.3 mm", "4.1°"."""
    value = round(amount if unit == "mm" else math.degrees(amount), 1) + 0.0  # no "-0.0"
    return f"{value:.1f} mm" if unit == "mm" else f"{value:.1f}°"


def short_title(machine: Machine[Any]) -> str:
    """ "3-RPS" of "3-RPS (one translation, two rotations)"."""
    return machine.title.partition(" (")[0]


def mode_noun(machine: Machine[Any]) -> str:
    """ "working mode", "operation mode", or "mode" of both kinds; "" for a mechanism of but one."""
    return machine.mode_noun and tr(f"modes.{machine.mode_noun.replace(' ', '_')}")


def mode_text(machine: Machine[Any], mode: str) -> str:
    """ "mode ++−+−", "operation mode 1"; "" for a mechanism that has but one."""
    return machine.mechanism.mode(mode).named


def status(review: Review, posture: Posture) -> Status:
    """Reachable or not, in which mode, how far from the nearest limit; and the way out."""
    mode = mode_text(review.machine, posture.mode)
    if posture.reachable:
        facts: tuple[Fact, ...] = ()
        limit = ""
        if (nearest := posture.nearest) is not None:
            left, place = amount_text(nearest.amount, nearest.unit), nearest.bound.place
            limit = tr("status.left", amount=left, place=place)
            facts = (Fact(left, tr("status.of_travel_left", place=place.replace(", ", " "))),)
        strokes = [m.amount for m in posture.margins if m.bound != "link"]
        span = min(c.upper - c.lower for c in review.machine.joints)
        near = bool(strokes) and min(strokes) < NEAR * span
        level: Level = "near" if near else "good"
        verdict = tr("status.reachable")
        return Status(level, verdict, mode, facts, _joined(verdict, mode, limit))
    worst = max(posture.reasons, key=lambda r: r.amount)
    more = len(posture.reasons) - 1
    further = tr("status.more", n=more) if more else ""
    text = _joined(tr("status.not_reachable"), mode, worst.text, further)
    verdict = worst.text[:1].upper() + worst.text[1:]
    wanted = _wanted(review.machine, posture, worst)
    return Status("bad", verdict, mode, wanted, text, _other_mode(review, posture))


def _wanted(machine: Machine[Any], posture: Posture, worst: Reason) -> tuple[Fact, ...]:
    """Where the joint that is beyond its range would stand, and where that ends."""
    joints = zip(machine.joints, posture.joints, strict=True)
    at = next(((c, v) for n, (c, v) in enumerate(joints, 1) if (c.limb or n) == worst.limb), None)
    if at is None or not math.isfinite(at[1]):
        return (Fact(amount_text(worst.amount, worst.unit), tr("status.missing")),)
    c, value = at
    end = c.upper if value > c.upper else c.lower
    what = tr("status.longest" if value > c.upper else "status.shortest")
    wanted = Fact(amount_text(value, c.unit), tr("status.wanted", joint=c.symbol))
    return wanted, Fact(amount_text(end, c.unit), what)


def _joined(*parts: str) -> str:
    return " · ".join(filter(None, parts))


def reaching_mode(review: Review, pose: Sequence[float]) -> str | None:
    """The working mode that reaches a pose with the fewest limbs flipped; None if none does."""
    answer = review.machine.inverse(pose)
    able = [m for m, ok in zip(answer.modes, answer.within_stroke, strict=True) if ok]
    return min(able, key=lambda m: m.flips(review.mode), default=None)


def _other_mode(review: Review, posture: Posture) -> str:
    noun = mode_noun(review.machine)
    nearest = reaching_mode(review, posture.pose)
    if nearest is None:
        return tr("status.no_mode", noun=noun) if noun else ""
    return tr("status.other_mode", mode=mode_text(review.machine, nearest))
