"""Why a pose cannot be held, and the ways out: another pose, another mode, another design."""

from __future__ import annotations

from math import degrees, inf

from kinematics.answers.clearances import DesignChanges
from kinematics.answers.solutions import Posture
from kinematics.facets.clearances import ClearancesFacet, Nearest, mm
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.nearest_pose.projection import nearest
from kinematics.mechanisms.five_rpur.nearest_pose.redesign import ways

_MODES_NAMED = 3


class NearestPose(ClearancesFacet[FiveRPURDesign]):
    """Proven at the orientation, searched for at others."""

    def nearest(self, posture: Posture, modes: tuple[str, ...]) -> tuple[Nearest | None, str]:
        """The nearest posture is at the same orientation: in the same working mode, and where that
        has no place there at all, in another one; both are proven to be the nearest (see
        `projection`). Where no mode has any, other orientations are searched, of the same mode
        first.
        """
        found, text = self._nearest(posture)
        if modes:
            text = f"{text}; {_modes_text(modes)}"
        elif found is not None and found.posture.mode == posture.mode:
            text += _nearer(self.design, posture, found)
        return found, text

    def changes(self, posture: Posture) -> DesignChanges:
        return self.allowing(posture, ways(self.design, posture))

    def _nearest(self, wanted: Posture) -> tuple[Nearest | None, str]:
        design, pose = self.design, wanted.pose
        found = nearest(design, pose, wanted.mode)
        if found is not None:
            return found, (
                f"the nearest pose that working mode {shown(wanted.mode)} can hold is "
                f"{mm(found.distance)} away"
            )
        for mode in design.modes:
            closer = nearest(design, pose, mode, float("inf") if found is None else found.distance)
            found = closer or found
        if found is not None:
            none_here = f"working mode {shown(wanted.mode)} has no place at this orientation"
            if found.distance == 0.0:  # what follows tells the modes
                return found, none_here
            return found, (
                f"{none_here}; the nearest pose that can be held is in working mode "
                f"{shown(found.posture.mode)}, {mm(found.distance)} away"
            )
        found = self._turned(wanted)
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
            "no working mode has any place at this orientation; the nearest pose that a search "
            f"found is {mm(found.distance)} away with {' and '.join(by)}{by_mode}"
        )

    def _turned(self, wanted: Posture) -> Nearest | None:
        """At another orientation, of the same mode if there is any; of all places there the nearest
        one.
        """
        design = self.design
        for modes in ((wanted.mode,), design.modes):
            at = self.searched(wanted, modes)
            if at is not None:
                found = nearest(design, (*wanted.pose[:3], *at.pose[3:]), at.mode)
                return None if found is None else found._replace(error=inf)
        return None


def _nearer(design: FiveRPURDesign, wanted: Posture, found: Nearest) -> str:
    """That another mode comes nearer at the same orientation, if one does."""
    best = found
    for mode in design.modes:
        best = nearest(design, wanted.pose, mode, best.distance) or best
    if best.posture.mode == wanted.mode or best.distance >= found.distance - found.error:
        return ""
    return f"; working mode {shown(best.posture.mode)} comes as near as {mm(best.distance)}"


def _modes_text(modes: tuple[str, ...]) -> str:
    if len(modes) == 1:
        return f"this very pose can be held in working mode {shown(modes[0])}"
    named = ", ".join(shown(mode) for mode in modes[:_MODES_NAMED])
    more = "" if len(modes) <= _MODES_NAMED else f" and {len(modes) - _MODES_NAMED} more"
    return f"this very pose can be held in working modes {named}{more}"


def shown(mode: str) -> str:
    """A mode with true minus signs."""
    return mode.replace("-", "−")
