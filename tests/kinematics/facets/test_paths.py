"""What moves pass, from margins and wrenches alone, as a mechanism without functions of its own."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.answers.singularities import Event
from kinematics.answers.solutions import Posture
from kinematics.designs.files import load_design
from kinematics.facets.events import after_part
from kinematics.facets.paths import PathsFacet
from kinematics.machine import Machine, machine_of

PRESETS = ("rpur-table1", "sps-spr", "rps-3", "spr-3", "five-bar")


class Plain(PathsFacet):
    """Nothing is known but what every mechanism supplies."""


class Constrained(Plain):
    """The same where coordinates depend on each other."""

    def __init__(self, machine: Machine) -> None:
        super().__init__(machine.mechanism)
        self.consistent = machine.paths.consistent  # type: ignore[method-assign]


def moves(machine: Machine, count: int) -> list[tuple[Posture, Posture]]:
    rng = np.random.default_rng(3)
    unit = np.array([1.0 if c.unit == "mm" else 1.0 / machine.length for c in machine.coordinates])
    low, high = np.array([(c.lower, c.upper) for c in machine.coordinates]).T
    home = machine.home
    found = []
    while len(found) < count:
        ends = []
        for _ in range(2):
            pose = np.array(home.pose) + rng.normal(size=len(unit)) * 160.0 * unit
            pose = np.clip(pose, low + 0.02 * (high - low), high - 0.02 * (high - low))
            if machine.dependent:
                pose = np.array(machine.complete_pose(pose, home.mode))
            ends.append(machine.posture(pose, home.mode))
        found.append((ends[0], ends[1]))
    return found


def key(event: Event) -> tuple[str, int | None, bool]:
    return event.kind, event.limb, event.stops


@pytest.mark.parametrize("name", PRESETS)
def test_margins_and_wrenches_alone_tell_the_same_events(name: str) -> None:
    machine = machine_of(load_design(name))
    plain = Constrained(machine)
    told = 0
    for before, after in moves(machine, 30):
        own = [e for e in machine.paths.passed(before, after) if e.stops or e.kind != "parallel"]
        found = [e for e in plain.passed(before, after) if e.stops or e.kind != "parallel"]
        assert [key(e) for e in found] == [key(e) for e in own]
        assert [e.fraction for e in found] == pytest.approx([e.fraction for e in own], abs=1e-6)
        told += len(own)
    assert told > 10


def test_a_path_of_one_s_own_functions_stops_where_the_plain_one_does() -> None:
    machine = machine_of(load_design("rps-3"))
    plain = Plain(machine.mechanism)
    stops = set()
    for before, after in moves(machine, 12):
        if before.reachable:
            one, two = machine.paths.drive(before, [after.pose]), plain.drive(before, [after.pose])
            assert (one.stop, one.limb) == (two.stop, two.limb)
            assert one.fraction == pytest.approx(two.fraction, abs=1e-6)
            stops.add(one.stop)
    assert len(stops) > 1


def test_places_on_a_way_are_told_in_per_cent() -> None:
    assert after_part(0.125) == "after 12.5 % of the way"
    assert after_part(1.0) == "after 100 % of the way"
