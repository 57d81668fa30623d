"""Where a posture has lost control, and where the operation mode may change.

Parallel singularities: P(Z, θ, sin 3φ) = 0. Constraint singularities: x0 = x3 = 0, a tilt of 180°,
which belongs to both operation modes; nowhere else do they meet (Nayak et al. 2017, section 5.1).
Serial: a limb without length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.singularities import AT, Measure, ModeChange, Singularity
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.inverse import posture as posture_at
from kinematics.mechanisms.tripods import polynomial, posing, wrenches
from kinematics.mechanisms.tripods.design import LIMBS, SUBSCRIPTS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.motion import pose_change
from kinematics.screws.singularity_geometry import listed, lost

MEETING = 1e-9
"""rad from a tilt of 180° within which a pose belongs to both operation modes."""
_ALONG = 721  # tilts looked at on the way to the change of mode

MEASURES = (
    Measure("conditioning", "Conditioning 1/κ", "", "high", (0.0, 1.0)),
    Measure(
        "singular_value", "Smallest singular value of the unit wrenches", "", "high", (0.0, None)
    ),
    Measure("largest_force", "Largest actuator force", "N", "low", (0.0, None), needs_load=True),
    Measure(
        "constraint_force", "Largest constraint force", "N", "low", (0.0, None), needs_load=True
    ),
    Measure("parasitic", "Parasitic motion √(X² + Y²)", "mm", "low", (0.0, None)),
)


def measure(
    design: TripodDesign,
    poses: ArrayLike,
    mode: str,
    key: str,
    load: ArrayLike | None = None,
) -> Array:
    """One of `MEASURES` at poses (..., 3); moments are divided by the characteristic length h2.

    Raises:
        InputError: there is no such measure, or it needs a load.
    """
    p = posing.read_poses(poses)
    if key == "conditioning":
        return np.asarray(1.0 / wrenches.condition(design, p, mode))
    if key == "singular_value":
        return wrenches.least(design, p, mode)
    if key == "parasitic":
        return np.asarray(np.hypot(*parasitic(design, p, mode)))
    if key not in ("largest_force", "constraint_force"):
        known = ", ".join(each.key for each in MEASURES)
        raise InputError(f"there is no measure {key!r}; known are {known}")
    if load is None:
        raise InputError(f"the measure {key!r} needs a load")
    forces = np.abs(wrenches.statics(design, p, mode, load).forces)
    chosen = forces[..., :LIMBS] if key == "largest_force" else forces[..., LIMBS:]
    return np.asarray(chosen.max(axis=-1))


def parasitic(design: TripodDesign, poses: ArrayLike, mode: str) -> tuple[Array, Array]:
    """X and Y (...) of O′, mm, which follow from Z, θ and φ; NaN where there is no position."""
    p = posing.read_poses(poses)
    place = posing.positions(design, p, mode)
    there = np.isfinite(posing.reduce_poses(design, p, mode).v)
    return np.where(there, place[..., 0], np.nan), np.where(there, place[..., 1], np.nan)


def determinant_from_polynomial(design: TripodDesign, poses: ArrayLike, mode: str) -> Array:
    """± the determinant of the unnormed wrenches by P: 6.75 x h2³ P, or 6.75 x h1³ P / cos² θ."""
    p = posing.read_poses(poses)
    z, tilt, azimuth = (p[..., n] for n in range(posing.POSE))
    k = mode_sign(mode) * design.platform_radius
    value = polynomial.value(
        design.mechanism, design.base_radius, k, z, tilt, np.sin(3.0 * azimuth)
    )
    found = 6.75 * np.cos(0.5 * tilt) * design.spherical_radius**3 * value
    return np.asarray(found if design.revolute_on_base else found / np.cos(tilt) ** 2)


def singularities(
    design: TripodDesign, posture: Posture, tolerance: float = AT
) -> tuple[Singularity, ...]:
    """All singularities of a posture whose measure is below ``tolerance``; serial ones first.

    The measure of a serial one is ρ/h2 of the limb, that of the others the smallest singular
    value of the wrenches.
    """
    if not posture.closes:
        return ()
    length = wrenches.characteristic_length(design)
    short = [i for i, r in enumerate(posture.joints) if r / length < tolerance]
    if short:
        limbs = tuple(i + 1 for i in short)
        who = f"limb{'s' if len(limbs) > 1 else ''} {listed(limbs)}"
        joints = " and ".join(f"A{SUBSCRIPTS[i]} = B{SUBSCRIPTS[i]}" for i in short)
        return (
            Singularity(
                "serial",
                limbs,
                f"{joints}: the limb has no length and no direction",
                f"serial singularity: {who} cannot drive the platform, {joints}",
                max(posture.joints[i] for i in short) / length,
            ),
        )
    pose = np.array(posture.pose)
    place = posing.positions(design, pose, posture.mode)
    return lost(
        wrenches.wrench_system(design, pose, posture.mode),
        tuple(place.tolist()),
        length,
        lambda twist: pose_change(pose, np.asarray(twist)).tolist(),
        tolerance,
    )


# --- from one operation mode to the other --------------------------------------------------


def in_other_mode(design: TripodDesign, posture: Posture) -> Posture:
    """The same configuration, at a tilt of 180°, told in the other operation mode."""
    z, _, azimuth = posture.pose
    other = "1" if posture.mode == "2" else "2"
    # (0, cos φ, sin φ, 0) of mode 2 is (0, sin φ₁, −cos φ₁, 0) of mode 1 with φ₁ = φ + 90°.
    turned = azimuth + (0.5 * np.pi if other == "1" else -0.5 * np.pi)
    turned = np.pi - (np.pi - turned) % (2.0 * np.pi)
    return posture_at(design, (z, np.pi, turned), other)


def mode_change(design: TripodDesign, posture: Posture) -> ModeChange:
    """Whether the machine stands where the operation modes meet, and if not, where they do.

    That is at a tilt of 180°; the way told is by more tilt, at the present altitude and azimuth.
    """
    z, tilt, azimuth = posture.pose
    other = "1" if posture.mode == "2" else "2"
    if abs(tilt - np.pi) <= MEETING:
        at = posture_at(design, (z, np.pi, azimuth), posture.mode)
        text = (
            "The platform is in the constraint singularity, where the operation modes meet: it "
            f"may go on in mode {other}."
        )
        return ModeChange(at, in_other_mode(design, at), True, 0.0, False, text)
    at = posture_at(design, (z, np.pi, azimuth), posture.mode)
    why = _in_between(design, posture)
    text = (
        f"Operation mode {other} begins at a tilt of 180°, {np.degrees(np.pi - tilt):.1f}° further"
        + (f"; on the straight way there {why}." if why else ", and the way there is free.")
    )
    return ModeChange(
        at, in_other_mode(design, at), False, abs(float(np.pi - tilt)), bool(why), text
    )


def _in_between(design: TripodDesign, posture: Posture) -> str:
    """What is met first when the tilt grows to 180°; "" if nothing is."""
    z, tilt, azimuth = posture.pose
    tilts = np.linspace(tilt, np.pi, _ALONG)
    poses = np.stack([np.full(_ALONG, z), tilts, np.full(_ALONG, azimuth)], axis=-1)
    k = mode_sign(posture.mode) * design.platform_radius
    w = np.sin(3.0 * azimuth)
    sign = np.sign(polynomial.value(design.mechanism, design.base_radius, k, z, tilts[:-1], w))
    lengths = posing.limb_lengths(design, poses, posture.mode)
    low, high = design.stroke
    with np.errstate(invalid="ignore"):
        out = ~((lengths >= low - 1e-9) & (lengths <= high + 1e-9)).all(axis=-1)
    turned = sign != sign[0]
    first_out = int(out.argmax()) if out.any() else _ALONG
    first_turned = int(turned.argmax()) if turned.any() else _ALONG
    if first_out == _ALONG and first_turned == _ALONG:
        return ""
    if first_turned <= first_out:
        return f"a parallel singularity is met at about {np.degrees(tilts[first_turned]):.0f}°"
    if first_out == 0:
        return "the limbs are beyond their strokes from the first"
    return f"a stroke ends at about {np.degrees(tilts[first_out]):.0f}°"
