"""Reports: what they hold of every kind, that they need no network, and their files."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from functools import lru_cache
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import numpy as np
import pypdfium2
import pytest

from app.features.marks.model import Anchor, Dimension, Note, SavedView, looks_of
from app.features.marks.state import Marks
from app.features.report import drawing, marked, vectors
from app.features.report.compute import Depth, Found, gather
from app.features.report.make import LARGEST, report_of, written
from app.features.report.model import Figure, Report, Scene, Table, plain
from app.features.report.reading import read
from app.features.section import compute as sections
from app.features.trajectory.state import Plan
from app.review import session
from app.review.state import Review, new_review
from app.review.units import volume_text
from app.review.view import view
from app.scene.camera import Camera
from app.widgets.svg import LOST
from kinematics.designs.files import load_design
from kinematics.machine import machine_of
from tests.conftest import Finished, answered, refused

MACHINES = ("rpur-table1", "sps-spr", "rps-3", "spr-3", "five-bar")
AT = datetime(2026, 12, 1, tzinfo=UTC)
Run = Callable[..., Finished]


@lru_cache
def found(name: str) -> Found:
    """Everything of a design, coarsely; of the five-bar with a trajectory."""
    review = new_review(load_design(name))
    if name == "five-bar":
        review = review.having(replace(review[Plan], on=True, samples=21, degree=3), _marks(review))
    return gather(review, Depth("preview", 0))


def _marks(review: Review) -> Marks:
    """One of each kind."""
    camera = Camera((0.0, 300.0, 900.0), (0.0, 400.0, 0.0), (0.0, 1.0, 0.0), 0.5)
    joint, pose, mode = Anchor("point", "limb1/B"), (120.0, 700.0), review.mode
    return Marks(
        (
            SavedView("the <elbow>", camera, looks_of(review)),
            SavedView("Plan", camera, (), pose, mode),
        ),
        (Note("close to the rail", pose, mode, joint), Note("begins here", review.pose, mode)),
        (Dimension("reach", (joint, Anchor("point", "base"))),),
    )


@lru_cache
def made(name: str) -> Report:
    return report_of([found(name)], AT)


def tables(report: Report) -> list[Table]:
    return [
        block
        for chapter in report.chapters
        for section in chapter.sections
        for block in section.blocks
        if isinstance(block, Table)
    ]


class Page(HTMLParser):
    """The elements of a page in their order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def of(self, *names: str) -> list[dict[str, str | None]]:
        return [look for tag, look in self.tags if tag in names]


# --- as a page -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", MACHINES)
def test_a_page_asks_for_nothing_and_is_in_order(name: str) -> None:
    data = written(made(name), "html").data
    assert len(data) < LARGEST / 4
    text = data.decode()
    page = Page(text)
    for look in (look for _, look in page.tags):
        for where in ("src", "href", "srcset", "action", "data", "poster"):
            assert (look.get(where) or "#").startswith("#")
    for other in re.findall(r"https?://[^\"' <]*", text):
        assert other == "http://www.w3.org/2000/svg"  # a name, not a place
    assert not re.search(r"url\(|@import|<link|fetch\(|XMLHttpRequest|<base", text)
    allowed = next(look["content"] for look in page.of("meta") if "http-equiv" in look)
    assert allowed is not None
    assert "default-src 'none'" in allowed
    assert page.of("html")[0]["lang"] == "en"
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch(r"h\d", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b <= a + 1 for a, b in pairwise(levels))
    assert all("scope" in look for look in page.of("th"))
    assert len(page.of("caption")) == len(page.of("table"))
    pictures = [look for look in page.of("svg") if look.get("role") == "img"]
    assert len(pictures) == len(page.of("figure"))
    assert all(look["aria-label"] for look in pictures)


def test_a_design_that_is_called_like_a_script_is_text() -> None:
    design = replace(load_design("rps-3"), title="</script><script>alert(1)</script>")
    view_of = replace(found("rps-3").view, review=replace(found("rps-3").review, design=design))
    text = written(report_of([replace(found("rps-3"), view=view_of)], AT), "html").data.decode()
    assert text.count("<script") == 2  # the scene's numbers, and what shows them
    assert "alert(1)" in text


