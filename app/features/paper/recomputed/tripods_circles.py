"""Nayak et al. (2017): singularity loci, inscribed circles (MICR) and what is claimed of them."""

from __future__ import annotations

from functools import cache

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import (
    HOLDS,
    Outcome,
    Quantity,
    agreement,
    claimed,
    compared,
    drawn,
)
from app.features.paper.recomputed.tripods_algebra import N, machine
from app.features.paper.registry import computes
from kinematics.answers.circles import MicrTable
from kinematics.arrays import Array
from kinematics.facets.circles import micr

RATIOS = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
HEIGHTS = np.linspace(0.05, 4.0, 80)
"""Z/h₁ of Figs. 4 and 5."""

_RING = 1e-3
"""Degrees within which circles that end at the ring of 90° are told apart by rounding."""


@cache
def table(mechanism: str) -> MicrTable:
    """MICR (2 modes, ratios, heights)."""
    return micr(mechanism, 1.0, np.array(RATIOS)[:, None], HEIGHTS[None])


def degrees_of(mechanism: str) -> Array:
    """(2, ratios, heights) degrees; 180 where no tilt is singular."""
    return np.nan_to_num(np.degrees(table(mechanism).radius), nan=180.0)


def example(item: Item) -> MicrTable:
    """The paper's example of a mechanism."""
    return micr(item.data["mechanism"], item.data["h1"], item.data["h2"], item.data["z"])


@computes(N, "Fig. 3(a)", "Fig. 3(b)")
def fig_3(item: Item) -> Outcome:
    made, mode = machine("spr-3"), item.data["mode"]
    spec = made.singularities.loci[0]
    height = float(item.data["z"]) * 100.0
    curves = made.singularities.locus(spec.key, (height, 0.0, 0.0), mode)
    nearest = min(float(points[:, 0].min()) for points in curves.lost())
    found = micr("three_spr", item.data["h1"], item.data["h2"], item.data["z"])
    radius = float(found.radius[int(mode) - 1])
    points = np.concatenate(curves.lost())
    at = np.column_stack([np.full(len(points), height), points])
    near = np.abs(made.statics.wrenches(at[points[:, 0] < 1.4], mode).determinant).max()
    return drawn(
        abs(nearest - radius) < 2e-3 and float(near) < 1e-5,
        Quantity("circle (MICR)", float(np.degrees(radius)), unit="°"),
        Quantity("curves", float(len(curves.kinds))),
        Quantity("least tilt of their points", float(np.degrees(nearest)), unit="°"),
        Quantity("largest determinant of the six wrenches on them, below 80°", float(near)),
        proof="the circle touches the curves, and on them the six wrenches are dependent",
    )


@computes(N, "Fig. 4(a)", "Fig. 4(b)")
def fig_4(item: Item) -> Outcome:
    found = degrees_of(item.data["mechanism"])[int(item.data["mode"]) - 1]
    own = _by_wrenches(item.data["mechanism"], item.data["mode"])
    best = np.unravel_index(int(found.argmax()), found.shape)
    return drawn(
        own < 1e-6,
        Quantity("largest MICR", float(found.max()), unit="°"),
        Quantity("at h₂/h₁, Z/h₁", f"{RATIOS[best[0]]:g}, {HEIGHTS[best[1]]:.2f}"),
        Quantity("smallest singular value of the wrenches where circles touch", own),
        proof="where the circles touch, the six wrenches are dependent",
    )


def _by_wrenches(mechanism: str, mode: str) -> float:
    """The largest of the smallest singular values of the wrenches at contacts of some circles."""
    name = {"three_rps": "rps-3", "three_spr": "spr-3"}[mechanism]
    made = machine(name).edited("base_radius", 100.0)
    found, n, worst = table(mechanism), int(mode) - 1, 0.0
    for r, ratio in enumerate(RATIOS):
        if ratio == 1.0:
            continue  # limbs of a level platform are parallel there
        one = made.edited("platform_radius", 100.0 * ratio)
        for h in range(9, len(HEIGHTS), 20):
            radius = found.radius[n, r, h]
            if np.isfinite(radius) and abs(radius - 0.5 * np.pi) > 0.05:
                pose = np.array([100.0 * HEIGHTS[h], radius, found.contact[n, r, h]])
                rows = one.statics.at(pose, mode).rows / np.repeat([1.0, 100.0], 3)
                values = np.linalg.svd(rows, compute_uv=False)
                worst = max(worst, float(values[-1] / values[0]))
    return worst


