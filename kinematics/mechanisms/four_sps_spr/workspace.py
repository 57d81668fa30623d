"""Where p of the 4-SPS + 1-SPR can be while two angles are held and the third follows: a solid.

At each place the constraint leaves the third angle θ two values or none. One of the two branches
is followed; they meet where the constraint's derivative by θ vanishes, the fold, which bounds the
solid as the ends of the strokes do.

The planes of `plane` for all θ sweep through that solid: at θ, p lies in a plane that moves with
the speed −∂c/∂θ of the constraint c(p, θ) = m(θ)·(A_5 − p) − b_5·n6, |∇_p c| = 1. So its volume is
∫ dθ ∫ |∂c/∂θ| dA over the exact plane regions, in which ∂c/∂θ is linear: one quadrature, as exact
as wanted. The mesh is the intersection of isosurfaces, one for each stroke end and the fold, with
their vertices on the true surfaces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from kinematics.arrays import Array
from kinematics.facets.solids import Resolution
from kinematics.mechanisms.four_sps_spr import home
from kinematics.mechanisms.four_sps_spr.constraint import angle_terms, dependent_values
from kinematics.mechanisms.four_sps_spr.design import LIMBS, SPR, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.motion import angular_axes
from kinematics.mechanisms.four_sps_spr.plane import plane, rings
from kinematics.mechanisms.four_sps_spr.statics import legs
from kinematics.plane.annuli import Rings, rings_moments
from kinematics.screws.spatial import wrap_angle
from kinematics.solids.isosurfaces import positive_part

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid, TracedMesh

_CELLS: dict[Resolution, int] = {"preview": 16, "normal": 32, "fine": 64}
"""Along each side of the solid's box, were it a cube."""
_EXACT: dict[Resolution, float | None] = {"preview": None, "normal": 1e-4, "fine": 1e-5}
"""How exact the volume is that a mesh is compared with."""
_ROUGH = 0.01
_COARSE = 40  # cells of the search for that box
_EVEN, _PIECES = 144, 12  # of the turn: slices for a rough volume, and pieces to integrate
_STRAIGHT = 1e9  # mm: the radius of a circle that stands for a line
_FOLD = 1e-9  # of the machine's size: with ∂c/∂θ below that gradients are cut off


TAGS = ("fold", *((f"limb{i + 1}", end) for end in (0, 1) for i in range(LIMBS)))
"""Of the surfaces: the fold, the ends of the strokes, the shortest first."""


@dataclass(frozen=True, slots=True)
class Request:
    """A solid: the angles (rad), which of them follows (3, 4, 5), and its branch.

    Attributes:
        angles: α, β, γ; what stands at ``index`` does not matter.
        index: among the pose's coordinates.
        side: +1 or −1; −side is the sign of ∂c/∂θ.
    """

    angles: tuple[float, float, float]
    index: int
    side: int


def request_at(design: FourSPSSPRDesign, pose: tuple[float, ...], index: int) -> Request:
    """The solid that a pose lies in, or the branch with the angle nearest to the pose's.

    ``pose``: (6,) mm and rad; NaN at ``index`` is zero.
    """
    values = np.array(pose, dtype=float)
    near = 0.0 if np.isnan(values[index]) else float(values[index])
    values[:3] = np.where(np.isfinite(values[:3]), values[:3], home.home(design).pose[:3])
    both = dependent_values(design, values, index)
    if not np.isfinite(both).all():  # beyond the fold at this place: above the base as a rule
        values[:3] = home.home(design).pose[:3]
        both = dependent_values(design, values, index)
    away = np.abs(wrap_angle(np.nan_to_num(both, nan=near) - near))
    side = -1 if away[0] <= away[1] else 1
    angles = [float(v) for v in values[3:]]
    angles[index - 3] = 0.0
    a, b, c = angles
    return Request((a, b, c), index, side)


# --- the functions whose zeros bound the solid ---------------------------------------------


