"""All assembly modes for the present actuators, and where the present one ends: found in a lane of
its own, and made ready for a page.

A general design takes from a tenth of a second to more than one, too long for the page's loop.
`Known` is the set found last, `atlas` makes of it what is shown: rows filtered and sorted, the
sentences above them, the platforms that stand in the scene as ghosts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from app.features.solutions.state import Atlas, Only, Sort
from app.jobs.answers import Question
from app.language import tr
from app.review.state import Review
from app.review.units import place_text
from app.review.view import View
from app.terminal import tables
from kinematics.answers.modes import matching
from kinematics.answers.solutions import Fold, ForwardSolutions, Merged, Posture, Refreshed
from kinematics.arrays import Array
from kinematics.machine import machine_of
from kinematics.mechanism import Design

REST = 0.15  # s without a new wish before work on it begins
SAME_JOINTS = 1e-6  # mm or rad: lengths that differ by less have the same solutions
NAMED, TOLD = 8, 3  # of those that came, and of those that went, the page names this many
HERE = 0.01  # mm: a solution whose platform is nearer than this is the present one
SAME = 1e-3  # mm and rad: a partner this near to a known solution is that solution


@dataclass(frozen=True, eq=False, slots=True)
class Wish:
    """Solutions to find; no two wishes are the same work.

    ``before`` is a set to go on from, None to find all from scratch.
    """

    design: Design
    joints: tuple[float, ...]
    before: ForwardSolutions | None = None


def solve(wish: Wish) -> Refreshed:
    """All solutions, gone on from a set if there is one; from scratch all of them count as having
    been there before.
    """
    forward = machine_of(wish.design).forward
    if wish.before is not None:
        return forward.refresh(wish.before, wish.joints)
    (found,) = forward([wish.joints])
    return Refreshed(found, (), ())


@dataclass(frozen=True, eq=False, slots=True)
class Known:
    """The solutions found last, for which design, and what happened to them on the way.

    ``appeared`` and ``merged`` count from the last time that the actuators stood still.
    """

    design: Design
    solutions: ForwardSolutions
    appeared: frozenset[int] = frozenset()
    merged: tuple[Merged, ...] = ()

    def is_of(self, review: Review) -> bool:
        """Found for this design."""
        return self.design == review.design

    def stands_at(self, joints: Sequence[float]) -> bool:
        """Found for these actuators."""
        return max(abs(a - b) for a, b in zip(self.solutions.joints, joints, strict=True)) <= (
            SAME_JOINTS
        )

    def after(self, refreshed: Refreshed, *, rested: bool) -> Known:
        """The same at other actuators; ``rested`` begins a new count of who came and went."""
        appeared, merged = (frozenset(), ()) if rested else (self.appeared, self.merged)
        gone = {m.identity for m in refreshed.merged}
        # Who appeared on the way and merged again was never there.
        passing = gone & appeared
        return replace(
            self,
            solutions=refreshed.solutions,
            appeared=(appeared - gone) | frozenset(refreshed.appeared),
            merged=(*merged, *(m for m in refreshed.merged if m.identity not in passing)),
        )

    def index(self, identity: int) -> int | None:
        """Where a solution stands in the set; None if it is not there any more."""
        found = self.solutions.identities
        return found.index(identity) if identity in found else None


@dataclass(frozen=True, slots=True)
class Row:
    """One solution. ``distance`` is the way of the platform's farthest point from here, mm."""

    identity: int
    index: int
    pose: tuple[float, ...]
    mode: str
    distance: float
    height: float
    condition: float
    remark: str
    within_stroke: bool
    here: bool
    new: bool


@dataclass(frozen=True, eq=False, slots=True)
class Listed:
    """What a page shows of the solutions.

    Attributes:
        rows: those that pass the filter, sorted.
        placements: (N, 4, 4) where the platform of each row stands.
        count: "34 real of 1560 complex solutions".
        how: how that is known, how they were found, how long it took.
        complete: nothing is missing.
        stale: they belong to other actuators than the present ones.
        remarks: further sentences, each with whether it is about a singularity.
        hidden: how many the filter leaves out.
        counts: how many each choice of ``Atlas.only`` would show.
    """

    rows: tuple[Row, ...]
    placements: Array
    count: str
    how: str
    complete: bool
    stale: bool
    remarks: tuple[tuple[str, bool], ...]
    hidden: int
    counts: Mapping[Only, int] = field(default_factory=dict)


NONE_YET = Listed((), np.empty((0, 4, 4)), "", "", False, True, (), 0)


def atlas(view: View, known: Known | None) -> Listed:
    """What to show of the solutions in a view; `NONE_YET` while there are none."""
    review, posture = view.review, view.posture
    if not posture.closes:
        why = tr("solutions.open")
        return replace(NONE_YET, stale=False, remarks=((why, False),))
    if known is None or not known.is_of(review):
        return NONE_YET
    found = known.solutions
    stale = not known.stands_at(posture.joints)
    placements = review.machine.transform(found.poses, found.modes)
    rows = _rows(view, known, placements, stale=stale)
    able = _filtered(review, rows)
    chosen = {only: [r for r in able if test(r)] for only, test in _only(review).items()}
    kept = _sorted(review, chosen[review[Atlas].only])
    singular = {motion.text for motion in found.self_motions}
    remarks = [(note, note in singular) for note in found.notes]
    remarks += _news(review, known)
    if not stale and not any(row.here for row in rows):
        remarks.append((tr("solutions.elsewhere"), False))
    return Listed(
        rows=tuple(kept),
        placements=placements[[row.index for row in kept]],
        count=tables.real_of_complex(found),
        how=f"{tables.known(found)} · {found.method} in {tables.seconds_text(found.seconds)}",
        complete=found.complete,
        stale=stale,
        remarks=tuple(remarks),
        hidden=len(rows) - len(kept),
        counts={only: len(found) for only, found in chosen.items()},
    )


