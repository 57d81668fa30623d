"""From wrenches to singularities in words, for machines of any kind."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.answers.motion import WrenchName, WrenchSystem
from kinematics.answers.singularities import NEAR
from kinematics.arrays import Array
from kinematics.screws.lines import geometry
from kinematics.screws.singularity_geometry import cause, listed, lost, motion_text, wrench_list
from kinematics.screws.varieties import Screw
from kinematics.screws.wrenches import determinant
from tests.kinematics.screws.test_lines import KINDS, lines, unit

LENGTH = 50.0
NAMES = (
    *(WrenchName("actuation", n, f"F{n}") for n in (1, 2, 3)),
    *(WrenchName("constraint", n, f"C{n}") for n in (1, 2, 3)),
)


def system(rows: Array, names: tuple[WrenchName, ...] = NAMES) -> WrenchSystem:
    gain = np.ones(3)
    return WrenchSystem(names, rows, np.zeros((len(rows), 3)), determinant(rows, LENGTH), gain)


def spatial_rates(twist: Array) -> list[float]:
    """A pose whose rates are the twist itself."""
    return [*twist[3:], *twist[:3]]


def random_rows(seed: int) -> Array:
    rng = np.random.default_rng(seed)
    return lines(LENGTH * rng.normal(size=(6, 3)), unit(rng, 6))


def test_a_held_platform_has_lost_nothing() -> None:
    assert lost(system(random_rows(1)), (0.0, 0.0, 0.0), LENGTH, spatial_rates) == ()


def test_dependent_constraints_are_a_constraint_singularity() -> None:
    rows = random_rows(2)
    rows[4] = -2.0 * rows[3]
    (found,) = lost(system(rows), (0.0, 0.0, 0.0), LENGTH, spatial_rates)
    assert found.kind == "constraint"
    assert found.limbs == (1, 2)
    assert found.cause == "the constraints of limbs 1 and 2 coincide"
    assert found.text.startswith("Constraint singularity: the constraints no longer forbid ")
    assert found.twist is not None
    work = rows[:, :3] @ found.twist[3:] + rows[:, 3:] @ found.twist[:3]
    np.testing.assert_allclose(work, 0.0, atol=1e-9)


def test_actuators_and_constraints_together_are_a_parallel_one() -> None:
    rows = random_rows(3)
    rows[1] = rows[0] + rows[3]  # no line, but dependent
    (found,) = lost(system(rows), (0.0, 0.0, 0.0), LENGTH, spatial_rates)
    assert found.kind == "parallel"
    assert found.limbs == (1, 2)
    assert found.cause.startswith("the lines of limbs 1 and 2 and the constraint of limb 1 ")


def test_both_at_a_time_constraints_first() -> None:
    rows = random_rows(4)
    rows[1] = 3.0 * rows[0]
    rows[5] = rows[4]
    found = lost(system(rows), (0.0, 0.0, 0.0), LENGTH, spatial_rates)
    assert [one.kind for one in found] == ["constraint", "parallel"]
    assert [one.limbs for one in found] == [(2, 3), (1, 2)]
    assert all("one of 2 free motions" in one.text for one in found)


def test_near_ones_keep_the_constraints() -> None:
    rows = random_rows(5)
    rows[1] = rows[0] + 1e-3 * random_rows(6)[1]
    assert lost(system(rows), (0.0, 0.0, 0.0), LENGTH, spatial_rates) == ()
    (found,) = lost(system(rows), (0.0, 0.0, 0.0), LENGTH, spatial_rates, NEAR)
    assert found.text.startswith("Near a parallel singularity: the platform yields most to ")
    assert 1e-6 < found.measure < NEAR
    assert found.cause == "nearly: the lines of limbs 1 and 2 coincide"
    assert found.twist is not None
    work = rows[:, :3] @ found.twist[3:] + rows[:, 3:] @ found.twist[:3]
    np.testing.assert_allclose(work[3:], 0.0, atol=1e-9)
    assert np.abs(work[:3]).max() > 1e-5


def test_unknown_wrenches_and_rates() -> None:
    rows = random_rows(7)
    rows[1] = rows[0]
    (found,) = lost(system(rows), (0.0, 0.0, 0.0), LENGTH, lambda twist: [float("nan")] * 3)
    assert found.motion is None
    assert found.twist is not None
    rows = rows.copy()
    rows[2, 1] = np.nan
    assert lost(system(rows), (0.0, 0.0, 0.0), LENGTH, spatial_rates) == ()


def test_axes_do_not_depend_on_the_reference_point() -> None:
    rows = random_rows(8)
    rows[1] = rows[0]
    point = np.array([30.0, -40.0, 20.0])
    about = rows.copy()
    about[:, 3:] -= np.cross(point, rows[:, :3])
    (here,) = geometry(rows, LENGTH, 1e-6).screws
    (there,) = geometry(about, LENGTH, 1e-6, tuple(point)).screws
    np.testing.assert_allclose(np.cross(here.direction, there.direction), 0.0, atol=1e-9)
    assert there.pitch == pytest.approx(here.pitch)
    assert here.point is not None
    assert there.point is not None
    gap = np.array(here.point) - there.point
    np.testing.assert_allclose(np.cross(gap, here.direction), 0.0, atol=1e-7)


SAID = {
    "line": "coincide",
    "couple": "couples about parallel axes",
    "pencil": "and meet in the point",
    "parallel pencil": "are parallel and lie in one plane",
    "couples": "are couples parallel to one plane",
    "bundle": "meet in one point",
    "parallel bundle": "are all parallel",
    "plane": "a plane field",
    "all couples": "are couples",
    "two pencils": "two flat pencils that share the line",
    "regulus": "one hyperboloid: a regulus",
    "paraboloid": "hyperbolic paraboloid",
    "hyperbolic congruence": "all meet two lines",
    "elliptic congruence": "an elliptic congruence",
    "parabolic congruence": "a parabolic congruence",
    "degenerate congruence": "a degenerate congruence",
    "special complex": "a special linear complex",
    "general complex": "with pitch",
}


def test_every_variety_has_its_words() -> None:
    for construct, kind in KINDS:
        rows = construct(np.random.default_rng(9))
        (circuit,) = geometry(rows, 1.0, 1e-6).circuits
        names = tuple(WrenchName("actuation", n + 1, "F") for n in range(len(rows)))
        said = cause(circuit, names)
        assert said.startswith("the lines of limbs 1")
        assert SAID[kind] in said
        assert "nan" not in said
        assert "inf" not in said.replace("infinity", "")


def test_a_wrench_that_vanishes_is_said_in_the_singular() -> None:
    rows = random_rows(10)
    rows[1] = 0.0
    (circuit,) = geometry(rows, LENGTH, 1e-6).circuits
    assert cause(circuit, NAMES) == "the line of limb 2 vanishes"


def test_who_takes_part() -> None:
    names = (*NAMES[:3], WrenchName("constraint", None, "M"))
    assert wrench_list((0, 2, 3), names) == "the lines of limbs 1 and 3 and the constraint couple"
    assert (
        wrench_list((0, 3, 4), NAMES) == "the line of limb 1 and the constraints of limbs 1 and 2"
    )
    assert listed([4]) == "4"
    assert listed([1, 2, 5]) == "1, 2 and 5"


def test_motions_as_a_designer_reads_them() -> None:
    turn = Screw((0.0, 1.0, 0.0), (12.34, 0.0, -4.0), 0.0)
    assert motion_text(turn) == "a turn about the axis through (12.3, 0.0, -4.0) mm along (0, 1, 0)"
    assert motion_text(Screw((0.6, 0.8, 0.0), (0.0, 0.0, 0.0), 12.345)) == (
        "a screw motion about the axis through (0.0, 0.0, 0.0) mm along (0.6, 0.8, 0), "
        "pitch 12.3 mm/rad"
    )
    slide = Screw((1.0, 0.0, 0.0), None, np.inf)
    assert motion_text(slide) == "a translation along (1, 0, 0)"
