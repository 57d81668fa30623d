"""What a map depends on, and what is known of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.features.map.state import Chart, Span
from app.features.workspace.state import solver_modes
from app.jobs.answers import Question
from app.review.state import Review
from kinematics.answers.sections import MapCells
from kinematics.arrays import Array, Ints
from kinematics.facets.map_sweeps import Map, MapRequest, map_request


@dataclass(frozen=True, eq=False, slots=True)
class Charted:
    """The map as panels draw it.

    Attributes:
        map: of the chosen quantity, if something is known of it, else the newest one.
        of: tells apart what maps are of.
        stale: it is of another design or of other working modes.
        running: the title of what is being computed, "" for nothing; ``share`` of it is done
            after ``seconds``.
        trouble: why the last one was given up.
    """

    map: Map | None
    of: object
    stale: bool
    running: str
    share: float
    seconds: float
    trouble: str


class Known:
    """What is known of a map of one quantity."""

    def __init__(self, request: MapRequest) -> None:
        self.request = request
        self.values: Array = np.full(request.shape, np.nan)
        self.errors: Array = np.full(request.shape, np.nan)
        self.done: NDArray[np.bool_] = np.zeros(request.shape, dtype=bool)

    def take(self, indices: Ints, cells: MapCells) -> None:
        """Some points have come."""
        self.values.flat[indices] = cells.values[:, 0]
        self.errors.flat[indices] = cells.errors[:, 0]
        self.done.flat[indices] = True

    def map(self) -> Map:
        """The map as far as it is known."""
        return Map(
            self.request, self.values[None].copy(), self.errors[None].copy(), self.done.copy()
        )


def of(request: MapRequest, review: Review) -> bool:
    """Whether a map is of a review's design and working modes."""
    return request.design == review.design and request.modes == solver_modes(review)


def chart_request(review: Review) -> MapRequest:
    """The map that a review asks for.

    Raises:
        InputError: its mechanism has none.
    """
    chart = review[Chart]
    return map_request(
        review.design,
        values(chart.first),
        values(chart.second),
        modes=solver_modes(review),
        quantities=(chart.quantity,),
        pose=review.pose,
    )


def same_places(old: MapRequest, new: MapRequest) -> bool:
    """Whether two maps are of the same workspaces, be it of another quantity."""
    return replace(old, quantities=new.quantities, pose=new.pose) == new


def key_of(review: Review) -> tuple[object, ...]:
    """What a map answers: a quantity of a design in some modes."""
    return review.design, solver_modes(review), review[Chart].quantity


def values(span: Span) -> Array:
    """The values of a span (n,)."""
    return np.linspace(span.low, span.high, span.count)


# Put together from cells, and never asked for.
MAP = Question("", "maps", Known)
