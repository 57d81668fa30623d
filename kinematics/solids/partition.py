"""A solid parted by the zeros of a function into pieces on which the function keeps its sign.

The solid is split by the mesh of an isosurface, so that what one side loses the other side gains:
the volumes of the pieces add up to the solid's. Every piece is a closed mesh of its own; the
surface between two of them is there twice, once for either side, with the same vertices. These are
then put on the zeros of the function, at the rim along the solid's faces and edges.

Scraps that are thinner than what the mesh can tell go to the piece that they touch. Lengths mm.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.solids import meshes
from kinematics.solids.csg import BuiltSolid, LeakError, Solid, rounded
from kinematics.solids.isosurfaces import Isosurface
from kinematics.solids.meshes import Patch, Piece, SolidMesh, TracedMesh
from kinematics.zeros import Field

LOCUS = "locus"
"""The tag of faces on the zeros."""
_SIDE = "side"

_STEPS = 8  # of Newton's method along a face or an edge
_FLAT = 1e-6  # of the scatter of the normals about a vertex: less is rounding
_STEEP = 0.03  # of the gradient along the faces: less, and they touch the zeros

Ints = NDArray[np.intp]
Mask = NDArray[np.bool_]


def partition(
    solid: Solid,
    cutter: Isosurface | None,
    sign: int,
    field: Field,
    error: Callable[[TracedMesh, float], float],
    *,
    thinnest: float = 0.0,
    reach: float = np.inf,
) -> BuiltSolid:
    """The pieces of a solid, each with the sign of the function.

    Args:
        solid: what to part.
        cutter: the closed surface of the part of space where sign × function is positive, as
            large as the solid at least; None where the function has the sign everywhere in it.
        sign: +1 or −1.
        field: the function and its gradient.
        error: estimates |mesh volume − true volume| of the whole solid, as for `solids.finish`.
        thinnest: a piece thinner than this on the average (2 volume / area, mm) is a scrap.
        reach: mm, the longest way on which a vertex at the rim is put on the zeros.

    Raises:
        LeakError: a piece's surface could not be closed.
    """
    if cutter is None or solid.is_empty:
        sides = [(solid, sign)]
    else:
        patch = np.where(cutter.on_zero, 0, 1)
        tool = Solid.from_mesh(cutter.vertices, cutter.faces, patch=patch, tags=(LOCUS, _SIDE))
        inside, outside = _without_scraps(*solid.split(tool), thinnest)
        sides = [(inside, sign), (outside, -sign)]
    return assembled(sides, field, error, thinnest=thinnest, reach=reach)


def assembled(
    sides: Sequence[tuple[Solid, int]],
    field: Field,
    error: Callable[[TracedMesh, float], float],
    *,
    thinnest: float = 0.0,
    reach: float = np.inf,
    together: Sequence[Callable[[Array], Ints]] = (),
    total: Callable[[float], float] | None = None,
) -> BuiltSolid:
    """The sides of a solid, each with its sign, as one; what parts them has the tag `LOCUS`.

    Args:
        sides: solids, and the signs of the function in them.
        field, error, thinnest, reach: as for `partition`.
        together: of each side the numbers of pieces, by places on them: shells that have one
            number are one piece.
        total: the error of the whole volume, where that is known better than by ``error``.
    """
    bounds = np.array([np.zeros((2, 3)), *(side.bounds for side, _ in sides if side.bounds)])
    step = meshes.grid_step(np.maximum(np.abs(bounds).reshape(-1, 3), 1e-30))
    parts: list[TracedMesh] = []
    shells: list[Ints] = []
    lost = 0.0
    for side, _ in sides:
        traced, shell, dropped = meshes.without_slivers(side.traced(), thinnest)
        traced, shell, _ = rounded(side, traced, shell, thinnest, step, collapse=False)
        parts.append(traced)
        shells.append(shell)
        lost += 2.0 * dropped
    whole = _together(parts)
    of_patch = np.array([patch.tag == LOCUS for patch in whole.patches], dtype=bool)
    on_locus = of_patch[whole.patch_of] if len(of_patch) else np.zeros(0, bool)
    v, residual, unplaced = _on_zeros(whole.mesh, on_locus, field, step, reach)
    f = whole.mesh.faces
    whole = TracedMesh(SolidMesh(v, f), whole.patches, whole.patch_of)
    signs = [own for _, own in sides]
    pieces, piece_of, closed = _pieces(v, parts, shells, signs, together)
    if not closed:
        raise LeakError
    if len({piece.sign for piece in pieces}) < 2:  # what is left of merged scraps
        on_locus, residual, unplaced = np.zeros(len(f), dtype=bool), 0.0, 0
    pieces = _with_errors(pieces, piece_of, whole, on_locus, field, error)
    six, twice, _ = meshes.face_parts(v, f)
    volume = float(six.sum()) / 6.0
    return BuiltSolid(
        mesh=whole.mesh,
        shaded=meshes.shaded(whole),
        volume=volume,
        volume_error=error(whole, volume) + lost if total is None else total(volume),
        area=float(twice.sum()) / 2.0,
        pieces=pieces,
        watertight=True,
        triangles=len(f),
        piece_of=piece_of,
        on_locus=on_locus,
        locus_residual=residual,
        locus_unplaced=unplaced,
    )


# --- scraps --------------------------------------------------------------------------------------


def _without_scraps(inside: Solid, outside: Solid, thinnest: float) -> tuple[Solid, Solid]:
    """Both sides, each with the other's scraps."""
    kept, scraps = zip(_sorted(inside, thinnest), _sorted(outside, thinnest), strict=True)
    if not any(scraps):
        return inside, outside
    one, other = (
        Solid.union((Solid.composed(own), *more)) if more else Solid.composed(own)
        for own, more in zip(kept, reversed(scraps), strict=True)
    )
    return one, other


