"""What a feature does on the page's loop: asks for what the review wishes, and shows what came."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, ClassVar, ParamSpec, Protocol, TypeVar

from app.jobs.answers import Answers, Asked, Key, Told
from app.jobs.lane import Done, Lane, Lost

if TYPE_CHECKING:
    from app.features.review.files import ExportedFile
    from app.review.changes import Change
    from app.review.keeping import Keeper
    from app.review.state import Review
    from app.review.view import View
    from app.scene.camera import Camera
    from app.scene.machine import Scene
    from app.scene.pointer import Pointer
    from app.widgets.desk import Sheet
    from kinematics.arrays import Array

AGED = 0.4  # s after which the scene shows that something is of before

Client = Any
"""Whose browser it is that something was asked in; None for nobody's in particular."""
A = ParamSpec("A")
P = TypeVar("P")


class Grip:
    """Whose hands hold something in the scene; one grip is one step of undo.

    Attributes:
        number: of the newest grip.
    """

    def __init__(self) -> None:
        self._hands: set[int] = set()
        self.number = 0

    @property
    def held(self) -> bool:
        """Somebody holds it, and decides where it is."""
        return bool(self._hands)

    def take(self, phase: str, client_id: int | None) -> bool:
        """A hand moves it, or with the phase "end" lets it go: then false."""
        who = -1 if client_id is None else client_id
        if phase == "end":
            self._hands.discard(who)
            return False
        self.number += not self._hands
        self._hands.add(who)
        return True


class Room(Protocol):
    """What panels and parts may both ask of the page; none of it blocks."""

    def part(self, kind: type[P]) -> P:
        """A part; of a part one that comes before."""

    def ask(self, act: Callable[A, object], *arguments: A.args, **options: A.kwargs) -> None:
        """Have the loop call this; the page is brought to the review if it returns True."""

    def fit_view(self) -> None: ...
    def complain(self, text: str, client: Client = None) -> None: ...
    def download(self, file: ExportedFile, client: Client) -> None: ...


class Stage(Room, Protocol):
    """The page as its parts see it; all of it on the loop's thread, but for `put`."""

    @property
    def server(self) -> Any: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def keeper(self) -> Keeper | None: ...
    @property
    def view(self) -> View:
        """What is shown, of the review that was brought to the page last."""

    @property
    def review(self) -> Review:
        """The present one, be it not on the page yet."""

    def sheet(self) -> Sheet: ...
    def run_script(self, source: str, client: Client) -> None:
        """Have one browser run a script."""

    def turn(self, camera: Camera, client: Client) -> None:
        """Have one browser look from there."""

    def tell(self, news: object, view: View | None = None) -> None:
        """Hand something to the panels that show it, with the view that it is of."""

    def note(self, text: str) -> None:
        """Something that stands in the status until the next change."""

    def shown(self) -> View:
        """The view with the machine where it is to be seen now."""

    def show_machine(self) -> None:
        """Bring the machine in the scene there."""

    def put(self, item: object) -> None:
        """Put something into the inbox."""

    def apply(self, change: Change, client: Client) -> bool: ...
    def apart(self, client: Client, act: Callable[[], None]) -> None: ...


