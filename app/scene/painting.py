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
from kinematics.arrays import Array

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

STEPS = 10
"""of a measure; each is a mesh."""
LIFT = 1e-3
"""of a solid's size, see `lifted`."""
PIECES = 10
"""that have a mesh, and so a colour, of their own; smaller ones share the last."""


@dataclass(frozen=True, eq=False, slots=True)
class Coat:
    """Triangles of one colour: ``vertices`` (V, 3) mm float32, ``faces`` (F, 3) uint32.

    ``opaque``: 1 for as opaque as the solid is to be; more stands out.
    """

    color: str
    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    opaque: float = 1.0


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


def plain(solid: BuiltSolid, color: str) -> tuple[Coat, ...]:
    """One colour."""
    mesh = solid.shaded
    return (Coat(color, _float(mesh.vertices), mesh.faces.astype(np.uint32, copy=False)),)


def piece_colors(signs: Sequence[int]) -> tuple[str, ...]:
    """A colour for each of a solid's pieces, from their signs."""
    seen: dict[int, int] = {}
    colors = []
    for n, sign in enumerate(signs):
        if n < PIECES:
            seen[sign] = seen.get(sign, -1) + 1
        colors.append(palette.aspect_color(sign, seen.get(sign, 0)))
    return tuple(colors)


def pieces(solid: BuiltSolid, *, locus: bool) -> tuple[Coat, ...]:
    """Each piece in its colour, and the singular surface between them if it is to be seen."""
    assert solid.piece_of is not None
    assert solid.on_locus is not None
    mesh = solid.shaded
    colors = piece_colors([piece.sign for piece in solid.pieces])
    owner = np.minimum(solid.piece_of, PIECES - 1)
    outside = ~solid.on_locus
    vertices = lifted(mesh.vertices, mesh.faces[outside])
    coats = [
        _part(vertices, mesh.faces[outside & (owner == n)], colors[n])
        for n in range(min(len(colors), PIECES))
    ]
    if locus:
        # Of both sides of the surface one is enough.
        signs = np.array([piece.sign for piece in solid.pieces])
        one = solid.on_locus & (signs[solid.piece_of] > 0)
        coats.append(_part(mesh.vertices, mesh.faces[one], palette.BEYOND, 1.6))
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
        coats.append(_part(vertices, mesh.faces[~known], bare))
    triangles = np.concatenate([corners, at[:, :, None]], axis=2)[known].astype(float)
    edges = steps.edges.copy()
    edges[0], edges[-1] = -np.inf, np.inf
    for n in range(STEPS):
        inside = _clipped(_clipped(triangles, edges[n], 1.0), edges[n + 1], -1.0)
        if len(inside):
            flat = inside[:, :, :3].reshape(-1, 3).astype(np.float32)
            used, faces = np.unique(flat, axis=0, return_inverse=True)
            coats.append(Coat(steps.color(n), used, faces.reshape(-1, 3).astype(np.uint32)))
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


def _part(vertices: NDArray[Any], faces: NDArray[Any], color: str, opaque: float = 1.0) -> Coat:
    used, packed = np.unique(faces, return_inverse=True)
    return Coat(color, _float(vertices[used]), packed.reshape(-1, 3).astype(np.uint32), opaque)


def _float(vertices: NDArray[Any]) -> NDArray[np.float32]:
    return vertices.astype(np.float32, copy=False)
