"""The constant-orientation workspace as a solid, for all working modes or for any set of them.

In the turned frame, p' = R_y(−θ) p lies in the workspace iff p' − w'_i ∈ B_i for all limbs,
w'_i = R_y(−θ) r_i − R_x(φ) s'_i (Tale Masouleh et al. 2011, eq. 27): five solids that never
change, moved and intersected. Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from kinematics.errors import InputError
from kinematics.facets.solids import SURFACES, Resolution, SurfaceKind
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import chosen
from kinematics.mechanisms.five_rpur.offsets import merged_limbs
from kinematics.mechanisms.five_rpur.workspace.booleans import products, riders, united
from kinematics.mechanisms.five_rpur.workspace.true_surface import true_surface
from kinematics.mechanisms.five_rpur.workspace.vertex_space import (
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
    choices, together = products(chosen(design, modes)), riders(design)
    last = None
    for same in _MERGED:
        limbs = merged_limbs(design, phi, theta, same)
        stands = np.column_stack([limbs.offset, limbs.link, limbs.stroke])
        if last is not None and np.array_equal(stands, last):
            continue
        last = stands
        try:
            return build(united(stands, together, choices, resolution), limbs.moved)
        except LeakError:
            pass
    raise LeakError


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
    place = offset[patch_of].T
    a, b, c = (
        corner - place
        for corner in meshes.corners(traced.mesh.vertices, traced.mesh.faces[curved], np.zeros(3))
    )
    normal_x, _, normal_z = meshes.cross(b - a, c - a) / 2.0
    x, y, z = (_POINTS @ np.stack([a[n], b[n], c[n]]) for n in range(3))
    side = sign[patch_of]
    z = np.where(side == 0.0, 0.0, z - side * shear(y, link[patch_of]))
    distance = np.maximum(np.sqrt(x * x + z * z), 1e-300)
    gap = radius[patch_of] - distance
    across = gap * (normal_x * x + normal_z * z) / distance
    swept = _WEIGHTS @ across
    everywhere = _WEIGHTS @ np.abs(across)
    lost = np.abs(gap).max(axis=0) > _LOST * deviation
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
    own = (3.0 * deviation) ** 3
    if moved > 0.0:
        twice = meshes.face_parts(traced.mesh.vertices, traced.mesh.faces)[1]
        own += moved * 0.5 * float(twice.sum())
    return 1.25 * first + second_order + own
