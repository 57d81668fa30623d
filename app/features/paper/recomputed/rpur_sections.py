"""Sections of the 5-RPUR's workspace: eqs. 28 to 43 of the journal paper and its Fig. 17."""

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
    error,
    identity,
)
from app.features.paper.recomputed.postures import machine, postures
from app.features.paper.recomputed.rpur_model import J, K, about_x, about_y
from app.features.paper.registry import computes
from kinematics.answers.sections import BOUNDS, Construction
from kinematics.arrays import Array
from kinematics.facets.spaces import ShownSection, Space

AT = 50.0
"""mm, where the papers cut."""
_STEPS = np.linspace(-640.3, 760.1, 281)  # x′ at which intervals are tried


def space(name: str, degrees: tuple[float, float]) -> Space[Any]:
    """The workspace of all modes of a preset at φ, θ."""
    found: Space[Any] = machine(name).workspace(phi_deg=degrees[0], theta_deg=degrees[1])
    return found


@cache
def section(name: str, degrees: tuple[float, float], at: float) -> ShownSection:
    """Its section at x′."""
    return space(name, degrees).section(at)


def offsets(name: str, degrees: tuple[float, float]) -> Array:
    """w′ (5, 3) by eq. 27."""
    at = postures(name)
    phi, theta = np.radians(np.array([degrees]).T)
    turned = at.a @ about_y(-theta)[0].T - at.s @ about_x(phi)[0].T
    return np.asarray(turned)


def _stroke(name: str) -> Array:
    """(5, 2) mm."""
    return np.array([limb["stroke"] for limb in machine(name).table["limb"]])


# --- where the plane cuts ------------------------------------------------------------------

_LEVEL, TURNED = (0.0, 0.0), (45.0, 45.0)
TABLES = {
    J: (("Table 1", "rpur-table1"), ("Table 2", "rpur-table2")),
    K: (("Table I", "rpur-table1-icee"),),
}


@computes(J, "eq. 28")
@computes(K, "eq. 15")
def eq_28(item: Item) -> Outcome:
    quantities: list[Quantity] = []
    off = 0.0
    for title, name in TABLES[item.paper]:
        for degrees in (_LEVEL, TURNED):
            x, reach = offsets(name, degrees)[:, 0], _stroke(name)[:, 1]
            low, high = float((x - reach).max()), float((x + reach).min())
            sections = machine(name).sections
            assert sections is not None
            own = sections.range(space(name, degrees).pose, None)
            off = max(off, error([low, high], own or [0.0, 0.0]))
            where = "φ = θ = 0" if degrees == _LEVEL else "φ = θ = π/4"
            told = f"{low:.2f} … {high:.2f}".replace("-", "−")
            quantities.append(Quantity(f"{title}, {where}", told, unit="mm"))
    proof = "the same interval in which the library's exact sections can be anything"
    return claimed(off < 1e-9, *quantities, proof=proof)


@computes(J, "eq. 29")
def eq_29(item: Item) -> Outcome:
    name, degrees = "rpur-table1", TURNED
    w = offsets(name, degrees)
    at = postures(name)
    theta = np.radians(np.array([degrees[1]]))
    plain = w @ about_y(theta)[0].T  # w_i in the base frame
    inner = _stroke(name)[:, 0]
    cut = np.array([_cut(section(name, degrees, float(x))) for x in _STEPS])
    wrong = np.abs(_STEPS[:, None] - plain[:, 0]) <= inner
    right = np.abs(_STEPS[:, None] - w[:, 0]) <= inner
    whole = _reached(name, degrees)
    missed = int((wrong != cut)[whole].sum())
    left = int((right != cut)[whole].sum())
    return claimed(
        missed == 0,
        Quantity("w_ix", _listed(plain[:, 0]), unit="mm"),
        Quantity("w′_ix", _listed(w[:, 0]), unit="mm"),
        Quantity("limbs told wrongly as printed", float(missed)),
        Quantity("limbs told wrongly with w′_ix", float(left)),
        proof=f"told for {len(at.a)} limbs in {int(whole.sum())} sections of Table 1 at "
        f"φ = θ = π/4, it is wrong {missed} times as printed and {left} times with w′_ix",
    )


def _cut(found: ShownSection) -> NDArray[np.bool_]:
    """(5,) which limbs' B_min the library's construction has circles of."""
    made = found.construction
    inner = made.circle_limb[made.circle_bound == BOUNDS.index("rho_min")]
    return np.isin(np.arange(1, 6), inner)


