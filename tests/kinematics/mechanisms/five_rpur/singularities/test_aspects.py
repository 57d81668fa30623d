"""Aspects as solids: closed, of one sign each, together the workspace, between true zeros."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from kinematics.errors import ComputationError, InputError
from kinematics.facets.solids import build_solid
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class
from kinematics.mechanisms.five_rpur.inverse import MODES, limb_lengths
from kinematics.mechanisms.five_rpur.offsets import merged_limbs
from kinematics.mechanisms.five_rpur.singularities.aspects import aspects
from kinematics.mechanisms.five_rpur.singularities.columns import ModeColumns
from kinematics.mechanisms.five_rpur.singularities.determinant import Determinant
from kinematics.mechanisms.five_rpur.workspace.workspace import coarseness, workspace
from kinematics.solids.column_solids import layout
from kinematics.solids.csg import Solid
from kinematics.solids.refining import Fineness
from tests.kinematics.mechanisms.five_rpur.machines import preset
from tests.kinematics.mechanisms.five_rpur.singularities.cases import (
    always_singular,
    held,
    moved_base,
    other_reference,
    poses,
    random_case,
    turned,
)

MACHINE = mechanism_class("five_rpur")


def samples(built, rng, count):
    """Points in the pieces' boxes, and the piece that holds each; −1 for none."""
    points = np.concatenate([rng.uniform(*p.bounds, (count, 3)) for p in built.pieces[:4]])
    return points, np.array([-1 if (k := built.piece_at(p)) is None else k for p in points])


@settings(max_examples=12)
@given(st.integers(0, 10**6))
def test_pieces_are_closed_have_one_sign_and_add_up(seed: int) -> None:
    design, phi, theta, mode = random_case(seed)
    built = aspects(design, phi, theta, mode, "preview")
    whole = workspace(design, phi, theta, (mode,), "preview")
    assert built.watertight
    assert built.volume == pytest.approx(whole.volume, rel=3e-5)
    assert sum(p.volume for p in built.pieces) == pytest.approx(built.volume, rel=1e-12)
    if not built.pieces:
        return
    for n, piece in enumerate(built.pieces):
        mesh = built.piece_mesh(n)
        assert Solid.from_mesh(mesh.vertices, mesh.faces).volume == pytest.approx(piece.volume)
    determinant = Determinant.at(design, phi, theta, mode)
    points, owner = samples(built, np.random.default_rng(seed), 40)
    signs = np.array([p.sign for p in built.pieces])
    value, gradient = determinant.value_and_gradient(points)
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.abs(value) / np.linalg.norm(gradient, axis=1)
    # Chords of the singular surface may sag by a part of a cell.
    sure = (owner >= 0) & (away > 3.0 * coarseness(design, "preview"))
    assert (np.sign(value[sure]) == signs[owner[sure]]).all()


@pytest.mark.parametrize(
    ("mode", "phi", "theta"), [("+++++", 0.2, 0.1), ("-----", 0.3, -0.4), ("+++++", 0.0, 0.0)]
)
def test_the_parts_of_table_1_are_found_again_by_inverse_kinematics(
    mode: str, phi: float, theta: float
) -> None:
    design = preset("rpur-table1")
    built = aspects(design, phi, theta, mode)
    whole = workspace(design, phi, theta, (mode,))
    assert built.volume == pytest.approx(whole.volume, rel=1e-7)
    determinant = Determinant.at(design, phi, theta, mode)
    rng = np.random.default_rng(5)
    low, high = (np.array([p.bounds[k] for p in built.pieces]) for k in (0, 1))
    low, high = low.min(axis=0), high.max(axis=0)
    points = rng.uniform(low, high, (100_000, 3))
    inside = held(design, phi, theta, mode, points)
    positive = determinant.value(points) > 0.0
    box = float(np.prod(high - low))
    for sign, there in ((1, positive), (-1, ~positive)):
        share = (inside & there).mean()
        error = 4.0 * np.sqrt(share * (1.0 - share) / len(points)) * box
        own = [p for p in built.pieces if p.sign == sign]
        error += sum(p.volume_error for p in own)
        assert sum(p.volume for p in own) == pytest.approx(share * box, abs=error)
    fine = aspects(design, phi, theta, mode, "fine")
    for piece, finer in zip(built.pieces, fine.pieces, strict=True):
        assert piece.sign == finer.sign
        error = piece.volume_error + finer.volume_error
        assert piece.volume == pytest.approx(finer.volume, abs=error)
        assert error < 0.02 * piece.volume


