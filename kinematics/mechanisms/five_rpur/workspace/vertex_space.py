"""The vertex space B_i of one RPUR limb, where O' may be as far as that limb is concerned.

In the turned frame x'y'z' (R_y(−θ) of the base frame) and about A_i, B is the same solid for
every orientation: the Minkowski sum of the annulus ρ_min … ρ_max in x'z' and the circle of
radius l in y'z' (a thick Bohemian dome; Tale Masouleh et al. 2011, section 4, Figs. 9-13). In
the plane y the circle has the two points z = ±h(y), h = sqrt(l² − y²): one for each working
mode σ of the limb. So everything here is made of straight prisms along y, sheared by
z ↦ z + σ h(y):

- D^σ(r): the disc of radius r, sheared; B^σ = D^σ(ρ_max) − D^σ(ρ_min) and B = B⁺ ∪ B⁻;
- the main body: what lies between and in D⁺(ρ_max) and D⁻(ρ_max), along z;
- H1 = body − D⁺(ρ_max) − D⁻(ρ_max), H2 = D⁺(ρ_min) ∩ D⁻(ρ_min),
  H3 = D⁺(ρ_min) − D⁻(ρ_max) and its mirror: B = body − H1 − H2 − H3.

The meshes are made to be right on the average rather than inscribed, see `_ring` and
`_stations`: intersections of such solids lose most of the usual error of volume.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.solids import RESOLUTIONS, Resolution
from kinematics.solids.csg import Solid
from kinematics.solids.meshes import fine_step

Part = Literal["whole", "plus", "minus", "body", "H1", "H2", "H3"]
PARTS: tuple[Part, ...] = get_args(Part)

# Ring segments and sweep segments of a limb with ρ_max / l = 8/3, the paper's.
_STEPS: dict[Resolution, tuple[float, float]] = {
    "preview": (20, 10),
    "normal": (48, 20),
    "fine": (128, 40),
}
_PROPORTION = 8.0 / 3.0

# An inner circle smaller than this part of the outer one is none: no file could hold its facets.
_NO_CIRCLE = 1e-5

# Stations crowd towards y = ±l, where h(y) is steep; the exponent was found by trial.
_CROWDING = 1.4


@dataclass(frozen=True, slots=True)
class Surface:
    """What a face of a limb's solid stands for, about A_i in the turned frame.

    Attributes:
        kind: "arc", x² + (z − σ h(y))² = radius²; "side", |x| = radius; "end", |y| = link.
        radius: mm.
        sign: σ.
    """

    kind: Literal["arc", "side", "end"]
    radius: float
    sign: int
    link: float


def shear(y: Array, link: float | Array) -> Array:
    """h(y) = sqrt(l² − y²), mm, 0 beyond |y| = l."""
    return np.asarray(np.sqrt(np.maximum((link - y) * (link + y), 0.0)))


def limb_solid(
    link: float, rho_min: float, rho_max: float, part: str, resolution: Resolution
) -> Solid:
    """One limb's vertex space or a part of it, about A_i in the turned frame x'y'z'.

    Args:
        rho_min: mm, may be 0, and is taken as 0 below a hundred-thousandth of ``rho_max``.
        part: one of `PARTS`; "plus" and "minus" are B⁺ and B⁻, "H3" is both upper and lower.

    Raises:
        InputError: an unknown part or resolution, or lengths that make no limb.
    """
    if part not in PARTS:
        raise InputError(f"there is no part {part!r} of a vertex space; use {', '.join(PARTS)}")
    if resolution not in RESOLUTIONS:
        raise InputError(f"there is no resolution {resolution!r}; use {', '.join(RESOLUTIONS)}")
    if not (0 < link < np.inf and 0 <= rho_min < rho_max < np.inf):
        raise InputError(
            "a limb needs a link longer than 0 and a stroke 0 <= rho_min < rho_max, "
            f"got link {link:g} and stroke {rho_min:g} to {rho_max:g} mm"
        )
    if rho_min < _NO_CIRCLE * rho_max:
        rho_min = 0.0
    return _part(float(link), float(rho_min), float(rho_max), part, resolution)


@lru_cache(maxsize=256)
def _part(link: float, rho_min: float, rho_max: float, part: str, step: Resolution) -> Solid:
    def disc(radius: float, sign: int) -> Solid:
        if radius == 0.0:
            return Solid.union(())
        return _disc(link, radius, sign, *segments(link, rho_max, step))

    match part:
        case "plus" | "minus":
            sign = 1 if part == "plus" else -1
            return _tube(link, rho_min, rho_max, sign, *segments(link, rho_max, step))
        case "body":
            return _body(link, rho_max, *segments(link, rho_max, step))
        case "H1":
            body = _part(link, rho_min, rho_max, "body", step)
            return body.difference((disc(rho_max, 1), disc(rho_max, -1)))
        case "H2":
            return Solid.intersection((disc(rho_min, 1), disc(rho_min, -1)))
        case "H3":
            return Solid.union(
                disc(rho_min, sign).difference((disc(rho_max, -sign),)) for sign in (1, -1)
            )
        case _:
            return Solid.union(_part(link, rho_min, rho_max, s, step) for s in ("plus", "minus"))


def segments(link: float, rho_max: float, resolution: Resolution) -> tuple[int, int]:
    """How many segments the rings and the sweep have.

    A limb with a long link has more sweep and fewer ring segments: the deviation ρ/N² of the
    one is kept in proportion to l/M² of the other.
    """
    around, along = _STEPS[resolution]
    stretch = float(np.clip(rho_max / link / _PROPORTION, 1 / 256, 256)) ** 0.25
    return 4 * max(3, round(around * stretch / 4)), 2 * max(3, round(along / stretch / 2))


def deviation(link: float, rho_max: float, resolution: Resolution) -> float:
    """How far a limb's mesh is from its surface at most, roughly, mm."""
    around, along = segments(link, rho_max, resolution)
    ring = rho_max * (np.pi / around) ** 2 / 2.0
    return float(ring + link * (np.pi * _CROWDING / along) ** 2 / 8.0)