def _reached(name: str, degrees: tuple[float, float]) -> Array:
    """Which of the steps lie in the interval of eq. 28."""
    x, reach = offsets(name, degrees)[:, 0], _stroke(name)[:, 1]
    return np.asarray(((x - reach).max() < _STEPS) & ((x + reach).min() > _STEPS))


def _listed(values: Array) -> str:
    return ", ".join(f"{value:.2f}".replace("-", "−") for value in values + 0.0)


# --- circles -------------------------------------------------------------------------------


def _circles(item: Item, which: str, sign: float) -> Outcome:
    """Centres by eqs. 30 to 33 beside those of the library's construction."""
    name, off, count = "rpur-table1", 0.0, 0
    column = ("rho_min", "rho_max").index(which)
    for degrees in (_LEVEL, TURNED, (-17.0, 29.0)):
        w, radius = offsets(name, degrees), _stroke(name)[:, column]
        for x in np.linspace(-120.0, 320.0, 23):
            made = section(name, degrees, float(x)).construction
            root = radius**2 - (w[:, 0] - x) ** 2
            for limb in np.flatnonzero(root > 0.0):
                center = np.array([w[limb, 1], w[limb, 2] + sign * np.sqrt(root[limb])])
                own = made.center[_mine(made, int(limb) + 1, which)]
                if len(own):
                    off = max(off, float(np.abs(own - center).max(axis=1).min()))
                    count += 1
    return identity(off / 400.0, where=f"for {count} circles of 69 sections of Table 1")


def _mine(made: Construction, limb: int, which: str) -> Array:
    bound = [*map(str, BOUNDS)].index(which)
    return np.asarray((made.circle_limb == limb) & (made.circle_bound == bound))


@computes(J, "eq. 30")
def eq_30(item: Item) -> Outcome:
    return _circles(item, "rho_min", -1.0)


@computes(J, "eq. 31")
def eq_31(item: Item) -> Outcome:
    return _circles(item, "rho_min", 1.0)


@computes(J, "eq. 32")
def eq_32(item: Item) -> Outcome:
    return _circles(item, "rho_max", -1.0)


@computes(J, "eq. 33")
def eq_33(item: Item) -> Outcome:
    return _circles(item, "rho_max", 1.0)


# --- inside and outside --------------------------------------------------------------------


