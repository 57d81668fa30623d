"""What limbs share is found once while they keep their distance, and changes no solid."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.designs.files import load_design
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.mechanisms.five_rpur.workspace import booleans
from kinematics.mechanisms.five_rpur.workspace.workspace import workspace
from kinematics.solids.csg import Solid

DESIGNS = ("rpur-table1", "rpur-table2", "rpur-a1a1", "rpur-mpa1")


@pytest.mark.parametrize("name", DESIGNS)
def test_limbs_that_ride_together_keep_their_distance(name: str) -> None:
    design = load_design(name)
    together = np.array(booleans.riders(design))
    angles = np.linspace(-1.0, 1.0, 9)
    offsets = [offset_points(design, *pair) for pair in ((angles, 0.3), (0.2, angles))]
    keep = [
        np.ptp(w[:, :, None] - w[:, None, :], axis=0).max(axis=-1) < 1e-9 for w in offsets
    ]  # while φ turns, and while θ does
    for one, other in zip(*np.nonzero(together[:, None] == together), strict=True):
        assert keep[0][one, other] or keep[1][one, other]
    alone = np.array([np.count_nonzero(together == n) == 1 for n in together])
    assert not (keep[0] & alone & ~np.eye(5, dtype=bool)).any()
    assert len(set(together.tolist())) < 5


@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.parametrize("modes", [None, ("++++-",)])
def test_a_solid_does_not_depend_on_those_before(name: str, modes: tuple[str, ...] | None) -> None:
    design = load_design(name)
    booleans._kept.cache_clear()
    alone = workspace(design, 0.2, 0.1, modes, "preview")
    booleans._kept.cache_clear()
    for phi in np.linspace(-0.3, 0.19, 12):
        workspace(design, float(phi), 0.1, modes, "preview")
    after = workspace(design, 0.2, 0.1, modes, "preview")
    np.testing.assert_array_equal(alone.mesh.vertices, after.mesh.vertices)
    np.testing.assert_array_equal(alone.mesh.faces, after.mesh.faces)


@pytest.mark.parametrize(("name", "most"), [("rpur-table1", 3), ("rpur-table2", 2)])
def test_a_drag_of_phi_takes_fewer_booleans(
    name: str, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    design, counts, intersection = load_design(name), [], Solid.intersection
    monkeypatch.setattr(
        Solid,
        "intersection",
        staticmethod(lambda solids: (counts.append(1), intersection(solids))[1]),
    )
    for phi in np.linspace(-0.3, 0.3, 40):
        counts.append(0)
        workspace(design, float(phi), 0.1, None, "preview")
    taken = [len(run) for run in "".join(map(str, counts)).split("0")[1:]]
    assert max(taken) <= 4
    assert taken.count(most) > 25  # the others meet a twin by the last digit
    assert min(taken) == most
