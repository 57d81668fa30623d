"""Charts of the five-bar's singularities: in its plane, and over the two driven angles.

Every point is exact: serial ones lie on the circles that bound the workspace, parallel ones come
with their configuration (see `curves`). Lengths mm, angles rad.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.loci import LocusCurve, LocusCurves, LocusSpec
from kinematics.answers.modes import one_of
from kinematics.answers.sections import BOUNDS
from kinematics.answers.singularities import SingularityKind
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.singularities import SingularitiesFacet
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.curve_pieces import pieces, sampled
from kinematics.mechanisms.five_bar.curves import closure
from kinematics.mechanisms.five_bar.design import LIMBS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import MODES, elbows, in_range, limb_angles
from kinematics.plane.arcs import Edge

FINE = 200  # parts of the size from one point to the next
_LINK = BOUNDS.index("link")

SPECS = (
    LocusSpec("plane", "Singularities of the working mode", ("x", "y"), ("mm", "mm")),
    LocusSpec(
        "plane-all", "Singularities of all working modes", ("x", "y"), ("mm", "mm"), figure="Fig. 9"
    ),
    LocusSpec("joints", "Singularities over the driven angles", ("θ₁", "θ₂"), ("rad", "rad")),
)


class Loci(SingularitiesFacet[FiveBarDesign]):
    """The charts, in the plane and over the driven angles."""

    loci = SPECS

    def locus(
        self, key: str, pose: Sequence[float], mode: str, at: float | None = None
    ) -> LocusCurves:
        """The curves of a chart of `SPECS`.

        "plane": serial and parallel ones in one working mode; "plane-all": in all of them;
        "joints": those of all working modes over (θ_1, θ_2), where they do not depend on the mode.

        Raises:
            InputError: there is no such chart, or no such mode.
        """
        design = self.design
        one_of(mode, MODES)
        if key in ("plane", "plane-all"):
            modes = (mode,) if key == "plane" else MODES
            curves = [*_serial_plane(design, modes), *_parallel_plane(design, modes)]
            reach = design.half_base + float((design.proximal + design.distal).max())
            bounds = np.array([[-reach, reach], [-reach, reach]])
        elif key == "joints":
            curves = [*_serial_joints(design), *_parallel_joints(design)]
            low, high = design.joint_range.T
            free = np.isinf(low)
            bounds = np.stack([np.where(free, -np.pi, low), np.where(free, np.pi, high)], axis=-1)
        else:
            known = ", ".join(spec.key for spec in SPECS)
            raise InputError(f"a five-bar has no loci {key!r}; known are {known}")
        return LocusCurves.of(curves, bounds)


def base_points(design: FiveBarDesign) -> list[int]:
    """Limbs (from 0) that can fold onto their base point: r_1 = r_2, a serial singularity."""
    equal = np.abs(design.proximal - design.distal) <= 1e-9 * design.size
    return [int(i) for i in np.flatnonzero(equal)]


def _serial_plane(design: FiveBarDesign, modes: Sequence[str]) -> list[LocusCurve]:
    """Circles where a limb is stretched or folded, as far as the other limb reaches."""
    found: list[LocusCurve] = []
    step = design.size / FINE
    seen: set[tuple[float, ...]] = set()
    for mode in modes:
        for edge in (edge for loop in workspace.loops(design, (mode,)) for edge in loop):
            if int(edge.shown.bound[0]) != _LINK:
                continue
            mark = tuple(np.round([*edge.first, *edge.last, *edge.point(0.5)], 6))
            if mark in seen:
                continue
            seen.add(mark)
            found.append(_along(design, edge, step))
    for i in base_points(design):
        point = design.base[i]
        if np.isfinite(limb_angles(design, point)).all():
            found.append(LocusCurve(point[None, :], np.zeros(1), "serial", i + 1))
    return found


def _along(design: FiveBarDesign, edge: Edge, step: float) -> LocusCurve:
    one = edge.shown
    length = abs(float(one.sweep[0])) * float(one.radius[0])
    share = np.linspace(0.0, 1.0, max(2, int(np.ceil(length / step)) + 1))
    angle = one.start[0] + one.sweep[0] * share
    points = one.center[0] + one.radius[0] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points[0], points[-1] = edge.first, edge.last
    off = np.abs(np.hypot(*(points - one.center[0]).T) - one.radius[0])
    return LocusCurve(points, off, "serial", int(one.limb[0]))


def _parallel_plane(design: FiveBarDesign, modes: Sequence[str]) -> list[LocusCurve]:
    found: list[LocusCurve] = []
    for piece in pieces(design):
        if piece.mode in modes:
            points, joints = sampled(piece, design.size / FINE)
            if piece.whole:
                points[-1] = points[0]
            left = closure(design, points, joints, piece.loop.side)
            found.append(LocusCurve(points, left))
    return found


def _parallel_joints(design: FiveBarDesign) -> list[LocusCurve]:
    found: list[LocusCurve] = []
    for piece in pieces(design):
        points, joints = sampled(piece, design.size / FINE)
        left = closure(design, points, joints, piece.loop.side) / design.proximal.mean()
        if piece.loop.kind == "circle":  # one point over the angles
            found.append(LocusCurve(joints[:1], left[:1]))
            continue
        found += _unbroken(joints, left, "parallel", 0)
    return found


def _serial_joints(design: FiveBarDesign) -> list[LocusCurve]:
    """θ of the other limb, both ways, while one is stretched or folded and turns."""
    found: list[LocusCurve] = []
    for i in range(LIMBS):
        low, high = design.joint_range[i].tolist()
        if np.isinf(low):
            low, high = -np.pi, np.pi
        angle = np.linspace(low, high, 8 * FINE + 1)
        ray = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        for turn in (1.0, -1.0):
            reach = float(design.proximal[i] + turn * design.distal[i])
            point = design.base[i] + reach * ray
            other = limb_angles(design, point)[:, 1 - i, :]
            for sign in range(2):
                joints = np.stack([angle, other[:, sign]], axis=-1)
                joints = joints if i == 0 else joints[:, ::-1]
                elbow = elbows(design, joints)
                off = np.linalg.norm(point[:, None] - elbow, axis=-1) - design.distal
                left = np.abs(off).max(axis=-1) / design.proximal.mean()
                joints = np.where(in_range(design, joints), joints, np.nan)
                found += _unbroken(joints, left, "serial", i + 1)
    return [curve for curve in found if len(curve.points) > 1]


def _unbroken(joints: Array, left: Array, kind: SingularityKind, limb: int) -> list[LocusCurve]:
    """Curves over the angles, cut where an angle leaps by a whole turn or there is none."""
    leap = np.abs(np.diff(joints, axis=0)).max(axis=-1)
    breaks = np.flatnonzero(~(leap < np.pi)) + 1
    found: list[LocusCurve] = []
    for part, rest in zip(np.split(joints, breaks), np.split(left, breaks), strict=True):
        ok = np.isfinite(part).all(axis=-1)
        if ok.all() and len(part):
            found.append(LocusCurve(part, rest, kind, limb))
    return found
