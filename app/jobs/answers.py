"""Answers that are handed out only for the question that is asked now.

Whatever is computed beside the page's loop comes late, out of order or never. So every answer is
kept by the request that it answers, and a part reads it through the request that the present review
makes: an answer to another one cannot be taken for it. The newest of those can be had as
`Told.old`, to be shown as what it is: of before.
"""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from app.jobs.lane import Done, Job, Lane, Lost
from app.language import tr

_NOTHING: Mapping[Any, Any] = {}

A = TypeVar("A")


@dataclass(frozen=True, eq=False)
class Question(Generic[A]):
    """A kind of work: from a request, which is all that it depends on, to its answer.

    Attributes:
        title: the key of what a person reads while it takes long; "" for work with a progress bar
            of its own.
        lane: who does it.
        answer: called in the lane's process with the request, or with the arguments instead of it.
        rest, slow, tries: as in `Job`.
        urgent: its failure is told at once, not only where its answer would stand.
        kept: how many answers are kept for requests that are made again.
    """

    title: str
    lane: str
    answer: Callable[..., A]
    rest: float = 0.0
    slow: bool = False
    tries: int = 1
    urgent: bool = False
    kept: int = 8

    def __call__(
        self, request: Hashable, *arguments: Any, title: str = "", idle: bool = False
    ) -> Asked[A]:
        """The question about a request; ``arguments`` instead of it go to the process.

        If ``idle`` the answer is of use if it is there, and not worth any work now.
        """
        return Asked(
            self, request, arguments or (request,), title or (self.title and tr(self.title)), idle
        )


@dataclass(frozen=True, eq=False)
class Asked(Generic[A]):
    """A question about a request."""

    question: Question[A]
    request: Any
    arguments: tuple[Any, ...]
    title: str
    idle: bool


@dataclass(frozen=True)
class Key:
    """What a lane's job is known by; ``asked`` counts how often answers were forgotten."""

    question: Question[Any]
    request: Any
    asked: int


@dataclass(frozen=True, eq=False, slots=True)
class Told(Generic[A]):
    """What is known of a question.

    Attributes:
        now: the answer to the present request; None while there is none.
        old: the newest answer to another request, ``old_of``, while the present one is waited for.
        trouble: why there is none and will be none, for the user.
        given_up: there will be none.
        since: when the newest answer came, or was first of before, s.
    """

    now: A | None = None
    old: A | None = None
    old_of: Any = None
    trouble: str = ""
    given_up: bool = False
    since: float = 0.0

    @property
    def shown(self) -> A | None:
        """What to show: if ``now`` is None, as something of before."""
        return self.old if self.now is None else self.now

    @property
    def stale(self) -> bool:
        """What is shown is of before."""
        return self.now is None and self.old is not None


class Answers:
    """What came from some lanes."""

    def __init__(self, lanes: Mapping[str, Lane]) -> None:
        self._lanes = lanes
        self._asked: dict[Question[Any], dict[Hashable, Asked[Any]]] = {}
        self._kept: dict[Question[Any], OrderedDict[Hashable, Any]] = {}
        self._newest: dict[Question[Any], tuple[Any, Any, float]] = {}
        self._waiting: dict[Question[Any], float] = {}
        self._lost: dict[tuple[Question[Any], Hashable], str] = {}
        self._forgotten: dict[Question[Any], int] = {}

    def want(self, asked: Iterable[Asked[Any]]) -> None:
        """These are the questions from now on, the first to be answered first."""
        wanted = tuple(asked)
        self._asked = {}
        for each in wanted:
            self._asked.setdefault(each.question, {})[each.request] = each
        # What is asked again later is tried again.
        self._lost = {
            (question, request): text
            for (question, request), text in self._lost.items()
            if request in self._asked.get(question, ())
        }
        left = [each for each in wanted if not each.idle and not self.settled(each)]
        open_ = {each.question for each in left}
        now = time.monotonic()
        self._waiting = {question: self._waiting.get(question, now) for question in open_}
        for name, lane in self._lanes.items():
            lane.want([self._job(each) for each in left if each.question.lane == name])

    def take(self, event: Done | Lost) -> Asked[Any] | None:
        """Keep what came of a job; the question that it settles, if that is asked now."""
        key = event.job.key
        if not isinstance(key, Key) or key.question.lane not in self._lanes:
            return None  # another part's
        if key.asked != self._forgotten.get(key.question, 0):
            return None
        asked = self._asked.get(key.question, {}).get(key.request)
        if isinstance(event, Done):
            self.put(key.question, key.request, event.result)
        elif asked is not None:
            self._lost[key.question, key.request] = event.text
        return asked

    def put(self, question: Question[A], request: Hashable, answer: A) -> None:
        """Keep an answer."""
        kept = self._kept.setdefault(question, OrderedDict())
        kept[request] = answer
        self._newest[question] = request, answer, time.monotonic()
        kept.move_to_end(request)
        others = [old for old in kept if old not in self._asked.get(question, ())]
        for old in others[: max(len(others) - question.kept, 0)]:
            del kept[old]

    def forget(self, *questions: Question[Any]) -> None:
        """Know nothing of these any more, and ask for all of it again."""
        for question in questions:
            self._kept.pop(question, None)
            self._newest.pop(question, None)
            self._forgotten[question] = self._forgotten.get(question, 0) + 1
        self._lost = {key: text for key, text in self._lost.items() if key[0] not in questions}

    def kept(self, asked: Asked[A]) -> A | None:
        """The answer to a question that is about to be asked, if it is there already."""
        kept: A | None = self._kept.get(asked.question, _NOTHING).get(asked.request)
        return kept

    def given_up(self, asked: Asked[Any]) -> bool:
        """Whether a question that is asked will not be answered."""
        return (asked.question, asked.request) in self._lost

    def settled(self, asked: Asked[Any]) -> bool:
        """Whether nothing more will come to a question."""
        return asked.request in self._kept.get(asked.question, ()) or self.given_up(asked)

    def renew(self) -> None:
        """Another machine has come: nothing is of before."""
        self._newest.clear()

    def of(self, question: Question[A], request: Hashable) -> Told[A]:
        """What is known of a question about a request; nothing unless that is asked now."""
        if request not in self._asked.get(question, ()):
            return Told()
        kept = self._kept.get(question, _NOTHING)
        if request in kept:
            return Told(kept[request])
        trouble = self._lost.get((question, request))
        if trouble is not None:
            return Told(trouble=trouble, given_up=True)
        old_of, old, came = self._newest.get(question, (None, None, 0.0))
        since = max(came, self._waiting.get(question, 0.0))
        return Told(old=old, old_of=old_of, since=since)

    def __getitem__(self, question: Question[A]) -> Told[A]:
        """What is known of a question that is asked about one request; nothing if of none."""
        for request in self._asked.get(question, ()):
            return self.of(question, request)
        return Told()

    def _job(self, asked: Asked[Any]) -> Job:
        question = asked.question
        key = Key(question, asked.request, self._forgotten.get(question, 0))
        return Job(
            key,
            asked.title,
            question.answer,
            asked.arguments,
            question.rest,
            question.slow,
            question.tries,
        )
