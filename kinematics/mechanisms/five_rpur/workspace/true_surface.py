"""A faceted workspace moved onto the surfaces that its facets stand for.

Every vertex of the solid lies near one true surface, on the curve of two or in the corner of
three and more; Gauss-Newton with steps of least norm puts it there (`sheets`). A vertex that
cannot be put on all its surfaces without folding the mesh (`folds`) goes on fewer of them, or
stays; these are counted.

Facets between exact vertices are chords: where a body is convex they lie inside it. A mesh that
is right on the average loses that; so chords that sag are halved (`refinement`) until the volume
is as good as the resolution promises. And where two surfaces meet at a very small angle, chords
of the one may cross those of the other: facets, cut by one another, never do. Lengths mm.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.workspace.folds import Net, looks, unfold
from kinematics.mechanisms.five_rpur.workspace.refinement import refine
from kinematics.mechanisms.five_rpur.workspace.sheets import (
    Masks,
    Sheets,
    masks_of,
    onto,
    onto_fewer,
    residuals,
    sheets_of,
)
from kinematics.solids.csg import PlacedMesh, SolidMesh, TracedMesh, close_pairs

ON = 1e-9
"""mm: a vertex nearer than this to its surfaces is on them (or a 1e-12th of the solid's size)."""


def true_surface(
    traced: TracedMesh, deviation: float, apart: float, sag: float | None = None
) -> PlacedMesh:
    """The mesh with its vertices on the true surfaces.

    Args:
        traced: a mesh of `vertex_space` solids, in the frame in which they were moved only.
        deviation: how far its facets are from the surfaces at most, roughly, mm.
        apart: no two vertices come nearer to each other than this, mm.
        sag: chords farther than this from their surfaces are halved, mm; None: none is.
    """
    v, f = traced.mesh.vertices, traced.mesh.faces
    if not len(f):
        return PlacedMesh(traced, 0.0, 0)
    sheets = sheets_of(traced)
    on = max(ON, 1e-12 * float(np.abs(v).max()))
    wanted = masks_of(sheets, f, len(v))
    moved, masks = _placed(sheets, wanted, v, deviation, on)
    outward = _outward(traced, sheets)
    net = Net(sheets, moved, masks, f.copy(), sheets.of_face, outward, traced.patch_of)
    unfold(net, v, deviation, on)
    while len(back := _placed_among(net, close_pairs(net.v, apart))):
        net.v[back], net.masks[back] = v[back], 0
        unfold(net, v, deviation, on)
    unplaced = int((net.masks != wanted).sum())
    if sag is not None:
        net = refine(net, sag, on, apart)
    sure = net.masks != 0
    residual = residuals(sheets, net.masks[sure], net.v[sure]).max(initial=0.0)
    mesh = SolidMesh(net.v, net.f)
    return PlacedMesh(TracedMesh(mesh, traced.patches, net.patch_of), float(residual), unplaced)


def _placed(
    sheets: Sheets, wanted: Masks, v: Array, deviation: float, on: float
) -> tuple[Array, Masks]:
    """Vertices on all of their surfaces, or on fewer, or as they were; and on which."""
    moved, done = onto(sheets, wanted, v, deviation, on)
    masks = wanted.copy()
    while len(short := np.flatnonzero(~done & (masks != 0))):
        moved[short], masks[short] = onto_fewer(sheets, masks[short], v[short], deviation, on)
        done[short] = True
    return moved, masks


def _placed_among(net: Net, pairs: NDArray[np.intp]) -> NDArray[np.intp]:
    """The vertices of pairs that are not where they came from."""
    found = np.unique(pairs)
    return np.asarray(found[net.masks[found] != 0], dtype=np.intp)


def _outward(traced: TracedMesh, sheets: Sheets) -> Array:
    """(F,) +1 or −1: whether a face looks along its surface's normal, by the vote of a patch."""
    vote = looks(sheets, sheets.of_face, traced.mesh.vertices, traced.mesh.faces)
    # An end's two planes look to opposite sides.
    group = traced.patch_of * len(sheets) + sheets.of_face
    _, which = np.unique(group, return_inverse=True)
    side: Array = np.where(np.bincount(which, vote) < 0.0, -1.0, 1.0)
    return side[which]
