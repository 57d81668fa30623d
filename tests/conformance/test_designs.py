"""Designs are read as they were written, and every number of them can be edited."""

from __future__ import annotations

import pickle

import pytest

import kinematics as kin
from tests.conformance.machines import ONE_EACH, PRESETS, machine


@pytest.mark.parametrize("name", PRESETS)
def test_what_is_written_reads_back_equal(name: str) -> None:
    m = machine(name)
    again = kin.read(kin.write(m), name=m.design.name)
    assert again.design == m.design
    assert hash(again.design) == hash(m.design)
    assert pickle.loads(pickle.dumps(m.design)) == m.design
    assert m.mechanism.read_design(m.table, origin="", name=m.design.name) == m.design


@pytest.mark.parametrize("name", ONE_EACH)
def test_every_number_can_be_edited_and_stands_where_it_says(name: str) -> None:
    m = machine(name)
    assert m.fields
    for field in m.fields:
        value = field.value * 0.99 if field.value else 1.0
        changed = m.edited(field.path, value)
        assert changed.design != m.design
        (now,) = [each.value for each in changed.fields if each.path == field.path]
        assert now == pytest.approx(value)
        assert m.edited(".".join(map(str, field.path)), value).design == changed.design
        with pytest.raises(kin.InputError):
            m.edited(field.path, float("nan"))
    with pytest.raises(kin.InputError, match="no number"):
        m.edited("nothing.3", 1.0)


@pytest.mark.parametrize("name", ONE_EACH)
def test_a_kind_says_what_it_is(name: str) -> None:
    m = machine(name)
    keys = [axis.key for axis in (*m.coordinates, *m.joints)]
    assert len(set(keys)) == len(keys)
    for axis in (*m.coordinates, *m.joints):
        assert axis.symbol
        assert axis.lower < axis.upper
    assert m.length > 0.0
    assert m.home.mode in m.modes
    assert (m.mode_noun == "") == (len(m.modes) == 1)
