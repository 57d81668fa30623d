"""Exact volumes: references, closed forms, honest errors, symmetries, and other ways to count."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from kinematics.answers.sections import Volume
from kinematics.designs.files import load_design, presets
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur import inverse
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.workspace.workspace import workspace
from kinematics.screws.spatial import rotation_y
from tests.conftest import rarely
from tests.kinematics.mechanisms.five_rpur.machines import (
    of_volume_case,
    preset,
    section,
    section_range,
    volume,
)
from tests.kinematics.references import read

pytestmark = pytest.mark.usefixtures("compiled")

CASES = read("volumes.json")["cases"]
ZERO = (0.0, 0.0, 0.0)
TABLES = ("rpur-table1", "rpur-table1-icee", "rpur-table2")
DESIGNS = [p.name for p in presets() if p.mechanism == "five_rpur"]


def modes_of(case) -> tuple[str, ...] | None:
    signs = case["modes"]
    return None if signs is None else ("".join("+" if s > 0 else "-" for s in signs),)


def alike(link: float, low: float, high: float, base=ZERO) -> FiveRPURDesign:
    """Five limbs at one place: the workspace is one limb's vertex space."""
    limb = Limb(tuple(base), ZERO, link, (low, high))
    return FiveRPURDesign((limb,) * 5)


def moved(design: FiveRPURDesign, base, platform=None) -> FiveRPURDesign:
    """The design with its points (3,) changed by functions."""
    platform = platform or (lambda s: s)
    return FiveRPURDesign(
        tuple(
            Limb(
                tuple(np.asarray(base(np.array(limb.base))).tolist()),
                tuple(np.asarray(platform(np.array(limb.platform))).tolist()),
                limb.link,
                limb.stroke,
            )
            for limb in design.limbs
        )
    )


def check(found: Volume, relative: float) -> None:
    """What holds of every volume."""
    assert found.value >= 0.0
    # To the last digits it is rounding that counts: of the range times the size's square.
    assert 0.0 <= found.error <= max(relative * found.value, 1e-4)
    assert sum(found.pieces) == pytest.approx(found.value, rel=1e-7, abs=1e-12)
    assert list(found.pieces) == sorted(found.pieces)[::-1]
    assert len(found.at) == len(found.area) <= found.sections
    assert (np.diff(found.at) >= 0.0).all()
    assert (np.diff(found.events) > 0.0).all()
    assert np.isfinite(found.centroid).all() == (found.value > 0.0)
    for array in (found.at, found.area, found.events, found.centroid):
        assert not array.flags.writeable


# --- known volumes -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "case", CASES, ids=lambda c: f"{c['name']} {c['phi']:.1f} {(modes_of(c) or ('all',))[0]}"
)
def test_stored_volumes(case):
    for relative in (1e-3, 1e-6, 1e-9):
        found = volume(
            of_volume_case(case), case["phi"], case["theta"], modes_of(case), relative=relative
        )
        check(found, relative)
        assert abs(found.value - case["volume"]) <= found.error + 0.1  # it is told to 0.1 mm³
    assert found.value == pytest.approx(case["volume"], rel=1e-6)


@pytest.mark.parametrize(("link", "low", "high"), [(150, 250, 400), (80, 0, 100), (300, 10, 20)])
def test_half_a_vertex_space_in_closed_form(link, low, high):
    for mode in ("+++++", "-----"):
        found = volume(alike(link, low, high), 0.3, -0.2, (mode,), relative=1e-10)
        check(found, 1e-10)
        true = 2 * link * np.pi * (high**2 - low**2)
        assert abs(found.value - true) <= found.error
        height = np.pi / 4 * link * (1 if mode == "+++++" else -1)
        np.testing.assert_allclose(found.centroid @ rotation_y(-0.2), [0, 0, height], atol=1e-6)


def common(one: float, other: float, apart: float) -> float:
    """The area that two circles have in common."""
    if apart >= one + other:
        return 0.0
    if apart <= abs(one - other):
        return float(np.pi * min(one, other) ** 2)
    x = (apart**2 + one**2 - other**2) / (2 * apart)
    y = np.sqrt(max(one**2 - x**2, 0.0))
    return float(one**2 * np.arctan2(y, x) + other**2 * np.arctan2(y, apart - x) - apart * y)


