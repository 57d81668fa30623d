"""What the command line says in words and tables: results → text. Angles are degrees here."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isfinite, radians
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kinematics.answers.solutions import ForwardSolutions, Posture, Reason
    from kinematics.mechanism import Coordinate
    from kinematics.solids.csg import BuiltSolid

LOCUS = "locus"
"""What the part of a solid is called where control is lost, in commands and in file names."""
NEAR_DOUBLE = 1.0  # mm between two solutions: a small error of a length may make them one


def unit(axis: Coordinate) -> str:
    """The unit that people read and write."""
    return "degrees" if axis.unit == "rad" else axis.unit


def key(axis: Coordinate) -> str:
    """The coordinate's key in JSON, which names degrees."""
    return f"{axis.key}_deg" if axis.unit == "rad" else axis.key


def inner(value: float, axis: Coordinate) -> float:
    """mm stay, degrees become radians."""
    return radians(value) if axis.unit == "rad" else value


def outer(values: Sequence[float], axes: Sequence[Coordinate]) -> list[float]:
    """mm stay, radians become degrees."""
    return [
        degrees(value) if axis.unit == "rad" else float(value)
        for value, axis in zip(values, axes, strict=True)
    ]


def with_units(typed: Sequence[float], axes: Sequence[Coordinate]) -> str:
    """Numbers in people's units, each with its symbol: "x = -10 mm, θ = 3°"."""
    return ", ".join(
        f"{axis.symbol} = {value:g}{'°' if axis.unit == 'rad' else ' mm'}"
        for value, axis in zip(typed, axes, strict=True)
    )


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns as wide as their widest cell."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (header, *rows)
    )


def beyond_stroke(value: float, axis: Coordinate) -> str:
    """Says that a joint (mm or rad) lies outside its stroke."""
    shown, low, high = (outer([v], [axis])[0] for v in (value, axis.lower, axis.upper))
    mark = "°" if axis.unit == "rad" else " mm"
    return f"{axis.symbol} = {shown:g}{mark} is outside its stroke, {low:g} to {high:g}{mark}"


def inverse_text(
    closing: Sequence[Posture],
    nearest: Posture,
    joints: Sequence[Coordinate],
    reachable: bool,
    noun: str = "working mode",
    free: Sequence[Sequence[int]] = (),
) -> str:
    """The modes that close at a pose, and how many of them are within the strokes.

    ``noun`` is what the mechanism calls them, "" where there is only one; ``free`` which joints the
    pose leaves free in each.
    """
    lines = [""]
    if closing:
        header = ["mode"] if noun else []
        header += [*(f"{j.symbol} ({unit(j)})" for j in joints), "within its stroke"]
        symbols = {joint.limb: joint.symbol for joint in joints}
        rows = [
            (
                *([posture.mode] if noun else []),
                *(f"{joint:.4f}" for joint in outer(posture.joints, joints)),
                ", ".join(
                    [
                        ", ".join(_beyond(reason, symbols) for reason in posture.reasons) or "yes",
                        *(f"{joints[k].symbol} is free" for k in loose),
                    ]
                ),
            )
            for posture, loose in zip(closing, free or [()] * len(closing), strict=True)
        ]
        lines += [table(header, rows), ""]
    if reachable:
        count = sum(posture.reachable for posture in closing)
        lines.append(f"Reachable in {count} of {len(closing)} {noun}s." if noun else "Reachable.")
    else:
        where = f" The nearest {noun} is {nearest.mode}:" if closing and noun else ""
        lines.append(f"Not reachable in any {noun}.{where}" if noun else "Not reachable.")
        lines += [f"  {reason.text}" for reason in nearest.reasons]
    return "\n".join(lines)


def _beyond(reason: Reason, symbols: dict[int | None, str]) -> str:
    """A reason short enough for a table: "ρ₃ 40.3 too long", "θ₂ 12.5° below its range"."""
    symbol = symbols.get(reason.limb, f"limb {reason.limb}")
    low = reason.bound == "rho_min"
    if reason.unit == "rad":
        direction = "below" if low else "beyond"
        return f"{symbol} {_amount(degrees(reason.amount))}° {direction} its range"
    return f"{symbol} {_amount(reason.amount)} {'too short' if low else 'too long'}"


def _amount(value: float) -> str:
    """One decimal, or as many as show that it is not zero."""
    return f"{value:.1f}" if value >= 0.05 else f"{value:.1g}"


