"""What a move of the pose passes, paths as a machine is driven along them, and paths by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.bounds import Bound, decimals
from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Followed, Posture
from kinematics.answers.trajectories import NamedTrajectory
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.events import MoveEvents, after_part, shown_end
from kinematics.facets.facet import Facet
from kinematics.facets.inverse import InverseFacet
from kinematics.facets.segments import ROUNDING, Part, Segment
from kinematics.facets.statics import StaticsFacet
from kinematics.mechanism import D
from kinematics.screws.wrenches import determinant
from kinematics.zeros import special_points

WARNED = 5.0
"""mm from a singularity, angles times the characteristic length: nearer, there is a warning."""
_ROUNDINGS = (0.0, 1e-15, 1e-13, 1e-11, 1e-9)  # of a way, by which a posture may be held again


class PathsFacet(Facet[D]):
    """Straight moves in the pose coordinates and what they meet.

    Attributes:
        gap: mm, angles times the characteristic length, by which a path stops before a singularity.
        at_reach: what is the case where a limb is at its reach.
    """

    topic = "paths"
    gap: float = 1e-6
    at_reach: str = "at the end of its reach"

    # --- what a move passes

    def passed(self, before: Posture, after: Posture, through: ArrayLike = ()) -> tuple[Event, ...]:
        """What is passed on the way from one posture to another of the same mode, in order.

        The way is straight, or straight from one to the next of the poses ``through`` (N, P);
        angles go the shorter way round. Of postures in different modes it is only told that no way
        was driven.

        Returns:
            Events with fractions of the whole length, angles counted by the characteristic length.

        Raises:
            InputError: the poses on the way are not P finite numbers each.
        """
        if before.mode != after.mode:
            return (self.changed_mode(before, after),)
        count = len(self.mechanism.coordinates)
        between = finite(np.reshape(through, (-1, count)), name="a pose")
        moves = self._moves([before.pose, *between, after.pose], before.mode)
        if len(moves) == 1:
            return self.events(moves[0])
        lengths = [move.length for move in moves]
        whole, done = sum(lengths), 0.0
        told: list[Event] = []
        for move, length in zip(moves, lengths, strict=True):
            for event in self.events(move):
                fraction = (done + event.fraction * length) / whole
                text = event.text.replace(after_part(event.fraction), after_part(fraction))
                told.append(replace(event, fraction=fraction, text=text))
            done += length
        return tuple(told)

    def events(self, move: Segment) -> tuple[Event, ...]:
        """What one straight move passes, in order."""
        return MoveEvents(self, move).all()

    def drive(self, posture: Posture, poses: ArrayLike) -> Followed:
        """From a posture through poses (N, P), as driven, up to what would stop the machine.

        A path stops at the end of a range itself, but `gap` before a singularity that it would
        cross or touch. From a parallel singularity it may lead away.

        Returns:
            The posture reached, what stopped it, and what else was passed; ``fraction`` of the
            whole length.

        Raises:
            InputError: no poses, or not P finite numbers each.
        """
        symbols = [c.symbol for c in self.mechanism.coordinates]
        corners = finite(poses, name="a pose", last=len(symbols))
        if corners.ndim != 2 or not len(corners):
            names = ", ".join(symbols)
            raise InputError(f"a path must be a list of poses of {len(symbols)} numbers ({names})")
        if not posture.reachable:
            text = f"cannot start: {posture.reasons[0].text}"
            return Followed(posture, "stalled", text, 0.0)
        moves = self._moves([posture.pose, *corners], posture.mode)
        whole, done = sum(move.length for move in moves), 0.0
        notes: list[str] = []
        here = posture
        for move in moves:
            for event in self.events(move):
                if not event.stops:
                    notes.append(event.text)
                    continue
                at_end = event.kind == "stroke"
                s = event.fraction if at_end else max(event.fraction - self.gap / move.length, 0.0)
                here = self._reached(move, s, here)
                covered = (done + s * move.length) / whole
                return Followed(
                    here,
                    "stroke" if at_end else "singularity",
                    "; ".join([*notes, self._why(event, here, covered)]),
                    covered,
                    event.limb,
                    self.warning(here, stopped=not at_end),
                )
            here = self._posture(move.pose(1.0), move.mode)
            done += move.length
        return Followed(here, "target", "; ".join(notes), 1.0, warning=self.warning(here))

    def warning(self, posture: Posture, *, stopped: bool = False) -> str:
        """One phrase where a posture that closes is within `WARNED` of a singularity; else "".

        Of a parallel singularity the distance is a first order estimate, see
        `Segment.to_singularity`; of a serial one it is that to the reach, or a length itself.

        Args:
            stopped: a motion stopped at a parallel singularity, which need not be told again.
        """
        if not posture.closes:
            return ""
        parts = []
        if not stopped:
            away = self.segment(posture.pose, posture.pose, posture.mode).to_singularity(
                posture.pose
            )
            if away < WARNED:
                parts.append(f"about {away:.{decimals(away)}f} mm from a parallel singularity")
        lengths = {c.limb for c in self.mechanism.actuators if c.unit == "mm" and not c.signed}
        for margin in posture.margins:
            amount = float("inf")
            if margin.bound.end == "link":
                amount = max(margin.amount, 0.0)
            elif margin.bound.end == "min" and margin.limb in lengths:
                amount = posture.joints[margin.limb - 1]
            if amount < WARNED:
                away_text = f"{amount:.{decimals(amount)}f} mm from a serial singularity"
                parts.append(f"{away_text} of limb {margin.limb}")
        return " and ".join(parts)

    def named(self) -> tuple[NamedTrajectory, ...]:
        """Trajectories that the mechanism's paper or trade runs, by name."""
        return ()

    # --- what a mechanism may know better

    def consistent(self, poses: Array) -> Array:
        """Poses (n, P) brought to where the machine can be assembled, where coordinates depend on
        each other."""
        return poses

    def reach(self, poses: Array, mode: str) -> Array:
        """(n, R) parts of a limb's size at poses (n, P), positive where the limb closes; zero where
        it is in a serial singularity. Smooth, finite, for the limbs of `reach_limbs`."""
        joints = self.mechanism.joints(poses, mode)
        margins = self.mechanism.margins(poses, mode, joints)
        links = [bound.end == "link" for bound in self.mechanism.bounds]
        return np.nan_to_num(margins[:, links], nan=1.0) / self.mechanism.length

    @property
    def reach_limbs(self) -> tuple[int, ...]:
        """Of each column of `reach`, the limb from 1."""
        return tuple(b.limb or 0 for b in self.mechanism.bounds if b.end == "link")

    def ranges(self, poses: Array, mode: str) -> Array:
        """(n, B) of `ends`, positive within, of any scale; smooth where the same limbs close."""
        joints = self.mechanism.joints(poses, mode)
        margins = self.mechanism.margins(poses, mode, joints)
        return margins[:, [bound.end in ("min", "max") for bound in self.mechanism.bounds]]

    def determinant(self, poses: Array, mode: str) -> tuple[Array, Array]:
        """(n,) of the wrenches at poses (n, P), of any scale, and what of it is rounding."""
        rows = self.other(StaticsFacet).at(poses, mode).rows
        value = determinant(rows, self.mechanism.length)
        return np.nan_to_num(value), np.full(len(poses), ROUNDING)

    def breaks(self, move: Segment) -> Sequence[float]:
        """Where else, but at the reach of limbs, `ranges` and `determinant` are not smooth."""
        return ()

    def places(
        self,
        move: Segment,
        part: Part,
        functions: Callable[[Array], Array],
        *,
        stationary: bool = False,
        noise: float = 0.0,
    ) -> list[Array]:
        """Where each of K functions (n,) → (n, K) of t may be zero, sorted, with both ends.

        Args:
            stationary: also where they may have an extreme.
            noise: values below which a function is rounding.
        """
        return special_points(functions, 0.0, np.pi, stationary=stationary, noise=noise)

    def changed_mode(self, before: Posture, after: Posture) -> Event:
        """That another mode was set, to which no way was driven."""
        was, is_now = (self.mechanism.mode(posture.mode) for posture in (before, after))
        if was.operation != is_now.operation:
            text = (
                f"the operation mode was set to {after.mode}; the machine itself comes there only "
                "through a constraint singularity"
            )
            return Event("parallel", 0.0, before.pose, None, text, True)
        signs = zip(was.signs, is_now.signs, strict=True)
        limbs = [n for n, (one, two) in enumerate(signs, 1) if one != two]
        which = f"limb {limbs[0]}" if len(limbs) == 1 else f"limbs {', '.join(map(str, limbs))}"
        text = (
            f"went to another working mode of {which}; the machine itself comes there only through "
            "a serial singularity"
        )
        return Event("serial", 0.0, before.pose, limbs[0] if len(limbs) == 1 else None, text, True)

    def touched(self, limb: int, what: str, where: str) -> str:
        """That a limb came to its reach, and not beyond."""
        return f"limb {limb} touched {what} {where}, {self.at_reach}"

    # --- inside

    def segment(self, start: ArrayLike, end: ArrayLike, mode: str) -> Segment:
        """The straight move between two poses."""
        return Segment.between(self, start, end, mode)

    def _moves(self, corners: Sequence[ArrayLike], mode: str) -> list[Segment]:
        return [self.segment(a, b, mode) for a, b in pairwise(corners)]

    def _posture(self, pose: Sequence[float], mode: str) -> Posture:
        return self.other(InverseFacet).posture(pose, mode)

    def _reached(self, move: Segment, s: float, here: Posture) -> Posture:
        """The posture at s, or a rounding before it; where none can be held, the one before."""
        for back in _ROUNDINGS:
            there = self._posture(move.pose(max(s - back, 0.0)), move.mode)
            if there.reachable:
                return there
        return here

    @cached_property
    def ends(self) -> list[tuple[Bound, float]]:
        """The ends of the joints' ranges with their numbers, as in `ranges`."""
        joints = {c.limb: (c.lower, c.upper) for c in self.mechanism.actuators}
        ends = [b for b in self.mechanism.bounds if b.end in ("min", "max")]
        return [(b, joints[b.limb][b.end == "max"]) for b in ends]

    def _why(self, event: Event, here: Posture, covered: float) -> str:
        """What is said of the event that stops a path."""
        if event.kind == "serial":
            return f"stopped at a serial singularity of limb {event.limb} {after_part(covered)}"
        if event.kind == "parallel":
            return f"stopped at a parallel singularity {after_part(covered)}"
        own = [m for m in here.margins if m.limb == event.limb and m.bound.end in ("min", "max")]
        bound = min(own, key=lambda m: abs(m.amount)).bound
        end = next(number for each, number in self.ends if each is bound)
        shown = shown_end(bound, end)
        whose = f"{bound.joint} is at the end of its range"
        if bound.unit == "mm":
            whose = f"limb {event.limb} is at the end of its stroke"
        return f"{whose} ({shown}) {after_part(covered)}"
