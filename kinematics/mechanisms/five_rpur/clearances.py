"""How far the platform may move at its orientation until a limb meets one of its bounds.

Distances are those of O' to the surface on which the bound is met, in the posture's working mode:
of a stroke end the tube of `feet`, of the reach |Y_i| = l_i (where the limb's two working modes
meet) a plane. The workspace of one mode at one orientation is the intersection of the limbs'
solids, so the nearest of all these is its boundary. Lengths mm, base frame.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinematics.answers.bounds import bound_of, named, range_of
from kinematics.answers.clearances import Clearance
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.clearances import far, place, to_parallel, to_range_end
from kinematics.mechanisms.five_rpur.design import LIMBS
from kinematics.mechanisms.five_rpur.feet import ERROR, feet
from kinematics.mechanisms.five_rpur.inverse import LIMITS, signs
from kinematics.mechanisms.five_rpur.nearest_pose.facet import NearestPose
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.mechanisms.five_rpur.singularities.nearest import nearest_singularity
from kinematics.screws.spatial import rotation_y


class Clearances(NearestPose):
    """The room of O′ at its orientation."""

    def to_bounds(self, posture: Posture) -> list[Clearance]:
        """To every stroke end and working-mode change, and to the workspace's boundary.

        A limb that cannot close has its reach alone, and the boundary is told of a posture that can
        be held alone. Exact but for rounding.
        """
        design = self.design
        position, theta = np.array(posture.pose[:3]), posture.pose[4]
        turn = rotation_y(theta)
        offset = offset_points(design, posture.pose[3], theta)
        relative = position @ turn - offset
        distance, foot = feet(
            relative[:, None],
            design.link[:, None],
            signs(posture.mode, design)[:, None],
            design.stroke,
        )
        foot = (foot + offset[:, None]) @ turn.T
        size = float(np.abs(offset).max() + (design.link + design.stroke[:, 1]).max())
        error = ERROR * (size + float(np.abs(position).max()))
        found: list[Clearance] = []
        for i in range(LIMBS):
            found.append(_reach(i, float(relative[i, 1]), float(design.link[i]), position, error))
            if not np.isfinite(posture.joints[i]):
                continue
            for end, bound in enumerate(range_of(LIMITS, i + 1)):
                beyond = any(r.limb == i + 1 and r.bound == bound for r in posture.reasons)
                amount = -float(distance[i, end]) if beyond else float(distance[i, end])
                found.append(to_range_end(bound, amount, foot[i, end], error))
        found.sort(key=lambda c: c.distance)
        if posture.reachable:
            # A stroke that begins at zero ends at ρ = 0, but the workspace does not.
            hollow = design.stroke[:, 0] > 0.0
            edge = next(c for c in found if c.bound != "rho_min" or hollow[(c.limb or 1) - 1])
            found.insert(found.index(edge), _boundary(edge))
        return found

    def to_singularities(self, posture: Posture) -> Iterator[Clearance]:
        near = nearest_singularity(self.design, posture.pose, posture.mode)
        if near is not None:
            yield to_parallel(near.distance, near.point, near.error)


def _reach(i: int, across: float, link: float, position: Array, error: float) -> Clearance:
    """|Y| = l is met along y, which R_y(θ) leaves alone."""
    amount = link - abs(across)
    point = position + np.array([0.0, amount if across >= 0.0 else -amount, 0.0])
    if amount >= 0.0:
        text = f"{far(amount)} where limb {i + 1} changes its working mode (its link along e₁)"
    else:
        text = f"{far(amount)} the reach of limb {i + 1}'s link (along e₁)"
    bound = bound_of(LIMITS, i + 1, "link")
    return Clearance("mode", amount, place(point), text, i + 1, bound, error)


def _boundary(edge: Clearance) -> Clearance:
    where = (
        f"limb {edge.limb} at the reach of its link"
        if edge.kind == "mode"
        else f"limb {edge.limb} at {named(edge.bound)}"
    )
    text = f"{far(edge.distance)} the boundary of the working mode's workspace ({where})"
    return Clearance("boundary", edge.distance, edge.point, text, edge.limb, edge.bound, edge.error)
