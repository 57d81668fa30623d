"""From the wrenches of a posture to its singularities, with their cause in the field's words.

For whatever mechanism: it hands in its `motion.WrenchSystem` at one posture, and how a twist of the
platform is a motion of its own coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isinf

import numpy as np

from kinematics.answers.motion import WrenchName, WrenchSystem
from kinematics.answers.singularities import AT, Singularity, SingularityKind
from kinematics.arrays import Array
from kinematics.screws.lines import Circuit, Geometry, geometry
from kinematics.screws.varieties import Screw, Variety, Vector


def lost(
    system: WrenchSystem,
    point: Sequence[float],
    length: float,
    pose_rates: Callable[[Array], Sequence[float]],
    tolerance: float = AT,
) -> tuple[Singularity, ...]:
    """The parallel and constraint singularities of a posture, one for each motion that is free.

    Args:
        system: at one posture, rows (R, 6) and points (R, 3).
        point: (3,) mm, O′ in the base frame, the reference point of the rows.
        length: mm, the characteristic length.
        pose_rates: d(pose) of a twist [ω, v of O′]; not finite where the pose has no such rates.
        tolerance: a smallest singular value of the normalised wrenches below this is reported.

    Returns:
        Constraint singularities first; empty where the platform is held, or where some wrench is
        not known (NaN).
    """
    if system.rows.ndim != 2 or not np.isfinite(system.rows).all():
        return ()
    constraints = [n for n, name in enumerate(system.names) if name.kind == "constraint"]
    found = geometry(system.rows, length, tolerance, point, constraints)
    answer: list[Singularity] = []
    for n, circuit in enumerate(found.circuits[: len(found.twists)]):
        kind: SingularityKind = (
            "constraint" if set(constraints).issuperset(circuit.members) else "parallel"
        )
        twist = np.array(found.twists[n])
        measure = _measure(found, n)
        answer.append(
            Singularity(
                kind=kind,
                limbs=_limbs(circuit.members, system.names),
                cause=("nearly: " if measure >= AT else "") + cause(circuit, system.names),
                text=_text(kind, measure, found, n),
                measure=measure,
                motion=_motion(twist, pose_rates, length),
                twist=tuple(twist.tolist()),
            )
        )
    return tuple(sorted(answer, key=lambda each: each.kind != "constraint"))


def cause(circuit: Circuit, names: Sequence[WrenchName]) -> str:
    """What dependent wrenches have in common: "the forces of limbs 1, 2 and 4 lie in a plane and
    meet in the point (…) mm"."""
    who = wrench_list(circuit.members, names)
    one = len(circuit.members) == 1
    return f"{who} {_common(circuit.variety, one=one)}"


def wrench_list(members: Sequence[int], names: Sequence[WrenchName]) -> str:
    """ "the forces of limbs 1 and 2, and the constraint of limb 3"."""
    parts = []
    for kind, noun in (("actuation", "line"), ("constraint", "constraint")):
        chosen = [names[n] for n in members if names[n].kind == kind]
        limbs = sorted({name.limb for name in chosen if name.limb is not None})
        if limbs:
            several = len([name for name in chosen if name.limb is not None]) > 1
            parts.append(
                f"the {noun}{'s' if several else ''} of limb{'s' if len(limbs) > 1 else ''} "
                f"{listed(limbs)}"
            )
        if any(name.limb is None for name in chosen):
            parts.append("the constraint couple" if kind == "constraint" else "the actuation")
    return " and ".join(parts)


def listed(numbers: Sequence[int]) -> str:
    """ "1, 2 and 4"."""
    words = [str(number) for number in numbers]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def motion_text(axis: Screw) -> str:
    """A screw as a designer reads it: "a turn about the axis through (…) mm along (…)"."""
    if axis.point is None:
        return f"a translation along {direction_text(axis.direction)}"
    about = f"the axis through {point_text(axis.point)} along {direction_text(axis.direction)}"
    if axis.pitch == 0.0:
        return f"a turn about {about}"
    return f"a screw motion about {about}, pitch {axis.pitch:.3g} mm/rad"


def point_text(point: Vector) -> str:
    """ "(12.3, −4.0, 5.6) mm"."""
    return "({}) mm".format(", ".join(f"{v + 0.0:.1f}" for v in np.round(point, 1)))


