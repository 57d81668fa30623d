"""What the command line says: results → JSON, tables and text. Angles are degrees here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import degrees, isfinite
from typing import TYPE_CHECKING, Any

from kinematics.answers.modes import Mode

if TYPE_CHECKING:
    from kinematics.answers.coordinates import Coordinate
    from kinematics.answers.solutions import ForwardSolutions
    from kinematics.machine import Machine
    from kinematics.solids.csg import BuiltSolid

LOCUS = "locus"
"""What the part of a solid is called where control is lost, in commands and in file names."""
NEAR_DOUBLE = 1.0  # mm between two solutions: a small error of a length may make them one
UNITS = ("mm", "mm2", "mm3", "mm4", "deg", "s", "N", "Nmm")


# --- JSON ----------------------------------------------------------------------------------


def outer(values: Iterable[float], axes: Sequence[Coordinate]) -> list[float]:
    """mm stay, radians become degrees."""
    return [axis.outer(float(value)) for value, axis in zip(values, axes, strict=True)]


def inner(values: Iterable[float], axes: Sequence[Coordinate]) -> list[float]:
    """mm stay, degrees become radians."""
    return [axis.inner(value) for value, axis in zip(values, axes, strict=True)]


def listed(values: Iterable[float], axes: Sequence[Coordinate]) -> list[float | None]:
    """Numbers (mm, rad) for JSON in people's units."""
    return [finite(value) for value in outer(values, axes)]


def named(
    values: Iterable[float], axes: Sequence[Coordinate], per: int = 0
) -> dict[str, float | None]:
    """Numbers (mm, rad) for JSON by the keys of their coordinates, in people's units.

    Args:
        per: 1 for rates, 2 for accelerations: their keys name the whole unit.
    """
    tail = ("", "_per_s", "_per_s2")[per]
    keys = [unit_key(axis) + tail if per else axis.json_key for axis in axes]
    return dict(zip(keys, listed(values, axes), strict=True))


def unit_key(axis: Coordinate) -> str:
    """The coordinate's key with its unit, mm too."""
    return f"{axis.key}_{'deg' if axis.unit == 'rad' else axis.unit}"


def record(found: object, *keys: str, at: Any = ..., **named: str) -> dict[str, Any]:
    """Attributes for JSON, as `plain`: each by its name with its unit, degrees for rad.

    Args:
        at: of attributes that are arrays, which element.
        named: those whose key is not the attribute's name, as ``volume_mm3="value"``.
    """
    bare = {key: key.rpartition("_") for key in keys}
    names = {key: name if unit in UNITS else key for key, (name, _, unit) in bare.items()} | named
    answer = {}
    for key, name in names.items():
        value = getattr(found, name)
        scale = degrees(1.0) if key.endswith("_deg") else 1.0
        answer[key] = plain(value if at is ... else value[at], scale)
    return answer


def warnings(machine: Machine[Any]) -> list[str]:
    """What is to be known of a design before its numbers are used."""
    return [f"{f.title}: {f.text}" for f in machine.findings if f.severity == "warning"]


def plain(value: Any, scale: float = 1.0) -> Any:
    """A value for JSON: lists for arrays and tuples, None for what is not finite."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(each, scale) for each in value]
    return finite(value * scale) if isinstance(value, float) else value


def finite(value: float) -> float | None:
    """JSON has no infinity."""
    return float(value) if isfinite(value) else None


def mode_entry(machine: Machine[Any], mode: str) -> dict[str, str]:
    """The mode under the mechanism's own key, or keys; nothing where there is only one."""
    noun = machine.mode_noun
    if noun == "mode":  # both working and operation modes
        return Mode.read(mode).entry
    return {noun.replace(" ", "_"): mode} if noun else {}


def modes_entry(modes: Sequence[str] | None) -> dict[str, Any]:
    """The modes that something is of; None is all of them together."""
    return {"modes": "all" if modes is None else list(modes)}


