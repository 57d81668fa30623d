"""What dependent lines have in common: the linear line varieties of Grassmann, and screws.

Wrenches are rows [F, T about a reference point], forces along lines or couples (lines at
infinity); twists are [ω, v of that point]. Which variety lines span, the form F₁·T₂ + F₂·T₁ tells
on their span, or on the twists that are reciprocal to it (Merlet, Int. J. Robotics Research 8
(1989)). Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.screws.spatial import cross_matrix
from kinematics.screws.wrenches import normalised

Vector = tuple[float, float, float]

VarietyKind = Literal[
    "zero",  # rank 0: a wrench that vanishes
    "line",  # rank 1: lines that coincide
    "couple",  # couples about parallel axes
    "pencil",  # rank 2: in one plane and through one point of it
    "parallel pencil",  # in one plane and parallel; of couples, those normal to it
    "couples",  # couples parallel to one plane
    "bundle",  # rank 3: through one point
    "parallel bundle",  # parallel lines; of couples, those normal to them
    "plane",  # in one plane; of couples, those normal to it
    "all couples",
    "two pencils",  # of two pencils that share a line
    "regulus",  # rulings of a hyperboloid of one sheet
    "paraboloid",  # rulings of a hyperbolic paraboloid
    "hyperbolic congruence",  # rank 4: meeting two lines
    "elliptic congruence",  # meeting two imaginary lines
    "parabolic congruence",  # meeting one line, of a pencil for each point of it
    "degenerate congruence",  # in one plane, or through one point of it
    "special complex",  # rank 5: meeting one line
    "general complex",  # reciprocal to a screw
    "screws",  # no variety of lines: some wrenches have a pitch
    "space",  # rank 6
]

EXACT = 1e-7
"""Singular values below this are zero but for rounding, whatever a caller's tolerance."""
FLAT = 1e-6
"""The form is zero below this, of its largest possible value."""
_COARSE = 0.05  # the same at most, however inexact a span is
_FAR = 1e6  # characteristic lengths; an axis further off is a direction


@dataclass(frozen=True, slots=True)
class Screw:
    """The axis of a twist: a turn, a translation or both; it has no size.

    Attributes:
        direction: unit vector, of ω, or of v of a translation.
        point: mm, the axis's nearest point to the reference point; None of a translation.
        pitch: mm/rad; 0 of a turn, infinite of a translation.
    """

    direction: Vector
    point: Vector | None
    pitch: float

    @property
    def translation(self) -> bool:
        return self.point is None


@dataclass(frozen=True, slots=True)
class Variety:
    """What some dependent lines have in common.

    Attributes:
        kind: which linear line variety they span.
        point: mm, where they meet, or a point of their plane.
        direction: unit vector along lines that are parallel.
        normal: unit vector, of their plane.
        axes: the lines that all of them meet; of two pencils the shared line; of a general
            complex the axis and pitch. A translation among them is a line at infinity: all are
            normal to its direction.
    """

    kind: VarietyKind
    point: Vector | None = None
    direction: Vector | None = None
    normal: Vector | None = None
    axes: tuple[Screw, ...] = ()


def screw(twist: ArrayLike, length: float, point: Sequence[float] | Array) -> Screw:
    """The axis of a twist [ω, v of ``point``]; pitches below 1e-6 of ``length`` are zero."""
    t = np.asarray(twist, dtype=float)
    turning, moving = t[:3], t[3:]
    turn, move = float(np.linalg.norm(turning)), float(np.linalg.norm(moving))
    if turn * length * _FAR <= move:
        return Screw(_vector(_upright(moving / move)), None, np.inf)
    pitch = float(turning @ moving) / turn**2
    foot = np.asarray(point, dtype=float) + np.cross(turning, moving) / turn**2
    # Pitch counts beside the lever that the twist has about the point, not only beside the length.
    scale = max(length, move / turn)
    pitch = 0.0 if abs(pitch) <= FLAT * scale else pitch
    return Screw(_vector(_upright(turning / turn)), _vector(foot), pitch)