@pytest.mark.parametrize(("link", "low", "high"), [(150.0, 250.0, 400.0), (200.0, 50.0, 120.0)])
def test_a_whole_vertex_space_from_its_other_slices(link, low, high):
    """At y' = const it is two annuli, 2h apart: the common area of circles in closed form."""

    def area(beta: float) -> float:
        apart = 2 * link * np.sin(beta)
        both = common(high, high, apart) - 2 * common(low, high, apart) + common(low, low, apart)
        return (2 * np.pi * (high**2 - low**2) - both) * link * np.sin(beta)

    kinks = [v / (2 * link) for v in (2 * high, 2 * low, high - low, high + low)]
    stops = [0.0, *sorted(float(np.arcsin(v)) for v in kinks if v < 1), np.pi / 2]
    true = 2 * sum(quad(area, a, b, epsabs=1e-4, epsrel=1e-12)[0] for a, b in pairwise(stops))
    found = volume(alike(link, low, high), 0.0, 0.0, relative=1e-9)
    assert abs(found.value - true) <= found.error + 1e-10 * true
    if link == 150.0:
        assert found.value == pytest.approx(159_552_169.23, abs=0.2)
    assert len(found.pieces) == 1


# --- the error ----------------------------------------------------------------------------------


def random_design(rng: np.random.Generator, kind: int) -> FiveRPURDesign:
    limbs = []
    link, low, step = (float(rng.choice(v)) for v in ((100, 150, 200), (0, 100, 250), (50, 150)))
    for _ in range(5):
        if kind == 0:  # round numbers
            if rng.random() < 0.2:
                link = float(rng.choice((100, 150, 200)))
            base, platform = rng.integers(-3, 4, 3) * 50.0, rng.integers(-1, 2, 3) * 50.0
            limbs.append(
                Limb(tuple(base.tolist()), tuple(platform.tolist()), link, (low, low + step))
            )
        else:
            shortest = rng.uniform(0, 300) if rng.random() < 0.9 else 0.0
            points = (tuple(rng.uniform(-v, v, 3).tolist()) for v in (100, 60))
            stroke = (shortest, shortest + rng.uniform(30, 250))
            limbs.append(Limb(*points, rng.uniform(80, 250), stroke))
    return FiveRPURDesign(tuple(limbs))


def random_case(seed: int):
    rng = np.random.default_rng(seed)
    if seed % 3 == 2:
        design = preset(str(rng.choice(DESIGNS)))
    else:
        design = random_design(rng, seed % 3)
    phi, theta = rng.uniform(-1.5, 1.5, 2)
    if seed % 3 == 0:
        phi, theta = rng.choice((0.0, np.pi / 6, np.pi / 4, -np.pi / 4, np.pi / 2, -np.pi / 3), 2)
    modes = None
    if rng.random() < 0.6:
        modes = tuple(rng.choice(inverse.MODES, rng.integers(1, 5), replace=False).tolist())
    return design, float(phi), float(theta), modes


@pytest.mark.parametrize("block", [0, *map(rarely, (1, 2, 3))])
def test_the_error_is_never_larger_than_told(block):
    seen = 0
    for seed in range(1000 + 15 * block, 1015 + 15 * block):
        case = random_case(seed)
        rough = {relative: volume(*case, relative=relative) for relative in (1e-3, 1e-4, 1e-6)}
        if rough[1e-4].value == 0.0:
            continue
        seen += 1
        fine = volume(*case, relative=1e-8)
        for relative, found in {**rough, 1e-8: fine}.items():
            check(found, relative)
            assert abs(found.value - fine.value) <= found.error + fine.error, (seed, relative)
    assert seen >= 5


def slab_sum(design, phi, theta, modes, cuts, relative) -> tuple[float, float]:
    parts = [
        volume(design, phi, theta, modes, relative=relative, between=pair)
        for pair in pairwise(cuts)
    ]
    return sum(p.value for p in parts), sum(p.error for p in parts)


@pytest.mark.parametrize("seed", [1, 4, 5, 8, 11])
def test_slabs_add_up(seed):
    design, phi, theta, modes = random_case(seed)
    found = section_range(design, phi, theta, modes)
    assert found is not None
    inner = np.random.default_rng(seed).uniform(*found, 6)
    cuts = np.sort([found[0] - 1.0, *found, *inner, found[1] + 1.0]).tolist()
    value, error = slab_sum(design, phi, theta, modes, cuts, 1e-7)
    whole = volume(design, phi, theta, modes, relative=1e-7)
    assert whole.value > 0.0
    assert abs(value - whole.value) <= error + whole.error
    assert volume(design, phi, theta, modes, between=(found[1], found[1] + 9.0)).value == 0.0
    back = volume(design, phi, theta, modes, between=(cuts[4], cuts[2]))
    assert back.value == volume(design, phi, theta, modes, between=(cuts[2], cuts[4])).value


