"""The workspace as a solid: against stored volumes, exact slices, and inverse kinematics."""

from __future__ import annotations

import io
from itertools import pairwise, product

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from kinematics.errors import InputError
from kinematics.facets.solids import RESOLUTIONS
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.mechanisms.five_rpur.workspace.vertex_space import PARTS
from kinematics.mechanisms.five_rpur.workspace.workspace import limb_part, workspace
from kinematics.screws.spatial import rotation_x, rotation_y
from kinematics.solids.files import encode
from tests.kinematics.mechanisms.five_rpur.machines import of_volume_case
from tests.kinematics.references import read

CASES = read("volumes.json")["cases"]
FLOOR = {"preview": 1e-2, "normal": 1e-3, "fine": 1e-4}
MODES = ["".join(signs) for signs in product("+-", repeat=5)]


def modes_of(case) -> tuple[str, ...] | None:
    signs = case["modes"]
    return None if signs is None else ("".join("+" if s > 0 else "-" for s in signs),)


TABLE_1, TABLE_2 = of_volume_case(CASES[0]), of_volume_case(CASES[6])


def check(built) -> None:
    """What holds of every solid, whatever the machine."""
    assert built.watertight
    assert built.triangles == len(built.mesh.faces)
    assert bool(built.pieces) == (built.volume > 0) == (built.triangles > 0)
    assert all(p.volume > 0 for p in built.pieces)
    assert sum(p.volume for p in built.pieces) == pytest.approx(built.volume, rel=1e-9)
    assert [p.volume for p in built.pieces] == sorted(p.volume for p in built.pieces)[::-1]
    assert np.isfinite(built.volume_error)
    if built.triangles:
        again = trimesh.load(io.BytesIO(encode(built.mesh, "stl")), file_type="stl")
        assert again.is_watertight or np.abs(built.mesh.vertices).max() < 1.0
        assert again.volume == pytest.approx(built.volume, rel=1e-5)
        np.testing.assert_array_equal(
            built.shaded.vertices[built.shaded.faces],
            built.mesh.vertices[built.mesh.faces].astype(np.float32),
        )


# --- an independent volume: exact areas of slices y' = const, and one quadrature over y' --------


