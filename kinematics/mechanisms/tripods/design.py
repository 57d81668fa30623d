"""The design of a 3-RPS or a 3-SPR: two circumradii and a stroke that its three limbs share.

A_i = h1 u_i on the base, B_i = h2 u_i on the platform, u_i at the azimuths 0, −120° and 120°. The
3-RPS has its revolute joints on the base and its spherical ones on the platform, the 3-SPR the
other way round: either is the other one held by its platform, which `revolute_radius` and
`spherical_radius` put into words. Nayak, Nurahmi, Wenger, Caro, *Comparison of 3-RPS and 3-SPR
Parallel Manipulators based on their Maximum Inscribed Singularity-free Circle* (2017), section 2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kinematics.arrays import Array
from kinematics.designs.files import (
    TableError,
    change_table,
    check_keys,
    read_number,
    read_numbers,
    read_text,
)
from kinematics.errors import InputError
from kinematics.mechanism import DesignField

Kind = Literal["three_rps", "three_spr"]
KINDS: tuple[Kind, Kind] = ("three_rps", "three_spr")
LIMBS = 3
SUBSCRIPTS = "₁₂₃"
JOINT_SYMBOLS = tuple(f"ρ{index}" for index in SUBSCRIPTS)
AZIMUTHS = (0.0, -2.0 * np.pi / 3.0, 2.0 * np.pi / 3.0)
"""Of u_1, u_2, u_3, rad."""
MODES = ("1", "2")
"""The operation modes: 1 is x0 = 0, a half turn about z at home, and 2 is x3 = 0."""
SHORTEST = 1e-3
"""mm; below a micrometre a radius is a slip of the pen."""


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
    if mode not in MODES:
        raise InputError(f"an operation mode is 1 or 2, got {mode[:20]!r}")
    return -1.0 if mode == "1" else 1.0


# --- design files --------------------------------------------------------------------------


def design_from_table(
    table: Mapping[str, Any], *, kind: Kind, origin: str, name: str
) -> TripodDesign:
    """The design that a parsed design file describes.

    Raises:
        DesignError: naming the origin, the key and the remedy.
    """
    check_keys(
        table,
        required=("mechanism", "base_radius", "platform_radius", "stroke"),
        optional=("title", "source"),
        origin=origin,
    )
    base, platform = (_radius(table, key, origin) for key in ("base_radius", "platform_radius"))
    low, high = read_numbers(table["stroke"], 2, origin=origin, path=("stroke",))
    if low < 0.0:
        raise TableError(
            origin, ("stroke",), f"stroke: ρ_min must not be negative (mm), got {low:g}"
        )
    if low >= high:
        raise TableError(
            origin,
            ("stroke",),
            f"stroke must be [ρ_min, ρ_max] with ρ_min < ρ_max (mm), got [{low:g}, {high:g}]",
        )
    return TripodDesign(
        kind,
        base,
        platform,
        (low, high),
        name=name,
        title=read_text(table, "title", origin=origin),
        source=read_text(table, "source", origin=origin),
    )


def _radius(table: Mapping[str, Any], key: str, origin: str) -> float:
    value = read_number(table[key], origin=origin, path=(key,))
    if value < SHORTEST:
        raise TableError(
            origin, (key,), f"{key} must be a positive length (mm, at least 0.001), got {value:g}"
        )
    return value


def design_to_table(design: TripodDesign) -> dict[str, Any]:
    """What a design file says, as plain values; lengths in mm."""
    return {
        "mechanism": design.mechanism,
        "title": design.title,
        "source": design.source,
        "base_radius": design.base_radius,
        "platform_radius": design.platform_radius,
        "stroke": list(design.stroke),
    }


def design_fields(design: TripodDesign) -> tuple[DesignField, ...]:
    """Every number of the design: four, all in mm."""
    low, high = design.stroke
    return (
        DesignField(("base_radius",), "base radius h₁", design.base_radius, "mm", "Triangles"),
        DesignField(
            ("platform_radius",), "platform radius h₂", design.platform_radius, "mm", "Triangles"
        ),
        DesignField(("stroke", 0), "ρ min", low, "mm", "Limbs"),
        DesignField(("stroke", 1), "ρ max", high, "mm", "Limbs"),
    )


def with_field(design: TripodDesign, path: Sequence[str | int], value: float) -> TripodDesign:
    """The design with one number (a `DesignField.path`) changed and everything checked again.

    Raises:
        InputError: the design has no such number.
        DesignError: the design would not be valid with it.
    """
    changed = change_table(design_to_table(design), design_fields(design), path, value)
    return design_from_table(changed, kind=design.mechanism, origin="", name=design.name)