def variety(
    rows: ArrayLike,
    length: float,
    point: Sequence[float] | Array = (0.0, 0.0, 0.0),
    *,
    rank: int | None = None,
    blur: float = 0.0,
) -> Variety:
    """The linear line variety that wrenches (R, 6) span.

    Args:
        rank: of the rows; by default what their singular values say, to `EXACT`.
        blur: how inexact the span is, as a part; coarsens what counts as zero.
    """
    origin = np.asarray(point, dtype=float)
    center, reach = _middle(np.asarray(rows, dtype=float), length, origin)
    # The same wrenches about a point amidst the lines and in their size: there the form is even.
    unit = normalised(_moved(np.asarray(rows, dtype=float), origin - center), reach)
    values, right = spectrum(unit)
    rank = int((values >= EXACT).sum()) if rank is None else rank
    flat = min(max(FLAT, blur), _COARSE)
    if rank <= 0:
        return Variety("zero")
    if rank > 5:
        return Variety("space")
    # Three dependent lines are of a pencil, however nearly: only wrenches with a pitch are not.
    straight = bool((np.abs((unit[:, :3] * unit[:, 3:]).sum(axis=1)) <= FLAT).all())
    common = (
        _few(right[:rank], rank, reach, center, 1.0 if rank == 2 and straight else flat, flat)
        if rank <= 3
        else _many(right[rank:], rank, reach, center, flat)
    )
    return replace(common, axes=tuple(_footed(axis, origin) for axis in common.axes))


def spectrum(unit: Array) -> tuple[Array, Array]:
    """Singular values, R or 6 of them whichever is less, and all six right singular vectors."""
    _, values, right = np.linalg.svd(unit, full_matrices=True)
    return values, right


# --- from the span, or from what is reciprocal to it ---------------------------------------


def _form(basis: Array) -> Array:
    """F₁·T₂ + F₂·T₁ of all pairs of basis wrenches (or of twists, with [v, ω])."""
    product = basis[:, :3] @ basis[:, 3:].T
    return product + product.T


def _few(
    basis: Array, rank: int, length: float, center: Array, flat: float, thin: float
) -> Variety:
    """Ranks 1 to 3, from the span itself; ``thin``: below this there are no forces in it."""
    form = _form(basis)
    values, vectors = np.linalg.eigh(form)
    zero = np.abs(values) <= flat
    _, sizes, directions = np.linalg.svd(basis[:, :3], full_matrices=True)
    finite = int((sizes > thin).sum())
    if not zero.all():
        return _quadric(basis, values, vectors, zero, finite, rank, length, center)
    if finite == 0:
        kinds: tuple[VarietyKind, ...] = ("couple", "couples", "all couples")
        normal = _last_normal(basis[:, 3:]) if rank == 2 else None
        along = _vector(_upright(basis[0, 3:])) if rank == 1 else None
        return Variety(kinds[rank - 1], direction=along, normal=normal)
    first = _upright(directions[0])
    if rank == 1:
        return Variety("line", point=_meet(basis, length, center), direction=_vector(first))
    if finite == 1:
        if rank == 3:
            return Variety("parallel bundle", direction=_vector(first))
        return Variety(
            "parallel pencil",
            point=_meet(basis, length, center),
            direction=_vector(first),
            normal=_vector(_upright(_couple_of(basis))),
        )
    plane = np.cross(directions[0], directions[1])
    if finite == 2 and rank == 3:
        across = np.cross(plane, basis[:, :3])
        distance = float((across * basis[:, 3:]).sum() / (across**2).sum()) * length
        return Variety(
            "plane",
            point=_vector(center + distance * plane),
            normal=_vector(_upright(plane)),
        )
    place = _meet(basis, length, center)
    if rank == 2:
        return Variety("pencil", point=place, normal=_vector(_upright(plane)))
    return Variety("bundle", point=place)


def _quadric(
    basis: Array,
    values: Array,
    vectors: Array,
    zero: Array,
    finite: int,
    rank: int,
    length: float,
    center: Array,
) -> Variety:
    """Rank 2 or 3 where not every member of the span is a line."""
    mixed = values[0] < 0.0 < values[-1]
    if rank == 3 and mixed and not zero.any():
        return Variety("regulus" if finite == 3 else "paraboloid")
    if rank == 3 and mixed and int(zero.sum()) == 1:
        shared = vectors[:, int(np.flatnonzero(zero)[0])] @ basis
        line = np.concatenate([shared[:3], shared[3:] * length])
        return Variety("two pencils", axes=(screw(line, length, center),))
    return Variety("screws")


