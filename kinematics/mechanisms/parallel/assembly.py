"""The machine of a design: its limbs at the closed reference posture, and how it moves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial

import numpy as np

from kinematics.arrays import Array, read_only
from kinematics.designs.files import TableError
from kinematics.errors import InputError
from kinematics.mechanisms.parallel import mobility as motions
from kinematics.mechanisms.parallel.bonds import COUNTS, Bonds
from kinematics.mechanisms.parallel.chains import chain
from kinematics.mechanisms.parallel.chart import Chart, linear
from kinematics.mechanisms.parallel.design import ParallelDesign
from kinematics.mechanisms.parallel.drives import Drives
from kinematics.mechanisms.parallel.limb_types import TYPES
from kinematics.mechanisms.parallel.limbs import Limb, short_form
from kinematics.mechanisms.parallel.mobility import Mobility
from kinematics.screws.spatial import homogeneous

_WORDS = {"translation": 3, "planar": 3, "spherical": 3}


@dataclass(frozen=True, eq=False)
class Assembly:
    """Everything that follows from a design before it moves.

    Attributes:
        limbs: at the reference.
        start: (4, 4) the reference pose as the file has it.
        reference: (4, 4) the same, closed.
        length: mm, the characteristic length.
        tables: of each limb, the number of its table.
    """

    design: ParallelDesign
    limbs: tuple[Limb, ...]
    drives: Drives
    bonds: Bonds
    start: Array
    reference: Array
    length: float
    tables: tuple[int, ...]

    @cached_property
    def mobility(self) -> Mobility:
        return motions.mobility(self.bonds, self.reference, self.length)

    @cached_property
    def chart(self) -> Chart:
        free, fixed = motions.chosen(self.mobility, partial(linear, self.bonds))
        if self.design.coordinates:
            free = tuple(motions.NAMES.index(key) for key in self.design.coordinates)
            fixed = tuple(n for n in fixed if n not in free)
        blank = Chart(self.bonds, free, fixed, np.zeros(6), self.length)
        return replace(blank, reference=blank.six(self.reference))

    @cached_property
    def branch(self) -> Array:
        """(L,) ±1 at the reference."""
        return read_only([limb.branch for limb in self.limbs])

    @property
    def drawn(self) -> bool:
        """Three coordinates of the pose are places in a solid, and what follows has closed form."""
        chart = self.chart
        return len(chart.free) >= 3 and (chart.closed_form or not chart.following)

    @property
    def by_limb(self) -> bool:
        """The bonds' own wrenches are as many as are needed; otherwise constant ones are."""
        return self.bonds.count == 6 - self.mobility.free


@lru_cache(maxsize=128)
def assembled(design: ParallelDesign) -> Assembly:
    """The machine of a design.

    Raises:
        InputError: it cannot be assembled; the message names the limb.
    """
    platform = design.platform
    start = homogeneous(platform.matrix(), platform.position)
    limbs: list[Limb] = []
    tables: list[int] = []
    for n, table, copy, place in design.each():
        try:
            found = (
                short_form(design, table, copy, place, start)
                if table.type
                else chain(table, copy, start)
            )
        except InputError as error:
            raise TableError("", ("limb", n), f"limb {len(limbs) + 1}: {error}") from None
        limbs.append(found)
        tables.append(n)
    length = _length(limbs, start)
    bonds = Bonds(tuple(limbs), start)
    reference = bonds.closed(start, length)
    if not np.isfinite(reference).all():
        off = float(np.abs(bonds.at(start).values).max())
        problem = (
            "platform: the limbs cannot be assembled near this pose, where their joints are off "
            f"by up to {off:.3g}; move or turn the reference pose"
        )
        raise TableError("", ("platform",), problem)
    drives = Drives(tuple(limbs))
    limbs = [_at_reference(n, limb, drives, reference, design) for n, limb in enumerate(limbs)]
    for n, limb in enumerate(limbs):
        _reaches(n, limb, drives, reference, tables[n])
    return Assembly(
        design, tuple(limbs), Drives(tuple(limbs)), bonds, start, reference, length, tuple(tables)
    )


