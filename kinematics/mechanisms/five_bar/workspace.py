"""The workspace of the five-bar as exact loops of arcs, per working mode and for any set of modes.

A limb that turns freely reaches the ring between |r_1 − r_2| and r_1 + r_2 about A_i in both
working modes. With a range of θ_i it reaches, in each mode, a four-sided region: parts of the
ring's two circles, where the limb is stretched or folded, and the half circles of radius r_2 about
B_i at the two ends of the range. Both limbs together reach the intersection, several modes the
union. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from kinematics.answers.sections import BOUNDS
from kinematics.facets.inverse import inside
from kinematics.mechanisms.five_bar import inverse
from kinematics.mechanisms.five_bar.design import LIMBS, FiveBarDesign
from kinematics.plane import arcs, arrangement
from kinematics.plane.arcs import Arcs, Edge

_LINK = BOUNDS.index("link")
_ENDS = BOUNDS.index("rho_min"), BOUNDS.index("rho_max")


@lru_cache(maxsize=64)
def loops(design: FiveBarDesign, modes: tuple[str, ...] | None = None) -> list[list[Edge]]:
    """The boundary of what P reaches in any of ``modes`` (None: of all), loop by loop.

    Edges carry the limb and, as their bound, "link" where the limb is stretched or folded (a
    serial singularity) or the end of the joint's range. Points A_i that a limb with r_1 = r_2
    folds onto are serial singularities too, but bound nothing.
    """
    chosen = inverse.MODES if modes is None else modes
    candidates = made_of(design, chosen)
    return arrangement.boundary(
        candidates, lambda points: inside(design, points, chosen), design.size
    )


def made_of(design: FiveBarDesign, modes: Sequence[str]) -> Arcs:
    """Every arc that can bound the workspace in these modes, counter-clockwise."""
    parts: list[Arcs] = []
    for i in range(LIMBS):
        for sign in sorted({mode[i] for mode in modes}):
            parts += _limb_arcs(design, i, 1.0 if sign == "+" else -1.0)
    return arcs.joined(parts)


def _limb_arcs(design: FiveBarDesign, i: int, sign: float) -> list[Arcs]:
    limb, base = design.limbs[i], design.base[i]
    r1, r2 = limb.proximal, limb.distal
    low, high = design.joint_range[i].tolist()
    free = limb.joint_range_deg is None
    start, sweep = (0.0, 2 * np.pi) if free else (low, high - low)
    found = [arcs.arc(base, r1 + r2, start, sweep, i + 1, _LINK)]
    inner = abs(r1 - r2)
    if inner > arcs.MEETING * design.size:
        # Folded, P lies on the elbow's side of A_i if r_1 > r_2, else on the other.
        turn = 0.0 if r1 > r2 else np.pi
        found.append(arcs.arc(base, inner, start + turn, sweep, i + 1, _LINK))
    if not free:
        for angle, bound in zip((low, high), _ENDS, strict=True):
            elbow = base + r1 * np.array([np.cos(angle), np.sin(angle)])
            # With sign + the distal link is turned from the proximal one by −π to 0.
            first = angle - np.pi if sign > 0 else angle
            found.append(arcs.arc(elbow, r2, first, np.pi, i + 1, bound))
    return found