def direction_text(direction: Vector) -> str:
    """ "(0, 1, 0)", to three decimals."""
    return "({})".format(", ".join(f"{v + 0.0:.3g}" for v in np.round(direction, 3)))


# --- inside --------------------------------------------------------------------------------


def _measure(found: Geometry, n: int) -> float:
    """The n-th smallest singular value; 0 where there are fewer values than directions."""
    values = [*found.singular_values, *[0.0] * (6 - len(found.singular_values))]
    return values[5 - n]


def _limbs(members: Sequence[int], names: Sequence[WrenchName]) -> tuple[int, ...]:
    limbs = {names[n].limb for n in members}
    return tuple(sorted(limb for limb in limbs if limb is not None))


def _motion(
    twist: Array, pose_rates: Callable[[Array], Sequence[float]], length: float
) -> tuple[float, ...] | None:
    """d(pose), of the size that the twist has: 1, with ω times the characteristic length."""
    rates = tuple(float(v) for v in pose_rates(twist))
    return rates if np.isfinite(rates).all() else None


def _text(kind: SingularityKind, measure: float, found: Geometry, n: int) -> str:
    free = motion_text(found.screws[n])
    count = len(found.twists)
    which = f" (one of {count} free motions)" if count > 1 else ""
    if measure >= AT:
        return f"Near a {kind} singularity: the platform yields most to {free}{which}."
    if kind == "constraint":
        return f"Constraint singularity: the constraints no longer forbid {free}{which}."
    return f"Parallel singularity: with all actuators locked the platform is free in {free}{which}."


def _line(axis: Screw) -> str:
    if axis.point is None:
        return f"the line at infinity of planes normal to {direction_text(axis.direction)}"
    return f"the line through {point_text(axis.point)} along {direction_text(axis.direction)}"


def _common(v: Variety, *, one: bool) -> str:
    point = "" if v.point is None else point_text(v.point)
    normal = "" if v.normal is None else direction_text(v.normal)
    along = "" if v.direction is None else direction_text(v.direction)
    match v.kind:
        case "zero":
            return "vanishes" if one else "vanish"
        case "line":
            return "coincide"
        case "couple":
            return f"are couples about parallel axes, {along}"
        case "pencil":
            return (
                f"lie in one plane, normal to {normal}, and meet in the point {point}: a flat "
                "pencil"
            )
        case "parallel pencil":
            return (
                f"are parallel and lie in one plane, normal to {normal}: a flat pencil at infinity"
            )
        case "couples":
            return "are couples parallel to one plane"
        case "bundle":
            return f"meet in one point, {point}: a bundle"
        case "parallel bundle":
            return f"are all parallel, along {along}: a bundle at infinity"
        case "plane":
            return f"lie in one plane, through {point} and normal to {normal}: a plane field"
        case "all couples":
            return "are couples"
        case "two pencils":
            return f"form two flat pencils that share {_line(v.axes[0])}"
        case "regulus":
            return "are rulings of one hyperboloid: a regulus"
        case "paraboloid":
            return "are rulings of one hyperbolic paraboloid: a regulus with a line at infinity"
        case "hyperbolic congruence":
            both = " and ".join(_line(axis) for axis in v.axes)
            return f"all meet two lines, {both}: a hyperbolic congruence"
        case "elliptic congruence":
            return "belong to an elliptic congruence"
        case "parabolic congruence":
            return f"all meet {_line(v.axes[0])}: a parabolic congruence"
        case "degenerate congruence":
            place = f"the point {point}" if v.direction is None else f"infinity along {along}"
            if v.point is None:
                place = "a line at infinity"
            return (
                f"each lie in one plane, normal to {normal}, or pass through {place} of it: a "
                "degenerate congruence"
            )
        case "special complex":
            return f"all meet {_line(v.axes[0])}: a special linear complex"
        case "general complex":
            axis = v.axes[0]
            pitch = "" if isinf(axis.pitch) else f" with pitch {axis.pitch:.3g} mm/rad"
            return f"belong to a general linear complex about {_line(axis)}{pitch}"
        case "screws":
            return "are dependent"
        case "space":
            return "are more than six"
