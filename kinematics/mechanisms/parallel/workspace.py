"""The workspace of a parallel mechanism as a solid: what all limbs' margins leave together.

Each margin (an end of a range, a reach, a cone) bounds a solid of its own, a closed mesh with its
vertices on the true surface; their intersection has sharp edges where surfaces meet, which a mesh
of the least margin would round off. Margins go on continuously where a limb cannot close.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import cast

import numpy as np
from scipy.ndimage import binary_dilation

from kinematics.answers.modes import Mode
from kinematics.arrays import Array
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.parallel.assembly import Assembly, assembled
from kinematics.mechanisms.parallel.chart import placed
from kinematics.mechanisms.parallel.design import ParallelDesign
from kinematics.mechanisms.parallel.drives import Stretched
from kinematics.mechanisms.parallel.ranges import Ranges
from kinematics.mechanisms.parallel.solids import scales, slots
from kinematics.solids import meshes
from kinematics.solids.csg import BuiltSolid, LeakError, Solid, finish
from kinematics.solids.isosurfaces import positive_part
from kinematics.solids.meshes import TracedMesh

THETA = 4
_CELLS: dict[Resolution, int] = {"preview": 12, "normal": 32, "fine": 64}
_COARSE = 22  # nodes along each side of a box in which what can be held is sought
_FITTED = 4  # times that the box is fitted
_STEP = 1e-6  # of the box, of the differences that gradients are made of
_TRIES = 4  # grids, where a solid's surface does not close
_CERTAIN = 2.0
"""Times the third of the difference to a mesh of half as many cells, which is what is left."""

_ALIKE = 1e-5
"""Of the box: margins that are nearer to each other everywhere are one."""

_Box = tuple[Array, Array, Array, Array]
"""Lowest and highest corner, and how far it may be widened to both sides."""


@dataclass(frozen=True, eq=False)
class _Margins:
    """Margins of one limb, or of what follows, at places (N, 3) as they are drawn."""

    machine: Assembly
    limb: int | None
    mode: Mode
    held: tuple[float, ...]

    def poses(self, points: Array) -> Array:
        poses = np.tile(np.array(self.held), (len(points), 1))
        poses[:, list(slots(self.machine))] = points / scales(self.machine)
        return poses

    def full(self, points: Array) -> tuple[Array, Array]:
        """The whole poses at places, and how far they are from where there are none."""
        return self.machine.chart.full(self.poses(points), int(self.mode.operation or 1))

    def __call__(self, points: Array) -> Array:
        """(N, K)."""
        return self.at(*self.full(points))

    def at(self, full: Array, room: Array) -> Array:
        """(N, K) at whole poses, which all limbs share."""
        machine, n = self.machine, self.limb
        if n is None:
            return room[:, None]
        placement = np.asarray(placed(full))
        one = _alone(machine, n)
        sign = np.array(self.mode.sigma or (1.0,) * len(machine.limbs))[n : n + 1]
        joints = one.drives.joints(placement, sign)
        amounts = Ranges(one).margins(placement, sign, joints, room)
        limb = machine.limbs[n]
        names = [bound.end for bound in Ranges(one).bounds]
        columns = [amounts[:, k] for k, end in enumerate(names) if end not in ("min", "max")]
        ends = [amounts[:, k] for k, end in enumerate(names) if end in ("min", "max")]
        if not limb.turns:
            columns += [end for end in ends if np.isfinite(end).any()]
        elif np.isfinite(limb.high - limb.low) and limb.high - limb.low < 2.0 * np.pi:
            middle, half = 0.5 * (limb.low + limb.high), 0.5 * (limb.high - limb.low)
            lever = limb.crank or machine.length
            columns.append(lever * (np.cos(joints[:, 0] - middle) - np.cos(half)))
        made = np.stack(columns, axis=-1) if columns else np.empty((len(full), 0))
        return np.nan_to_num(np.minimum(made, 1e3 * machine.length), nan=0.0)


@lru_cache(maxsize=64)
def _alone(machine: Assembly, n: int) -> Assembly:
    """The machine with one limb, which stretches where it cannot close."""
    limbs = machine.limbs[n : n + 1]
    bonds = replace(machine.bonds, limbs=tuple(replace(one, bond="free") for one in limbs))
    return replace(machine, limbs=limbs, drives=Stretched(limbs), bonds=bonds)


@lru_cache(maxsize=8)
def build(
    design: ParallelDesign, mode: str, held: tuple[float, ...], resolution: Resolution
) -> BuiltSolid:
    """The solid of one mode with some coordinates held; its error is an estimate.

    Raises:
        ComputationError: manifold3d gave up.
    """
    machine = assembled(design)
    each = [_Margins(machine, n, Mode.read(mode), held) for n in range(len(machine.limbs))]
    if machine.chart.operations > 1:
        each.append(_Margins(machine, None, Mode.read(mode), held))
    box = _box(machine, each)
    if box is None:
        return finish(Solid.from_mesh(np.empty((0, 3)), np.empty((0, 3))), lambda *_: 0.0)
    cells = _CELLS[resolution]
    coarse = _solid(each, box, cells // 2)[0].volume
    for more in range(_TRIES):
        # Where surfaces touch, another grid may part them.
        solid, merged = _solid(each, box, cells + more)
        refined = abs(solid.volume - coarse) / 3.0 * _CERTAIN
        try:
            return finish(
                solid,
                partial(_error, each, box, refined, merged),
                thinnest=1e-6 * float(np.max(box[1] - box[0])),
            )
        except LeakError:
            if more == _TRIES - 1:
                raise
    raise AssertionError


def _error(
    each: list[_Margins], box: _Box, refined: float, merged: float, traced: TracedMesh, _: float
) -> float:
    """mm³ by which the volume of a mesh may be off: what lies between its faces and the surfaces,
    and not less than what ``refined`` cells made of it, which tells of parts that none saw; and
    what lies between margins that were ``merged``, mm.
    """
    corners = traced.mesh.vertices[traced.mesh.faces]
    of = {margins.limb: margins for margins in each}
    between = 0.0
    for n, patch in enumerate(traced.patches):
        limb, k = cast("tuple[int | None, int]", patch.tag)
        at = corners[traced.patch_of == n]
        near = 1e-6 * (box[1] - box[0])
        ends = [(np.abs(at - end) < near).all(axis=1).any(axis=1) for end in box[2:]]
        at = at[~(ends[0] | ends[1])]  # an angle goes once round there, no margin ends
        if len(at):
            between += meshes.sag(at, partial(_column, of[limb], k))
    area = 0.5 * float(meshes.face_parts(traced.mesh.vertices, traced.mesh.faces)[1].sum())
    return max(refined, between) + merged * area


def _column(margins: _Margins, k: int, points: Array) -> Array:
    return margins(points)[:, k]


def _least(each: list[_Margins], points: Array) -> Array:
    """(N,) the least of all margins."""
    shared = each[0].full(points)
    return np.asarray(np.nanmin(np.concatenate([m.at(*shared) for m in each], axis=1), axis=1))


def _box(machine: Assembly, each: list[_Margins]) -> _Box | None:
    """A box about everything that can be held, as a grid sees it; None where nothing can.

    Lowest and highest corner, and how far it may be widened: an angle goes once round.
    """
    axes = Ranges(machine).poses()
    shown, scale = slots(machine), scales(machine)
    low = np.array([axes[n].lower for n in shown]) * scale
    high = np.array([axes[n].upper for n in shown]) * scale
    # θ from −90° to 90°: beyond are the same orientations once more.
    pitch = np.array([machine.chart.free[n] == THETA for n in shown])
    low, high = np.where(pitch, 0.5 * low, low), np.where(pitch, 0.5 * high, high)
    whole = low.copy(), high.copy()
    home = machine.chart.pose(machine.reference)[list(shown)] * scale
    found = False
    for _ in range(_FITTED):
        steps = [np.linspace(a, b, _COARSE) for a, b in zip(low, high, strict=True)]
        points = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
        points = np.concatenate([points, home[None]])
        inside = points[_least(each, points) >= 0.0]
        if not len(inside):
            break
        found = True
        cell = (high - low) / (_COARSE - 1)
        low = np.maximum(inside.min(axis=0) - 1.01 * cell, whole[0])
        high = np.minimum(inside.max(axis=0) + 1.01 * cell, whole[1])
    angle = np.array([machine.chart.free[n] >= 3 for n in shown])
    ends = np.where(angle, whole[0], -np.inf), np.where(angle, whole[1], np.inf)
    return (low, high, *ends) if found else None


def _solid(each: list[_Margins], box: _Box, cells: int) -> tuple[Solid, float]:
    """The solid, and how far margins were apart, mm, that were taken for one."""
    low, high, least, most = box
    # Not symmetric, so that surfaces which meet do not do so in nodes.
    counts = (cells + 1, cells + 2, cells + 3)
    cell = (high - low) / cells
    low, high = np.maximum(low - 0.17 * cell, least), np.minimum(high + 0.29 * cell, most)
    axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    points, shape = grid.reshape(-1, 3), grid.shape[:-1]
    step = _STEP * (high - low)
    solids: list[Solid] = []
    taken: list[Array] = []
    alike, merged = _ALIKE * float(np.max(high - low)), 0.0
    shared = each[0].full(points)
    found = [margins.at(*shared) for margins in each]
    near = np.ones(shape, dtype=bool)
    for values in found:
        near &= (values >= 0.0).all(axis=1).reshape(shape)
    around = binary_dilation(near, np.ones((3, 3, 3)), iterations=2).ravel()
    for margins, values in zip(each, found, strict=True):
        for k in range(values.shape[1]):
            if (values[around, k] >= 0.0).all():
                continue  # it bounds nothing of what the others leave
            # Surfaces that all but coincide cannot be told apart by meshes.
            apart = min((_apart(values[around, k], other) for other in taken), default=np.inf)
            if apart <= alike:
                merged = max(merged, apart)
                continue
            taken.append(values[around, k])

            def field(at: Array, margins: _Margins = margins, k: int = k) -> tuple[Array, Array]:
                tried = np.concatenate([at, *(at + aside for aside in np.diag(step))])
                parts = margins(tried)[:, k].reshape(4, -1)
                return parts[0], ((parts[1:] - parts[0]) / step[:, None]).T

            surface = positive_part(axes, values[:, k].reshape(shape), field)
            made = Solid.from_mesh(surface.vertices, surface.faces, tags=((margins.limb, k),))
            solids.append(made)
            if made.is_empty:
                return made, merged
    if not solids:
        corners = positive_part(axes, np.ones(shape), lambda at: (np.ones(len(at)), 0.0 * at))
        return Solid.from_mesh(corners.vertices, corners.faces), merged
    return Solid.intersection(solids), merged


def _apart(one: Array, other: Array) -> float:
    return float(np.abs(one - other).max(initial=0.0))