def test_where_a_workspace_is_a_speck_it_is_found():
    """Balls of a millimetre and less, in a range of x' of some hundreds."""
    for reach in (1.0, 1e-2, 1e-4):
        # Two limbs far apart that barely reach each other: a lens of that height.
        far = Limb((0.0, 0.0, 2 * 550.0 - reach), ZERO, 150.0, (250.0, 400.0))
        near = Limb(ZERO, ZERO, 150.0, (250.0, 400.0))
        design = FiveRPURDesign((near, far, near, far, near))
        found = volume(design, 0.0, 0.0, relative=1e-6)
        check(found, 1e-6)
        # The lens between two caps: curvatures 1/400 along x', and 1/150 along y'.
        true = np.pi / 2 * reach**2 * np.sqrt(400.0 * 150.0)
        assert abs(found.value - true) <= found.error + 2e-3 * reach * true
        assert found.error < 1e-3 * true or reach < 1e-3
        middle = [0.0, 0.0, 550.0 - reach / 2]
        assert inverse.inside(design, [*middle, 0.0, 0.0])
        np.testing.assert_allclose(found.centroid, middle, atol=1e-3)
        assert np.ptp(found.at[found.area > 0]) < 2 * np.sqrt(400.0 * reach) + 1e-3


def test_nothing_is_known_to_be_nothing():
    apart = FiveRPURDesign(
        tuple(Limb((900.0 * n, 0.0, 0.0), ZERO, 150.0, (250.0, 400.0)) for n in range(5))
    )
    narrowly = FiveRPURDesign(
        tuple(Limb((0.0, 0.0, 1100.001 * (n % 2)), ZERO, 150.0, (250.0, 400.0)) for n in range(5))
    )
    for design, modes in ((apart, None), (narrowly, None), (preset("rpur-table1"), ())):
        found = volume(design, 0.0, 0.0, modes)
        check(found, 1e-6)
        assert found.value == 0.0
        assert found.pieces == ()
        assert found.error < 1e-4


# --- modes ---------------------------------------------------------------------------------------


def test_thirty_two_modes_are_all_modes():
    design = preset("rpur-table1")
    whole = volume(design, 0.2, 0.1)
    listed = volume(design, 0.2, 0.1, inverse.MODES[::-1])
    assert (listed.value, listed.error) == (whole.value, whole.error)
    assert listed.pieces == whole.pieces


def test_more_modes_more_volume_and_unions_no_more_than_sums():
    design, angles = preset("rpur-table2"), (0.1, -0.3)
    order = np.random.default_rng(2).permutation(inverse.MODES).tolist()
    single = {m: volume(design, *angles, (m,), relative=1e-5) for m in order}
    last = 0.0
    for count in (1, 2, 5, 12, 25, 32):
        found = volume(design, *angles, order[:count], relative=1e-5)
        assert last <= found.value + found.error
        parts = [single[m] for m in order[:count]]
        most = sum(p.value + p.error for p in parts)
        assert max(p.value - p.error for p in parts) <= found.value + found.error
        assert found.value - found.error <= most
        last = found.value - found.error
    # What two modes share is what is missing in the union.
    one, two = "+++++", "-++++"
    both = volume(design, *angles, (one, two), relative=1e-7).value
    assert 0.0 < single[one].value + single[two].value - both < single[two].value


def test_modes_that_have_a_workspace():
    """27 of 32 at φ = θ = 0 of Table 1. A grid of 40³ shows 26: the thinnest is 10.8 mm³."""
    design = preset("rpur-table1")
    found = {m: volume(design, 0.0, 0.0, (m,)) for m in inverse.MODES}
    there = {m for m, v in found.items() if v.value > 0.0}
    assert len(there) == 27
    smallest = min(there, key=lambda m: found[m].value)
    assert smallest == "+++--"
    assert found[smallest].value == pytest.approx(10.7698, abs=1e-3)
    s = section(design, 0.0, 0.0, float(found[smallest].centroid[0]), (smallest,))
    point = [s.at, *s.centroid, 0.0, 0.0]
    assert inverse.inside(design, point, (smallest,))
    for mode in set(inverse.MODES) - there:
        # Not one of a million points, nor any volume that might hide between sections.
        assert found[mode].error < 1e-6
    low, high = np.array([-300.0, 55.0, -560.0]), np.array([395.0, 100.0, 560.0])
    points = np.random.default_rng(1).uniform(low, high, (200_000, 3))
    within = inverse.inverse(design, np.pad(points, ((0, 0), (0, 2)))).within_stroke
    seen = {m for m, hit in zip(inverse.MODES, within.any(axis=0), strict=True) if hit}
    assert seen <= there


