"""Design files: the presets, reading back what was written, and every message."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinematics.designs import assets, files
from kinematics.designs.files import (
    load_design,
    presets,
    read_design,
    write_design,
)
from kinematics.errors import DesignError, InputError
from kinematics.machine import machine_of
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign, Limb

LIMB = """
[[limb]]
base = [{x}, 30.0, 50.0]
platform = [-50.0, 0.0, 0.0]
link = 150.0
stroke = [250.0, 400.0]
"""
HEAD = 'mechanism = "five_rpur"\ntitle = "A design"\nsource = "None"\n'
GOOD = HEAD + "".join(LIMB.format(x=x) for x in (-55.0, 245.0, 20.0, 200.0, 0.0))

PAPER_STROKE = (250.0, 400.0)
TABLE_1 = (
    ((-55, 30, 50), (-50, 0, 0)),
    ((245, 30, 50), (50, 0, 0)),
    ((20, 205, 0), (0, 50, 0)),
    ((200, 180, 0), (0, 50, -50)),
    ((0, 0, 0), (0, -50, -50)),
)
TABLE_2 = (
    ((0, 0, 0), (0, -50, 0)),
    ((245, 0, 0), (0, -50, 0)),
    ((-50.8, 127, -50.8), (0, 50, 0)),
    ((203.2, 127, -50.8), (0, 50, 0)),
    ((-101.6, 50.8, 0), (-50, 0, 0)),
)


def message(text: str, origin: str = "mine.toml") -> str:
    with pytest.raises(DesignError) as caught:
        read_design(text, origin=origin)
    said = str(caught.value)
    assert "\n" not in said
    return said


def test_presets_are_those_of_the_contract_and_name_their_sources() -> None:
    found = {preset.name: preset for preset in presets()}
    classes = ("a1a1", "a1a2", "a1a3", "a2a2", "a2a3", "a3a3", "mpa1", "mpa2", "mpa3")
    expected = {"rpur-table1", "rpur-table1-icee", "rpur-table2", *(f"rpur-{c}" for c in classes)}
    assert expected <= set(found)
    for preset in found.values():
        design = load_design(preset.name)
        assert (preset.mechanism, preset.title) == (design.mechanism, design.title)
        assert preset.title
        assert preset.source == design.source
        assert preset.source
        assert design.name == preset.name


@pytest.mark.parametrize(("name", "table"), [("rpur-table1", TABLE_1), ("rpur-table2", TABLE_2)])
def test_the_journal_tables_are_as_printed(name: str, table: tuple[object, ...]) -> None:
    design = load_design(name)
    assert isinstance(design, FiveRPURDesign)
    assert tuple((limb.base, limb.platform) for limb in design.limbs) == table
    assert {(limb.link, limb.stroke) for limb in design.limbs} == {(150.0, PAPER_STROKE)}


def test_the_conference_table_differs_in_one_number() -> None:
    journal, conference = (load_design(n) for n in ("rpur-table1", "rpur-table1-icee"))
    assert isinstance(journal, FiveRPURDesign)
    assert isinstance(conference, FiveRPURDesign)
    assert conference.limbs[4].platform == (0.0, 50.0, -50.0)
    assert conference.limbs[:4] == journal.limbs[:4]
    assert conference.limbs[4].base == journal.limbs[4].base


def test_presets_are_found_in_an_installed_wheel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "_assets" / "designs"
    folder.mkdir(parents=True)
    (folder / "only.toml").write_text(GOOD, encoding="utf-8")
    with _fresh_presets():
        monkeypatch.setattr(assets, "__file__", str(tmp_path / "designs" / "assets.py"))
        assert [preset.name for preset in presets()] == ["only"]
        monkeypatch.undo()


class _fresh_presets:
    def __enter__(self) -> None:
        self._clear()

    def __exit__(self, *_: object) -> None:
        self._clear()

    def _clear(self) -> None:
        for cached in (files.presets, files._preset, files._preset_paths):
            cached.cache_clear()


# --- reading back --------------------------------------------------------------------------

number = st.floats(-1e6, 1e6, allow_subnormal=False)
point = st.tuples(number, number, number)


@st.composite
def limbs(draw: st.DrawFn) -> Limb:
    low = draw(st.floats(0, 5e5, allow_subnormal=False))
    high = draw(st.floats(math.nextafter(low, math.inf), 1e6, allow_subnormal=False))
    return Limb(draw(point), draw(point), draw(st.floats(1e-3, 1e6)), (low, high))


text = st.text(st.characters(exclude_categories=["Cs"]), max_size=40)
some_designs = st.builds(
    FiveRPURDesign, st.tuples(limbs(), limbs(), limbs(), limbs(), limbs()), st.just("x"), text, text
)


@given(some_designs)
def test_what_is_written_reads_back_equal(design: FiveRPURDesign) -> None:
    assert read_design(write_design(design), origin="written", name="x") == design


def test_every_preset_reads_back_equal() -> None:
    for preset in presets():
        design = load_design(preset.name)
        assert read_design(write_design(design), origin="written", name=preset.name) == design


def test_a_file_is_named_by_its_stem(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    design = load_design(path)
    assert design.name == "mine"
    assert design.title == "A design"


def test_title_and_source_may_be_left_out() -> None:
    design = read_design(GOOD.replace('title = "A design"\nsource = "None"\n', ""), origin="x")
    assert (design.title, design.source) == ("", "")


def test_integers_are_numbers_and_rho_min_may_be_zero() -> None:
    design = read_design(GOOD.replace("[250.0, 400.0]", "[0, 400]"), origin="x")
    assert isinstance(design, FiveRPURDesign)
    assert design.limbs[0].stroke == (0.0, 400.0)
    assert all(isinstance(v, float) for v in design.limbs[0].stroke)


# --- what is refused -----------------------------------------------------------------------


def third(old: str, new: str) -> str:
    """GOOD with one line of limb 3 replaced; its header stands on line 17."""
    parts = GOOD.split("[[limb]]")
    assert old in parts[3]
    parts[3] = parts[3].replace(old, new)
    return "[[limb]]".join(parts)


BASE = "base = [20.0, 30.0, 50.0]"  # line 18; platform 19, link 20, stroke 21
LINK, STROKE = "link = 150.0", "stroke = [250.0, 400.0]"


@pytest.mark.parametrize(
    ("text", "fragments"),
    [
        (third(LINK, "lnik = 150.0"), ["line 20", "limb 3", "'lnik'", "did you mean 'link'?"]),
        (third(LINK, LINK + "\nmass = 1"), ["line 21", "limb 3", "'mass'", "known are base"]),
        (third(LINK, ""), ["line 17", "limb 3", "'link' is missing"]),
        (third(LINK, "link = 0.0"), ["line 20", "limb 3: link", "positive", "got 0"]),
        (third(LINK, "link = -150"), ["line 20", "limb 3: link", "positive", "got -150"]),
        (third(LINK, "link = true"), ["line 20", "limb 3: link", "number", "got true"]),
        (third(LINK, 'link = "150"'), ["line 20", "limb 3: link", "number", "got '150'"]),
        (third(LINK, "link = nan"), ["line 20", "limb 3: link", "finite", "got nan"]),
        (third(LINK, "link = inf"), ["line 20", "limb 3: link", "finite", "got inf"]),
        (third(LINK, "link = 1e7"), ["line 20", "limb 3: link", "±1000000 mm", "unit"]),
        (third(LINK, "link = 1" + "0" * 500), ["line 20", "limb 3: link", "±1000000 mm"]),
        (third(LINK, "link = [150.0]"), ["line 20", "limb 3: link", "number", "got a list"]),
        (third(LINK, "link = {a = 1}"), ["line 20", "limb 3: link", "number", "got a table"]),
        (third(LINK, "link = 2011-04-01"), ["line 20", "limb 3: link", "got something else"]),
        (third(BASE, "base = [20.0, 30.0]"), ["line 18", "limb 3: base", "3 numbers", "got 2"]),
        (third(BASE, "base = 20.0"), ["line 18", "limb 3: base", "list of 3", "got 20.0"]),
        (
            third(BASE, "base = [\n  20.0, # x\n  nan,\n  1,\n]"),
            ["line 18", "limb 3: base: number 2", "finite"],
        ),
        (third(BASE, "base = [0, false, 0]"), ["limb 3: base: number 2", "got false"]),
        (third(BASE, "base = [0, 0, 2e6]"), ["limb 3: base: number 3", "±1000000"]),
        (third(STROKE, "stroke = [400, 250]"), ["line 21", "limb 3: stroke", "ρ_min < ρ_max"]),
        (third(STROKE, "stroke = [400, 400]"), ["line 21", "ρ_min < ρ_max", "[400, 400]"]),
        (third(STROKE, "stroke = [-1, 400]"), ["line 21", "ρ_min must not be negative", "got -1"]),
        (third(STROKE, "stroke = [1, 2, 3]"), ["line 21", "limb 3: stroke", "2 numbers", "got 3"]),
        (third(LINK, LINK + "\n" + LINK), ["line 21", "not valid TOML", "correct it"]),
        (third(LINK, "link = 15O.0"), ["line 20", "not valid TOML", "column"]),
        (GOOD + LIMB.format(x=1.0), ["line 35", "5 tables [[limb]]", "found 6"]),
        (GOOD.rsplit("[[limb]]", 1)[0], ["line 23", "5 tables [[limb]]", "found 4"]),
        (HEAD, ["'limb' is missing"]),
        (HEAD + "limb = 3", ["line 4", "5 tables", "[[limb]]"]),
        (HEAD + "limb = []", ["line 4", "5 tables", "found 0"]),
        (HEAD + "limb = [1, 2, 3, 4, 5]", ["line 4", "limb 1", "must be a table"]),
        (HEAD + "[limb]\nbase = 1", ["line 4", "5 tables", "[[limb]]"]),
        (GOOD.replace(HEAD, ""), ["'mechanism' is missing", "known are five_rpur"]),
        (
            GOOD.replace("mechanism", "mechanisn"),
            ["line 1", "'mechanism' is missing", "'mechanisn'"],
        ),
        (GOOD.replace("five_rpur", "five_rpu"), ["line 1", "did you mean 'five_rpur'?"]),
        (GOOD.replace('"five_rpur"', '"x"'), ["line 1", "'x'", "known are five_rpur"]),
        (GOOD.replace('"five_rpur"', "5"), ["line 1", "no mechanism 5"]),
        (GOOD.replace('"five_rpur"', '["five_rpur"]'), ["line 1", "no mechanism a list"]),
        (GOOD.replace('"A design"', "5"), ["line 2", "title must be text", "got 5"]),
        (GOOD.replace("source =", "sauce ="), ["line 3", "'sauce'", "did you mean 'source'?"]),
        (GOOD.replace('"A design"', '"A design'), ["line 2", "not valid TOML"]),
        (GOOD + "x = [1,", ["not valid TOML"]),
        (GOOD + "x = " + "[" * 5000, ["too deeply"]),
        ("", ["'mechanism' is missing"]),
        ("# " + "x" * files.MAX_BYTES, ["256 kB"]),
        ("# " + "ρ" * (files.MAX_BYTES // 2), ["256 kB"]),
        ("\0", ["not valid TOML"]),
    ],
)
def test_a_broken_design_is_refused_in_one_sentence(text: str, fragments: list[str]) -> None:
    said = message(text)
    assert said.startswith("mine.toml")
    for fragment in fragments:
        assert fragment in said


@given(st.text(max_size=200))
def test_any_text_is_a_design_or_a_message(text: str) -> None:
    message(text)  # no such text is a design


@given(st.integers(0, len(GOOD) - 1), st.characters(exclude_categories=["Cs"]))
def test_a_slip_of_the_pen_never_raises_anything_else(place: int, character: str) -> None:
    said = "slip: read"
    try:
        read_design(GOOD[:place] + character + GOOD[place + 1 :], origin="slip")
    except DesignError as error:
        said = str(error)
    assert re.match(r"slip(, line \d+)?: .", said)


def test_what_cannot_be_opened_is_said(tmp_path: Path) -> None:
    binary = tmp_path / "picture.toml"
    binary.write_bytes(b"\x89PNG\xff\xfe")
    large = tmp_path / "large.toml"
    large.write_bytes(b"#" * (files.MAX_BYTES + 1))
    for place, fragment in ((binary, "UTF-8"), (large, "256 kB"), (tmp_path, "cannot be read")):
        with pytest.raises(DesignError, match=fragment):
            load_design(place)


@pytest.mark.parametrize(
    ("name", "fragment"),
    [
        ("rpur-tabel1", "did you mean rpur-table1"),
        ("qqqqqq", "the presets are .*rpur-table2"),
        ("", "no preset and no file"),
        ("a\0b", "no preset and no file"),
        ("x" * 5000, "no preset and no file"),
    ],
)
def test_an_unknown_name_lists_what_there_is(name: str, fragment: str) -> None:
    with pytest.raises(DesignError, match=fragment):
        load_design(name)


# --- numbers that may be edited ------------------------------------------------------------


def test_fields_are_all_numbers_of_a_design_and_each_can_be_changed() -> None:
    design = load_design("rpur-table1")
    fields = machine_of(design).fields
    assert len({field.path for field in fields}) == len(fields) == 45
    for field in fields:
        changed = machine_of(design).edited(field.path, field.value + 0.5).design
        values = {f.path: f.value for f in machine_of(changed).fields}
        assert values.pop(field.path) == field.value + 0.5
        assert values == {f.path: f.value for f in fields if f.path != field.path}
        assert (changed.name, changed.title) == (design.name, design.title)
        assert machine_of(changed).edited(field.path, field.value).design == design


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (("limb", 2, "link"), -1.0, r"^limb 3: link must be a positive length"),
        (("limb", 0, "stroke", 0), 500.0, r"^limb 1: stroke must be \[ρ_min, ρ_max\]"),
        (("limb", 4, "base", 1), math.nan, r"^limb 5: base: number 2 must be a finite number"),
        (("limb", 4, "base", 1), math.inf, r"^limb 5: base: number 2 must be a finite number"),
        (("limb", 5, "link"), 1.0, r"no number 'limb.5.link'"),
        (("limb", 0, "colour"), 1.0, r"no number 'limb.0.colour'"),
        ((), 1.0, r"no number ''"),
    ],
)
def test_a_wrong_edit_is_refused(path: tuple[str | int, ...], value: float, said: str) -> None:
    with pytest.raises(InputError, match=said):
        machine_of(load_design("rpur-table1")).edited(path, value)
