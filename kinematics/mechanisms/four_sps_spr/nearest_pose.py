"""Why a pose of the 4-SPS + 1-SPR cannot be held, and the ways out: another pose, other strokes."""

from __future__ import annotations

from math import inf

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.facets.clearances import ClearancesFacet, Nearest, mm
from kinematics.facets.inverse import posture
from kinematics.mechanisms.four_sps_spr.constraint import complete_pose
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.home import home
from kinematics.mechanisms.four_sps_spr.plane import nearest_place

_HALVINGS = 40


class NearestPose(ClearancesFacet[FourSPSSPRDesign]):
    """Exact at the orientation: a plane region bounded by arcs."""

    def nearest(self, posture: Posture, modes: tuple[str, ...]) -> tuple[Nearest | None, str]:
        """Where the region is empty, the orientation is turned towards that of home as little as it
        takes, which is not proven to be the nearest of all.
        """
        found = _at(self.design, posture, posture.pose[3:])
        if found is not None:
            return found, f"the nearest pose that can be held is {mm(found.distance)} away"
        found = _turned(self.design, posture)
        none_here = "no place can be held at this orientation"
        if found is None:
            return None, f"{none_here}, and none was found at others"
        away = mm(found.distance)
        text = f"{none_here}; one that can, turned towards home, is {away} away"
        return found._replace(error=inf), text


def _at(design: FourSPSSPRDesign, wanted: Posture, angles: tuple[float, ...]) -> Nearest | None:
    position = np.array(wanted.pose[:3])
    found = nearest_place(design, angles, position)
    if found is None:
        return None
    # The constraint and the strokes to the last digit: a hair further inside.
    pose = complete_pose(design, (*found[0].tolist(), *angles))
    there = posture(design, pose)
    if not there.reachable and max(r.amount for r in there.reasons) > 1e-6:
        return None
    known = np.clip(there.joints, design.stroke[:, 0], design.stroke[:, 1])
    distance = float(np.linalg.norm(found[0] - position))
    return Nearest(posture(design, pose, known=known), distance, 0.0)


def _turned(design: FourSPSSPRDesign, wanted: Posture) -> Nearest | None:
    """The least part of the way to the angles of home that makes room."""
    start, goal = np.array(wanted.pose[3:]), np.array(home(design).pose[3:])
    low, high, best = 0.0, 1.0, None
    for _ in range(_HALVINGS):
        part = high if best is None else 0.5 * (low + high)
        a, b, c = (start + part * (goal - start)).tolist()
        found = _at(design, wanted, (a, b, c))
        if found is not None:
            best, high = found, part
        elif best is None:
            return None
        else:
            low = part
        if high - low < 1e-3:
            break
    return best
