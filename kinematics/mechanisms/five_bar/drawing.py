"""The five-bar as a machine: which bars, bodies and marks stand where at one posture.

It lies on a table, as such machines do: the paper's plane is z = 0 of the base frame, seen from
above. The links turn in four layers so that they pass one another: proximal 1 at the bottom, then
distal 1, distal 2 and proximal 2; P's hinge joins the two in the middle and carries the tool.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinematics.answers.drawings import Bar, Body, Dimension, Drawing, Mark, Point, letters
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.design import LIMBS, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import elbows

_PROXIMAL = 1.0, 4.0  # heights of the layers, in layers
_DISTAL = 2.0, 3.0


def drawing(design: FiveBarDesign, posture: Posture) -> Drawing:
    """The machine at ``posture``, in the base frame, mm; z up from the plane of the table."""
    size = 0.5 * design.size
    layer, thick = 0.055 * size, 0.022 * size
    p = np.array(posture.pose)
    closed = [bool(np.isfinite(q)) for q in posture.joints]
    held = enumerate(posture.joints)
    joints = np.array([q if np.isfinite(q) else _toward(design, i, p) for i, q in held])
    b = elbows(design, joints)
    bars: list[Bar] = []
    points: list[Mark] = []
    for i in range(LIMBS):
        limb, low, high = i + 1, layer * _PROXIMAL[i], layer * _DISTAL[i]
        a, name = design.base[i], f"limb{limb}"
        end = p if closed[i] else _short(design, i, b[i], p)
        bars += [
            Bar(f"{name}/proximal", _t(a, low), _t(b[i], low), 1.25 * thick, "cylinder", limb),
            Bar(f"{name}/link", _t(b[i], high), _t(end, high), thick, "link", limb),
            # The motor below, its shaft up to the link; the elbow's pin through both links.
            Bar(
                f"{name}/motor", _t(a, -1.6 * layer), _t(a, 0.2 * layer), 3.2 * thick, "base", limb
            ),
            Bar(f"{name}/R_A", _t(a, 0.2 * layer), _t(a, low + thick), 1.7 * thick, "joint", limb),
            Bar(
                f"{name}/R_B",
                _t(b[i], min(low, high) - 1.6 * thick),
                _t(b[i], max(low, high) + 1.6 * thick),
                1.3 * thick,
                "joint",
                limb,
            ),
        ]
        bars += _stops(design, i, low, size, thick)
        if not closed[i]:
            bars.append(Bar(f"{name}/gap", _t(end, high), _t(p, high), 0.5 * thick, "gap", limb))
        tops = np.array([*a, low + thick]), np.array([*b[i], max(low, high) + thick])
        points += letters(limb, A=tops[0], B=tops[1])
    bars.append(
        Bar(
            "R_P", _t(p, _DISTAL[0] * layer - 1.8 * thick), _t(p, 4.2 * layer), 1.3 * thick, "joint"
        )
    )
    points.append(Mark("P", "P", _t(p, 4.2 * layer)))
    tool = tuple((0.0, 0.0, z) for z in (0.45 * layer, 1.9 * layer))
    return Drawing(
        bars=tuple(bars),
        bodies=(
            Body("platform", tool, 0.9 * thick, "platform", "platform"),
            Body("base", _slab(design, layer, size), 0.6 * thick, "base", "base"),
        ),
        points=tuple(points),
        axes=(
            Mark("x", "x", (0.0, 0.0, 0.0), None, (1.0, 0.0, 0.0)),
            Mark("y", "y", (0.0, 0.0, 0.0), None, (0.0, 1.0, 0.0)),
        ),
        size=size,
        dimensions=tuple(_dimensions(design, b, p)),
    )


def _dimensions(design: FiveBarDesign, b: Array, p: Array) -> Iterator[Dimension]:
    """What the design's numbers are, in the plane z = 0."""
    zero = (0.0, 0.0, 0.0)
    for i in range(LIMBS):
        limb, at, elbow = i + 1, _t(design.base[i], 0.0), _t(b[i], 0.0)
        proximal, distal, turn = (((k, i),) for k in ("proximal", "distal", "joint_range_deg"))
        angle = f"θ{'₁₂'[i]}"
        yield Dimension("r₁", "proximal link, from A to B", "length", at, elbow, proximal, limb)
        yield Dimension("r₂", "distal link, from B to P", "length", elbow, _t(p, 0.0), distal, limb)
        text = "half of the base, from the middle to A"
        yield Dimension("r₃", text, "length", zero, at, (("half_base",),), limb)
        yield Dimension(angle, "driven angle, from +x to A B", "angle", at, elbow, turn, limb)


def _toward(design: FiveBarDesign, i: int, p: Array) -> float:
    """How a limb that cannot close stands: stretched towards P, or folded back."""
    away = p - design.base[i]
    angle = float(np.arctan2(away[1], away[0]))
    reach = float(np.hypot(*away))
    limb = design.limbs[i]
    inward = reach < abs(limb.proximal - limb.distal) and limb.proximal < limb.distal
    return angle + np.pi if inward else angle


def _short(design: FiveBarDesign, i: int, b: Array, p: Array) -> Array:
    """The tip of a distal link that points to P and does not get there."""
    away = p - b
    length = float(np.hypot(*away))
    unit = away / length if length > 0.0 else np.array([1.0, 0.0])
    return np.asarray(b + design.distal[i] * unit)


def _stops(design: FiveBarDesign, i: int, z: float, size: float, thick: float) -> Iterator[Bar]:
    """Short pegs at the ends of a joint's range, beside the motor."""
    if design.limbs[i].joint_range_deg is None:
        return
    for key, angle in zip(("min", "max"), design.joint_range[i], strict=True):
        ray = np.array([np.cos(angle), np.sin(angle)])
        near, far = (design.base[i] + reach * size * ray for reach in (0.11, 0.17))
        yield Bar(f"limb{i + 1}/{key}", _t(near, z), _t(far, z), 0.5 * thick, "stop", i + 1)


def _slab(design: FiveBarDesign, layer: float, size: float) -> tuple[Point, ...]:
    """A plate under both motors."""
    reach = 0.16 * size
    z = -1.7 * layer
    half = design.half_base + reach
    return tuple((x, y, z) for x in (-half, half) for y in (-reach, reach))


def _t(point: Array, z: float) -> Point:
    return float(point[0]), float(point[1]), float(z)
