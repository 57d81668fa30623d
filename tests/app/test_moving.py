"""The part that keeps the trajectory: newest wins, nothing stale, the review stays as it plays."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.features.move.state import Place
from app.features.trajectory import compute
from app.features.trajectory.compute import Asked, Computed, Moved
from app.features.trajectory.html import ends_html
from app.features.trajectory.part import TrajectoryPart, rounded_up
from app.features.trajectory.playing import Player
from app.features.trajectory.state import Plan, SetPlan
from app.jobs.lane import Done, Job, Lost
from app.review.changes import Change, change
from app.review.state import Review, new_review
from app.review.view import View, view
from kinematics.designs.files import load_design


class Stage:
    """A page that only keeps its review."""

    def __init__(self, review: Review) -> None:
        self.review = review
        self.scene: Any = SimpleNamespace()
        self.told: list[str] = []
        self.made: list[Change] = []
        self.inbox: list[object] = []

    @property
    def view(self) -> View:
        return view(self.review)

    def put(self, item: object) -> None:
        self.inbox.append(item)

    def ask(self, act: object, *arguments: object, **options: object) -> None:
        self.inbox.append(act)

    def complain(self, text: str, client: object = None) -> None:
        self.told.append(text)

    def apply(self, what: Change, client: object) -> bool:
        self.made.append(what)
        self.review = change(self.review, what)[0]
        return True


class Desk:
    """The part with a lane that only notes what it is told."""

    def __init__(self) -> None:
        review = new_review(load_design("five-bar"))
        plan = (("on", True), ("way", "rest-to-rest"), ("samples", 11), ("rates", (0.3, 0.4)))
        self.stage = Stage(change(review, SetPlan(plan))[0])
        self.part = TrajectoryPart(self.stage)  # type: ignore[arg-type]
        self.wanted: list[Job] = []
        lane: Any = SimpleNamespace(want=self._want, cancel=lambda: None)
        self.part.lanes["trajectory"] = lane
        self.part.follow()

    def _want(self, jobs: list[Job]) -> None:
        self.wanted = list(jobs)

    @property
    def kinds(self) -> list[str]:
        """What is wanted, each by the name of its question."""
        return [job.function.__name__ for job in self.wanted]

    def set(self, **values: Any) -> None:
        self.stage.apply(SetPlan(tuple(values.items())), None)
        self.part.follow()

    def do(self, job: Job) -> None:
        self.part.take(Done(job, job.function(*job.arguments)))

    def shown(self) -> Moved:
        return self.part._moved()


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_the_trajectory_comes_first_then_its_distances_then_what_they_tell(desk: Desk) -> None:
    assert desk.kinds == ["compute"]
    assert desk.shown().stale
    desk.do(desk.wanted[0])
    assert set(desk.kinds) == {"distances"}
    assert desk.shown().share == 0.0
    for job in list(desk.wanted):
        desk.do(job)
    assert desk.shown().share == 1.0
    assert desk.kinds == ["judged"]
    desk.do(desk.wanted[0])
    assert desk.wanted == []
    moved = desk.shown()
    assert moved.computed is not None
    assert np.isfinite(moved.computed.found.distance).all()


def test_what_was_asked_before_is_nothing_any_more(desk: Desk) -> None:
    old = desk.wanted[0]
    desk.set(duration=3.0)
    desk.do(old)
    assert desk.shown().computed is None
    desk.do(desk.wanted[0])
    late = desk.wanted[0]
    desk.set(duration=4.0)
    desk.part.take(Done(late, np.zeros(6)))
    assert desk.shown().stale
    assert desk.kinds == ["compute"]


def test_polynomials_of_another_degree_are_asked_for_and_nothing_else(desk: Desk) -> None:
    desk.do(desk.wanted[0])
    desk.part.measure(on=False)
    assert desk.wanted == []
    desk.set(degree=4)
    (job,) = desk.wanted
    desk.do(job)
    fits = desk.shown().fits
    assert fits is not None
    assert fits.degree == 4
    desk.set(degree=5)
    assert desk.shown().fits is None
    desk.part.take(Lost(desk.wanted[0], "too few samples"))
    assert desk.shown().fit_trouble == "too few samples"
    desk.part.measure(on=True)
    assert desk.wanted


def test_a_failure_is_told_and_nothing_old_stays(desk: Desk) -> None:
    desk.do(desk.wanted[0])
    desk.set(duration=3.0)
    desk.part.take(Lost(desk.wanted[0], "no path"))
    assert desk.shown().trouble == "no path"
    assert desk.shown().computed is None
    desk.set(way="straight")
    assert "To here" in desk.shown().missing


def test_playing_moves_pictures_and_stopping_moves_the_machine(desk: Desk) -> None:
    desk.part.playing.play()
    assert desk.stage.told == ["There is no trajectory to play yet."]
    desk.do(desk.wanted[0])
    home = desk.stage.review.pose
    desk.part.playing.play()
    assert desk.part.late
    assert desk.stage.made == []
    desk.part.playing.scrub(1.25)
    shown = desk.part.shown(desk.stage.view)
    computed = desk.part.current
    assert computed is not None
    assert shown.posture.pose == computed.pose_at(1.25)
    assert shown.review.pose == home
    assert desk.part.playing.stop_here()
    assert desk.stage.made == [Place(computed.pose_at(1.25), gesture="")]
    desk.part.follow()
    assert desk.part.shown(desk.stage.view).posture.pose == desk.stage.review.pose


def test_whoever_moves_the_machine_has_it(desk: Desk) -> None:
    desk.do(desk.wanted[0])
    desk.part.playing.play(on=True)
    desk.stage.apply(Place((10.0, 700.0)), None)
    desk.part.follow()
    assert desk.part.shown(desk.stage.view).posture.pose == (10.0, 700.0)
    assert not desk.part.playing.player.playing
    desk.part.playing.scrub(0.5)
    assert desk.part.playing.go_back()
    assert desk.part.shown(desk.stage.view).posture.pose == (10.0, 700.0)


def test_warnings_are_gone_through_and_limits_kept(desk: Desk) -> None:
    desk.do(desk.wanted[0])
    computed = desk.part.current
    assert computed is not None
    starts = [event.start for event in computed.found.events]
    desk.part.playing.to_warning()
    assert desk.part.playing.player.phase == pytest.approx(starts[0])
    desk.part.shorten()
    desk.part.follow()
    assert desk.stage.review[Plan].duration > 2.0
    desk.do(desk.wanted[0])
    found = desk.part.current
    assert found is not None
    worst = found.found.largest("rate")[0] / np.array([0.3, 0.4])
    assert worst.max() == pytest.approx(1.0, rel=1e-5)
    desk.set(rates=())
    desk.do(desk.wanted[0])
    desk.part.playing.to_warning()
    desk.part.shorten()
    assert desk.stage.told[-2].startswith("Nothing is wrong")
    assert desk.stage.told[-1].startswith("Give limits")


def test_the_cursor_is_where_the_machine_is(desk: Desk) -> None:
    desk.do(desk.wanted[0])
    part, computed = desk.part, desk.part.current
    assert computed is not None
    home = desk.stage.review
    part.playing.scrub(1.25)
    part.playing.stop_here()
    part.follow()
    assert part.playing.player.at(0.0) == 1.25  # it stands there now
    assert part.playing.stands_at(1.25)
    # Put there again: nothing changes, and nothing is left to go back to.
    part.playing.play(on=True)
    part.playing.play(on=False)
    part.playing.scrub(1.25)
    part.playing.stop_here()
    part.follow()
    assert not part.playing.away
    # Undo: it stands where it was, which is not on the way at that time.
    desk.stage.review = home
    part.follow()
    assert part.playing.player.at(0.0) == 0.0
    # Back to where it was; another path.
    part.playing.scrub(0.75)
    part.playing.go_back()
    assert part.playing.player.at(0.0) == 0.0
    part.playing.scrub(0.5)
    desk.set(way="line")
    desk.do(desk.wanted[0])
    assert part.playing.player.at(0.0) == 0.0
    assert not part.playing.away


def test_the_machine_is_not_put_beside_its_way(desk: Desk) -> None:
    desk.set(way="straight", start=(0.0, 804.0), end=(0.0, 3000.0))
    desk.do(desk.wanted[0])
    computed = desk.part.current
    assert computed is not None
    desk.part.playing.scrub(0.6 * computed.law.duration)
    made = list(desk.stage.made)
    assert not desk.part.playing.settle(None, asked=False)
    assert desk.stage.told == []
    assert not desk.part.playing.stop_here()
    assert desk.stage.told == ["The machine cannot be put there: y is kept within −960 … 960 mm."]
    assert desk.stage.made == made
    assert desk.part.playing.away  # and is still shown there


def test_playing_stops_at_singularities_and_goes_on_from_there(desk: Desk) -> None:
    desk.set(way="straight", start=(0.0, 804.0), end=(0.0, 300.0), samples=51, rates=())
    desk.do(desk.wanted[0])
    part, computed = desk.part, desk.part.current
    assert computed is not None
    (met,) = {e.start for e in computed.found.events if e.kind == "singularity"}
    assert computed.pose_at(met)[1] == pytest.approx(np.sqrt(480.0**2 - 240.0**2), abs=1e-3)
    part.playing.play(on=True)
    begun = part.playing.player.since
    assert begun is not None
    for step in np.linspace(0.0, 0.9 * computed.law.duration, 40):  # pictures
        part.playing._halt(begun + step)
    assert not part.playing.player.playing
    assert part.playing.player.at(0.0) == met
    assert desk.stage.told[-1].startswith(f"Stopped at {met:.3f} s")
    part.playing.play(on=True)
    begun = part.playing.player.since
    assert begun is not None
    part.playing._halt(begun + 0.5 * (computed.law.duration - met))
    assert part.playing.player.playing
    desk.set(halt=False)
    part.playing.scrub(0.0)
    part.playing.play(on=True)
    begun = part.playing.player.since
    assert begun is not None
    part.playing._halt(begun + 0.99 * computed.law.duration)
    part.playing._halt(begun + 0.995 * computed.law.duration)
    assert part.playing.player.playing
    # On the way back of "to and fro", too.
    desk.set(halt=True, playback="swing")
    part.playing.player = part.playing.player.to(0.0).play(0.0)
    part.playing._played_to = 0.95 * computed.law.duration
    part.playing._halt(1.2 * computed.law.duration)
    part.playing._halt(2.0 * computed.law.duration - 0.9 * met)
    assert part.playing.player.at(0.0) == pytest.approx(met)
    assert part.playing.player.play(0.0).at(0.01) < met


def test_to_and_fro_goes_on_as_it_went() -> None:
    player = Player(2.0, "swing").play(0.0)
    back = player.pause(2.5)  # on its way back
    assert back.at(9.0) == pytest.approx(1.5)
    assert back.play(10.0).at(10.25) == pytest.approx(1.25)
    faster = player.paced("swing", 2.0, 2.5)
    assert faster.at(2.75) == pytest.approx(1.0)
    looped = player.paced("loop", 1.0, 2.5)
    assert looped.at(2.75) == pytest.approx(1.75)
    assert back.to(2.0).at(0.0) == 2.0


@pytest.mark.parametrize("value", [0.0123456789, 1.0, 1.2345601, 99.99999, 123456.7])
def test_durations_are_rounded_up(value: float) -> None:
    assert value < rounded_up(value) < value * (1.0 + 1.1e-5)


def test_a_stroke_asks_for_the_reach(desk: Desk) -> None:
    desk.set(way="stroke")
    assert desk.kinds == ["reach"]
    desk.do(desk.wanted[0])
    assert desk.shown().reach is not None
    desk.set(plane=("y", "x"))
    assert desk.shown().reach is None


def test_answers_come_back_from_the_process_as_they_are() -> None:
    import pickle

    review = Desk().stage.review
    of = compute.asked(review)
    assert isinstance(of, Asked)
    again = pickle.loads(pickle.dumps(compute.compute(of)))
    assert isinstance(again, Computed)
    assert again.asked == of
    assert not again.found.joints.flags.writeable


def test_a_straight_way_is_ended_where_it_leaves_the_workspace(desk: Desk) -> None:
    review = desk.stage.review
    here = review.machine.home.pose
    desk.set(way="straight", start=here, end=(here[0] + 900.0, *here[1:]))
    desk.do(desk.wanted[0])
    computed = desk.shown().computed
    assert computed is not None
    leaves = compute.leaves_at(computed)
    assert leaves is not None
    desk.part.cut()
    end = desk.stage.review[Plan].end
    assert review.machine.inverse.posture(end, review.mode).reachable
    np.testing.assert_allclose(end, computed.pose_at(leaves), atol=0.5)  # the event is as near
    beyond = np.array(end) + 1e-3 * (np.array(computed.pose_at(9e9)) - here) / 900.0
    assert not review.machine.inverse.posture(tuple(beyond), review.mode).reachable
    desk.part.follow()
    desk.do(desk.wanted[0])
    inside = desk.shown().computed
    assert inside is not None
    assert compute.leaves_at(inside) is None


def test_the_ends_of_a_way_are_a_table_that_tells_units_and_what_is_not_chosen() -> None:
    review = new_review(load_design("rpur-table1"))
    start = (326.0, 73.0, 211.0, 0.1, -0.2)
    text = ends_html([("start", start), ("end", ())], review.machine.coordinates)
    assert text.count("data-edit=") == 10
    assert 'data-edit="start.3" data-line="start.line" data-of="°" value="5.7296"' in text
    assert 'data-edit="end.0" data-line="end.line" data-of="mm" value=""' in text
    assert 'data-send="start"' in text
    assert 'data-send="end"' in text