def forward_text(found: ForwardSolutions, shown: Sequence[int], axes: Sequence[Coordinate]) -> str:
    """Solutions ``shown`` (indices, in this order) as a table, and what is known of the set."""
    lines = [""]
    if shown:
        header = [
            "#",
            *(["mode"] if any(found.modes) else []),
            *(f"{axis.symbol} ({'°' if axis.unit == 'rad' else axis.unit})" for axis in axes),
            "condition",
            "within strokes",
            "remark",
        ]
        rows = [
            (
                str(found.identities[n]),
                *([found.modes[n]] if any(found.modes) else []),
                *(f"{v:.4f}" for v in outer(found.poses[n], axes)),
                condition_text(float(found.condition[n])),
                "yes" if found.within_stroke[n] else "no",
                remark(int(found.multiplicity[n]), float(found.gap[n])),
            )
            for n in shown
        ]
        lines += [table(header, rows), ""]
    lines += found.notes
    if len(shown) < len(found):
        lines.append(f"{len(shown)} of {len(found)} real solutions are within the strokes.")
    lines.append(counted(found))
    return "\n".join(lines)


def counted(found: ForwardSolutions) -> str:
    """ "34 real of 1560 complex solutions (complete: …); how; 0.31 s"."""
    return (
        f"{real_of_complex(found)} ({known(found)}); {found.method}; {seconds_text(found.seconds)}"
    )


def real_of_complex(found: ForwardSolutions) -> str:
    """ "34 real of 1560 complex solutions"; real ones are counted as often as they coincide."""
    real = int(found.multiplicity.sum())
    distinct = "" if real == len(found) else f" ({len(found)} distinct)"
    return f"{real} real{distinct} of {found.complex_count} complex solutions"


def known(found: ForwardSolutions) -> str:
    """Whether the solutions are all of them, and how that is known."""
    if found.complete:
        return "complete: count and conjugation closure hold"
    if found.expected_count is None:
        return "not known to be complete"
    return f"not known to be complete: {found.expected_count} are expected"


def remark(multiplicity: int, gap: float) -> str:
    """What is particular about one solution; "" as a rule. ``gap`` in mm."""
    if multiplicity > 1:
        return {2: "double", 3: "triple"}.get(multiplicity, f"{multiplicity}-fold")
    return f"near-double, {gap:.2g} mm" if gap < NEAR_DOUBLE else ""


def condition_text(value: float) -> str:
    """Three digits as a rule; infinite at a singularity."""
    if not isfinite(value):
        return "singular"
    return f"{value:.3g}" if value < 1e4 else f"{value:.0e}"


def number_text(value: float) -> str:
    """Six digits; a dash for what does not exist."""
    return f"{value:.6g}" if isfinite(value) else "–"


def seconds_text(value: float) -> str:
    """ms below a tenth of a second."""
    return f"{value:.2f} s" if value >= 0.1 else f"{1e3 * value:.1f} ms"


def solid_text(
    built: BuiltSolid, title: str, where: str, modes: tuple[str, ...] | None, file: str | None
) -> str:
    """What a solid is; ``modes`` is None for all, () where they do not matter."""
    if modes != ():
        where += f", {modes_text(modes)}"
    pieces = ", ".join(volume_text(piece.volume) for piece in built.pieces)
    lines = [
        f"{title} {where}",
        f"volume     {volume_text(built.volume)} ± {volume_text(built.volume_error)}",
        f"pieces     {len(built.pieces)}" + (f": {pieces}" if len(built.pieces) > 1 else ""),
        f"triangles  {built.triangles}" + ("" if built.watertight else ", not watertight"),
        f"surface    {surface_text(built)}",
    ]
    if file is not None:
        lines.append(f"file       {file} (mm, base coordinates)")
    return "\n".join(lines)


def surface_text(built: BuiltSolid) -> str:
    """What a solid's mesh is made of."""
    if built.residual is None:
        return "facets, right on the average"
    text = f"true: vertices within {max(built.residual, 1e-12):.0e} mm of the exact surfaces"
    if built.unplaced:
        text += f"; {built.unplaced} of them not on all that meet there"
    return text


def modes_text(modes: Sequence[str] | None) -> str:
    """ "working mode +-+++"; None is all of them together."""
    if modes is None:
        return "all working modes"
    return f"working mode{'s' if len(modes) > 1 else ''} {', '.join(modes)}"


def volume_text(value: float) -> str:
    """mm³, in groups of three digits."""
    number = f"{value:,.0f}".replace(",", "\u202f") if value >= 100 else f"{value:.3g}"
    return f"{number} mm³"
