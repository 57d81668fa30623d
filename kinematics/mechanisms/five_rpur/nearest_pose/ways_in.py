"""Why a pose cannot be held, and the ways out: another pose, another mode, another design."""

from __future__ import annotations

from math import degrees

from kinematics.answers.bounds import decimals
from kinematics.answers.clearances import Remedy
from kinematics.answers.solutions import Posture
from kinematics.facets.clearances import ClearancesFacet
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import MODES, inverse
from kinematics.mechanisms.five_rpur.nearest_pose.projection import Found, nearest
from kinematics.mechanisms.five_rpur.nearest_pose.redesign import changes
from kinematics.mechanisms.five_rpur.nearest_pose.turning import turned

_MODES_NAMED = 3


class NearestPose(ClearancesFacet[FiveRPURDesign]):
    """Proven at the orientation, searched for at others."""

    def nearest_pose(self, posture: Posture) -> Remedy:
        """The ways out of a posture that cannot be held.

        The nearest posture is at the same orientation: in the same working mode, and where that has
        no place there at all, in another one; both are proven to be the nearest (see `projection`).
        Where no mode has any, other orientations are searched, of the same mode first (see
        `turning`).
        """
        design, wanted = self.design, posture
        if wanted.reachable:
            return Remedy(wanted, 0.0, (), "this pose can be held")
        within = inverse(design, wanted.pose).within_stroke
        modes = tuple(mode for mode, ok in zip(MODES, within, strict=True) if ok)
        found, text = _nearest(design, wanted)
        if modes:
            text = f"{text}; {_modes_text(modes)}"
        elif found is not None and found.posture.mode == wanted.mode:
            text += _nearer(design, wanted, found)
        return Remedy(
            nearest=None if found is None else found.posture,
            distance=float("inf") if found is None else found.distance,
            changes=changes(design, wanted),
            text=text,
            modes=modes,
            error=0.0 if found is None else found.error,
        )


def _nearest(design: FiveRPURDesign, wanted: Posture) -> tuple[Found | None, str]:
    pose = wanted.pose
    found = nearest(design, pose, wanted.mode)
    if found is not None:
        return found, (
            f"the nearest pose that working mode {shown(wanted.mode)} can hold is "
            f"{_mm(found.distance)} away"
        )
    for mode in MODES:
        closer = nearest(design, pose, mode, float("inf") if found is None else found.distance)
        found = closer or found
    if found is not None:
        none_here = f"working mode {shown(wanted.mode)} has no place at this orientation"
        if found.distance == 0.0:  # what follows tells the modes
            return found, none_here
        return found, (
            f"{none_here}; the nearest pose that can be held is in working mode "
            f"{shown(found.posture.mode)}, {_mm(found.distance)} away"
        )
    found = turned(design, wanted)
    if found is None:
        return None, "no pose that this machine can hold was found"
    there = found.posture
    by = [
        f"{symbol} = {degrees(there.pose[k]):.1f}°"
        for k, symbol in ((3, "φ"), (4, "θ"))
        if abs(there.pose[k] - pose[k]) > 5e-4
    ]
    by_mode = "" if there.mode == wanted.mode else f" in working mode {shown(there.mode)}"
    return found, (
        f"no working mode has any place at this orientation; the nearest pose that a search found "
        f"is {_mm(found.distance)} away with {' and '.join(by)}{by_mode}"
    )


def _nearer(design: FiveRPURDesign, wanted: Posture, found: Found) -> str:
    """That another mode comes nearer at the same orientation, if one does."""
    best = found
    for mode in MODES:
        best = nearest(design, wanted.pose, mode, best.distance) or best
    if best.posture.mode == wanted.mode or best.distance >= found.distance - found.error:
        return ""
    return f"; working mode {shown(best.posture.mode)} comes as near as {_mm(best.distance)}"


def _modes_text(modes: tuple[str, ...]) -> str:
    if len(modes) == 1:
        return f"this very pose can be held in working mode {shown(modes[0])}"
    named = ", ".join(shown(mode) for mode in modes[:_MODES_NAMED])
    more = "" if len(modes) <= _MODES_NAMED else f" and {len(modes) - _MODES_NAMED} more"
    return f"this very pose can be held in working modes {named}{more}"


def _mm(distance: float) -> str:
    return f"{distance:.{decimals(distance)}f} mm"


def shown(mode: str) -> str:
    """A mode with true minus signs."""
    return mode.replace("-", "−")
