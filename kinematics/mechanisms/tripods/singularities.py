"""Where a posture has lost control, and where the operation mode may change.

Parallel singularities: P(Z, θ, sin 3φ) = 0. Constraint singularities: x0 = x3 = 0, a tilt of 180°,
which belongs to both operation modes; nowhere else do they meet (Nayak et al. 2017, section 5.1).
Serial: a limb without length.
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.singularities import ModeChange, Singularity
from kinematics.answers.solutions import Posture
from kinematics.facets.inverse import posture as posture_at
from kinematics.mechanisms.tripods import polynomial
from kinematics.mechanisms.tripods.design import SUBSCRIPTS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.limbs import limb_lengths
from kinematics.mechanisms.tripods.loci import Loci
from kinematics.screws.singularity_geometry import listed

MEETING = 1e-9
"""rad from a tilt of 180° within which a pose belongs to both operation modes."""
_ALONG = 721  # tilts looked at on the way to the change of mode


class Singularities(Loci):
    """Serial ones by ρ/h2 of the limbs; without a direction of theirs no others can be told."""

    def serial(self, posture: Posture, tolerance: float) -> tuple[Singularity, ...]:
        length = self.design.platform_radius
        short = [i for i, r in enumerate(posture.joints) if r / length < tolerance]
        if not short:
            return ()
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

    def mode_change(self, posture: Posture, wanted: str = "") -> ModeChange:
        """Whether the machine stands where the operation modes meet, and if not, where they do.

        That is at a tilt of 180°; the way told is by more tilt, at the present altitude and
        azimuth.
        """
        design = self.design
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
            f"Operation mode {other} begins at a tilt of 180°, "
            f"{np.degrees(np.pi - tilt):.1f}° further"
            + (f"; on the straight way there {why}." if why else ", and the way there is free.")
        )
        return ModeChange(
            at, in_other_mode(design, at), False, abs(float(np.pi - tilt)), bool(why), text
        )


def in_other_mode(design: TripodDesign, posture: Posture) -> Posture:
    """The same configuration, at a tilt of 180°, told in the other operation mode."""
    z, _, azimuth = posture.pose
    other = "1" if posture.mode == "2" else "2"
    # (0, cos φ, sin φ, 0) of mode 2 is (0, sin φ₁, −cos φ₁, 0) of mode 1 with φ₁ = φ + 90°.
    turned = azimuth + (0.5 * np.pi if other == "1" else -0.5 * np.pi)
    turned = np.pi - (np.pi - turned) % (2.0 * np.pi)
    return posture_at(design, (z, np.pi, turned), other)


def _in_between(design: TripodDesign, posture: Posture) -> str:
    """What is met first when the tilt grows to 180°; "" if nothing is."""
    z, tilt, azimuth = posture.pose
    tilts = np.linspace(tilt, np.pi, _ALONG)
    poses = np.stack([np.full(_ALONG, z), tilts, np.full(_ALONG, azimuth)], axis=-1)
    k = mode_sign(posture.mode) * design.platform_radius
    w = np.sin(3.0 * azimuth)
    sign = np.sign(polynomial.value(design.mechanism, design.base_radius, k, z, tilts[:-1], w))
    lengths = limb_lengths(design, poses, posture.mode)
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
