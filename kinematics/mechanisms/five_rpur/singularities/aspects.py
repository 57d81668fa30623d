"""The aspects of one working mode, cut at one orientation: pieces of the workspace as solids.

The workspace of the mode is parted where the wrenches are dependent (`determinant`). On every
piece the determinant keeps its sign, so that the platform may move all over it, at this
orientation, without losing control. The pieces are slices of the aspects, which live in five
dimensions: two of them may be joined through other orientations. Frame x'y'z'; lengths mm.

The meshes of Booleans show a piece if it is thicker than a cell, and a neck between two pieces if
it is wider. So, but for a preview, what hangs together is looked up in exact columns (`columns`),
roughly at first. Where that is something else, meshes with the finest cells are tried; where those
are wrong too, the solid is made of the columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinematics.errors import ComputationError
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.offsets import merged_limbs
from kinematics.mechanisms.five_rpur.singularities.cells import CELLS, Cells, Field
from kinematics.mechanisms.five_rpur.singularities.columns import ModeColumns
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.mechanisms.five_rpur.workspace.workspace import (
    coarseness,
    from_solid,
    thinnest,
    volume_error,
)
from kinematics.solids.column_solids import Quality, layout, parted, shaped
from kinematics.solids.csg import BuiltSolid, LeakError, Solid, TracedMesh
from kinematics.solids.isosurfaces import positive_part
from kinematics.solids.partition import partition
from kinematics.solids.refining import Fineness

_NEAR = 1e-7  # part of the machine's size
_LOOKS = (Fineness((16, 16), 2e-2, 2000), Fineness((16, 16), 5e-3, 2000))
_QUALITY: dict[Resolution, Quality] = {
    "normal": Quality(Fineness((12, 12), 1e-3, 4000), exact=2e-4, promised=1e-3),
    "fine": Quality(Fineness((16, 16), 2e-4, 16000), exact=5e-5, promised=2e-4),
}
_SAME, _SMALL = 0.1, 0.01
"""Parts of a piece's volume and of the whole by which a rough volume may be off."""
_TINY = 1e-5  # of the whole: smaller pieces need not be shown
_MANY = 50  # pieces: more are due to limbs that are nearly equal
_MERGED = 1e-6  # see `offsets.merged_limbs`
_UNCERTAIN = (
    "How many pieces there are is not certain: some are thinner, or nearer to each other, than the "
    "cells that this resolution has can tell."
)


def aspects(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    mode: str,
    resolution: Resolution = "normal",
) -> BuiltSolid:
    """The singularity-free pieces of the workspace in x'y'z' (turn it by R_y(θ) for the base).

    Returns:
        All pieces as one `BuiltSolid`; a piece's sign is that of the determinant of
        the wrenches of `statics`. Volumes add up to that of the workspace of the mode, within its
        error. ``note`` says if how many pieces there are is not certain.

    Raises:
        InputError: an angle that is not finite, or a mode that is not five signs.
        ComputationError: every pose is singular, or manifold3d gave up.
    """
    built = _of_meshes(design, phi, theta, mode, resolution)
    determinant = Determinant.at(design, phi, theta, mode)
    if resolution == "preview" or not determinant.closes:
        return built
    stands = merged_limbs(design, phi, theta, _MERGED)
    columns = ModeColumns(determinant, stands)
    tried = [built]
    for look in _LOOKS:
        pieces, settled = layout(columns, look)
        clear = settled and len(pieces) <= _MANY
        right = _one_alike(tried, pieces) if settled else None
        if right is None and clear and resolution != "fine" and len(tried) == 1:
            tried.append(_of_meshes(design, phi, theta, mode, "fine"))
            right = _one_alike(tried[1:], pieces)
        if right is not None:
            return right
    if clear:
        try:
            found = parted(shaped(columns, _QUALITY[resolution]), Field(determinant), columns.off)
            right = _one_alike(tried, [(piece.sign, piece.volume) for piece in found.pieces])
            if right is not None:
                return right  # the looks had been too rough
            return replace(found, volume_error=found.volume_error + stands.moved * found.area)
        except LeakError:
            pass
    return replace(built, note=_UNCERTAIN)


def _one_alike(meshes: Sequence[BuiltSolid], wanted: list[tuple[int, float]]) -> BuiltSolid | None:
    """The first that has the pieces that it should have."""
    return next((mesh for mesh in meshes if _alike(mesh, wanted)), None)


def _of_meshes(
    design: FiveRPURDesign, phi: float, theta: float, mode: str, resolution: Resolution
) -> BuiltSolid:
    """The pieces by Booleans of meshes, as far as their cells can tell them."""
    return from_solid(
        design,
        phi,
        theta,
        (mode,),
        resolution,
        lambda whole, moved: _parted(design, phi, theta, mode, resolution, whole, moved),
    )


def _alike(built: BuiltSolid, wanted: list[tuple[int, float]]) -> bool:
    """Whether a solid has the pieces that it should have, by their signs and volumes."""
    total = sum(volume for _, volume in wanted)
    there = [(p.sign, p.volume) for p in built.pieces]
    found, wanted = ([p for p in each if p[1] > _TINY * total] for each in (there, wanted))
    for sign in (1, -1):
        own, true = (sorted(volume for s, volume in e if s == sign) for e in (found, wanted))
        if len(own) != len(true):
            return False
        if not np.allclose(own, true, rtol=_SAME, atol=_SMALL * total):
            return False
    return True


def _parted(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    mode: str,
    resolution: Resolution,
    whole: Solid,
    moved: float,
) -> BuiltSolid:
    determinant = Determinant.at(design, phi, theta, mode)
    coarsest = coarseness(design, resolution)

    def error(mesh: TracedMesh, volume: float) -> float:
        return volume_error(mesh, volume, coarsest, moved)

    field = Field(determinant)
    thin = thinnest(design, resolution)
    if whole.bounds is None:
        return partition(whole, None, 1, field, error, thinnest=thin)
    box = np.array(whole.bounds)
    cells = Cells.about(determinant, design.stroke, box, CELLS[resolution], coarsest)
    known = cells.values[np.isfinite(cells.values)]
    if cells.vanish():
        raise ComputationError(
            f"every pose at this orientation in mode {mode} is a parallel singularity: the "
            "wrenches of the limbs are dependent everywhere, so there are no aspects"
        )
    if not ((known > 0.0).any() and (known < 0.0).any()):
        return partition(whole, None, 1 if known.max() > 0.0 else -1, field, error, thinnest=thin)
    # Of the two sides the smaller one is the cheaper tool.
    sign = 1 if (known > 0.0).sum() <= (known < 0.0).sum() else -1
    # Exact enough to be put on the zeros at the end, with what the split makes of them.
    near = _NEAR * determinant.size
    cutter = positive_part(
        cells.axes, sign * cells.values, Field(determinant, sign), tolerance=near
    )
    return partition(whole, cutter, sign, field, error, thinnest=thin, reach=2.0 * coarsest)