class _Branch:
    """θ(p) of one branch, and the legs there."""

    def __init__(self, design: FourSPSSPRDesign, request: Request) -> None:
        self.design, self.request = design, request

    def poses(self, points: Array) -> tuple[Array, Array]:
        """Poses (n, 6), θ stopped at the fold beyond it, and ∂c/∂θ (n,)."""
        poses = np.hstack([points, np.broadcast_to(self.request.angles, (len(points), 3))])
        a, b, c = angle_terms(self.design, poses, self.request.index)
        size = np.maximum(np.hypot(a, b), 1e-300)
        half = np.arccos(np.clip(c / size, -1.0, 1.0))
        poses[:, self.request.index] = np.arctan2(b, a) + self.request.side * half
        return poses, -self.request.side * size * np.sin(half)

    def lengths(self, points: Array) -> Array:
        """(n, 5) mm."""
        poses, _ = self.poses(points)
        return legs(self.design, poses).length

    def margins(self, points: Array) -> Array:
        """(n, 11) mm or alike: to the fold, and of every leg to both ends; all ≥ 0 in the solid."""
        at = self.lengths(points)
        fold, _ = self.fold(points)
        low, high = self.design.stroke.T
        return np.column_stack([fold, at - low, high - at])

    def margin(self, which: int) -> Callable[[Array], tuple[Array, Array]]:
        """One of the margins, (n,), with its gradient (n, 3)."""
        if which == 0:
            return self.fold
        limb, end = (which - 1) % LIMBS, 0 if which <= LIMBS else 1
        bound, sign = float(self.design.stroke[limb, end]), 1.0 if end == 0 else -1.0

        def field(points: Array) -> tuple[Array, Array]:
            poses, slope = self.poses(points)
            at = legs(self.design, poses)
            moment = np.cross(at.arm[:, limb], at.unit[:, limb])
            by_angle = (moment * self._turn(poses)).sum(axis=1)
            beyond = np.abs(slope) <= _FOLD * self.design.size
            # dθ/dp = −∇_p c / (∂c/∂θ) with ∇_p c = −m
            rate = np.where(beyond, 0.0, by_angle / np.where(beyond, 1.0, slope))
            gradient = at.unit[:, limb] + rate[:, None] * at.unit[:, LIMBS]
            return sign * (at.length[:, limb] - bound), sign * gradient

        return field

    def _turn(self, poses: Array) -> Array:
        turn: Array = angular_axes(poses)[..., self.request.index - 3]
        return turn

    def fold(self, points: Array) -> tuple[Array, Array]:
        """a² + b² − c² / L², ≥ 0 where θ exists, and its gradient."""

        def terms(p: Array) -> Array:
            poses = np.hstack([p, np.broadcast_to(self.request.angles, (len(p), 3))])
            return np.stack(angle_terms(self.design, poses, self.request.index))

        corner = terms(np.vstack([np.zeros(3), np.eye(3)]))
        slopes = corner[:, 1:] - corner[:, :1]  # (3 terms, 3), constant
        scale = 1.0 / self.design.size
        a, b, c = terms(points)
        value = scale * (a * a + b * b - c * c)
        gradient = 2.0 * scale * (np.outer(a, slopes[0]) + np.outer(b, slopes[1]))
        return value, gradient - 2.0 * scale * np.outer(c, slopes[2])


# --- the mesh ------------------------------------------------------------------------------


def build(design: FourSPSSPRDesign, request: Request, resolution: Resolution) -> BuiltSolid:
    """The solid in the base frame; its error is the distance from the exact volume.

    A preview, for which that takes too long, states 1 %, several times what was measured.
    """
    from scipy.ndimage import binary_dilation

    from kinematics.solids.csg import Solid, finish

    branch = _Branch(design, request)
    relative = _EXACT[resolution]
    exact = None if relative is None else exact_volume(design, request, relative)

    def error(traced: TracedMesh, volume: float) -> float:
        return _ROUGH * volume if exact is None else abs(volume - exact[0]) + exact[1]

    axes = _box(design, branch, _CELLS[resolution])
    if axes is None:
        return finish(Solid.from_mesh(np.zeros((0, 3)), np.zeros((0, 3))), error)
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    shape = nodes.shape[:3]
    margins = branch.margins(nodes.reshape(-1, 3)).reshape(*shape, -1)
    # Surfaces matter next to the solid only.
    near = binary_dilation((margins >= 0.0).all(axis=-1), np.ones((3, 3, 3)), iterations=2)
    parts: list[Solid] = []
    for which, tag in enumerate(TAGS):
        known = np.where(near, margins[..., which], np.nan)
        if parts and (known[near] > 0.0).all():
            continue
        surface = positive_part(axes, known, branch.margin(which))
        patch = np.where(surface.on_zero, 0, 1)
        tags = (tag, "side")
        parts.append(Solid.from_mesh(surface.vertices, surface.faces, patch=patch, tags=tags))
    parts.sort(key=lambda part: part.volume)
    whole = parts[0]
    for part in parts[1:]:  # one by one, the smallest first, is much quicker than all at once
        whole = Solid.intersection((whole, part))
    return finish(whole, error)


