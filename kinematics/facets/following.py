"""One assembly mode while the actuators move on a straight line in joint space.

The generic way follows a mechanism's closure equations by proven steps, see
`kinematics.homotopy.continuation`: it never jumps to another assembly mode.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.solutions import Fold, Followed, Posture, SelfMotion, Stop
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.homotopy.continuation import MOST_PIECES, turn_ahead, walk
from kinematics.homotopy.curve import Curve
from kinematics.homotopy.quadrics import Quadrics
from kinematics.homotopy.self_motion import curve_of_solutions
from kinematics.mechanism import D

_STILL = 1e-14  # a way of this part of the joints is none
SLACK = 1e-9  # mm or rad by which a wanted joint may lie beyond its stroke


class FollowingFacet(Facet[D]):
    """Following an assembly mode, and the fold ahead at which it merges with another."""

    @abstractmethod
    def follow(self, posture: Posture, joints: ArrayLike) -> Followed:
        """Move the joints on a straight line to ``joints`` (J,), mm or rad, on the assembly mode.

        Wanted joints beyond a stroke are cut off at its end; a joint that is beyond its stroke
        already may stay there or come back, but not go further. The motion stops just before a
        parallel singularity and never jumps to another assembly mode.

        Args:
            posture: the posture now.

        Returns:
            The posture reached and what stopped it; ``fraction`` is measured in joint space.

        Raises:
            InputError: not J finite numbers.
        """

    @abstractmethod
    def fold_ahead(self, posture: Posture, joints: ArrayLike) -> Fold | None:
        """The parallel singularity at which the assembly mode ends on the line to ``joints``.

        The line is not cut off at stroke ends, unlike that of `follow`. None where the way is
        free, and for a posture that does not close or stands in a singularity.

        Raises:
            InputError: not J finite numbers; lengths that are negative.
        """

    def wanted(self, joints: ArrayLike) -> Array:
        """One set of joints (J,).

        Raises:
            InputError: it is not.
        """
        count = len(self.mechanism.actuators)
        wanted = finite(joints, name="the joints", last=count)
        if wanted.shape != (count,):
            raise InputError(f"one set of {count} joints can be followed at a time")
        return wanted


class Aim(NamedTuple):
    """Where the joints can go: cut off at stroke ends.

    Attributes:
        joints: (J,).
        blocked: the joint that is held back most, from 0; None if none is.
        share: how much of the way is left, in joint space.
    """

    joints: Array
    blocked: int | None
    share: float


def aimed(now: Array, wanted: Array, low: Array, high: Array) -> Aim:
    """``wanted`` cut off at the ends ``low`` and ``high`` of strokes; beyond, where a joint is."""
    aim = np.clip(wanted, np.minimum(low, now), np.maximum(high, now))
    beyond = np.abs(wanted - aim)
    blocked = int(beyond.argmax()) if beyond.max() > SLACK else None
    whole = float(np.linalg.norm(wanted - now))
    share = 1.0 if blocked is None else float(np.linalg.norm(aim - now)) / whole
    return Aim(aim, blocked, share)


class ClosureFollowing(FollowingFacet[D]):
    """Following by the closure equations, which a mechanism states as quadrics."""

    edge: int | None = None
    """An unknown that ends the assembly mode where it changes its sign; None: no such."""

    @property
    def unit(self) -> float:
        """mm that count as 1 among the unknowns: a length of the machine."""
        return self.mechanism.length

    @abstractmethod
    def closure(self, mode: str) -> Quadrics:
        """F = 0 in n unknowns and then the J joints, both in units of `unit`: n equations."""

    @abstractmethod
    def unknowns(self, pose: Sequence[float], mode: str) -> Array:
        """The unknowns (n,) of a pose, closed or nearly so.

        Raises:
            InputError: not P finite numbers, or no such mode.
        """

    @abstractmethod
    def posture(self, unknowns: Array, joints: Array, pose: Sequence[float], mode: str) -> Posture:
        """The posture of unknowns (n,) with its joints (J,) mm, come from a pose in a mode."""

    def events(self, start: Posture, end: Posture, visited: Array) -> str:
        """What happened on a way along points (K, n), in words; "" if nothing."""
        return ""

    def edge_text(self, start: Posture) -> str:
        """Said where the way ends at `edge`."""
        return ""

    def warning(self, reached: Followed) -> str:
        """One phrase where the posture reached is near a singularity, else ""."""
        return ""

    def follow(self, posture: Posture, joints: ArrayLike, most: int = MOST_PIECES) -> Followed:
        wanted = self.wanted(joints)
        if not posture.closes:
            return Followed(posture, "stalled", not_closed_text(posture), 0.0)
        first, now = self._start(posture)
        coordinates = self.mechanism.actuators
        low, high = np.array([(c.lower, c.upper) for c in coordinates]).T
        aim, blocked, share = aimed(now, wanted, low, high)
        symbols = [c.symbol for c in coordinates]
        moved, fraction, happened, text = posture, 1.0, "", ""
        stop: Stop = "target"
        line = self._line(posture.mode, first, now, aim)
        if line is not None:
            end = walk(line.curve, line.first, line.way, self.edge, most)
            stop = "singularity" if end.stop == "edge" else end.stop
            fraction = 1.0 if stop == "target" else float(end.point[-1]) / line.way
            if stop == "target" or len(end.visited) > 1:
                there = aim if stop == "target" else line.joints(end.point)
                moved = self.posture(end.point[:-1], there, posture.pose, posture.mode)
                happened = self.events(posture, moved, end.visited[:, :-1])
            if end.undetermined:
                text = _UNDETERMINED
            elif end.stop == "edge":
                text = self.edge_text(posture)
            elif stop == "singularity":
                text = stopped_text(aim - now, moved, fraction * share, symbols)
            elif stop == "stalled":
                part = 100.0 * fraction * share
                text = f"could not be followed further than {part:.3g} % of the way"
        limb = None
        if stop == "target" and blocked is not None:
            stop, limb = "stroke", blocked + 1
            ends = float(low[blocked]), float(high[blocked])
            text = stroke_text(limb, symbols[blocked], float(wanted[blocked]), ends)
        text = "; ".join(filter(None, (happened, text)))
        reached = Followed(moved, stop, text, fraction * share, limb)
        return replace(reached, warning=self.warning(reached))

    def fold_ahead(self, posture: Posture, joints: ArrayLike) -> Fold | None:
        wanted = self.wanted(joints)
        lengths = [c.unit == "mm" and not c.signed for c in self.mechanism.actuators]
        short = (wanted < 0.0) & lengths
        if short.any():
            limb = int(short.argmax())
            symbol = self.mechanism.actuators[limb].symbol
            raise InputError(f"the joints must not be negative, got {symbol} = {wanted[limb]:g} mm")
        if not posture.closes:
            return None
        first, now = self._start(posture)
        line = self._line(posture.mode, first, now, wanted)
        if line is None:
            return None
        found = turn_ahead(line.curve, line.first, line.way, self.edge)
        if found is None:
            return None
        at = line.joints(found.point)
        there = self.posture(found.point[:-1], at, posture.pose, posture.mode)
        partner = None
        if found.partner is not None:
            partner = self.posture(found.partner[:-1], now, there.pose, there.mode)
        distance = float(found.point[-1]) * self.unit
        return Fold(distance, tuple(at.tolist()), there.pose, there.mode, partner)

    def carried(
        self, pose: Sequence[float], mode: str, joints: ArrayLike, wanted: ArrayLike
    ) -> Carried:
        """Where a solution at joints (J,) is led when they move straight to others, strokes or not.

        As in `follow` it ends shortly before a parallel singularity, and never jumps.
        """
        first, now = self._closed(pose, mode, np.asarray(joints, dtype=float))
        aim = np.asarray(wanted, dtype=float)
        line = self._line(mode, first, now, aim)
        if line is None:
            return Carried(tuple(pose), mode, 1.0)
        end = walk(line.curve, line.first, line.way, self.edge)
        part = 1.0 if end.stop == "target" else float(end.point[-1]) / line.way
        at = aim if end.stop == "target" else line.joints(end.point)
        there = self.posture(end.point[:-1], at, pose, mode)
        return Carried(there.pose, there.mode, part)

    def polish(self, pose: Sequence[float], mode: str, joints: ArrayLike) -> Posture | None:
        """The posture with the given joints that Newton's method reaches from a guess.

        Args:
            pose: the guess, (P,).
            mode: in which it starts; the solution's mode is what it came out as.
            joints: (J,) mm.

        Returns:
            None where Newton's method does not converge: at a parallel singularity, or from too
            far.

        Raises:
            InputError: not P or J finite numbers, or no such mode.
        """
        wanted = self.wanted(joints)
        found = self.solved(self.unknowns(pose, mode), mode, wanted)
        return None if found is None else self.posture(found, wanted, pose, mode)

    def solved(self, guess: Array, mode: str, joints: Array, rounds: int = 40) -> Array | None:
        """The unknowns (n,) with joints (J,) mm that Newton's method reaches, if it does."""
        curve, point = self._curve(mode, guess, joints, np.zeros(len(joints)))
        found = curve.correct(point, curve.level, rounds=rounds)
        return None if found is None else curve.polished(found[0])[:-1]

    # --- with the joints locked

    def self_motions(
        self, poses: ArrayLike, modes: Sequence[str], joints: ArrayLike
    ) -> tuple[SelfMotion, ...]:
        """What stays free with joints (J,) locked: motions through solutions near poses (N, P).

        Returns:
            One for each mode in which some was found.
        """
        found: dict[str, SelfMotion] = {}
        for pose, mode in zip(np.asarray(poses, dtype=float).tolist(), modes, strict=True):
            motion = self._self_motion(pose, mode, np.asarray(joints, dtype=float))
            if motion is not None:
                found.setdefault(motion.mode, motion)
                if not self.mechanism.mode_noun:
                    break
        return tuple(found.values())

    def moves_on(self, posture: Posture, tries: tuple[float, ...] = (0.01, 0.04)) -> bool:
        """Whether a singular posture can move on, both ways and a finite way, joints locked.

        Next to a double solution, or one that counts three- or fourfold, there are none.
        """
        first, now = self._start(posture)
        return curve_of_solutions(self._locked(posture.mode, first, now), first, tries) is not None

    def _self_motion(self, pose: list[float], mode: str, joints: Array) -> SelfMotion | None:
        guess = self.unknowns(pose, mode)
        found = curve_of_solutions(self._locked(mode, guess, joints), guess)
        if found is None:
            return None
        here, free = found
        at = self.posture(here, joints, pose, mode)
        ahead = self.posture(here + 1e-6 * free, joints, at.pose, at.mode)
        d = np.subtract(ahead.pose, at.pose)
        coordinates = self.mechanism.coordinates
        turns = np.array([c.unit == "rad" for c in coordinates])
        d[turns] = np.mod(d[turns] + np.pi, 2.0 * np.pi) - np.pi
        parts = np.abs(d) * np.where(turns, self.mechanism.length, 1.0)
        d = d / np.sqrt((parts**2).sum())
        least = 0.05 * parts.max()
        names = [c.symbol for c, part in zip(coordinates, parts, strict=True) if part > least]
        text = (
            f"Self-motion{f' in mode {at.mode}' if at.mode else ''}: the platform moves freely "
            f"({', '.join(names)}) with all actuators locked; infinitely many solutions belong to "
            "it."
        )
        return SelfMotion(at.pose, at.mode, tuple(d.tolist()), text)

    def _locked(self, mode: str, like: Array, joints: Array) -> Quadrics:
        """The closure equations in the unknowns alone."""
        place = np.concatenate([np.zeros(len(like)), joints / self.unit])
        return self.closure(mode).along(place, np.eye(len(place), len(like)))

    def _start(self, posture: Posture) -> tuple[Array, Array]:
        """Unknowns and joints (J,) mm of a posture, which close to within rounding."""
        return self._closed(posture.pose, posture.mode, np.array(posture.joints))

    def _closed(self, pose: Sequence[float], mode: str, joints: Array) -> tuple[Array, Array]:
        first, closure = self.unknowns(pose, mode), self.closure(mode)
        count = len(first)
        for _ in range(2):
            v = np.concatenate([first, joints / self.unit])
            by_joints = closure.slopes(v)[:, count:]
            joints = joints - self.unit * np.linalg.lstsq(by_joints, closure.values(v))[0]
        return first, joints

    def _curve(self, mode: str, first: Array, now: Array, direction: Array) -> tuple[Curve, Array]:
        """The closure equations with joints ``now`` + λ ``direction`` (J,), and where λ = 0."""
        count = len(first)
        place = np.concatenate([np.zeros(count), now / self.unit])
        directions = np.eye(len(place), count + 1)
        directions[count:, count] = direction
        point = np.append(first, 0.0)
        return Curve(self.closure(mode).along(place, directions), point), point

    def _line(self, mode: str, first: Array, now: Array, aim: Array) -> _Line | None:
        """The straight way from ``now`` to ``aim``; None where that is no way."""
        way = float(np.linalg.norm(aim - now))
        if way <= _STILL * max(float(np.abs(now).max()), self.unit):
            return None
        direction = (aim - now) / way
        curve, point = self._curve(mode, first, now, direction)
        return _Line(curve, point, now, direction * self.unit, way / self.unit)


