"""Simplified 5-RPUR designs with many real solutions, solved, and what is counted on them."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.features.paper.recomputed.postures import machine, with_limbs
from kinematics.answers.solutions import ForwardSolutions
from kinematics.arrays import Array
from kinematics.designs.assets import asset_folder
from kinematics.machine import Machine

ORDER = ("A1", "A2", "A3")
_SAME = 1e-6  # of what is compared: closer values are one
_W = 5  # of the roots' unknowns the first z′ coordinate of a U joint, see `five_rpur`


@dataclass(frozen=True)
class Example:
    """A design with as many real solutions as were found, solved.

    Attributes:
        name: "{A1A2}".
        groups: limbs of each arrangement, from 0.
        found: all solutions, in mixed modes too unless joints are merged.
        tied: of the real ones those with each arrangement in one working mode.
        complex_count: of all, with each arrangement in one working mode.
    """

    name: str
    machine: Machine[Any]
    groups: tuple[tuple[int, ...], ...]
    found: ForwardSolutions
    tied: NDArray[np.intp]
    complex_count: int


@cache
def examples() -> dict[str, Example]:
    """The nine simplified designs by their names."""
    path = asset_folder("papers") / "most-real.toml"
    known = tomllib.loads(path.read_text(encoding="utf-8"))["example"]
    return {entry["design"]: _example(entry) for entry in known}


def _example(entry: dict[str, Any]) -> Example:
    name = entry["design"]
    groups = ((0, 1, 2),) if name.startswith("{Mp") else ((0, 1), (2, 3))
    limbs = [
        {"base": v[:3], "platform": v[3:6], "link": v[6], "stroke": [1.0, 2000.0]}
        for v in entry["limbs"]
    ]
    merged = [pair for pair in ((0, 1), (2, 3)) if _merge(limbs, *pair)]
    head = f"merged_joints = {[[i + 1, j + 1] for i, j in merged]}" if merged else ""
    made = with_limbs(limbs, head)
    found = made.forward(entry["joints"])
    together = np.ones(len(found), dtype=bool)
    for first, *others in groups:
        for other in others:
            together &= np.array([mode[first] == mode[other] for mode in found.modes], dtype=bool)
    same = tied_roots(found.roots, groups)
    return Example(name, made, groups, found, np.flatnonzero(together), int(same.sum()))


def _merge(limbs: list[dict[str, Any]], i: int, j: int) -> bool:
    """Whether two limbs can have one U joint: an A1 pair."""
    one, two = limbs[i], limbs[j]
    equal = one["platform"] == two["platform"] and one["link"] == two["link"]
    return bool(equal and one["base"][1] == two["base"][1])


# --- places --------------------------------------------------------------------------------


def joints_b(made: Machine[Any], found: ForwardSolutions, some: NDArray[np.intp]) -> Array:
    """(N, 5, 3) the U joints of some of the solutions, mm."""
    return np.array(
        [made.statics.wrenches(found.poses[n], found.modes[n]).point[:5] for n in some.tolist()]
    ).reshape(-1, 5, 3)


def distinct(values: Array) -> NDArray[np.intp]:
    """(N,) which of N values (N, K) are one: a number for each, from 0."""
    number = np.full(len(values), -1)
    count = 0
    for n in range(len(values)):
        if number[n] < 0:
            near = np.abs(values - values[n]).max(axis=1) < 1e-5 * (1.0 + np.abs(values).max())
            number[near] = count
            count += 1
    return number


def number_of(values: Array) -> int:
    """How many different ones there are among values (N, K)."""
    return int(distinct(values).max()) + 1


def places(name: str) -> tuple[Array, Array, Example]:
    """θ as a point on a circle (N, 2), and the U joints' x and z (N, 5, 2), of the tied ones."""
    one = examples()[name]
    theta = one.found.poses[one.tied, 4]
    b = joints_b(one.machine, one.found, one.tied)[:, :, [0, 2]]
    return np.stack([np.cos(theta), np.sin(theta)], axis=1), b, one


def each_of(groups: NDArray[np.intp], values: Array) -> set[int]:
    """How many different values there are in each group."""
    return {number_of(values[groups == n]) for n in range(int(groups.max()) + 1)}


def flat(values: Array) -> Array:
    return values.reshape(len(values), -1)


def places_of_roots(name: str) -> Array:
    """e^{iθ} (M, 2) of every complex solution with the arrangements in one mode each."""
    one = examples()[name]
    return turns_of_roots(one.found, one.groups)


def turns_of_roots(found: ForwardSolutions, groups: tuple[tuple[int, ...], ...]) -> Array:
    roots = found.roots
    turn = roots[4, tied_roots(roots, groups)]
    return np.stack([turn.real, turn.imag], axis=1)


def tied_roots(
    roots: NDArray[np.complex128], groups: tuple[tuple[int, ...], ...]
) -> NDArray[np.bool_]:
    """Which complex solutions have each arrangement in one working mode: equal z′ of its B."""
    same = np.ones(roots.shape[1], dtype=bool)
    for first, *others in groups:
        for other in others:
            same &= np.abs(roots[_W + first] - roots[_W + other]) < _SAME
    return same


def turns(found: ForwardSolutions, some: NDArray[np.intp]) -> int:
    """How many different θ some of the real solutions have."""
    if not len(some):
        return 0
    theta = found.poses[some, 4]
    return number_of(np.stack([np.cos(theta), np.sin(theta)], axis=1))


@cache
def solved(name: str, joints: tuple[float, ...]) -> ForwardSolutions:
    return machine(name).forward(joints)
