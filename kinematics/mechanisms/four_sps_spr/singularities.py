"""How well a posture of the 4-SPS + 1-SPR is held, how far it is from losing that, and the loci."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.bounds import decimals as digits
from kinematics.answers.bounds import range_of
from kinematics.answers.clearances import Clearance
from kinematics.answers.loci import LocusCurves, LocusSpec
from kinematics.answers.singularities import AT, Measure, Singularity, SingularityKind
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.inverse import CONSTRAINT_SLACK, LIMITS, violation
from kinematics.mechanisms.four_sps_spr.motion import UPRIGHT, angular_axes
from kinematics.mechanisms.four_sps_spr.plane import Plane, plane, rings
from kinematics.mechanisms.four_sps_spr.singular_curve import cubic, nearest_singular, traced
from kinematics.mechanisms.four_sps_spr.wrenches import condition, statics, wrench_system
from kinematics.plane.annuli import rings_section
from kinematics.plane.regions import nearest_point
from kinematics.screws import wrenches as shared
from kinematics.screws.singularity_geometry import lost

# --- measures ------------------------------------------------------------------------------

MEASURES = (
    Measure("conditioning", "Conditioning", "", "high", (0.0, 1.0)),
    Measure("manipulability", "Manipulability", "", "high", (0.0, 1.0)),
    Measure("force", "Largest leg force", "N", "low", (0.0, None), needs_load=True),
    Measure("constraint_force", "Constraint force", "N", "low", (0.0, None), needs_load=True),
)


def measure(
    design: FourSPSSPRDesign, poses: ArrayLike, key: str, load: Sequence[float] | None = None
) -> Array:
    """One of `MEASURES` at poses (..., 6), mm and rad; moments by the characteristic length.

    Args:
        key: "conditioning", 1/κ of G; "manipulability", |det| of the six wrenches, each of unit
            size; "force", the largest of the legs', and "constraint_force", N.
        load: [F, T] at p, N and N·mm, which the forces need.

    Returns:
        (...,); NaN where the constraint is violated, and of forces at singularities.

    Raises:
        InputError: there is no such measure, or it needs a load.
    """
    p = finite(poses, name="a pose", last=6)
    if key == "conditioning":
        return np.asarray(1.0 / condition(design, p))
    if key == "manipulability":
        values = shared.singular_values(wrench_system(design, p).rows, design.length)
        return np.asarray(np.prod(values, axis=-1))
    if key not in ("force", "constraint_force"):
        known = ", ".join(each.key for each in MEASURES)
        raise InputError(f"there is no measure {key!r}; use one of {known}")
    if load is None:
        raise InputError("a largest force is that for a load; none is given")
    forces = np.abs(statics(design, p, load).forces)
    return np.asarray(forces[..., LIMBS] if key == "constraint_force" else _largest(forces))


def _largest(forces: Array) -> Array:
    answer: Array = forces[..., :LIMBS].max(axis=-1)
    return answer


# --- singularities -------------------------------------------------------------------------


def singularities(
    design: FourSPSSPRDesign, posture: Posture, tolerance: float = AT
) -> tuple[Singularity, ...]:
    """The parallel singularities of a posture, one for each motion that is free.

    There is no constraint singularity proper: the one constraint is a unit force.
    """
    pose = np.array(posture.pose)
    axes = angular_axes(pose)
    if abs(np.cos(pose[4])) <= UPRIGHT:
        axes = np.full((3, 3), np.nan)  # the angles do not tell how the platform turns

    def pose_rates(twist: Array) -> list[float]:
        turning = np.linalg.solve(axes, twist[:3]) if np.isfinite(axes).all() else axes[0]
        return [*twist[3:].tolist(), *turning.tolist()]

    system = wrench_system(design, pose)
    return lost(system, posture.pose[:3], design.length, pose_rates, tolerance)


# --- clearances ----------------------------------------------------------------------------

_EXACT = 1e-9  # of the machine's size


def clearances(
    design: FourSPSSPRDesign, posture: Posture, *, singular: bool = True
) -> tuple[Clearance, ...]:
    """How far p may move in the plane that its orientation leaves, until something happens.

    To every stroke end, where it lies in the plane at all; to the boundary of the
    constant-orientation workspace; and to the nearest parallel singularity. Where a stroke end is
    passed already its distance is negative: the way back.

    Returns:
        The nearest first. None for a posture that violates the constraint.
    """
    pose = np.array(posture.pose)
    if abs(float(violation(design, pose))) > CONSTRAINT_SLACK:
        return ()
    angles = tuple(pose[3:].tolist())
    here = plane(design, angles)
    uv = here.coordinates(pose[:3])
    error = _EXACT * design.size
    found = _strokes(design, here, uv, posture, error)
    if posture.reachable:
        region = rings_section(rings(design, here), here.at)
        edge = nearest_point(region, uv)
        if edge is not None:
            point, k = edge
            limb = int(region.limb[k])
            bound = range_of(LIMITS, limb)[int(region.bound[k])]
            amount = float(np.linalg.norm(point - uv))
            text = f"{_far(amount)} the boundary of the workspace (limb {limb} at {bound.name})"
            found.append(
                Clearance("boundary", amount, _xyz(here.place(point)), text, limb, bound, error)
            )
    a, b, c = angles
    near = nearest_singular(cubic(design, (a, b, c)), uv) if singular else None
    if near is not None:
        point, amount, blur = near
        text = f"{_far(amount)} a parallel singularity"
        found.append(
            Clearance("parallel", amount, _xyz(here.place(point)), text, error=error + blur)
        )
    return tuple(sorted(found, key=lambda clearance: clearance.distance))


def _strokes(
    design: FourSPSSPRDesign, here: Plane, uv: Array, posture: Posture, error: float
) -> list[Clearance]:
    answer = []
    found = rings(design, here)
    for i in range(LIMBS):
        away = uv - found.center[i]
        length = float(np.linalg.norm(away))
        unit = away / length if length > 0.0 else np.array([1.0, 0.0])
        for bound, radius in zip(
            range_of(LIMITS, i + 1), (found.inner[i], found.outer[i]), strict=True
        ):
            if not radius > 0.0:
                continue  # the plane does not meet this sphere
            beyond = any(r.limb == i + 1 and r.bound == bound for r in posture.reasons)
            amount = abs(length - float(radius)) * (-1.0 if beyond else 1.0)
            point = here.place(found.center[i] + radius * unit)
            text = f"{_far(amount)} the end of limb {i + 1}'s stroke ({bound.name})"
            answer.append(Clearance("stroke", amount, _xyz(point), text, i + 1, bound, error))
    return answer


def _far(amount: float) -> str:
    word = "mm to" if amount >= 0.0 else "mm beyond"
    return f"{abs(amount):.{digits(abs(amount))}f} {word}"


def _xyz(point: Array) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return (x, y, z)


# --- loci ----------------------------------------------------------------------------------

PLANE = "plane"
LOCI = (
    LocusSpec(
        PLANE,
        "Singular places at this orientation, in the plane of the constraint",
        ("u", "v"),
        ("mm", "mm"),
    ),
)


def locus(design: FourSPSSPRDesign, key: str, pose: Sequence[float]) -> LocusCurves:
    """The cubic curve of parallel singularities at the pose's orientation, where p can reach.

    Raises:
        InputError: there is no such chart.
    """
    if key != PLANE:
        raise InputError(f"there is no chart {key!r}; known is {PLANE}")
    a, b, c = (float(v) for v in pose[3:])
    here = plane(design, (a, b, c))
    curve = cubic(design, (a, b, c))
    low, high = bounds(design, here)
    found = traced(curve, low, high)
    count = len(found.start) - 1
    kinds: tuple[SingularityKind, ...] = tuple("parallel" for _ in range(count))
    return LocusCurves(
        points=found.points,
        start=found.start,
        kinds=kinds,
        limb=np.zeros(count, dtype=np.int64),
        residual=curve.distance(found.points),
        bounds=np.stack([low, high], axis=1),
    )


def bounds(design: FourSPSSPRDesign, here: Plane) -> tuple[Array, Array]:
    """A box of the plane in which all legs may reach: the lowest and highest (u, v), mm."""
    found = rings(design, here)
    radius = np.where(found.outer > 0.0, found.outer, design.stroke[:, 1])[:, None]
    low, high = (found.center - radius).max(axis=0), (found.center + radius).min(axis=0)
    apart = low >= high
    low = np.where(apart, (found.center - radius).min(axis=0), low)
    high = np.where(apart, (found.center + radius).max(axis=0), high)
    margin = 0.05 * (high - low)
    return low - margin, high + margin