class Carried(NamedTuple):
    """Where a solution was led, in which mode it is there, and on how much of the way, 0 to 1."""

    pose: tuple[float, ...]
    mode: str
    fraction: float


class _Line(NamedTuple):
    """Joints on a straight way: ``now`` + λ ``direction``, 0 ≤ λ ≤ ``way``."""

    curve: Curve
    first: Array
    now: Array
    direction: Array
    way: float

    def joints(self, point: Array) -> Array:
        return np.asarray(self.now + float(point[-1]) * self.direction)


# --- what is said --------------------------------------------------------------------------

_UNDETERMINED = (
    "the machine stands in a parallel singularity, where its actuators do not determine how it "
    "moves; move the platform out of it first"
)


def not_closed_text(posture: Posture) -> str:
    """Said where there is nothing to follow."""
    limbs = [i + 1 for i, joint in enumerate(posture.joints) if not np.isfinite(joint)]
    which = f"limb {limbs[0]}" if len(limbs) == 1 else f"limbs {', '.join(map(str, limbs))}"
    whys = [reason.text for reason in posture.reasons if reason.limb in limbs]
    why = whys[0] if len(whys) == 1 else f"{which} cannot close at this pose"
    return (
        f"{why}, so there is no assembly mode to follow; "
        "move the platform to a pose that the machine can hold"
    )


def stroke_text(
    limb: int, symbol: str, wanted: float, stroke: Sequence[float], unit: str = "mm"
) -> str:
    """Said where a limb (from 1) is held at the end of its stroke though more was ``wanted``."""
    name, end = ("max", stroke[1]) if wanted > stroke[1] else ("min", stroke[0])
    return f"limb {limb} is at the end of its stroke ({symbol} {name} = {end:g} {unit})"


def stopped_text(move: Array, reached: Posture, fraction: float, symbols: Sequence[str]) -> str:
    """Said where a fold stops a motion: of a single joint what it cannot pass."""
    moving = np.flatnonzero(np.abs(move) > SLACK)
    if len(moving) == 1:
        i = int(moving[0])
        where = "beyond" if move[i] > 0 else "below"
        return (
            f"stopped at a parallel singularity: {symbols[i]} cannot go {where} "
            f"{reached.joints[i]:.1f} mm on this assembly mode"
        )
    return f"stopped at a parallel singularity after {100 * fraction:.3g} % of the way"
