"""The smallest changes of single numbers of the design that give a limb back to a pose.

With (X, Y, Z) = C_i − A_i in the base frame turned by R_y(−θ), h = sqrt(l² − Y²) and mode σ, a limb
holds the pose where |Y| ≤ l and ρ_min ≤ hypot(X, Z − σ h) ≤ ρ_max. Of one number moved alone the
values that do are intervals; each ends where ρ meets an end of the stroke or |Y| = l. The nearest
end is thus the smallest change: in closed form for the stroke and the link, from a polynomial of
degree 4 for a point moved along an axis. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from math import ceil

import numpy as np

from kinematics.answers.clearances import DesignChange
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.designs.schema import SHORTEST
from kinematics.errors import BohemiaError
from kinematics.facets.clearances import Path, Way, change
from kinematics.facets.inverse import posture
from kinematics.mechanisms.five_rpur.design import (
    SCHEMA,
    FiveRPURDesign,
    Limb,
    Point,
)
from kinematics.mechanisms.five_rpur.inverse import LINK_SLACK, STROKE_SLACK
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.screws.spatial import rotation_x, rotation_y

_NUDGES = (0.0, *(s * 10.0**n for n in range(-13, -7) for s in (1.0, -1.0)))
"""Parts of the machine's size by which rounding may have carried a value out of its interval."""


def ways(design: FiveRPURDesign, wanted: Posture) -> Iterator[Way]:
    """For each way, one change for each limb at fault that together may allow the wanted posture.

    The ways: of every limb the same number (the end of its stroke, its link, one coordinate of its
    base or of its platform point), and of every limb the number that needs to change least.

    A limb to which no single number would give the pose has its link made long enough to close
    and the end of its stroke moved to where it then is.
    """
    at_fault = list(dict.fromkeys(reason.limb for reason in wanted.reasons))
    offered = [_of_limb(design, wanted, limb - 1) for limb in at_fault]
    for what in offered[0] if offered else ():
        if all(what in limb for limb in offered):
            yield tuple(chain.from_iterable(limb[what] for limb in offered))
    least = (min(limb.values(), key=_amount) for limb in offered)
    yield tuple(chain.from_iterable(least))


def _amount(way: Way) -> float:
    return sum(abs(change.after - change.before) for change in way)


# --- one limb ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Closing:
    """A limb at a pose: C − A in the turned frame, its mode and its numbers."""

    x: float
    y: float
    z: float
    sign: float
    limb: Limb

    @property
    def holds(self) -> bool:
        # Half of what rounding is allowed elsewhere: the design is computed anew there.
        room = self.limb.link * (1.0 + 0.5 * LINK_SLACK) - abs(self.y)
        if room < 0.0:
            return False
        h = np.sqrt(max((self.limb.link - self.y) * (self.limb.link + self.y), 0.0))
        rho = float(np.hypot(self.x, self.z - self.sign * h))
        low, high = self.limb.stroke
        return low - 0.5 * STROKE_SLACK <= rho <= high + 0.5 * STROKE_SLACK

    def moved(self, by: Array) -> _Closing:
        return replace(self, x=self.x + by[0], y=self.y + by[1], z=self.z + by[2])

    def shifts(self, direction: Array) -> Iterator[float]:
        """All δ at which C − A, moved by δ along a direction, may meet a bound."""
        unit = max(map(abs, (self.x, self.y, self.z, self.limb.link, self.limb.stroke[1])))
        here = np.array([self.x, self.y, self.z]) / unit
        x, y, z = np.stack([direction, here], axis=1)
        link = self.limb.link / unit
        if direction[1] != 0.0:
            yield from (unit * (end - here[1]) / direction[1] for end in (link, -link))
        square = np.polysub([link**2], np.polymul(y, y))  # h²
        sides = np.polyadd(np.polyadd(np.polymul(x, x), np.polymul(z, z)), square)
        product = 4.0 * np.polymul(np.polymul(z, z), square)
        for end in self.limb.stroke:
            # ρ² = X² + Z² + h² − 2 σ Z h; squared, that holds in either mode.
            half = np.polysub(sides, [(end / unit) ** 2])
            yield from unit * np.roots(np.polysub(np.polymul(half, half), product)).real

    def links(self) -> Iterator[float]:
        """All lengths of the link at which a bound may be met."""
        yield abs(self.y)
        for end in self.limb.stroke:
            across = (end - self.x) * (end + self.x)
            if across >= 0.0:
                for root in (np.sqrt(across), -np.sqrt(across)):
                    h = self.sign * (self.z - root)
                    if h >= 0.0:
                        yield float(np.hypot(self.y, h))