def _on_boundary(which: str, lower: bool) -> Outcome:
    """Eqs. 34, 35, 37, 38: on the library's edges that are due to that half of that circle the
    printed a vanishes (relative to l).
    """
    name, found = "rpur-table1", []
    bound = [*map(str, BOUNDS)].index(which)
    column = ("rho_min", "rho_max").index(which)
    side = -1.0 if lower else 1.0  # of the circle
    half = side if which == "rho_max" else -side  # of the arc on it
    for degrees in (_LEVEL, TURNED):
        w, radius = offsets(name, degrees), _stroke(name)[:, column]
        for x in np.linspace(-180.0, 370.0, 45):
            one = section(name, degrees, float(x))
            for edge in np.flatnonzero((one.bound == bound) & one.is_arc).tolist():
                limb = int(one.limb[edge]) - 1
                y, z = (one.edge_points(edge, 20.0)[1:-1] - w[limb, 1:]).T
                center = one.center[edge, 1] - w[limb, 2]
                if side * center > 0.0 and half * (z[len(z) // 2] - center) > 0.0:
                    high = np.sqrt(radius[limb] ** 2 - (w[limb, 0] - x) ** 2)
                    a = z - (side * high + half * np.sqrt(np.maximum(150.0**2 - y**2, 0.0)))
                    found.append(a / 150.0)
    off = np.concatenate(found)
    where = f"for {len(off)} points on edges of 90 sections of Table 1"
    return identity(float(np.abs(off).max()), where=where)


@computes(J, "eq. 34")
def eq_34(item: Item) -> Outcome:
    return _on_boundary("rho_max", lower=True)


@computes(J, "eq. 35")
def eq_35(item: Item) -> Outcome:
    return _on_boundary("rho_max", lower=False)


@computes(J, "eq. 37")
def eq_37(item: Item) -> Outcome:
    return _on_boundary("rho_min", lower=True)


@computes(J, "eq. 38")
def eq_38(item: Item) -> Outcome:
    return _on_boundary("rho_min", lower=False)


def _volume_of(which: str) -> tuple[float, float, float]:
    """Volume of what eq. 36 (ρ_max) or 39 (ρ_min) describes, by quadrature over y and x, and of the
    library's solid with its error."""
    radius, link = (400.0, 150.0) if which == "body" else (250.0, 150.0)
    # x = ρ sin a, y = l sin b: the integrand is smooth but where a hole begins.
    a, wa = np.polynomial.legendre.leggauss(400)
    x, y = 0.5 * np.pi * a, 0.5 * np.pi * a[:, None]
    up, half = radius * np.cos(x), link * np.cos(y)
    high = up + half if which == "body" else np.maximum(up - half, 0.0)
    weight = (0.5 * np.pi) ** 2 * wa * wa[:, None] * up * half
    built = machine("rpur-table1").workspace().solid("normal", key=f"limb1/{which}").built
    return float((2.0 * high * weight).sum()), built.volume, built.volume_error


@computes(J, "eq. 36")
def eq_36(item: Item) -> Outcome:
    return _described("body", "main body")


@computes(J, "eq. 39")
def eq_39(item: Item) -> Outcome:
    return _described("H2", "hole H₂")


def _described(part: str, title: str) -> Outcome:
    by_equation, built, margin = _volume_of(part)
    return claimed(
        abs(by_equation - built) <= margin + 1e-4 * built,
        Quantity("volume of what the criterion describes", by_equation, unit="mm³"),
        Quantity(f"of the library's {title}", built, unit="mm³"),
        Quantity("error of that mesh", margin, unit="mm³"),
        proof=f"both volumes agree within the mesh's error, so the criterion describes the {title}",
    )


# --- areas ---------------------------------------------------------------------------------


def _parts(degrees: tuple[float, float]) -> tuple[float, float, float]:
    """Of Fig. 17's section: the sums of eq. 40 over arcs and of eq. 43 over lines, and its area."""
    found = section("rpur-table1", degrees, AT)
    arcs = lines = 0.0
    for k in range(len(found.start)):
        start, end = found.start[k], found.end[k]
        if not found.is_arc[k]:
            lines += float(start[0] * (end[1] - start[1]))  # n·s, the outer side to the right
            continue
        (h, g), r = found.center[k], found.radius[k]
        first = float(np.arctan2(start[1] - g, start[0] - h))
        last = first + float(found.sweep[k])
        arcs += float(
            h * r * (np.sin(last) - np.sin(first))
            + g * r * (np.cos(first) - np.cos(last))
            + r**2 * (last - first)
        )
    return arcs, lines, found.area


@computes(J, "eq. 40")
def eq_40(item: Item) -> Outcome:
    return _area(*_stadium())


@computes(J, "eq. 43")
def eq_43(item: Item) -> Outcome:
    return _area(*_stadium())


def _stadium() -> tuple[float, float, Quantity]:
    arcs, lines, area = _parts(TURNED)
    told = Quantity("area of the section of Fig. 17", area, unit="mm²")
    return error(arcs + lines, area), error(0.5 * (arcs + lines), area), told


def _area(as_printed: float, right: float, told: Quantity) -> Outcome:
    found = identity(as_printed, right, where="summed over the section of Fig. 17")
    return Outcome(found.verdict, (told, *found.quantities), found.proof)


@computes(J, "eq. 41")
def eq_41(item: Item) -> Outcome:
    # ∫ n·s over lines that run up on the right side, down on the left, beside Gauss's theorem.
    lines = _lines()
    (y, z), (_, end) = lines[:, 0].T, lines[:, 1].T
    exact = lines[:, 0, 0] * lines[:, 1, 1] - lines[:, 0, 1] * lines[:, 1, 0]
    as_printed, right = 0.5 * (end**2 - z**2), y * (end - z)
    where = f"for {len(lines)} lines of 100 sections of Table 1"
    return identity(error(as_printed, exact), error(right, exact), where=where)


def _lines() -> Array:
    """Line edges (M, 2, 2) of many sections, both ends each."""
    found = []
    for x in np.linspace(-180.0, 370.0, 100):
        one = section("rpur-table1", _LEVEL, float(x))
        straight = ~one.is_arc
        found.append(np.stack([one.start[straight], one.end[straight]], axis=1))
    return np.concatenate(found)


@computes(J, "eq. 42")
def eq_42(item: Item) -> Outcome:
    lines = _lines()
    w = offsets("rpur-table1", _LEVEL)
    places = np.concatenate([w[:, 1] - 150.0, w[:, 1] + 150.0])
    off = np.abs(lines[:, 0, 0, None] - places).min(axis=1).max()
    upright = np.abs(lines[:, 0, 0] - lines[:, 1, 0]).max()
    worst = float(max(off, upright)) / 150.0
    return identity(worst, where=f"for {len(lines)} lines at y′ = w′_iy ± l, of one y′ each")