def _sorted(solid: Solid, thinnest: float) -> tuple[list[Solid], list[Solid]]:
    """The shells of a solid, and those that are scraps; a void is none."""
    kept: list[Solid] = []
    scraps: list[Solid] = []
    for shell in solid.shells():
        thin = 0.0 <= 2.0 * shell.volume <= thinnest * shell.area
        (scraps if thin else kept).append(shell)
    return kept, scraps


# --- vertices on the zeros -----------------------------------------------------------------------


def _on_zeros(
    mesh: SolidMesh, on_locus: Mask, field: Field, step: float, reach: float
) -> tuple[Array, float, int]:
    """The vertices with those of the locus put on it, the worst residual, and how many are not.

    What two sides share is moved alike: vertices are known by their places here.
    """
    v, f = mesh.vertices, mesh.faces
    if not on_locus.any():
        return v, 0.0, 0
    places, place_of = _places(v)
    corners = place_of[f]
    chosen = np.unique(corners[on_locus])
    start = places[chosen]
    free = _freedom(places, corners, on_locus, chosen)
    there, good = _along(field, start, free, reach, 1e-2 * step)
    moved = places.copy()
    moved[chosen[good]] = there[good]
    _untangle(places, moved, corners, step)
    value, gradient = field(moved[chosen])
    with np.errstate(invalid="ignore", divide="ignore"):
        residual = np.abs(value) / np.linalg.norm(gradient, axis=1)
    placed = residual <= 1e-3 * step
    worst = float(residual[placed].max(initial=0.0))
    return moved[place_of], worst, int((~placed).sum())


def _places(v: Array) -> tuple[Array, Ints]:
    """The different places of vertices, and at which of them each stands."""
    order = np.lexsort(v.T)
    new = np.ones(len(v), dtype=bool)
    new[1:] = (v[order[1:]] != v[order[:-1]]).any(axis=1)
    place_of = np.empty(len(v), dtype=np.intp)
    place_of[order] = np.cumsum(new) - 1
    return v[order[new]], place_of


