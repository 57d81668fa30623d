"""Modes and bounds as values: their written forms, what they are called, and the way back."""

from __future__ import annotations

import json
import pickle
from itertools import product

import pytest

from kinematics.answers.bounds import Bound, decimals, named, shared_names
from kinematics.answers.modes import Mode, matching, noun, working_modes
from kinematics.designs.files import presets, read_design
from kinematics.errors import InputError
from kinematics.machine import Machine, machine_of

BOTH = tuple(Mode(operation, "".join(s)) for operation in (1, 2) for s in product("+-", repeat=3))


def machine(name: str) -> Machine[object]:  # type: ignore[type-var]
    from kinematics.designs.files import load_design

    return machine_of(load_design(name))


@pytest.mark.parametrize("mode", [Mode(), Mode(2), *working_modes(2), *BOTH])
def test_a_mode_is_read_back_from_its_written_form(mode: Mode) -> None:
    assert Mode.read(mode) == mode
    assert Mode.read(mode.page).signs == mode.signs
    for copy in (pickle.loads(pickle.dumps(mode)), Mode(mode.operation, mode.signs)):
        assert (copy, copy.operation, copy.signs) == (mode, mode.operation, mode.signs)
    assert json.dumps({"mode": mode}) == json.dumps({"mode": str(mode)})


def test_modes_of_both_kinds_are_told_by_number_and_signs() -> None:
    assert (noun(BOTH), noun(BOTH[:1])) == ("mode", "mode")
    assert noun(("+-", "--")) == "working mode"
    assert noun(("1", "2")) == "operation mode"
    assert noun(("",)) == ""
    mode = Mode(2, "+-+")
    assert (mode, mode.page) == ("2+-+", "2+−+")
    assert mode.named == "operation mode 2, mode +−+"
    assert mode.entry == {"operation_mode": "2", "working_mode": "+-+"}
    assert mode.with_sign(1, "-") == "2--+"


def test_what_is_typed_may_leave_one_kind_open() -> None:
    assert matching("1", BOTH) == BOTH[:8]
    assert matching("+-+", BOTH) == ("1+-+", "2+-+")
    assert matching("2+−?", BOTH) == ("2+-+", "2+--")
    for wrong in ("3", "+-", "1+", "1++++", "x"):
        with pytest.raises(InputError, match="is not a mode; it is one of 1"):
            matching(wrong, BOTH)


def test_the_nearest_mode_flips_the_fewest_limbs() -> None:
    here = Mode(1, "+++")
    assert [here.flips(mode) for mode in ("1+++", "1-+-", "2+++")] == [0, 2, 4]


@pytest.mark.parametrize(
    ("preset", "text", "said"),
    [
        ("rpur-table1", "+-", "a working mode has one sign, + or -, for each of the 5 limbs"),
        ("rps-3", "3", "an operation mode is 1 or 2, got '3'"),
        ("sps-spr", "+", "a mode need not be named"),
    ],
)
def test_a_mode_that_a_machine_has_not_is_refused(preset: str, text: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        machine(preset).mechanism.mode(text)
    assert said in str(caught.value)


@pytest.mark.parametrize("preset", [info.name for info in presets()])
def test_every_bound_is_called_by_the_machines_own_symbols(preset: str) -> None:
    m = machine(preset)
    symbols = {joint.limb: joint.symbol for joint in m.joints}
    units = {joint.limb: joint.unit for joint in m.joints}
    for bound in m.mechanism.bounds:
        if bound.end in ("min", "max"):
            assert bound == f"rho_{bound.end}"
            assert (bound.joint, bound.unit) == (symbols[bound.limb], units[bound.limb])
    assert {margin.bound for margin in m.home.margins} <= set(m.mechanism.bounds)


def test_a_five_bar_speaks_of_its_angles() -> None:
    design = read_design(
        'mechanism = "five_bar"\nproximal = [480, 480]\ndistal = [480, 480]\nhalf_base = 240\n'
        "joint_range_deg = [[0, 175], [0, 175]]\n",
        origin="a test",
    )
    m = machine_of(design)
    nearest = m.home.nearest
    assert nearest is not None
    assert nearest.bound.place in {"limb 1, θ₁ max", "limb 2, θ₂ min"}
    over = m.posture((-600.0, 100.0), "+-").reasons
    assert any("θ₁ is" in reason.text for reason in over)
    assert shared_names(m.mechanism.bounds)["rho_max"] == "θ max"


def vars_of(bound: Bound) -> tuple[object, ...]:
    return bound.joint, bound.end, bound.name, bound.unit, bound.limb


def test_bounds_keep_what_they_are() -> None:
    bound = Bound("θ₁", "max", unit="rad", limb=1)
    copy = pickle.loads(pickle.dumps(bound))
    assert vars_of(copy) == vars_of(bound) == ("θ₁", "max", "θ₁ max", "rad", 1)
    assert (named(bound), named("link")) == ("θ₁ max", "link")


@pytest.mark.parametrize(
    ("amount", "digits"), [(12.0, 1), (0.1, 1), (0.04, 3), (3e-5, 6), (0.0, 1)]
)
def test_amounts_are_written_with_as_many_digits_as_show_them(amount: float, digits: int) -> None:
    assert decimals(amount) == digits
