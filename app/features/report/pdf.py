"""A report on paper: A4 or letter, drawn as lines and letters.

Made by ReportLab alone, so that it looks the same wherever it is made, with no browser.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

from reportlab.graphics import shapes
from reportlab.lib.colors import HexColor
from reportlab.lib.enums import TA_RIGHT
from reportlab.lib.pagesizes import A4, LETTER
from reportlab.lib.styles import ParagraphStyle
from reportlab.lib.units import mm
from reportlab.pdfbase import pdfmetrics
from reportlab.pdfbase.ttfonts import TTFont
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import BaseDocTemplate as Document
from reportlab.platypus import (
    CondPageBreak,
    Frame,
    HRFlowable,
    KeepTogether,
    PageBreak,
    PageTemplate,
    Paragraph,
    Spacer,
)
from reportlab.platypus import Table as Grid

from app.features.report.model import Block, Figure, Report, Run, Runs, Scene, Section, Table, Words
from app.features.report.vectors import BOLD, FONT, drawing
from app.scene.palette import LIGHT
from app.widgets.svg import plain

MARGIN, FOOT = 20 * mm, 10 * mm
PAPERS = {"a4": A4, "letter": LETTER}
RULE, PALE, EDGE = "#DDE2E8", "#EEF1F5", "#7F8996"
TONES = {"good": LIGHT.good, "near": LIGHT.near, "bad": LIGHT.bad, "quiet": LIGHT.quiet}
TEXT, SMALL, FOOT_SIZE = 8.2, 7.2, 6.8  # pt
PAGES = "pages"  # what each page shows, and the last one makes
BAR = 62.0  # pt, the least width of a bar in a table
MOST, SHORT = 0.6, 500.0  # of the page: any other picture; pt: what is less is no page
TALLEST = 0.35  # of the page: the picture on the first one

BODY = ParagraphStyle(
    "body", fontName=FONT, fontSize=TEXT, leading=11.5, textColor=HexColor(LIGHT.ink)
)
NOTE = ParagraphStyle("note", BODY, fontSize=SMALL, leading=9.8, textColor=HexColor(LIGHT.quiet))
CELL = ParagraphStyle("cell", BODY, fontSize=7.4, leading=9.6)
RIGHT = ParagraphStyle("right", CELL, alignment=TA_RIGHT)
HEAD = ParagraphStyle("head", CELL, fontSize=6.8, leading=8.6, textColor=HexColor(LIGHT.quiet))
HEAD_RIGHT = ParagraphStyle("head right", HEAD, alignment=TA_RIGHT)
CAPTION = ParagraphStyle("caption", BODY, fontName=BOLD, fontSize=7.8, leading=11, spaceAfter=2)
H1 = ParagraphStyle("h1", BODY, fontName=BOLD, fontSize=17, leading=21)
H2 = ParagraphStyle("h2", BODY, fontName=BOLD, fontSize=14, leading=18)
H3 = ParagraphStyle("h3", BODY, fontName=BOLD, fontSize=11.5, leading=15, spaceAfter=3)
SUB = ParagraphStyle("sub", BODY, fontSize=8.6, leading=11.5, textColor=HexColor(LIGHT.quiet))


def pdf(report: Report, paper: str) -> tuple[bytes, int]:
    """The whole file, and how many pages it has."""
    _fonts()
    size = PAPERS[paper]
    wide = size[0] - 2 * MARGIN
    written = io.BytesIO()
    document = Document(
        written,
        pagesize=size,
        leftMargin=MARGIN,
        rightMargin=MARGIN,
        topMargin=MARGIN,
        bottomMargin=MARGIN,
        title=report.title,
        author="Bohemia",
        subject="Kinematic review",
        creator=report.facts[-1],
        lang="en",
        invariant=1,
    )
    frame = Frame(
        MARGIN, MARGIN + FOOT / 2, wide, size[1] - 2 * MARGIN - FOOT / 2, 0, 0, 0, 0, id="text"
    )
    document.addPageTemplates([PageTemplate("page", [frame], onPageEnd=_foot(report, size))])
    levels = ("h2", "h3") if len(report.chapters) > 1 else ("h3",)
    document.afterFlowable = partial(_outline, document, levels)
    document.build([*_story(report, wide, size[1])], canvasmaker=_canvas)
    return written.getvalue(), document.page


def _canvas(*arguments: Any, **options: Any) -> Any:
    """A canvas that writes how many pages there are, once it knows."""
    made = Canvas(*arguments, **options)
    save = made.save

    def saved() -> None:
        made.beginForm(PAGES, 0, -4, 40, 10)
        made.setFont(FONT, FOOT_SIZE)
        made.setFillColor(HexColor(LIGHT.quiet))
        made.drawString(0, 0, f" / {made.getPageNumber() - 1}")
        made.endForm()
        save()

    made.save = saved
    return made


def _outline(document: Any, levels: Sequence[str], flowable: Any) -> None:
    """Headings stand in the outline that readers show beside the pages."""
    name = getattr(getattr(flowable, "style", None), "name", "")
    if name not in levels:
        return
    key = f"h{document.seq.nextf('heading')}"
    document.canv.bookmarkPage(key)
    document.canv.addOutlineEntry(flowable.getPlainText(), key, levels.index(name), closed=False)


def _fonts() -> None:
    """Letters that have φ, ρ₁ and ′: those that come with matplotlib."""
    if FONT in pdfmetrics.getRegisteredFontNames():
        return
    import matplotlib

    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    pdfmetrics.registerFont(TTFont(FONT, folder / "DejaVuSans.ttf"))
    pdfmetrics.registerFont(TTFont(BOLD, folder / "DejaVuSans-Bold.ttf"))
    pdfmetrics.registerFontFamily(FONT, normal=FONT, bold=BOLD, italic=FONT, boldItalic=BOLD)


def _foot(report: Report, size: tuple[float, float]) -> Any:
    def draw(canvas: Any, document: Any) -> None:
        canvas.saveState()
        canvas.setStrokeColor(HexColor(RULE))
        canvas.setLineWidth(0.6)
        canvas.line(MARGIN, MARGIN, size[0] - MARGIN, MARGIN)
        canvas.setFont(FONT, FOOT_SIZE)
        canvas.setFillColor(HexColor(LIGHT.quiet))
        canvas.drawString(MARGIN, MARGIN - 11, report.foot[:130])
        right = size[0] - MARGIN - pdfmetrics.stringWidth(" / 99", FONT, FOOT_SIZE)
        canvas.drawRightString(right, MARGIN - 11, f"{document.page}")
        canvas.translate(right, MARGIN - 11)
        canvas.doForm(PAGES)
        canvas.restoreState()

    return draw


# --- the text ------------------------------------------------------------------------------


def _story(report: Report, wide: float, high: float) -> Iterator[Any]:
    several = len(report.chapters) > 1
    yield Paragraph(escape(report.title), H1)
    first = report.chapters[0]
    sub = " · ".join(filter(None, ("Kinematic review", "" if several else first.subtitle)))
    yield Paragraph(escape(sub), SUB)
    yield Spacer(0, 2)
    yield Paragraph(escape(" · ".join(report.facts)), NOTE)
    ink = HexColor(LIGHT.ink)
    yield HRFlowable(width="100%", thickness=2, color=ink, spaceBefore=5, spaceAfter=6)
    for n, chapter in enumerate(report.chapters):
        if several:
            if n:
                yield PageBreak()
            named = f"{chapter.letter} · " if chapter.letter else ""
            yield Paragraph(escape(named + chapter.title), H2)
            if chapter.subtitle:
                yield Paragraph(escape(chapter.subtitle), SUB)
            yield Spacer(0, 4)
        for m, section in enumerate(chapter.sections):
            yield from _section(section, wide, high, first=m == 0)


def _section(section: Section, wide: float, high: float, *, first: bool) -> Iterator[Any]:
    if not first:
        yield Spacer(0, 12)
        yield CondPageBreak((0.4 if section.fresh else 0.2) * high)
    head = [] if first else [Paragraph(escape(section.title), H3)]
    for block in section.blocks:
        for parts in _block(block, wide, high):
            # A long table may go on overleaf.
            yield parts[0] if len(parts) == 1 and not head else KeepTogether([*head, *parts])
            head = []


def _block(block: Block, wide: float, high: float) -> Iterator[list[Any]]:
    """What is to stand together on a page, one after another."""
    match block:
        case Words():
            color = TONES.get(block.tone, LIGHT.ink)
            style = ParagraphStyle(f"words {block.tone}", BODY, textColor=HexColor(color))
            yield [Paragraph(_markup(block.runs), style), Spacer(0, 3)]
        case Table():
            yield from _table(block, wide)
        case Figure():
            yield _figure(block, wide, high)
        case Scene():
            yield _figure(block.still, wide, TALLEST * high)


def _figure(figure: Figure, wide: float, high: float) -> list[Any]:
    made = drawing(figure.svg, figure.share * wide)
    most = MOST * high if high > SHORT else high
    if made.height > most:
        made = drawing(figure.svg, figure.share * wide * most / made.height)
    made.hAlign = "CENTER" if figure.share == 1.0 else "LEFT"
    parts = [Spacer(0, 4), made]
    if figure.caption:
        parts += [Spacer(0, 2), Paragraph(escape(figure.caption), NOTE)]
    return [*parts, Spacer(0, 6)]


def _markup(runs: Runs) -> str:
    return "".join(map(_run, runs))


def _run(run: Run) -> str:
    text = escape(run.text)
    if run.script:
        name = {"sup": "super", "sub": "sub"}[run.script]
        text = f"<{name}>{text}</{name}>"
    if run.bold:
        text = f"<b>{text}</b>"
    color = plain(run.color)
    if color.startswith("#"):
        text = f'<font color="{color}">{text}</font>'
    chip = plain(run.chip)
    square = f'<font color="{chip}">■</font> ' if chip.startswith("#") else ""
    return square + text


# --- tables --------------------------------------------------------------------------------


def _table(table: Table, wide: float) -> Iterator[list[Any]]:
    heads: list[Any] = []
    if any(table.heads):
        heads = [
            Paragraph(escape(head), HEAD_RIGHT if right else HEAD)
            for head, right in zip(table.heads, table.numeric, strict=True)
        ]
    widths = _widths(table, wide)
    rows = [
        [
            _cell(cell, right=right, wide=w - 8)
            for cell, right, w in zip(row, table.numeric, widths, strict=True)
        ]
        for row in table.rows
    ]
    first = len([heads] if heads else [])
    style: list[tuple[Any, ...]] = [
        ("VALIGN", (0, 0), (-1, -1), "TOP"),
        ("LEFTPADDING", (0, 0), (-1, -1), 0),
        ("RIGHTPADDING", (0, 0), (-1, -1), 8),
        ("RIGHTPADDING", (-1, 0), (-1, -1), 0),
        ("TOPPADDING", (0, 0), (-1, -1), 1.6),
        ("BOTTOMPADDING", (0, 0), (-1, -1), 1.8),
        ("LINEBELOW", (0, first), (-1, -1), 0.4, HexColor(RULE)),
    ]
    if heads:
        style.append(("LINEBELOW", (0, 0), (-1, 0), 0.6, HexColor(EDGE)))
        style.append(("VALIGN", (0, 0), (-1, 0), "BOTTOM"))
    style += [("BACKGROUND", (0, n + first), (-1, n + first), HexColor(PALE)) for n in table.marked]
    if not rows:
        return
    grid = Grid(
        [*([heads] if heads else []), *rows],
        colWidths=widths,
        repeatRows=first,
        style=style,
        hAlign="LEFT",
    )
    parts: list[Any] = [Spacer(0, 5)]
    if table.caption:
        parts.append(Paragraph(escape(table.caption), CAPTION))
    note = [Spacer(0, 2), Paragraph(_markup(table.note), NOTE)] if table.note else []
    if len(rows) <= 14:
        yield [*parts, grid, *note, Spacer(0, 6)]
        return
    yield [CondPageBreak(110), *parts]
    yield [grid]
    yield [*note, Spacer(0, 6)]


def _cell(cell: Runs, *, right: bool, wide: float) -> Any:
    if cell and cell[0].bar:
        return _bar(cell[0], max(wide, BAR))
    return Paragraph(_markup(cell), RIGHT if right else CELL)


def _bar(run: Run, wide: float) -> Any:
    made = shapes.Drawing(wide, 8)
    made.add(shapes.Rect(0, 1.5, wide, 4, rx=2, ry=2, fillColor=HexColor(PALE), strokeColor=None))
    for low, high, color in run.bar:
        code = plain(color)
        code = code if code.startswith("#") else LIGHT.ink
        left, right = (wide * min(max(v, 0.0), 1.0) for v in (low, low if high is None else high))
        tall, foot = (4.0, 1.5) if high is not None else (7.0, 0.0)
        size = right - left if high is not None else 1.4
        if size > 0:
            place = (left if high is not None else left - 0.7, foot)
            made.add(shapes.Rect(*place, size, tall, fillColor=HexColor(code), strokeColor=None))
    return made


def _widths(table: Table, wide: float) -> list[float]:
    """Of the columns: as wide as what they hold, and what is left to those of words."""
    needs, least = [], []
    for n, head in enumerate(table.heads):
        cells = [row[n] for row in table.rows]
        words = [pdfmetrics.stringWidth(w, FONT, HEAD.fontSize) for w in head.split()]
        size = max(words, default=0.0) * 1.05
        bars = any(cell and cell[0].bar for cell in cells)
        for cell in cells:
            text = "".join(("■ " if run.chip else "") + run.text for run in cell)
            size = max(size, pdfmetrics.stringWidth(text, FONT, CELL.fontSize) * 1.03)
        needs.append((BAR if bars else size) + 9.0)
        least.append(needs[-1] if table.numeric[n] or bars else min(needs[-1], 0.16 * wide))
    spare = wide - sum(least)
    more = [need - low for need, low in zip(needs, least, strict=True)]
    if sum(needs) <= wide:
        rest = wide - sum(needs)
        # What is left goes to bars, else between the columns.
        long = [n for n in range(len(needs)) if any(r[n] and r[n][0].bar for r in table.rows)]
        share = [rest / len(long) if n in long else 0.0 for n in range(len(needs))] if long else []
        if not share:
            share = [min(rest / len(needs), 60.0) for _ in needs]
            if not table.numeric[-1]:
                share[-1] += rest - sum(share)
        return [need + s for need, s in zip(needs, share, strict=True)]
    if spare <= 0.0 or not sum(more):
        return [wide * low / sum(least) for low in least]
    return [low + spare * m / sum(more) for low, m in zip(least, more, strict=True)]
