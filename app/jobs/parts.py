"""The parts of the page that compute beside its loop, and what they may ask of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from app.features.review.files import ExportedFile
from app.jobs.worker import LaneName
from app.review.changes import Change
from app.review.state import Review
from app.review.view import View
from app.scene.machine import Scene

if TYPE_CHECKING:
    import viser

    from app.widgets.desk import Panel, Sheet


class Stage(Protocol):
    """The page as its parts see it; all of it on the loop's thread, but for `put`."""

    @property
    def server(self) -> viser.ViserServer: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def view(self) -> View: ...
    @property
    def panels(self) -> Sequence[Panel]: ...
    def sheet(self) -> Sheet: ...
    def put(self, item: object) -> None: ...
    def apply(self, change: Change, client: viser.ClientHandle | None) -> bool: ...
    def complain(self, text: str, client: viser.ClientHandle | None = None) -> None: ...
    def download(self, file: ExportedFile, client: viser.ClientHandle | None) -> None: ...
    def apart(self, client: viser.ClientHandle | None, act: Callable[[], None]) -> None: ...


class Part(Protocol):
    """One line of work beside the loop; its methods are called by the loop alone."""

    lanes: tuple[LaneName, ...]

    @property
    def late(self) -> bool:
        """Whether something is to be drawn as soon as there is time."""

    def start(self) -> None:
        """Start what computes."""

    def stop(self) -> None:
        """End it."""

    def cancel(self, lane: LaneName) -> None:
        """Give up what a lane is busy with."""

    def prepare(self) -> None:
        """Make its scene nodes; the solids', which are made later, are drawn after them."""

    def follow(self) -> None:
        """The review may have changed, and everything else has been brought to it."""

    def applied(self, change: Change, before: Review, note: str) -> None:
        """A person's change was taken, with this to say; the review was ``before``."""

    def take(self, item: Any) -> bool:
        """Something from the inbox, perhaps not of this part; true when the page has to change."""

    def catch_up(self) -> None:
        """Bring its own up to date, after everything else."""
