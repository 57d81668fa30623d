"""Vertex spaces and workspaces of the 5-RPUR: Figs. 8 to 16 and 18 to 21, claims C17, C18, C21."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    claimed,
    compared,
    counts,
    drawn,
    error,
)
from app.features.paper.recomputed.postures import machine, postures, with_limbs
from app.features.paper.recomputed.rpur_model import J, K
from app.features.paper.recomputed.rpur_sections import offsets, space
from app.features.paper.registry import computes
from kinematics.arrays import Array
from kinematics.facets.map_sweeps import Map, map_request, sweep
from kinematics.facets.spaces import ShownSolid

LINK, LOW, HIGH = 150.0, 250.0, 400.0
"""mm, section 4."""
_SAMPLES = 1_000_000
TITLES = {"body": "main body", "whole": "vertex space", "H1": "H₁", "H2": "H₂", "H3": "H₃"}


@cache
def part(key: str, name: str = "rpur-table1") -> ShownSolid:
    """A solid of limb 1: "whole", "body", "H1", "H2", "H3", "plus"."""
    return machine(name).workspace().solid("normal", key=f"limb1/{key}")


def dome(points: Array, rho: ArrayLike, link: float = LINK) -> Array:
    """The quartic that is zero on a Bohemian dome, mm⁴; points (..., 3) relative to A in x′y′z′."""
    x, y, z = (points[..., k] for k in range(3))
    s, h = np.asarray(rho) ** 2 - x * x, link * link - y * y
    return np.asarray((z * z - s - h) ** 2 - 4.0 * s * h)


def _dome_error() -> tuple[float, int]:
    """How well C − A of random postures satisfies the quartic of its ρ, and its degree along random
    lines."""
    at = postures("rpur-table1")
    arms = at.c - at.a
    turned = arms @ at.turn[:, :, :1]  # along e₂
    local = np.stack(
        [
            turned[..., 0],
            arms[..., 1],
            arms[..., 0] * at.sin[:, None] + arms[..., 2] * at.cos[:, None],
        ],
        axis=-1,
    )
    off = np.abs(dome(local, at.rho)) / (at.rho**2 * LINK**2)
    chance = np.random.default_rng(3)
    start, way = chance.normal(size=(2, 8, 1, 3))
    along = dome(start + way * np.linspace(-1.0, 1.0, 13)[:, None], 1.3, 0.7)
    sizes = [np.abs(np.diff(along, n, axis=1)).max() for n in range(1, 9)]
    degree = max(n for n, size in enumerate(sizes, start=1) if size > 1e-9 * sizes[0])
    return float(off.max()), degree


# --- vertex spaces -------------------------------------------------------------------------


@cache
def by_quadrature() -> dict[str, float]:
    """Volumes, mm³, of the main body and its holes from what describes them: heights along z over
    x and y, integrated between all places where a hole begins or ends.
    """
    edges = [0.0, np.sqrt(LOW**2 - LINK**2), _meeting(1.0), LOW, _meeting(-1.0)]
    edges = sorted({*edges, float(np.sqrt(HIGH**2 - LINK**2)), HIGH})
    x, wx = (each.ravel() for each in _panels(np.array(edges)[None], 40))
    outer, inner = (np.sqrt(np.maximum(r * r - x * x, 0.0)) for r in (HIGH, LOW))
    starts = np.stack([outer, inner, 0.5 * (outer + inner), 0.5 * (outer - inner)], axis=1)
    bends = np.arccos(np.clip(starts / LINK, -1.0, 1.0))  # y = l sin b, h = l cos b
    rim = np.stack([np.zeros_like(x), np.full_like(x, 0.5 * np.pi)], axis=1)
    b, wb = _panels(np.sort(np.concatenate([rim, bends], axis=1), axis=1), 24)
    h = LINK * np.cos(b)
    up, low = outer[:, None, None], inner[:, None, None]
    third = np.where(low > 0.0, (h + low) - np.maximum(h - low, up - h), 0.0)
    heights = {
        "body": up + h,
        "H1": np.maximum(h - up, 0.0),
        "H2": np.maximum(low - h, 0.0),
        "H3": np.maximum(third, 0.0),
    }
    weight = 8.0 * wx[:, None, None] * wb * h
    found = {key: float((height * weight).sum()) for key, height in heights.items()}
    found["whole"] = found["body"] - found["H1"] - found["H2"] - found["H3"]
    return found


def _meeting(sign: float) -> float:
    """x at which S(ρ_max, x) ± S(ρ_min, x) = 2l; ρ_min where there is none."""
    # S_max² − S_min² = ρ_max² − ρ_min², so the other combination is known as well.
    other = (HIGH**2 - LOW**2) / (2.0 * LINK)
    inner = 0.5 * sign * (2.0 * LINK - other)
    return float(np.sqrt(LOW**2 - inner**2)) if 0.0 < inner < LOW else LOW


def _panels(edges: Array, count: int) -> tuple[Array, Array]:
    """Places and weights (N, panels, count) between edges (N, panels + 1), for functions with
    roots at either end of a panel."""
    a, w = np.polynomial.legendre.leggauss(count)
    middle, half = 0.5 * (edges[:, 1:] + edges[:, :-1]), 0.5 * np.diff(edges, axis=1)
    bent = 0.5 * np.pi * a
    places = middle[..., None] + half[..., None] * np.sin(bent)
    return places, half[..., None] * (0.5 * np.pi * w * np.cos(bent))


@computes(J, "Fig. 8")
def fig_8(item: Item) -> Outcome:
    off, degree = _dome_error()
    return drawn(
        off < 1e-9 and degree == 4,
        Quantity("error of the dome's quartic at 1000 platform points", off),
        Quantity("degree of the surface", float(degree)),
        proof="platform points of the library lie on the surface that is drawn",
    )


@computes(J, "Fig. 9", "Fig. 10", "Fig. 11", "Fig. 12", "Fig. 13")
@computes(K, "Fig. 5")
def figs_9_to_13(item: Item) -> Outcome:
    key = item.data["solid"]
    built, exact = part(key).built, by_quadrature()[key]
    return drawn(
        abs(built.volume - exact) <= built.volume_error + 2e-4 * exact and built.watertight,
        Quantity(f"volume of the {TITLES[key]}", exact, unit="mm³"),
        Quantity("of the solid as a mesh", built.volume, unit="mm³"),
        Quantity("pieces", float(len(built.pieces))),
        proof="the closed solid agrees with a quadrature within the mesh's error, "
        f"{built.volume_error:.1e} mm³",
    )


@computes(J, "Fig. 16")
@computes(K, "Fig. 8")
def fig_16(item: Item) -> Outcome:
    points = part("whole").built.mesh.vertices
    size = points.max(axis=0) - points.min(axis=0)
    wanted = np.array([2 * HIGH, 2 * LINK, 2 * (HIGH + LINK)])
    return drawn(
        error(size, wanted) < 2e-2,
        Quantity("width 2ρ_max along x′", float(wanted[0]), unit="mm"),
        Quantity("height 2(ρ_max + l) along z′", float(wanted[2]), unit="mm"),
        Quantity("of the solid", f"{size[0]:.1f} × {size[2]:.1f}", unit="mm"),
        proof="the outline has the extent of the library's vertex space within its facets",
    )


# --- workspaces ----------------------------------------------------------------------------


def degrees_of(item: Item) -> tuple[float, float]:
    """φ and θ, degrees."""
    phi, theta = item.data["orientation"]
    return float(phi), float(theta)


@cache
def volume(name: str, degrees: tuple[float, float]) -> tuple[float, float]:
    """The exact volume of all modes together and its error, mm³."""
    found = space(name, degrees).volume(1e-7, pieces=False)
    return found.value, found.error


@cache
def solid(name: str, degrees: tuple[float, float]) -> ShownSolid:
    """The workspace as a mesh."""
    return space(name, degrees).solid("normal")


@computes(J, "Fig. 14", "Fig. 15", "Fig. 18", "Fig. 19")
@computes(K, "Fig. 6", "Fig. 7", "Fig. 10")
def workspaces(item: Item) -> Outcome:
    name, degrees = item.data["design"], degrees_of(item)
    exact, off = volume(name, degrees)
    built = solid(name, degrees).built
    quantities = [
        Quantity("volume by exact sections", round(exact), unit="mm³"),
        Quantity("by a boolean of solids", round(built.volume), unit="mm³"),
        Quantity("pieces", float(len(built.pieces))),
    ]
    if item.name in ("Fig. 14", "Fig. 15"):
        cut = cut_by_holes(name)
        quantities.append(Quantity("without H₃ (sampled, ±0.1·10⁶)", cut["no H3"], unit="mm³"))
    found = drawn(
        abs(built.volume - exact) <= off + built.volume_error + 1e-3 * exact,
        *quantities,
        proof=f"sections and solids agree within the mesh's error, {built.volume_error:.1e} mm³, "
        "as the paper says of its two ways",
    )
    if "arrangement" not in item.data:
        return found
    label = arrangement(name)
    told = Quantity("design", label, str(item.data["arrangement"]))
    return claimed(
        told.agrees,
        *found.quantities,
        told,
        proof=f"{found.proof}; the arrangements found in the table make it {label}",
    )


def arrangement(name: str) -> str:
    """The simplified design that the library finds a preset to be; "" for none."""
    titles = [finding.title for finding in machine(name).findings]
    found = [title for title in titles if title.startswith("Simplified design ")]
    return found[0].removeprefix("Simplified design ") if found else ""


@computes(J, "Fig. 20", "Fig. 21")
@computes(K, "Fig. 11")
def volumes(item: Item) -> Outcome:
    name = item.data["design"]
    level = volume(name, (0.0, 0.0))[0]
    quantities = [Quantity("φ = θ = 0", round(level), unit="mm³")]
    sound = True
    for phi, theta in item.data["volumes"]:
        degrees = (float(phi), float(theta))
        exact, built = volume(name, degrees)[0], solid(name, degrees).built
        sound &= abs(exact - built.volume) <= built.volume_error + 2e-3 * exact
        where = f"φ = {np.radians(phi):.4g}, θ = {np.radians(theta):.4g}"
        quantities.append(Quantity(where, round(exact), unit="mm³"))
    found = chart(name, 5)
    best = np.unravel_index(int(found.values[0].argmax()), found.values[0].shape)
    at = np.degrees([found.request.first[best[0]], found.request.second[best[1]]])
    quantities.append(
        Quantity(
            f"largest on a grid of 30°, at φ = {at[0]:.0f}°, θ = {at[1]:.0f}°",
            round(float(found.values[0].max())),
            unit="mm³",
        )
    )
    if item.paper == K:
        quantities.append(
            Quantity(
                "φ = −π/4, θ = π/4, that is eq. 14 as printed at π/4, π/4",
                round(volume(name, (-45.0, 45.0))[0]),
                unit="mm³",
            )
        )
    return drawn(sound, *quantities, proof="sections and solids agree at each orientation")


@cache
def chart(name: str, count: int) -> Map:
    """The volume over φ and θ from −60° to 60°."""
    angles = np.radians(np.linspace(-60.0, 60.0, count))
    request = map_request(machine(name).design, angles, angles, relative=1e-3)
    with ThreadPoolExecutor() as executor:
        return sweep(request, executor)


# --- claims --------------------------------------------------------------------------------


@cache
def cut_by_holes(name: str) -> dict[str, float]:
    """By random points at φ = θ = 0: the common main body, what the holes of each kind cut from it,
    and what is left with H₃ and without, mm³."""
    w, reach = offsets(name, (0.0, 0.0)), np.array([HIGH, LINK, HIGH + LINK])
    low, high = (w - reach).max(axis=0), (w + reach).min(axis=0)
    points = low + (high - low) * np.random.default_rng(11).random((_SAMPLES, 3))
    body = np.ones(_SAMPLES, dtype=bool)
    holes = np.zeros((3, _SAMPLES), dtype=bool)
    for limb in w:
        x, y, z = (points - limb).T
        h = np.sqrt(np.maximum(LINK**2 - y**2, 0.0))
        outer, inner = (np.sqrt(np.maximum(r**2 - x**2, 0.0)) for r in (HIGH, LOW))
        up = np.abs(z)
        body &= (np.abs(y) <= LINK) & (np.abs(x) <= HIGH) & (up <= outer + h)
        holes[0] |= up < h - outer
        holes[1] |= up < inner - h
        holes[2] |= (np.abs(up - h) < inner) & (up > outer - h)
    box = float(np.prod(high - low)) / _SAMPLES
    h1, h2, h3 = holes & body
    kinds = {
        "body": body,
        "H1": h1,
        "H2": h2,
        "H3": h3,
        "no H3": body & ~h1 & ~h2,
        "left": body & ~h1 & ~h2 & ~h3,
    }
    return {key: round(box * float(some.sum()), -5) for key, some in kinds.items()}


@computes(J, "C17")
def c_17(item: Item) -> Outcome:
    volumes = {key: part(key).volume for key in ("H1", "H2", "H3")}
    general = machine("rpur-table1").table
    limbs = [{**limb, "stroke": [100.0, 400.0], "link": 149.0} for limb in general["limb"]]
    wide = with_limbs(limbs).workspace().solid("normal", key="limb1/H3").volume
    just = [{**limb, "stroke": [110.0, 400.0]} for limb in limbs]
    narrow = with_limbs(just).workspace().solid("normal", key="limb1/H3").volume
    there = sum(volume > 0.0 for volume in volumes.values())
    cut = {name: cut_by_holes(name) for name in ("rpur-table1", "rpur-table2")}
    found = counts(
        item.data["counts"],
        ("holes for l = 150 mm, ρ from 250 to 400 mm", there),
        more=[
            Quantity("H₃ for Δρ/2 = 150 mm > l = 149 mm", wide, unit="mm³"),
            Quantity("H₃ for Δρ/2 = 145 mm < l = 149 mm", narrow, unit="mm³"),
            *(
                Quantity(
                    f"{title}: cut from the common main body by {key}",
                    cut[name][key],
                    unit="mm³ ± 10⁵",
                )
                for title, name in (("Table 1", "rpur-table1"), ("Table 2", "rpur-table2"))
                for key in ("H1", "H2", "H3")
            ),
        ],
    )
    holds = wide == 0.0 and narrow > 0.0 and found.verdict == "reproduced"
    proof = "three holes where the paper says so; H₃ vanishes as soon as Δρ/2 exceeds l"
    return claimed(holds, *found.quantities, proof=proof)


@computes(J, "C18")
def c_18(item: Item) -> Outcome:
    off, degree = _dome_error()
    return compared(
        Quantity("degree along random lines", float(degree), str(item.data["counts"][0])),
        Quantity("error of that quartic at 1000 platform points of the library", off),
    )


@computes(J, "C21")
def c_21(item: Item) -> Outcome:
    exact = 2.0 * LINK * np.pi * (HIGH**2 - LOW**2)
    built = part("plus").built
    there = {
        name: sum(
            machine(name).workspace(mode, phi=0, theta=0).volume(1e-2, pieces=False).value > 0.0
            for mode in machine(name).modes
        )
        for name in ("rpur-table1", "rpur-table2")
    }
    one = machine("rpur-table1").workspace("+++++", phi=0, theta=0)
    mode, mesh = one.volume(1e-6, pieces=False), one.solid("normal").built
    off = abs(mode.value - mesh.volume)
    holds = (
        abs(built.volume - exact) <= built.volume_error and off <= mesh.volume_error + mode.error
    )
    return claimed(
        not holds,
        Quantity("volume of B⁺, closed form", exact, unit="mm³"),
        Quantity("of the solid", built.volume, unit="mm³"),
        Quantity("Table 1, mode +++++ by solids", round(mesh.volume), unit="mm³"),
        Quantity("the same by exact sections", round(mode.value), unit="mm³"),
        Quantity("modes with a workspace at φ = θ = 0, Table 1", float(there["rpur-table1"])),
        Quantity("the same, Table 2", float(there["rpur-table2"])),
        proof="the workspace of one working mode is built here by booleans of solids, and agrees "
        "with its exact sections",
    )
