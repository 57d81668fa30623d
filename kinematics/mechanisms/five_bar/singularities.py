"""Where the five-bar loses control: at a posture, and where two working modes meet.

Working modes meet where a limb is stretched, folded, or folded onto its base. Only there can a
machine change its working mode; everywhere else the elbow would have to leap. Lengths mm, angles
rad.
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.modes import one_of
from kinematics.answers.sections import BOUNDS
from kinematics.answers.singularities import AT, ModeChange, Singularity, SingularityKind
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.inverse import posture as posture_at
from kinematics.facets.paths import PathsFacet
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.design import LIMBS, SUBSCRIPTS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import MODES, elbows
from kinematics.mechanisms.five_bar.loci import Loci, base_points
from kinematics.mechanisms.five_bar.nearest_pose import nearest_on
from kinematics.mechanisms.five_bar.statics import sines

HERE = 1e-7
"""Part of the size: so near to the place where modes meet a machine stands in it."""
_LINK = BOUNDS.index("link")


class Singularities(Loci):
    """Measures are sines of angles between links."""

    def at(self, posture: Posture, tolerance: float = AT) -> tuple[Singularity, ...]:
        """What control is lost at a posture; empty as a rule, and where it does not close."""
        design, at = self.design, posture
        if not at.closes:
            return ()
        p, q = np.array(at.pose), np.array(at.joints)
        limbs, between = sines(design, p, q)
        found: list[Singularity] = []
        for i in range(LIMBS):
            rho = float(np.hypot(*(p - design.base[i])))
            if rho <= tolerance * design.size:
                text = f"with P on A{SUBSCRIPTS[i]} limb {i + 1} may turn as it likes"
                found.append(
                    Singularity(
                        "serial", (i + 1,), f"limb {i + 1} is folded onto its base", text, 0.0
                    )
                )
            elif abs(float(limbs[i])) <= tolerance:
                far = rho > float(design.proximal[i])
                cause = f"limb {i + 1} is {'stretched' if far else 'folded'}"
                text = (
                    f"P cannot be moved along limb {i + 1} by its actuator, whose two solutions "
                    "meet"
                )
                found.append(Singularity("serial", (i + 1,), cause, text, abs(float(limbs[i]))))
        if abs(float(between)) <= tolerance:
            found.append(_parallel(design, p, q, abs(float(between))))
        return tuple(found)

    def mode_change(self, posture: Posture, wanted: str = "") -> ModeChange | None:
        """The way to where one limb can go over to its other working mode.

        Of all such places the nearest to which P can go straight, without a parallel singularity or
        the end of a range in between; if there is none, the nearest.

        Args:
            wanted: a mode; only limbs that differ from it are asked for. "": any limb.

        Returns:
            None where the posture cannot be held, or no limb has such a place in this mode.
        """
        design, at, paths = self.design, posture, self.other(PathsFacet)
        if not at.reachable:
            return None
        goal = wanted or "".join("-" if sign == "+" else "+" for sign in at.mode)
        one_of(goal, MODES)
        p = np.array(at.pose)
        ways: list[tuple[bool, float, int, Array]] = []
        for i in range(LIMBS):
            if goal[i] != at.mode[i]:
                for point in _places(design, at.mode, i, p):
                    move = paths.segment(p, _short(p, point), at.mode)
                    stopped = any(e.stops for e in paths.events(move))
                    ways.append((stopped, float(np.hypot(*(point - p))), i, point))
        if not ways:
            return None
        blocked, distance, i, point = min(ways, key=lambda way: way[:3])
        other = at.mode[:i] + goal[i] + at.mode[i + 1 :]
        here = distance <= HERE * design.size
        there = _held(design, at.mode, other, point)
        if there is None:
            return None
        x, y = there[0].pose
        if here:
            text = (
                f"limb {i + 1} is in its serial singularity: it may go on in mode {_shown(other)}"
            )
        else:
            free = "on the straight way a singularity or the end of a range is met"
            text = (
                f"limb {i + 1} goes over to mode {_shown(other)} only where it is stretched or "
                f"folded, next at x = {x:.3f} mm, y = {y:.3f} mm, {distance:.1f} mm away; "
                f"{free if blocked else 'the way there is free'}"
            )
        return ModeChange(there[0], there[1], here, 0.0, blocked, text)


def _parallel(design: FiveBarDesign, p: Array, q: Array, measure: float) -> Singularity:
    b = elbows(design, q)
    unit = (p - b[0]) / design.distal[0]
    free = np.array([-unit[1], unit[0]])
    kind: SingularityKind = "parallel"
    together = float(np.hypot(*(b[1] - b[0]))) <= AT * design.size
    if together:
        cause, kind = "B₁ and B₂ coincide", "self-motion"
        text = "P turns freely about B₁ = B₂ with both actuators locked"
    else:
        extended = float(unit @ (p - b[1])) < 0.0
        cause = "B₁, P and B₂ are in line" + ("" if extended else ", folded")
        text = "P can move across the line of its distal links although both actuators are locked"
    return Singularity(
        kind,
        (1, 2),
        cause,
        text,
        measure,
        motion=(float(free[0]), float(free[1])),
        twist=(0.0, 0.0, 0.0, float(free[0]), float(free[1]), 0.0),
    )


def _places(design: FiveBarDesign, mode: str, i: int, p: Array) -> list[Array]:
    """The nearest point of each circle on which limb i has only one working mode."""
    edges = [
        edge
        for loop in workspace.loops(design, (mode,))
        for edge in loop
        if int(edge.shown.bound[0]) == _LINK and int(edge.shown.limb[0]) == i + 1
    ]
    found = [nearest[1] for edge in edges if (nearest := nearest_on([edge], p)) is not None]
    if (
        i in base_points(design)
        and posture_at(design, tuple(design.base[i].tolist()), mode).reachable
    ):
        found.append(design.base[i])
    return found


def _short(p: Array, point: Array) -> Array:
    """Just before a point, so that what happens at the point itself is not on the way."""
    return np.asarray(p + (1.0 - 1e-6) * (point - p))


def _held(
    design: FiveBarDesign, mode: str, other: str, point: Array
) -> tuple[Posture, Posture] | None:
    """The postures of both modes at a point, or a rounding towards where both can be held."""
    base = design.base
    for part in (0.0, 1e-14, 1e-13, 1e-12):
        for toward in (base[0] + base[1], *(2.0 * point - each for each in base), *base):
            pose = tuple((point + part * (toward - point)).tolist())
            one, two = posture_at(design, pose, mode), posture_at(design, pose, other)
            if one.reachable and two.reachable:
                return one, two
    return None


def _shown(mode: str) -> str:
    return mode.replace("-", "−")
