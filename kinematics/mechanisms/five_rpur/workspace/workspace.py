"""The constant-orientation workspace as a solid, for all working modes or for any set of them.

In the turned frame, p' = R_y(−θ) p lies in the workspace iff p' − w'_i ∈ B_i for all limbs,
w'_i = R_y(−θ) r_i − R_x(φ) s'_i (Tale Masouleh et al. 2011, eq. 27): five solids that never
change, moved and intersected. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product

import numpy as np

from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.solids import SURFACES, Resolution, SurfaceKind
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import chosen
from kinematics.mechanisms.five_rpur.offsets import merged_limbs
from kinematics.mechanisms.five_rpur.workspace.true_surface import true_surface
from kinematics.mechanisms.five_rpur.workspace.vertex_space import (
    Part,
    Surface,
    deviation,
    limb_solid,
    shear,
)
from kinematics.solids import meshes
from kinematics.solids.csg import BuiltSolid, LeakError, PlacedMesh, Solid, TracedMesh, finish

# A piece thinner on the average than this part of the mesh's deviation (or of a short stroke)
# is as likely due to the facets as to the machine, and is not counted.
_RESOLVED = 0.25

# Limbs that differ by less than such a part of their size are made one, for facets of nearly equal
# solids cross in slivers that no grid of coordinates holds. The first is less than the grid's own
# step; the others are for where that did not lead to a closed surface.
_MERGED = (1e-7, 1e-6, 1e-5, 1e-4)

# How far chords of the true surface may sag, in deviations of the mesh: what keeps its volume,
# too small by the chords, as good as the resolution promises.
_SAG: dict[Resolution, float] = {"normal": 0.1, "fine": 0.06}


@dataclass(frozen=True, slots=True)
class _Operand:
    """One limb's solid where it stands: all that the intersection depends on."""

    link: float
    rho_min: float
    rho_max: float
    part: Part
    offset: tuple[float, float, float]


def workspace(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: Iterable[str] | None = None,
    resolution: Resolution = "normal",
    surface: SurfaceKind = "facets",
) -> BuiltSolid:
    """The constant-orientation workspace in x'y'z' (turn it by R_y(θ) for the base frame).

    Args:
        modes: working modes as "+-+++", of which any will do; None for all 32, ∩ B_i.
        surface: "facets", right on the average; or "true", every vertex on the exact surfaces
            that meet there and chords halved where they sag. A preview is of facets always.

    Raises:
        InputError: an angle that is not finite, a mode that is not five signs, or no such surface.
        ComputationError: manifold3d gave up, or the surface could not be closed.
    """
    if surface not in SURFACES:
        raise InputError(f"there is no surface {surface!r}; use {' or '.join(SURFACES)}")
    true = surface == "true" and resolution in _SAG

    def build(whole: Solid, moved: float) -> BuiltSolid:
        coarsest = coarseness(design, resolution)

        def place(mesh: TracedMesh, apart: float) -> PlacedMesh:
            placed = true_surface(mesh, coarsest, apart, _SAG[resolution] * coarsest)
            return replace(placed, residual=placed.residual + moved)

        return finish(
            whole,
            lambda mesh, volume: volume_error(mesh, volume, coarsest, moved),
            thinnest=thinnest(design, resolution),
            place=place if true else None,
        )

    return from_solid(design, phi, theta, modes, resolution, build)


def from_solid(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: Iterable[str] | None,
    resolution: Resolution,
    build: Callable[[Solid, float], BuiltSolid],
) -> BuiltSolid:
    """What is made of the workspace as it comes from the Booleans, see `workspace`.

    Limbs that are nearly equal are made equal, and more of them where the surface would leak.

    Args:
        build: takes the solid, and how far (mm) its surfaces are from where they should be.

    Raises:
        LeakError: the surface was not closed however boldly limbs were merged.
    """
    choices = _products(chosen(design, modes))
    last = None
    for same in _MERGED:
        limbs = merged_limbs(design, phi, theta, same)
        stands = np.column_stack([limbs.offset, limbs.link, limbs.stroke])
        if last is not None and np.array_equal(stands, last):
            continue
        last = stands
        try:
            return build(_raw(stands, choices, resolution), limbs.moved)
        except LeakError:
            pass
    raise LeakError