@computes(N, "Fig. 5(a)", "Fig. 5(b)")
def fig_5(item: Item) -> Outcome:
    mode = int(item.data["mode"]) - 1
    found = micr(item.data["mechanism"], 1.0, 2.0, 1.0)
    return _beside(
        [(f"MICR at the cursor, mode {mode + 1}", item.data["cursor"], mode)], found, "three_spr"
    )


def _beside(told: list[tuple[str, str, int]], found: MicrTable, mechanism: str) -> Outcome:
    """Printed MICR beside exact ones and beside what the paper's method prints."""
    quantities = []
    for what, printed, mode in told:
        exact = float(np.degrees(found.radius[mode]))
        quantities.append(Quantity(what, exact, printed, "°"))
        method = float(found.printed[mode])
        quantities.append(Quantity("by a grid of 0.01 rad, π = 3.14", method, printed, "°"))
    outcome = compared(*quantities)
    exact_off = [q for q in quantities[::2] if not q.agrees]
    explained = all(agreement(q.printed or "", float(q.computed))[0] == 4 for q in quantities[1::2])
    tail = "; the grid of 0.01 rad and π = 3.14 give the printed digits" if explained else ""
    most = float(np.nanmax(_singular(found, mechanism)))
    extra = Quantity("smallest singular value of the wrenches at the exact contact", most)
    verdict = outcome.verdict if exact_off else "reproduced"
    return Outcome(verdict, (*quantities, extra), outcome.proof + tail)


def _singular(found: MicrTable, mechanism: str) -> Array:
    """Smallest singular values of the wrenches at contacts of the paper's example."""
    name = {"three_rps": "rps-3", "three_spr": "spr-3"}[mechanism]
    made = machine(name).edited("base_radius", 100.0).edited("platform_radius", 200.0)
    values = []
    for n, mode in enumerate(found.modes):
        pose = np.array([100.0, found.radius[n], found.contact[n]])
        rows = made.statics.at(pose, mode).rows / np.repeat([1.0, 100.0], 3)
        values.append(np.linalg.svd(rows, compute_uv=False)[-1])
    return np.array(values)


# --- claims --------------------------------------------------------------------------------


@computes(N, "C4")
def c_4(item: Item) -> Outcome:
    found = degrees_of("three_spr")
    made = machine("spr-3").coordinates
    tilt, azimuth = made[1], made[2]
    return claimed(
        bool((found > item.data["cap"]).any()),
        Quantity(
            "range of the tilt",
            f"{tilt.outer(tilt.lower):.0f} … {tilt.outer(tilt.upper):.0f}",
            "0 … 180",
            "°",
        ),
        Quantity(
            "range of the azimuth",
            f"{azimuth.outer(azimuth.lower):.0f} … {azimuth.outer(azimuth.upper):.0f}",
            "-180 … 180",
            "°",
        ),
        Quantity(
            "circles above the cap of 160°, of those drawn here",
            f"{int((found > item.data['cap']).sum())} of {found.size}",
        ),
        proof="the same ranges; the cap matters",
    )


@computes(N, "C5")
def c_5(item: Item) -> Outcome:
    told = [(f"MICR, mode {n + 1}", value, n) for n, value in enumerate(item.data["values"])]
    return _beside(told, example(item), "three_spr")


@computes(N, "C6")
def c_6(item: Item) -> Outcome:
    found = example(item)
    values = [float(np.degrees(found.radius[n])) for n in range(2)]
    other = micr("three_spr", 1.0, 2.0, 1.0)
    worst = float(_singular(found, "three_rps").max())
    return drawn(
        worst < HOLDS,
        *(Quantity(f"3-RPS, mode {n + 1}", value, unit="°") for n, value in enumerate(values)),
        *(
            Quantity(f"3-SPR, mode {n + 1}", float(np.degrees(other.radius[n])), unit="°")
            for n in range(2)
        ),
        Quantity("smallest singular value of the wrenches at the contacts", worst),
        proof="at the contacts the six wrenches are dependent",
    )


@computes(N, "C7")
def c_7(item: Item) -> Outcome:
    spr, rps = degrees_of("three_spr"), degrees_of("three_rps")
    less = spr < rps - 1e-9
    large = np.array(RATIOS) > 1.0
    return claimed(
        not less.any(),
        Quantity(
            "points of the grid with the larger circle of the 3-RPS",
            f"{int(less.sum())} of {less.size}",
        ),
        Quantity("of them with h₂ ≤ h₁", float(less[:, ~large].sum())),
        Quantity(
            "the example, mode 2: 3-RPS less 3-SPR",
            float(
                np.degrees(
                    np.subtract(
                        *[
                            micr(kind, 1.0, 2.0, 1.0).radius[1]
                            for kind in ("three_rps", "three_spr")
                        ]
                    )
                )
            ),
            unit="°",
        ),
        proof=f"the 3-RPS has the larger circle at {100.0 * less.mean():.0f} % of "
        f"{less.size} points, all with h₂ > h₁",
    )


