"""`bohemia map`: what the workspace is like over all orientations."""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from app.terminal import common, tables
from kinematics.errors import InputError

if TYPE_CHECKING:
    from types import FrameType

    from kinematics.answers.sections import MapCells, MapSpec
    from kinematics.arrays import Array, Ints
    from kinematics.facets.map_sweeps import Map

RANGE = "-90:90:37"  # every 5°
TOLERANCE = 1e-4


def register(command: common.AddCommand) -> None:
    chart = command("map", _map, "The workspace's volume over φ and θ (Figs. 20 and 21).")
    common.add_design(chart)
    for name in ("phi", "theta"):
        chart.add_argument(
            f"--{name}",
            default=RANGE,
            metavar="a:b:n",
            help="n values from a to b, degrees, or one angle (default %(default)s)",
        )
    common.add_modes(chart)
    chart.add_argument(
        "--quantity",
        default="volume",
        metavar="NAMES",
        help="beside the volume, with commas: pieces, largest_piece, sphere, stroke, or all",
    )
    common.add_tolerance(chart, TOLERANCE)
    chart.add_argument(
        "--jobs", type=_jobs, metavar="N", help="processes on this machine (default: one a core)"
    )
    chart.add_argument(
        "--scheduler",
        metavar="tcp://HOST:PORT",
        help="compute on the Dask cluster of this scheduler instead",
    )
    chart.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write .csv, .npz, .png or .svg"
    )
    common.add_json(chart)


def _map(arguments: argparse.Namespace) -> None:
    from app.features.map import files
    from app.jobs import executors
    from kinematics.facets.map_sweeps import map_request, sweep

    path: Path | None = arguments.output
    kind = None if path is None else common.ending(path, files.FORMATS, "a map")
    if arguments.jobs is not None and arguments.scheduler is not None:
        raise InputError("--jobs is for this machine, --scheduler for a cluster; give one of them")
    machine = common.load(arguments.design)
    design = machine.design
    spec = machine.map_spec
    if spec is None:
        raise InputError(f"{design.name}: a {machine.title} has no maps")
    request = map_request(
        design,
        _range("--phi", arguments.phi),
        _range("--theta", arguments.theta),
        modes=common.chosen_modes(arguments.modes, machine.modes),
        quantities=_quantities(arguments.quantity, spec),
        relative=arguments.tolerance,
    )
    began = time.monotonic()
    with ExitStack() as stack:
        interrupt = stack.enter_context(_interruptible())
        progress = stack.enter_context(_Progress(request.shape[0] * request.shape[1]))
        workers = stack.enter_context(
            executors.local_workers(arguments.jobs)
            if arguments.scheduler is None
            else executors.dask_workers(arguments.scheduler)
        )

        def cancelled() -> bool:
            workers.check()
            return interrupt.came

        found = sweep(
            request,
            workers.executor,
            in_flight=2 * workers.count,
            on_cells=progress,
            cancelled=cancelled,
        )
    seconds = time.monotonic() - began
    common.warn(machine)
    if path is not None and kind is not None and found.done.any():
        common.write(path, files.map_bytes(found, kind))
    else:
        path = None
    if arguments.json:
        common.print_json(_answer(found, seconds, path))
    elif found.done.any():
        common.print_head(design, _what(found))
        print("\n".join(_lines(found, seconds, path)))
    if not found.complete:
        done, points = int(found.done.sum()), found.done.size
        kept = f"; {path} holds those" if path is not None else ""
        print(f"bohemia: stopped after {done} of {points} orientations{kept}", file=sys.stderr)
        raise KeyboardInterrupt


# --- arguments -----------------------------------------------------------------------------