def test_numbers_are_those_of_the_page() -> None:
    review = new_review(load_design("rpur-table1"))
    volume = sections.measure(sections.region(review, "present"))
    results = next(t for t in tables(made("rpur-table1")) if t.caption == "Results")
    told = {plain(row[0]): [plain(cell) for cell in row[1:]] for row in results.rows}
    value, error = volume_text(volume.value, volume.error).removesuffix(" dm³").split(" ± ")
    assert told["Workspace, this mode"][:2] == [f"{value} dm³", f"{error} dm³"]
    assert "mode +−+−+" in told["Workspace, this mode"][2]
    assert all(cells[1] for cells in told.values())  # each with its error, be it rounding
    assert all(cells[2] for cells in told.values())  # and with what it is of


@pytest.mark.parametrize("name", MACHINES)
def test_every_number_of_the_design_stands_in_it_and_is_explained(name: str) -> None:
    machine = machine_of(load_design(name))
    numbers = " ".join(plain(c) for t in tables(made(name)) for row in t.rows for c in row)
    for field in machine.fields:
        value = np.degrees(field.value) if field.unit == "rad" else field.value
        assert f"{round(float(value), 9) + 0.0:.10g}".replace("-", "−") in numbers
    shown = machine.drawing(machine.home)
    for field in machine.fields:
        assert any(field.path[: len(p)] == p for d in shown.dimensions for p in d.paths)
    svg, limb = drawing.dimensioned(view(found(name).review), "")
    for dimension in shown.dimensions:
        if dimension.limb == limb:
            assert f">{dimension.symbol}</text>" in svg


@pytest.mark.parametrize("name", MACHINES)
def test_dimensions_are_as_long_as_their_numbers(name: str) -> None:
    machine = machine_of(load_design(name))
    shown, joints = machine.drawing(machine.home), machine.home.joints
    for d in shown.dimensions:
        values = [f.value for f in machine.fields if any(f.path[: len(p)] == p for p in d.paths)]
        size = float(np.linalg.norm(np.subtract(d.end, d.start)))
        if d.kind == "vector":
            assert size == pytest.approx(np.linalg.norm(values), abs=1e-9)
        elif d.kind == "length":
            assert size == pytest.approx(values[0], abs=1e-9)
        elif d.kind == "stroke" and d.limb is not None:
            assert size == pytest.approx(joints[d.limb - 1], abs=1e-9)


def test_the_scene_moves_along_the_trajectory() -> None:
    scene = next(
        block
        for block in made("five-bar").chapters[0].sections[0].blocks
        if isinstance(block, Scene)
    )
    assert scene.packed.seconds == pytest.approx(1.0)
    assert len(scene.packed.data["times"]) == 21
    titles = [section.title for section in made("five-bar").chapters[0].sections]
    assert "Trajectory" in titles
    assert "Trajectory" not in [s.title for s in made("rps-3").chapters[0].sections]


# --- what the page says, taken over --------------------------------------------------------


def test_the_pages_html_becomes_tables_and_paragraphs() -> None:
    blocks = read(
        '<div class="bo-says"><b>Held</b> here<table class="bo-table"><tr><th>a</th><th></th></tr>'
        '<tr aria-current><td><span style="background:#123456"></span>one</td>'
        '<td style="text-align:right">2 mm</td></tr></table><button>Go</button>'
        '<span style="opacity:.75">quiet &amp; <i>more</i></span></div>',
        "Numbers",
    )
    first, table, last = blocks
    assert not isinstance(first, Table)
    assert isinstance(table, Table)
    assert [run.bold for run in first.runs] == [True, False]
    assert table.heads == ("a", "")
    assert table.numeric == (False, True)
    assert table.marked == {0}
    assert table.rows[0][0][0].chip == "#123456"
    assert "Go" not in str(blocks)
    assert not isinstance(last, Table)
    assert plain(last.runs) == "Quiet & more"