@computes(N, "C8")
def c_8(item: Item) -> Outcome:
    radius = table("three_spr").radius
    found = np.degrees(radius)
    low, high = (float(value) for value in item.data["ranges"])
    most = [float(np.nanmax(found[n])) for n in range(2)]
    free = int(np.isnan(radius[1]).sum())
    return claimed(
        most[0] <= low and most[1] <= high and free == 0,
        Quantity("largest MICR in mode 1", most[0], str(item.data["ranges"][0]), "°"),
        Quantity("largest MICR in mode 2", most[1], str(item.data["ranges"][1]), "°"),
        Quantity("points in mode 2 where no tilt is singular", float(free)),
        proof=f"mode 1 reaches {most[0]:.1f}°, and in mode 2 no tilt is singular at {free} of "
        f"{radius[1].size} points",
    )


@computes(N, "C9")
def c_9(item: Item) -> Outcome:
    found = degrees_of("three_rps")
    apart = np.abs(found[0] - found[1])
    return claimed(
        bool((apart < 1.0).mean() > 0.9),
        Quantity("largest difference of the modes", float(apart.max()), unit="°"),
        Quantity(
            "share of the grid with more than 5°",
            float(round(100 * (apart > 5.0).mean(), 1)),
            unit="%",
        ),
        proof=f"they differ by up to {apart.max():.1f}°, and by more than 5° at "
        f"{100 * (apart > 5.0).mean():.0f} % of {apart.size} points",
    )


@computes(N, "C10")
def c_10(item: Item) -> Outcome:
    found = degrees_of("three_spr")
    below = found[1] < found[0] - _RING
    return claimed(
        not below.any(),
        Quantity("points with mode 2 below mode 1", f"{int(below.sum())} of {below.size}"),
        Quantity("largest difference", float((found[1] - found[0]).max()), unit="°"),
        proof=f"mode 2 is not below mode 1 at any of {below.size} points",
    )


@computes(N, "C11")
def c_11(item: Item) -> Outcome:
    found = degrees_of("three_rps")
    above, below = found[0] > found[1] + 1e-9, found[0] < found[1] - 1e-9
    return claimed(
        not below.any(),
        Quantity("points with mode 1 above mode 2", f"{int(above.sum())} of {above.size}"),
        Quantity("points with mode 1 below mode 2", f"{int(below.sum())} of {below.size}"),
        proof=f"mode 1 is above mode 2 at {100 * above.mean():.0f} % and below at "
        f"{100 * below.mean():.0f} % of {above.size} points",
    )


@computes(N, "C12")
def c_12(item: Item) -> Outcome:
    found = degrees_of("three_rps")
    spread = found.max(axis=1) - found.min(axis=1)  # over ratios: (mode, height)
    less = spread[0] < spread[1]
    from_height = float(HEIGHTS[less].min()) if less.any() else float("nan")
    return claimed(
        not less.any(),
        Quantity("mean spread over the ratios, mode 1", float(spread[0].mean()), unit="°"),
        Quantity("mean spread, mode 2", float(spread[1].mean()), unit="°"),
        Quantity("reversed from Z/h₁ on", round(from_height, 6)),
        proof=f"mean spreads are {spread[0].mean():.1f}° in mode 1 and {spread[1].mean():.1f}° in "
        f"mode 2, but from Z/h₁ = {from_height:.2f} on it is the other way",
    )


@computes(N, "C13")
def c_13(item: Item) -> Outcome:
    ratios = np.array([0.25, 0.5, 1.0, 1.25, 1.5, 2.0])
    found = np.nan_to_num(np.degrees(micr("three_spr", 1.0, ratios, 1.0).radius[1]), nan=180.0)
    low_h1 = ratios > 1.0  # h₁ : h₂ is low where h₂ : h₁ is high
    return claimed(
        bool(found[low_h1].min() > found[~low_h1].max()),
        *(
            Quantity(f"MICR at h₂/h₁ = {ratio:g}, Z = h₁", float(value), unit="°")
            for ratio, value in zip(ratios, found, strict=True)
        ),
        proof=f"for h₂/h₁ ≤ 1 it is at least {found[~low_h1].min():.0f}°, for h₂/h₁ > 1 at most "
        f"{found[low_h1].max():.0f}° (Z = h₁)",
    )
