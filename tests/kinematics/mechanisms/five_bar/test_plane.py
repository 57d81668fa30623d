"""The plane: workspace, curves, aspects, charts. Areas against closed forms, dice and grids."""

from __future__ import annotations

from math import acos, pi, sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from scipy import ndimage

from kinematics.answers.sections import BOUNDS
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets import inverse as generic
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_bar import aspects, curve_pieces, curves, inverse, loci, workspace
from kinematics.mechanisms.five_bar.design import FiveBarDesign, Limb
from kinematics.mechanisms.five_bar.statics import sines
from kinematics.plane import regions as outlines
from tests.kinematics.mechanisms.five_bar.conftest import (
    APART,
    EMPTY,
    EQUAL,
    MACHINES,
    PAPER,
    RANGED,
)

M = mechanism_class("five_bar")
lengths = st.floats(60.0, 500.0)


# --- workspace -----------------------------------------------------------------------------


def sextic(design: FiveBarDesign, points: ArrayLike, side: int) -> tuple[Array, Array]:
    """The sextic's value (...) mm⁴/mm² and gradient (..., 2), made dimensionless but for mm².

    Zero where P (..., 2) mm can stand in a parallel singularity of this side, in some working mode.
    """
    p = np.asarray(points, dtype=float)
    x, y = p[..., 0], p[..., 1]
    w = 2.0 * design.half_base
    away = p[..., None, :] - design.base
    r1, r2 = design.proximal, design.distal
    n = ((away**2).sum(axis=-1) + r2**2 - r1**2) / (2.0 * r2)
    dn = away / r2[:, None]
    u = (n[..., 0] + side * n[..., 1]) / w
    du = (dn[..., 0, :] + side * dn[..., 1, :]) / w
    m = n[..., 0] - away[..., 0, 0] * u
    dm = dn[..., 0, :] - away[..., 0, 0, None] * du
    dm = dm - np.stack([u, np.zeros_like(u)], axis=-1)
    value = m**2 - y**2 * (1.0 - u**2)
    gradient = 2.0 * m[..., None] * dm + (2.0 * y**2 * u)[..., None] * du
    gradient = gradient - np.stack([np.zeros_like(x), 2.0 * y * (1.0 - u**2)], axis=-1)
    return value, gradient


def test_the_paper_s_lens(reference: dict[str, Any]) -> None:
    (region,) = machine_of(PAPER).regions.of("workspace", ())
    lens = 2.0 * 960.0**2 * acos(240.0 / 960.0) - 240.0 * sqrt(4.0 * 960.0**2 - 480.0**2)
    assert region.section.area == pytest.approx(lens, rel=1e-14)
    assert region.section.area / 100.0 == pytest.approx(reference["workspace"]["area"], rel=1e-14)
    assert f"{region.section.area / 100.0:.6f}" == "19833.838618"
    nodes = np.concatenate([region.section.start, region.section.end])
    assert np.abs(nodes[:, 1]).max() / 10 == pytest.approx(reference["workspace"]["y_extent"])
    assert region.section.loops == 1
    np.testing.assert_allclose(region.section.centroid, [0.0, 0.0], atol=1e-9)


def test_rings_of_unlike_machines_are_closed_forms() -> None:
    # A ring that lies inside the other limb's, which a wide base and a short limb give.
    design = FiveBarDesign((Limb(40.0, 30.0), Limb(300.0, 250.0)), 100.0)
    (region,) = machine_of(design).regions.of("workspace", ())
    assert region.section.area == pytest.approx(pi * (70.0**2 - 10.0**2), rel=1e-13)
    assert region.section.loops == 2
    assert region.section.pieces == 1
    assert machine_of(EMPTY).regions.of("workspace", ())[0].section.area == 0.0
    assert np.isnan(machine_of(EMPTY).regions.of("workspace", ())[0].inside).all()