def test_marks_are_told_drawn_and_turned_to() -> None:
    seen, told = found("five-bar").view, marked.told(found("five-bar").view)
    elbow = np.array(next(m.position for m in seen.drawing.points if m.name == "limb1/B"))
    value = f"{np.linalg.norm(elbow):.2f} mm"
    report = made("five-bar")
    by_name = {t.caption.partition(",")[0]: t for t in tables(report)}
    assert [plain(cell) for cell in by_name["Dimensions"].rows[0][:3]] == ["reach", "B₁ – O", value]
    assert [plain(row[1]) for row in by_name["Notes"].rows] == ["close to the rail", "begins here"]
    assert plain(by_name["Notes"].rows[0][2]) == "B₁"
    assert "x 120.0, y 700.0 mm" in plain(by_name["Notes"].rows[0][3])
    section = next(s for s in report.chapters[0].sections if s.title == "Marks")
    pictures = [block for block in section.blocks if isinstance(block, Figure)]
    assert [p.caption.partition(".")[0] for p in pictures] == ["the <elbow>", "Plan"]
    assert f"reach: {value}" in pictures[0].svg
    scene = next(b for b in report.chapters[0].sections[0].blocks if isinstance(b, Scene))
    assert f"reach: {value}" in scene.still.svg
    data = scene.packed.data
    names = {text for text, _, group in data["names"] if group == "marks"}
    assert names == {f"reach: {value}", "(1)", "(2)"}
    kept = data["looks"][-2:]
    assert [look[0] for look in kept] == ["the <elbow>", "Plan"]
    _, toward, target, away, shown = kept[0]
    back = np.array([0.0, -100.0, 900.0])
    assert toward == pytest.approx(back / np.linalg.norm(back), abs=1e-6)
    assert target == [0.0, 400.0, 0.0]
    # As high at what it looks at as it was.
    assert away * math.tan(math.pi / 12) == pytest.approx(np.linalg.norm(back) * math.tan(0.25))
    assert {"machine", "ground", "marks"} <= set(shown)
    assert kept[1][4] is None
    pins = [at for at in told.pins if at is not None]
    assert pins[1] == pytest.approx(seen.platform[:3, 3])
    page = written(report, "html").data.decode()
    assert 'data-look="5">Plan</button>' in page
    assert "the &lt;elbow&gt;" in page


def test_a_saved_view_is_drawn_as_it_was_seen() -> None:
    """What it looked at in the middle, and what was at the upper edge of it at the upper edge."""
    at, fov = np.array([10.0, 20.0, 300.0]), 0.4
    camera = Camera((10.0, -980.0, 300.0), (10.0, 20.0, 300.0), (0.0, 0.0, 1.0), fov)
    eye = marked.Framed(camera, flat=False)
    wide, high = eye.size
    assert eye.px(at).tolist() == pytest.approx([wide / 2, high / 2])
    top = at + np.array([0.0, 0.0, 1000.0 * math.tan(fov / 2)])
    assert eye.px(top).tolist() == pytest.approx([wide / 2, 0.0], abs=1e-6)
    above = Camera((0.0, 0.0, 900.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), fov)
    assert np.isfinite(marked.Framed(above, flat=False).px(at)).all()


# --- on paper ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "paper", "size"),
    [("rpur-table1", "a4", (595, 842)), ("five-bar", "letter", (612, 792))],
)
def test_a_pdf_has_the_same_words_as_letters_and_no_picture_of_pixels(
    name: str, paper: str, size: tuple[int, int]
) -> None:
    report = made(name)
    done = written(report, "pdf", paper)  # type: ignore[arg-type]
    assert b"/Image" not in done.data.replace(b"/ImageB /ImageC /ImageI", b"")
    document = pypdfium2.PdfDocument(done.data)
    assert len(document) == done.pages
    assert [round(v) for v in document[0].get_size()] == list(size)
    pages = [page.get_textpage().get_text_bounded() for page in document]
    text = " ".join(" ".join(pages).split())
    for section in report.chapters[0].sections[1:]:
        assert section.title in text
    results = next(t for t in tables(report) if t.caption == "Results")
    for row in results.rows:
        assert plain(row[1]) in text
    assert pages[0].rstrip().endswith(f"/ {done.pages}")
    assert len(list(document.get_toc())) == len(report.chapters[0].sections) - 1
    document.close()


