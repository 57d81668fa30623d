"""What a machine says to what is no number, and of itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kinematics as kin
from kinematics.facets.faceted import TOPICS


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda m: m.pose(phi_deg="x"), "phi_deg must be a finite number, got 'x'"),
        (lambda m: m.pose(x=[1.0, 2.0]), "x must be a finite number"),
        (lambda m: m.pose(x=np.inf), "x must be a finite number, got inf"),
        (lambda m: m.poses(x="a"), "x must be numbers"),
        (lambda m: m.pose().with_values(x="a"), "x must be a finite number, got 'a'"),
        (lambda m: m.at("x"), "a pose must be numbers"),
        (lambda m: m.workspace(phi="x"), "phi must be a finite number, got 'x'"),
        (lambda m: m.inverse([["x"] * 5]), "a pose must be numbers"),
        (lambda m: m.forward("x"), "the joints must be numbers"),
        (lambda m: m.follow(m.home, "x"), "the joints must be numbers"),
        (lambda m: m.at().followed({"rho1": "x"}), "rho1 must be a finite number, got 'x'"),
        (lambda m: m.at().velocity(pose_rates="x"), "rates must be numbers"),
        (lambda m: m.edited("limb.2.link", "x"), "the new value must be a finite number"),
    ],
)
def test_what_is_no_number_is_told_in_one_sentence(
    ask: Callable[[kin.Machine[Any]], object], said: str
) -> None:
    with pytest.raises(kin.InputError, match=said):
        ask(kin.open("rpur-table1"))


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("limb.9.link", "no number 'limb.9.link'; limb has 0, 1, 2, 3, 4"),
        ("limb.2.lnk", "no number 'limb.2.lnk'; limb.2 has base, platform, link, stroke"),
        ("limb.2.link.0", "no number 'limb.2.link.0'; limb.2.link is a number itself"),
        ("foo", "no number 'foo'; there are limb"),
    ],
)
def test_a_path_that_is_not_there_is_told_as_typed(path: str, said: str) -> None:
    with pytest.raises(kin.InputError, match=said):
        kin.open("rpur-table1").edited(path, 3.0)


def test_what_a_machine_answers_is_documented_on_its_class() -> None:
    for name in TOPICS:
        kind = getattr(kin.Machine, name)
        assert isinstance(kind, type)
        assert kind.__doc__
    assert isinstance(kin.open("rps-3").forward, kin.Machine.forward)  # type: ignore[arg-type]
