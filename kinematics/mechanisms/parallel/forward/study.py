"""Machines whose limbs hold points on spheres and in planes: Study's coordinates.

Paths begin from all solutions of one random complex machine with the same limbs, a stored file (see
`monodromy`). A design's own start set is all solutions for its geometry with complex lengths, and
complex centres of the spheres that its actuators move; from there only these move.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cache, lru_cache, partial

import numpy as np

from kinematics.arrays import Array
from kinematics.designs.assets import asset_folder
from kinematics.homotopy.assembly_sets import NEAR, accounted
from kinematics.homotopy.forms import normal_form
from kinematics.homotopy.solving import Roots, StartSet
from kinematics.homotopy.start_sets import OwnStartSets, made, stored
from kinematics.homotopy.study import Limbs, Plane, StudyEquations, real_poses
from kinematics.homotopy.tracking import Control, Index
from kinematics.mechanisms.parallel.assembly import Assembly, assembled
from kinematics.mechanisms.parallel.design import ParallelDesign
from kinematics.mechanisms.parallel.forward.found import Assembled
from kinematics.screws.spatial import homogeneous

PLANES: dict[str, Plane] = {"free": "", "base plane": "base", "platform plane": "platform"}
SPHERES = ("leg", "crank", "slider")
Signature = tuple[int, int, int]
"""How many limbs have a sphere alone, a plane of the base besides, and one of the platform."""
_QUICK = Control(first=0.1)
_REAL = 1e-7  # largest imaginary part of a real solution, relative to its size
_DOUBLE_REAL = 1e-4
_CURVES_FAR = 1e2  # units, of singular solutions that are looked at


def signature(machine: Assembly) -> Signature | None:
    """That of a machine; None where some limb is of another kind."""
    if any(one.bond not in PLANES or one.drive not in SPHERES for one in machine.limbs):
        return None
    kinds = [PLANES[limb.bond] for limb in machine.limbs]
    found = kinds.count(""), kinds.count("base"), kinds.count("platform")
    return found if found[0] + 2 * (found[1] + found[2]) == 6 else None


def file_name(of: Signature) -> str:
    """Of the stored start set."""
    return "parallel-{}{}{}.npz".format(*of)


@lru_cache(maxsize=16)
def equations(of: Signature) -> StudyEquations:
    """Limbs with spheres alone first, then those with planes of the base, then of the platform."""
    planes: list[Plane] = ["", "base", "platform"]
    return StudyEquations([p for p, count in zip(planes, of, strict=True) for _ in range(count)])


@cache
def general_set(of: Signature) -> StartSet[Limbs]:
    """The stored set."""
    file = stored(asset_folder("start_solutions") / file_name(of))
    roots = np.ascontiguousarray(file.pop("roots"), dtype=complex)
    return StartSet(Limbs(**file), roots)


def has_set(of: Signature) -> bool:
    """Whether there is one."""
    return (asset_folder("start_solutions") / file_name(of)).exists()


@lru_cache(maxsize=16)
def _own(of: Signature) -> OwnStartSets[Limbs]:
    return OwnStartSets(equations(of), 16, _QUICK)


@dataclass(frozen=True, eq=False)
class Frame:
    """Where the equations' origins and unit stand, mm, and the order of the limbs."""

    base: Array
    platform: Array
    unit: float
    order: Index

    @classmethod
    def of(cls, machine: Assembly) -> Frame:
        drives = machine.drives
        planes = [PLANES[limb.bond] for limb in machine.limbs]
        order = np.argsort([("", "base", "platform").index(p) for p in planes], kind="stable")
        e, length = drives.locked(drives.joints(machine.reference, machine.branch))
        base, platform = e.mean(axis=0), drives.b.mean(axis=0)
        unit = max(
            float(np.abs(e - base).max()),
            float(np.abs(drives.b - platform).max()),
            0.25 * float(length.max()),
        )
        return cls(base, platform, unit, order)

    def limbs(self, machine: Assembly, joints: Array) -> Limbs:
        """At joints (..., L)."""
        e, length = machine.drives.locked(joints)
        axis = np.where(
            np.array([limb.bond == "platform plane" for limb in machine.limbs])[:, None],
            machine.drives.m,
            machine.drives.n,
        )
        o = self.order
        return Limbs(
            (e[..., o, :] - self.base) / self.unit,
            (machine.drives.b[o] - self.platform) / self.unit,
            axis[o],
            (length[..., o] / self.unit) ** 2,
        )