def test_arcs_are_curves_through_their_ends_about_their_centre() -> None:
    runs = vectors.path_of("M10 0A10 10 0 0 1 0 10")
    assert runs[0] == ("M", [10.0, 0.0])
    assert runs[-1][1][-2:] == pytest.approx([0.0, 10.0])
    for kind, curve in runs[1:]:
        assert kind == "C"
        x0, y0, x1, y1, x2, y2, x3, y3 = [10.0, 0.0, *curve]
        t = np.linspace(0.0, 1.0, 33)
        b = [(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3]
        x, y = (
            sum(w * v for w, v in zip(b, p, strict=True))
            for p in ((x0, x1, x2, x3), (y0, y1, y2, y3))
        )
        assert np.hypot(x, y) == pytest.approx(10.0, abs=3e-3)
    around = vectors.path_of("M0 0a6 6 0 1 0 12 0a6 6 0 1 0 -12 0")
    assert around[-1][1][-2:] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert vectors.path_of("M1 2h3v4l-1 -1 2 2H0V0z")[-1] == ("Z", [])


def test_colours_of_the_style_sheet_are_light_on_paper() -> None:
    svg = f'<svg viewBox="0 0 10 10"><path d="M0 0L9 9" stroke="{LOST}"/><text x="1">φ</text></svg>'
    picture = vectors.drawing(svg, 100.0)
    path = picture.contents[0].contents[0]
    assert path.strokeColor.hexval() == "0xd55e00"
    assert picture.height == pytest.approx(100.0)


# --- the command ---------------------------------------------------------------------------


def test_the_command_writes_beside_and_says_what(tmp_path: Path, here: Run) -> None:
    file = tmp_path / "review.html"
    said = answered(
        here("report", "five-bar", "-o", str(file), "--resolution", "preview", "--json")
    )
    assert said["schema"] == "bohemia/report/1"
    assert said["file"] == str(file)
    assert said["size_bytes"] == file.stat().st_size
    assert said["pages"] is None
    assert [each["name"] for each in said["designs"]] == ["five-bar"]
    assert [path.name for path in tmp_path.iterdir()] == ["review.html"]


def test_a_session_is_reported_as_it_was_left(tmp_path: Path, here: Run) -> None:
    review = new_review(load_design("five-bar"))
    review = replace(review, pose=(120.0, 700.0))
    review = review.having(replace(review[Plan], on=True, samples=11))
    kept, file = tmp_path / "kept.json", tmp_path / "review.pdf"
    session.save(review, kept)
    said = answered(here("report", str(kept), "-o", str(file), "--paper", "letter", "--json"))
    assert said["paper"] == "letter"
    document = pypdfium2.PdfDocument(file.read_bytes())
    text = " ".join(page.get_textpage().get_text_bounded() for page in document)
    assert "x 120.0, y 700.0 mm" in text
    assert "O′ travels" in text
    document.close()


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["report"], "DESIGN"),
        (["report", "five-bar"], "-o review.html"),
        (["report", "five-bar", "-o", "review.txt"], ".html, .pdf"),
        (["report", "nothing", "-o", "review.pdf"], "no preset and no file"),
        (["report", *["five-bar"] * 5, "-o", "review.pdf"], "at most 4 designs"),
        (["report", "five-bar", "--paper", "a3", "-o", "review.pdf"], "a4, letter"),
    ],
)
def test_what_cannot_be_reported_is_said(
    words: list[str], why: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert why in refused(here(*words))
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["html", "pdf"])
def test_two_designs_with_their_maps(kind: str, tmp_path: Path, bohemia: Run) -> None:
    file = tmp_path / f"review.{kind}"
    said = answered(bohemia("report", "rpur-table1", "rpur-table2", "-o", str(file), "--json"))
    assert said["size_bytes"] < LARGEST
    text = json.dumps(said)
    assert "rpur-table2" in text