def _only(review: Review) -> dict[Only, Callable[[Row], bool]]:
    return {
        "": lambda row: True,
        "mode": lambda row: row.mode == review.mode,
        "new": lambda row: row.new,
        "merging": lambda row: bool(row.remark),
    }


def _rows(view: View, known: Known, placements: Array, *, stale: bool) -> list[Row]:
    found = known.solutions
    points = [p for b in view.drawing.bodies if b.frame == "platform" for p in b.points]
    corners = np.column_stack([np.array(points).reshape(-1, 3), np.ones(len(points))])
    moved = ((placements - view.platform) @ corners.T)[:, :3]
    distance = np.linalg.norm(moved, axis=1).max(axis=1, initial=0.0)
    same = np.array([mode == view.posture.mode for mode in found.modes], dtype=bool)
    here = -1
    if not stale and (same & (distance < HERE)).any():
        here = int(np.where(same, distance, np.inf).argmin())
    return [
        Row(
            identity=found.identities[n],
            index=n,
            pose=tuple(float(v) for v in found.poses[n]),
            mode=found.modes[n],
            distance=float(distance[n]),
            height=float(placements[n, 2, 3]),
            condition=float(found.condition[n]),
            remark=tables.remark(int(found.multiplicity[n]), float(found.gap[n])),
            within_stroke=bool(found.within_stroke[n]),
            here=n == here,
            new=found.identities[n] in known.appeared,
        )
        for n in range(len(found))
    ]


def _filtered(review: Review, rows: list[Row]) -> list[Row]:
    wanted = review[Atlas]
    modes: Sequence[str] = review.machine.modes
    if wanted.modes:
        modes = matching(wanted.modes, review.machine.modes)
    return [r for r in rows if r.mode in modes and (r.within_stroke or not wanted.within_stroke)]


def _sorted(review: Review, rows: list[Row]) -> list[Row]:
    order: dict[str, int] = {mode: n for n, mode in enumerate(review.machine.modes)}
    keys: dict[Sort, Callable[[Row], Any]] = {
        "distance": lambda r: r.distance,
        "condition": lambda r: r.condition,
        "height": lambda r: -r.height,
        "mode": lambda r: (order[r.mode], r.distance),
    }
    return sorted(rows, key=keys[review[Atlas].sort])


# --- sentences -----------------------------------------------------------------------------


def _news(review: Review, known: Known) -> list[tuple[str, bool]]:
    """Who appeared and who merged since the actuators last stood still."""
    news = []
    if known.appeared:
        count = len(known.appeared)
        names = ", ".join(f"#{identity}" for identity in sorted(known.appeared)[:NAMED])
        more = " " + tr("solutions.and_more", n=count - NAMED) if count > NAMED else ""
        news.append((tr("solutions.appeared", n=count, names=names + more), False))
    if known.merged:
        told: list[str] = []
        partners: set[int] = set()
        for gone in known.merged:
            if gone.identity in partners:
                continue
            partners |= {gone.partner} if gone.partner is not None else set()
            place = place_text(review.machine.coordinates, gone.pose)
            key = "solutions.one_gone" if gone.partner is None else "solutions.pair_gone"
            told.append(tr(key, identity=gone.identity, partner=gone.partner, place=place))
        shown = "; ".join(told[:TOLD]) + ("; …" if len(told) > TOLD else "")
        news.append((tr("solutions.merged", n=len(known.merged), names=shown), True))
    return news


# --- the folds ahead -----------------------------------------------------------------------


@dataclass(frozen=True, eq=False, slots=True)
class Ahead:
    """One actuator driven alone to one end of its stroke, and the fold on the way, if any.

    Attributes:
        index: the actuator, from 0.
        start: where it stands, mm or rad.
        end: the end of its stroke.
        fold: where the assembly mode ends before that.
    """

    index: int
    start: float
    end: float
    fold: Fold | None

    @property
    def goal(self) -> float:
        """How far the actuator can go on this assembly mode."""
        return self.end if self.fold is None else self.fold.joints[self.index]

    @property
    def longer(self) -> bool:
        """The direction: towards the upper end."""
        return self.end > self.start


def look_ahead(design: Design, posture: Posture) -> tuple[Ahead, ...]:
    """Both directions of every actuator that has somewhere to go."""
    machine = machine_of(design)
    found = []
    for index, axis in enumerate(machine.joints):
        start = posture.joints[index]
        for end, sign in ((axis.lower, -1), (axis.upper, 1)):
            if sign * (end - start) > 0:
                joints = (*posture.joints[:index], end, *posture.joints[index + 1 :])
                fold = machine.following.fold_ahead(posture, joints)
                found.append(Ahead(index, start, end, fold))
    return tuple(found)


def nearest_first(ahead: Sequence[Ahead], driven: int | None) -> list[Ahead]:
    """Those with a fold: of the actuator that was last driven before the others, then nearest."""
    folds = [(a.index != driven, a.fold.distance, n) for n, a in enumerate(ahead) if a.fold]
    return [ahead[n] for *_, n in sorted(folds)]


def partner(known: Known | None, posture: Posture) -> int | None:
    """The identity of the known solution that a posture is; None if it is none of them."""
    if known is None or not len(known.solutions):
        return None
    off = np.abs(known.solutions.poses - posture.pose).max(axis=1)
    nearest = int(off.argmin())
    same = off[nearest] < SAME and known.solutions.modes[nearest] == posture.mode
    return known.solutions.identities[nearest] if same else None


SOLUTIONS = Question("work.solutions", "solutions", solve, REST, kept=0)
FOLDS = Question("work.folds", "solutions", look_ahead, REST)