def check(design: ParallelDesign, origin: str) -> None:
    """Whether it is a mechanism that can be moved: assembled, with an actuator for each freedom.

    Raises:
        TableError: why not.
    """
    try:
        machine = assembled(design)
    except TableError as error:
        raise TableError(origin, error.path, error.problem) from None
    found, actuators = machine.mobility, len(machine.limbs)
    if found.free != actuators:
        raise TableError(origin, ("limb",), wrong_mobility(machine))
    wanted = design.coordinates
    if wanted:
        chosen = tuple(motions.NAMES.index(key) for key in wanted)
        by = motions.rates(found)[:, chosen]
        if len(wanted) != found.free or np.linalg.svd(by, compute_uv=False)[:, -1].min() < 1e-6:
            names = ", ".join(motions.NAMES[n] for n in motions.chosen(found)[0])
            problem = f"coordinates do not tell how this platform moves; {names} do"
            raise TableError(origin, ("coordinates",), problem)
    if not machine.by_limb and found.group not in ("translation", "planar"):
        problem = (
            f"the limbs take {machine.bonds.count} freedoms from the platform, of which "
            f"{6 - found.free} are different; such overconstrained machines are known only where "
            "the platform translates, moves in a plane or about a point"
        )
        raise TableError(origin, ("limb",), problem)


def wrong_mobility(machine: Assembly) -> str:
    """What the mobility is instead, and why."""
    found, actuators = machine.mobility, len(machine.limbs)
    taken = []
    for one in machine.bonds.each:
        who = [n + 1 for n in one.limbs]
        limbs = f"limb {who[0]}" if len(who) == 1 else f"limbs {_listed(who)} together"
        verb = "takes" if len(who) == 1 else "take"
        taken.append(f"{limbs} {verb} {one.limb.kind.taken}")
    why = "; ".join(taken) or "no limb takes anything from the platform"
    different = 6 - found.free
    total = sum(COUNTS[one.limb.bond] for one in machine.bonds.each)
    count = f"of these {total} wrenches {different} are independent" if total else ""
    text = (
        f"the mobility is {found.free} ({found.words}), but {actuators} joints are actuated: "
        f"{'; '.join(filter(None, (why, count)))}"
    )
    if found.instantaneous != found.free:
        text += f"; at the reference pose alone it is {found.instantaneous}"
    remedy = "leave out limbs" if actuators > found.free else "add limbs"
    if found.free < actuators and total:
        remedy = "correct the axes of the limbs, or leave out limbs"
    return f"{text}; {remedy}"


def _listed(numbers: list[int]) -> str:
    words = [str(n) for n in numbers]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _length(limbs: list[Limb], start: Array) -> float:
    """The median distance of the limbs' ends from O′; 100 mm where they are all there."""
    ends = [limb.a - start[:3, 3] for limb in limbs]
    ends += [limb.b for limb in limbs if limb.drive != "direction"]
    away = np.linalg.norm(np.array(ends), axis=1)
    found = float(np.median(away))
    largest = float(away.max())
    return found if found > 1e-6 * largest else largest if largest > 0.0 else 100.0


def _at_reference(
    n: int, limb: Limb, drives: Drives, reference: Array, design: ParallelDesign
) -> Limb:
    """The limb with the branch that its chain is in."""
    if limb.kind.name in TYPES and _is_short(design, n):
        return limb
    shown = np.full(len(drives.limbs), 0.0)
    best = (np.inf, 1)
    for sign in (1, -1):
        joints = drives.joints(reference, np.full(len(shown), float(sign)))
        wanted = _value_of(design, n)
        off = abs(joints[n] - wanted)
        off = abs((off + np.pi) % (2.0 * np.pi) - np.pi) if limb.turns else off
        if off < best[0] - 1e-9:
            best = (float(off), sign)
    return replace(limb, branch=best[1])


def _is_short(design: ParallelDesign, n: int) -> bool:
    return bool([table for _, table, _, _ in design.each()][n].type)


def _value_of(design: ParallelDesign, n: int) -> float:
    """The value of the actuated joint of a chain at the reference."""
    table = [table for _, table, _, _ in design.each()][n]
    for joint in table.joints:
        entries = dict(joint)
        if entries.get("actuated"):
            value = entries.get("value", 0.0)
            assert isinstance(value, float | int)
            return float(np.radians(value)) if entries["joint"] == "R" else float(value)
    return 0.0


def _reaches(n: int, limb: Limb, drives: Drives, reference: Array, table: int) -> None:
    room = float(drives.room(reference)[n])
    if room >= -1e-9 * max(limb.rod, 1.0) or np.isnan(room):
        return
    unit = "" if limb.drive == "direction" else " mm"
    problem = (
        f"limb {n + 1} ({limb.kind.name}) cannot reach the reference pose: it is short of "
        f"{-room:.4g}{unit}; move the platform's position or change the limb's lengths"
    )
    raise TableError("", ("limb", table), problem)
