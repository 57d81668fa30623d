"""How a solid is painted: a mesh for each colour, as the browser knows one colour a mesh.

One colour as a rule; of aspects one for each piece and one for the singular surface between them;
of a measure one for each step of it, cut along the lines where the measure takes these values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.scene import palette
from app.scene.palette import LIGHT, Scheme
from kinematics.arrays import Array

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

STEPS = 10
"""of a measure; each is a mesh."""
LIFT = 1e-3
"""of a solid's size, see `lifted`."""
PIECES = 10
"""that have a mesh, and so a colour, of their own; smaller ones share the last."""


Shells = tuple[float, float]
"""Opacities of the faces that are seen from within, drawn first, and of those from outside: depth,
without the tint of both being the same.
"""
PLAIN: Shells = (0.10, 0.16)
LIMB: Shells = (0.10, 0.20)
ASPECT: Shells = (0.20, 0.30)
MEASURE: Shells = (0.30, 0.50)
LOCUS: Shells = (0.35, 0.55)


@dataclass(frozen=True, eq=False, slots=True)
class Coat:
    """Triangles of one colour: ``vertices`` (V, 3) mm float32, ``faces`` (F, 3) uint32.

    ``shells`` are those at the usual opacity of the solid; ``piece``: which of its pieces it is.
    """

    color: str
    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    shells: Shells = PLAIN
    piece: int | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Scale:
    """The steps of a measure: ``edges`` (STEPS + 1,) increasing; good values have the last colours
    if ``high`` ones are better.
    """

    edges: Array
    high: bool

    def color(self, step: int) -> str:
        share = step / (STEPS - 1)
        return palette.ramp_color(share if self.high else 1.0 - share)


def plain(solid: BuiltSolid, color: str, shells: Shells = PLAIN) -> tuple[Coat, ...]:
    """One colour."""
    mesh = solid.shaded
    faces = mesh.faces.astype(np.uint32, copy=False)
    return (Coat(color, _float(mesh.vertices), faces, shells),)


def piece_colors(signs: Sequence[int], of: Scheme = LIGHT) -> tuple[str, ...]:
    """A colour for each of a solid's pieces, from their signs."""
    seen: dict[int, int] = {}
    colors = []
    for n, sign in enumerate(signs):
        if n < PIECES:
            seen[sign] = seen.get(sign, -1) + 1
        colors.append(palette.aspect_color(sign, seen.get(sign, 0), of))
    return tuple(colors)


def pieces(solid: BuiltSolid, *, locus: bool, of: Scheme = LIGHT) -> tuple[Coat, ...]:
    """The singular surface between pieces, if it is to be seen, and each piece in its colour."""
    assert solid.piece_of is not None
    assert solid.on_locus is not None
    mesh = solid.shaded
    colors = piece_colors([piece.sign for piece in solid.pieces], of)
    owner = np.minimum(solid.piece_of, PIECES - 1)
    outside = ~solid.on_locus
    vertices = lifted(mesh.vertices, mesh.faces[outside])
    coats = []
    if locus:
        # Of both sides of the surface one is enough. First, as the pieces are around it.
        signs = np.array([piece.sign for piece in solid.pieces])
        one = solid.on_locus & (signs[solid.piece_of] > 0)
        coats.append(_part(mesh.vertices, mesh.faces[one], of.beyond, LOCUS))
    coats += [
        _part(vertices, mesh.faces[outside & (owner == n)], colors[n], ASPECT, n)
        for n in range(min(len(colors), PIECES))
    ]
    return tuple(coat for coat in coats if len(coat.faces))


def lifted(vertices: NDArray[Any], faces: NDArray[Any]) -> NDArray[np.float32]:
    """Vertices (V, 3) of faces moved outwards a little, for the eye only: where another solid has
    the very same face the browser could not tell which of both is in front.
    """
    a, b, c = (vertices[faces[:, n]].astype(float) for n in range(3))
    turned = np.cross(b - a, c - a)
    normal = np.zeros((len(vertices), 3))
    for n in range(3):
        np.add.at(normal, faces[:, n], turned)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    size = float(np.ptp(vertices, axis=0).max(initial=0.0))
    return (vertices + LIFT * size * normal).astype(np.float32)


def scale(values: Array, *, high: bool, limits: tuple[float | None, float | None]) -> Scale | None:
    """Steps that suit values; None where there are none.

    The least and the largest are those of the measure where it has such, else nearly those found:
    a few extremes next to a singularity do not take the colours from all the others.
    """
    known = values[np.isfinite(values)]
    if not known.size:
        return None
    low, top = (float(v) for v in np.percentile(known, [1.0, 95.0]))
    low = limits[0] if limits[0] is not None else low
    if limits[1] is not None and not high:
        top = limits[1]
    if not top - low > 1e-12 * max(abs(low), abs(top), 1e-280):
        top = low + max(abs(low), 1.0) * 1e-6
    return Scale(np.linspace(low, top, STEPS + 1), high)