class Part:
    """One feature on the loop, which alone calls its methods.

    What a person asks of it, rather than of the review, are further methods of it; they return
    True when the page has to be brought to the review.
    """

    LANES: ClassVar[tuple[str, ...]] = ()
    DRAWN_LAST: ClassVar[bool] = False  # its nodes are translucent, and others are within them
    ASKS_FIRST: ClassVar[bool] = False  # a hand waits for its answers

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.lanes = {name: self.lane(name) for name in self.LANES}
        self.answers = Answers(self.lanes)
        self.late = False  # something of it is to be drawn as soon as there is time
        self._age_at: float | None = None

    # --- what parts are made of

    def lane(self, name: str) -> Lane:
        """A lane of its own."""
        return Lane(name, self.stage.put)

    def prepare(self) -> None:
        """Make its scene nodes, for another machine; the page has been cleared."""

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        """What is to be known for a review, the first to be answered first."""
        return ()

    def save(
        self, of: P | None, make: Callable[[P], ExportedFile], client: Client, missing: str = ""
    ) -> None:
        """Make a file of something where nobody waits for it, and have it downloaded; with None it
        is told that it is ``missing``.
        """
        if of is None:
            self.stage.complain(missing, client)
        else:
            self.stage.apart(client, lambda: self.stage.download(make(of), client))

    def came(self, asked: Asked[Any], answer: Any) -> bool:
        """A question of the present review was answered; as above."""
        return False

    def lost(self, asked: Asked[Any]) -> None:
        """A question of the present review was given up."""

    def show(self, sheet: Sheet) -> None:
        """Bring scene and panels to what is known."""

    def applied(self, change: Change, before: Review, note: str, client: Client) -> None:
        """A person's change was taken, with this to say; the review was ``before``."""

    def joined(self, client: Client) -> None:
        """A browser has come."""

    def left(self) -> None:
        """A browser has gone."""

    def pointed(self, pointer: Pointer) -> None:
        """A person's pointer is somewhere else in the scene, or another tab is open."""

    def seen(self, view: View) -> View:
        """The view of a review with what the feature adds to it; the same as a rule."""
        return view

    def shown(self, view: View) -> View:
        """The view that the scene shows, be it on the way to this one; the same as a rule."""
        return view

    @property
    def covered(self) -> float:
        """px at the foot of the scene over which it shows something."""
        return 0.0

    @property
    def covered_left(self) -> float:
        """px at the left of the scene over which it shows something."""
        return 0.0

    @property
    def points(self) -> Array | None:
        """Points (N, 3) mm of what it shows that are to be seen all; None as a rule."""
        return None

    @property
    def due(self) -> float | None:
        """s until it has to do something; None while it has not."""
        if self.late:
            return 0.0
        return None if self._age_at is None else max(self._age_at - time.monotonic(), 0.0)

    def aged(self, told: Told[Any]) -> bool:
        """Whether what is shown has been of before for so long that the scene is to show it."""
        if not told.stale:
            return False
        at = told.since + AGED
        if time.monotonic() >= at:
            return True
        self._age_at = at if self._age_at is None else min(self._age_at, at)
        return False

    # --- what the loop does with them

    def start(self) -> None:
        """Start what computes."""
        for lane in self.lanes.values():
            lane.start()

    def stop(self) -> None:
        """End it."""
        for lane in self.lanes.values():
            lane.stop()

    def cancel(self, lane: str) -> None:
        """Give up what a lane is busy with."""
        self.lanes[lane].cancel()

    def follow(self) -> None:
        """The review may have changed."""
        self.ask()
        self.late = True

    def ask(self) -> None:
        """Ask for what is wished now."""
        self.answers.want(self.wished(self.stage.view))

    def take(self, event: Done | Lost) -> bool:
        """Something came from one of its lanes; true when the page has to change."""
        asked = self.answers.take(event)
        if asked is None:
            return False
        self.late = True
        redraw = False
        if isinstance(event, Lost):
            self.lost(asked)
            if event.text and asked.question.urgent:
                self.stage.complain(event.text)
                self.stage.note(event.text)  # whoever opens the page later reads it too
        else:
            redraw = self.came(asked, event.result)
        self.ask()  # more may be asked now
        return redraw

    def awaits(self, item: object) -> bool:
        """Whether something in the loop's inbox came from one of its lanes."""
        if not isinstance(item, Done | Lost):
            return False
        key = item.job.key
        return isinstance(key, Key) and key.question.lane in self.lanes

    def catch_up(self) -> None:
        """Draw what is late, after everything else."""
        if self._age_at is not None and time.monotonic() >= self._age_at:
            self._age_at, self.late = None, True
        if not self.late:
            return
        self.late = False
        with self.stage.server.atomic():
            self.show(self.stage.sheet())
        self.stage.server.flush()
