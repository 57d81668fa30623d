"""The design of a 3-RPS or a 3-SPR: two circumradii and a stroke that its three limbs share.

A_i = h1 u_i on the base, B_i = h2 u_i on the platform, u_i at the azimuths 0, −120° and 120°. The
3-RPS has its revolute joints on the base and its spherical ones on the platform, the 3-SPR the
other way round: either is the other one held by its platform, which `revolute_radius` and
`spherical_radius` put into words. Nayak, Nurahmi, Wenger, Caro, *Comparison of 3-RPS and 3-SPR
Parallel Manipulators based on their Maximum Inscribed Singularity-free Circle* (2017), section 2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kinematics.answers.modes import Mode, one_of
from kinematics.arrays import Array
from kinematics.designs.schema import Key, Schema, ordered, positive

Kind = Literal["three_rps", "three_spr"]
KINDS: tuple[Kind, Kind] = ("three_rps", "three_spr")
LIMBS = 3
SUBSCRIPTS = "₁₂₃"
JOINT_SYMBOLS = tuple(f"ρ{index}" for index in SUBSCRIPTS)
AZIMUTHS = (0.0, -2.0 * np.pi / 3.0, 2.0 * np.pi / 3.0)
"""Of u_1, u_2, u_3, rad."""
MODES = (Mode(1), Mode(2))
"""The operation modes: 1 is x0 = 0, a half turn about z at home, and 2 is x3 = 0."""


def _directions() -> tuple[Array, Array]:
    angle = np.array(AZIMUTHS)
    zero = np.zeros(LIMBS)
    radial = np.stack([np.cos(angle), np.sin(angle), zero], axis=-1)
    tangent = np.stack([np.sin(angle), -np.cos(angle), zero], axis=-1)
    radial.setflags(write=False)
    tangent.setflags(write=False)
    return radial, tangent


RADIAL, TANGENT = _directions()
"""u_i and s_i, (3, 3) each: towards the joints, and along the axes of the revolute ones (eq. 5)."""


@dataclass(frozen=True, slots=True)
class TripodDesign:
    """A 3-RPS or 3-SPR; all in mm. Frozen and hashable.

    Attributes:
        mechanism: which of the two.
        base_radius: h1.
        platform_radius: h2.
        stroke: the shortest and the longest |A_i B_i|.
    """

    mechanism: Kind
    base_radius: float
    platform_radius: float
    stroke: tuple[float, float]
    name: str = ""
    title: str = ""
    source: str = ""

    @property
    def revolute_on_base(self) -> bool:
        """Of the 3-RPS."""
        return self.mechanism == "three_rps"

    @property
    def revolute_radius(self) -> float:
        """Circumradius of the triangle that carries the revolute joints."""
        return self.base_radius if self.revolute_on_base else self.platform_radius

    @property
    def spherical_radius(self) -> float:
        """Circumradius of the triangle that carries the spherical joints."""
        return self.platform_radius if self.revolute_on_base else self.base_radius

    @property
    def size(self) -> float:
        """A typical length of the machine."""
        return 0.6 * (self.base_radius + self.platform_radius) + 0.5 * self.stroke[1]


def mode_sign(mode: str) -> float:
    """σ: −1 in operation mode 1, in which the platform is turned by π about its normal, +1 in 2.

    Raises:
        InputError: there is no such mode.
    """
    return -1.0 if one_of(mode, MODES) == "1" else 1.0


# --- design files --------------------------------------------------------------------------


class _TripodSchema(Schema[TripodDesign]):
    def further(self, table: Mapping[str, Any], *, origin: str) -> dict[str, Any]:
        return {"mechanism": table["mechanism"]}


SCHEMA = _TripodSchema(
    TripodDesign,
    (
        Key("base_radius", ("base radius h₁",), check=positive, group="Triangles"),
        Key("platform_radius", ("platform radius h₂",), check=positive, group="Triangles"),
        Key(
            "stroke",
            ("ρ min", "ρ max"),
            check=ordered("ρ_min", "ρ_max", "ρ_min"),
            group="Limbs",
        ),
    ),
)
"""Four numbers, all in mm."""