@settings(max_examples=25)
@given(lengths, lengths, lengths, lengths, lengths, st.booleans(), st.integers(0, 3))
def test_areas_are_those_of_dice(
    a: float, b: float, c: float, d: float, r: float, ranged: bool, n: int
) -> None:
    limits = (-40.0, 130.0) if ranged else None
    design = FiveBarDesign((Limb(a, b, limits), Limb(c, d)), r)
    modes = (inverse.MODES[n],) if n < 2 else inverse.MODES[:n]
    section = outlines.section_of(workspace.loops(design, modes))
    reach = r + max(a + b, c + d)
    rng = np.random.default_rng(7)
    p = rng.uniform(-reach, reach, (40000, 2))
    hit = generic.inside(design, p, modes)
    error = 4 * reach**2 * np.sqrt(max(hit.mean() * (1 - hit.mean()), 1e-4) / len(p))
    assert section.area == pytest.approx(hit.mean() * 4 * reach**2, abs=5.5 * error)
    if section.loops:
        polygons = [outlines.outline(loop, reach / 500) for loop in workspace.loops(design, modes)]
        few = p[:400]
        held = sum(outlines.contains(each, few).astype(int) for each in polygons) % 2 == 1
        rim = np.concatenate(polygons)
        clear = np.array([np.hypot(*(rim - x).T).min() for x in few]) > reach / 100
        np.testing.assert_array_equal(held[clear], hit[:400][clear])


def test_edges_meet_and_lie_on_their_bounds() -> None:
    for design in MACHINES.values():
        for mode in inverse.MODES:
            section = outlines.section_of(workspace.loops(design, (mode,)))
            for loop in range(section.loops):
                rows = range(section.loop_start[loop], section.loop_start[loop + 1])
                for a, b in zip(rows, [*rows[1:], rows[0]], strict=True):
                    assert np.array_equal(section.end[a], section.start[b])
            for k in range(len(section.start)):
                (middle,) = section.edge_points(k, 1e9)[1:2]
                i = section.limb[k] - 1
                rho = float(np.hypot(*(middle - design.base[i])))
                if BOUNDS[section.bound[k]] == "link":
                    limb = design.limbs[i]
                    ends = (limb.proximal + limb.distal, abs(limb.proximal - limb.distal))
                    assert min(abs(rho - end) for end in ends) < 1e-9
                else:
                    joints = inverse.joints_of(design, middle, mode)
                    assert np.abs(joints[i] - design.joint_range[i]).min() < 1e-9


# --- parallel singularities ----------------------------------------------------------------


@settings(max_examples=40)
@given(lengths, lengths, lengths, lengths, lengths)
# Four equal sides: both ways on from where they lie flat; a loop leaps from one to the other.
@example(120.0, 60.0, 120.0, 60.0, 60.0)
def test_curves_are_exact_and_closed(a: float, b: float, c: float, d: float, r: float) -> None:
    design = FiveBarDesign((Limb(a, b), Limb(c, d)), r)
    tau = np.linspace(0.0, 2 * np.pi, 301)
    for loop in curves.loops(design):
        p, q = loop.points(tau)
        assert curves.closure(design, p, q, loop.side).max() < 1e-11 * design.size
        assert np.hypot(*(p[0] - p[-1])) < 1e-6 * design.size or curves.leaps(loop)
        _, sine = sines(design, p, q)
        assert np.abs(sine).max() < 1e-6
        value, gradient = sextic(design, p, loop.side)
        slope = np.hypot(*gradient.T)
        assert (np.abs(value) <= 1e-7 * design.size * np.maximum(slope, design.size)).all()


def test_the_sextic_s_gradient_is_that_of_differences() -> None:
    rng = np.random.default_rng(3)
    p = rng.uniform(-600.0, 600.0, (50, 2))
    for design in MACHINES.values():
        for side in (1, -1):
            _, gradient = sextic(design, p, side)
            for k in range(2):
                step = np.zeros(2)
                step[k] = 1e-3
                up, down = (sextic(design, p + s * step, side)[0] for s in (1, -1))
                np.testing.assert_allclose(
                    gradient[:, k], (up - down) / 2e-3, rtol=1e-5, atol=1e-3 * design.size
                )


def test_every_crossing_of_the_determinant_is_on_a_curve() -> None:
    rng = np.random.default_rng(9)
    for design in (PAPER, APART, RANGED):
        for mode in inverse.MODES:
            p = rng.uniform(-800.0, 800.0, (3000, 2))
            ends = np.stack([p, p + rng.normal(size=p.shape) * 5.0])
            q = inverse.joints_of(design, ends, mode)
            ok = inverse.in_range(design, q).all(axis=(0, -1))
            sign = np.sign(sines(design, ends, q)[1])
            with np.errstate(invalid="ignore"):
                crossed = ok & (sign[0] * sign[1] < 0.0)
            held = [piece for piece in curve_pieces.pieces(design) if piece.mode == mode]
            points = [curve_pieces.sampled(piece, 1.0)[0] for piece in held]
            for one in ends[0][crossed][:20]:
                assert min(np.hypot(*(each - one).T).min() for each in points) < 40.0


