"""The section of Fig. 17 (conference: Fig. 9), and claims about sections."""

from __future__ import annotations

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    claimed,
    compared,
    counts,
    drawn,
)
from app.features.paper.recomputed.postures import Postures, machine, postures
from app.features.paper.recomputed.rpur_model import J, K, about_y
from app.features.paper.recomputed.rpur_sections import AT, TABLES, TURNED, section
from app.features.paper.registry import computes
from kinematics.answers.sections import Construction

# --- the figure ----------------------------------------------------------------------------


@computes(J, "Fig. 17")
@computes(K, "Fig. 9")
def fig_17(item: Item) -> Outcome:
    degrees = (float(item.data["orientation"][0]), float(item.data["orientation"][1]))
    name, at = item.data["design"], float(item.data["at"])
    found = section(name, degrees, at)
    made = found.construction
    counted, error_of = sampled_area(name, degrees, at)
    return drawn(
        abs(counted - found.area) <= 4.0 * error_of,
        Quantity("area inside all five", found.area, unit="mm²"),
        Quantity("circles", float(len(made.circle_limb))),
        Quantity("lines", float(_straight(made))),
        Quantity("edges of the section", float(len(found.start))),
        Quantity("pieces", float(found.pieces)),
        proof="the exact section agrees with inverse kinematics at the points of a grid, "
        f"{counted:.0f} ± {2.0 * error_of:.0f} mm²",
    )


def sampled_area(name: str, degrees: tuple[float, float], at: float) -> tuple[float, float]:
    """The area of a section by inverse kinematics at the points of a grid, and its deviation."""
    found = section(name, degrees, at)
    low, high = found.start.min(axis=0) - 1.0, found.start.max(axis=0) + 1.0
    count = 160
    y, z = (np.linspace(a, b, 2 * count + 1)[1::2] for a, b in zip(low, high, strict=True))
    plane = np.stack(np.meshgrid(np.array([at]), y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    theta = np.radians(degrees[1])
    places = plane @ about_y(np.array([theta]))[0].T
    turned = np.broadcast_to(np.radians(degrees), (len(places), 2))
    inside = machine(name).inverse.inside(np.concatenate([places, turned], axis=1), None)
    cell = float(np.prod(high - low)) / count**2
    return float(inside.sum()) * cell, cell * (found.perimeter / np.sqrt(cell)) ** 0.5


@computes(J, "C20")
def c_20(item: Item) -> Outcome:
    made = section("rpur-table1", TURNED, AT).construction
    return counts(
        item.data["counts"],
        ("circles in the section of Fig. 17", len(made.circle_limb)),
        more=[Quantity("lines besides", float(_straight(made)))],
    )


def _straight(made: Construction) -> int:
    """Lines; a limb's may consist of two parts."""
    return len(np.unique(np.stack([made.line_limb, made.line[:, 0, 0].round(6)], 1), axis=0))


@computes(J, "C19")
def c_19(item: Item) -> Outcome:
    at: Postures = postures("rpur-table1")
    chance = np.random.default_rng(7)
    poses = at.poses[:100, None] + np.array([0, 1, 0, 0, 0]) * chance.uniform(-400, 400, (1, 60, 1))
    poses = poses.reshape(-1, 5)
    closes = np.isfinite(at.machine.mechanism.joints(poses, at.mode))
    places = at.machine.mechanism.transform(poses, at.mode)
    k = places[:, 1, 3, None] + places[:, 1, :3] @ at.s.T - at.a[:, 1]
    wrong = int((closes != (k >= 0.0)).sum())
    right = int((closes != (np.abs(k) <= at.link)).sum())
    return claimed(
        wrong == 0,
        Quantity("limbs told wrongly by K ≥ 0", float(wrong)),
        Quantity("limbs told wrongly by |K| ≤ l", float(right)),
        proof=f"of {closes.size} limbs at random poses K ≥ 0 tells {wrong} wrongly whether they "
        f"close, |K| ≤ l {right}",
    )


@computes(J, "C16")
@computes(K, "C9")
def c_16(item: Item) -> Outcome:
    name = TABLES[item.paper][0][1]
    limb = machine(name).table["limb"][0]
    low, high = item.data["stroke"]
    alike = all(
        each["link"] == limb["link"] and each["stroke"] == limb["stroke"]
        for each in machine(name).table["limb"]
    )
    if not alike:
        return claimed(False, proof="the limbs of the preset differ")
    return compared(
        Quantity("l of the preset", float(limb["link"]), str(item.data["link"]), "mm"),
        Quantity("ρ_min", float(limb["stroke"][0]), str(low), "mm"),
        Quantity("ρ_max", float(limb["stroke"][1]), str(high), "mm"),
    )
