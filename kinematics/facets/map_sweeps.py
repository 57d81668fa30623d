"""Maps: what a mechanism offers at the points of a grid, computed on an executor handed in.

So the same sweep runs in one thread, on all cores or on a cluster. The points come coarse first: a
picture can be shown early and refined. What comes out at a point depends neither on the order nor
on the executor.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.sections import MapCells, Quantity
from kinematics.arrays import Array, Ints, finite
from kinematics.errors import BohemiaError, ComputationError, InputError
from kinematics.facets.facet import required
from kinematics.facets.maps import MapsFacet
from kinematics.mechanism import Coordinate, Design, mechanism_of

CHUNK = 8
"""Points in one task: a fraction of a second, so that one can stop, and more than its overhead."""

IN_FLIGHT = 16
"""Tasks handed to the executor at a time: enough for eight workers; the others can be withdrawn."""

ATTEMPTS = 3
"""How often a task is begun whose worker is lost before the map is given up."""

MOST_POINTS = 4_000_000
POLL = 0.1  # s between two looks at whether the sweep is cancelled

OnCells = Callable[[Ints, MapCells], None]


@dataclass(frozen=True, slots=True)
class MapRequest:
    """Everything that a map depends on, checked; built by `map_request`. Hashable, picklable.

    Attributes:
        quantities: what is wanted, in this order.
        pose: the coordinates that the map does not run over; those it does are replaced.
        axes: the indices of the first and of the second coordinate in a pose.
        first, second: their values, mm or rad.
        relative: how exact, as a fraction of each value.
    """

    design: Design
    modes: tuple[str, ...] | None
    quantities: tuple[Quantity, ...]
    pose: tuple[float, ...]
    axes: tuple[int, int]
    first: tuple[float, ...]
    second: tuple[float, ...]
    relative: float

    @property
    def shape(self) -> tuple[int, int]:
        """(n, m): how many values the first and the second coordinate take."""
        return len(self.first), len(self.second)

    @property
    def coordinates(self) -> tuple[Coordinate, Coordinate]:
        """The coordinates that the map runs over."""
        known = mechanism_of(self.design).pose_coordinates()
        return known[self.axes[0]], known[self.axes[1]]

    def poses(self, indices: Ints) -> Array:
        """The poses (N, P) at flat ``indices`` (N,), the second coordinate running fastest."""
        rows, columns = np.unravel_index(indices, self.shape)
        poses = np.tile(np.asarray(self.pose), (len(indices), 1))
        poses[:, self.axes[0]] = np.asarray(self.first)[rows]
        poses[:, self.axes[1]] = np.asarray(self.second)[columns]
        return poses


@dataclass(frozen=True, eq=False)
class Map:
    """A map, whole or as far as it came; arrays read-only.

    Attributes:
        request: what it is a map of.
        values: (Q, n, m), NaN where not done.
        errors: (Q, n, m) estimates from above of each value's error, NaN where not done.
        done: (n, m).
    """

    request: MapRequest
    values: Array
    errors: Array
    done: NDArray[np.bool_]

    def __post_init__(self) -> None:
        for array in (self.values, self.errors, self.done):
            array.setflags(write=False)

    @property
    def complete(self) -> bool:
        """Every point was computed."""
        return bool(self.done.all())


def map_request(
    design: Design,
    first: ArrayLike,
    second: ArrayLike,
    *,
    modes: Sequence[str] | None = None,
    quantities: Sequence[str] = ("volume",),
    relative: float = 1e-4,
    pose: Sequence[float] | None = None,
) -> MapRequest:
    """A map over the two coordinates that the mechanism's maps run over.

    Args:
        first, second: (n,) and (m,) values of the two coordinates, mm or rad.
        modes: working modes, None for all of them together.
        quantities: keys of the mechanism's `MapSpec`.
        relative: how exact, as a fraction of each value.
        pose: the other coordinates, where they matter; None for zero.

    Raises:
        InputError: the mechanism has no maps, or one of these is not what it must be.
    """
    kind = mechanism_of(design)
    facet: MapsFacet[Any] | None = kind.facet(MapsFacet.topic)
    if facet is None:
        raise InputError(f"a {kind.title} has no maps")
    spec = facet.spec
    coordinates = kind.pose_coordinates()
    values = [
        finite(given, name=f"the values of {coordinates[axis].symbol}")
        for given, axis in zip((first, second), spec.axes, strict=True)
    ]
    for given, axis in zip(values, spec.axes, strict=True):
        if given.ndim != 1 or not len(given):
            raise InputError(f"the values of {coordinates[axis].symbol} must be a list, not empty")
    count = len(values[0]) * len(values[1])
    if count > MOST_POINTS:
        raise InputError(f"a map of {count} points is too large; the most is {MOST_POINTS}")
    known = {quantity.key: quantity for quantity in spec.quantities}
    for key in quantities:
        if key not in known:
            raise InputError(f"there is no quantity {key!r}; it is one of {', '.join(known)}")
    if not quantities or len(set(quantities)) < len(quantities):
        raise InputError(f"name each wanted quantity once: some of {', '.join(known)}")
    if modes is not None and (not modes or not set(modes) <= set(kind.modes)):
        raise InputError("the working modes must be some of the mechanism's, or None for all")
    if not 0.0 < relative < 1.0:
        raise InputError(f"the relative tolerance must lie between 0 and 1, got {relative:g}")
    other = np.zeros(len(coordinates)) if pose is None else np.asarray(pose, dtype=float)
    if other.shape != (len(coordinates),) or not np.isfinite(other).all():
        raise InputError(f"the pose must be {len(coordinates)} finite numbers")
    return MapRequest(
        design=design,
        modes=None if modes is None else tuple(modes),
        quantities=tuple(known[key] for key in quantities),
        pose=tuple(other.tolist()),
        axes=spec.axes,
        first=tuple(values[0].tolist()),
        second=tuple(values[1].tolist()),
        relative=float(relative),
    )


def coarse_first(shape: tuple[int, int]) -> tuple[Ints, ...]:
    """The flat indices of a grid in levels: every 2^k-th point of both axes, then every 2^(k-1)-th.

    Each level holds the points that no coarser one has; the last is the rest.
    """
    step = 1
    while 2 * step < max(shape):
        step *= 2
    done = np.zeros(shape, dtype=bool)
    levels: list[Ints] = []
    while step >= 1:
        level = np.zeros(shape, dtype=bool)
        level[::step, ::step] = True
        levels.append(np.flatnonzero(level & ~done))
        done |= level
        step //= 2
    return tuple(level for level in levels if len(level))


def compute_cells(
    design: Design,
    poses: Array,
    modes: tuple[str, ...] | None,
    quantities: tuple[str, ...],
    relative: float,
) -> MapCells:
    """One task: the quantities at some points of a map, in whatever process this is called."""
    facet: MapsFacet[Any] | None = mechanism_of(design).facet(MapsFacet.topic)
    return required(facet, "map").cells(poses, modes, quantities, relative=relative)


def sweep(
    request: MapRequest,
    executor: Executor,
    *,
    chunk: int = CHUNK,
    in_flight: int = IN_FLIGHT,
    on_cells: OnCells | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Map:
    """Compute a map on an executor's workers.

    Args:
        executor: stays open; it is not asked how many workers it has.
        chunk: points in one task.
        in_flight: tasks handed to the executor at a time; two for each worker keep all busy.
        on_cells: called in this thread with flat indices (N,) and their values as they come.
        cancelled: asked every tenth of a second; if true the map is returned as far as it came.

    Raises:
        InputError: ``chunk`` or ``in_flight`` is less than 1.
        BohemiaError: a point's own failure.
        ComputationError: the executor lost its workers, or a task failed otherwise.
    """
    if chunk < 1 or in_flight < 1:
        raise InputError("a chunk holds at least one point, and at least one is in flight")
    values = np.full((len(request.quantities), request.shape[0] * request.shape[1]), np.nan)
    errors = values.copy()
    done = np.zeros(values.shape[1], dtype=bool)
    waiting = deque(
        (level[start : start + chunk], 1)
        for level in coarse_first(request.shape)
        for start in range(0, len(level), chunk)
    )
    running: dict[Future[MapCells], tuple[Ints, int]] = {}
    stop = cancelled or (lambda: False)
    try:
        while (waiting or running) and not stop():
            while waiting and len(running) < in_flight:
                indices, attempt = waiting.popleft()
                running[_submit(executor, request, indices)] = indices, attempt
            finished, _ = wait(running, timeout=POLL, return_when=FIRST_COMPLETED)
            for future in finished:
                indices, attempt = running.pop(future)
                cells = _cells(future, last=attempt == ATTEMPTS)
                if cells is None:
                    waiting.appendleft((indices, attempt + 1))
                    continue
                values[:, indices] = cells.values.T
                errors[:, indices] = cells.errors.T
                done[indices] = True
                if on_cells is not None:
                    on_cells(indices, cells)
    finally:
        for future in running:
            future.cancel()
    whole = (len(request.quantities), *request.shape)
    return Map(request, values.reshape(whole), errors.reshape(whole), done.reshape(request.shape))


def _submit(executor: Executor, request: MapRequest, indices: Ints) -> Future[MapCells]:
    keys = tuple(quantity.key for quantity in request.quantities)
    poses = request.poses(indices)
    try:
        return executor.submit(
            compute_cells, request.design, poses, request.modes, keys, request.relative
        )
    except (RuntimeError, OSError) as error:  # broken, shut down, or cut off
        raise ComputationError(f"the map cannot go on: {_said(error)}") from error


def _cells(future: Future[MapCells], *, last: bool) -> MapCells | None:
    """What a task gave; None if its worker was lost and it can be tried once more."""
    try:
        return future.result()
    except BohemiaError:
        raise
    except Exception as error:  # whatever a cluster may raise
        if not _lost(error):
            raise ComputationError(f"the map could not be computed: {_said(error)}") from error
        if last:
            raise ComputationError(
                f"the map was given up: its worker was lost {ATTEMPTS} times ({_said(error)})"
            ) from error
        return None


def _lost(error: BaseException) -> bool:
    """The worker failed, not the task: the processes died, or a connection did."""
    # One of Dask's own, as KilledWorker, is told by its module: it need not be installed here.
    lost = isinstance(error, BrokenExecutor | CancelledError | OSError | EOFError)
    return lost or type(error).__module__.partition(".")[0] == "distributed"


def _said(error: BaseException) -> str:
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
