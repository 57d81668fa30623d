"""One assembly mode while the actuators move on a straight line in joint space.

Small steps by the screws, each brought back onto the loops by Newton's method and taken only if
that leads little astray and the determinant of the wrenches keeps its sign. That is no proof, but a
jump to another assembly mode would need two of them closer together than a step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, cast

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.solutions import Fold, Followed, Posture, Stop
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.following import (
    Carried,
    FollowingFacet,
    aimed,
    not_closed_text,
    stopped_text,
)
from kinematics.facets.inverse import posture as posture_at
from kinematics.facets.paths import PathsFacet
from kinematics.mechanisms.parallel.bonds import moved
from kinematics.mechanisms.parallel.closing import newton
from kinematics.mechanisms.parallel.design import ParallelDesign
from kinematics.mechanisms.parallel.mechanism import Parallel
from kinematics.mechanisms.parallel.statics import wrenches
from kinematics.screws.wrenches import determinant, singular_values

_LONGEST = 0.08  # of the characteristic length and rad: what the platform moves in a step
_STRAYS = 0.1  # of a step: how far Newton's method may lead astray
_CLOSES = 1e-11  # of the characteristic length
_STEPS = 3000
_SHORTEST = 1e-13  # of the way
_SINGULAR = 1e-6  # least singular value of the wrenches in which nothing is determined
_STOPS = 1e-4  # at which a motion stops
_MIRRORED = 1e-3  # of the way: how far before a fold its two modes are told apart
_UNDETERMINED = (
    "the machine stands in a parallel singularity, where its actuators do not determine how it "
    "moves; move the platform out of it first"
)


@dataclass(frozen=True, eq=False)
class _End:
    """Where a way led.

    Attributes:
        placement: (4, 4).
        part: of the way, 0 to 1.
        stop: what ended it.
        earlier: a placement before, at ``earlier_part``, from where the fold is well seen.
    """

    placement: Array
    part: float
    stop: Literal["target", "singularity", "stalled", "undetermined"]
    earlier: Array
    earlier_part: float


class Following(FollowingFacet[ParallelDesign]):
    """By small steps, not proven; what turns freely takes the shorter way round."""

    @property
    def _parallel(self) -> Parallel:
        return cast(Parallel, self.mechanism)

    def follow(self, posture: Posture, joints: ArrayLike) -> Followed:
        wanted = self.wanted(joints)
        if not posture.closes:
            return Followed(posture, "stalled", not_closed_text(posture), 0.0)
        axes = self.mechanism.actuators
        now = np.array(posture.joints)
        free = np.array([axis.free for axis in axes])
        turn = wanted - now
        turn = np.where(free, turn - 2.0 * np.pi * np.round(turn / (2.0 * np.pi)), turn)
        low, high = np.array([(a.lower, a.upper) for a in axes]).T
        low, high = np.where(free, -np.inf, low), np.where(free, np.inf, high)
        aim, blocked, share = aimed(now, now + turn, low, high)
        start = self.mechanism.transform(posture.pose, posture.mode)
        end = self._walk(start, now, aim)
        at = now + end.part * (aim - now)
        reached = posture if end.part == 0.0 else self._posture(end.placement, at)
        stop: Stop = "target"
        limb, text = None, _changed(posture.mode, reached.mode)
        if end.stop == "undetermined":
            stop, text = "singularity", _UNDETERMINED
        elif end.stop == "singularity":
            stop = "singularity"
            text = _joined(text, self._stopped(aim - now, reached, end.part * share))
        elif end.stop == "stalled":
            stop = "stalled"
            part = 100.0 * end.part * share
            text = _joined(text, f"could not be followed further than {part:.3g} % of the way")
        elif blocked is not None:
            stop, limb = "stroke", blocked + 1
            axis = axes[blocked]
            last = axis.upper if wanted[blocked] > axis.upper else axis.lower
            unit = "°" if axis.unit == "rad" else " mm"
            text = _joined(
                text, f"{axis.symbol} stopped at the end of its range, {axis.outer(last):g}{unit}"
            )
        found = Followed(reached, stop, text, end.part * share, limb)
        return replace(found, warning=self.other(PathsFacet).warning(reached))

    def fold_ahead(self, posture: Posture, joints: ArrayLike) -> Fold | None:
        wanted = self.wanted(joints)
        axes = self.mechanism.actuators
        for n, axis in enumerate(axes):
            if axis.unit == "mm" and not axis.signed and wanted[n] < 0.0:
                raise InputError(
                    f"the joints must not be negative, got {axis.symbol} = {wanted[n]:g} mm"
                )
        if not posture.closes:
            return None
        now = np.array(posture.joints)
        start = self.mechanism.transform(posture.pose, posture.mode)
        end = self._walk(start, now, wanted)
        if end.stop != "singularity":
            return None
        at = now + end.part * (wanted - now)
        there = self._posture(end.placement, at)
        partner = self._partner(end, now, wanted)
        distance = end.part * float(np.linalg.norm(wanted - now))
        return Fold(distance, tuple(at.tolist()), there.pose, there.mode, partner)

    def carried(
        self, pose: Sequence[float], mode: str, joints: ArrayLike, wanted: ArrayLike
    ) -> Carried:
        """Where a solution at joints (J,) is led when they move straight to others."""
        now, aim = np.asarray(joints, dtype=float), np.asarray(wanted, dtype=float)
        if np.abs(aim - now).max() == 0.0:
            return Carried(tuple(pose), mode, 1.0)
        end = self._walk(self.mechanism.transform(pose, mode), now, aim)
        at = now + end.part * (aim - now)
        there = self._posture(end.placement, at)
        return Carried(there.pose, there.mode, end.part)

    # --- inside

    def _walk(self, start: Array, now: Array, aim: Array) -> _End:
        machine = self._parallel.machine
        length = machine.length
        scale = np.array([1.0, 1.0, 1.0, length, length, length])
        move = aim - now
        t, part, h = start, 0.0, 0.05
        visited = [(t, 0.0)]
        signs = machine.drives.branches(t, now)
        v, least, side = self._rate(t, signs, move)
        if np.abs(move).max() == 0.0:
            return _End(t, 1.0, "target", t, 0.0)
        if not least > _SINGULAR:
            return _End(t, 0.0, "undetermined", t, 0.0)
        for _ in range(_STEPS):
            far = float(np.linalg.norm(v * scale)) / length
            h = min(h, 1.0 - part, _LONGEST / max(far, 1e-300))
            joints = now + (1.0 if part + h >= 1.0 - 1e-15 else part + h) * move
            guess = moved(t, h * v)
            found = newton(machine, guess[None], joints[None], rounds=8)
            there = found.placement[0]
            off = np.append((there - guess)[:3, :3].ravel() * length, (there - guess)[:3, 3])
            astray = float(np.linalg.norm(off)) / length
            good = found.off[0] < _CLOSES * length and astray < _STRAYS * h * far + 1e-9
            if good:
                new_signs = machine.drives.branches(there, joints)
                rate, new_least, new_side = self._rate(there, new_signs, move)
                good = new_side == side
            if not good:
                h *= 0.3
                if h < _SHORTEST or (h < 1e-8 and least < 1e-3):
                    stop: Literal["singularity", "stalled"] = (
                        "singularity" if least < 0.02 else "stalled"
                    )
                    return _End(t, part, stop, *_before(visited, part))
                continue
            t, part = there, 1.0 if part + h >= 1.0 - 1e-15 else part + h
            visited.append((t, part))
            v, least = rate, new_least
            if part == 1.0:
                return _End(t, 1.0, "target", t, 1.0)
            if least < _STOPS:
                return _End(t, part, "singularity", *_before(visited, part))
            if astray < 0.25 * _STRAYS * h * far:
                h *= 1.8
        return _End(t, part, "stalled", t, part)

    def _rate(self, t: Array, signs: Array, move: Array) -> tuple[Array, float, float]:
        """[v, ω] for the joints' rates, how well the wrenches hold, and the side of the fold."""
        machine = self._parallel.machine
        rows, gain, _ = wrenches(machine, t, signs)
        rows, gain = np.asarray(rows), np.asarray(gain)
        if not np.isfinite(rows).all():
            return np.zeros(6), 0.0, 0.0
        right = np.zeros(6)
        right[: len(move)] = gain * move
        length = machine.length
        scale = np.array([1.0, 1.0, 1.0, length, length, length])
        least = float(singular_values(rows, length)[-1])
        v = np.linalg.lstsq(rows / scale, right)[0] / scale
        return v, least, float(np.sign(determinant(rows, length)))

    def _posture(self, placement: Array, joints: Array) -> Posture:
        mechanism = self._parallel
        pose = mechanism.machine.chart.pose(placement)
        modes, _ = mechanism.modes_of(pose[None], placement[None], joints[None])
        return posture_at(self.design, pose, modes[0], known=joints)

    def _partner(self, end: _End, now: Array, wanted: Array) -> Posture | None:
        """Who the assembly mode merges with: mirrored at the fold, and led back."""
        machine = self._parallel.machine
        at = now + end.earlier_part * (wanted - now)
        turn = end.placement[:3, :3] @ end.earlier[:3, :3].T
        guess = end.placement.copy()
        guess[:3, :3] = turn @ end.placement[:3, :3]
        guess[:3, 3] += end.placement[:3, 3] - end.earlier[:3, 3]
        found = newton(machine, guess[None], at[None])
        if not found.off[0] < 1e-9 * machine.length:
            return None
        apart = np.abs(found.placement[0] - end.earlier)[:3].max()
        if apart < 0.5 * np.abs(end.placement - end.earlier)[:3].max():
            return None
        back = self._walk(found.placement[0], at, now)
        return self._posture(back.placement, now) if back.stop == "target" else None

    def _stopped(self, move: Array, reached: Posture, part: float) -> str:
        axes = self.mechanism.actuators
        text = stopped_text(move, reached, part, [axis.symbol for axis in axes])
        moving = np.flatnonzero(np.abs(move) > 1e-9)
        if len(moving) == 1 and axes[moving[0]].unit == "rad":
            axis = axes[moving[0]]
            where = "beyond" if move[moving[0]] > 0 else "below"
            value = axis.outer(reached.joints[moving[0]])
            text = (
                f"stopped at a parallel singularity: {axis.symbol} cannot go {where} {value:.2f}° "
                "on this assembly mode"
            )
        return text


def _before(visited: list[tuple[Array, float]], part: float) -> tuple[Array, float]:
    """A placement on the way, and where it is, shortly before it ended."""
    for placement, at in reversed(visited):
        if part - at >= _MIRRORED * max(part, 1e-3):
            return placement, at
    return visited[0]


def _changed(before: str, after: str) -> str:
    """Which limbs passed into another working mode."""
    limbs = [n + 1 for n, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    if not limbs:
        return ""
    return f"passed a serial singularity into working mode {after.replace('-', '−')}"


def _joined(*parts: str) -> str:
    return "; ".join(filter(None, parts))