def _box(
    design: FourSPSSPRDesign, branch: _Branch, cells: int
) -> tuple[Array, Array, Array] | None:
    """Axes of a grid that just holds the solid; None where it is empty."""
    low, high = (np.array(v) for v in home.reach(design))
    for _ in range(2):  # a coarse look, then a closer one
        axes = [np.linspace(low[k], high[k], _COARSE + 1) for k in range(3)]
        nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        lengths = branch.lengths(nodes)
        fold, _ = branch.fold(nodes)
        # Steep next to the fold, so that rather too much is taken in.
        step = float(np.linalg.norm((high - low) / _COARSE))
        margin = np.minimum(lengths - design.stroke[:, 0], design.stroke[:, 1] - lengths)
        held = (margin.min(axis=1) > -1.5 * step) & (fold > -4.0 * step * design.size)
        if not held.any():
            return None
        inner = nodes[held]
        pad = (high - low) / _COARSE
        low, high = (
            np.maximum(low, inner.min(axis=0) - pad),
            np.minimum(high, inner.max(axis=0) + pad),
        )
    side = float(np.prod(high - low)) ** (1.0 / 3.0) / cells
    counts = np.clip(np.round((high - low) / side), 4, 4 * cells).astype(int)
    x, y, z = (np.linspace(low[k], high[k], counts[k] + 1) for k in range(3))
    return x, y, z


# --- the exact volume ----------------------------------------------------------------------


@lru_cache(maxsize=64)
def exact_volume(
    design: FourSPSSPRDesign, request: Request, relative: float = 1e-5
) -> tuple[float, float]:
    """The volume and an estimate from above of its error, mm³."""
    from scipy.integrate import quad

    def slice_of(angle: float) -> float:
        angles = list(request.angles)
        angles[request.index - 3] = angle
        a, b, c = angles
        return _swept(design, (a, b, c), request)

    # What an even rule finds tells how exact the pieces have to be.
    angles = np.linspace(-np.pi, np.pi, _EVEN, endpoint=False)
    rough = [slice_of(float(angle)) for angle in angles]
    size = 2.0 * np.pi * float(np.mean(rough))
    total, doubt = 0.0, 0.0
    marks = np.linspace(-np.pi, np.pi, _PIECES + 1)
    absolute = max(relative * size / _PIECES, 1e-300)
    for low, high in pairwise(marks.tolist()):
        inner = (angles >= low - 0.05) & (angles <= high + 0.05)
        if not any(value for value, here in zip(rough, inner, strict=True) if here):
            continue  # nothing there, nor next to it
        part, error, *_ = quad(
            slice_of, low, high, epsrel=0.0, epsabs=absolute, limit=30, full_output=1
        )
        total, doubt = total + part, doubt + error
    return total, doubt


def _swept(design: FourSPSSPRDesign, angles: tuple[float, float, float], request: Request) -> float:
    """∫ |∂c/∂θ| dA over the part of the plane region that is on the branch, mm³/rad."""
    here = plane(design, angles)
    found = rings(design, here)
    if not (found.outer > 0.0).all():
        return 0.0
    turn = angular_axes(np.array([0.0, 0.0, 0.0, *angles]))[:, request.index - 3]
    speed = np.cross(turn, here.frame[0])  # m′(θ); ∂c/∂θ = m′·(A_5 − p)
    # The sign of ∂c/∂θ is −side: on the branch, −side · ∂c/∂θ > 0.
    slope = request.side * (here.frame[1:] @ speed)
    start = -request.side * float(speed @ (design.base[SPR] - here.at * here.frame[0]))
    steep = float(np.linalg.norm(slope))
    if steep > 1e-12:
        unit = slope / steep
        middle = found.center.mean(axis=0)
        on_line = middle - unit * (start + float(slope @ middle)) / steep
        found = Rings(
            np.vstack([found.center, on_line + _STRAIGHT * unit]),
            np.append(found.inner, 0.0),
            np.append(found.outer, _STRAIGHT),
            np.append(found.limb, 0),
        )
    elif start <= 0.0:
        return 0.0
    area, first = rings_moments(found)
    return area * start + float(slope @ first)
