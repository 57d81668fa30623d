"""Workspaces over one another: by parts of themselves, by membership, by solids beside sections."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest

import kinematics as kin
from kinematics.facets.comparison import Comparison

SMALLER = {  # a number of each kind's preset that leaves a part of its workspace
    "five-bar": [(("proximal", 0), 400.0), (("proximal", 1), 400.0)],
    "rps-3": [(("stroke", 0), 260.0)],
    "spr-3": [(("stroke", 1), 170.0)],
    "sps-spr": [(("limb", 0, "stroke", 1), 780.0)],
    "rpur-table1": [(("limb", 2, "stroke", 1), 380.0)],
}


def edited(name: str, edits: list[Any]) -> kin.Machine[Any]:
    made = kin.open(name)
    for path, value in edits:
        made = made.edited(path, value)
    return made


def random_rpur(rng: np.random.Generator, scale: float = 1.0) -> kin.Machine[Any]:
    """A 5-RPUR whose limbs all differ, not far from Table 1."""
    made = kin.open("rpur-table1")
    values = [(f.path, scale * (f.value + rng.uniform(-20.0, 20.0))) for f in made.fields]
    for path, value in values if scale <= 1.0 else reversed(values):  # ρ_min stays below ρ_max
        made = made.edited(path, value)
    return made


def close(one: Any, other: Any) -> bool:
    return bool(abs(one.value - other.value) <= one.error + other.error + 1e-9 * abs(one.value))


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    "name",
    ["five-bar", "rpur-table1", *(pytest.param(n, marks=SLOW) for n in ("rps-3", "sps-spr"))],
)
def test_a_workspace_over_itself_and_over_a_part_of_itself(name: str) -> None:
    whole, part = kin.open(name), edited(name, SMALLER[name])
    if name == "five-bar":  # shorter links reach less far, and the hole between them is larger
        whole = edited(name, [(("proximal", n), 480.0) for n in range(2)])
    found = whole.compare(part)
    assert found.exact == (name in ("five-bar", "rpur-table1"))
    size, lesser = found.sizes
    if name != "five-bar":
        assert close(found.common, lesser)
        assert found.only[1].value <= found.only[1].error
    assert found.only[0].value == pytest.approx(
        size.value - found.common.value, rel=1e-9, abs=found.only[0].error
    )
    same = whole.compare(whole)
    assert close(same.common, size)
    assert all(one.value <= one.error + 1e-9 * size.value for one in same.only)


@pytest.mark.parametrize("modes", [pytest.param(None, marks=SLOW), "+-+-+"])
def test_four_designs_by_membership(modes: str | None) -> None:
    """Random places, judged by inverse kinematics, are in the parts as often as these are large."""
    rng = np.random.default_rng(3)
    machines = [kin.open("rpur-table1"), *(random_rpur(rng) for _ in range(3))]
    first, *others = machines
    found = first.compare(*others, modes=modes, phi=0.2, theta=-0.15)
    spaces = found.spaces
    vertices = np.concatenate([s.solid("preview").mesh.vertices for s in spaces])
    low, high = vertices.min(axis=0) - 5.0, vertices.max(axis=0) + 5.0
    points = rng.uniform(low, high, (20_000, 3))
    held = np.stack([space.contains(points) for space in spaces])
    box = float(np.prod(high - low))

    def judged(hits: Any, told: Any) -> None:
        share = hits.mean()
        spread = box * np.sqrt(share * (1.0 - share) / len(points)) + 1e-9 * box
        assert abs(box * share - told.value) <= 4.5 * spread + told.error

    judged(held.all(axis=0), found.common)
    for n, only in enumerate(found.only):
        judged(held[n] & (held.sum(axis=0) == 1), only)
    for n, size in enumerate(found.sizes):
        judged(held[n], size)


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=SLOW) for n in range(1, 6))])
def test_solids_agree_with_exact_sections(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one, other = random_rpur(rng), random_rpur(rng)
    turned = {"phi": rng.uniform(-0.4, 0.4), "theta": rng.uniform(-0.4, 0.4)}
    exact = one.compare(other, **turned)
    solids = Comparison(exact.spaces)
    solids._way = "solids"
    assert close(exact.common, solids.common)
    for a, b in zip(exact.only, solids.only, strict=True):
        assert close(a, b)
    parts = exact.parts()
    for built, size in zip((parts.common, *parts.only), (exact.common, *exact.only), strict=True):
        assert built.watertight
        assert abs(built.volume - size.value) <= built.volume_error + size.error


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_every_scale_gives_the_scaled_answer(scale: float) -> None:
    made = [[random_rpur(np.random.default_rng(n), s) for n in range(2)] for s in (1.0, scale)]
    found = [one.compare(other, phi=0.1) for one, other in made]
    one, other = (each.common for each in found)
    error = other.error + scale**3 * one.error
    assert abs(other.value - scale**3 * one.value) <= error <= 1e-5 * other.value


def test_five_bars_share_what_all_four_limbs_reach() -> None:
    """Regions by arcs against a fine grid of places, each judged by inverse kinematics."""
    one = kin.open("five-bar")
    other = edited("five-bar", [(("distal", 1), 420.0), (("joint_range_deg", 0, 0), -1.0)])
    for modes in (None, "+-", "++,-+"):
        found = one.compare(other, modes=modes)
        axis = np.linspace(-1100.0, 1100.0, 441)
        points = np.array(list(product(axis, axis)))
        cell = (axis[1] - axis[0]) ** 2
        held = [space.contains(points) for space in found.spaces]
        counts = (held[0] & held[1], held[0] & ~held[1], held[1] & ~held[0])
        every, alone = found.sections
        for counted, section in zip(counts, (every, *alone), strict=True):
            rim = section.perimeter * np.sqrt(cell)
            assert abs(section.area - counted.sum() * cell) <= 0.2 * rim + 0.5 * cell
        for n in range(2):
            assert found.common.value + found.only[n].value == pytest.approx(
                found.sizes[n].value, rel=1e-9
            )


@pytest.mark.slow
def test_tripods_are_drawn_as_the_first_one() -> None:
    """A larger platform alone changes the chart's scale, and the poses hardly."""
    one = kin.open("rps-3")
    other = one.edited("platform_radius", 101.0)
    found = one.compare(other)
    assert found.sizes[1].value == pytest.approx(found.sizes[0].value, rel=0.05)
    assert found.common.value > 0.95 * found.sizes[0].value


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("rps-3", "spr-3"), "different coordinates"),
        (("five-bar", "rps-3"), "plane workspace"),
        (("rpur-table1",), "two to 4 designs are compared, got 1"),
        (("five-bar",) * 5, "two to 4 designs are compared, got 5"),
    ],
)
def test_what_cannot_be_compared_is_told(names: tuple[str, ...], words: str) -> None:
    first, *others = map(kin.open, names)
    with pytest.raises(kin.InputError, match=words):
        first.compare(*others)


def test_a_mode_that_one_machine_lacks_is_told() -> None:
    with pytest.raises(kin.InputError, match="mode"):
        kin.open("rpur-table1").compare(kin.open("rpur-a1a1"), modes="+-+-+")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(50))
def test_parts_add_up_on_fifty_pairs_of_all_kinds(seed: int) -> None:
    """common + only is each size within the errors, by meshes of another resolution."""
    rng = np.random.default_rng(seed)
    name = list(SMALLER)[seed % len(SMALLER)]
    machines = []
    for _ in range(2):
        made = kin.open(name)
        for field in made.fields:
            if field.unit == "mm":
                made = made.edited(field.path, field.value * rng.uniform(0.97, 1.03))
        machines.append(made)
    found = machines[0].compare(machines[1])
    for size, only in zip(found.sizes, found.only, strict=True):
        error = size.error + only.error + found.common.error
        assert abs(found.common.value + only.value - size.value) <= error + 1e-9 * size.value
    if found.unit == "mm³":
        parts = found.parts("preview")
        for built, size in zip(
            (parts.common, *parts.only), (found.common, *found.only), strict=True
        ):
            assert built.watertight or not built.triangles
            assert abs(built.volume - size.value) <= built.volume_error + size.error