def solve(machine: Assembly, of: Signature, joints: Array) -> list[Assembled]:
    """For joints (B, L)."""
    frame = Frame.of(machine)
    target = frame.limbs(machine, joints)
    still = all(limb.drive == "leg" for limb in machine.limbs)

    def at(own: Limbs) -> Limbs:
        base = own.base if still else target.base
        return own._replace(base=base, squares=np.asarray(target.squares, dtype=complex))

    general = general_set(of)
    most = general.roots.shape[1]
    key: Hashable = (machine.design.platform, machine.design.limbs)
    make = partial(_make_own, machine.design, of)
    found = _own(of).solve(key, make, at, len(joints), most)
    own = _own(of).get(key, make)
    return [_one(machine, of, frame, roots, own, most) for roots in found]


def _make_own(design: ParallelDesign, of: Signature) -> StartSet[Limbs]:
    """Follow the general set to the design's geometry."""
    machine = assembled(design)
    frame = Frame.of(machine)
    now = machine.drives.joints(machine.reference, machine.branch)
    target = frame.limbs(machine, now)
    rng = np.random.default_rng(40)
    base = np.asarray(target.base, dtype=complex)
    moving = np.array([limb.drive != "leg" for limb in machine.limbs])[frame.order]
    away = rng.normal(size=base.shape) + 1j * rng.normal(size=base.shape)
    axis = np.asarray(target.axis)
    # Centres stay in the planes of their limbs.
    flat = np.array([bool(PLANES[limb.bond] == "base") for limb in machine.limbs])[frame.order]
    inside = away - (away * axis).sum(axis=-1, keepdims=True) * axis
    away = np.where(flat[:, None], inside, away)
    base = base + np.where(moving[:, None], 0.5 * away, 0.0)
    turns = np.exp(1j * np.array([0.9, -1.3, 0.5, 1.7, -0.7, 2.2]))[: len(base)]
    size = 1.0 + float(np.mean((np.asarray(target.base).real ** 2).sum(axis=-1)))
    squares = size * np.array([1.1, 0.8, 1.3, 0.9, 1.0, 1.2])[: len(base)] * turns
    goal = target._replace(base=base, squares=squares)
    return made(equations(of), general_set(of), goal, _QUICK)


def _one(
    machine: Assembly,
    of: Signature,
    frame: Frame,
    roots: Roots,
    own: StartSet[Limbs],
    most: int,
) -> Assembled:
    form = normal_form(roots.values)
    away = np.abs(form.imag).max(axis=0, initial=0.0) / np.maximum(
        np.abs(form).max(axis=0, initial=0.0), 1.0
    )
    limit = np.where(roots.multiplicity > 1, _DOUBLE_REAL, _REAL)
    limit[roots.regular :] = _DOUBLE_REAL
    real = np.flatnonzero(away <= limit)
    count = own.roots.shape[1]
    apart = np.hypot(
        4.0 * frame.unit * np.sqrt((form[4:].imag ** 2).sum(axis=0)),
        4.0 * machine.length * np.sqrt((form[:4].imag ** 2).sum(axis=0)),
    )
    singular = np.arange(form.shape[1]) >= roots.regular
    singular &= np.abs(form).max(axis=0, initial=0.0) < _CURVES_FAR
    title = "the general machine of these limb types"
    notes = accounted(roots, title, most, most - count if own.complete else 0)
    return Assembled(
        _placements(of, frame, roots.values[:, real]),
        roots.multiplicity[real],
        form,
        roots.count,
        count,
        roots.complete and own.complete,
        f"{roots.expected} paths tracked from the design's own start set in Study's coordinates",
        notes,
        int(np.count_nonzero((apart < NEAR) & (away > limit))) // 2,
        _placements(of, frame, roots.values[:, singular]),
    )


def _placements(of: Signature, frame: Frame, u: np.ndarray) -> Array:
    """(N, 4, 4) mm."""
    r, p = real_poses(u)
    return homogeneous(r, frame.base + frame.unit * p - r @ frame.platform)
