"""Design files of the 4-SPS + 1-SPR: round trips, and one clear sentence for what is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.designs.files import read_design, write_design
from kinematics.errors import DesignError
from kinematics.machine import machine_of
from tests.kinematics.mechanisms.four_sps_spr.machines import general, preset

GOOD = write_design(preset())


def test_the_preset_is_the_layout_that_its_file_states() -> None:
    design = preset()
    assert design.base[0].tolist() == [200.0, 0.0, 0.0]
    turns = np.degrees(np.arctan2(design.base[1:, 1], design.base[1:, 0])) % 360.0
    assert turns == pytest.approx([45.0, 135.0, 225.0, 315.0])
    assert np.linalg.norm(design.base[1:], axis=1) == pytest.approx(400.0)
    assert np.linalg.norm(design.platform, axis=1) == pytest.approx(100.0)
    turns = np.degrees(np.arctan2(design.platform[:, 1], design.platform[:, 0])) % 360.0
    assert turns == pytest.approx(27.0 + 72.0 * np.arange(5))
    tangent = np.cross([0.0, 0.0, 1.0], design.platform[4] / 100.0)
    assert abs(design.axis @ tangent) == pytest.approx(1.0)


@pytest.mark.parametrize("design", [preset(), general()])
def test_designs_read_back_equal(design) -> None:
    text = write_design(design)
    again = read_design(text, origin="file", name=design.name)
    assert again == design
    assert hash(again) == hash(design)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("revolute_axis", "revolut_axis", "did you mean 'revolute_axis'"),
        ("revolute_axis = [1.0, 1.0, 0.0]", "", "'revolute_axis' is missing"),
        ("[1.0, 1.0, 0.0]", "[0, 0.0, 0]", "must be a direction"),
        ("[1.0, 1.0, 0.0]", "[1.0, nan, 0.0]", "finite"),
        ("[1.0, 1.0, 0.0]", "[1.0, 1.0]", "3 numbers"),
        ("stroke = [450.0, 800.0]", "stroke = [800.0, 450.0]", "shortest < longest"),
        ("stroke = [450.0, 800.0]", "stroke = [-1.0, 450.0]", "must not be negative"),
        ("stroke = [450.0, 800.0]", "link = 3", "unknown key 'link'"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(old: str, new: str, told: str) -> None:
    with pytest.raises(DesignError, match=r"^file") as caught:
        read_design(GOOD.replace(old, new, 1), origin="file", name="x")
    assert told in str(caught.value)


def test_four_limbs_are_not_enough() -> None:
    text = GOOD[: GOOD.rindex("[[limb]]")]
    with pytest.raises(DesignError, match="5 tables"):
        read_design(text, origin="file", name="x")


def test_every_number_may_be_edited() -> None:
    design = preset()
    fields = machine_of(design).fields
    assert len(fields) == 43
    for field in fields:
        changed = machine_of(design).edited(field.path, field.value + 1.0).design
        (now,) = (f.value for f in machine_of(changed).fields if f.path == field.path)
        assert now == field.value + 1.0
