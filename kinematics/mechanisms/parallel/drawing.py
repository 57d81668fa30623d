"""A parallel mechanism as a machine: bodies by joint type, links between them, at one posture."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from kinematics.answers.drawings import (
    Bar,
    Body,
    Drawing,
    Mark,
    corners,
    direction,
    joint,
    letters,
    pedestals,
    prismatic,
    round_plate,
    spot,
)
from kinematics.answers.modes import Mode
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanisms.parallel.limbs import Limb

if TYPE_CHECKING:
    from kinematics.mechanisms.parallel.mechanism import Parallel

_ARC = 6  # bars of an arc
_CORNERS = 20  # of a round base's rim
_FLAT = 1e-6  # of the size: points that lie in a plane


def drawing(mechanism: Parallel, posture: Posture) -> Drawing:
    """The machine at ``posture``, in the base frame, mm."""
    machine = mechanism.machine
    placed = mechanism.transform(posture.pose, posture.mode)
    signs = np.array(Mode.read(posture.mode).sigma or (1.0,) * len(machine.limbs))
    ends = np.asarray(machine.drives.points(placed))
    arms, _ = machine.drives.arms(placed, signs)
    size = _size(mechanism)
    bars: list[Bar] = []
    points: list[Mark] = []
    tips = [np.zeros(3)]
    feet = []
    for n, limb in enumerate(machine.limbs):
        if limb.drive == "direction":
            bars += _arcs(n + 1, limb, limb.a, arms[n], ends[n], machine.length, 0.018 * size)
            tips.append(limb.mark + machine.length * limb.b)
            tips.append(limb.mark)
            feet.append(limb.a + 1.25 * machine.length * limb.axis)
            continue
        bars += _limb(n + 1, limb, np.asarray(arms[n]), ends[n], placed, size)
        points += letters(n + 1, A=limb.a, B=ends[n])
        tips.append(limb.b)
        feet.append(_foot(limb))
    flat = machine.mobility.group == "planar"
    base = _base(np.array(feet), size, bars, machine.limbs[0].normal if flat else None)
    return Drawing(
        bars=tuple(bars),
        bodies=(
            Body("platform", corners(tips), 0.016 * size, "platform", "platform"),
            base,
        ),
        points=(*points, Mark("O", "O′", spot(placed[:3, 3]))),
        axes=(),
        size=size,
    )


def _size(mechanism: Parallel) -> float:
    """A typical length, mm: of the limbs at the reference, or of the machine."""
    machine = mechanism.machine
    ends = np.asarray(machine.drives.points(machine.reference))
    spans = [
        float(np.linalg.norm(end - limb.a))
        for limb, end in zip(machine.limbs, ends, strict=True)
        if limb.drive != "direction"
    ]
    return max(float(np.median(spans)) if spans else 0.0, machine.length)


def _foot(limb: Limb) -> Array:
    if limb.drive == "slider" and np.isfinite(limb.high - limb.low):
        return np.asarray(limb.a + limb.low * limb.axis)
    return limb.a


def _base(feet: Array, size: float, bars: list[Bar], normal: Array | None) -> Body:
    """A plate through the limbs' feet where these are flat; else a round one below them.

    Args:
        normal: of a machine that moves in a plane, which stands on its plate.
    """
    if normal is not None:
        under = feet - 0.09 * size * normal
        for n, (foot, at) in enumerate(zip(under, feet, strict=True), 1):
            bars.append(Bar(f"limb{n}/pedestal", spot(foot), spot(at), 0.03 * size, "base"))
        return Body("base", corners(under), 0.016 * size, "base", "base")
    around = feet - feet.mean(axis=0)
    if np.linalg.svd(around, compute_uv=False)[-1] <= _FLAT * size or len(feet) < 3:
        return Body("base", corners(feet), 0.016 * size, "base", "base")
    floor = float(feet[:, 2].min() - 0.09 * size)
    bars += pedestals(feet, floor, 0.022 * size)
    middle = 0.5 * (feet[:, :2].min(axis=0) + feet[:, :2].max(axis=0))
    radius = float(np.linalg.norm(feet[:, :2] - middle, axis=1).max()) + 0.08 * size
    rim = round_plate(middle, radius, floor, _CORNERS)
    return Body("base", rim, 0.016 * size, "base", "base")


def _limb(
    number: int, limb: Limb, arm: Array, end: Array, placed: Array, size: float
) -> Iterator[Bar]:
    name, thick, short = f"limb{number}", 0.016 * size, 1e-9 * size
    closes = bool(np.isfinite(arm).all())
    e = arm if closes else _nearest(limb, end)
    tip = end if closes or limb.drive == "leg" else e + _rod(limb) * direction(end - e, short)
    if limb.drive in ("leg", "elbow", "offset leg"):
        e = limb.a if limb.drive != "offset leg" else e
        head = e if limb.drive == "offset leg" else end
        if limb.drive == "elbow":
            yield from _elbow(number, limb, end, thick, closes)
        else:
            yield from _prismatic(number, limb, head, thick, short)
        if limb.drive == "offset leg":
            yield Bar(f"{name}/link", spot(e), spot(tip), 0.8 * thick, "link", number)
            yield joint(number, "U", e, 2.2 * thick * limb.normal, 0.9 * thick)
    else:
        if limb.drive == "crank":
            yield Bar(f"{name}/crank", spot(limb.a), spot(e), 1.3 * thick, "link", number)
            yield joint(number, "R_A", limb.a, 2.4 * thick * limb.axis, 1.8 * thick)
        else:
            yield from _rail(number, limb, thick)
            half = 1.6 * thick * limb.axis
            yield Bar(
                f"{name}/slide", spot(e - half), spot(e + half), 1.7 * thick, "cylinder", number
            )
        yield Bar(f"{name}/rod", spot(e), spot(tip), 0.8 * thick, "link", number)
        yield from _pin(number, "E", limb, e, tip, thick)
    if not closes and limb.drive != "leg":
        yield Bar(f"{name}/gap", spot(tip), spot(end), 0.5 * thick, "gap", number)
    if limb.drive in ("leg", "offset leg"):
        yield from _pin(number, "A", limb, limb.a, head, thick)
    axis = placed[:3, :3] @ limb.mark
    if limb.bond in ("platform plane", "normal axes", "universal", "planar", "parallelogram"):
        yield joint(number, "B", tip, 2.4 * thick * axis, 0.9 * thick)
    else:
        yield joint(number, "B", tip, 0.35 * thick * direction(tip - e, short), 1.35 * thick)


def _rod(limb: Limb) -> float:
    return limb.rod


def _pin(
    number: int, key: str, limb: Limb, at: Array, toward: Array, thick: float
) -> Iterator[Bar]:
    """A revolute or a ball joint where a limb has one."""
    if limb.bond in ("base plane", "planar", "normal axes", "universal", "parallelogram"):
        yield joint(number, f"R_{key}", at, 2.2 * thick * limb.normal, 0.9 * thick)
    else:
        half = 0.35 * thick * direction(toward - at, 1e-9 * thick)
        yield joint(number, f"S_{key}", at, half, 1.35 * thick)


def _prismatic(number: int, limb: Limb, head: Array, thick: float, short: float) -> Iterator[Bar]:
    low, high = limb.low - limb.shift, limb.high - limb.shift
    if not np.isfinite(high - low):
        length = float(np.linalg.norm(head - limb.a))
        low, high = 0.6 * length, 1.4 * length
    yield from prismatic(number, limb.a, head, np.array([max(low, 0.0), high]), thick, short)


def _elbow(number: int, limb: Limb, end: Array, thick: float, closes: bool) -> Iterator[Bar]:
    """Two links that make the way from A to B."""
    d = end - limb.a
    far = float(np.linalg.norm(d))
    along = (far**2 + limb.crank**2 - limb.rod**2) / (2.0 * max(far, 1e-300))
    along = float(np.clip(along, -limb.crank, limb.crank))
    unit = direction(d, 1e-300)
    side = np.cross(limb.axis, unit) * np.sqrt(max(limb.crank**2 - along**2, 0.0))
    e = limb.a + along * unit - side * limb.branch
    tip = e + limb.rod * direction(end - e, 1e-300)
    yield Bar(f"limb{number}/crank", spot(limb.a), spot(e), 1.2 * thick, "link", number)
    yield Bar(f"limb{number}/rod", spot(e), spot(tip), 0.9 * thick, "link", number)
    yield joint(number, "R_A", limb.a, 2.4 * thick * limb.axis, 1.5 * thick)
    yield joint(number, "R_E", e, 2.4 * thick * limb.axis, 1.8 * thick)


def _rail(number: int, limb: Limb, thick: float) -> Iterator[Bar]:
    name = f"limb{number}"
    low, high = limb.low, limb.high
    if not np.isfinite(high - low):
        low, high = -limb.rod, limb.rod
    ends = limb.a + low * limb.axis, limb.a + high * limb.axis
    yield Bar(f"{name}/rail", spot(ends[0]), spot(ends[1]), 0.6 * thick, "rail", number)
    half = 0.15 * thick * limb.axis
    for key, at in zip(("min", "max"), ends, strict=True):
        yield Bar(f"{name}/{key}", spot(at - half), spot(at + half), 1.2 * thick, "stop", number)


def _nearest(limb: Limb, end: Array) -> Array:
    """Where E stands of a limb that cannot close: as near to B as it gets, or as far."""
    d = end - limb.a
    if limb.drive == "slider":
        return np.asarray(limb.a + float(d @ limb.axis) * limb.axis)
    if limb.drive == "offset leg":
        return np.asarray(end - float((end - limb.a) @ limb.normal) * limb.normal)
    flat = d - (d @ limb.axis) * limb.axis
    side = (
        1.0 if np.linalg.norm(flat) > abs(limb.crank - limb.rod) or limb.crank > limb.rod else -1.0
    )
    way = flat if np.linalg.norm(flat) > 0.0 else limb.zero
    return np.asarray(limb.a + side * limb.crank * way / np.linalg.norm(way))


def _arcs(
    number: int, limb: Limb, centre: Array, arm: Array, end: Array, radius: float, thick: float
) -> Iterator[Bar]:
    """Two curved links about a centre, from the base axis to the middle one and to the platform."""
    closes = bool(np.isfinite(arm).all())
    middle = arm if closes else limb.along * limb.axis + limb.zero
    outer, inner = 1.25 * radius, radius
    tip = end if closes else middle * limb.rod + _beside(middle, end) * np.sqrt(1.0 - limb.rod**2)
    for key, one, two, r in (("crank", limb.axis, middle, outer), ("rod", middle, tip, inner)):
        angle = float(np.arccos(np.clip(one @ two, -1.0, 1.0)))
        across = _beside(one, two)
        steps = np.linspace(0.0, angle, _ARC + 1)
        places = [centre + r * (np.cos(s) * one + np.sin(s) * across) for s in steps]
        for k in range(_ARC):
            bar = f"limb{number}/{key}{k}"
            yield Bar(bar, spot(places[k]), spot(places[k + 1]), 0.9 * thick, "link", number)
    reach = 0.5 * (outer - inner) + 1.6 * thick
    between = centre + 0.5 * (outer + inner) * middle
    yield joint(number, "R_A", centre + outer * limb.axis, 2.4 * thick * limb.axis, 1.7 * thick)
    yield joint(number, "R_E", between, reach * middle, 1.2 * thick)
    yield joint(number, "R_B", centre + inner * tip, 2.0 * thick * tip, 1.3 * thick)
    if not closes:
        places = [centre + inner * v for v in (tip, end)]
        yield Bar(f"limb{number}/gap", spot(places[0]), spot(places[1]), 0.5 * thick, "gap", number)


def _beside(one: Array, two: Array) -> Array:
    """The direction normal to one towards another."""
    across = two - (one @ two) * one
    if np.linalg.norm(across) < 1e-9:
        across = np.cross(one, np.eye(3)[int(np.abs(one).argmin())])
    return np.asarray(across / np.linalg.norm(across))
