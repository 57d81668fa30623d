"""The folds ahead: which is told of first, and in which words."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.features.solutions.compute import Ahead, Known, look_ahead, nearest_first, partner
from app.features.solutions.html import title, words
from app.review.state import Review, new_review
from kinematics.answers.solutions import Fold
from kinematics.designs.files import load_design


@pytest.fixture(scope="module")
def review() -> Review:
    return new_review(load_design("rpur-a3a3"))


@pytest.fixture(scope="module")
def known(review: Review) -> Known:
    (found,) = review.machine.forward([review.posture.joints])
    return Known(review.design, found)


def _ahead(review: Review, index: int, by: float, *, partner: int | None, known: Known) -> Ahead:
    start = review.posture.joints[index]
    joints = list(review.posture.joints)
    joints[index] = start + by
    other = None
    if partner is not None:
        found = known.solutions
        other = review.machine.inverse.posture(found.poses[partner].tolist(), found.modes[partner])
    fold = Fold(abs(by), tuple(joints), review.pose, review.mode, other)
    return Ahead(index, start, start + 3 * by, fold)


def test_the_driven_actuator_comes_first_and_then_the_nearest(review: Review, known: Known) -> None:
    def at(index: int, by: float) -> Ahead:
        return _ahead(review, index, by, partner=None, known=known)

    free = Ahead(4, 300.0, 400.0, None)
    folds = (at(0, 30.0), at(1, -10.0), at(2, 50.0), at(2, -40.0), free)
    assert nearest_first(folds, None) == [folds[1], folds[0], folds[3], folds[2]]
    assert nearest_first(folds, 2) == [folds[3], folds[2], folds[1], folds[0]]
    assert nearest_first((free,), 4) == []


def test_it_says_how_far_where_and_with_which_solution(review: Review, known: Known) -> None:
    start = review.posture.joints[2]
    ahead = _ahead(review, 2, 33.74, partner=1, known=known)
    other = known.solutions.identities[1]
    assert title(review, ahead) == "ρ₃ +33.7 mm"
    text = words(review, ahead, known)
    assert text.startswith(f"Raising ρ₃ by 33.7 mm, to {start + 33.74:.1f} mm, ends this assembly")
    assert f"There it merges with solution #{other} (mode " in text
    assert "with a solution (mode" in words(review, ahead, None)
    back = _ahead(review, 2, -33.74, partner=None, known=known)
    assert title(review, back) == "ρ₃ −33.7 mm"
    assert words(review, back, known).startswith("Lowering ρ₃ by 33.7 mm")
    assert "does not reach back" in words(review, back, known)
    assert words(review, Ahead(2, 300.0, 400.0, None), known) == ""


def test_another_mode_at_the_fold_is_told(review: Review, known: Known) -> None:
    ahead = _ahead(review, 0, 5.0, partner=None, known=known)
    assert ahead.fold is not None
    mode = "".join("-" if sign == "+" else "+" for sign in review.mode)
    turned = replace(ahead, fold=replace(ahead.fold, mode=mode))
    assert f"(by then in mode {mode.replace('-', '−')})" in words(review, turned, known)


def test_a_partner_is_one_of_the_known_solutions_or_none(review: Review, known: Known) -> None:
    found = known.solutions
    for n, identity in enumerate(found.identities):
        posture = review.machine.inverse.posture(found.poses[n].tolist(), found.modes[n])
        assert partner(known, posture) == identity
        off = (posture.pose[0] + 1.0, *posture.pose[1:])
        assert partner(known, review.machine.inverse.posture(off, posture.mode)) is None
    assert partner(None, review.posture) is None


def test_both_directions_of_every_actuator_are_looked_at(review: Review, known: Known) -> None:
    ahead = look_ahead(review.design, review.posture)
    bounds = review.machine.joints
    assert [(a.index, a.longer) for a in ahead] == [
        (n, up) for n in range(5) for up in (False, True)
    ]
    for a in ahead:
        assert a.end == (bounds[a.index].upper if a.longer else bounds[a.index].lower)
        assert a.start == review.posture.joints[a.index]
        if a.fold is not None:
            off = [abs(x - y) for x, y in zip(a.fold.joints, review.posture.joints, strict=True)]
            assert off[a.index] == pytest.approx(a.fold.distance, abs=1e-6)
            assert sum(off) == pytest.approx(a.fold.distance, abs=1e-6)  # it alone is driven
