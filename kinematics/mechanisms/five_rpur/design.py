"""The design of a 5-RPUR: five limbs, each a base point, a platform point, a link and a stroke."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinematics.arrays import Array, read_only
from kinematics.designs.schema import Key, Schema, ordered, point, positive

Point = tuple[float, float, float]
LIMBS = 5
SUBSCRIPTS = "₁₂₃₄₅"
JOINT_SYMBOLS = tuple(f"ρ{index}" for index in SUBSCRIPTS)


@dataclass(frozen=True, slots=True)
class Limb:
    """One RPUR limb; the letters of Tale Masouleh et al. (2011) in brackets. All in mm.

    Attributes:
        base: A_i in the base frame (r_i).
        platform: C_i in the platform frame (s'_i).
        link: |B_i C_i| (l_i).
        stroke: the shortest and the longest |A_i B_i| (ρ_min, ρ_max).
    """

    base: Point
    platform: Point
    link: float
    stroke: tuple[float, float]


@dataclass(frozen=True)
class FiveRPURDesign:
    """Five limbs and where they come from. Frozen and hashable; the arrays are cached."""

    limbs: tuple[Limb, Limb, Limb, Limb, Limb]
    name: str = ""
    title: str = ""
    source: str = ""

    mechanism = "five_rpur"

    @cached_property
    def base(self) -> Array:
        """r_i, (5, 3) mm in the base frame, read-only."""
        return read_only([limb.base for limb in self.limbs])

    @cached_property
    def platform(self) -> Array:
        """s'_i, (5, 3) mm in the platform frame, read-only."""
        return read_only([limb.platform for limb in self.limbs])

    @cached_property
    def link(self) -> Array:
        """l_i, (5,) mm, read-only."""
        return read_only([limb.link for limb in self.limbs])

    @cached_property
    def stroke(self) -> Array:
        """(5, 2) mm: ρ_min and ρ_max, read-only."""
        return read_only([limb.stroke for limb in self.limbs])

    @cached_property
    def length(self) -> float:
        """The characteristic length, mm, that makes rotations comparable with displacements.

        The root mean square distance of the platform points from their centroid; where they all
        coincide, the mean link length.
        """
        spread = self.platform - self.platform.mean(axis=0)
        length = float(np.sqrt((spread**2).sum(axis=1).mean()))
        return length if length > 1e-9 * float(self.link.max()) else float(self.link.mean())


# --- design files --------------------------------------------------------------------------

SCHEMA = Schema(
    FiveRPURDesign,
    limb=Limb,
    limb_keys=(
        point("base"),
        point("platform"),
        Key("link", ("link l",), check=positive),
        Key("stroke", ("ρ min", "ρ max"), check=ordered("ρ_min", "ρ_max", "ρ_min")),
    ),
    limbs=LIMBS,
)
"""Nine numbers a limb, all in mm."""
