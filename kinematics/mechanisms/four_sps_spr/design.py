"""The design of a 4-SPS + 1-SPR: five limbs and the axis of the fifth one's revolute joint."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinematics.arrays import Array, read_only
from kinematics.designs.schema import Key, Schema, ordered, point

Point = tuple[float, float, float]
LIMBS = 5
SPR = 4
"""The SPR limb, counted from 0."""
SUBSCRIPTS = "₁₂₃₄₅"
JOINT_SYMBOLS = tuple(f"l{index}" for index in SUBSCRIPTS)
SHORTEST_AXIS = 1e-9
"""A direction with numbers smaller than this is none."""


@dataclass(frozen=True, slots=True)
class Limb:
    """One limb; the letters of Wang et al. (2017) in brackets. All in mm.

    Attributes:
        base: centre of its spherical joint on the base (A_i), base frame.
        platform: of its joint on the platform (B_i), platform frame.
        stroke: the shortest and the longest |A_i B_i| (l_i).
    """

    base: Point
    platform: Point
    stroke: tuple[float, float]


@dataclass(frozen=True)
class FourSPSSPRDesign:
    """Five limbs, the fifth with a revolute joint on the platform. Frozen and hashable.

    Attributes:
        limbs: the SPR limb is the last.
        revolute_axis: direction of its revolute joint, platform frame, of any length.
    """

    limbs: tuple[Limb, Limb, Limb, Limb, Limb]
    revolute_axis: Point
    name: str = ""
    title: str = ""
    source: str = ""

    mechanism = "four_sps_spr"

    @cached_property
    def base(self) -> Array:
        """A_i, (5, 3) mm in the base frame, read-only."""
        return read_only([limb.base for limb in self.limbs])

    @cached_property
    def platform(self) -> Array:
        """b_i, (5, 3) mm in the platform frame, read-only."""
        return read_only([limb.platform for limb in self.limbs])

    @cached_property
    def stroke(self) -> Array:
        """(5, 2) mm: the shortest and the longest lengths, read-only."""
        return read_only([limb.stroke for limb in self.limbs])

    @cached_property
    def axis(self) -> Array:
        """n6 in the platform frame, (3,) of length one, read-only."""
        direction = np.array(self.revolute_axis)
        return read_only(direction / np.linalg.norm(direction))

    @cached_property
    def offset(self) -> float:
        """b5·n6, mm: how far from p the plane is that limb 5 moves in."""
        return float(self.platform[SPR] @ self.axis)

    @cached_property
    def length(self) -> float:
        """The characteristic length, mm, that makes rotations comparable with displacements.

        The root mean square distance of the platform points from their centroid; where they all
        coincide, a tenth of the mean of the longest limb lengths.
        """
        spread = self.platform - self.platform.mean(axis=0)
        length = float(np.sqrt((spread**2).sum(axis=1).mean()))
        longest = float(self.stroke[:, 1].mean())
        return length if length > 1e-9 * longest else 0.1 * longest

    @cached_property
    def size(self) -> float:
        """A typical length of the machine, mm."""
        return float(max(np.abs(self.base).max(), np.abs(self.platform).max(), self.stroke.max()))


# --- design files --------------------------------------------------------------------------


def _a_direction(what: str, axis: Point) -> str:
    if max(map(abs, axis)) >= SHORTEST_AXIS:
        return ""
    return (
        f"{what} must be a direction in the platform frame, as [1, 0, 0]; its numbers are all zero"
    )


_SPR_HEADING = f"Limb {SPR + 1} (SPR)"

SCHEMA = Schema(
    FourSPSSPRDesign,
    (
        Key(
            "revolute_axis",
            ("n₆ x", "n₆ y", "n₆ z"),
            "",
            _a_direction,
            group=_SPR_HEADING,
            what="a direction",
        ),
    ),
    limb=Limb,
    limb_keys=(
        point("base"),
        point("platform"),
        Key(
            "stroke",
            ("l min", "l max"),
            check=ordered("shortest", "longest", "the shortest length"),
        ),
    ),
    limbs=LIMBS,
    headings=(*(f"Limb {i + 1}" for i in range(SPR)), _SPR_HEADING),
)
"""Eight numbers a limb, in mm, and the three of the revolute axis."""