@pytest.mark.parametrize("resolution", ["normal", "fine"])
def test_pieces_that_all_but_touch_along_an_edge_are_two(resolution: str) -> None:
    """Of ρ₁ = ρ₂ = 250, where the determinant has the other sign over 3 mm."""
    phi, theta, mode = np.radians(20.0), np.radians(-35.0), "+-+-+"
    design = preset("rpur-table2")
    built = aspects(design, phi, theta, mode, resolution)
    positive = [p for p in built.pieces if p.sign == 1]
    wanted = [1_696_163.0, 337_690.0, 53_586.0, 3_713.0]
    assert len(positive) == len(wanted)
    for piece, right in zip(positive, wanted, strict=True):
        assert piece.volume == pytest.approx(right, abs=piece.volume_error, rel=0.0)
        assert piece.volume == pytest.approx(right, rel=0.03)
    whole = workspace(design, phi, theta, (mode,), resolution)
    assert built.volume == pytest.approx(whole.volume, abs=built.volume_error + whole.volume_error)
    assert built.watertight


@pytest.mark.slow
def test_a_neck_of_a_millimetre_is_none() -> None:
    """Two pieces come to 1.7 mm from each other: no way through on a raster of 0.03 mm."""
    design, phi, theta, mode = preset("rpur-table2"), np.radians(11.3), np.radians(28.2), "++++-"
    built = aspects(design, phi, theta, mode)
    middle = np.array([215.816, 147.672, -161.427])
    step = np.linspace(-1.0, 1.0, 64)
    nodes = middle + np.stack(np.meshgrid(step, step, step, indexing="ij"), axis=-1)
    points = nodes.reshape(-1, 3)
    positive = Determinant.at(design, phi, theta, mode).value(points) > 0.0
    inside = held(design, phi, theta, mode, points) & positive
    parts, count = label(inside.reshape(nodes.shape[:3]), np.ones((3, 3, 3)))
    places = [nodes[parts == n].mean(axis=0) for n in range(1, count + 1)]
    assert len(places) == 2
    owners = {built.piece_at(place) for place in places}
    assert len(owners) == 2
    assert len({p.sign for p in built.pieces}) == 2


@pytest.mark.slow
def test_pieces_that_normal_cells_lose_are_those_of_fine_ones() -> None:
    """The three small ones, of which Booleans of normal cells join or lose some."""
    design = preset("rpur-table1")
    built = aspects(design, 0.0, 0.0, "+-+-+")
    fine = aspects(design, 0.0, 0.0, "+-+-+", "fine")
    assert not built.note
    assert [p.sign for p in built.pieces] == [-1, -1, 1, 1, 1, 1]
    for one, other in zip(built.pieces, fine.pieces, strict=True):
        assert one.sign == other.sign
        assert one.volume == pytest.approx(other.volume, abs=one.volume_error + other.volume_error)


def test_layers_far_above_each_other_are_two_pieces() -> None:
    """Between two columns next to each other one ends and the other begins, 430 mm above."""
    design, phi, theta = preset("rpur-mpa1", merged=True), -0.4033562, -0.3819117
    determinant = Determinant.at(design, phi, theta, "-----")
    columns = ModeColumns(determinant, merged_limbs(design, phi, theta, 1e-6))
    pieces, settled = layout(columns, Fineness((16, 16), 5e-3, 2000))
    assert settled
    assert [sign for sign, _ in pieces] == [1, 1]