# --- meshes ------------------------------------------------------------------------------------


def _ring(radius: float, count: int) -> Array:
    """A polygon (count, 2) about the origin whose area is the circle's: right on the average."""
    angle = 2.0 * np.pi * np.arange(count) / count
    scale = np.sqrt((2.0 * np.pi / count) / np.sin(2.0 * np.pi / count))
    ring: Array = radius * scale * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # Exactly on the axes and exactly symmetric, so that the two working modes match.
    quarter = count // 4
    ring[quarter, 0] = ring[3 * quarter, 0] = ring[0, 1] = ring[2 * quarter, 1] = 0.0
    ring[quarter + 1 : 3 * quarter, 0] = -ring[2 * quarter - np.arange(quarter + 1, 3 * quarter), 0]
    ring[2 * quarter + 1 :, 1] = -ring[2 * quarter - 1 : 0 : -1, 1]
    return ring


@lru_cache(maxsize=64)
def _stations(link: float, count: int) -> tuple[Array, Array]:
    """Where the sweep stands: y (count + 1,) from −l to l, and the h to use there.

    The polyline through (y, h) is the least-squares fit to the half ellipse h(y) that is 0 at
    both ends. Its error is orthogonal to every piecewise linear function on the stations: what
    a volume sees of it cancels.
    """
    from scipy.linalg import solve_banded

    u = np.linspace(-1.0, 1.0, count + 1)
    beta = np.pi / 2.0 * (1.0 + np.sign(u) * (1.0 - (1.0 - np.abs(u)) ** _CROWDING))
    y = -np.cos(beta)
    y = (y - y[::-1]) / 2.0
    # In units of l: ∫ h dy and ∫ y h dy over each segment, with y = −cos β and h = sin β.
    area = np.diff(beta / 2.0 - np.sin(2.0 * beta) / 4.0)
    moment = np.diff(-(np.sin(beta) ** 3) / 3.0)
    width = np.diff(y)
    right = (moment - y[:-1] * area) / width
    left = area - right
    band = np.zeros((3, count - 1))
    band[0, 1:] = band[2, :-1] = width[1:-1] / 6.0
    band[1] = (width[:-1] + width[1:]) / 3.0
    h = np.zeros(count + 1)
    h[1:-1] = solve_banded((1, 1), band, right[:-1] + left[1:])
    h = (h + h[::-1]) / 2.0
    y, h = link * y, link * h
    y.setflags(write=False)
    h.setflags(write=False)
    return y, h


class _Faces:
    """Faces being collected, with the plane and the surface that each belongs to."""

    def __init__(self) -> None:
        self.faces: list[NDArray[np.int64]] = []
        self.planes: list[NDArray[np.int64]] = []
        self.patches: list[NDArray[np.int64]] = []
        self.tags: list[Surface] = []
        self._next = 0

    def quads(self, near: NDArray[np.int64], far: NDArray[np.int64], tag: Surface) -> None:
        """Strips between rows of vertices (M, n): near[:, :-1] and near[:, 1:] to ``far``'s.

        Each quad is a parallelogram. It is a triangle where two of its corners are one.
        """
        a, b, c, d = (v.ravel() for v in (near[:, :-1], near[:, 1:], far[:, :-1], far[:, 1:]))
        plane = np.arange(len(a))
        self._add(np.stack([a, c, b], 1), plane, tag)
        self._add(np.stack([b, c, d], 1), plane, tag, same=True)
        self._next += len(a)

    def flat(self, faces: NDArray[np.int64], tag: Surface) -> None:
        """Faces in one plane."""
        self._add(faces, np.zeros(len(faces), np.int64), tag)
        self._next += 1

    def _add(
        self,
        faces: NDArray[np.int64],
        plane: NDArray[np.int64],
        tag: Surface,
        *,
        same: bool = False,
    ) -> None:
        if not same:
            self.tags.append(tag)
        a, b, c = faces.T
        real = (a != b) & (b != c) & (c != a)
        self.faces.append(faces[real])
        self.planes.append(self._next + plane[real])
        self.patches.append(np.full(int(real.sum()), len(self.tags) - 1))

    def solid(self, vertices: Array) -> Solid:
        step = fine_step(float(np.abs(vertices).max()))  # as the places that it is moved to
        return Solid.from_mesh(
            np.round(vertices / step) * step + 0.0,
            np.concatenate(self.faces),
            patch=np.concatenate(self.patches),
            plane=np.concatenate(self.planes),
            tags=self.tags,
        )