def true_volume(design: FiveRPURDesign, phi, theta, modes=None, nodes=160) -> float:
    """In a slice a limb's vertex space is two annuli. The area common to all limbs follows by
    Green's theorem from the arcs of which exactly one side lies in all of them.
    """
    w = design.base @ rotation_y(theta) - design.platform @ rotation_x(-phi)
    link, low, high = design.link, *design.stroke.T
    size = float((link + high).min())
    circles = {}  # equal ones once: (centre's x, y and z, l, r, σ) to the limb they come from
    for i in range(5):
        for n, sign in enumerate("+-"):
            if modes is None or any(m[i] == sign for m in modes):
                for radius in (low[i], high[i]):
                    key = np.round(np.array([*w[i], link[i], radius]) / size, 9) + 0.0
                    if radius > 0:
                        circles.setdefault((*key, n), (i, 1 - 2 * n, radius))
    owner, sign, radius = (np.array(column) for column in zip(*circles.values(), strict=True))

    start, end = (w[:, 1] - link).max(), (w[:, 1] + link).min()
    if start >= end:
        return 0.0
    panels = np.unique(np.clip([*(w[:, 1] - link), *(w[:, 1] + link), *w[:, 1]], start, end))
    panels = panels[np.append(True, np.diff(panels) > 1e-9 * size)]
    point, weight = np.polynomial.legendre.leggauss(max(12, nodes // max(1, len(panels) - 1)))
    half_turn = np.pi / 2 * point  # y = sin: square roots at the ends of a panel vanish
    total = 0.0
    for a, b in pairwise(panels):
        y = (a + b) / 2 + (b - a) / 2 * np.sin(half_turn)
        h = np.sqrt(np.maximum(link**2 - (y[:, None] - w[:, 1]) ** 2, 0.0))
        centre = np.stack(
            [np.broadcast_to(w[owner, 0], (len(y), len(owner))), w[owner, 2] + sign * h[:, owner]],
            axis=-1,
        )

        def inside(p, h=h):
            member = np.empty((5, 2, *p.shape[:-1]), bool)
            for i in range(5):
                for n, s in enumerate((1, -1)):
                    q = np.hypot(p[..., 0] - w[i, 0], p[..., 1] - w[i, 2] - s * h[:, i, None, None])
                    member[i, n] = (q >= low[i]) & (q <= high[i])
            if modes is None:
                return member.any(axis=1).all(axis=0)
            rows = [[member[i, "+-".index(m[i])] for i in range(5)] for m in modes]
            return np.any([np.all(row, axis=0) for row in rows], axis=0)

        area = common_area(centre, radius, inside)
        total += float((area * np.cos(half_turn) * weight).sum() * (b - a) / 2 * np.pi / 2)
    return total


def common_area(centre, radius, inside):
    apart = centre[:, None] - centre[:, :, None]
    distance = np.maximum(np.hypot(apart[..., 0], apart[..., 1]), 1e-300)
    one, other = radius[None, :, None], radius[None, None, :]
    cosine = (distance**2 + one**2 - other**2) / (2 * distance * one)
    meet = np.abs(cosine) < 1
    half = np.arccos(np.clip(cosine, -1, 1))
    base = np.arctan2(apart[..., 1], apart[..., 0])
    cuts = np.concatenate([np.where(meet, base + s * half, 0.0) for s in (1, -1)], axis=2)
    first = np.zeros((*cuts.shape[:2], 1))
    cuts = np.sort(np.concatenate([first, np.mod(cuts, 2 * np.pi), first + 2 * np.pi], axis=2))
    t0, t1 = cuts[..., :-1], cuts[..., 1:]
    # Not the middle: there symmetric machines have their tangencies.
    t = t0 + 0.43712 * (t1 - t0)
    out = np.stack([np.cos(t), np.sin(t)], axis=-1) * radius[:, None, None]
    here = centre[:, :, None]
    side = inside(here + (1 - 1e-10) * out).astype(float) - inside(here + (1 + 1e-10) * out)
    r = radius[None, :, None]
    green = r * r * (t1 - t0) / 2 + r / 2 * (
        here[..., 0] * (np.sin(t1) - np.sin(t0)) - here[..., 1] * (np.cos(t1) - np.cos(t0))
    )
    return (np.where(t1 - t0 > 1e-12, side, 0.0) * green).sum(axis=(1, 2))


@pytest.mark.parametrize("case", CASES[::4], ids=lambda c: c["name"])
def test_the_slices_agree_with_the_stored_volumes(case):
    found = true_volume(of_volume_case(case), case["phi"], case["theta"], modes_of(case), 400)
    assert found == pytest.approx(case["volume"], rel=2e-5)


# --- volumes


@pytest.mark.parametrize("resolution", RESOLUTIONS)
@pytest.mark.parametrize(
    "case", CASES, ids=lambda c: f"{c['name']} {c['phi']:.1f} {(modes_of(c) or ('all',))[0]}"
)
def test_stored_volumes(case, resolution):
    built = workspace(of_volume_case(case), case["phi"], case["theta"], modes_of(case), resolution)
    error = abs(built.volume - case["volume"])
    assert error <= FLOOR[resolution] * case["volume"]
    assert error <= built.volume_error
    # The estimate is worth something: not far above what is promised. The preview's is the
    # cruder, since its second-order term is not small.
    most = 5 if resolution == "preview" else 3
    assert built.volume_error <= most * FLOOR[resolution] * case["volume"]
    if resolution == "normal":
        check(built)


def degenerate(kind: str, rng: np.random.Generator) -> FiveRPURDesign:
    link, low = rng.uniform(0.5, 2.5, 5), rng.uniform(0.0, 3.0, 5)
    high = low + rng.uniform(0.1, 3.0, 5)
    base, platform = rng.uniform(-1, 1, (2, 5, 3))
    scale = 100.0
    if kind not in ("general", "inner circle 0", "short stroke", "long link", "one in another"):
        link[:], low[:], high[:] = 1.5, 2.5, 4.0
    match kind:
        case "all coincide":
            base[:], platform[:] = base[0], platform[0]
        case "two coincide":
            base[1::2], platform[1::2] = base[0], platform[0]
        case "equal heights":
            base[:, 1], platform[:, 1] = 0.2, 0.1
        case "lattice":
            base, platform = np.round(2 * base) / 2, np.round(2 * platform) / 2
        case "H3 just vanishes":
            link[:] = 0.75
            base, platform = np.round(2 * base) / 2, np.round(2 * platform) / 2
        case "inner circle 0":
            low[:] = 0.0
        case "short stroke":
            high = low + 10.0 ** rng.uniform(-3, -1, 5)
        case "long link":
            link = rng.uniform(3, 20, 5)
        case "far apart":
            base, platform = 3 * base, 3 * platform
        case "end walls touch":
            base[:], platform[:] = 0.0, 0.0
            base[1, 1] = rng.choice([3.0, 2.9999999, 1.5, 1e-10])
            base[2, 2] = rng.choice([0.0, 3.0, 1.5, 1e-10])
        case "cylinders touch":
            base[:], platform[:] = 0.0, 0.0
            base[1, 0] = rng.choice([8.0, 6.5, 1.5, 5.0])
        case "one in another":
            low[0] = max(low[0], 0.5)
            high[0] = low[0] + 1.0
            link[1], base[1], platform[1] = link[0], base[0], platform[0]
            low[1], high[1] = 0.5 * low[0], low[0]
        case "tiny":
            scale = 0.1
        case "huge":
            scale = 1e5
    limbs = zip(
        base * scale, platform * scale, link * scale, low * scale, high * scale, strict=True
    )
    return FiveRPURDesign(
        tuple(
            Limb(tuple(r.tolist()), tuple(s.tolist()), float(li), (float(a), float(b)))
            for r, s, li, a, b in limbs
        )
    )


KINDS = (
    "general",
    "all coincide",
    "two coincide",
    "equal heights",
    "lattice",
    "H3 just vanishes",
    "inner circle 0",
    "short stroke",
    "long link",
    "far apart",
    "end walls touch",
    "cylinders touch",
    "one in another",
    "tiny",
    "huge",
)


def sample(kind: str, seed: int):
    rng = np.random.default_rng((KINDS.index(kind), seed))
    design = degenerate(kind, rng)
    angles = [(0.0, 0.0), (np.pi / 2, 0.0), (np.pi / 4, -np.pi / 2), rng.uniform(-3, 3, 2)]
    phi, theta = (float(v) for v in angles[seed % 4])
    choice = rng.random()
    modes = None
    if choice > 0.5:
        modes = tuple(rng.choice(MODES, 1 if choice < 0.9 else 5, replace=False).tolist())
    return design, phi, theta, modes


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", KINDS)
def test_any_machine_within_the_stated_error(kind, seed):
    design, phi, theta, modes = sample(kind, seed)
    built = workspace(design, phi, theta, modes, "preview")
    check(built)
    coarse, true = (true_volume(design, phi, theta, modes, n) for n in (60, 90))
    unsure = 3 * abs(true - coarse) + 1e-6 * true
    assert abs(built.volume - true) <= built.volume_error + unsure


@pytest.mark.parametrize("kind", KINDS)
def test_always_closed(kind):
    for seed in range(100, 114):
        design, phi, theta, modes = sample(kind, seed)
        check(workspace(design, phi, theta, modes, "preview"))


# --- frames and modes


@pytest.mark.parametrize("modes", [None, ("+++++",), ("+-+-+", "--+-+", "-----")])
def test_holds_the_poses_that_inverse_kinematics_reaches(modes):
    phi, theta = -0.3, 0.5
    built = workspace(TABLE_1, phi, theta, modes, "normal")
    low, high = built.mesh.vertices.min(axis=0) - 5, built.mesh.vertices.max(axis=0) + 5
    turned = np.random.default_rng(1).uniform(low, high, (200_000, 3))
    points = turned @ rotation_y(theta).T
    poses = np.concatenate([points, np.tile([phi, theta], (len(points), 1))], axis=1)
    answer = inverse.inverse(TABLE_1, poses)
    wanted = [m in (modes or answer.modes) for m in answer.modes]
    inside = answer.within_stroke[:, wanted].any(axis=1)
    box = float(np.prod(high - low))
    volume = inside.mean() * box
    spread = np.sqrt(inside.mean() * (1 - inside.mean()) / len(points)) * box
    assert built.volume == pytest.approx(volume, abs=4.5 * spread + built.volume_error)
    centroid = sum(p.volume * np.array(p.centroid) for p in built.pieces) / built.volume
    scatter = 4.5 * turned[inside].std(axis=0) / np.sqrt(inside.sum())
    assert (np.abs(turned[inside].mean(axis=0) - centroid) <= scatter + 0.1).all()


def test_all_modes_one_by_one_are_all_modes_together():
    together = workspace(TABLE_1, 0.2, 0.1, None, "preview")
    listed = workspace(TABLE_1, 0.2, 0.1, MODES[::-1], "preview")
    np.testing.assert_array_equal(together.mesh.vertices, listed.mesh.vertices)
    assert together.volume == listed.volume


def test_a_set_of_modes_is_a_union():
    some = ("+++++", "++++-", "-+++-", "--+++")
    built = workspace(TABLE_1, 0.0, 0.0, some, "normal")
    true = true_volume(TABLE_1, 0.0, 0.0, some, 300)
    assert abs(built.volume - true) <= built.volume_error + 1e-5 * true
    assert built.volume > max(workspace(TABLE_1, 0, 0, (m,), "normal").volume for m in some)
    again = workspace(TABLE_1, 0.0, 0.0, frozenset(some), "normal")
    np.testing.assert_array_equal(built.mesh.vertices, again.mesh.vertices)


def test_no_modes_and_no_common_reach_are_empty_solids():
    for built in (
        workspace(TABLE_1, 0.0, 0.0, (), "preview"),
        workspace(degenerate("far apart", np.random.default_rng(3)), 0.0, 0.0, ("+-+-+",)),
        workspace(moved(TABLE_1, 0, (5000.0, 0.0, 0.0)), 0.0, 0.0),
    ):
        assert built.volume == 0.0
        assert built.pieces == ()
        assert built.triangles == 0
        assert built.watertight


def moved(design: FiveRPURDesign, limb: int, by) -> FiveRPURDesign:
    limbs = list(design.limbs)
    one = limbs[limb]
    base = tuple(float(a + b) for a, b in zip(one.base, by, strict=True))
    limbs[limb] = Limb(base, one.platform, one.link, one.stroke)
    return FiveRPURDesign(tuple(limbs))


@settings(max_examples=40)
@given(st.tuples(*[st.floats(-300, 300)] * 3), st.floats(-3, 3))
def test_moving_the_whole_base_moves_the_workspace(by, phi):
    shifted = TABLE_2
    for i in range(5):
        shifted = moved(shifted, i, by)
    here, there = (workspace(d, phi, 0.0, ("+++++",), "preview") for d in (TABLE_2, shifted))
    assert there.volume == pytest.approx(here.volume, rel=1e-4, abs=100.0)
    if here.pieces and there.pieces:
        span = np.array([here.mesh.vertices.min(axis=0), here.mesh.vertices.max(axis=0)])
        other = np.array([there.mesh.vertices.min(axis=0), there.mesh.vertices.max(axis=0)])
        np.testing.assert_allclose(other - by, span, atol=0.5)


def test_the_same_request_gives_the_same_solid():
    first, second = (workspace(TABLE_2, 0.4, -0.2, None, "normal") for _ in range(2))
    np.testing.assert_array_equal(first.mesh.vertices, second.mesh.vertices)
    np.testing.assert_array_equal(first.mesh.faces, second.mesh.faces)
    np.testing.assert_array_equal(first.shaded.vertices, second.shaded.vertices)
    assert first.pieces == second.pieces


def test_offsets_of_many_orientations():
    phi, theta = np.random.default_rng(2).uniform(-3, 3, (2, 4, 1))
    offsets = offset_points(TABLE_1, phi, theta[:, 0])
    assert offsets.shape == (4, 4, 5, 3)
    for a, b, i in product(range(4), range(4), range(5)):
        limb = TABLE_1.limbs[i]
        expected = rotation_y(-theta[b, 0]) @ limb.base - rotation_x(phi[a, 0]) @ limb.platform
        np.testing.assert_allclose(offsets[a, b, i], expected, atol=1e-12)


@pytest.mark.parametrize("part", PARTS)
def test_limb_parts(part):
    built = limb_part(TABLE_1, 3, part, "preview")
    check(built)
    assert built is limb_part(TABLE_1, 1, part, "preview")  # an equal limb
    # The whole is one piece although each half of H3 is a void in it.
    assert len(built.pieces) == {"H1": 2, "H3": 2}.get(part, 1)


@pytest.mark.parametrize(
    ("call", "why"),
    [
        (lambda: workspace(TABLE_1, float("nan"), 0.0), "phi"),
        (lambda: workspace(TABLE_1, 0.0, float("inf")), "theta"),
        (lambda: workspace(TABLE_1, (0.0, 1.0), 0.0), "one number"),
        (lambda: workspace(TABLE_1, 0.0, 0.0, ("+++",)), "five signs|5 signs"),
        (lambda: workspace(TABLE_1, 0.0, 0.0, ("+++*+",)), "signs"),
        (lambda: workspace(TABLE_1, 0.0, 0.0, None, "superb"), "superb"),
        (lambda: limb_part(TABLE_1, 0, "whole"), "limb 0"),
        (lambda: limb_part(TABLE_1, 6, "whole"), "limb 6"),
        (lambda: limb_part(TABLE_1, 1, "H4"), "H4"),
    ],
)
def test_wrong_requests_are_refused_in_one_sentence(call, why):
    with pytest.raises(InputError, match=why) as refused:
        call()
    assert "\n" not in str(refused.value)