@pytest.mark.parametrize("aside", [0.0, 140.0])
def test_what_limbs_change_over_a_cell_is_bounded(aside: float) -> None:
    """Also where y′ passes w′_y in a cell, where a limb's circle stands highest.

    With a limb far aside that is next to the end of the span, and the far end of the cell is near.
    """
    design, rng = preset("rpur-table1"), np.random.default_rng(4)
    x, y, z = design.limbs[4].base
    away = replace(design.limbs[4], base=(x, y + aside, z))
    design = replace(design, limbs=(*design.limbs[:4], away))
    determinant = Determinant.at(design, 0.2, 0.3, "+-+-+")
    columns = ModeColumns(determinant, merged_limbs(design, 0.2, 0.3, 1e-6))
    (_, turn), (low, high) = columns.base
    middle = np.column_stack([rng.uniform(0.0, turn, 500), rng.uniform(low, high, 500)])
    middle[:100, 0] *= 0.2
    half = np.array([0.2, 10.0]) * rng.uniform(0.0, 1.0, (500, 2)) * rng.integers(0, 2, (500, 2))
    half[:100, 0] = middle[:100, 0]
    bound = columns.spread(middle, half)
    p, shift = columns.limbs(middle)
    most = np.zeros_like(bound)
    for t in np.linspace(-1.0, 1.0, 81):
        for along in (-1.0, 1.0):
            at = middle + half * [t, along]
            at[:, 0] = np.clip(at[:, 0], 0.0, np.pi)
            there, moved = columns.limbs(at)
            most = np.maximum(most, np.hypot(there - p, moved - shift))
    assert (most <= bound + 1e-9).all()
    assert (bound <= 1.02 * most + 1e-9).all()  # for it is exact


def test_vertices_of_the_locus_are_zeros() -> None:
    design, phi, theta, mode = preset("rpur-table1"), 0.2, 0.1, "+++++"
    built = aspects(design, phi, theta, mode)
    surface = built.locus_mesh()
    value, gradient = Determinant.at(design, phi, theta, mode).value_and_gradient(surface.vertices)
    residual = np.abs(value) / np.linalg.norm(gradient, axis=1)
    assert built.locus_residual < 1e-9
    assert (residual > 1e-9).sum() <= built.locus_unplaced < 0.05 * len(residual)
    assert residual.max() < 2.0 * coarseness(design, "normal")
    # One side of the surface is like the other.
    signs = np.array([p.sign for p in built.pieces])[built.piece_of]
    twice = np.linalg.norm(
        np.cross(
            *(
                built.mesh.vertices[built.mesh.faces[:, k]]
                - built.mesh.vertices[built.mesh.faces[:, 0]]
                for k in (1, 2)
            )
        ),
        axis=1,
    )
    above, below = (twice[built.on_locus & (signs == s)].sum() for s in (1, -1))
    assert above == pytest.approx(below, rel=1e-6)


@pytest.mark.slow
def test_as_many_modes_are_parted_as_on_a_grid() -> None:
    """On a grid of 40³ nodes: 26 of 32 modes of Table 1 are not empty, in 14 the sign changes."""
    for name, filled, parted in (("rpur-table1", 26, 14), ("rpur-table2", 32, 16)):
        design = preset(name)
        w, reach = Determinant.at(design, 0.0, 0.0, MODES[0]).offset, design.stroke[:, 1]
        outer = np.stack([reach, design.link, reach + design.link], axis=-1)
        axes = np.linspace((w - outer).max(axis=0), (w + outer).min(axis=0), 40).T
        nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        lengths = limb_lengths(design, poses(design, 0.0, 0.0, nodes))
        within = (lengths >= design.stroke[:, :1]) & (lengths <= design.stroke[:, 1:])
        signs = {}
        for mode in MODES:
            pick = [int(sign == "-") for sign in mode]
            inside = nodes[within[:, range(5), pick].all(axis=1)]
            if len(inside):
                determinant = Determinant.at(design, 0.0, 0.0, mode)
                value, noise = determinant.value(inside), determinant.roundoff(inside)
                signs[mode] = set(np.sign(value[np.abs(value) > noise]))
        changed = {mode for mode, found in signs.items() if len(found) == 2}
        assert (len(signs), len(changed)) == (filled, parted)
        for mode in sorted(changed)[:3]:
            assert {p.sign for p in aspects(design, 0.0, 0.0, mode).pieces} == {1, -1}