def _sheared(ring: Array, y: Array, shift: Array) -> Array:
    """A ring (n, 2) in x'z' at every station: (stations × n, 3)."""
    points = np.empty((len(y), len(ring), 3))
    points[..., 0] = ring[:, 0]
    points[..., 1] = y[:, None]
    points[..., 2] = ring[:, 1] + shift[:, None]
    return points.reshape(-1, 3)


def _rows(start: int, stations: int, count: int) -> NDArray[np.int64]:
    """Indices of closed rings: (stations, count + 1), the first vertex again at the end."""
    index = start + np.arange(stations * count).reshape(stations, count)
    return np.concatenate([index, index[:, :1]], axis=1)


def _fan(loop: NDArray[np.int64]) -> NDArray[np.int64]:
    """A convex polygon as triangles."""
    inner = np.arange(1, len(loop) - 1)
    return np.stack([np.full(len(inner), loop[0]), loop[inner], loop[inner + 1]], 1)


def _disc(link: float, radius: float, sign: int, around: int, along: int) -> Solid:
    """D^σ(r): a disc sheared along y."""
    y, h = _stations(link, along)
    rows = _rows(0, along + 1, around)
    end = Surface("end", radius, sign, link)
    faces = _Faces()
    faces.quads(rows[:-1], rows[1:], Surface("arc", radius, sign, link))
    faces.flat(_fan(rows[0, :-1]), end)
    faces.flat(_fan(rows[-1, :-1])[:, ::-1], end)
    return faces.solid(_sheared(_ring(radius, around), y, sign * h))


def _tube(link: float, rho_min: float, rho_max: float, sign: int, around: int, along: int) -> Solid:
    """B^σ: the annulus sheared along y."""
    if rho_min == 0.0:
        return _disc(link, rho_max, sign, around, along)
    y, h = _stations(link, along)
    outer = _rows(0, along + 1, around)
    inner = _rows(outer.size - len(outer), along + 1, around)
    end = Surface("end", rho_max, sign, link)
    faces = _Faces()
    for near, far, radius in (
        (outer[:-1], outer[1:], rho_max),
        (inner[1:], inner[:-1], rho_min),
    ):
        faces.quads(near, far, Surface("arc", radius, sign, link))
    for k, (first, second) in ((0, (inner, outer)), (-1, (outer, inner))):
        a, b = first[k, :-1], first[k, 1:]
        c, d = second[k, :-1], second[k, 1:]
        faces.flat(np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)]), end)
    points = [_sheared(_ring(r, around), y, sign * h) for r in (rho_max, rho_min)]
    return faces.solid(np.concatenate(points))


def _body(link: float, rho_max: float, around: int, along: int) -> Solid:
    """The main body: D⁺(ρ_max), D⁻(ρ_max) and all between them along z."""
    y, h = _stations(link, along)
    ring = _ring(rho_max, around)
    half = around // 2
    # The upper and the lower half ring, each with both its ends; at y = ±l they share these.
    upper, lower = ring[: half + 1], np.concatenate([ring[half:], ring[:1]])
    points = np.concatenate([_sheared(upper, y, h), _sheared(lower, y, -h)])
    count = (along + 1) * (half + 1)
    up = np.arange(count).reshape(along + 1, half + 1)
    down = up + count
    for k in (0, -1):
        down[k, 0], down[k, -1] = up[k, -1], up[k, 0]
    faces = _Faces()
    faces.quads(up[:-1], up[1:], Surface("arc", rho_max, 1, link))
    faces.quads(down[:-1], down[1:], Surface("arc", rho_max, -1, link))
    left = np.stack([up[:, -1], down[:, 0]], axis=1)
    right = np.stack([down[:, -1], up[:, 0]], axis=1)
    side = Surface("side", rho_max, 1, link)
    faces.quads(left[:-1], left[1:], side)
    faces.quads(right[:-1], right[1:], side)
    loops = [np.concatenate([up[k], down[k, 1:-1]]) for k in (0, -1)]
    end = Surface("end", rho_max, 1, link)
    faces.flat(_fan(loops[0]), end)
    faces.flat(_fan(loops[1])[:, ::-1], end)
    used, packed = np.unique(np.concatenate(faces.faces), return_inverse=True)
    faces.faces = [packed.reshape(-1, 3)]
    return faces.solid(points[used])
