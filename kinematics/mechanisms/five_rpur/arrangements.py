"""Simplified arrangements A1, A2, A3 and Mp in a 5-RPUR design, and what follows from them.

Two limbs make a simplified arrangement when (Tale Masouleh et al., Meccanica 46 (2011), section
3, conditions 1-3) their base points lie in one plane normal to e1 or coincide, their second links
are equally long, and their platform points are aligned with e2 or coincide. In the same working
mode v_i ∥ v_j then, and B_i B_j is aligned with e2 (eqs. 7, 8). By what coincides:

    A1  the platform points (and so the U joints, which may be one)
    A2  the base points
    A3  neither

Mp is a third limb that satisfies the conditions with such a pair. That relation is an
equivalence, so a design falls into groups. Wrenches of a group lie in one plane, spanned by e2
and v: three limbs exhaust it, hence {Mp Ai Aj}, and any four limbs in a group, are
architecturally singular in the working modes that move each group alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import Literal

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.design import LIMBS, TOLERANCE, FiveRPURDesign

PairKind = Literal["A1", "A2", "A3", "same"]


@dataclass(frozen=True, slots=True)
class Pair:
    """Two limbs (from 1) in a simplified arrangement; "same" if they coincide altogether."""

    limbs: tuple[int, int]
    kind: PairKind


@dataclass(frozen=True, slots=True)
class Group:
    """Limbs that satisfy the paper's conditions with each other: two or more, from 1.

    Attributes:
        limbs: in rising order.
        pairs: all pairs of them.
        kind: the arrangement that the group is called by: that of its most special pair, A1
            before A2 before A3; "same" only if nothing else is in it.
    """

    limbs: tuple[int, ...]
    pairs: tuple[Pair, ...]
    kind: PairKind

    @property
    def middle(self) -> bool:
        """There is a third limb, Mp."""
        return len(self.limbs) > 2


@dataclass(frozen=True, slots=True)
class Arrangements:
    """What was found in a design.

    Attributes:
        groups: largest first, then by the first limb.
        name: the class, as "{A1A2}", "{MpA2}", "{A3}" or "" for a general design; "" too where
            the design is beyond the paper's classes (see ``reasons``).
        reasons: why the design is architecturally singular by its form, one sentence each.
    """

    groups: tuple[Group, ...]
    name: str
    reasons: tuple[str, ...]

    @property
    def architecturally_singular(self) -> bool:
        """Singular at every pose, at least in the modes that move each group alike."""
        return bool(self.reasons)


@dataclass(frozen=True, slots=True)
class SimplifiedClass:
    """Same-mode forward kinematics of a simplified class: how many θ, how many solutions."""

    angles: int
    solutions: int
    closed_form: bool


# Counts of θ and of all complex solutions in which each group stands in one mode. For {A1A2} the
# paper states 48 (section 3.2): the two solutions for B1 and B2 are counted once there.
CLASSES = {
    "{A1A1}": SimplifiedClass(8, 96, True),
    "{A1A2}": SimplifiedClass(8, 96, True),
    "{A1A3}": SimplifiedClass(12, 144, False),
    "{A2A2}": SimplifiedClass(8, 96, False),
    "{A2A3}": SimplifiedClass(12, 144, False),
    "{A3A3}": SimplifiedClass(16, 192, False),
    "{MpA1}": SimplifiedClass(4, 96, True),
    "{MpA2}": SimplifiedClass(4, 96, True),
    "{MpA3}": SimplifiedClass(6, 144, False),
}


@lru_cache(maxsize=64)
def arrangements(design: FiveRPURDesign) -> Arrangements:
    """The simplified arrangements of a design, compared to `TOLERANCE` × its size."""
    equal = TOLERANCE * design.size
    groups: list[list[int]] = []
    for i in range(LIMBS):
        for group in groups:
            if conditions(design, group[0], i).max() <= equal:
                group.append(i)
                break
        else:
            groups.append([i])
    found = [_group(design, group, equal) for group in groups if len(group) > 1]
    found.sort(key=lambda group: (-len(group.limbs), group.limbs))
    return Arrangements(
        groups=tuple(found),
        name=_name(found),
        reasons=tuple(_singular_by_form(design, found, equal)),
    )


# --- recognising ---------------------------------------------------------------------------


def conditions(design: FiveRPURDesign, i: int, j: int) -> Array:
    """By how much two limbs miss conditions 1, 2 and 3, mm."""
    base = design.base[i] - design.base[j]
    platform = design.platform[i] - design.platform[j]
    link = design.link[i] - design.link[j]
    return np.abs([base[1], link, np.hypot(platform[1], platform[2])])


def _group(design: FiveRPURDesign, members: Sequence[int], equal: float) -> Group:
    pairs = tuple(
        Pair((i + 1, j + 1), _pair_kind(design, i, j, equal)) for i, j in combinations(members, 2)
    )
    kinds = {pair.kind for pair in pairs}
    order: tuple[PairKind, ...] = ("A1", "A2", "A3", "same")
    kind = next(kind for kind in order if kind in kinds)
    return Group(tuple(i + 1 for i in members), pairs, kind)


def _pair_kind(design: FiveRPURDesign, i: int, j: int, equal: float) -> PairKind:
    base = bool(np.abs(design.base[i] - design.base[j]).max() <= equal)
    platform = bool(np.abs(design.platform[i] - design.platform[j]).max() <= equal)
    if base and platform:
        return "same"
    return "A1" if platform else "A2" if base else "A3"


def _name(groups: Sequence[Group]) -> str:
    if any(len(group.limbs) > 3 for group in groups):
        return ""
    if any(pair.kind == "same" for group in groups for pair in group.pairs):
        return ""
    middle = "Mp" if any(group.middle for group in groups) else ""
    kinds = sorted(str(group.kind) for group in groups)
    return f"{{{middle}{''.join(kinds)}}}" if kinds else ""


def _singular_by_form(design: FiveRPURDesign, groups: Sequence[Group], equal: float) -> list[str]:
    reasons = []
    for group in groups:
        limbs = listed(group.limbs)
        members = [i - 1 for i in group.limbs]
        if len(members) > 3:
            reasons.append(
                f"Limbs {limbs} all satisfy the conditions of a simplified arrangement with each "
                f"other: their forces lie in one plane, where only three are independent. {_ALIKE}"
            )
            continue
        if group.middle and _coincide(design.platform[members], equal):
            reasons.append(
                f"Limbs {limbs} share one platform point and their base points lie in one plane "
                f"normal to e₁: their forces meet in one point and lie in one plane. {_ALIKE}"
            )
        elif group.middle and _coincide(design.base[members], equal):
            reasons.append(
                f"Limbs {limbs} share one base point and their platform points are aligned with "
                f"e₂: their forces meet in one point and lie in one plane. {_ALIKE}"
            )
        else:
            reasons += [
                f"Limbs {listed(pair.limbs)} coincide: same base point, same platform point, "
                f"same link; one of them is redundant. {_ALIKE}"
                for pair in group.pairs
                if pair.kind == "same"
            ]
    if len(groups) == 2 and groups[0].middle:
        three, two = (listed(group.limbs) for group in groups)
        reasons.append(
            f"Limbs {three} form an Mp set and limbs {two} a further arrangement, "
            f"{_set_name(groups)}: together they and the constraint give only five independent "
            f"wrenches. {_ALIKE}"
        )
    if _coincide(design.platform[:, 1:], equal):
        reasons.append(
            "All platform points lie on one line along e₂: no limb can resist a turn of the "
            "platform about it, in any working mode."
        )
    if _coincide(design.base[:, [0, 2]], equal):
        reasons.append(
            "All base points lie on one line along e₁: no limb can resist a turn of the whole "
            "machine about it, in any working mode."
        )
    return reasons


_ALIKE = "With these limbs in the same working mode, the platform cannot be held at any pose."


def _set_name(groups: Sequence[Group]) -> str:
    return f"{{Mp {' '.join(str(group.kind) for group in groups)}}}"


def _coincide(points: Array, equal: float) -> bool:
    return bool(np.ptp(points, axis=0).max() <= equal)


def listed(limbs: Sequence[int]) -> str:
    """Limbs in words, as "1, 2 and 3"."""
    *most, last = (str(i) for i in limbs)
    return f"{', '.join(most)} and {last}" if most else last
