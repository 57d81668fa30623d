"""Families of 5-RPUR machines with fewer solutions than the general one, and their start sets.

The forward kinematics of the general 5-RPUR has 1680 complex solutions. Where a machine is
special, some of them are at infinity: 120 for every two platform points that are aligned with e2,
and as many for every two base points that are aligned with e1. Equal links and base points in a
plane normal to e1 cost more, where they make a simplified arrangement of such a pair. A start set
is all solutions of one random complex machine of a family; whoever solves a machine follows them
to it (`forward.general`).

The sets are files that the program reads, made by `forward.monodromy`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import permutations
from typing import Literal

import numpy as np

from kinematics.arrays import Array
from kinematics.designs.assets import asset_folder
from kinematics.designs.files import load_design
from kinematics.homotopy import solving
from kinematics.homotopy.start_sets import stored
from kinematics.mechanisms.five_rpur.design import LIMBS, TOLERANCE, FiveRPURDesign
from kinematics.mechanisms.five_rpur.forward.equations import Parameters

Kind = Literal["S", "R", "A1", "A2", "A3"]
Relation = tuple[Kind, int, int]


@dataclass(frozen=True, slots=True)
class Family:
    """Machines whose limbs satisfy some relations; limbs count from 0.

    "S" aligns two platform points with e2, "R" two base points with e1; A1, A2 and A3 are the
    simplified arrangements (Tale Masouleh et al., Meccanica 46 (2011), section 3).
    """

    name: str
    title: str
    relations: tuple[Relation, ...]
    count: int


FAMILIES: tuple[Family, ...] = (
    Family("general", "the general 5-RPUR", (), 1680),
    Family("s", "one pair of platform points aligned with e₂", (("S", 0, 1),), 1560),
    Family("r", "one pair of base points aligned with e₁", (("R", 0, 1),), 1560),
    Family("s-r", "a pair of platform and a pair of base points", (("S", 0, 1), ("R", 2, 3)), 1480),
    Family("s-s", "two pairs of platform points", (("S", 0, 1), ("S", 2, 3)), 1440),
    Family("a1", "one A1 arrangement", (("A1", 0, 1),), 1368),
    Family("a2", "one A2 arrangement", (("A2", 0, 1),), 1344),
    Family("a1-s", "A1 and a pair of platform points", (("A1", 0, 1), ("S", 2, 3)), 1280),
    Family("s3", "three platform points aligned with e₂", (("S", 0, 1), ("S", 0, 2)), 1272),
    Family("a2-s", "A2 and a pair of platform points", (("A2", 0, 1), ("S", 2, 3)), 1264),
    Family("a1-a1", "{A1A1}", (("A1", 0, 1), ("A1", 2, 3)), 1120),
    Family("mp-a1", "{MpA1}", (("A1", 0, 1), ("A3", 0, 2)), 1112),
    Family("a1-a2", "{A1A2}", (("A1", 0, 1), ("A2", 2, 3)), 1104),
    Family("a2-a2", "{A2A2}", (("A2", 0, 1), ("A2", 2, 3)), 1088),
    Family("mp-a2", "{MpA2}", (("A2", 0, 1), ("A3", 0, 2)), 1072),
)
"""From the most general to the one with the fewest solutions."""

MACHINES = ("rpur-table1", "rpur-table1-icee", "rpur-table2")
"""Presets whose own start sets are stored: the papers' machines."""


StartSet = solving.StartSet[Parameters]


@dataclass(frozen=True, slots=True)
class Membership:
    """The family of a design, and which of its limbs stands for each of the family's."""

    family: Family
    limbs: tuple[int, ...]


_SHARED: dict[Kind, tuple[str, ...]] = {
    "S": ("sy", "sz"),
    "R": ("rx", "rz"),
    "A1": ("sx", "sy", "sz", "ry", "link2"),
    "A2": ("sy", "sz", "rx", "ry", "rz", "link2"),
    "A3": ("sy", "sz", "ry", "link2"),
}
"""The parameters that are the same for both limbs of a relation."""


def membership(design: FiveRPURDesign) -> Membership:
    """The family with the fewest solutions that a design belongs to."""
    holds = _relations(design)
    for family in reversed(FAMILIES):
        for limbs in permutations(range(LIMBS)):
            if all(holds[kind][limbs[i], limbs[j]] for kind, i, j in family.relations):
                return Membership(family, limbs)
    raise AssertionError("every design belongs to the general family")


def _relations(design: FiveRPURDesign) -> dict[Kind, np.ndarray]:
    equal = TOLERANCE * design.size

    def same(values: Array) -> np.ndarray:
        return np.asarray(np.abs(values[:, None] - values) <= equal)

    rx, ry, rz = (same(v) for v in design.base.T)
    sx, sy, sz = (same(v) for v in design.platform.T)
    s, r = sy & sz, rx & rz
    pair = s & ry & same(design.link)
    return {"S": s, "R": r, "A1": pair & sx, "A2": pair & r, "A3": pair}


def exact(g: Parameters, member: Membership) -> Parameters:
    """A machine of a family, whose relations hold but for rounding, with relations that hold."""
    values = {name: np.array(v) for name, v in g._asdict().items()}
    for kind, first, second in member.family.relations:
        i, j = member.limbs[first], member.limbs[second]
        for name in _SHARED[kind]:
            values[name][j] = values[name][i]
    return Parameters(**values)


def start_set(member: Membership) -> StartSet:
    """The start set of a design's family, its limbs in the design's order."""
    found = _stored(member.family.name)
    places = np.argsort(member.limbs)
    roots = found.roots.copy()
    roots[5:] = found.roots[5:][places]
    return StartSet(Parameters(*(v[places] for v in found.parameters)), roots)


def kept_set(design: FiveRPURDesign) -> StartSet | None:
    """The stored start set of this very machine, as the papers' own have one; else None."""
    name = next((n for n in MACHINES if np.array_equal(_geometry_of(n), _geometry(design))), None)
    return None if name is None else _stored(name)


def _geometry(design: FiveRPURDesign) -> Array:
    return np.vstack([design.base.T, design.platform.T, design.link])


@cache
def _geometry_of(preset: str) -> Array:
    design = load_design(preset)
    assert isinstance(design, FiveRPURDesign)
    return _geometry(design)


@cache
def _stored(name: str) -> StartSet:
    file = stored(asset_folder("start_solutions") / f"five_rpur-{name}.npz")
    machine = Parameters(*(v[:, None] for v in file["parameters"]))
    return StartSet(machine, np.ascontiguousarray(file["roots"], dtype=complex))
