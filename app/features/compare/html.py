"""A comparison in numbers: sizes, measures with the best marked, what differs, one pose."""

from __future__ import annotations

from collections.abc import Sequence

from app.features.compare import LETTERS
from app.features.compare.compute import Asked, Compared, Row
from app.language import tr
from app.review.units import area_text, minus, pose_text, tenths, volume_text
from app.scene.palette import Scheme
from app.widgets.texts import NUMERIC, box, chip, esc, faint, styled, table, tone
from kinematics.facets.comparison import Size
from kinematics.mechanism import Design


def colors(of: Scheme) -> tuple[str, ...]:
    """Of each design, by its letter: the present one's, and those of the others."""
    return (of.workspace, of.counterpart, *of.beside)


def designs_html(designs: Sequence[Design], of: Scheme) -> str:
    """A row for each design with its letter; all but the present one can be taken away."""
    rows = []
    for n, (letter, design, color) in enumerate(zip(LETTERS, designs, colors(of), strict=False)):
        away = tr("compare.away", name=design.name)
        press = (
            f'<button type="button" data-send="away {n - 1}" aria-label="{esc(away)}" '
            f'title="{esc(away)}">×</button>'
        )
        title = design.title or design.name
        rows.append((f"{chip(color)}<b>{letter}</b>", esc(title), press if n else ""))
    return table(rows, ("width:2.6em", "", "width:2em;text-align:right"))


def answer_html(found: Compared) -> str:
    """What all reach and what each alone does, with errors."""
    if found.common is None:
        return box(esc(tr("compare.apart", why=found.why)))
    letters = LETTERS[: len(found.sizes)]
    number, _, rest = _size(found.common, found.unit).partition(" ")
    told = tr("compare.common", letters=", ".join(letters))
    head = f'<div><b class="bo-answer">{number}</b> {rest} {esc(told)}</div>'
    rows = [
        (letter, _size(size, found.unit), _size(only, found.unit), _share(found.common, size))
        for letter, size, only in zip(letters, found.sizes, found.only, strict=True)
    ]
    heads = ("", tr("compare.whole"), tr("compare.only"), tr("compare.share"))
    styles = ("width:1.6em", NUMERIC, NUMERIC, NUMERIC)
    how = tr("compare.exact" if found.exact else "compare.by_solids")
    return box(head + table(rows, styles, heads=heads) + faint(esc(how), "div"))


def _size(size: Size, unit: str) -> str:
    return volume_text(size.value, size.error) if unit == "mm³" else area_text(size.value)


def _share(common: Size, size: Size) -> str:
    return f"{100.0 * common.value / size.value:.1f} %" if size.value > 0.0 else "–"


def measures_html(measured: Sequence[Row], letters: str) -> str:
    """A row for each figure of merit, the best one strong and marked."""
    rows = []
    for row in measured:
        cells = [
            f"<b>{_value(v, row.unit)} ◂</b>" if n in row.best else _value(v, row.unit)
            for n, v in enumerate(row.values)
        ]
        rows.append((esc(row.title), *cells))
    heads = (tr("compare.measure"), *letters)
    return table(rows, ("", *(NUMERIC for _ in letters)), heads=heads)


def _value(value: float, unit: str) -> str:
    if value != value:
        return "–"
    if unit == "mm³":
        return volume_text(value)
    if unit == "mm²":
        return area_text(value)
    return minus(f"{value:.4g}") + (f" {unit}" if unit else "")


def differences_html(found: Compared) -> str:
    """The numbers in which the designs differ; angles in degrees."""
    from app.features.compare.compute import differing

    told = differing(found)
    if not told:
        return box(esc(tr("compare.same")))
    letters = LETTERS[: len(found.request.designs)]
    rows = []
    for one in told:
        unit = {"deg": "°"}.get(one["unit"], one["unit"])
        cells = ("–" if v is None else minus(f"{v:.6g}") for v in one["values"])
        rows.append((esc(one["label"]), *cells, unit))
    styles = ("", *(NUMERIC for _ in letters), "width:2.4em")
    return table(rows, styles, heads=(tr("compare.number"), *letters, ""))


def pose_html(found: Compared) -> str:
    """What each design answers to the present pose."""
    request = found.request
    machine = request.machines[0]
    heads = ("", *(axis.symbol for axis in machine.joints), "")
    rows = []
    for letter, one in zip(LETTERS, found.asked, strict=False):
        joints = ["" for _ in machine.joints]
        if one.posture is not None:
            axes = zip(machine.joints, one.posture.joints, strict=True)
            joints = [tenths(axis.outer(v)) if v == v else "–" for axis, v in axes]
        rows.append((letter, *joints, _verdict(one)))
    styles = ("width:1.6em", *(NUMERIC for _ in machine.joints), "padding-left:.8em")
    return box(faint(pose_text(machine.coordinates, request.pose))) + table(
        rows, styles, heads=heads
    )


def _verdict(one: Asked) -> str:
    if one.posture is None:
        return faint(esc(one.why))
    if one.posture.reachable:
        return styled(esc(tr("compare.reachable")), f"color:{tone('good')}")
    reason = one.posture.reasons[0].text.partition(" (")[0]
    return styled(esc(reason), f"color:{tone('bad')}")
