"""How far the platform may move, and the ways out of a pose that cannot be held: plain results.

Lengths mm, angles rad, base frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from kinematics.answers.solutions import Posture

ClearanceKind = Literal["parallel", "constraint", "boundary", "stroke", "mode"]


@dataclass(frozen=True, slots=True)
class Clearance:
    """How far the platform may move, at its orientation, until something happens.

    Attributes:
        kind: a parallel or constraint singularity; the boundary of the workspace; an end of a
            limb's stroke; the change of a limb's working mode (its serial singularity).
        distance: mm; negative where it has happened: so far is the way back.
        point: (x, y, z) of O′ there.
        text: one sentence for the user.
        limb: from 1, of strokes, modes and the boundary.
        bound: "rho_min", "rho_max" or "link", likewise.
        error: mm, an estimate from above of the error of ``distance``.
        angle: rad, where the way is a turn; ``distance`` is then about that of the platform's
            joints.
        along: the only line that the orientation leaves, as "along z"; "" where all ways count.
    """

    kind: ClearanceKind
    distance: float
    point: tuple[float, float, float]
    text: str
    limb: int | None = None
    bound: str = ""
    error: float = 0.0
    angle: float | None = None
    along: str = ""


@dataclass(frozen=True, slots=True)
class DesignChange:
    """A change of one number of the design; ``path`` as in `mechanism.DesignField`."""

    path: tuple[str | int, ...]
    label: str
    before: float
    after: float
    text: str


DesignChanges = tuple[tuple[DesignChange, ...], ...]
"""For each way, the changes that together are enough."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """The ways out of a pose that cannot be held.

    Attributes:
        nearest: the nearest posture that can be held, at the same orientation and mode if there is
            one; None where there is none.
        distance: mm from the pose to there, by the position of O′ alone.
        changes: for each way, the smallest changes of the design that together would allow the
            pose, one of each limb at fault; the way with the smallest sum first. Empty where none
            would.
        text: one sentence for the user.
        modes: other modes in which the very pose can be held.
        error: mm, an estimate from above of how much nearer another posture may be; infinite where
            the nearest was searched for and not proven.
    """

    nearest: Posture | None
    distance: float
    changes: DesignChanges
    text: str
    modes: tuple[str, ...] = ()
    error: float = 0.0
