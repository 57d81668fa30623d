"""One limb's vertex space against closed forms, and its two constructions against each other."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.integrate import quad

from kinematics.errors import InputError
from kinematics.facets.solids import RESOLUTIONS
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.workspace.vertex_space import (
    PARTS,
    Surface,
    deviation,
    limb_solid,
    segments,
)
from kinematics.mechanisms.five_rpur.workspace.workspace import limb_part
from kinematics.solids.csg import Solid

PAPER = (150.0, 250.0, 400.0)
LIMBS = [
    pytest.param(PAPER, id="paper"),
    pytest.param((150.0, 0.0, 400.0), id="no inner circle"),
    pytest.param((70.0, 250.0, 400.0), id="no H3"),
    pytest.param((75.0, 250.0, 400.0), id="H3 just vanishes"),
    pytest.param((75.1, 250.0, 400.0), id="H3 just appears"),
    pytest.param((600.0, 250.0, 400.0), id="link longer than the stroke reaches"),
    pytest.param((3000.0, 1.0, 4.0), id="very long link"),
    pytest.param((0.5, 250.0, 400.0), id="very short link"),
    pytest.param((150.0, 399.9, 400.0), id="hardly any stroke"),
    pytest.param((150.0, 1e-3, 400.0), id="tiny inner circle"),
    pytest.param((1.5e5, 2.5e5, 4.0e5), id="huge"),
    pytest.param((0.15, 0.25, 0.4), id="tiny"),
]
# What one limb alone may miss of its volume.
TOLERANCE = {"preview": 4e-3, "normal": 5e-4, "fine": 5e-5}


def lens(a: float, b: float, distance: float) -> float:
    """Area common to two circles."""
    if distance >= a + b:
        return 0.0
    if distance <= abs(a - b):
        return np.pi * min(a, b) ** 2
    p = (distance**2 + a**2 - b**2) / (2 * distance)
    q = distance - p
    triangle = np.sqrt(max(a**2 - p**2, 0.0))
    return (
        a**2 * np.arccos(np.clip(p / a, -1, 1))
        + b**2 * np.arccos(np.clip(q / b, -1, 1))
        - distance * triangle
    )


def swept(link: float, low: float, high: float, area) -> float:
    """∫ area(2 h) dy over |y| ≤ l, with its kinks, where circles touch, at panel ends."""
    kinks = {0.0, np.pi / 2}
    for distance in (high - low, high + low, 2 * low, 2 * high):
        if 0 < distance / 2 < link:
            kinks.add(float(np.arcsin(distance / 2 / link)))
    ends = sorted(kinks)
    parts = [
        quad(lambda b: area(2 * link * np.sin(b)) * np.sin(b), p, q, epsrel=1e-9, limit=200)[0]
        for p, q in itertools.pairwise(ends)
    ]
    return 2 * link * sum(parts)


def true_volumes(link: float, low: float, high: float) -> dict[str, float]:
    ring = np.pi * (high**2 - low**2)

    def both(d: float) -> float:
        return lens(high, high, d) - 2 * lens(high, low, d) + lens(low, low, d)

    half = 2 * link * ring
    discs = 2 * link * np.pi * high**2
    body = discs + np.pi * link**2 * 2 * high  # the discs' width times 2 h, and ∫ 2 h = π l²
    joined = swept(link, low, high, lambda d: 2 * np.pi * high**2 - lens(high, high, d))
    h2 = swept(link, low, high, lambda d: lens(low, low, d)) if low else 0.0
    h3 = swept(link, low, high, lambda d: 2 * (np.pi * low**2 - lens(low, high, d))) if low else 0.0
    return {
        "plus": half,
        "minus": half,
        "whole": 2 * half - swept(link, low, high, both),
        "body": body,
        "H1": body - joined,
        "H2": h2,
        "H3": h3,
    }


def test_closed_forms_agree_with_the_paper_s_example():
    volumes = true_volumes(*PAPER)
    assert volumes["plus"] == pytest.approx(91_891_585, abs=1)
    holes = volumes["H1"] + volumes["H2"] + volumes["H3"]
    assert volumes["body"] - holes == pytest.approx(volumes["whole"], rel=1e-8)


@pytest.mark.parametrize("limb", LIMBS)
@pytest.mark.parametrize("resolution", RESOLUTIONS)
def test_volumes_of_all_parts(limb, resolution):
    true = true_volumes(*limb)
    design = FiveRPURDesign((Limb((0, 0, 0), (0, 0, 0), limb[0], limb[1:]),) * 5)
    for part in PARTS:
        built = limb_part(design, 1, part, resolution)
        rounding = 1e-6 * true["body"]
        assert built.volume == pytest.approx(true[part], abs=built.volume_error + rounding)
        assert built.watertight
        if part not in ("body", "H1"):  # flat sides stand where the ring's corners are
            allowed = TOLERANCE[resolution] * true["body"]
            assert built.volume == pytest.approx(true[part], abs=allowed)
    for half in ("plus", "minus"):  # a straight shear keeps the volume, and rings have the area
        assert limb_solid(*limb, half, resolution).volume == pytest.approx(true[half], rel=1e-9)


@pytest.mark.parametrize("limb", LIMBS)
def test_both_constructions_are_the_same_solid(limb):
    whole = limb_solid(*limb, "whole", "preview")
    body, *holes = (limb_solid(*limb, part, "preview") for part in ("body", "H1", "H2", "H3"))
    carved = body.difference(holes)
    small = 1e-6 * body.volume
    assert whole.difference((carved,)).volume <= small
    assert carved.difference((whole,)).volume <= small
    # The four sets partition the body: nothing is cut twice and nothing lies outside.
    assert whole.volume + sum(h.volume for h in holes) == pytest.approx(body.volume, abs=small)
    assert Solid.union(holes).difference((body,)).volume <= small


def test_holes_that_do_not_exist_are_empty():
    assert limb_solid(70.0, 250.0, 400.0, "H3", "normal").is_empty
    assert not limb_solid(90.0, 250.0, 400.0, "H3", "normal").is_empty
    for part in ("H2", "H3"):
        assert limb_solid(150.0, 0.0, 400.0, part, "normal").is_empty
    assert not limb_solid(150.0, 1.0, 400.0, "H2", "normal").is_empty


@pytest.mark.parametrize("limb", LIMBS)
@pytest.mark.parametrize("part", PARTS)
def test_vertices_are_near_the_surfaces_that_their_faces_name(limb, part):
    traced = limb_solid(*limb, part, "normal").traced()
    reach = deviation(limb[0], limb[2], "normal")
    for number, patch in enumerate(traced.patches):
        tag = patch.tag
        assert isinstance(tag, Surface)
        x, y, z = (
            traced.mesh.vertices[traced.mesh.faces[traced.patch_of == number]].reshape(-1, 3).T
        )
        if tag.kind == "end":
            gap = np.abs(np.abs(y) - tag.link)
        elif tag.kind == "side":
            gap = np.abs(np.abs(x) - tag.radius)
        else:
            h = np.sqrt(np.maximum(tag.link**2 - y**2, 0.0))
            # Along the surface's normal: h is steep near y = ±l.
            radial = np.hypot(x, z - tag.sign * h)
            rise = np.abs(z - tag.sign * h) / np.maximum(radial, 1e-300)
            slope = np.abs(y) / np.maximum(h, 1e-300)
            gap = np.abs(radial - tag.radius) / np.hypot(1.0, slope * rise)
        assert gap.max(initial=0.0) <= 1.5 * reach


def test_symmetric_about_both_planes():
    for part in ("whole", "body", "H1", "H2", "H3"):
        solid = limb_solid(*PAPER, part, "preview")
        low, high = np.array(solid.bounds)
        np.testing.assert_allclose(low, -high, atol=1e-9)
    up, down = (np.array(limb_solid(*PAPER, part, "preview").bounds) for part in ("plus", "minus"))
    np.testing.assert_allclose(up[:, 2], -down[::-1, 2])


def test_each_limb_is_built_once():
    assert limb_solid(*PAPER, "whole", "preview") is limb_solid(150, 250, 400, "whole", "preview")


def test_segments_follow_the_limb_s_proportions():
    ring, sweep = segments(150.0, 400.0, "normal")
    long_ring, long_sweep = segments(1500.0, 400.0, "normal")
    assert long_ring < ring
    assert long_sweep > sweep
    for resolution in RESOLUTIONS:
        for link in (1e-6, 1.0, 1e6):
            ring, sweep = segments(link, 1.0, resolution)
            assert ring % 4 == 0
            assert 12 <= ring <= 1000
            assert 6 <= sweep <= 1000


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ((150, 250, 400, "H4", "normal"), "H4"),
        ((150, 250, 400, "whole", "coarse"), "coarse"),
        ((0, 250, 400, "whole", "normal"), "link"),
        ((150, 400, 400, "whole", "normal"), "rho_min < rho_max"),
        ((150, -1, 400, "whole", "normal"), "rho_min"),
        ((150, 250, float("nan"), "whole", "normal"), "rho_max"),
        ((float("inf"), 250, 400, "whole", "normal"), "link"),
    ],
)
def test_what_makes_no_limb_is_refused(arguments, why):
    with pytest.raises(InputError, match=why):
        limb_solid(*arguments)
