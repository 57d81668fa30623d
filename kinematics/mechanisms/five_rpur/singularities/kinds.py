"""Which singularities a posture of the 5-RPUR is in, and why, by Grassmann line geometry.

Serial: q = σh = 0, a limb's link parallel to e1, where its two working modes meet; or ρ = 0.
Parallel: the five forces and the couple are dependent. Two of them last over a finite motion in the
paper's simplified designs (Tale Masouleh et al., Meccanica 46 (2011)): in {A1A1} where the first
axes of both merged U joints lie on one line (after eq. 12), in {A1A2} where the merged U joint
comes onto the line along e1 through the shared base point (after eq. 25; that the actuators of A1
are aligned then, as the paper says, is so only where their base points lie in one plane with that
line). There is no constraint singularity: the couple is along e1 × e2, and e1 and e2 are always
normal to each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinematics.answers.singularities import AT, NEAR, Singularity
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.following import ClosureFollowing
from kinematics.facets.motion import MotionFacet
from kinematics.facets.statics import StaticsFacet
from kinematics.mechanisms.five_rpur.arrangements import Group, arrangements
from kinematics.mechanisms.five_rpur.design import LIMBS, SUBSCRIPTS, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import joint_points
from kinematics.mechanisms.five_rpur.singularities.curves import Loci
from kinematics.screws.singularity_geometry import listed, point_text
from kinematics.screws.varieties import EXACT
from kinematics.screws.wrenches import singular_values

_STILL = 1e-5  # curvature, without unit, below which a free motion goes on to second order
_CLOSE = 1e-6  # characteristic lengths within which two axes are one
_AROUND = 24, 0.05  # poses tried about one for what holds everywhere, and their spread


class Singularities(Loci):
    """Serial ones by h/l and ρ/l of the limbs, parallel ones with what the paper calls them."""

    def serial(self, posture: Posture, tolerance: float) -> tuple[Singularity, ...]:
        return _serial(self.design, posture, tolerance)

    def parallel(self, posture: Posture, tolerance: float) -> tuple[Singularity, ...]:
        return tuple(
            self._explained(posture, each) for each in super().parallel(posture, tolerance)
        )

    def _explained(self, posture: Posture, found: Singularity) -> Singularity:
        """One with what is particular about it: for every pose, or for a motion."""
        design = self.design
        if self._everywhere(posture, found.limbs):
            return _architectural(design, posture, found)
        name = _named(design, posture)
        cause = f"{name}; {found.cause}" if name else found.cause
        if found.measure >= AT or found.motion is None:
            return replace(found, cause=cause)
        following: ClosureFollowing[FiveRPURDesign] = self.mechanism.facet("following")
        if following.moves_on(posture):
            text = found.text.replace("Parallel singularity", "Self-motion").removesuffix(".")
            text = f"{text}; this goes on over a finite way."
            return replace(found, kind="self-motion", cause=cause, text=text)
        bent = self._curvature(posture, found.motion)
        how = ""
        if bent is not None:
            how = (
                " It is stopped at second order: two assembly modes merge here."
                if bent > _STILL
                else " It goes on to second order, but not over a finite way."
            )
        return replace(found, cause=cause, text=found.text + how)

    def _everywhere(self, posture: Posture, limbs: Sequence[int]) -> bool:
        """Whether the wrenches of these limbs and the couple are dependent at every pose nearby."""
        tries, spread = _AROUND
        rng = np.random.default_rng(20110401)
        reach = spread * np.array([*[float(self.design.link.min())] * 3, 1.0, 1.0])
        poses = np.array(posture.pose) + rng.uniform(-reach, reach, (tries, 5))
        rows = self.other(StaticsFacet).at(poses, posture.mode).rows
        rows = rows[:, [*(i - 1 for i in limbs), LIMBS]]
        rows = rows[np.isfinite(rows).all(axis=(1, 2))]
        values = singular_values(rows, self.design.length)[:, -1]
        return len(values) > 2 and bool((values < EXACT * 1e-2).all())

    def _curvature(self, posture: Posture, motion: Sequence[float]) -> float | None:
        """How much locked actuators bend a free motion away at second order; None if not known.

        With rows a_i ẋ = t_i ρ̇_i and Σ n_i a_i = 0, a motion with ρ constant has to have
        Σ n_i t_i ρ̈_i = 0 where the pose goes straight on.
        """
        pose, length = np.array(posture.pose), self.design.length
        held = self.other(StaticsFacet).at(pose, posture.mode)
        bent = self.other(MotionFacet).inverse(pose, posture.mode, motion).joint_accelerations
        axes = self.mechanism.velocity_axes(pose, posture.mode)
        rows = held.rows[:LIMBS] @ axes / [1.0, 1.0, 1.0, length, length]
        size = np.linalg.norm(rows, axis=1)
        if not (np.isfinite(bent).all() and (size > 0.0).all()):
            return None
        weights = np.linalg.svd(rows / size[:, None])[0][:, -1]
        return abs(float(weights @ (held.gain * bent / size))) * length


# --- serial --------------------------------------------------------------------------------


def _serial(design: FiveRPURDesign, posture: Posture, tolerance: float) -> tuple[Singularity, ...]:
    links = {m.limb: m.amount for m in posture.margins if m.bound == "link"}
    a, b, _ = joint_points(design, np.array(posture.pose), posture.mode)
    answer = []
    for i, limb in enumerate(design.limbs):
        number, name = i + 1, SUBSCRIPTS[i]
        offset = limb.link - links[number]  # |Y|
        height = float(np.sqrt(max((limb.link - offset) * (limb.link + offset), 0.0)))
        if height < tolerance * limb.link:
            at = height < AT * limb.link
            cause = (
                f"the link of limb {number} is parallel to e₁, at the end of its reach: h{name} = 0"
                if at
                else f"the link of limb {number} is nearly parallel to e₁: "
                f"h{name} = {height:.2g} mm"
            )
            # Then the planes of actuator and link are one, and the limb carries a pencil in it.
            if _slope(a[i], b[i], posture.pose[4]) < tolerance * limb.link:
                cause += ", and its actuator to e₂"
            text = (
                "its two working modes meet, and no actuator moves its platform point along e₁."
                if at
                else "its two working modes are about to meet, and its actuator hardly moves its "
                "platform point along e₁."
            )
            answer.append(_serial_one(number, height / limb.link, cause, text))
        rho = posture.joints[i]
        if rho < tolerance * limb.link:
            at = rho < AT * limb.link
            cause = (
                f"the actuator of limb {number} has no length: ρ{name} = 0"
                if at
                else f"the actuator of limb {number} has hardly any length: ρ{name} = {rho:.2g} mm"
            )
            text = "its U joint is at its base point, about which it turns without effect."
            answer.append(_serial_one(number, rho / limb.link, cause, text))
    return tuple(answer)


def _serial_one(limb: int, measure: float, cause: str, text: str) -> Singularity:
    head = "Serial singularity" if measure < AT else "Near a serial singularity"
    return Singularity("serial", (limb,), cause, f"{head} of limb {limb}: {text}", measure)


def _slope(a: Array, b: Array, theta: float) -> float:
    """|p|, how far B is from the line along e2 through A (both in one plane normal to e1), mm."""
    return abs(float(np.sin(theta) * (b[0] - a[0]) + np.cos(theta) * (b[2] - a[2])))


# --- parallel ------------------------------------------------------------------------------


def _architectural(design: FiveRPURDesign, posture: Posture, found: Singularity) -> Singularity:
    reasons = " ".join(arrangements(design).reasons)
    why = reasons or (
        f"In working mode {posture.mode} the wrenches of limbs {listed(found.limbs)} are dependent "
        "at every pose."
    )
    free = found.text.partition(": ")[2]
    text = f"Architectural singularity: {why} Here, {free}"
    return replace(found, kind="architectural", text=text)


def _named(design: FiveRPURDesign, posture: Posture) -> str:
    """What the paper calls the configuration, if it is one of its self-motions or next to one."""
    length = design.length
    within = NEAR * length
    elbows = joint_points(design, np.array(posture.pose), posture.mode)[1]
    merged = [g for g in arrangements(design).groups if _merged(g, posture.mode)]
    for k, one in enumerate(merged):
        first = elbows[one.limbs[0] - 1]
        for two in merged[k + 1 :]:
            second = elbows[two.limbs[0] - 1]
            if (apart := _apart(first, second)) <= within:
                return (
                    f"the first axes of the U joints of limbs {listed(one.limbs)} and of limbs "
                    f"{listed(two.limbs)} {_onto(apart, length)} through "
                    f"{point_text(_tuple(first))}"
                )
        for two in arrangements(design).groups:
            base = design.base[two.limbs[0] - 1]
            if two.kind == "A2" and (apart := _apart(first, base)) <= within:
                return (
                    f"the first axis of the U joint of limbs {listed(one.limbs)} and the base "
                    f"point of limbs {listed(two.limbs)} {_onto(apart, length)} through "
                    f"{point_text(_tuple(base))}"
                )
    return ""


def _merged(group: Group, mode: str) -> bool:
    """An A1 arrangement whose two U joints are one, as they are in one working mode."""
    return group.kind == "A1" and not group.middle and len({mode[i - 1] for i in group.limbs}) == 1


def _onto(apart: float, length: float) -> str:
    if apart <= _CLOSE * length:
        return "lie on one line along e₁"
    return f"are {apart:.2g} mm from one line along e₁"


def _apart(one: Array, two: Array) -> float:
    """The distance of two lines along e1."""
    return float(np.hypot(one[0] - two[0], one[2] - two[2]))


def _tuple(point: Array) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z
