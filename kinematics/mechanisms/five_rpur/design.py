"""The design of a 5-RPUR: five limbs, each a base point, a platform point, a link and a stroke."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from kinematics.answers.modes import Mode, working_modes
from kinematics.arrays import Array, read_only
from kinematics.designs.files import TableError
from kinematics.designs.schema import Key, Schema, list_schema, ordered, point, positive
from kinematics.mechanism import DesignField

Point = tuple[float, float, float]
LIMBS = 5
SUBSCRIPTS = "₁₂₃₄₅"
JOINT_SYMBOLS = tuple(f"ρ{index}" for index in SUBSCRIPTS)
TOLERANCE = 1e-9
"""Lengths equal to this part of the design's size are equal."""
MODES = working_modes(LIMBS)
"""The 32 working modes, limb 5 changing fastest: "+++++", "++++-", … "-----"."""

Ties = tuple[tuple[int, ...], ...]
"""Limbs, from 1, that share a U joint each."""


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
    """Five limbs and where they come from. Frozen and hashable; the arrays are cached.

    Attributes:
        merged_joints: limbs, from 1, whose U joints are one: they stand in one working mode. Limbs
            that are not in it may stand in any, whatever arrangement they make.
    """

    limbs: tuple[Limb, Limb, Limb, Limb, Limb]
    name: str = ""
    title: str = ""
    source: str = ""
    merged_joints: Ties = ()

    mechanism = "five_rpur"

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """The working modes that exist, in the order of `MODES`: merged limbs have one sign."""
        return tuple(
            mode
            for mode in MODES
            if all(len({mode[i - 1] for i in limbs}) == 1 for limbs in self.merged_joints)
        )

    @cached_property
    def size(self) -> float:
        """mm: the largest of its lengths and coordinate differences."""
        spans = [np.ptp(points, axis=0).max() for points in (self.base, self.platform)]
        return float(max(*spans, self.link.max(), self.stroke.max()))

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

_MERGED = "merged_joints"
_SHARED = (("platform", 0), ("platform", 1), ("platform", 2), ("link",), ("base", 1))
"""What limbs of one U joint have in common: the platform point, the link, y of the base point."""


class _FiveRPURSchema(Schema[FiveRPURDesign]):
    """Besides the limbs, which of them share a U joint."""

    optional = (_MERGED,)

    def read(self, table: Mapping[str, Any], *, origin: str, name: str) -> FiveRPURDesign:
        design = super().read(table, origin=origin, name=name)
        for first, *others in design.merged_joints:
            for other in others:
                _check_merged(design, first, other, origin)
        return design

    def further(self, table: Mapping[str, Any], *, origin: str) -> dict[str, Any]:
        return {_MERGED: _merged_joints(table.get(_MERGED, []), origin)}

    def optional_schemas(self) -> dict[str, Any]:
        limb = {"type": "integer", "minimum": 1, "maximum": LIMBS}
        group = list_schema(limb, 2, LIMBS) | {"uniqueItems": True}
        return {_MERGED: {"type": "array", "items": group}}

    def table(self, design: FiveRPURDesign) -> dict[str, Any]:
        said = super().table(design)
        merged = [list(limbs) for limbs in design.merged_joints]
        return {**said, _MERGED: merged} if merged else said

    def fields(self, design: FiveRPURDesign) -> tuple[DesignField, ...]:
        """What merged limbs have in common is one number, wherever it is said."""
        return tuple(
            replace(field, also=_elsewhere(design, field.path)) for field in super().fields(design)
        )


def _elsewhere(design: FiveRPURDesign, path: tuple[str | int, ...]) -> tuple[Any, ...]:
    """Where the limbs that share a U joint with a number's limb have the same number."""
    _, limb, *place = path
    merged = next((limbs for limbs in design.merged_joints if int(limb) + 1 in limbs), ())
    shared = tuple(place) in _SHARED
    return tuple(("limb", i - 1, *place) for i in merged if shared and i - 1 != limb)


def _merged_joints(value: object, origin: str) -> Ties:
    """A list of lists of limb numbers."""
    groups = value if isinstance(value, list | tuple) else None
    sound = groups is not None and all(
        isinstance(limbs, list | tuple)
        and len(limbs) > 1
        and all(type(i) is int and 1 <= i <= LIMBS for i in limbs)
        for limbs in groups
    )
    if groups is None or not sound:
        raise TableError(
            origin,
            (_MERGED,),
            f"{_MERGED} must be a list of lists of two limbs or more; write the limbs' numbers, "
            f"1 to {LIMBS}, as {_MERGED} = [[1, 2], [3, 4]]",
        )
    named = [i for limbs in groups for i in limbs]
    twice = sorted(i for i in set(named) if named.count(i) > 1)
    if twice:
        raise TableError(
            origin,
            (_MERGED,),
            f"{_MERGED}: limb {twice[0]} is named twice; the limbs of a U joint stand in one list",
        )
    return tuple(tuple(sorted(limbs)) for limbs in groups)


def _check_merged(design: FiveRPURDesign, first: int, other: int, origin: str) -> None:
    """Limbs whose U joint is one have one platform point, equal links, base points of one y.

    Raises:
        DesignError: these two have not.
    """
    i, j = first - 1, other - 1
    platform = float(np.linalg.norm(design.platform[i] - design.platform[j]))
    link, base = design.link[i] - design.link[j], design.base[i, 1] - design.base[j, 1]
    misses = [
        text.format(abs(amount))
        for amount, text in (
            (platform, "platform points are {:.3g} mm apart"),
            (link, "links differ by {:.3g} mm"),
            (base, "base points differ by {:.3g} mm in y"),
        )
        if abs(amount) > TOLERANCE * design.size
    ]
    if misses:
        raise TableError(
            origin,
            (_MERGED,),
            f"{_MERGED}: limbs {first} and {other} cannot share a U joint: their "
            f"{' and their '.join(misses)}; merged limbs have one platform point, equal links and "
            "base points of one y",
        )


SCHEMA = _FiveRPURSchema(
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