_STROKE: Path = ("stroke",)
_LINK: Path = ("link",)


def _of_limb(design: FiveRPURDesign, wanted: Posture, i: int) -> dict[Path, Way]:
    """By what is changed: the smallest changes that do, or none where the pose is far away."""
    single: dict[Path, Way] = {what: (change,) for what, change in _single(design, wanted, i)}
    if not single:
        single[_STROKE] = single[_LINK] = _pair(design, wanted, i)
    return single


def _pair(design: FiveRPURDesign, wanted: Posture, i: int) -> Way:
    """The link made long enough to close, and the stroke to go with it.

    At |Y| = l the actuator's length runs as the square root of the link's: the link is rounded up
    to what is told of it, so that both numbers hold as they are read.
    """
    limb = ("limb", i)
    link = ceil(10.0 * abs(_closing(design, wanted, i).y) + 0.1) / 10.0
    try:
        longer_link = SCHEMA.changed(design, (*limb, "link"), link)
    except BohemiaError:  # no machine is that large
        return ()
    rho = posture(longer_link, wanted.pose, wanted.mode).joints[i]
    end = int(rho > design.stroke[i, 1])
    return (
        _change(design, (*limb, "link"), link),
        _change(design, (*limb, "stroke", end), rho),
    )


def _closing(design: FiveRPURDesign, wanted: Posture, i: int) -> _Closing:
    phi, theta = wanted.pose[3:]
    offset = offset_points(design, phi, theta)[i]
    x, y, z = (np.array(wanted.pose[:3]) @ rotation_y(theta) - offset).tolist()
    return _Closing(x, y, z, 1.0 if wanted.mode[i] == "+" else -1.0, design.limbs[i])


def _single(design: FiveRPURDesign, wanted: Posture, i: int) -> Iterator[tuple[Path, DesignChange]]:
    """What is changed, without the limb, and how; the number is the smallest that does."""
    limb = design.limbs[i]
    here = _closing(design, wanted, i)
    numbers = (*limb.base, *limb.platform, *wanted.pose[:3], limb.link, *limb.stroke)
    size = max(map(abs, numbers))

    rho = wanted.joints[i]
    if np.isfinite(rho):
        end = int(rho > limb.stroke[1])
        yield _STROKE, _change(design, ("limb", i, "stroke", end), rho)

    def with_link(shift: float) -> bool:
        length = limb.link + shift
        return length >= SHORTEST and replace(here, limb=replace(limb, link=length)).holds

    shift = _least((length - limb.link for length in here.links()), with_link, size)
    if shift is not None:
        yield _LINK, _change(design, ("limb", i, "link"), limb.link + shift)

    # C − A goes against the base point and with the platform point, both in the turned frame.
    frames: tuple[tuple[str, Point, Array], ...] = (
        ("base", limb.base, -rotation_y(wanted.pose[4]).T),
        ("platform", limb.platform, rotation_x(wanted.pose[3])),
    )
    for key, point, frame in frames:
        for axis in range(3):
            direction = frame[:, axis]

            def moved(shift: float, direction: Array = direction) -> bool:
                return here.moved(shift * direction).holds

            shift = _least(here.shifts(direction), moved, size)
            if shift is not None:
                path = ("limb", i, key, axis)
                yield (key, axis), _change(design, path, point[axis] + shift)


def _least(shifts: Iterable[float], holds: Callable[[float], bool], size: float) -> float | None:
    """The smallest change after which the limb holds the pose, or a rounding beside it."""
    for shift in sorted(shifts, key=abs):
        for nudge in _NUDGES:
            if holds(shift + nudge * size):
                return float(shift + nudge * size)
    return None


# --- in words ------------------------------------------------------------------------------------


def _change(design: FiveRPURDesign, path: Path, after: float) -> DesignChange:
    field = next(f for f in SCHEMA.fields(design) if f.path == path)
    return change(field, after, _NAMES.get(field.label, ""))


_NAMES = {
    "link l": "link",
    **{f"{key} {axis}": f"{key} point {axis}" for key in ("base", "platform") for axis in "xyz"},
}
