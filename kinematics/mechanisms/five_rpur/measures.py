"""How well a posture of the 5-RPUR is held: indices that vanish at singularities, and forces.

The first three lie between 0 and 1 and depend on neither the base frame nor the unit of length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import Measure
from kinematics.arrays import Array, frozen
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import LIMBS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.statics import statics, wrench_system
from kinematics.mechanisms.five_rpur.velocity import characteristic_length, condition, wrenches
from kinematics.screws.wrenches import normalised

MEASURES: tuple[Measure, ...] = (
    Measure("conditioning", "Conditioning", "", "high", (0.0, 1.0)),
    Measure("manipulability", "Manipulability", "", "high", (0.0, 1.0)),
    Measure("transmission", "Transmission index", "", "high", (0.0, 1.0)),
    Measure("force", "Largest actuator force", "N", "low", (0.0, None), needs_load=True),
)


def measure(
    design: FiveRPURDesign,
    poses: ArrayLike,
    mode: str,
    key: str,
    load: Sequence[float] | None = None,
) -> Array:
    """One of `MEASURES` at poses (..., 5), mm and rad, in a working mode.

    Args:
        design: the machine.
        poses: (..., 5).
        mode: a working mode as "+-+++".
        key: "conditioning", "manipulability", "transmission" or "force".
        load: [F, T] at O', N and N·mm, which "force" needs.

    Returns:
        (...,); NaN where a limb cannot close.

    Raises:
        InputError: there is no such measure, or it needs a load and there is none.
    """
    if key == "force":
        if load is None:
            raise InputError("the largest actuator force is that for a load; none is given")
        return largest_force(design, poses, mode, load)
    found = _PLAIN.get(key)
    if found is None:
        known = ", ".join(m.key for m in MEASURES)
        raise InputError(f"there is no measure {key!r}; use one of {known}")
    return found(design, poses, mode)


def conditioning(design: FiveRPURDesign, poses: ArrayLike, mode: str) -> Array:
    """The reciprocal of the condition number of J5, its angles by the characteristic length.

    1 is isotropic; 0 at singularities of either type (Salisbury and Craig 1982; Gosselin and
    Angeles 1991).
    """
    with np.errstate(divide="ignore"):
        return frozen(1.0 / condition(design, poses, mode))


def manipulability(design: FiveRPURDesign, poses: ArrayLike, mode: str) -> Array:
    """sqrt(det G Gᵀ), G the six unit wrenches, moments about O' by the characteristic length.

    Yoshikawa's measure (1985) of the wrenches as they are scaled for a quality index (Lee, Duffy
    and Hunt 1998): 1 where they are normal to each other, by Hadamard's inequality; 0 at parallel
    singularities. A limb in a serial singularity still transmits its force, and counts as others.
    """
    system = wrench_system(design, poses, mode)
    unit = normalised(system.rows, characteristic_length(design))
    closes = np.asarray(np.isfinite(unit).all(axis=(-1, -2)))
    value = np.abs(np.linalg.det(np.where(closes[..., None, None], unit, 0.0)))
    return frozen(np.where(closes, np.minimum(value, 1.0), np.nan))


def transmission(design: FiveRPURDesign, poses: ArrayLike, mode: str) -> Array:
    """The least of all limbs' input and output transmission indices (Wang, Wu and Liu 2010).

    Input: |f̂·û|, of the force and the actuator's direction. Output: |f̂·v| / |v|, v the velocity
    of the platform's point at B_i when all other actuators are locked: the virtual coefficient of
    wrench and output twist, divided by its maximum over all directions of the force at its point
    of application (Chen and Angeles 2007). 0 at singularities of either type.
    """
    system = wrench_system(design, poses, mode)
    w = wrenches(design, poses, mode)
    scale = np.repeat([1.0, characteristic_length(design)], 3)
    rows = system.rows / scale
    good = np.asarray(np.isfinite(rows).all(axis=(-1, -2)))
    held = good & (np.abs(np.linalg.det(np.where(good[..., None, None], rows, 0.0))) > _SINGULAR)
    # Column i of the inverse is [v, ω] of the output twist of limb i, ω by the same length.
    twists = np.linalg.inv(np.where(held[..., None, None], rows, np.eye(LIMBS + 1)))
    twists = np.swapaxes(twists, -1, -2)[..., :LIMBS, :] / scale
    origin = system.point[..., LIMBS:, :]
    moved = twists[..., :3] + np.cross(twists[..., 3:], system.point[..., :LIMBS, :] - origin)
    force = system.rows[..., :LIMBS, :3]
    with np.errstate(invalid="ignore", divide="ignore"):
        push = np.abs((force * moved).sum(axis=-1)) / np.linalg.norm(moved, axis=-1)
        pull = np.abs(w.transmission) / np.linalg.norm(w.force, axis=-1)
        least = np.minimum(push, pull).min(axis=-1)
    return frozen(np.where(held, np.minimum(least, 1.0), np.where(good, 0.0, np.nan)))


def largest_force(
    design: FiveRPURDesign, poses: ArrayLike, mode: str, load: Sequence[float]
) -> Array:
    """The largest actuator force (N) that holds a load; infinite at parallel singularities.

    Raises:
        InputError: the load is not six finite numbers.
    """
    found = statics(design, poses, mode, load)
    rows = wrench_system(design, poses, mode).rows
    closes = np.isfinite(rows).all(axis=(-1, -2))
    force = np.abs(found.forces[..., :LIMBS]).max(axis=-1)
    return frozen(np.where(closes & np.isnan(force), np.inf, force))


_SINGULAR = 1e-14  # determinant of the wrenches below which there is no transmission

_PLAIN: dict[str, Callable[[FiveRPURDesign, ArrayLike, str], Array]] = {
    "conditioning": conditioning,
    "manipulability": manipulability,
    "transmission": transmission,
}
