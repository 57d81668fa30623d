"""What bounds a parallel mechanism: its coordinates, joints and their names, and margins."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite
from typing import Literal

import numpy as np

from kinematics.answers.bounds import SUBSCRIPTS, Bound
from kinematics.answers.coordinates import Coordinate
from kinematics.arrays import Array
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.drives import dot
from kinematics.mechanisms.parallel.limbs import Limb
from kinematics.mechanisms.parallel.mobility import NAMES, SYMBOLS
from kinematics.screws.spatial import common_box

FOLLOWING = "parasitic motion"
_LETTERS = {
    "leg": ("rho", "ρ"),
    "offset leg": ("rho", "ρ"),
    "slider": ("s", "s"),
    "crank": ("q", "q"),
    "elbow": ("q", "q"),
    "direction": ("q", "q"),
}


def symbol(n: int, limb: Limb) -> str:
    """Of the joint of a limb, from 0."""
    return f"{_LETTERS[limb.drive][1]}{SUBSCRIPTS[n]}"


@dataclass(frozen=True, eq=False)
class Ranges:
    """Bounds and margins of one machine."""

    machine: Assembly

    # --- coordinates

    def joints(self) -> tuple[Coordinate, ...]:
        """The actuated joints."""
        machine = self.machine
        now = machine.drives.joints(machine.reference, machine.branch)
        found = []
        for n, limb in enumerate(machine.limbs):
            low, high = limb.low, limb.high
            turning = limb.turns
            free = turning and not isfinite(high - low)
            if not isfinite(high - low):
                half = np.pi if turning else max(limb.rod, float(np.linalg.norm(limb.b)))
                half = half or float(now[n])
                low, high = (-np.pi, np.pi) if turning else (now[n] - half, now[n] + half)
                if limb.drive == "leg" and limb.shift == 0.0:
                    low = max(low, 0.0)
            unit: Literal["mm", "rad"] = "rad" if turning else "mm"
            signed = turning or limb.drive == "slider" or limb.shift != 0.0
            key = f"{_LETTERS[limb.drive][0]}{n + 1}"
            span = float(low), float(high)
            found.append(
                Coordinate(key, symbol(n, limb), unit, *span, limb=n + 1, signed=signed, free=free)
            )
        return tuple(found)

    def poses(self) -> tuple[Coordinate, ...]:
        """The coordinates of the pose: angles turn all the way, O′ is where all limbs may reach."""
        low, high = self._box
        found = []
        for n in self.machine.chart.free:
            if n < 3:
                found.append(Coordinate(NAMES[n], SYMBOLS[n], "mm", low[n], high[n]))
            else:
                found.append(Coordinate(NAMES[n], SYMBOLS[n], "rad", -np.pi, np.pi))
        return tuple(found)

    @cached_property
    def _box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        machine = self.machine
        still = {3, 4, 5} <= set(machine.chart.fixed)
        turn = machine.reference[:3, :3]
        centres, radii = [], []
        for limb in machine.limbs:
            if limb.drive == "direction":
                continue
            b = turn @ limb.b
            centre, reach = limb.a, limb.crank + limb.rod
            if limb.drive in ("leg", "offset leg"):
                far = limb.high - limb.shift + (limb.rod if limb.drive == "offset leg" else 0.0)
                reach = far if isfinite(far) else 2.0 * float(np.linalg.norm(b - limb.a))
            if limb.drive == "slider" and isfinite(limb.high - limb.low):
                centre = limb.a + 0.5 * (limb.low + limb.high) * limb.axis
                reach = limb.rod + 0.5 * (limb.high - limb.low)
            elif limb.drive == "slider":
                reach = limb.rod + 2.0 * machine.length
            centres.append(centre - (b if still else 0.0))
            radii.append(reach + (0.0 if still else float(np.linalg.norm(b))))
        if not centres:
            place = machine.reference[:3, 3]
            return tuple((place - machine.length).tolist()), tuple(
                (place + machine.length).tolist()
            )
        low, high = common_box(np.array(centres), np.array(radii))
        return low, high

    # --- bounds

    @cached_property
    def _each(self) -> tuple[tuple[Bound, str, int], ...]:
        """Every bound, what it is, and of which limb from 0."""
        found: list[tuple[Bound, str, int]] = []
        if self.machine.chart.following:
            found.append((Bound(FOLLOWING, "link", FOLLOWING), "following", 0))
        for n, limb in enumerate(self.machine.limbs):
            name, number = symbol(n, limb), n + 1
            unit: Literal["mm", "rad"] = "rad" if limb.turns else "mm"
            if limb.branches > 1:
                found.append((Bound(name, "link", "reach", "mm", number), "link", n))
            found += [
                (Bound(name, end, f"{name} {end}", unit, number), end, n) for end in ("min", "max")
            ]
            for cone in ("base_cone", "platform_cone"):
                if isfinite(getattr(limb, cone)):
                    title = f"cone at the {cone.partition('_')[0]}"
                    found.append((Bound(name, cone, title, "mm", number), cone, n))
            if isfinite(limb.skew):
                found.append(
                    (Bound(name, "skew", "skew of the parallelogram", "mm", number), "skew", n)
                )
        return tuple(found)

    @cached_property
    def bounds(self) -> tuple[Bound, ...]:
        """In the order of `margins`."""
        return tuple(bound for bound, _, _ in self._each)

    def margins(self, placement: Array, signs: Array, joints: Array, room: Array) -> Array:
        """(..., K) of placements (..., 4, 4) with joints (..., L), see `Mechanism.margins`.

        Args:
            signs: (..., L) ±1.
            room: (...) how far poses are from not existing; infinite where there is no such end.
        """
        machine = self.machine
        links = machine.drives.room(placement)
        answer = np.full((*joints.shape[:-1], len(self._each)), np.nan)
        rods: dict[str, Array] = {}
        for k, (_, what, n) in enumerate(self._each):
            limb, q = machine.limbs[n], joints[..., n]
            if what == "following":
                answer[..., k] = room
            elif what == "link":
                lever = machine.length if limb.drive == "direction" else 1.0
                answer[..., k] = lever * links[..., n]
            elif what == "min":
                answer[..., k] = q - limb.low if limb.low > -inf else np.nan
            elif what == "max":
                answer[..., k] = limb.high - q if limb.high < inf else np.nan
            else:
                if not rods:
                    rods = self._rods(placement, signs)
                v = rods["base"][..., n, :]
                if what == "skew":
                    answer[..., k] = limb.rod * np.sin(limb.skew) - np.abs(v @ limb.axis)
                    continue
                frame = what.partition("_")[0]
                v, middle = rods[frame][..., n, :], self._middles[frame][n]
                angle = getattr(limb, what)
                along = v @ middle
                across = np.sqrt(np.maximum(dot(v, v) - along**2, 0.0))
                answer[..., k] = along * np.sin(angle) - across * np.cos(angle)
        return answer

    def _rods(self, placement: Array, signs: Array) -> dict[str, Array]:
        """(..., L, 3) from E to B in both frames."""
        e, _ = self.machine.drives.arms(placement, signs)
        base = self.machine.drives.points(placement) - e
        return {"base": base, "platform": base @ placement[..., :3, :3]}

    @cached_property
    def _middles(self) -> dict[str, Array]:
        found = self._rods(self.machine.reference, self.machine.branch)
        return {k: v / np.linalg.norm(v, axis=-1, keepdims=True) for k, v in found.items()}