def _raw(stands: Array, choices: list[str], resolution: Resolution) -> Solid:
    """The union over some choices of signs of the intersections of the limbs' solids.

    ``stands`` (5, 6): w'_i, link and stroke, mm.
    """
    solids = []
    for choice in choices:
        operands = [
            _Operand(link, low, high, _CHOICE[sign], (x, y, z))
            for (x, y, z, link, low, high), sign in zip(stands.tolist(), choice, strict=True)
        ]
        solids.append(_intersection(operands, resolution))
    return solids[0] if len(solids) == 1 else Solid.union(solids)


def coarseness(design: FiveRPURDesign, resolution: Resolution) -> float:
    """How far the limbs' meshes are from their surfaces at most, roughly, mm."""
    return max(deviation(limb.link, limb.stroke[1], resolution) for limb in design.limbs)


def thinnest(design: FiveRPURDesign, resolution: Resolution) -> float:
    """The thickness below which a piece is more likely due to facets than to the machine, mm."""
    deviations = [deviation(limb.link, limb.stroke[1], resolution) for limb in design.limbs]
    strokes = (design.stroke[:, 1] - design.stroke[:, 0]).tolist()
    return _RESOLVED * float(min(*deviations, *strokes))


def limb_part(
    design: FiveRPURDesign, limb: int, part: str, resolution: Resolution = "normal"
) -> BuiltSolid:
    """The vertex space of a limb, or a part of it, about A_i in x'y'z'.

    It stands in the base frame by R_y(θ) · translation(w'_i).

    Args:
        limb: 1 to 5.
        part: one of `vertex_space.PARTS`.

    Raises:
        InputError: there is no such limb, part or resolution.
    """
    if limb not in range(1, LIMBS + 1):
        raise InputError(f"there is no limb {limb}; limbs are counted from 1 to {LIMBS}")
    chosen = design.limbs[limb - 1]
    return _built_part(chosen.link, *chosen.stroke, part, resolution)


@lru_cache(maxsize=64)
def _built_part(
    link: float, rho_min: float, rho_max: float, part: str, resolution: Resolution
) -> BuiltSolid:
    solid = limb_solid(link, rho_min, rho_max, part, resolution)
    coarsest = deviation(link, rho_max, resolution)
    return finish(solid, lambda mesh, volume: volume_error(mesh, volume, coarsest))


# --- Booleans ----------------------------------------------------------------------------------

_CHOICE: dict[str, Part] = {"+": "plus", "-": "minus", "*": "whole"}


def _intersection(operands: list[_Operand], resolution: Resolution) -> Solid:
    unique = dict.fromkeys(operands)
    # B ∩ B^σ = B^σ: where one limb stands in another, the whole adds nothing to the half.
    for one in list(unique):
        if one.part != "whole":
            unique.pop(replace(one, part="whole"), None)
    result: Solid | None = None
    for o in _far_first(list(unique)):
        solid = limb_solid(o.link, o.rho_min, o.rho_max, o.part, resolution).translated(o.offset)
        result = solid if result is None else Solid.intersection((result, solid))
        if result.is_empty:
            break
    return Solid.union(()) if result is None else result


def _far_first(operands: list[_Operand]) -> list[_Operand]:
    """Limbs that stand far apart first: what they share is small, and so are all later steps."""
    points = np.array([o.offset for o in operands])
    apart = np.linalg.norm(points[:, None] - points[None], axis=-1)
    order = [int(apart.max(axis=1).argmax())]
    while len(order) < len(operands):
        nearest = apart[order].min(axis=0)
        nearest[order] = -1.0
        order.append(int(nearest.argmax()))
    return [operands[n] for n in order]


def _products(modes: Iterable[str] | None) -> list[str]:
    """A set of modes as few products of choices a limb: "+", "-" or, for either, "*".

    The union over the modes is the union over these, each one intersection.
    """
    if modes is None:
        return ["*" * LIMBS]
    wanted = frozenset(modes)
    # The largest products first; each must bring a mode that is still missing.
    answer, missing = [], set(wanted)
    for choice in sorted(product("*+-", repeat=LIMBS), key=lambda c: -c.count("*")):
        if not missing:
            break
        members = {"".join(m) for m in product(*("+-" if c == "*" else c for c in choice))}
        if members <= wanted and members & missing:
            answer.append("".join(choice))
            missing -= members
    return answer


