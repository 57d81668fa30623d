"""Velocity, acceleration and statics of the five-bar, and how well a configuration is controlled.

A θ̇ = B ṗ (Sosa-López et al. 2017, eqs. 20 to 22): row i of B is the distal link P − B_i, and A is
diagonal with a_i = r_1 (P − B_i)·e⊥(θ_i). Differentiated once more,
a_i θ̈_i = (P − B_i)·p̈ + r_1 θ̇_i² (P − B_i)·e(θ_i) + |ṗ − Ḃ_i|²: eqs. 26 to 28, whose g_2 in row 2
of eq. 27 is multiplied by θ̇_2. Torques that hold a force F at P: τ = −A B^{−T} F.

det A is r_1 r_1' times y² c_1 c_2 − x y (c_1 s_2 + s_1 c_2) + y r_3 (c_1 s_2 − s_1 c_2) +
(x² − r_3²) s_1 s_2 (eq. 24 is misprinted): zero at serial singularities; det B (eq. 25) is zero at
parallel ones. Lengths mm, angles rad. Everything takes batches.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.motion import Motion, Statics, WrenchName, WrenchSystem
from kinematics.answers.singularities import Measure
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import elbows, joints_of

SINGULAR = 1e-12
"""|sin| of an angle between links below which they are in line, and the answer is NaN."""

NAMES = tuple(WrenchName("actuation", i + 1, f"τ{SUBSCRIPTS[i]}") for i in range(LIMBS))


def jacobians(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> tuple[Array, Array]:
    """The diagonal of A (..., 2) mm² and B (..., 2, 2) mm (eqs. 21 and 22)."""
    p, q = np.asarray(poses, dtype=float), np.asarray(joints, dtype=float)
    b = p[..., None, :] - elbows(design, q)
    a = design.proximal * (b[..., 1] * np.cos(q) - b[..., 0] * np.sin(q))
    return a, b


def determinants(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> tuple[Array, Array]:
    """det A (...) mm⁴ and det B (...) mm²; zero at serial and at parallel singularities."""
    a, b = jacobians(design, poses, joints)
    return a[..., 0] * a[..., 1], _cross(b[..., 0, :], b[..., 1, :])


def sines(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> tuple[Array, Array]:
    """det A and det B without their lengths.

    Returns:
        (..., 2): the sine of the angle from each proximal link to its distal one; and (...): that
        of the angle from distal link 1 to distal link 2.
    """
    a, b = jacobians(design, poses, joints)
    unit = b / design.distal[:, None]
    return a / (design.proximal * design.distal), _cross(unit[..., 0, :], unit[..., 1, :])


def inverse_jacobian(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> Array:
    """J = A⁻¹B (..., 2, 2) rad/mm: θ̇ = J ṗ (eq. 23); a row is NaN in a serial singularity."""
    a, b = jacobians(design, poses, joints)
    serial = np.abs(a) <= SINGULAR * design.proximal * design.distal
    with np.errstate(divide="ignore", invalid="ignore"):
        result: Array = b / np.where(serial, np.nan, a)[..., None]
    return result


def condition(design: FiveBarDesign, poses: ArrayLike, joints: ArrayLike) -> Array:
    """The condition number of J, (...): 1 at best, infinite at any singularity."""
    a, b = jacobians(design, poses, joints)
    s1, s2 = a[..., 0], a[..., 1]
    # Of the matrix adj(A) B, which is J times det A: no division that a singularity forbids.
    rows = np.stack([s2[..., None] * b[..., 0, :], s1[..., None] * b[..., 1, :]], axis=-2)
    norm2 = (rows**2).sum(axis=(-1, -2))
    det = np.abs(_cross(rows[..., 0, :], rows[..., 1, :]))
    small = det <= SINGULAR * norm2
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.maximum(norm2 / (2.0 * det), 1.0)  # (κ + 1/κ)/2
        answer = ratio + np.sqrt((ratio - 1.0) * (ratio + 1.0))
    return np.where(np.isnan(det), np.nan, np.where(small, np.inf, answer))


# --- rates ---------------------------------------------------------------------------------


def inverse_motion(
    design: FiveBarDesign,
    poses: ArrayLike,
    mode: str,
    pose_rates: ArrayLike,
    pose_accelerations: ArrayLike | None = None,
) -> Motion:
    """Joint rates and accelerations (..., 2) for those of P in one working mode (eq. 29).

    NaN where the pose does not close or a limb is stretched or folded (serial singularity).
    """
    p, v, w = _batch(poses, pose_rates, pose_accelerations, "pose")
    q = joints_of(design, p, mode)
    a, b = jacobians(design, p, q)
    a = np.where(np.abs(a) <= SINGULAR * design.proximal * design.distal, np.nan, a)
    with np.errstate(invalid="ignore"):
        rate = (b * v[..., None, :]).sum(axis=-1) / a
        acceleration = ((b * w[..., None, :]).sum(axis=-1) + _bias(design, b, q, v, rate)) / a
    return _motion(v, w, rate, acceleration)


def forward_motion(
    design: FiveBarDesign,
    poses: ArrayLike,
    mode: str,
    joint_rates: ArrayLike,
    joint_accelerations: ArrayLike | None = None,
) -> Motion:
    """The velocity and acceleration (..., 2) of P for those of the joints (eq. 30).

    NaN where the pose does not close or stands in a parallel singularity.
    """
    p, rate, acceleration = _batch(poses, joint_rates, joint_accelerations, "joint")
    q = joints_of(design, p, mode)
    return forward_motion_of(design, p, q, rate, acceleration)


def forward_motion_of(
    design: FiveBarDesign, p: Array, q: Array, rate: Array, acceleration: Array
) -> Motion:
    """The same for configurations: P (..., 2) mm with its joints (..., 2) rad."""
    a, b = jacobians(design, p, q)
    v = _solve(design, b, a * rate)
    w = _solve(design, b, a * acceleration - _bias(design, b, q, v, rate))
    return _motion(v, w, rate, acceleration)


def _bias(design: FiveBarDesign, b: Array, q: Array, v: Array, rate: Array) -> Array:
    """C of eq. 27, (..., 2) mm²/s²."""
    e = np.stack([np.cos(q), np.sin(q)], axis=-1)
    across = np.stack([-e[..., 1], e[..., 0]], axis=-1)
    relative = v[..., None, :] - (design.proximal * rate)[..., None] * across
    along: Array = design.proximal * rate**2 * (b * e).sum(axis=-1)
    bias: Array = along + (relative**2).sum(axis=-1)
    return bias


def _solve(design: FiveBarDesign, b: Array, right: Array) -> Array:
    """B⁻¹ times (..., 2); NaN where B is singular."""
    det = _cross(b[..., 0, :], b[..., 1, :])
    det = np.where(np.abs(det) <= SINGULAR * np.prod(design.distal), np.nan, det)
    with np.errstate(invalid="ignore"):
        x = (right[..., 0] * b[..., 1, 1] - right[..., 1] * b[..., 0, 1]) / det
        y = (right[..., 1] * b[..., 0, 0] - right[..., 0] * b[..., 1, 0]) / det
    return np.stack([x, y], axis=-1)


def _motion(v: Array, w: Array, rate: Array, acceleration: Array) -> Motion:
    v, w, rate, acceleration = np.broadcast_arrays(v, w, rate, acceleration)
    v, w, rate, acceleration = (each.copy() for each in (v, w, rate, acceleration))
    return Motion(v, w, _planar(v), _planar(w), rate, acceleration)


def _planar(v: Array) -> Array:
    """A velocity of P (..., 2) as a twist (..., 6); P does not turn."""
    twist = np.zeros((*v.shape[:-1], 6))
    twist[..., 3:5] = v
    twist[np.isnan(v).any(axis=-1)] = np.nan
    return twist


# --- forces --------------------------------------------------------------------------------


def wrench_system(design: FiveBarDesign, poses: ArrayLike, mode: str) -> WrenchSystem:
    """The two forces that the limbs exert on P, along their distal links, from B_i to P.

    The determinant is that of the two unit forces in the plane: the sine of the angle from distal
    link 1 to distal link 2. What holds P in its plane is left out: it is the same everywhere.
    """
    p = finite(poses, name="a pose", last=2)
    q = joints_of(design, p, mode)
    _, b = jacobians(design, p, q)
    unit = b / design.distal[:, None]
    rows = np.zeros((*p.shape[:-1], LIMBS, 6))
    rows[..., :2] = unit
    rows[np.isnan(unit).any(axis=-1)] = np.nan
    point = np.zeros((*p.shape[:-1], LIMBS, 3))
    point[..., :2] = p[..., None, :]
    names = tuple(WrenchName("actuation", i + 1, f"F{SUBSCRIPTS[i]}") for i in range(LIMBS))
    return WrenchSystem(names, rows, point, _cross(unit[..., 0, :], unit[..., 1, :]))


def statics(design: FiveBarDesign, poses: ArrayLike, mode: str, loads: ArrayLike) -> Statics:
    """Torques (..., 2) N·mm of the actuators that hold loads [F, T] (..., 6) at P.

    F_z, T_x and T_y are borne by the hinges. A moment T_z about the hinge P cannot be held: it
    stays in the residual.
    """
    p = finite(poses, name="a pose", last=2)
    load = finite(loads, name="a load", last=6)
    shape = np.broadcast_shapes(p.shape[:-1], load.shape[:-1])
    p, load = np.broadcast_to(p, (*shape, 2)), np.broadcast_to(load, (*shape, 6))
    a, b = jacobians(design, p, joints_of(design, p, mode))
    push = _solve(design, b.swapaxes(-1, -2), -load[..., :2])  # along the distal links, per mm
    left = (b * push[..., None]).sum(axis=-2) + load[..., :2]
    force = np.hypot(load[..., 0], load[..., 1])
    moment = np.abs(load[..., 5]) / characteristic_length(design)
    scale = np.maximum(force, moment)
    with np.errstate(invalid="ignore", divide="ignore"):
        worst = np.maximum(np.abs(left).max(axis=-1), moment) / scale
    return Statics(NAMES, a * push, np.where(scale == 0.0, 0.0, worst))


def characteristic_length(design: FiveBarDesign) -> float:
    """mm that an angle of 1 rad counts for: the mean driven link."""
    return float(design.proximal.mean())


# --- how well ------------------------------------------------------------------------------


MEASURES = (
    Measure("conditioning", "Conditioning of the Jacobian, 1/κ", "", "high", (0.0, 1.0)),
    Measure("manipulability", "Manipulability", "", "high", (0.0, 1.0)),
    Measure("transmission", "Transmission index", "", "high", (0.0, 1.0)),
    Measure("force", "Largest actuator torque", "N·mm", "low", (0.0, None), needs_load=True),
)


def measure(
    design: FiveBarDesign,
    poses: ArrayLike,
    mode: str,
    key: str,
    load: Sequence[float] | None = None,
) -> Array:
    """One of `MEASURES` at poses (..., 2), (...); NaN where they do not close.

    "conditioning": 1/κ of J; "manipulability": the area that the unit forces along the distal links
    span, |sin| of the angle between them; "transmission": the least of it and of |sin| between each
    limb's links (input and output index, Wang, Wu and Liu 2010); "force": the largest torque for
    a load, infinite at parallel singularities.

    Raises:
        InputError: there is no such measure, or it needs a load.
    """
    p = finite(poses, name="a pose", last=2)
    q = joints_of(design, p, mode)
    if key == "conditioning":
        answer: Array = 1.0 / condition(design, p, q)
        return answer
    limbs, between = (np.abs(each) for each in sines(design, p, q))
    if key == "transmission":
        return np.asarray(np.minimum(limbs.min(axis=-1), between))
    if key == "manipulability":
        return np.asarray(between)
    if key == "force":
        if load is None:
            raise InputError("the largest torque needs a load, [Fx, Fy, Fz, Tx, Ty, Tz]")
        largest: Array = np.abs(statics(design, p, mode, load).forces).max(axis=-1)
        return np.where(np.isfinite(between) & np.isnan(largest), np.inf, largest)
    known = ", ".join(each.key for each in MEASURES)
    raise InputError(f"there is no measure {key!r}; known are {known}")


# --- inside --------------------------------------------------------------------------------


def _batch(
    poses: ArrayLike, rates: ArrayLike, accelerations: ArrayLike | None, whose: str
) -> tuple[Array, Array, Array]:
    p = finite(poses, name="a pose", last=2)
    v = finite(rates, name=f"the {whose} rates", last=2)
    given = np.zeros(2) if accelerations is None else accelerations
    w = finite(given, name=f"the {whose} accelerations", last=2)
    try:
        shape = np.broadcast_shapes(p.shape, v.shape, w.shape)
    except ValueError:
        raise InputError("poses, rates and accelerations must be batches of one shape") from None
    p, v, w = (np.broadcast_to(each, shape) for each in (p, v, w))
    return p, v, w


def _cross(u: Array, v: Array) -> Array:
    result: Array = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return result
