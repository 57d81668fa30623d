"""Maps over (φ, θ): every quantity is what its own function gives."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb
from kinematics.mechanisms.five_rpur.inscribed.largest import sphere
from kinematics.mechanisms.five_rpur.maps import SPEC
from tests.kinematics.mechanisms.five_rpur.machines import map_cells, volume

pytestmark = pytest.mark.usefixtures("compiled")

KEYS = tuple(quantity.key for quantity in SPEC.quantities)


def poses(angles):
    result = np.zeros((len(angles), 5))
    result[:, 3:] = angles
    return result


def test_every_quantity_is_that_of_its_own_function():
    design = load_design("rpur-table1")
    angles = [(0.0, 0.0), (0.4, -0.3)]
    cells = map_cells(design, poses(angles), ("+-+-+",), KEYS, relative=1e-6)
    for n, (phi, theta) in enumerate(angles):
        exact = volume(design, phi, theta, ("+-+-+",))
        ball = sphere(design, phi, theta, ("+-+-+",))
        value = dict(zip(KEYS, cells.values[n], strict=True))
        error = dict(zip(KEYS, cells.errors[n], strict=True))
        assert abs(value["volume"] - exact.value) <= error["volume"] + exact.error
        assert value["pieces"] == len(exact.pieces)
        assert value["largest_piece"] == pytest.approx(exact.pieces[0], rel=1e-5)
        assert value["sphere"] == pytest.approx(ball.radius)
        assert 0.0 < value["stroke"] <= 100.0


def test_pieces_as_exact_as_the_volume_are_told_so():
    """Coarse cells count what finer ones do, but for pieces that their error might hide."""
    rng = np.random.default_rng(3)
    design = load_design("rpur-table1")
    angles = rng.uniform(-1.2, 1.2, (12, 2))
    keys = ("volume", "pieces", "largest_piece")
    coarse = map_cells(design, poses(angles), None, keys, relative=1e-3)
    fine = map_cells(design, poses(angles), None, keys, relative=1e-7)
    assert (fine.values[:, 0] > 0.0).sum() > 6
    assert (fine.errors[:, 1] == 0.0).sum() > 6
    for k, (phi, theta) in enumerate(angles.tolist()):
        hidden = [p for p in volume(design, phi, theta).pieces if p <= coarse.errors[k, 0]]
        off = abs(coarse.values[k, 1] - fine.values[k, 1])
        assert off <= coarse.errors[k, 1] + fine.errors[k, 1] + len(hidden)
        off = abs(coarse.values[k, 2] - fine.values[k, 2])
        assert off <= coarse.errors[k, 2] + fine.errors[k, 2]


def test_quantities_come_in_the_order_asked_for():
    design = load_design("rpur-table2")
    one = map_cells(design, poses([(0.1, 0.2)]), None, ("pieces", "volume"))
    two = map_cells(design, poses([(0.1, 0.2)]), None, ("volume", "pieces"))
    assert one.values[0].tolist() == two.values[0, ::-1].tolist()


def test_the_stroke_used_is_what_inverse_kinematics_needs():
    # The share of the limb that uses least, from many points inside by inverse kinematics.
    from kinematics.mechanisms.five_rpur.inverse import inside, limb_lengths

    design, mode = load_design("rpur-table1"), "-----"
    cells = map_cells(design, poses([(0.5, 0.4)]), (mode,), ("stroke",))
    told, error = cells.values[0, 0], cells.errors[0, 0]
    rng = np.random.default_rng(1)
    found = volume(design, 0.5, 0.4, (mode,))
    points = found.centroid + rng.uniform(-350.0, 350.0, (200_000, 3))
    tried = np.concatenate([points, np.broadcast_to([0.5, 0.4], (len(points), 2))], axis=1)
    held = tried[inside(design, tried, (mode,))]
    assert len(held) > 500
    used = limb_lengths(design, held)[:, :, 1]
    span = design.stroke[:, 1] - design.stroke[:, 0]
    seen = 100.0 * ((used.max(axis=0) - used.min(axis=0)) / span).min()
    assert seen <= told + error
    assert seen >= told - 6.0  # random points miss the corners


def test_a_symmetric_design_gives_a_symmetric_map():
    # Mirrored at the x'z' plane: limb for limb the same machine, so φ and −φ are alike.
    spots = ((80.0, 60.0), (-90.0, 45.0))
    limbs = [
        Limb((x, side * y, 10.0), (0.3 * x, side * 0.4 * y, -20.0), 150.0, (250.0, 400.0))
        for x, y in spots
        for side in (1.0, -1.0)
    ]
    limbs.append(Limb((20.0, 0.0, -10.0), (5.0, 0.0, 0.0), 150.0, (250.0, 400.0)))
    design = FiveRPURDesign(tuple(limbs))
    angles = [(0.3, 0.1), (-0.3, 0.1), (0.7, -0.4), (-0.7, -0.4)]
    values = map_cells(design, poses(angles), None, ("volume", "pieces"), relative=1e-7).values
    assert values[0::2] == pytest.approx(values[1::2], rel=1e-6)
    assert values[:, 0].min() > 1e5


def test_an_empty_workspace_is_an_answer():
    far = tuple(Limb((2000.0 * i, 0.0, 0.0), (0.0,) * 3, 100.0, (50.0, 60.0)) for i in range(5))
    cells = map_cells(FiveRPURDesign(far), poses([(0.0, 0.0)]), None, KEYS)
    assert (cells.values == 0.0).all()


def test_what_a_map_does_not_show_is_told():
    with pytest.raises(InputError, match=r"volume, pieces.*not 'area'"):
        map_cells(load_design("rpur-table1"), poses([(0.0, 0.0)]), None, ("area",))


@pytest.mark.parametrize(
    ("where", "told"),
    [
        ([[0, 0, 0, np.nan, 0]], "finite"),
        ([[0.0, 0.0, 0.1, 0.2]] * 5, "5 numbers"),
        ("here", "poses"),
    ],
)
def test_poses_that_are_none_are_told(where, told):
    with pytest.raises(InputError, match=told):
        map_cells(load_design("rpur-table1"), where, None, ("volume",))


def test_only_the_orientation_matters():
    design = load_design("rpur-table1")
    here = map_cells(design, [[0.0, 0.0, 0.0, 0.3, -0.4]], None, ("volume", "stroke"))
    there = map_cells(design, [[900.0, -50.0, 1e4, 0.3, -0.4]], None, ("volume", "stroke"))
    assert here.values.tolist() == there.values.tolist()
    assert map_cells(design, np.empty((0, 5)), None, KEYS).values.shape == (0, len(KEYS))
    assert not here.values.flags.writeable