# --- motions and mirrors -------------------------------------------------------------------------

SWAP = str.maketrans("+-", "-+")
TURN, SHIFT = rotation_y(0.7), np.array([10.0, -20.0, 33.0])
FLIP_X, FLIP_Y, FLIP_Z = (np.array(v, dtype=float) for v in ((-1, 1, 1), (1, -1, 1), (1, 1, -1)))
MOTIONS = {
    # points of the base, of the platform; φ, θ; modes; how the centroid follows
    "translated": (
        lambda r: r + SHIFT,
        None,
        (1, 0),
        (1, 0),
        False,
        lambda c: c + SHIFT,
    ),
    "turned about y": (lambda r: TURN @ r, None, (1, 0), (1, 0.7), False, lambda c: TURN @ c),
    # Mirrors turn the axes of rotation around that lie in the mirror: R_x and R_y act as before
    # with the angle's sign changed, unless the mirror's normal is their axis. Link i leans along
    # z', so that only the mirror z → −z exchanges the signs of the modes.
    "mirrored in y": (lambda r: r * FLIP_Y, FLIP_Y, (-1, 0), (1, 0), False, lambda c: c * FLIP_Y),
    "mirrored in x": (lambda r: r * FLIP_X, FLIP_X, (1, 0), (-1, 0), False, lambda c: c * FLIP_X),
    "mirrored in z": (lambda r: r * FLIP_Z, FLIP_Z, (-1, 0), (-1, 0), True, lambda c: c * FLIP_Z),
}


@pytest.mark.parametrize("modes", [None, ("+-+++", "--+-+")])
@pytest.mark.parametrize("motion", MOTIONS)
def test_the_machine_is_moved_or_mirrored(motion, modes):
    base, flip, (a, b), (c, d), swaps, follow = MOTIONS[motion]
    design, phi, theta = preset("rpur-table1"), 0.3, -0.4
    here = volume(design, phi, theta, modes, relative=1e-7)
    other = moved(design, base, None if flip is None else (lambda s: s * flip))
    if swaps and modes is not None:
        modes = tuple(m.translate(SWAP) for m in modes)
    there = volume(other, a * phi + b, c * theta + d, modes, relative=1e-7)
    assert abs(here.value - there.value) <= here.error + there.error
    np.testing.assert_allclose(there.centroid, follow(here.centroid), atol=1e-4)
    np.testing.assert_allclose(there.pieces, here.pieces, rtol=1e-4, atol=1.0)


def test_symmetric_designs_have_symmetric_maps():
    """Even in φ where y → −y exchanges limbs in pairs, even in θ where x → −x does."""
    rng = np.random.default_rng(4)
    for flip, change in ((FLIP_Y, (-1, 1)), (FLIP_X, (1, -1))):
        limbs = []
        for _ in range(2):
            base, platform = rng.uniform(20, 80, (2, 3))
            for sign in (np.ones(3), flip):
                points = (tuple((p * sign).tolist()) for p in (base, platform))
                limbs.append(Limb(*points, 150.0, (200.0, 380.0)))
        middle = np.array([30.0, 30.0, 10.0]) * (flip > 0)
        limbs.append(Limb(tuple(middle.tolist()), ZERO, 160.0, (250.0, 400.0)))
        design = FiveRPURDesign(tuple(limbs))
        # Exchanged limbs exchange their signs in a mode: "+-..." becomes "-+...".
        for modes, mirrored in ((None, None), (("+-+++",), ("-++++",))):
            for phi, theta in ((0.4, 0.2), (-0.1, 0.7)):
                one = volume(design, phi, theta, modes)
                two = volume(design, change[0] * phi, change[1] * theta, mirrored)
                assert one.value > 0.0
                assert abs(one.value - two.value) <= one.error + two.error
        different = volume(design, 0.4, 0.2).value - volume(design, 0.1, -0.5).value
        assert abs(different) > 1.0