def test_the_reference_s_points(reference: dict[str, Any]) -> None:
    (extended, *_) = curves.loops(PAPER)
    tau = np.linspace(0.0, 2 * np.pi, 20001)
    p, q = extended.points(tau)
    for x, y, t1, t2 in reference["type2"]["extended_points_x_y_th1_th2"]:
        near = np.hypot(*(p - [10 * x, 10 * y]).T) < 0.2
        # A base joint is passed twice, with other angles.
        apart = np.abs(np.sin(0.5 * (q[near] - [t1, t2]))).max(axis=-1)
        assert apart.min() < 2e-3
        value, gradient = sextic(PAPER, [10 * x, 10 * y], 1)
        assert abs(value) < 1e-3 * max(np.hypot(*gradient), 1.0)
    folded = [loop for loop in curves.loops(PAPER) if loop.side == -1]
    for loop in folded:
        circle, _ = loop.points(tau)
        y = 415.69219381653056 * np.sign(circle[:, 1].mean())
        np.testing.assert_allclose(np.hypot(*(circle - [0.0, y]).T), 480.0, rtol=1e-13)
    for x, y in reference["type2"]["folded_points"]:
        assert abs(np.hypot(10 * x, 10 * y - 415.69219381653056) - 480.0) < 1e-9


# The coupler is as long as the base and the cranks are equal: θ₁ leaps where they lie in line,
# which is at γ = 0 or π by which distal link is the longer.
LEAPING = tuple(
    FiveBarDesign((Limb(400.0, a), Limb(400.0, b)), 150.0)
    for a, b in ((100.0, 400.0), (400.0, 100.0), (50.0, 250.0))
)


def test_pieces_have_one_mode_and_end_where_it_changes() -> None:
    for design in (*MACHINES.values(), *LEAPING):
        for piece in curve_pieces.pieces(design):
            if piece.serial:
                continue
            p, q = piece.loop.points(piece.tau(np.linspace(0.02, 0.98, 25)))
            assert set(inverse.mode_of(design, p, q)) == {piece.mode}
            assert inverse.in_range(design, q).all()
            turns = np.diff(piece.loop.points(piece.tau(np.linspace(0.0, 1.0, 400)))[1], axis=0)
            assert np.abs((turns + np.pi) % (2 * np.pi) - np.pi).max() < 1.0  # it is one curve
            if not piece.whole:
                ends, joints = piece.loop.points(piece.tau([0.0, 1.0]))
                limbs, _ = sines(design, ends, joints)
                rest = np.abs(joints[..., None] - design.joint_range).min(axis=-1)
                at_base = np.linalg.norm(ends[:, None] - design.base, axis=-1) / design.size
                assert (
                    np.minimum(np.minimum(np.abs(limbs), rest), at_base).min(axis=-1) < 1e-5
                ).all()


# --- aspects -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", MACHINES)
def test_aspects_are_those_of_a_grid(name: str) -> None:
    design = MACHINES[name]
    found = aspects.aspects(design)
    reach = design.half_base + float((design.proximal + design.distal).max())
    count = 320
    step = 2 * reach / count
    axis = (np.arange(count) + 0.5) * step - reach
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1)
    for mode in inverse.MODES:
        whole = outlines.section_of(workspace.loops(design, (mode,))).area
        mine = [each for each in found if each.mode == mode]
        assert sum(each.area for each in mine) == pytest.approx(whole, rel=1e-10, abs=1e-4)
        q = inverse.joints_of(design, grid, mode)
        ok = inverse.in_range(design, q).all(axis=-1)
        with np.errstate(invalid="ignore"):
            sign = np.sign(sines(design, grid, q)[1])
        for side in (1, -1):
            area = sum(each.area for each in mine if each.sign == side)
            cells = ok & (sign == side)
            # Of cells cut by the boundary about half count.
            assert area == pytest.approx(cells.sum() * step**2, abs=4.0 * reach * step)
            labels, pieces = ndimage.label(cells)
            sizes = np.bincount(labels.ravel(), minlength=pieces + 1)[1:] * step**2
            large = 400 * step**2
            if name != "equal":  # there one sign lies on both sides of a double curve
                # A narrow neck may be lost on the grid, but nothing is parted that hangs together.
                exact = sum(each.area > large for each in mine if each.sign == side)
                assert (sizes > 0.9 * large).sum() >= exact
        for each in mine:
            if each.area > 400 * step**2:
                inside = outlines.point_inside(each.loops)
                assert each.holds(inside[None], design.size).all()
                joints = inverse.joints_of(design, inside, mode)
                assert np.sign(sines(design, inside, joints)[1]) == each.sign


