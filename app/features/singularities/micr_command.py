"""`bohemia micr`: the maximum inscribed singularity-free circle, of one machine or as curves."""

from __future__ import annotations

import argparse
from math import degrees, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.terminal import common, tables
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.answers.circles import MicrTable
    from kinematics.mechanism import Mechanism

RATIOS = "0.25,0.5,0.75,1,1.25,1.5,1.75,2"
HEIGHTS = "0.05:4:80"
MOST = 1_000_000  # circles at a time


def register(command: common.AddCommand) -> None:
    micr = command("micr", _micr, "The largest circle of tilts without a singularity (MICR).")
    micr.add_argument(
        "mechanism", metavar="MECHANISM", help="the kind of mechanism, three_rps or three_spr"
    )
    for name, what in (
        ("base", "base circumradius h1"),
        ("platform", "platform circumradius h2"),
        ("altitude", "altitude Z"),
    ):
        micr.add_argument(f"--{name}", metavar="MM", help=f"{what}, mm or in any other unit")
    micr.add_argument(
        "--curves", action="store_true", help="MICR against Z/h1, a curve for each ratio h2/h1"
    )
    micr.add_argument(
        "--ratios", metavar="r1,r2,...", help=f"h2/h1 of the curves (default {RATIOS})"
    )
    micr.add_argument(
        "--heights", metavar="a:b:n", help=f"Z/h1 from a to b, n of them (default {HEIGHTS})"
    )
    micr.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write the curves as .csv, .svg or .png"
    )
    micr.epilog = (
        "Degrees, about the level platform. JSON has null where no tilt is singular. A 3-SPR has "
        "no position at a tilt of 90°: a circle that crosses this ring is marked."
    )
    common.add_json(micr)


def _micr(arguments: argparse.Namespace) -> None:
    from kinematics.mechanism import mechanism_class

    mechanism = mechanism_class(arguments.mechanism.strip())
    if arguments.curves:
        _curves(arguments, mechanism)
    else:
        _one(arguments, mechanism)


# --- one machine ---------------------------------------------------------------------------


def _one(arguments: argparse.Namespace, mechanism: type[Mechanism[Any]]) -> None:
    for option in ("ratios", "heights", "output"):
        if getattr(arguments, option) is not None:
            name = "-o" if option == "output" else f"--{option}"
            raise InputError(f"{name} goes with --curves")
    base, platform, altitude = (_size(arguments, name) for name in ("base", "platform", "altitude"))
    from kinematics.facets import circles

    found = circles.micr(mechanism.kind, base, platform, altitude)
    if not arguments.json:
        print(
            f"{mechanism.title}, h1 = {base:g}, h2 = {platform:g}, Z = {altitude:g}", "", sep="\n"
        )
        print(_table(mechanism, found), "", found.note, sep="\n")
        return
    answer: dict[str, Any] = {
        "mechanism": mechanism.kind,
        "base": base,
        "platform": platform,
        "altitude": altitude,
    }
    for n, mode in enumerate(found.modes):
        answer[f"mode{mode}_deg"] = _degrees(float(found.radius[n]))
    for n, mode in enumerate(found.modes):
        answer[f"mode{mode}_contact_azimuth_deg"] = _degrees(float(found.contact[n]))
        answer[f"mode{mode}_crosses_ring"] = bool(found.barred[n])
        answer[f"mode{mode}_printed_deg"] = common.finite(float(found.printed[n]))
    common.print_json(answer)


def _size(arguments: argparse.Namespace, name: str) -> float:
    text = getattr(arguments, name)
    if text is None:
        raise InputError(
            "--base, --platform and --altitude are needed, or --curves (see bohemia micr --help)"
        )
    return common.number(text, f"--{name}")


def _degrees(value: float) -> float | None:
    return degrees(value) if isfinite(value) else None