def test_no_singularity_inside_leaves_the_workspaces_own_pieces() -> None:
    design = preset("rpur-mpa1")
    built = aspects(design, 0.0, 0.0, "+++++", "preview")
    whole = workspace(design, 0.0, 0.0, ("+++++",), "preview")
    assert [p.volume for p in built.pieces] == pytest.approx([p.volume for p in whole.pieces])
    assert {p.sign for p in built.pieces} in ({1}, {-1})
    assert not built.on_locus.any()
    assert built.locus_residual == 0.0


def test_neither_the_base_frame_nor_the_reference_point_counts() -> None:
    design, phi, theta, mode = preset("rpur-table1"), 0.3, -0.4, "-----"

    def pieces(machine, theta):
        built = aspects(machine, phi, theta, mode, "normal")
        return [(p.sign, p.volume) for p in built.pieces], [p.centroid for p in built.pieces]

    want, middle = pieces(design, theta)
    found, _ = pieces(moved_base(design, 0.7, np.array([30.0, 20.0, -50.0])), theta + 0.7)
    assert [s for s, _ in found] == [s for s, _ in want]
    assert [v for _, v in found] == pytest.approx([v for _, v in want], rel=1e-3)
    shift = np.array([25.0, -15.0, 40.0])
    found, there = pieces(other_reference(design, shift), theta)
    assert [s for s, _ in found] == [s for s, _ in want]
    assert [v for _, v in found] == pytest.approx([v for _, v in want], rel=1e-3)
    step = turned(phi, 0.0) @ shift
    assert np.array(there) - middle == pytest.approx(np.tile(step, (len(there), 1)), abs=0.2)


def test_a_machine_that_is_always_singular_is_told() -> None:
    design = always_singular(preset("rpur-table1"))
    with pytest.raises(ComputationError, match="every pose at this orientation in mode"):
        aspects(design, 0.0, 0.0, "+++++", "preview")


def test_limbs_that_share_points_in_other_modes() -> None:
    design = always_singular(preset("rpur-table1"))
    built = aspects(design, 0.1, 0.0, "+-+++", "preview")
    whole = workspace(design, 0.1, 0.0, ("+-+++",), "preview")
    assert built.watertight
    assert built.volume == pytest.approx(whole.volume, rel=3e-5)


def test_an_empty_workspace_has_no_pieces() -> None:
    built = aspects(preset("rpur-table1"), 0.0, 0.0, "++--+", "preview")
    assert built.pieces == ()
    assert built.volume == 0.0
    assert built.piece_at((0.0, 0.0, 0.0)) is None


def test_behind_the_shared_interface() -> None:
    design = preset("rpur-table1")
    pose = [50.0, 100.0, 300.0, 0.2, 0.1]
    spec = next(s for s in machine_of(design).solid_specs if s.key == "aspects")
    assert spec.of_present_mode
    request = machine_of(design).solids.request("aspects", pose, ("+++++",), "preview")
    elsewhere = [0.0, 0.0, 0.0, 0.2, 0.1]
    assert request == machine_of(design).solids.request("aspects", elsewhere, ("+++++",), "preview")
    built = build_solid(request)
    assert len(built.pieces) == 4
    placement = machine_of(design).solids.placement("aspects", pose)
    assert placement[:3, 3].tolist() == [0.0, 0.0, 0.0]
    with pytest.raises(InputError, match="one working mode"):
        machine_of(design).solids.request("aspects", pose, None, "preview")
    with pytest.raises(InputError):
        aspects(design, 0.0, 0.0, "++", "preview")
