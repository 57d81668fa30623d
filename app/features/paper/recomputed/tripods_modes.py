"""Nayak et al. (2017): ideals, operation modes and the Jacobian of the constraint equations."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    claimed,
    compared,
    counts,
    error,
    identity,
)
from app.features.paper.recomputed.tripods_algebra import (
    COUNT,
    STEP,
    WHERE,
    N,
    Poses,
    both,
    constraints,
    dual,
    machine,
    poses,
    printed_m,
    quaternion,
    triangle,
)
from app.features.paper.registry import computes
from kinematics.answers.solutions import ForwardSolutions
from kinematics.arrays import Array

# --- ideals, Jacobian ----------------------------------------------------------------------


def equations(x: Any, y: Any, joints: Any, h1: float, h2: float) -> Any:
    """g_1 … g_8 (..., 8), homogeneous of degree two: lengths and 1 times Σ x²."""
    norm = (x**2).sum(axis=-1)
    shift, turn = printed_m(x, y)
    square = 4.0 * (y**2).sum(axis=-1)
    limbs = []
    for a, b, r in zip(triangle(h1), triangle(h2), np.moveaxis(joints, -1, 0), strict=True):
        # |p + R b − a|² Σ x², by the Study condition quadratic in x and y
        moved = (turn @ b) @ a
        first = (shift * a).sum(axis=-1)
        second = _back(x, y, b)
        constant = (a @ a + b @ b - r**2) * norm
        limbs.append(square + constant + 2.0 * second - 2.0 * first - 2.0 * moved)
    last = np.stack([(x * y).sum(axis=-1), norm - 1.0], axis=-1)
    return np.concatenate([constraints(x, y, h1), np.stack(limbs, axis=-1), last], axis=-1)


def _back(x: Any, y: Any, b: Array) -> Any:
    """p · R b, bilinear: −b · (the translation of the inverse displacement)."""
    sign = np.array([1.0, -1.0, -1.0, -1.0])
    shift, _ = printed_m(x * sign, y * sign)
    return -(shift * b).sum(axis=-1)


def jacobian(at: Poses) -> Array:
    """(N, 8, 8) of eq. 13 by the imaginary part."""
    z = np.concatenate([at.x, at.y], axis=1)
    columns = []
    for k in range(8):
        moved: NDArray[np.complex128] = z.astype(complex)
        moved[:, k] += 1j * STEP
        g = equations(moved[:, :4], moved[:, 4:], at.joints, at.h1, at.h2)
        columns.append(g.imag / STEP)
    return np.stack(columns, axis=-1)


@computes(N, "eq. 9")
def eq_9(item: Item) -> Outcome:
    off = 0.0
    for at in both("spr-3"):
        g = equations(at.x, at.y, at.joints, at.h1, at.h2)
        off = max(off, float(np.abs(g).max()) / float(at.joints.max()) ** 2)
    return identity(off, where=f"{WHERE}, all eight equations")


@computes(N, "eq. 10")
def eq_10(item: Item) -> Outcome:
    off = 0.0
    for at in both("spr-3"):
        g = equations(at.x, at.y, at.joints, at.h1, at.h2)[:, [0, 1, 2, 6]]
        off = max(off, float(np.abs(g).max()) / at.h1)
    return identity(off, where=f"{WHERE}, the four equations without lengths")


@computes(N, "eq. 11")
def eq_11(item: Item) -> Outcome:
    first, second = both("spr-3")
    x0, x3 = float(np.abs(first.x[:, 0]).max()), float(np.abs(second.x[:, 3]).max())
    other = min(float(np.abs(first.x[:, 3]).min()), float(np.abs(second.x[:, 0]).min()))
    least = min(float((at.x**2).sum(axis=1).min()) for at in (first, second))
    return claimed(
        max(x0, x3) < 1e-12 and other > 1e-3 and least > 0.5,
        Quantity("largest |x₀| in mode 1", x0),
        Quantity("largest |x₃| in mode 2", x3),
        Quantity("least of the other one there", other),
        Quantity("least Σ x², that is no pose on J_3", least),
        proof="every pose of the library lies on J_1 or on J_2, and none on J_3",
    )


@computes(N, "eq. 12")
def eq_12(item: Item) -> Outcome:
    off = 0.0
    found = forward()
    for one in found:
        for n, mode in enumerate(one.modes):
            turn = machine("spr-3").mechanism.transform(one.poses[n], mode)[:3, :3]
            x = quaternion(turn[None])[0]
            off = max(off, abs(float(x[0] if mode == "1" else x[3])))
    used = {mode for one in found for mode in one.modes}
    return claimed(
        off < 1e-7 and len(used) == 2 and all(one.complete for one in found),
        Quantity("complex solutions of K_1 and K_2 together", float(found[0].complex_count)),
        Quantity("real ones of 20 cases", float(sum(map(len, found)))),
        Quantity("largest |x₀| in K_1 or |x₃| in K_2", off),
        proof="each solution of the library lies on the ideal of its mode",
    )


@computes(N, "eq. 13")
def eq_13(item: Item) -> Outcome:
    # Where det J vanishes: at the library's singular tilts, and not beside them.
    on, beside = _at_singularities()
    return claimed(
        on < 1e-7 * beside,
        Quantity("largest |det J| at the library's singular poses, normed", on / beside),
        Quantity("smallest one degree of tilt beside them", beside / beside),
        proof="det J vanishes where the library says that the machine is singular",
    )


def _at_singularities() -> tuple[float, float]:
    """|det J| on the library's locus (largest) and a degree beside it (smallest)."""
    made = machine("spr-3")
    on: list[Array] = []
    beside: list[Array] = []
    for mode in ("1", "2"):
        spec = made.singularities.loci[0]
        curves = made.singularities.locus(spec.key, (100.0, 0.0, 0.0), mode)
        points = np.concatenate(curves.lost())
        points = points[(points[:, 0] > 0.2) & (points[:, 0] < 1.3)][::25]
        for step, kept in ((0.0, on), (np.radians(1.0), beside)):
            at = np.column_stack([np.full(len(points), 100.0), points[:, 0] + step, points[:, 1]])
            placed = made.mechanism.transform(at, mode)
            x = quaternion(placed[:, :3, :3])
            here = Poses(
                made,
                mode,
                at,
                placed[:, :3, :3],
                placed[:, :3, 3],
                x,
                dual(x, placed[:, :3, 3]),
                made.mechanism.joints(at, mode),
                100.0,
                200.0,
            )
            kept.append(np.abs(np.linalg.det(jacobian(here))))
    return float(np.concatenate(on).max()), float(np.concatenate(beside).min())


