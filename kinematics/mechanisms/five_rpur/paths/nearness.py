"""A warning where control is nearly lost."""

from __future__ import annotations

from kinematics.answers.bounds import decimals
from kinematics.answers.solutions import Posture
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.paths.straight import Way

WARNED = 5.0
"""mm from a singularity, angles times the characteristic length: nearer, there is a warning."""


def warning(design: FiveRPURDesign, posture: Posture, *, stopped: bool = False) -> str:
    """One phrase where a posture that closes is within `WARNED` of a singularity; else "".

    Of a parallel singularity the distance is |F| / |∇F| over all five coordinates, a first order
    estimate; of a serial one it is l − |Y|, or ρ itself.

    Args:
        stopped: a motion stopped at a parallel singularity, which need not be told again.
    """
    if not posture.closes:
        return ""
    parts = []
    if not stopped:
        apart = Way.between(design, posture.pose, posture.pose, posture.mode).apart(posture.pose)
        if apart < WARNED:
            parts.append(f"about {apart:.{decimals(apart)}f} mm from a parallel singularity")
    for margin in posture.margins:
        i = margin.limb - 1
        if margin.bound == "link" and margin.amount < WARNED:
            distance = max(margin.amount, 0.0)
        elif margin.bound == "rho_min" and posture.joints[i] < WARNED:
            distance = posture.joints[i]
        else:
            continue
        parts.append(
            f"{distance:.{decimals(distance)}f} mm from a serial singularity of limb {i + 1}"
        )
    return " and ".join(parts)
