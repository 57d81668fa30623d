"""Working modes as people type them."""

from __future__ import annotations

from itertools import product

import pytest

from app.review.units import minus as page_mode
from kinematics.answers.modes import matching
from kinematics.errors import InputError

FIVE = tuple("".join(signs) for signs in product("+-", repeat=5))


@pytest.mark.parametrize(
    ("text", "modes"),
    [
        ("+-+-+", {"+-+-+"}),
        ("−−+++", {"--+++"}),
        ("––+++", {"--+++"}),
        (" +-+-+ ,  -----", {"+-+-+", "-----"}),
        ("+-+-+;-----", {"+-+-+", "-----"}),
        ("?-+-+", {"+-+-+", "--+-+"}),
        ("?????", set(FIVE)),
        ("+-+-+ +-+-+", {"+-+-+"}),
    ],
)
def test_patterns(text: str, modes: set[str]) -> None:
    found = matching(text, FIVE)
    assert set(found) == modes
    assert list(found) == [mode for mode in FIVE if mode in modes]


@pytest.mark.parametrize("text", ["", "+-+-", "+-+-++", "+-x-+", "+-+-+,", "none"])
def test_what_is_no_mode_says_what_one_is(text: str) -> None:
    with pytest.raises(InputError, match=r"is not a working mode; .* each of the 5 limbs, as [+-]"):
        matching(text, FIVE)


def test_modes_that_are_no_signs() -> None:
    assert matching("2", ("1", "2")) == ("2",)
    with pytest.raises(InputError, match="one of 1, 2"):
        matching("3", ("1", "2"))


def test_the_page_writes_a_minus_as_long_as_a_plus() -> None:
    assert page_mode("+--+-") == "+−−+−"
    assert matching(page_mode("+--+-"), FIVE) == ("+--+-",)