@computes(N, "eq. 14")
def eq_14(item: Item) -> Outcome:
    at = poses("spr-3", "1")
    z = np.concatenate([at.x, at.y], axis=1)
    whole = np.linalg.det(jacobian(at))
    twice = Poses(
        at.machine,
        at.mode,
        at.poses,
        at.turn,
        at.p,
        2.0 * at.x,
        2.0 * at.y,
        at.joints,
        at.h1,
        at.h2,
    )
    degree = np.log2(np.abs(np.linalg.det(jacobian(twice)) / whole))
    ratio = []
    for mode, index in (("1", 3), ("2", 0)):
        here = poses("spr-3", mode)
        small = here.x.copy()
        small[:, index] = 1e-9  # towards the constraint singularity
        near = Poses(
            here.machine,
            mode,
            here.poses,
            here.turn,
            here.p,
            small,
            here.y,
            here.joints,
            here.h1,
            here.h2,
        )
        ratio.append(np.abs(np.linalg.det(jacobian(near)) / np.linalg.det(jacobian(here))).max())
    return claimed(
        bool(np.allclose(degree, item.data["degree"], atol=1e-6) and max(ratio) < 1e-5 and z.size),
        Quantity("degree of det J", float(degree.mean()), str(item.data["degree"])),
        Quantity("det J at x₃ (mode 1), x₀ (mode 2) = 10⁻⁹, relative", float(max(ratio))),
        proof="det J is homogeneous of that degree and vanishes with x₃ in mode 1, x₀ in mode 2",
    )


