"""`bohemia micr`: the maximum inscribed singularity-free circle, of one machine or as curves."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, Output, command, progress
from app.terminal.options import argument, flag, option, output
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.mechanism import Mechanism

RATIOS = "0.25,0.5,0.75,1,1.25,1.5,1.75,2"
HEIGHTS = "0.05:4:80"
MOST = 1_000_000  # circles at a time


def _ratios(option: str, text: str, machine: Any = None) -> list[float]:
    return [_positive(option, values.number(option, word)) for word in text.split(",")]


def _heights(option: str, text: str, machine: Any = None) -> list[float]:
    return [_positive(option, value) for value in values.span(option, text, HEIGHTS)]


def _positive(option: str, value: float) -> float:
    if value <= 0.0:
        raise InputError(f"{option} must be positive, got {value:g}")
    return value


def _kinds(machine: Any) -> list[str]:
    from kinematics.mechanism import mechanism_class, mechanism_kinds

    return [kind for kind in mechanism_kinds() if "circles" in mechanism_class(kind).facets]


@command("micr")
def micr(
    mechanism: str = argument("MECHANISM", _kinds),
    base: float | None = option("MM", "base circumradius h1", values.number),
    platform: float | None = option("MM", "platform circumradius h2", values.number),
    altitude: float | None = option("MM", "altitude Z", values.number),
    curves: bool = flag("MICR against Z/h1, a curve for each ratio h2/h1"),
    ratios: list[float] | None = option(
        "r1,r2,...", f"h2/h1 of the curves (default {RATIOS})", _ratios
    ),
    heights: list[float] | None = option(
        "a:b:n", f"Z/h1 from a to b, n of them (default {HEIGHTS})", _heights
    ),
    output: Output = output("the curves as .csv, .svg or .png"),
) -> Answer:
    """The largest circle of tilts without a singularity (MICR).

    Of MECHANISM three_rps or three_spr, in degrees, about the level platform; sizes are mm, or all
    in any other unit. JSON has null where no tilt is singular; mode1_printed_deg is what the method
    of the mechanism's paper prints for mode 1, and note tells why that is another number. A 3-SPR
    has no position at a tilt of 90°: a circle that crosses this ring is marked.
    """
    from kinematics.mechanism import mechanism_class

    kind = mechanism_class(mechanism.strip())
    sizes = {"base": base, "platform": platform, "altitude": altitude}
    if curves:
        values.without("is of one machine; leave it out with --curves", **sizes)
        ratios = ratios or _ratios("--ratios", RATIOS)
        heights = heights or _heights("--heights", HEIGHTS)
        return _curves(kind, ratios, heights, output)
    values.without("goes with --curves", ratios=ratios, heights=heights, o=output.path)
    if base is None or platform is None or altitude is None:
        raise InputError(
            "--base, --platform and --altitude are needed, or --curves (see bohemia micr --help)"
        )
    return _one(kind, base, platform, altitude)


def _one(kind: type[Mechanism[Any]], base: float, platform: float, altitude: float) -> Answer:
    from kinematics.facets import circles

    found = circles.micr(kind.kind, base, platform, altitude)
    sizes = {"base": base, "platform": platform, "altitude": altitude}
    columns = {
        "deg": tables.plain(found.radius, degrees(1.0)),
        "contact_azimuth_deg": tables.plain(found.contact, degrees(1.0)),
        "crosses_ring": found.barred.tolist(),
        "printed_deg": tables.plain(found.printed),
    }
    rows = [
        {"mode": mode, **dict(zip(columns, row, strict=True))}
        for mode, *row in zip(found.modes, *columns.values(), strict=True)
    ]
    data = {
        "mechanism": kind.kind,
        **sizes,
        **{f"{name}_mm": value for name, value in sizes.items()},
        **{f"mode{row['mode']}_{key}": row[key] for row in rows for key in columns},
        "note": found.note,
    }

    table = tables.records(
        [{**row, "none": "" if row["deg"] else "no tilt is singular"} for row in rows],
        (kind.mode_noun, "mode"),
        ("MICR (°)", "deg", ".9f"),
        ("met at φ (°)", "contact_azimuth_deg", ".3f"),
        ("as the paper would print (°)", "printed_deg", ".2f"),
        ("", "none"),
        ("", "crosses_ring", {True: "crosses the ring at 90°", False: ""}),
    )
    head = f"{kind.title}, h1 = {base:g}, h2 = {platform:g}, Z = {altitude:g}"
    return Answer(data, [head, "", table, "", found.note])


def _curves(
    kind: type[Mechanism[Any]], ratios: list[float], heights: list[float], output: Output
) -> Answer:
    from app.features.singularities import micr_files
    from kinematics.facets import circles

    file = output.kind(micr_files.FORMATS, "a set of curves")
    if len(ratios) * len(heights) > MOST:
        raise InputError(f"{len(ratios)} ratios at {len(heights)} heights are more than {MOST}")
    with progress("MICR"):
        found = circles.micr(kind.kind, 1.0, [[ratio] for ratio in ratios], [heights])
    if file:
        data = micr_files.micr_bytes(kind.kind, kind.title, ratios, heights, found, file)
        output.write(data)
    answer: dict[str, Any] = {
        "mechanism": kind.kind,
        "ratios": ratios,
        "heights": heights,
        **{
            f"mode{mode}_deg": tables.plain(radii, degrees(1.0))
            for mode, radii in zip(found.modes, found.radius, strict=True)
        },
        "note": found.note,
    }
    rows = [  # of each curve its largest MICR, and at how many heights no tilt is singular
        (f"{ratio:g}", mode, f"{max(some):.3f}" if some else "", str(len(row) - len(some) or ""))
        for r, ratio in enumerate(ratios)
        for mode in found.modes
        for row in [answer[f"mode{mode}_deg"][r]]
        for some in [[value for value in row if value is not None]]
    ]
    table = tables.table(("h2/h1", "mode", "largest MICR (°)", "heights without any"), rows)
    head = f"{kind.title}: MICR of {len(ratios)} ratios at {len(heights)} heights"
    return Answer(answer, [head, "", table, "", found.note])