def shaded(solid: BuiltSolid, values: Array, steps: Scale, bare: str) -> tuple[Coat, ...]:
    """Painted by values (V,) at the shaded mesh's vertices; ``bare`` where they are NaN."""
    mesh = solid.shaded
    vertices = lifted(mesh.vertices, mesh.faces)
    corners, at = vertices[mesh.faces], values[mesh.faces]
    known = np.isfinite(at).all(axis=1)
    coats = []
    if not known.all():
        coats.append(_part(vertices, mesh.faces[~known], bare, MEASURE))
    triangles = np.concatenate([corners, at[:, :, None]], axis=2)[known].astype(float)
    edges = steps.edges.copy()
    edges[0], edges[-1] = -np.inf, np.inf
    for n in range(STEPS):
        inside = _clipped(_clipped(triangles, edges[n], 1.0), edges[n + 1], -1.0)
        if len(inside):
            flat = inside[:, :, :3].reshape(-1, 3).astype(np.float32)
            used, faces = np.unique(flat, axis=0, return_inverse=True)
            packed = faces.reshape(-1, 3).astype(np.uint32)
            coats.append(Coat(steps.color(n), used, packed, MEASURE))
    return tuple(coats)


def _clipped(triangles: Array, level: float, side: float) -> Array:
    """What of triangles (T, 3, 4), the last column their values, has side × (value − level) ≥ 0."""
    if not np.isfinite(level):
        return triangles
    over = side * (triangles[:, :, 3] - level)
    count = (over >= 0.0).sum(axis=1)
    kept = [triangles[count == 3]]
    for inside in (1, 2):
        chosen = count == inside
        some, height = triangles[chosen], over[chosen]
        if not len(some):
            continue
        # Turn each so that its odd corner comes first.
        odd = (height >= 0.0) if inside == 1 else (height < 0.0)
        order = (odd.argmax(axis=1)[:, None] + np.arange(3)) % 3
        some = np.take_along_axis(some, order[:, :, None], axis=1)
        height = np.take_along_axis(height, order, axis=1)
        a, b, c = some[:, 0], some[:, 1], some[:, 2]
        ab = a + (height[:, 0] / (height[:, 0] - height[:, 1]))[:, None] * (b - a)
        ac = a + (height[:, 0] / (height[:, 0] - height[:, 2]))[:, None] * (c - a)
        if inside == 1:
            kept.append(np.stack([a, ab, ac], axis=1))
        else:
            kept += [np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)]
    return np.concatenate(kept)


def _part(
    vertices: NDArray[Any],
    faces: NDArray[Any],
    color: str,
    shells: Shells,
    piece: int | None = None,
) -> Coat:
    used, packed = np.unique(faces, return_inverse=True)
    whole = packed.reshape(-1, 3).astype(np.uint32)
    return Coat(color, _float(vertices[used]), whole, shells, piece)


def _float(vertices: NDArray[Any]) -> NDArray[np.float32]:
    return vertices.astype(np.float32, copy=False)


def below(
    vertices: NDArray[np.float32], faces: NDArray[np.uint32], normal: Array, at: float
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Of triangles what is on the lower side of a plane: normal · vertex ≤ at."""
    height = vertices.astype(float) @ normal
    low = height[faces] <= at
    count = low.sum(axis=1)
    whole, cut = faces[count == 3], faces[(count > 0) & (count < 3)]
    corners = np.concatenate([vertices[cut].astype(float), height[cut][:, :, None]], axis=2)
    rest = _clipped(corners, at, -1.0)[:, :, :3].reshape(-1, 3)
    new = (len(vertices) + np.arange(len(rest))).reshape(-1, 3)
    return (
        np.concatenate([vertices, rest]).astype(np.float32),
        np.concatenate([whole, new]).astype(np.uint32),
    )


def below_lines(lines: NDArray[np.float32], normal: Array, at: float) -> NDArray[np.float32]:
    """Of segments (N, 2, 3) what is there."""
    height = lines.astype(float) @ normal - at
    kept = (height <= 0.0).any(axis=1)
    ends, height = lines[kept].astype(float), height[kept]
    share = height[:, 0] / np.where(height[:, 0] == height[:, 1], 1.0, height[:, 0] - height[:, 1])
    middle = ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0])
    clipped = np.where((height > 0.0)[:, :, None], middle[:, None], ends)
    return clipped.astype(np.float32)
