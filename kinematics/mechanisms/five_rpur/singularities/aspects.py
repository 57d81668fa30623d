"""The aspects of one working mode, cut at one orientation: pieces of the workspace as solids.

The workspace of the mode is parted where the wrenches are dependent (`determinant`). On every
piece the determinant keeps its sign, so that the platform may move all over it, at this
orientation, without losing control. The pieces are slices of the aspects, which live in five
dimensions: two of them may be joined through other orientations. Frame x'y'z'; lengths mm.
"""

from __future__ import annotations

import numpy as np

from kinematics.errors import ComputationError
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.singularities.cells import CELLS, Cells, Field
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.mechanisms.five_rpur.workspace.workspace import (
    coarseness,
    from_solid,
    thinnest,
    volume_error,
)
from kinematics.solids.csg import BuiltSolid, Solid, TracedMesh
from kinematics.solids.isosurfaces import positive_part
from kinematics.solids.partition import partition

_NEAR = 1e-7  # part of the machine's size


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
        the wrenches of `statics`. Volumes add up to that of the workspace of the mode.

    Raises:
        InputError: an angle that is not finite, or a mode that is not five signs.
        ComputationError: every pose is singular, or manifold3d gave up.
    """
    return from_solid(
        design,
        phi,
        theta,
        (mode,),
        resolution,
        lambda whole, moved: _parted(design, phi, theta, mode, resolution, whole, moved),
    )


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