# --- the error of volume -------------------------------------------------------------------------

# Points and weights on a triangle, exact for polynomials of degree 4 (Dunavant 1985).
_A, _B = 0.445948490915965, 0.091576213509771
_POINTS = np.array(
    [
        *((1 - 2 * t, t, t) for t in (_A, _B)),
        *((t, 1 - 2 * t, t) for t in (_A, _B)),
        *((t, t, 1 - 2 * t) for t in (_A, _B)),
    ]
)
_LOST = 8.0  # deviations of the mesh: farther faces stand for other surfaces than theirs
_WEIGHTS = np.array([0.223381589678011, 0.109951743655322] * 3)


def _gaps(traced: TracedMesh, deviation: float) -> tuple[float, float, float]:
    """What lies between a mesh and the surfaces that it stands for.

    At constant y a face is moved along the radius of its circle onto that circle; the volume
    that it sweeps is ∫ (r − |q|) n·q/|q| dA, q = (x, z − σ h(y)) about the circle's centre.

    Returns:
        mm³: the sum with signs (true volume − mesh volume, to first order) or more than that where
        faces are many times the mesh's ``deviation`` (mm) from their surfaces, and have lost them;
        the sum of the faces' absolute values; and that of all points'.
    """
    radius, sign, link = (np.zeros(len(traced.patches)) for _ in range(3))
    offset = np.zeros((len(traced.patches), 3))
    for n, patch in enumerate(traced.patches):
        surface = patch.tag
        if isinstance(surface, Surface) and surface.kind != "end":
            # A flat side is an arc whose z does not count, told by sign 0.
            radius[n], link[n] = surface.radius, surface.link
            sign[n] = surface.sign if surface.kind == "arc" else 0.0
            offset[n] = patch.transform[:, 3]
    curved = radius[traced.patch_of] > 0.0
    patch_of = traced.patch_of[curved]
    a, b, c = (
        traced.mesh.vertices[traced.mesh.faces[curved, n]] - offset[patch_of] for n in range(3)
    )
    normal = np.cross(b - a, c - a) / 2.0
    x, y, z = (np.stack([a[:, n], b[:, n], c[:, n]], axis=1) @ _POINTS.T for n in range(3))
    side = sign[patch_of, None]
    z = np.where(side == 0.0, 0.0, z - side * shear(y, link[patch_of, None]))
    distance = np.maximum(np.hypot(x, z), 1e-300)
    across = (normal[:, :1] * x + normal[:, 2:] * z) / distance
    gap = radius[patch_of, None] - distance
    swept = (gap * across) @ _WEIGHTS
    everywhere = np.abs(gap * across) @ _WEIGHTS
    lost = np.abs(gap).max(axis=1) > _LOST * deviation
    signed = abs(float(swept[~lost].sum())) + float(np.abs(swept[lost]).sum())
    return signed, float(np.abs(swept).sum()), float(everywhere.sum())


def volume_error(traced: TracedMesh, volume: float, deviation: float, moved: float = 0.0) -> float:
    """An estimate from above of |true volume − mesh volume|, mm³.

    First order: the gaps between faces and surfaces, with signs. Second order: where surfaces
    meet, the gaps of both interact; the factors were found on a thousand random designs. (Whole
    faces have next to no gap on the whole: of one limb's own solid, and of nearly equal ones', only
    the gaps at points tell.) A piece no larger than some of the mesh's ``deviation`` (mm) may not
    have been meshed at all. Last, the surfaces themselves may have been ``moved`` (mm).
    """
    first, *second = _gaps(traced, deviation)
    second_order = 0.0
    for factor, absolute in zip((3.0, 0.03), second, strict=True):
        share = min(1.0, (absolute / volume) ** 0.5) if volume > 0.0 else 1.0
        second_order += factor * absolute * share
    area = 0.5 * float(meshes.face_parts(traced.mesh.vertices, traced.mesh.faces)[1].sum())
    return 1.25 * first + second_order + (3.0 * deviation) ** 3 + moved * area