def test_opposite_modes_mirror_each_other() -> None:
    found = machine_of(PAPER).regions.of("aspects", ())
    areas = {
        mode: sorted(round(r.section.area, 4) for r in found if r.mode == mode)
        for mode in inverse.MODES
    }
    assert areas["+-"] == areas["-+"]
    assert areas["++"] == areas["--"]
    assert len(areas["+-"]) == 3
    assert len(areas["++"]) == 2
    groups = {(r.sign, r.group) for r in found}
    assert len(groups) == 2  # one for each assembly mode


def test_groups_join_by_following() -> None:
    """A motion that passes serial singularities only stays within a group."""
    found = aspects.aspects(PAPER)
    rng = np.random.default_rng(4)

    def group(posture: Any) -> int:
        p = np.array(posture.pose)
        _, sine = sines(PAPER, p, np.array(posture.joints))
        if abs(float(sine)) < 0.02:
            return 0
        held = [
            a.group
            for a in found
            if a.mode == posture.mode
            and a.holds(p[None], PAPER.size)[0]
            and a.sign == np.sign(sine)
        ]
        return held[0] if held else 0

    told = 0
    for _ in range(60):
        start = machine_of(PAPER).inverse.posture(
            rng.uniform(-700, 700, 2), inverse.MODES[rng.integers(4)]
        )
        if not start.reachable or not group(start):
            continue
        moved = machine_of(PAPER).following.follow(
            start, np.array(start.joints) + rng.normal(size=2)
        )
        if group(moved.posture):
            told += 1
            assert group(moved.posture) == group(start)
    assert told > 20


def test_change_points_do_not_lose_an_area() -> None:
    found = aspects.aspects(EQUAL)
    upper = [a.area for a in found if a.mode == "+-"]
    disc = pi * 240.0**2
    assert any(area == pytest.approx(disc, rel=1e-9) for area in upper)


# --- results -------------------------------------------------------------------------------


def test_regions_are_told_by_key() -> None:
    assert [spec.key for spec in machine_of(PAPER).region_specs] == [
        "workspace",
        "modes",
        "aspects",
    ]
    pose = machine_of(PAPER).home.pose
    each = machine_of(PAPER).regions.of("modes", pose, ("+-", "--"))
    assert [region.mode for region in each] == ["+-", "--"]
    for region in machine_of(PAPER).regions.of("aspects", pose, None):
        assert region.deviation < 2e-6 * PAPER.size
        assert region.group > 0
        shown = region.section
        assert not np.isnan(shown.area)
        assert (shown.limb[shown.bound == BOUNDS.index("parallel")] == 0).all()
    with pytest.raises(InputError, match="no regions"):
        machine_of(PAPER).regions.of("solid", pose, None)
    np.testing.assert_array_equal(machine_of(PAPER).regions.frame(pose), np.eye(4))


@pytest.mark.parametrize("key", ["plane", "plane-all", "joints"])
def test_charts(key: str) -> None:
    for design in MACHINES.values():
        found = machine_of(design).singularities.locus(key, (0.0, 0.0), "+-")
        assert found.start[-1] == len(found.points)
        assert len(found.kinds) == len(found.limb) == len(found.start) - 1
        assert found.residual.max() < 1e-9 * design.size
        assert (found.points >= found.bounds[:, 0] - 1e-6).all()
        assert (found.points <= found.bounds[:, 1] + 1e-6).all()
        for n, kind in enumerate(found.kinds):
            part = found.points[found.start[n] : found.start[n + 1]]
            assert (found.limb[n] > 0) == (kind == "serial")
            if key == "joints":
                assert np.abs(np.diff(part, axis=0)).max(initial=0.0) < np.pi
            elif kind == "parallel":
                assert np.hypot(*np.diff(part, axis=0).T).max() < design.size / loci.FINE * 1.01
    with pytest.raises(InputError, match="no loci"):
        machine_of(PAPER).singularities.locus("section", (0.0, 0.0), "+-")
