"""How many solutions the simplified 5-RPUR designs have, and their self-motions."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    claimed,
    counts,
    error,
)
from app.features.paper.recomputed.postures import machine, of_machine, postures, with_limbs
from app.features.paper.recomputed.rpur_examples import (
    distinct,
    each_of,
    examples,
    flat,
    number_of,
    places,
    solved,
    turns,
    turns_of_roots,
)
from app.features.paper.recomputed.rpur_model import J, K
from app.features.paper.registry import computes
from kinematics.arrays import Array
from kinematics.machine import Machine

# --- {A1A1} --------------------------------------------------------------------------------


@computes(J, "C4")
@computes(K, "C5")
def c_4(item: Item) -> Outcome:
    theta, b, _ = places("{A1A1}")
    found = number_of(flat(b[:, [0, 2]]))
    return counts(
        item.data["counts"],
        ("places of B_12 and B_34, of a design with 96 real solutions", found),
        ("values of θ", number_of(theta)),
    )


@computes(J, "C5")
def c_5(item: Item) -> Outcome:
    theta, b, _ = places("{A1A1}")
    (found,) = each_of(distinct(theta), b[:, 4])
    return counts(item.data["counts"], ("places of B_5 for each θ", found))


@computes(J, "C6")
@computes(K, "C6", "C8")
def c_6(item: Item) -> Outcome:
    theta, b, one = places("{A1A1}")
    phi = one.found.poses[one.tied, 3]
    turn = np.stack([np.cos(phi), np.sin(phi)], axis=1)
    (found,) = each_of(distinct(np.concatenate([theta, flat(b) / 500.0], axis=1)), turn)
    return counts(item.data["counts"], ("values of φ for each θ and all B, all real", found))


@computes(J, "C7")
@computes(K, "C7")
def c_7(item: Item) -> Outcome:
    theta, _, one = places("{A1A1}")
    (each,) = {int((distinct(theta) == n).sum()) for n in range(number_of(theta))}
    return counts(
        item.data["counts"],
        ("solutions for each θ", each),
        ("complex solutions", one.complex_count),
        more=[
            Quantity("real ones of the example", float(len(one.tied))),
            Quantity(
                "complex solutions of Table 2, mixed modes too",
                float(solved("rpur-table2", (300, 310, 320, 330, 340)).complex_count),
            ),
        ],
    )


@computes(J, "C8")
def c_8(item: Item) -> Outcome:
    # B_12 and B_34 of Table 2 in one place: the posture is free to turn by θ.
    made, (x, z) = machine("rpur-table2"), item.data["b12"]
    a = postures("rpur-table2").a
    rho = np.hypot(x - a[:4, 0], z - a[:4, 2])
    sizes, fifth = [], []
    for theta in np.radians(item.data["thetas"]):
        pose = _through(made, float(x), float(z), float(theta))
        found = made.mechanism.joints(pose[None], "+++++")[0]
        fifth.append(float(found[4]))
        rows = made.statics.at(pose, "+++++").rows / np.repeat([1.0, made.length], 3)
        sizes.append(float(np.linalg.svd(rows, compute_uv=False)[-1]))
        sizes.append(error(found[:4], rho))
    moving = made.forward([*rho, fifth[0]]).self_motions
    return claimed(
        max(sizes) < 1e-9 and len(moving) > 0,
        Quantity("smallest singular value of the wrenches, three values of θ", max(sizes)),
        Quantity("ρ₁ … ρ₄", ", ".join(f"{v:.1f}" for v in rho), unit="mm"),
        Quantity("ρ₅", ", ".join(f"{v:.1f}" for v in fifth), unit="mm"),
        Quantity("self-motions that the forward kinematics reports", float(len(moving))),
        proof="with B_12 over B_34 Table 2 moves with ρ₁ … ρ₄ locked, within its strokes",
    )


def _through(made: Machine[Any], x: float, z: float, theta: float) -> Array:
    """A pose of Table 2 at φ = 0 in mode +++++ whose B_12 and B_34 are both at x, z."""
    limbs = made.table["limb"]
    y = 0.5 * (limbs[0]["base"][1] + limbs[2]["base"][1])
    reach = limbs[0]["link"] ** 2 - (y + limbs[0]["platform"][1] - limbs[0]["base"][1]) ** 2
    h = float(np.sqrt(reach))
    return np.array([x + h * np.sin(theta), y, z + h * np.cos(theta), 0.0, theta])


# --- {A1A2}, {MpA2} ------------------------------------------------------------------------


@computes(J, "C9")
def c_9(item: Item) -> Outcome:
    theta, _, _ = places("{A1A2}")
    return counts(item.data["counts"], ("values of θ, of a design with 96 real", number_of(theta)))


@computes(J, "C10")
def c_10(item: Item) -> Outcome:
    theta, b, _ = places("{A1A2}")
    groups = distinct(np.concatenate([theta, flat(b[:, [0]]) / 500.0], axis=1))
    (found,) = each_of(groups, flat(b[:, [2, 3]]))
    return counts(item.data["counts"], ("places of the A2 pair's U joints, all real", found))


@computes(J, "C11")
def c_11(item: Item) -> Outcome:
    one = examples()["{A1A2}"]
    return counts(
        item.data["counts"],
        ("complex solutions", one.complex_count),
        more=[
            Quantity("real ones of the example", float(len(one.tied))),
            Quantity(
                "complex ones, mixed modes of the A2 pair too", float(one.found.complex_count)
            ),
        ],
    )


@computes(J, "C12")
def c_12(item: Item) -> Outcome:
    base = machine("rpur-a1a2").table
    a3, a4 = item.data["a3"], item.data["a4"]
    limbs = [dict(limb) for limb in base["limb"]]
    for limb, (x, z) in zip(limbs[:2], (a3, a4), strict=True):  # the A1 pair
        limb["base"] = [float(x), limb["base"][1], float(z)]
        limb["platform"] = [0.0, *limb["platform"][1:]]
    for limb in limbs[2:4]:  # the A2 pair about the origin
        limb["base"] = [0.0, limb["base"][1], 0.0]
    s1, s2 = limbs[2]["platform"][0], limbs[3]["platform"][0]
    made = with_limbs(limbs, "merged_joints = [[1, 2]]")
    rho = [float(np.hypot(*a3)), float(np.hypot(*a4))]
    fitting = float(np.sqrt(300.0**2 - s1**2 + s2**2))  # ρ₂ with ρ₂² − ρ₁² + s₁² − s₂² = 0
    free = made.forward([*rho, 300.0, fitting, 320.0])
    stuck = made.forward([*rho, 300.0, fitting + 10.0, 320.0])
    angle = float(np.degrees(np.arccos(np.dot(a3, a4) / (rho[0] * rho[1]))))
    return claimed(
        len(stuck.self_motions) > 0 and angle in (0.0, 180.0),
        Quantity("self-motions with ρ₂² − ρ₁² + s₁² − s₂² = 0", float(len(free.self_motions))),
        Quantity("self-motions without it", float(len(stuck.self_motions))),
        Quantity("angle between the actuators of A1 at x_B34 = z_B34 = 0", angle, unit="°"),
        proof="with x_B34 = z_B34 = 0 the library finds "
        f"{'a self-motion' if free.self_motions else 'no self-motion'} where that sum vanishes and "
        f"{'one' if stuck.self_motions else 'none'} where it does not, and the actuators meet at "
        f"{angle:.0f}°",
    )


@computes(J, "C13")
def c_13(item: Item) -> Outcome:
    # {MpA3} with its three base points on a line: the planar 3-RPR with linear base and platform.
    one = examples()["{MpA2}"]
    most, every = turns(one.found, one.tied), 0
    made, chance = machine("rpur-mpa3"), np.random.default_rng(2)
    limbs = [dict(limb) for limb in made.table["limb"]]
    for limb, x in zip(limbs[:3], (-80.0, 20.0, 130.0), strict=True):
        limb["base"] = [x, limbs[0]["base"][1], 0.0]
    for found in with_limbs(limbs).forward(chance.uniform(120.0, 380.0, (12, 5))):
        tied = [n for n, mode in enumerate(found.modes) if len({*mode[:3]}) == 1]
        most = max(most, turns(found, np.array(tied, dtype=np.intp)))
        every = max(every, number_of(turns_of_roots(found, ((0, 1, 2),))))
    general = examples()["{MpA3}"]
    return counts(
        item.data["counts"],
        ("most real values of θ, linear base and platform, 13 cases", most),
        more=[
            Quantity("complex values of θ there", float(every)),
            Quantity(
                "real ones of {MpA3} with a general base",
                float(turns(general.found, general.tied)),
            ),
        ],
    )


@computes(J, "C14")
def c_14(item: Item) -> Outcome:
    one = examples()["{MpA2}"]
    return counts(
        item.data["counts"],
        ("complex solutions", one.complex_count),
        more=[
            Quantity("real ones of the example", float(len(one.tied))),
            Quantity("complex ones, mixed modes too", float(one.found.complex_count)),
        ],
    )


@computes(J, "C15")
def c_15(item: Item) -> Outcome:
    limbs = [dict(limb) for limb in machine("rpur-mpa2").table["limb"]]
    limbs[4] = {
        **limbs[4],
        "platform": limbs[3]["platform"],
        "link": limbs[3]["link"],
        "base": [limbs[4]["base"][0], limbs[3]["base"][1], limbs[4]["base"][2]],
    }
    made = with_limbs(limbs)
    smallest = []
    for one in (made, machine("rpur-mpa2")):
        at = of_machine(one, "+++++", 0.5)
        rows = one.statics.at(at.poses, at.mode).rows / np.repeat([1.0, one.length], 3)
        smallest.append(np.linalg.svd(rows, compute_uv=False)[:, -1])
    said = [f.title for f in made.findings if f.severity == "warning"]
    return claimed(
        bool(smallest[0].max() < 1e-9 and smallest[1].max() > 1e-3),
        Quantity("largest of the smallest singular values of {MpA2A1}", float(smallest[0].max())),
        Quantity("of {MpA2}", float(smallest[1].max())),
        Quantity("what the library says of {MpA2A1}", ", ".join(said) or "nothing"),
        proof="with the two other limbs an A1 pair the six wrenches are dependent at all of 200 "
        "random postures",
    )