def _table(mechanism: type[Mechanism[Any]], found: MicrTable) -> str:
    rows = []
    for n, mode in enumerate(found.modes):
        radius, contact = float(found.radius[n]), float(found.contact[n])
        if not isfinite(radius):
            rows.append((mode, "no tilt is singular", "", "", _ring(bool(found.barred[n]))))
            continue
        printed = f"{float(found.printed[n]):.2f}"
        place = f"{degrees(contact):.3f}"
        rows.append((mode, f"{degrees(radius):.9f}", place, printed, _ring(bool(found.barred[n]))))
    header = (mechanism.mode_noun, "MICR (°)", "met at φ (°)", "as the paper would print (°)", "")
    return tables.table(header, rows)


def _ring(barred: bool) -> str:
    return "crosses the ring at 90°" if barred else ""


# --- curves --------------------------------------------------------------------------------


def _curves(arguments: argparse.Namespace, mechanism: type[Mechanism[Any]]) -> None:
    from app.features.singularities import micr_files
    from kinematics.facets import circles

    for name in ("base", "platform", "altitude"):
        if getattr(arguments, name) is not None:
            raise InputError(f"--{name} is of one machine; leave it out with --curves")
    path: Path | None = arguments.output
    kind = None if path is None else common.ending(path, micr_files.FORMATS, "a set of curves")
    ratios = _ratios(arguments.ratios or RATIOS)
    heights = _heights(arguments.heights or HEIGHTS)
    if len(ratios) * len(heights) > MOST:
        raise InputError(f"{len(ratios)} ratios at {len(heights)} heights are more than {MOST}")
    with common.progress("MICR"):
        found = circles.micr(mechanism.kind, 1.0, [[ratio] for ratio in ratios], [heights])
    if path is not None and kind is not None:
        data = micr_files.micr_bytes(mechanism.kind, mechanism.title, ratios, heights, found, kind)
        common.write(path, data)
    file = None if path is None else str(path)
    if not arguments.json:
        print(
            f"{mechanism.title}: MICR of {len(ratios)} ratios at {len(heights)} heights",
            "",
            sep="\n",
        )
        print(_summary(found, ratios))
        print("", found.note, *([f"file  {file}"] if file else []), sep="\n")
        return
    common.print_json(
        {
            "mechanism": mechanism.kind,
            "ratios": ratios,
            "heights": heights,
            **{
                f"mode{mode}_deg": [[_degrees(v) for v in row] for row in found.radius[n].tolist()]
                for n, mode in enumerate(found.modes)
            },
            "file": file,
        }
    )


def _summary(found: MicrTable, ratios: list[float]) -> str:
    """Of each curve its largest MICR, and at how many heights no tilt is singular."""
    rows = []
    for r, ratio in enumerate(ratios):
        for n, mode in enumerate(found.modes):
            values = [value for value in found.radius[n, r].tolist() if isfinite(value)]
            free = len(found.radius[n, r]) - len(values)
            largest = f"{degrees(max(values)):.3f}" if values else ""
            rows.append((f"{ratio:g}", mode, largest, str(free) if free else ""))
    return tables.table(("h2/h1", "mode", "largest MICR (°)", "heights without any"), rows)


def _ratios(text: str) -> list[float]:
    ratios = [common.number(word, "--ratios") for word in text.split(",")]
    for ratio in ratios:
        if ratio <= 0.0:
            raise InputError(f"--ratios must be positive, got {ratio:g}")
    return ratios


def _heights(text: str) -> list[float]:
    words = text.split(":")
    if len(words) == 1:
        return [_height(words[0])]
    if len(words) != 3 or not words[2].strip().isdecimal() or int(words[2]) < 1:
        raise InputError(f"--heights must be from:to:count, as {HEIGHTS}, or one; got {text!r}")
    first, last, count = _height(words[0]), _height(words[1]), int(words[2])
    if count > MOST:
        raise InputError(f"--heights: at most {MOST} of them, got {count}")
    step = (last - first) / (count - 1) if count > 1 else 0.0
    return [first + n * step for n in range(count)]


def _height(word: str) -> float:
    value = common.number(word, "--heights")
    if value <= 0.0:
        raise InputError(f"--heights must be positive, got {value:g}")
    return value
