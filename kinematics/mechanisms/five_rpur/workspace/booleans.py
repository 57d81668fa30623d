"""Limbs' solids moved and intersected, with as few Booleans as what was found before allows.

What a Boolean costs goes with what it makes, not with what it is given. While one angle turns
alone, limbs whose platform points (φ) or base points (θ) are beside each other along its axis keep
their distance (eq. 27): what they share is kept, and only moved. Lengths mm.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import product

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.workspace.vertex_space import Part, limb_solid
from kinematics.solids.csg import Solid
from kinematics.solids.meshes import fine_step

_CHOICE: dict[str, Part] = {"+": "plus", "-": "minus", "*": "whole"}
Riders = tuple[int, ...]
"""Limbs with the same number keep their distance while one of both angles turns alone."""


@dataclass(frozen=True, slots=True)
class _Operand:
    """One limb's solid where it stands: all that the intersection depends on.

    ``rides``: see `Riders`.
    """

    link: float
    rho_min: float
    rho_max: float
    part: Part
    offset: tuple[float, float, float]
    rides: int = field(compare=False)


def riders(design: FiveRPURDesign) -> Riders:
    """Limbs that keep their distance while φ turns alone; of the others those that do while θ does.

    w'_i − w'_j is without φ where y and z of s'_i and s'_j are the same, and without θ where x and
    z of r_i and r_j are.
    """
    platform = [(float(y), float(z)) for _, y, z in design.platform]
    base = [(float(x), float(z)) for x, _, z in design.base]
    keys = [
        ("φ", one) if platform.count(one) > 1 else ("θ", other)
        for one, other in zip(platform, base, strict=True)
    ]
    return tuple(keys.index(key) for key in keys)


def united(stands: Array, together: Riders, choices: list[str], resolution: Resolution) -> Solid:
    """The union over some choices of signs of the intersections of the limbs' solids.

    Args:
        stands: (5, 6) w'_i, link and stroke, mm.
        choices: see `products`.
    """
    offsets = stands[:, :3]
    step = fine_step(float((stands[:, 3] + stands[:, 5]).max()))
    # Sums of such numbers are exact: solids stand where they do however they were moved there.
    offsets = np.round(offsets / step) * step + 0.0
    solids = []
    for choice in choices:
        operands = [
            _Operand(link, low, high, _CHOICE[sign], (x, y, z), rides)
            for (x, y, z), (link, low, high), sign, rides in zip(
                offsets.tolist(), stands[:, 3:].tolist(), choice, together, strict=True
            )
        ]
        solids.append(_intersection(operands, resolution))
    return solids[0] if len(solids) == 1 else Solid.union(solids)


def _intersection(operands: list[_Operand], resolution: Resolution) -> Solid:
    unique = dict.fromkeys(operands)
    # B ∩ B^σ = B^σ: where one limb stands in another, the whole adds nothing to the half.
    for one in list(unique):
        if one.part != "whole":
            unique.pop(replace(one, part="whole"), None)
    groups: dict[int, list[_Operand]] = {}
    for n, one in enumerate(unique):
        # Halves share so little with far ones that to begin with these takes less on the whole.
        own = one.rides if one.part == "whole" else LIMBS + n
        groups.setdefault(own, []).append(one)
    # Previews alone are many, and small enough to be kept.
    shared = _kept if resolution == "preview" else _shared
    result: Solid | None = None
    for group in _far_first(list(groups.values())):
        first = np.array(group[0].offset)
        members = tuple(
            replace(one, offset=tuple((np.array(one.offset) - first).tolist())) for one in group
        )
        solid = shared(members, resolution).translated(first)
        result = solid if result is None else Solid.intersection((result, solid))
        if result.is_empty:
            break
    return Solid.union(()) if result is None else result


def _shared(members: tuple[_Operand, ...], resolution: Resolution) -> Solid:
    """What limbs' solids share."""
    solids = [
        limb_solid(one.link, one.rho_min, one.rho_max, one.part, resolution) for one in members
    ]
    result = solids[0]
    for one, solid in zip(members[1:], solids[1:], strict=True):
        result = Solid.intersection((result, solid.translated(one.offset)))
    return result


# Distances that do not change do so by the last digit: some twins of each are kept.
_kept = lru_cache(maxsize=24)(_shared)


def _far_first(groups: list[list[_Operand]]) -> list[list[_Operand]]:
    """The largest group, then those far from it: what they share is small, as are all later
    steps.
    """
    points = [np.array([one.offset for one in group]) for group in groups]

    def apart(n: int, others: Iterable[int]) -> float:
        there = np.concatenate([points[k] for k in others])
        return float(np.linalg.norm(points[n][:, None] - there, axis=-1).min())

    rest = list(range(len(groups)))
    order = [max(rest, key=lambda n: (len(groups[n]), max(apart(n, [k]) for k in rest)))]
    while len(order) < len(groups):
        rest.remove(order[-1])
        order.append(max(rest, key=lambda n: apart(n, order)))
    return [groups[n] for n in order]


def products(modes: Iterable[str] | None) -> list[str]:
    """A set of modes as few products of choices a limb: "+", "-" or, for either, "*".

    The union over the modes is the union over these, each one intersection.
    """
    if modes is None:
        return ["*" * LIMBS]
    wanted = frozenset(modes)
    # The largest products first; each must bring a mode that is still missing.
    answer, missing = [], set(wanted)
    for choice in sorted(product("*+-", repeat=LIMBS), key=lambda c: -c.count("*")):
        if not missing:
            break
        members = {"".join(m) for m in product(*("+-" if c == "*" else c for c in choice))}
        if members <= wanted and members & missing:
            answer.append("".join(choice))
            missing -= members
    return answer
