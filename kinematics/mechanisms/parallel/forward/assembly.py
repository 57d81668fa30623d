"""Forward kinematics of a parallel mechanism: the real solutions, in modes of the machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, SelfMotion
from kinematics.arrays import Array
from kinematics.facets.forward import ForwardFacet, Found
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.bonds import moved
from kinematics.mechanisms.parallel.closing import loops, newton
from kinematics.mechanisms.parallel.design import ParallelDesign
from kinematics.mechanisms.parallel.forward import planar, rotations, searching, study, translation
from kinematics.mechanisms.parallel.forward.found import Assembled
from kinematics.mechanisms.parallel.mechanism import Parallel

_CLOSES = 1e-9  # of the characteristic length: a root that Newton's method brings there is real
_STRAYS = 1e-3  # of the same: how far it may bring it
_SINGULAR = 1e-4
_TRIES = (0.01, 0.05)


class Forward(ForwardFacet[ParallelDesign]):
    """All assembly modes for given joints."""

    noun = "joints"
    chunk = 16
    double = 1e-7

    @property
    def parallel(self) -> Parallel:
        """The mechanism."""
        return cast(Parallel, self.mechanism)

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        return self.parallel.machine.mobility.group in ("translation", "planar")

    def alike(self, modes: Sequence[str]) -> Iterator[tuple[Any, Any]]:
        """All at once."""
        yield np.arange(len(modes)), tuple(modes)

    def solve(self, joints: Array, *, mixed_modes: bool) -> list[ForwardSolutions]:
        machine = self.parallel.machine
        found = _solved(machine, joints)
        return self.answers([self._found(q, one) for q, one in zip(joints, found, strict=True)])

    def _found(self, joints: Array, one: Assembled) -> Found:
        mechanism, machine = self.parallel, self.parallel.machine
        free = _self_motions(mechanism, joints, one)
        closed = newton(machine, one.placements, np.tile(joints, (len(one.placements), 1)))
        strayed = np.abs(closed.placement - one.placements).max(axis=(-1, -2), initial=0.0)
        good = (closed.off < _CLOSES * machine.length) & (
            strayed < _STRAYS * max(machine.length, 1.0) * 1e3
        )
        single = one.multiplicity == 1
        placements = np.where((good & single)[:, None, None], closed.placement, one.placements)
        kept = good | ~single
        notes = one.notes
        if not kept.all():
            text = f"{int((~kept).sum())} roots that seem real could not be closed."
            notes = (*notes, text)
        placements, weights = placements[kept], one.multiplicity[kept]
        poses = machine.chart.pose(placements)
        modes, told = mechanism.modes_of(poses, placements, np.tile(joints, (len(poses), 1)))
        if not told.all():
            names = ", ".join(c.symbol for c in mechanism.coordinates)
            text = (
                f"{int((~told).sum())} real solutions are left out: {names} do not tell them from "
                "others of the same coordinates."
            )
            notes = (*notes, text)
            poses, weights = poses[told], weights[told]
            modes = tuple(mode for mode, known in zip(modes, told, strict=True) if known)
        first = poses[:, [c.unit == "mm" for c in mechanism.coordinates]]
        keys = [*poses.T[::-1], -np.round(first[:, -1], 6)] if first.shape[1] else [*poses.T[::-1]]
        order = np.lexsort(keys)
        return Found(
            joints=joints,
            poses=poses[order],
            modes=tuple(modes[n] for n in order.tolist()),
            multiplicity=weights[order],
            roots=one.roots,
            count=one.count,
            expected=one.expected,
            complete=one.complete and not free and bool(kept.all()) and bool(told.all()),
            method=one.method,
            notes=notes,
            pairs=one.pairs,
            self_motions=free,
        )


def _solved(machine: Assembly, joints: Array) -> list[Assembled]:
    """By the group of the platform's motion."""
    group = machine.mobility.group
    drives = {limb.drive for limb in machine.limbs}
    if group == "translation" and drives <= set(study.SPHERES):
        return translation.solve(machine, joints)
    if group == "planar":
        return planar.solve(machine, joints)
    if group == "spherical" and drives == {"direction"}:
        return rotations.solve(machine, joints)
    of = study.signature(machine)
    if of is not None and study.has_set(of):
        return study.solve(machine, of, joints)
    return searching.solve(machine, joints)


def _self_motions(mechanism: Parallel, joints: Array, one: Assembled) -> tuple[SelfMotion, ...]:
    """One motion, if there is any, through the solutions that may lie on curves of them."""
    if one.free is None or not len(one.free):
        return ()
    machine, length = mechanism.machine, mechanism.length
    closed = newton(machine, one.free, np.tile(joints, (len(one.free), 1)), rounds=60)
    scale = np.array([1.0, 1.0, 1.0, length, length, length])
    for placement, off in zip(closed.placement, closed.off, strict=True):
        if off > _CLOSES * length:
            continue
        here = placement[None]
        signs = machine.drives.branches(here, joints[None])
        _, rows = loops(machine, here, joints[None], signs)
        _, sizes, right = np.linalg.svd(rows[0])
        if len(sizes) >= 6 and sizes[5] > _SINGULAR * sizes[0]:
            continue
        direction = right[-1]
        steps = np.array([s * t * length * direction for t in _TRIES for s in (1.0, -1.0)])
        there = moved(np.repeat(here, len(steps), axis=0), steps / scale)
        ends = newton(
            machine, there, np.tile(joints, (len(steps), 1)), np.repeat(signs, len(steps), 0)
        )
        way = np.linalg.norm(ends.placement[:, :3] - placement[:3], axis=(1, 2))
        wanted = np.linalg.norm(there[:, :3] - placement[:3], axis=(1, 2))
        if (ends.off < _CLOSES * length).all() and (way > 0.5 * wanted).all():
            return (_told(mechanism, placement, joints, direction),)
    return ()


def _told(mechanism: Parallel, placement: Array, joints: Array, direction: Array) -> SelfMotion:
    pose = mechanism.machine.chart.pose(placement)
    modes, _ = mechanism.modes_of(pose[None], placement[None], joints[None])
    length = mechanism.length
    twist = np.concatenate([direction[3:] / length, direction[:3]])
    facet = mechanism.facet("motion")
    rates = facet.pose_rates(pose, modes[0], twist)
    sizes = np.array([length if c.unit == "rad" else 1.0 for c in mechanism.coordinates])
    size = float(np.linalg.norm(rates * sizes)) or 1.0
    names = [
        c.symbol
        for c, part in zip(mechanism.coordinates, np.abs(rates * sizes) / size, strict=True)
        if part > 0.05
    ]
    text = (
        f"Self-motion: the platform moves freely ({', '.join(names)}) with all actuators locked; "
        "infinitely many solutions belong to it."
    )
    return SelfMotion(tuple(pose.tolist()), modes[0], tuple((rates / size).tolist()), text)