# --- other ways to count -------------------------------------------------------------------------


@pytest.mark.parametrize("modes", [None, ("+++++", "+-+-+", "--+-+")])
def test_by_dice(modes):
    design, phi, theta = preset("rpur-table1"), -0.3, 0.5
    found = volume(design, phi, theta, modes)
    x = section_range(design, phi, theta, modes)
    assert x is not None
    cuts = [section(design, phi, theta, at, modes) for at in np.linspace(*x, 60)]
    ends = np.concatenate([s.polyline(n, 5.0) for s in cuts for n in range(s.loops)])
    low = np.array([x[0], *(ends.min(axis=0) - 10.0)])
    high = np.array([x[1], *(ends.max(axis=0) + 10.0)])
    turned = np.random.default_rng(3).uniform(low, high, (300_000, 3))
    points = turned @ rotation_y(theta).T
    poses = np.concatenate([points, np.tile([phi, theta], (len(points), 1))], axis=1)
    inside = inverse.inside(design, poses, modes)
    box, share = float(np.prod(high - low)), inside.mean()
    spread = box * np.sqrt(share * (1 - share) / len(points))
    assert abs(found.value - share * box) <= 4.5 * spread
    scatter = 4.5 * points[inside].std(axis=0) / np.sqrt(inside.sum())
    assert (np.abs(points[inside].mean(axis=0) - found.centroid) <= scatter).all()


@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.3, -0.4)])
@pytest.mark.parametrize("name", DESIGNS)
def test_agrees_with_the_solid(name, angles):
    design = preset(name)
    built = workspace(design, *angles, None, "preview")
    found = volume(design, *angles)
    check(found, 1e-6)
    assert abs(found.value - built.volume) <= built.volume_error + found.error
    if not built.pieces:
        return
    # A solid of chords may have lost what is thin, or parted it.
    least = max(built.volume_error, 1e-3 * found.value)
    large = [v for v in found.pieces if v > least]
    assert len(large) == len([p for p in built.pieces if p.volume > least])
    for ours, theirs in zip(large, built.pieces, strict=False):
        assert ours == pytest.approx(theirs.volume, abs=built.volume_error)
    centroid = sum(p.volume * np.array(p.centroid) for p in built.pieces) / built.volume
    np.testing.assert_allclose(rotation_y(-angles[1]) @ found.centroid, centroid, atol=2.0)


def test_the_sections_told_are_sections():
    design = preset("rpur-table2")
    found = volume(design, 0.1, 0.2, relative=1e-4)
    for n in range(0, len(found.at), 97):
        assert section(design, 0.1, 0.2, float(found.at[n])).area == pytest.approx(
            found.area[n], rel=1e-9, abs=1e-6
        )
    assert np.trapezoid(found.area, found.at) == pytest.approx(found.value, rel=1e-2)


def test_fewer_digits_take_fewer_sections():
    design = preset("rpur-table1")
    counts = [volume(design, 0.1, 0.2, relative=10.0**-n).sections for n in (2, 4, 6, 8)]
    assert counts == sorted(counts)
    assert counts[1] < 300
    assert counts[2] < 1000


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"phi": np.nan}, "phi"),
        ({"theta": np.inf}, "theta"),
        ({"modes": ["+-++"]}, "5 signs"),
        ({"relative": 0.0}, "relative"),
        ({"relative": 2.0}, "relative"),
        ({"relative": np.nan}, "relative"),
        ({"between": (0.0, np.nan)}, "between"),
    ],
)
def test_bad_input_is_told_in_a_sentence(arguments, named):
    with pytest.raises(InputError, match=named) as told:
        volume(preset("rpur-table1"), **{"phi": 0.0, "theta": 0.0, **arguments})
    assert "\n" not in str(told.value)


def test_a_volume_without_its_structure_is_the_same_volume() -> None:
    design = load_design("rpur-table1")
    whole = volume(design, 0.1, -0.2, relative=1e-4)
    alone = volume(design, 0.1, -0.2, relative=1e-4, pieces=False)
    assert (alone.value, alone.error) == (whole.value, whole.error)
    assert (alone.centroid == whole.centroid).all()
    assert whole.pieces
    assert len(whole.events)
    assert alone.pieces == ()
    assert not len(alone.events)