def _jobs(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 1024:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of processes from 1 to 1024")
    return int(text)


def _range(option: str, text: str) -> Array:
    """The angles of "a:b:n", or one alone, in rad."""
    import numpy as np

    words = text.split(":")
    if len(words) == 1:
        return np.array([radians(common.number(text, option))])
    if len(words) != 3:
        raise InputError(f"{option} must be from:to:count, as {RANGE}, or one angle; got {text!r}")
    first, last = (common.number(word, option) for word in words[:2])
    if not words[2].strip().isdecimal() or int(words[2]) < 1:
        raise InputError(f"{option}: the count must be a whole number from 1 on, got {words[2]!r}")
    if first == last:
        raise InputError(
            f"{option} runs from {first:g}° to the same angle; write {option} {first:g}"
        )
    return np.radians(np.linspace(first, last, int(words[2])))


def _quantities(text: str, spec: MapSpec) -> list[str]:
    """The volume first, whatever else is wanted."""
    known = [quantity.key for quantity in spec.quantities]
    if text.strip().lower() == "all":
        return known
    wanted = [word.strip().lower().replace("-", "_") for word in text.split(",")]
    for word in wanted:
        if word not in known:
            raise InputError(
                f"--quantity: there is no {word!r}; it is one of {', '.join(known)}, or 'all'"
            )
    return [key for key in known if key == "volume" or key in wanted]


# --- while it runs -------------------------------------------------------------------------


class _Interrupt:
    came = False


@contextmanager
def _interruptible() -> Iterator[_Interrupt]:
    """The first Ctrl-C asks to stop after the cells at work, the second one stops."""
    interrupt = _Interrupt()

    def note(number: int, frame: FrameType | None) -> None:
        interrupt.came = True
        signal.signal(number, signal.default_int_handler)

    before = signal.signal(signal.SIGINT, note)
    try:
        yield interrupt
    finally:
        signal.signal(signal.SIGINT, before)


class _Progress:
    """Shows on stderr how far the map is and how long it will take, if a person is looking."""

    def __init__(self, points: int) -> None:
        self._points = points
        self._done = 0
        self._first: tuple[float, int] | None = None
        self._shown = sys.stderr.isatty()

    def __enter__(self) -> Self:
        self._show("Map: the processes start …")
        return self

    def __exit__(self, *_: object) -> None:
        self._show("")

    def __call__(self, indices: Ints, cells: MapCells) -> None:
        self._done += len(indices)
        now = time.monotonic()
        if self._first is None:  # until now they were only starting
            self._first = now, self._done
        since, done = self._first
        rest = ""
        if self._done > done:
            each = (now - since) / (self._done - done)
            rest = f", {each * (self._points - self._done):.0f} s left"
        self._show(f"Map: {self._done} of {self._points}{rest}")

    def _show(self, text: str) -> None:
        if self._shown:
            print(f"\r{text}\x1b[K", end="", file=sys.stderr, flush=True)


# --- what comes out ------------------------------------------------------------------------


def _answer(found: Map, seconds: float, path: Path | None) -> dict[str, Any]:
    """The grid and the values on it; null where a point was not done."""
    from app.features.map import files

    request = found.request
    first, second = files.axis_values(request)
    grids = {
        name: [[common.finite(value) for value in row] for row in values.tolist()]
        for names, *both in zip(files.columns(request), found.values, found.errors, strict=True)
        for name, values in zip(names, both, strict=True)
    }
    return {
        "design": request.design.name,
        "mechanism": request.design.mechanism,
        "modes": "all" if request.modes is None else request.modes,
        **dict(zip(map(tables.key, request.coordinates), (first, second), strict=True)),
        **grids,
        "points": found.done.size,
        "done": int(found.done.sum()),
        "seconds": seconds,
        "file": None if path is None else str(path),
    }


def _lines(found: Map, seconds: float, path: Path | None) -> list[str]:
    """Each quantity's extremes and where they are, as a table."""
    import numpy as np

    from app.features.map import files

    request = found.request
    axes = request.coordinates
    first, second = files.axis_values(request)

    def extreme(values: Array, flat: int) -> tuple[str, str]:
        i, j = divmod(flat, values.shape[1])
        return f"{values[i, j]:.6g}", tables.with_units([first[i], second[j]], axes)

    rows = []
    for quantity, values in zip(request.quantities, found.values, strict=True):
        if np.isnan(values).all():
            continue
        unit = f" ({quantity.unit})" if quantity.unit else ""
        least = extreme(values, int(np.nanargmin(values)))
        most = extreme(values, int(np.nanargmax(values)))
        rows.append((f"{quantity.title}{unit}", *least, *most, f"{np.nanmean(values):.6g}"))
    header = ("", "least", "at", "most", "at", "mean")
    n, m = request.shape
    lines = ["", tables.table(header, rows), ""]
    error = float(np.nanmax(found.errors[0]))
    lines.append(
        f"{n} × {m} orientations in {tables.seconds_text(seconds)}; "
        f"volumes ± {tables.volume_text(error)} at most"
    )
    if path is not None:
        lines.append(f"file  {path}")
    return lines


def _what(found: Map) -> str:
    from app.features.map import files

    first, second = (
        f"{axis.symbol} from {values[0]:g}° to {values[-1]:g}°"
        for axis, values in zip(
            found.request.coordinates, files.axis_values(found.request), strict=True
        )
    )
    return f"{first}, {second}, {tables.modes_text(found.request.modes)}"
