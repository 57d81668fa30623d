"""A comparison as a folder: solids or plane regions, and its tables. Angles are degrees."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from app.features.compare import LETTERS
from app.features.compare.compute import Compared, differing, parts, regions
from app.features.review.files import sanitized, solid_bytes
from app.terminal.lengths import csv_in
from app.terminal.tables import finite
from kinematics.errors import InputError
from kinematics.storage import csv_text, write_file

REPORTS = ("html", "pdf")

if TYPE_CHECKING:
    from app.terminal.command import Output


def check(output: Output) -> None:
    """Raise before any work where neither a folder nor a report can be written.

    Raises:
        InputError: it is a file, or would have to be in a folder that is not there.
    """
    path = output.path
    if path is None:
        return
    if path.suffix and not path.is_dir():
        output.kind(REPORTS, "a comparison is a folder, or as a report")
        return
    if path.exists() and not path.is_dir():
        raise InputError(f"cannot write {str(path)!r}: a comparison needs a folder; it is a file")
    if not path.exists() and not path.parent.is_dir():
        raise InputError(f"cannot write {str(path)!r}: there is no folder {str(path.parent)!r}")


def write(found: Compared, output: Output) -> None:
    """Write a report, or everything into a folder, which is made if it is not there."""
    path = output.path
    assert path is not None
    kind = path.suffix.removeprefix(".").lower()
    if kind in REPORTS and not path.is_dir():
        from app.features.report.make import comparison, written

        made = written(comparison(found), kind)
        output.write(made.data, f"{len(made.data) / 1e6:.2f} MB")
        return
    path.mkdir(exist_ok=True)
    for name, data in contents(found, output.unit):
        write_file(path / name, data)
    output.written = str(path)


def contents(found: Compared, unit: str = "mm") -> Iterable[tuple[str, bytes]]:
    """The files, by name."""
    tables = (
        ("sizes.csv", sizes_csv(found)),
        ("measures.csv", measures_csv(found)),
        ("differences.csv", differences_csv(found)),
        ("areas.csv", areas_csv(found)),
    )
    for name, text in tables:
        if text:
            yield name, csv_in(text, unit).encode()
    yield from _sections(found, unit)
    if found.common is None:
        return
    if found.unit == "mm²":
        from app.features.section.files import section_bytes

        spec, every, alone = regions(found.request)
        for name, section in (("common", every), *zip(_alone(found), alone, strict=True)):
            if section.loops:
                yield f"{name}.dxf", section_bytes(section, spec, "dxf", title=name, unit=unit)
        return
    import numpy as np

    solids = parts(found.request, "normal")
    for name, built in (("common", solids.common), *zip(_alone(found), solids.only, strict=True)):
        if built.triangles:
            yield f"{name}.stl", solid_bytes(built, np.eye(4), "stl", unit)


def _sections(found: Compared, unit: str) -> Iterable[tuple[str, bytes]]:
    """The exact section of each design by one plane."""
    from app.features.section.files import section_bytes

    for letter, machine, one in zip(LETTERS, found.request.machines, found.outlines, strict=False):
        if one is not None and one.loops and machine.section_spec is not None:
            name = f"section-{letter}_{sanitized(machine.design.name)}"
            data = section_bytes(one, machine.section_spec, "dxf", title=name, unit=unit)
            yield f"{name}.dxf", data


def _alone(found: Compared) -> list[str]:
    """Files' stems of what each design alone reaches: "only-A_rpur-table1"."""
    names = (design.name for design in found.request.designs)
    return [f"only-{letter}_{sanitized(n)}" for letter, n in zip(LETTERS, names, strict=False)]


def sizes_csv(found: Compared) -> str:
    """How large each workspace is, what all share, and what each alone reaches."""
    if found.common is None:
        return ""
    unit = "mm3" if found.unit == "mm³" else "mm2"
    rows: list[list[object]] = [["part", "design", f"size_{unit}", f"error_{unit}"]]
    names = [design.name for design in found.request.designs]
    rows += [["workspace", n, s.value, s.error] for n, s in zip(names, found.sizes, strict=True)]
    rows += [["common", "", found.common.value, found.common.error]]
    rows += [["only", n, s.value, s.error] for n, s in zip(names, found.only, strict=True)]
    return csv_text(rows)


def measures_csv(found: Compared) -> str:
    """Figures of merit, a row each; the best ones by their letters."""
    letters = LETTERS[: len(found.request.designs)]
    heads = [part for letter in letters for part in (letter, f"error_{letter}")]
    rows: list[list[object]] = [["measure", "unit", *heads, "best"]]
    for row in found.rows:
        pairs = zip(row.values, row.errors, strict=True)
        cells = [_cell(v) for pair in pairs for v in pair]
        rows.append([row.title, row.unit, *cells, " ".join(letters[n] for n in row.best)])
    return csv_text(rows)


def differences_csv(found: Compared) -> str:
    """The numbers in which the designs differ, as their files have them."""
    letters = LETTERS[: len(found.request.designs)]
    rows: list[list[object]] = [["field", "label", "unit", *letters]]
    for one in differing(found):
        cells = [_cell(value) for value in one["values"]]
        rows.append([one["field"], one["label"], one["unit"], *cells])
    return csv_text(rows)


def areas_csv(found: Compared) -> str:
    """The sections' areas along the normal, of each design where its sections are exact."""
    rows: list[list[object]] = [["design", "at_mm", "area_mm2"]]
    for design, curve in zip(found.request.designs, found.curves, strict=True):
        if curve is not None:
            pairs = zip(curve.at.tolist(), curve.area.tolist(), strict=True)
            rows += [[design.name, *pair] for pair in pairs]
    return csv_text(rows) if len(rows) > 1 else ""


def _cell(value: float | None) -> object:
    known = None if value is None else finite(value)
    return "" if known is None else known
