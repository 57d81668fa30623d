"""What a person may ask for that does not change the review: plain values for the page's loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    import viser


@dataclass(frozen=True, slots=True)
class VisitSolution:
    """Go to a solution of the list, by its number."""

    identity: int
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class FindAgain:
    """Forget the solutions and find them all from scratch."""


@dataclass(frozen=True, slots=True)
class RedrawSolutions:
    """The list is to be drawn again, as when it shows more of itself."""


@dataclass(frozen=True, slots=True)
class ChooseFold:
    """Tell of the fold of this actuator, as it grows or shrinks."""

    index: int
    longer: bool


@dataclass(frozen=True, slots=True)
class Inscribe:
    """Find the largest ball or box in the workspace, about the platform or anywhere."""

    what: Literal["ball", "box"]
    here: bool


@dataclass(frozen=True, slots=True)
class Forget:
    """Take the ball and the box off display."""


@dataclass(frozen=True, slots=True)
class GoToBall:
    """Put the platform into the middle of the largest ball, at its present orientation.

    The working mode changes if the present one does not get there.
    """

    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class SaveSection:
    """Save the section as a file of this kind."""

    kind: str
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class StartMap:
    """Compute the map that is chosen."""

    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class StopMap:
    """Give up the map that is being computed."""


@dataclass(frozen=True, slots=True)
class SaveMap:
    """Save the map as a file of this kind."""

    kind: str
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class FindFree:
    """Find the largest ball without a singularity, about the platform or anywhere.

    With None it is taken off display.
    """

    here: bool | None
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class GoToFree:
    """Put the platform into the middle of that ball."""

    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class Escape:
    """Go to the nearest posture that can be held."""

    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class ChangeDesign:
    """Change the design so that the pose can be held, in the way of this number."""

    way: int
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class Swing:
    """Show the free motion of the singularity of this number."""

    which: int


@dataclass(frozen=True, slots=True)
class SaveLoci:
    """Save the chart's curves as a file of this kind."""

    kind: str
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class SaveRegions:
    """Save the plane regions on display as a file of this kind."""

    kind: str
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class ClearLog:
    """Forget what happened on the way."""


@dataclass(frozen=True, slots=True)
class Play:
    """Play the trajectory, or pause; None for the other of the two."""

    on: bool | None = None


@dataclass(frozen=True, slots=True)
class Scrub:
    """Show the machine at this time of the trajectory, s, and put it there when the hand rests."""

    at: float
    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class StopHere:
    """Put the machine where the trajectory shows it."""

    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class LeaveWay:
    """Show the machine where the review has it, and not on its trajectory any more."""


@dataclass(frozen=True, slots=True)
class NextWarning:
    """Show the machine at the next place of the trajectory where something is wrong."""

    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class Distances:
    """Find the trajectory's distances to singularities, or give that up."""

    on: bool


@dataclass(frozen=True, slots=True)
class Shortest:
    """Choose the shortest duration that keeps the limits of rates and accelerations."""

    client: viser.ClientHandle | None = None


@dataclass(frozen=True, slots=True)
class SaveTrajectory:
    """Save the trajectory as CSV, or its plots as SVG."""

    kind: str
    client: viser.ClientHandle | None = None


Request = (
    VisitSolution
    | FindAgain
    | RedrawSolutions
    | ChooseFold
    | Inscribe
    | Forget
    | GoToBall
    | SaveSection
    | StartMap
    | StopMap
    | SaveMap
    | FindFree
    | GoToFree
    | Escape
    | ChangeDesign
    | Swing
    | SaveLoci
    | SaveRegions
    | ClearLog
    | Play
    | Scrub
    | StopHere
    | LeaveWay
    | NextWarning
    | Distances
    | Shortest
    | SaveTrajectory
)