def _freedom(places: Array, corners: Ints, on_locus: Mask, chosen: Ints) -> Array:
    """(N, 3, 3) projectors onto the directions that keep chosen places on faces off the locus."""
    free = np.tile(np.eye(3), (len(chosen), 1, 1))
    number = np.full(len(places), -1, dtype=np.intp)
    number[chosen] = np.arange(len(chosen))
    faces = corners[~on_locus]
    faces = faces[(number[faces] >= 0).any(axis=1)]
    a, b, c = (places[faces[:, n]] for n in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    outer = normal[:, :, None] * normal[:, None, :] / np.maximum(size, 1e-300)[:, None, None]
    scatter = np.zeros((len(chosen), 3, 3))
    for n in range(3):
        at = number[faces[:, n]]
        np.add.at(scatter, at[at >= 0], outer[at >= 0])
    rim = np.flatnonzero(np.einsum("nii->n", scatter) > 0.0)
    sizes, axes = np.linalg.eigh(scatter[rim])
    flat = sizes <= _FLAT * np.maximum(sizes[:, 2:], 1e-300)
    free[rim] = np.einsum("pia,pa,pja->pij", axes, flat.astype(float), axes)
    return free


def _along(
    field: Field, start: Array, free: Array, reach: float, tolerance: float
) -> tuple[Array, Mask]:
    """Points moved onto the zeros in the directions that are free, and which of them got there."""
    p = start.copy()
    active = np.arange(len(p))
    good = np.zeros(len(p), dtype=bool)
    for _ in range(_STEPS):
        value, gradient = field(p[active])
        way = np.einsum("nij,nj->ni", free[active], gradient)
        steep = np.linalg.norm(gradient, axis=1)
        along = np.einsum("ni,ni->n", way, way)
        open_ = (along > (_STEEP * steep) ** 2) & np.isfinite(along)
        with np.errstate(invalid="ignore", divide="ignore"):
            move = np.where(open_[:, None], -(value / along)[:, None] * way, 0.0)
        p[active] += move
        ahead = np.linalg.norm(p[active] - start[active], axis=1) <= reach
        arrived = open_ & ahead & (np.linalg.norm(move, axis=1) <= tolerance)
        good[active[arrived]] = True
        active = active[open_ & ahead & ~arrived]
        if not len(active):
            break
    else:
        good[active] = True  # as near as rounding lets them
    return p, good


def _untangle(places: Array, moved: Array, corners: Ints, step: float) -> None:
    """Puts places back where faces would turn over or places fall together, in ``moved``."""
    away = (moved != places).any(axis=1)
    touched = corners[away[corners].any(axis=1)]
    before = _normals(places, touched)
    around = np.unique(touched)
    for _ in range(16):
        over = (np.einsum("ij,ij->i", before, _normals(moved, touched)) <= 0.0) & away[touched].any(
            axis=1
        )
        back = np.unique(touched[over])
        close = around[np.unique(meshes.close_pairs(moved[around], 0.75 * step))]
        back = np.union1d(back[away[back]], close[away[close]])
        if not len(back):
            return
        moved[back] = places[back]
        away[back] = False


def _normals(v: Array, f: Ints) -> Array:
    a, b, c = (v[f[:, n]] for n in range(3))
    return np.cross(b - a, c - a)


def _sags(mesh: SolidMesh, on_locus: Mask, field: Field) -> Array:
    """(F,) the volume between each face on the locus and the locus, mm³, with a sign."""
    swept = np.zeros(len(mesh.faces))
    a, b, c = (mesh.vertices[mesh.faces[on_locus, n]] for n in range(3))
    value, gradient = field((a + b + c) / 3.0)
    twice = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        away = value / np.linalg.norm(gradient, axis=1)
    # Between a chord and a parabola, three quarters of the sag in the middle are the mean.
    swept[on_locus] = 0.375 * twice * np.where(np.isfinite(away), away, 0.0)
    return swept


# --- pieces --------------------------------------------------------------------------------------


def _together(parts: Sequence[TracedMesh]) -> TracedMesh:
    """Several meshes as one."""
    vertices, faces, patch_of = [], [], []
    patches: list[Patch] = []
    count = 0
    for part in parts:
        vertices.append(part.mesh.vertices)
        faces.append(part.mesh.faces + count)
        patch_of.append(part.patch_of + len(patches))
        patches += part.patches
        count += len(part.mesh.vertices)
    mesh = SolidMesh(np.concatenate(vertices), np.concatenate(faces).astype(np.int32))
    return TracedMesh(mesh, tuple(patches), np.concatenate(patch_of))


def _pieces(
    v: Array,
    parts: Sequence[TracedMesh],
    shells: Sequence[Ints],
    signs: Sequence[int],
    together: Sequence[Callable[[Array], Ints]],
) -> tuple[tuple[Piece, ...], Ints, bool]:
    """All pieces, the largest first; of which each face is; and whether every side is closed."""
    found: list[Piece] = []
    owners: list[Ints] = []
    closed = True
    first = 0
    for n, (part, shell, sign) in enumerate(zip(parts, shells, signs, strict=True)):
        there, own = v[first : first + len(part.mesh.vertices)], part.mesh.faces
        six, _, moments = meshes.face_parts(there, own)
        pieces, piece_of = meshes.pieces(there, own, shell, six, moments)
        if together and pieces:
            pieces, piece_of = meshes.merged(there, own, pieces, piece_of, together[n])
        owners.append(np.where(piece_of < 0, -1, piece_of + len(found)))
        found += [replace(piece, sign=sign) for piece in pieces]
        closed &= meshes.closed_by_position(there, own)
        first += len(there)
    order = sorted(range(len(found)), key=lambda n: (-found[n].volume, found[n].bounds))
    place = np.full(len(found) + 1, -1, dtype=np.intp)
    place[order] = np.arange(len(found))
    return tuple(found[n] for n in order), place[np.concatenate(owners)], closed


def _with_errors(
    pieces: tuple[Piece, ...],
    piece_of: Ints,
    whole: TracedMesh,
    on_locus: Mask,
    field: Field,
    error: Callable[[TracedMesh, float], float],
) -> tuple[Piece, ...]:
    """The pieces with the errors of their volumes: of the solid's faces, and of the zeros'."""
    swept = _sags(whole.mesh, on_locus, field) if on_locus.any() else np.zeros(len(piece_of))
    found = []
    for n, piece in enumerate(pieces):
        own = piece_of == n
        mesh = SolidMesh(whole.mesh.vertices, whole.mesh.faces[own])
        at_faces = error(TracedMesh(mesh, whole.patches, whole.patch_of[own]), piece.volume)
        absolute = float(np.abs(swept[own]).sum())
        share = min(1.0, (absolute / piece.volume) ** 0.5)
        at_zeros = 1.25 * abs(float(swept[own].sum())) + 3.0 * absolute * share
        found.append(replace(piece, volume_error=at_faces + at_zeros))
    return tuple(found)
