"""Wang et al. (2017): why its ranges cannot be reproduced, and what can be told all the same."""

from __future__ import annotations

from typing import Any

import numpy as np

import kinematics as kin
from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    missing,
)
from app.features.paper.recomputed.sps_spr import LEGS, LEVEL, SPR, W, machine, poses
from app.features.paper.registry import computes
from kinematics.arrays import Array
from kinematics.machine import Machine

# --- the ranges ----------------------------------------------------------------------------


def pentagons(w: float, *, angle: float = 0.0) -> Machine[Any]:
    """A_1 = (w, 0, 0) and A_2 … A_5 at multiples of 72°, B_i a regular pentagon."""
    return _layout(w, [72.0 * k for k in range(1, 5)], [angle + 72.0 * k for k in range(5)])


def _layout(w: float, base: list[float], platform: list[float]) -> Machine[Any]:
    a = [[w, 0.0, 0.0], *(_on(400.0, degrees) for degrees in base)]
    b = [_on(100.0, degrees) for degrees in platform]
    last = np.radians(platform[-1])
    lines = ['mechanism = "four_sps_spr"']
    lines.append(f"revolute_axis = [{-np.sin(last)}, {np.cos(last)}, 0.0]")
    for one, other in zip(a, b, strict=True):
        lines += ["[[limb]]", f"base = {one}", f"platform = {other}", "stroke = [100.0, 2000.0]"]
    return kin.read("\n".join(lines))


def _on(radius: float, degrees: float) -> list[float]:
    angle = np.radians(degrees)
    return [float(radius * np.cos(angle)), float(radius * np.sin(angle)), 0.0]


def smallest(made: Machine[Any], pose: Array) -> float:
    """The smallest singular value of G, moments by 100 mm."""
    rows = made.statics.at(pose, made.modes[0]).rows / np.repeat([1.0, 100.0], 3)
    return float(np.linalg.svd(rows, compute_uv=False)[-1])


@computes(W, "C4")
def c_4(item: Item) -> Outcome:
    low, high = np.array(item.data["low"]), np.array(item.data["high"])
    middle = 0.5 * (low + high)
    middle[3:] = np.radians(middle[3:])
    made = machine()
    on = np.array(made.complete_pose([np.nan, *middle[1:].tolist()], made.home.mode))
    at = poses()
    placed = made.mechanism.transform(middle, made.home.mode)
    off = float((at.a[SPR] - placed[:3, 3] - placed[:3, :3] @ at.b[SPR]) @ placed[:3, :3] @ at.axis)
    return missing(
        Quantity("freedoms of the machine", 5.0),
        Quantity("ranges printed", float(len(low))),
        Quantity("constraint at the middle of all ranges, preset", off, unit="mm"),
        Quantity("X that the constraint gives there", float(on[0]), unit="mm"),
    )


@computes(W, "C5")
def c_5(item: Item) -> Outcome:
    low, high = np.array(item.data["low"]), np.array(item.data["high"])
    level = np.array([0.0, 0.0, LEVEL, 0.0, 0.0, 0.0])
    equal = pentagons(400.0)
    legs = equal.mechanism.joints(level[None], equal.modes[0])[0]
    common = f"{low.max():.1f} … {high.min():.1f}"
    other = pentagons(500.0).mechanism.joints(level[None], equal.modes[0])[0]
    inside = bool((other >= low).all() and (other <= high).all())
    worst = max(smallest(pentagons(w), level) for w in (400.0, 450.0, 500.0, -300.0))
    told = ", ".join(f"{v:.1f}" for v in other)
    spread = float(legs.max() - legs.min())
    return missing(
        Quantity(
            "spread of the legs, two pentagons with W = 400, level on the axis", spread, unit="mm"
        ),
        Quantity(
            "length that lies in all five printed ranges",
            common if low.max() <= high.min() else f"none ({common})",
            unit="mm",
        ),
        Quantity("legs with W = 500", told, unit="mm"),
        Quantity("all within the printed ranges", "yes" if inside else "no"),
        Quantity("smallest singular value of G there, W = 400, 450, 500, −300", worst),
    )


@computes(W, "C6")
def c_6(item: Item) -> Outcome:
    found = machine().workspace(gamma=None).solid("preview")
    return missing(
        Quantity(
            "workspace of the preset at α = β = 0, γ following", round(found.volume), unit="mm³"
        ),
    )


@computes(W, "C7")
def c_7(item: Item) -> Outcome:
    made, quantities = machine(), []
    for y in (-200.0, 0.0, 200.0):
        pose = made.complete_pose([float("nan"), y, 520.0, 0.0, 0.0, 0.0], made.home.mode)
        held = made.statics.forces(pose, made.home.mode, item.data["load"])
        worst = float(np.abs(held.forces[:LEGS]).max())
        place = f"x = {pose[0]:.0f}, y = {y:.0f}, z = 520 mm".replace("-", "−")
        quantities.append(Quantity(f"largest leg force at {place}", worst, unit="N"))
    return missing(*quantities)


@computes(W, "forward displacement")
def forward(item: Item) -> Outcome:
    made = machine()
    own = made.forward([float(v) for v in poses().joints[0]])
    other = pentagons(400.0)
    tilted = np.array(
        other.complete_pose([float("nan"), 30.0, LEVEL, 0.1, 0.15, -0.1], other.modes[0])
    )
    legs = other.mechanism.joints(tilted[None], other.modes[0])[0]
    two = other.forward([float(v) for v in legs])
    return missing(
        Quantity("complex solutions of the preset", float(own.complex_count)),
        Quantity("real ones of one pose's legs", float(len(own))),
        Quantity("complex solutions of two regular pentagons", float(two.complex_count)),
    )