def _many(null: Array, rank: int, length: float, center: Array, flat: float) -> Variety:
    """Ranks 4 and 5, from the reciprocal twists [v, ω length]."""
    if rank == 5:
        axis = _axis(null[0], length, center)
        pure = abs(float(_form(null)[0, 0])) <= flat
        if pure and not axis.translation:
            axis = Screw(axis.direction, axis.point, 0.0)
        return Variety("special complex" if pure else "general complex", axes=(axis,))
    values, vectors = np.linalg.eigh(_form(null))
    zero = np.abs(values) <= flat
    if zero.all():
        _, sizes, directions = np.linalg.svd(null[:, 3:], full_matrices=True)
        turning = int((sizes > flat).sum())
        pencil = np.concatenate([null[:, 3:], null[:, :3]], axis=1)  # axes as lines [ω, v]
        if turning == 2:
            normal = np.cross(directions[0], directions[1])
            place: Vector | None = _meet(pencil, length, center)
        elif turning == 1:
            normal, place = _couple_of(pencil), _meet(pencil, length, center)
        else:
            normal, place = np.cross(null[0, :3], null[1, :3]), None
            normal = normal / np.linalg.norm(normal)
        return Variety(
            "degenerate congruence",
            point=place,
            direction=_vector(_upright(directions[0])) if turning == 1 else None,
            normal=_vector(_upright(normal)),
        )
    if zero.any():
        double = vectors[:, int(np.flatnonzero(zero)[0])] @ null
        return Variety("parabolic congruence", axes=(_axis(double, length, center, pure=True),))
    if values[0] < 0.0 < values[-1]:
        axes = tuple(_axis(t, length, center, pure=True) for t in isotropic(null, flat))
        return Variety("hyperbolic congruence", axes=axes)
    return Variety("elliptic congruence")


def isotropic(pair: Array, flat: float) -> list[Array]:
    """The two real members of zero pitch in the span of two; fewer where they are not real."""
    values, vectors = np.linalg.eigh(_form(pair))
    if not values[0] < -flat < flat < values[1]:
        return []
    low, high = np.sqrt(values[1]), np.sqrt(-values[0])
    answer = []
    for sign in (1.0, -1.0):
        member = (low * vectors[:, 0] + sign * high * vectors[:, 1]) @ pair
        answer.append(member / np.linalg.norm(member))
    return answer


def _footed(axis: Screw, origin: Array) -> Screw:
    """The same axis by its nearest point to the reference point."""
    if axis.point is None:
        return axis
    along, place = np.array(axis.direction), np.array(axis.point)
    return replace(axis, point=_vector(place + ((origin - place) @ along) * along))


def _axis(null: Array, length: float, center: Array, *, pure: bool = False) -> Screw:
    """The screw of a twist given as [v, ω length]; ``pure``: its pitch is zero but for rounding."""
    found = screw(np.concatenate([null[3:] / length, null[:3]]), length, center)
    if pure and not found.translation:
        return Screw(found.direction, found.point, 0.0)
    return found


# --- points, planes, frames ----------------------------------------------------------------


def _middle(rows: Array, length: float, origin: Array) -> tuple[Array, float]:
    """A point amidst the lines, and how far they are from it, at least ``length``."""
    force, moment = rows[:, :3], rows[:, 3:]
    size = np.linalg.norm(force, axis=1)
    real = size > 1e-9 * np.maximum(np.linalg.norm(moment, axis=1) / length, 1e-300)
    if not real.any():
        return origin, length
    along = force[real] / size[real, None]
    feet = np.cross(force[real], moment[real]) / size[real, None] ** 2
    across = np.eye(3) - along[:, :, None] * along[:, None, :]
    pull = 1e-3 * len(feet)  # keeps it near where lines are nearly parallel
    matrix = across.sum(axis=0) + pull * np.eye(3)
    center = np.linalg.solve(matrix, (across @ feet[..., None])[..., 0].sum(axis=0))
    away = np.einsum("nij,nj->ni", across, feet - center)
    reach = float(np.sqrt((away**2).sum(axis=1).mean()))
    return origin + center, max(reach, length)


def _moved(rows: Array, shift: Array) -> Array:
    """Moments about a point that lies −shift from the old one: T + shift × F."""
    return np.concatenate([rows[:, :3], rows[:, 3:] + np.cross(shift, rows[:, :3])], axis=1)


def _meet(basis: Array, length: float, center: Array) -> Vector:
    """The point c of least size with c × F = T for all, mm."""
    force, moment = basis[:, :3], basis[:, 3:]
    matrix = -cross_matrix(force).reshape(-1, 3)
    place = np.linalg.lstsq(matrix, moment.ravel(), rcond=1e-6)[0]
    return _vector(center + length * place)


def _couple_of(basis: Array) -> Array:
    """The couple in a span of parallel lines: the normal of their plane, unit."""
    left, _, _ = np.linalg.svd(basis[:, :3], full_matrices=True)
    couple = (left[:, -1] @ basis)[3:]
    return np.asarray(couple / np.linalg.norm(couple))


def _last_normal(vectors: Array) -> Vector:
    _, _, right = np.linalg.svd(vectors, full_matrices=True)
    return _vector(_upright(right[-1]))


def _upright(direction: Array) -> Array:
    """The same line with its largest component positive."""
    return direction if direction[int(np.argmax(np.abs(direction)))] > 0.0 else -direction


def _vector(values: Array) -> Vector:
    x, y, z = (float(v) + 0.0 for v in values)
    return x, y, z