# --- tables --------------------------------------------------------------------------------


def records(found: Sequence[Mapping[str, Any]], *columns: tuple[Any, ...]) -> str:
    """What JSON lists, as a table.

    Args:
        columns: of each the title, the key ("#" counts) and, if it is not `number_text`, how its
            values are written: a format, a dictionary, or a function; "" for None then.
    """

    def cell(value: Any, how: Any = None) -> str:
        if how is None:
            return number_text(value) if value is None or isinstance(value, float) else str(value)
        if isinstance(how, dict):
            return str(how[value])
        return "" if value is None else how(value) if callable(how) else format(value, how)

    rows = [
        [cell(n if key == "#" else record[key], *how) for _, key, *how in columns]
        for n, record in enumerate(found, start=1)
    ]
    return table([title for title, *_ in columns], rows)


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Columns as wide as their widest cell."""
    cells = [header, *rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in cells
    )


def headings(axes: Sequence[Coordinate], degrees: str = "degrees") -> list[str]:
    """Of columns: "ρ₁ (mm)", "θ (degrees)"."""
    return [f"{axis.symbol} ({degrees if axis.unit == 'rad' else axis.unit})" for axis in axes]


# --- text ----------------------------------------------------------------------------------


def with_units(typed: Sequence[float], axes: Sequence[Coordinate]) -> str:
    """Numbers in people's units, each with its symbol: "x = -10 mm, θ = 3°"."""
    return ", ".join(
        f"{axis.symbol} = {value:g}{'°' if axis.unit == 'rad' else ' mm'}"
        for value, axis in zip(typed, axes, strict=True)
    )


def mode_text(machine: Machine[Any], mode: str) -> str:
    """ ", working mode +-+++", to be put behind a pose; "" where there is only one."""
    return f", {machine.mode_noun} {mode}" if machine.mode_noun else ""


def modes_text(modes: Sequence[str] | None, noun: str = "working mode") -> str:
    """ "working mode +-+++"; None is all of them together."""
    if modes is None:
        return f"all {noun}s"
    return f"{noun}{'s' if len(modes) > 1 else ''} {', '.join(modes)}"


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


def number_text(value: float | None) -> str:
    """Six digits, large numbers to the unit; a dash for what does not exist."""
    if value is None or not isfinite(value):
        return "–"
    return grouped(value) if 1e5 <= abs(value) < 1e12 else f"{value + 0.0:.6g}"


def grouped(value: float, decimals: int = 0) -> str:
    """Digits in groups of three."""
    return f"{value:,.{decimals}f}".replace(",", "\u202f")


def fixed(value: float, axis: Coordinate) -> str:
    """A coordinate in people's units to four decimals; no "-0.0000", and half a turn is 180°."""
    text = f"{value:.4f}"
    same = {"-0.0000": "0.0000"} | ({"-180.0000": "180.0000"} if axis.unit == "rad" else {})
    return same.get(text, text)


def seconds_text(value: float) -> str:
    """ms below a tenth of a second."""
    return f"{value:.2f} s" if value >= 0.1 else f"{1e3 * value:.1f} ms"


def surface_text(built: BuiltSolid) -> str:
    """What a solid's mesh is made of."""
    if built.residual is None:
        return "facets, right on the average"
    text = f"true: vertices within {max(built.residual, 1e-12):.0e} mm of the exact surfaces"
    if built.unplaced:
        text += f"; {built.unplaced} of them not on all that meet there"
    return text


def pieces_text(volumes: Sequence[float]) -> str:
    """How many pieces, and the volumes of several."""
    told = ", ".join(map(volume_text, volumes))
    return f"{len(volumes)}: {told}" if len(volumes) > 1 else str(len(volumes))


def volume_text(value: float) -> str:
    """mm³, in groups of three digits."""
    number = grouped(value) if value >= 100 else f"{value:.3g}"
    return f"{number} mm³"