@computes(N, "eq. 15")
def eq_15(item: Item) -> Outcome:
    chance = np.random.default_rng(1)
    phi, theta, psi = chance.uniform(0.1, 1.5, (3, COUNT))
    c, s = np.cos(0.5 * theta), np.sin(0.5 * theta)
    plus, minus = 0.5 * (phi + psi), 0.5 * (phi - psi)
    x = np.stack([c * np.cos(plus), s * np.cos(minus), s * np.sin(minus), c * np.sin(plus)], -1)
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_euler("ZXZ", np.stack([phi, theta, psi], axis=-1)).as_matrix()
    right = error(printed_m(x, 0.0 * x)[1], turn)
    torsion = []
    for at in both("spr-3"):
        euler = Rotation.from_matrix(at.turn).as_euler("ZXZ")
        torsion.append(
            float(np.degrees(np.abs(np.angle(np.exp(1j * (euler[:, 0] + euler[:, 2])))).max()))
        )
    return claimed(
        right < 1e-9 and max(torsion) < 1e-6,
        Quantity("error of the formulas as Euler angles ZXZ", right),
        Quantity("torsion |φ + ψ| in mode 1", torsion[0], "0", "°"),
        Quantity("torsion |φ + ψ| in mode 2", torsion[1], "0", "°"),
        proof=f"the library's poses of mode 1 have a torsion of {torsion[0]:.0f}°",
    )


# --- modes ---------------------------------------------------------------------------------


@computes(N, "C1")
def c_1(item: Item) -> Outcome:
    products = [
        float(np.abs(at.x[:, 0] * at.x[:, 3]).max())
        for name in ("rps-3", "spr-3")
        for at in both(name)
    ]
    found = {len(machine(name).modes) for name in ("rps-3", "spr-3")}
    return counts(
        item.data["counts"],
        ("operation modes of either machine", found.pop() if len(found) == 1 else 0),
        more=[Quantity("largest |x₀x₃| of both at random poses", max(products))],
    )


@computes(N, "C2")
def c_2(item: Item) -> Outcome:
    used = {mode for one in forward() for mode in one.modes}
    return counts(
        item.data["counts"],
        ("ideals that hold solutions (J_3 does not)", len(used)),
    )


@computes(N, "C3")
def c_3(item: Item) -> Outcome:
    from scipy.spatial.transform import Rotation

    turned = [np.degrees(Rotation.from_matrix(at.turn).magnitude()) for at in both("spr-3")]
    spread = float(np.abs(turned[0] - 180.0).max())
    home = machine("spr-3").mechanism.transform((100.0, 0.0, 0.0), "1")[:3, :3]
    return compared(
        Quantity(
            "angle of the displacement in mode 1",
            float(turned[0].mean()),
            str(item.data["counts"][0]),
            "°",
        ),
        Quantity("largest difference from it at random poses", spread, unit="°"),
        Quantity("angles in mode 2", f"{turned[1].min():.1f} … {turned[1].max():.1f}", unit="°"),
        Quantity(
            "home of mode 1, turn about z", float(np.degrees(np.arccos(home[0, 0]))), unit="°"
        ),
    )


@computes(N, "C14")
def c_14(item: Item) -> Outcome:
    fields = [field.label for field in machine("spr-3").fields]
    kinds = machine("spr-3").title.partition(" ")[0], machine("rps-3").title.partition(" ")[0]
    at = poses("spr-3", "2")
    return compared(
        Quantity("symbol of the base's circumradius", "h₁", "h₂"),
        Quantity("symbol of the platform's", "h₂", "h₂"),
        Quantity("machine of section 6", kinds[0], "3-PRS"),
        Quantity("both radii in the example", f"{at.h1:g}, {at.h2:g}", unit="mm"),
        Quantity("what the library calls them", "; ".join(fields[:2])),
    )


@computes(N, "C15")
def c_15(item: Item) -> Outcome:
    found = forward()
    most = [max(sum(m == mode for m in one.modes) for one in found) for mode in ("1", "2")]
    at = poses("spr-3", "2")
    g = equations(at.x, at.y, at.joints, at.h1, at.h2)
    return compared(
        Quantity("equations", float(g.shape[1]), str(item.data["counts"][0])),
        Quantity("complex solutions", float(found[0].complex_count)),
        Quantity("most real ones in mode 1 and in mode 2, 20 cases", f"{most[0]}, {most[1]}"),
    )


@cache
def forward() -> tuple[ForwardSolutions, ...]:
    """All solutions for the limbs of ten random poses in each mode."""
    joints = np.concatenate([at.joints[:10] for at in both("spr-3")])
    return machine("spr-3").forward(joints)
