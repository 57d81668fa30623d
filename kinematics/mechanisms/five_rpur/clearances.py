"""How far the platform may move at its orientation until a limb meets one of its bounds.

Distances are those of O' to the surface on which the bound is met, in the posture's working mode:
of a stroke end the tube of `feet`, of the reach |Y_i| = l_i (where the limb's two working modes
meet) a plane. The workspace of one mode at one orientation is the intersection of the limbs'
solids, so the nearest of all these is its boundary. Lengths mm, base frame.
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.bounds import Bound, bound_of, decimals, named, range_of
from kinematics.answers.clearances import Clearance
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.feet import ERROR, feet
from kinematics.mechanisms.five_rpur.inverse import LIMITS, signs
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.mechanisms.five_rpur.singularities.nearest import nearest_singularity
from kinematics.screws.spatial import rotation_y


def clearances(design: FiveRPURDesign, posture: Posture) -> tuple[Clearance, ...]:
    """The room to every stroke end and working-mode change, and to the workspace's boundary.

    Where a bound is passed already its distance is negative: the way back to it. A limb that cannot
    close has its reach alone, and the boundary is told of a posture that can be held alone.

    Returns:
        The nearest first, negative ones before. Exact but for rounding.
    """
    position, theta = np.array(posture.pose[:3]), posture.pose[4]
    turn = rotation_y(theta)
    offset = offset_points(design, posture.pose[3], theta)
    relative = position @ turn - offset
    distance, foot = feet(
        relative[:, None], design.link[:, None], signs(posture.mode)[:, None], design.stroke
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
            found.append(_stroke(i, bound, amount, foot[i, end], error))
    found.sort(key=lambda c: c.distance)
    if posture.reachable:
        # A stroke that begins at zero ends at ρ = 0, but the workspace does not.
        edge = next(c for c in found if c.bound != "rho_min" or design.stroke[_at(c), 0] > 0.0)
        found.insert(found.index(edge), _boundary(edge))
    return tuple(found)


def with_singularity(
    design: FiveRPURDesign, posture: Posture, found: tuple[Clearance, ...]
) -> tuple[Clearance, ...]:
    """The same and the room to the nearest parallel singularity, which takes longer to find."""
    singular = nearest_singularity(design, posture.pose, posture.mode)
    if singular is None:
        return found
    more = Clearance(
        "parallel",
        singular.distance,
        _xyz(singular.point),
        f"{_far(singular.distance)} a parallel singularity",
        error=singular.error,
    )
    return tuple(sorted((*found, more), key=lambda c: c.distance))


def _at(clearance: Clearance) -> int:
    return (clearance.limb or 1) - 1


def _stroke(i: int, bound: Bound, amount: float, point: Array, error: float) -> Clearance:
    text = f"{_far(amount)} the end of limb {i + 1}'s stroke ({bound.name})"
    return Clearance("stroke", amount, _xyz(point), text, i + 1, bound, error)


def _reach(i: int, across: float, link: float, position: Array, error: float) -> Clearance:
    """|Y| = l is met along y, which R_y(θ) leaves alone."""
    amount = link - abs(across)
    point = position + np.array([0.0, amount if across >= 0.0 else -amount, 0.0])
    if amount >= 0.0:
        text = f"{_far(amount)} where limb {i + 1} changes its working mode (its link along e₁)"
    else:
        text = f"{_far(amount)} the reach of limb {i + 1}'s link (along e₁)"
    bound = bound_of(LIMITS, i + 1, "link")
    return Clearance("mode", amount, _xyz(point), text, i + 1, bound, error)


def _boundary(edge: Clearance) -> Clearance:
    where = (
        f"limb {edge.limb} at the reach of its link"
        if edge.kind == "mode"
        else f"limb {edge.limb} at {named(edge.bound)}"
    )
    text = f"{_far(edge.distance)} the boundary of the working mode's workspace ({where})"
    return Clearance("boundary", edge.distance, edge.point, text, edge.limb, edge.bound, edge.error)


def _far(amount: float) -> str:
    word = "mm to" if amount >= 0.0 else "mm beyond"
    return f"{abs(amount):.{decimals(abs(amount))}f} {word}"


def _xyz(point: Array) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return (x, y, z)
