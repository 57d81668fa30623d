"""The list of solutions: every one of them is there, told truly, filtered and sorted as asked."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from app.features.move.state import Move, Visit
from app.features.solutions.compute import HERE, Known, atlas
from app.features.solutions.state import SetAtlas
from app.review import view as compute
from app.review.changes import change
from app.review.state import Review, new_review
from app.review.units import pose_text
from app.review.units import tenths as number
from kinematics.answers.solutions import ForwardSolutions, Merged, Refreshed
from kinematics.designs.files import load_design
from kinematics.errors import InputError
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class

MACHINE = mechanism_class("five_rpur")


def known_of(review: Review) -> Known:
    (found,) = machine_of(review.design).forward([review.posture.joints])
    return Known(review.design, found)


@pytest.fixture(scope="module")
def review() -> Review:
    """A simplified design where nothing is special."""
    home = new_review(load_design("rpur-a1a2"))
    x, y, z, _, _ = home.pose
    return change(home, Visit((x + 7.0, y - 3.0, z + 5.0, 0.1, -0.07), home.mode))[0]


@pytest.fixture(scope="module")
def known(review: Review) -> Known:
    return known_of(review)


def test_every_solution_is_a_row_and_the_present_one_is_marked(
    review: Review, known: Known
) -> None:
    shown = atlas(compute.view(review), known)
    assert len(shown.rows) == len(known.solutions) > 3
    assert not shown.stale
    assert shown.hidden == 0
    (here,) = [row for row in shown.rows if row.here]
    assert here is shown.rows[0]
    assert here.distance < HERE
    assert here.pose == pytest.approx(review.pose, abs=1e-6)
    assert here.mode == review.mode
    assert {row.identity for row in shown.rows} == set(known.solutions.identities)


def test_the_count_says_how_it_is_known(review: Review, known: Known) -> None:
    shown = atlas(compute.view(review), known)
    assert shown.complete
    found = known.solutions
    assert shown.count == f"{len(found)} real of {found.complex_count} complex solutions"
    assert shown.how.startswith("complete: count and conjugation closure hold · ")
    lacking = replace(known.solutions, complete=False, expected_count=96, complex_count=90)
    partly = atlas(compute.view(review), replace(known, solutions=lacking))
    assert not partly.complete
    assert "of 90 complex" in partly.count
    assert partly.how.startswith("not known to be complete: 96 are expected")


def test_a_distance_is_how_far_the_platforms_farthest_point_goes(
    review: Review, known: Known
) -> None:
    view = compute.view(review)
    corners = [p for b in view.drawing.bodies if b.name == "platform" for p in b.points]
    for row in atlas(view, known).rows:
        there = machine_of(review.design).transform(row.pose, row.mode)
        ways = [
            math.dist((there @ [*p, 1.0])[:3], (view.platform @ [*p, 1.0])[:3]) for p in corners
        ]
        assert row.distance == pytest.approx(max(ways), abs=1e-9)


def test_ghosts_stand_where_their_rows_say(review: Review, known: Known) -> None:
    turned, _ = change(review, SetAtlas("sort", "condition"))
    shown = atlas(compute.view(turned), known)
    for row, placed in zip(shown.rows, shown.placements, strict=True):
        assert placed == pytest.approx(machine_of(review.design).transform(row.pose, row.mode))


@pytest.mark.parametrize(
    ("sort", "value"),
    [
        ("distance", lambda row: row.distance),
        ("condition", lambda row: row.condition),
        ("height", lambda row: -row.pose[2]),
        ("mode", lambda row: MACHINE.modes.index(row.mode)),
    ],
)
def test_sorting(review: Review, known: Known, sort: str, value) -> None:  # type: ignore[no-untyped-def]
    ordered, _ = change(review, SetAtlas("sort", sort))
    values = [value(row) for row in atlas(compute.view(ordered), known).rows]
    assert len(set(values)) > 1
    assert values == sorted(values)


def test_filters(review: Review, known: Known) -> None:
    modes = known.solutions.modes

    def shown(name: str, value: bool | str) -> list[str]:
        filtered = atlas(compute.view(change(review, SetAtlas(name, value))[0]), known)
        assert filtered.hidden == len(modes) - len(filtered.rows)
        return sorted(row.mode for row in filtered.rows)

    assert shown("modes", "") == sorted(modes)
    pattern = f"????{review.mode[4]}"
    assert 0 < len(shown("modes", pattern)) < len(modes)
    assert shown("modes", pattern) == sorted(m for m in modes if m[4] == review.mode[4])
    assert shown("within_stroke", True) == sorted(modes)
    beyond = replace(known.solutions, within_stroke=np.zeros(len(modes), dtype=bool))
    strict, _ = change(review, SetAtlas("within_stroke", True))
    assert atlas(compute.view(strict), replace(known, solutions=beyond)).rows == ()


def test_solutions_of_other_lengths_are_called_stale(review: Review, known: Known) -> None:
    moved, _ = change(review, Move(0, review.pose[0] + 5.0))
    shown = atlas(compute.view(moved), known)
    assert shown.stale
    assert not any(row.here for row in shown.rows)
    assert not known.stands_at(moved.posture.joints)
    assert known.stands_at(review.posture.joints)


def test_a_visit_keeps_the_lengths_and_changes_who_is_here(review: Review, known: Known) -> None:
    for row in atlas(compute.view(review), known).rows:
        there, note = change(review, Visit(row.pose, row.mode))
        assert note == ""
        assert there.posture.joints == pytest.approx(review.posture.joints, abs=1e-7)
        assert known.stands_at(there.posture.joints)
        shown = atlas(compute.view(there), known)
        assert [r.identity for r in shown.rows if r.here] == [row.identity]


def test_nothing_is_shown_of_another_design_or_of_a_machine_that_does_not_close(
    review: Review, known: Known
) -> None:
    other = new_review(load_design("rpur-a2a3"))
    assert atlas(compute.view(other), known).rows == ()
    assert atlas(compute.view(review), None).rows == ()
    top = machine_of(review.design).coordinates[1].upper
    away, _ = change(review, Move(1, top))
    assert not away.posture.closes
    shown = atlas(compute.view(away), known)
    assert shown.rows == ()
    assert "do not close" in shown.remarks[0][0]


def test_limbs_of_an_arrangement_that_is_not_merged_stand_in_any_mode() -> None:
    review = new_review(load_design("rpur-a2a2"))
    review, _ = change(review, Visit((-265.0, 65.0, 107.0, 0.0, 0.0), "-++--"))
    assert review.posture.reachable
    shown = atlas(compute.view(review), known_of(review))
    assert [row.mode for row in shown.rows if row.here] == [review.mode]
    assert "of 1088 complex" in shown.count


def test_merged_limbs_are_offered_one_mode() -> None:
    review = new_review(load_design("rpur-a1a1"))
    with pytest.raises(InputError, match="not a solution of this mechanism"):
        change(review, Visit(review.pose, "+-+++"))
    shown = atlas(compute.view(review), known_of(review))
    assert {row.mode for row in shown.rows} <= set(review.machine.modes)
    assert len(review.machine.modes) == 8


# --- who came and went ----------------------------------------------------------------------


def _set(known: Known, *identities: int) -> ForwardSolutions:
    count = len(identities)
    found = known.solutions
    return replace(
        found,
        identities=identities,
        **{
            name: getattr(found, name)[:count]
            for name in (
                "poses",
                "modes",
                "residual",
                "condition",
                "determinant",
                "within_stroke",
                "multiplicity",
                "gap",
            )
        },
    )


def test_news_are_counted_from_the_last_rest(review: Review, known: Known) -> None:
    pose = known.solutions.poses[0]
    gone = [Merged(n, 5 - n, tuple(pose), "+++++") for n in (2, 3)]
    passing = [Merged(n, 17 - n, tuple(pose), "+++++") for n in (8, 9)]
    start = replace(known, solutions=_set(known, 1, 2, 3))
    one = start.after(Refreshed(_set(known, 1, 8, 9), (8, 9), tuple(gone)), rested=True)
    assert one.appeared == {8, 9}
    assert one.merged == tuple(gone)
    two = one.after(Refreshed(_set(known, 1), (), tuple(passing)), rested=False)
    assert two.appeared == frozenset()
    assert two.merged == tuple(gone)  # 8 and 9 were never there, seen from the rest
    three = two.after(Refreshed(_set(known, 1, 10), (10,), ()), rested=True)
    assert three.appeared == {10}
    assert three.merged == ()

    shown = atlas(compute.view(review), one)
    assert [row.identity for row in shown.rows if row.new] == [
        row.identity for row in shown.rows if row.identity in {8, 9}
    ]
    texts = [text for text, _ in shown.remarks]
    assert "2 appeared on the way: #8, #9" in texts
    (told,) = [text for text in texts if "merged" in text]
    assert told.startswith("2 merged on the way: #2 with #3 at x ")


def test_identities_are_found_again(known: Known) -> None:
    for n, identity in enumerate(known.solutions.identities):
        assert known.index(identity) == n
    assert known.index(-5) is None


# --- words ----------------------------------------------------------------------------------


def test_numbers_on_the_page() -> None:
    assert number(-12.34) == "−12.3"
    assert number(-0.04) == "0.0"
    assert number(math.nan) == "–"


def test_a_pose_in_words(review: Review) -> None:
    text = pose_text(review.machine.coordinates, (1.0, -2.0, 3.25, math.pi / 2, -math.pi / 6))
    assert text == "x 1.0, y −2.0, z 3.2 mm, φ 90.0°, θ −30.0°"
