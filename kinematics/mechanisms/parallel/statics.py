"""The wrenches of a parallel mechanism: what its actuators exert, and what holds the rest.

Rows are [F, T about O′]: a unit force along the rod of each limb, or a couple where an actuator
turns a direction. After them the bonds' own wrenches where they are just as many as are needed;
where limbs say the same several times, constant ones that say it once.
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.bounds import SUBSCRIPTS
from kinematics.answers.motion import Wrenches, WrenchName
from kinematics.arrays import Array
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.drives import Numbers

_LETTERS = {
    "normal axes": ("M",),
    "universal": ("M",),
    "parallelogram": ("M", "M′"),
    "planar": ("C", "M", "M′"),
    "point": ("C", "C′", "C″"),
}
"""Forces and couples of bonds that are not one force."""


def names(machine: Assembly) -> tuple[WrenchName, ...]:
    """Of all six, actuators first."""
    found = [
        WrenchName("actuation", n + 1, f"{'τ' if limb.turns else 'F'}{SUBSCRIPTS[n]}")
        for n, limb in enumerate(machine.limbs)
    ]
    if not machine.by_limb:
        flat = machine.mobility.group == "planar"
        symbols = ("C", "M", "M′") if flat else ("M", "M′", "M″")
        return (*found, *(WrenchName("constraint", None, symbol) for symbol in symbols))
    for one in machine.bonds.each:
        limb = one.limbs[0] + 1 if len(one.limbs) == 1 else None
        mark = SUBSCRIPTS[one.limbs[0]] if limb else ""
        letters = _LETTERS.get(one.limb.bond, ("C",))
        found += [WrenchName("constraint", limb, f"{letter}{mark}") for letter in letters]
    return tuple(found)


def wrenches(machine: Assembly, placement: Numbers, signs: Array) -> Wrenches:
    """All six at placements (..., 4, 4) in branches (..., L), see `Mechanism.wrenches`."""
    push = machine.drives.pushes(placement, signs)
    acting = np.concatenate([push.force, push.couple], axis=-1)
    shape = acting.shape[:-2]
    origin = placement[..., None, :3, 3]
    if machine.by_limb:
        held = machine.bonds.at(placement)
        rest = np.concatenate([held.force, held.couple], axis=-1)
        point = held.point
    else:
        rest = np.broadcast_to(_constant(machine), (*shape, 6 - machine.mobility.free, 6))
        point = np.broadcast_to(origin, (*shape, rest.shape[-2], 3))
    rest = np.broadcast_to(rest, (*shape, *rest.shape[-2:]))
    point = np.broadcast_to(point, (*shape, *point.shape[-2:]))
    rows = np.concatenate([acting, rest], axis=-2)
    return Wrenches(rows, push.gain, np.concatenate([push.point, point], axis=-2))


def _constant(machine: Assembly) -> Array:
    """(6 − d, 6) of a machine that only translates, or moves in a plane."""
    rows = np.zeros((6 - machine.mobility.free, 6))
    if machine.mobility.group == "translation":
        rows[:, 3:] = np.eye(3)
        return rows
    normal = next(limb.normal for limb in machine.limbs if limb.bond == "planar")
    rows[0, :3] = normal
    rows[1:, 3:] = np.linalg.svd(normal[None])[2][1:]
    return rows
