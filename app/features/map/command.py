"""`bohemia map`: what the workspace is like over all orientations."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress, said
from app.terminal.options import DESIGN, MODES, Modes, option, output, tolerance
from kinematics.errors import InputError

if TYPE_CHECKING:
    from types import FrameType

    from kinematics.answers.sections import MapCells, MapSpec
    from kinematics.arrays import Array, Ints
    from kinematics.facets.map_sweeps import Map
    from kinematics.machine import Machine

RANGE = "-90:90:37"  # every 5°


def _quantities(option: str, text: str, machine: Machine[Any]) -> list[str]:
    """The volume first, whatever else is wanted."""
    known = [quantity.key for quantity in _spec(machine).quantities]
    wanted = [word.strip().lower().replace("-", "_") for word in text.split(",")]
    for word in wanted:
        if word not in (*known, "all"):
            raise InputError(
                f"{option}: there is no {word!r}; it is one of {', '.join(known)}, or 'all'"
            )
    return [key for key in known if key == "volume" or {key, "all"} & set(wanted)]


def _spec(machine: Machine[Any]) -> MapSpec:
    if machine.map_spec is None:
        raise InputError(f"{machine.design.name}: a {machine.title} has no maps")
    return machine.map_spec


@command("map", coordinates=True)
def chart(
    machine: Machine[Any] = DESIGN,
    modes: Modes = MODES,
    quantity: list[str] = option(
        "NAMES",
        "beside the volume, with commas: pieces, largest_piece, sphere, stroke, or all",
        _quantities,
        known=lambda machine: [*(quantity.key for quantity in _spec(machine).quantities), "all"],
        default="volume",
    ),
    tolerance: float = tolerance("1e-04"),
    jobs: int | None = option(
        "N",
        "processes on this machine (default: one a core)",
        values.counted("a number of processes", 1, 1024),
    ),
    scheduler: str | None = option(
        "tcp://HOST:PORT", "compute on the Dask cluster of this scheduler instead"
    ),
    output: Output = output(".csv, .npz, .png or .svg"),
) -> Answer:
    """The workspace's volume over all orientations.

    As Figs. 20 and 21 of Tale Masouleh et al. (2011). It runs over --phi and --theta a:b:n, n
    values from a to b, degrees, or one angle (default -90:90:37); of another mechanism over the two
    coordinates that its maps have. Ctrl-C stops it and keeps what is done.
    """
    from app.features.map import files
    from app.jobs import executors
    from kinematics.facets import map_sweeps
    from kinematics.mechanism import mechanism_class

    kind = output.kind(files.FORMATS, "a map")
    if jobs is not None and scheduler is not None:
        raise InputError("--jobs is for this machine, --scheduler for a cluster; give one of them")
    typed, axes = said(), [machine.coordinates[n] for n in _spec(machine).axes]
    keys = [axis.json_key for axis in axes]
    for key in typed.keys() - {axis.key for axis in axes}:
        raise InputError(f"--{key}: the map runs over --{' and --'.join(a.key for a in axes)}")
    spans = [values.span(f"--{a.key}", typed.get(a.key, RANGE), RANGE) for a in axes]
    grid = [[axis.inner(value) for value in row] for row, axis in zip(spans, axes, strict=True)]
    request = map_sweeps.map_request(
        machine.design, *grid, modes=modes, quantities=quantity, relative=tolerance
    )
    prepare = mechanism_class(machine.design.mechanism).prepare
    began = time.monotonic()
    with ExitStack() as stack:
        interrupted = stack.enter_context(_interruptible())
        show = stack.enter_context(progress("Map: the processes start"))
        workers = stack.enter_context(
            executors.local_workers(jobs, meanwhile=prepare)
            if scheduler is None
            else executors.dask_workers(scheduler)
        )

        def cancelled() -> bool:
            workers.check()
            return interrupted()

        found = map_sweeps.sweep(
            request,
            workers.executor,
            in_flight=2 * workers.count,
            on_cells=_counting(request.shape[0] * request.shape[1], show),
            cancelled=cancelled,
        )
    seconds = time.monotonic() - began
    done, points = int(found.done.sum()), found.done.size
    if kind and done:
        output.write(files.map_bytes(found, kind))
    kept = f"; {output.written} holds those" if output.written else ""
    stopped = "" if found.complete else f"stopped after {done} of {points} orientations{kept}"
    lines = _lines(machine, found, seconds) if done else ["Nothing is done."]
    data = {
        **tables.modes_entry(modes),
        **dict(zip(keys, files.axis_values(request), strict=True)),
        **{
            name: tables.plain(grid)  # null where a point was not done
            for names, *both in zip(files.columns(request), found.values, found.errors, strict=True)
            for name, grid in zip(names, both, strict=True)
        },
        "points": points,
        "done": done,
        "seconds": seconds,
    }
    return Answer(data, lines, stopped)


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """The first Ctrl-C asks to stop after the cells at work, the second one stops."""
    came: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        came.append(number)
        signal.signal(number, signal.default_int_handler)

    before = signal.signal(signal.SIGINT, note)
    try:
        yield partial(bool, came)
    finally:
        signal.signal(signal.SIGINT, before)


def _counting(points: int, show: Callable[[str], None]) -> Callable[[Ints, MapCells], None]:
    """Shows how far the map is and how long it will take."""
    times: list[tuple[float, int]] = []  # when, and how many were done then

    def count(indices: Ints, cells: MapCells) -> None:
        done = len(indices) + (times[-1][1] if times else 0)
        times.append((time.monotonic(), done))  # until the first they were only starting
        (since, before), (now, _) = times[0], times[-1]
        each = (now - since) / (done - before) if done > before else 0.0
        rest = f", {each * (points - done):.0f} s left" if each else ""
        show(f"Map: {done} of {points}{rest}")

    return count


def _lines(machine: Machine[Any], found: Map, seconds: float) -> list[str]:
    """Each quantity's extremes and where they are, as a table."""
    import numpy as np

    from app.features.map import files

    request, axes = found.request, found.request.coordinates
    first, second = files.axis_values(request)

    def extreme(grid: Array, flat: int) -> tuple[str, str]:
        i, j = divmod(flat, grid.shape[1])
        return f"{grid[i, j]:.6g}", tables.with_units([first[i], second[j]], axes)

    rows = []
    for quantity, grid in zip(request.quantities, found.values, strict=True):
        if np.isnan(grid).all():
            continue
        unit = f" ({quantity.unit})" if quantity.unit else ""
        least = extreme(grid, int(np.nanargmin(grid)))
        most = extreme(grid, int(np.nanargmax(grid)))
        rows.append((f"{quantity.title}{unit}", *least, *most, f"{np.nanmean(grid):.6g}"))
    spans = (
        f"{axis.symbol} from {shown[0]:g}° to {shown[-1]:g}°"
        for axis, shown in zip(axes, (first, second), strict=True)
    )
    n, m = request.shape
    error = tables.volume_text(float(np.nanmax(found.errors[0])))
    return [
        ", ".join([*spans, tables.modes_text(request.modes, machine.mode_noun)]),
        "",
        tables.table(("", "least", "at", "most", "at", "mean"), rows),
        "",
        f"{n} × {m} orientations in {tables.seconds_text(seconds)}; volumes ± {error} at most",
    ]
