"""The catalogue of the page's texts: it and the program agree, and a translation is one file."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import pytest

import kinematics as kin
from app import language
from app.features import each
from app.language import about, catalogue, fields, hint, menu, tr, use
from app.widgets.desk import Panel
from kinematics.errors import InputError
from kinematics.mechanism import mechanism_kinds
from tests.app.seats import seat

APP = Path(__file__).parents[2] / "app"
ENGLISH = catalogue("en")
SECTIONS = {key.partition(".")[0] for key in ENGLISH}
CALLS = ("tr", "hint", "menu")
ANY = r"[\w ]+"  # what is put into a key
HELP = ANY + r"\.help"  # of each tab
BESIDE = ("_hint", "_label")  # endings of the keys that go with another one


@lru_cache
def _trees() -> dict[str, ast.Module]:
    files = sorted(APP.rglob("*.py"))
    return {str(f.relative_to(APP)): ast.parse(f.read_text(encoding="utf-8")) for f in files}


def _named() -> Iterator[tuple[str, str]]:
    """Each key in the program, with its file, as a pattern."""
    for file, tree in _trees().items():
        groups = {
            id(call.args[0])
            for call in ast.walk(tree)
            if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "menu"
        }
        for node in ast.walk(tree):
            pattern = _pattern(node)
            if pattern == HELP or (pattern and pattern.partition(r"\.")[0] in SECTIONS):
                yield pattern + r"\.\w+" * (id(node) in groups), file


def _pattern(node: ast.AST) -> str | None:
    """A string that may be a key: "move.pose", or f"keys.{name}"."""
    parts = node.values if isinstance(node, ast.JoinedStr) else [node]
    texts = []
    for part in parts:
        if isinstance(part, ast.FormattedValue):
            texts.append(ANY)
        elif isinstance(part, ast.Constant) and isinstance(part.value, str):
            texts.append(re.escape(part.value))
        else:
            return None
    pattern = "".join(texts)
    shape = pattern.replace(ANY, "any")
    return pattern if re.fullmatch(r"\w+(\\\.\w+)+", shape) else None


def test_the_program_asks_for_no_text_that_is_not_there() -> None:
    missing = [
        (pattern, file)
        for pattern, file in _named()
        if not any(re.fullmatch(pattern, key) for key in ENGLISH)
    ]
    assert not missing


def test_every_text_is_used() -> None:
    patterns = {pattern for pattern, _ in _named()}
    assert len(patterns) > 200
    used = {key for key in ENGLISH if any(re.fullmatch(pattern, key) for pattern in patterns)}
    assert {
        key
        for key in ENGLISH
        if key not in used
        and not any(key.endswith(end) and key.removesuffix(end) in used for end in BESIDE)
    } == set()


def test_values_are_given_for_the_fields_that_a_text_has() -> None:
    wrong = []
    for file, tree in _trees().items():
        for call in ast.walk(tree):
            if not isinstance(call, ast.Call) or getattr(call.func, "id", "") != "tr":
                continue
            given = {str(each.arg) for each in call.keywords}
            keys = [n.value for n in ast.walk(call.args[0]) if isinstance(n, ast.Constant)]
            known = [key for key in keys if key in ENGLISH]  # of a choice between some
            wanted = {name for key in known for name in fields(ENGLISH[key])}
            wanted |= {"n"} if any(len(ENGLISH[key]) > 1 for key in known) else set()
            if known and given != wanted:
                wrong.append((file, keys, given))
    assert not wrong


def test_texts_are_asked_for_when_they_are_shown() -> None:
    """What a module asks for while it is loaded would be in the language of before."""
    early = []
    for file, tree in _trees().items():
        later: set[int] = set()
        for node in ast.walk(tree):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
                bodies = node.body if isinstance(node.body, list) else [node.body]
                later |= {id(inner) for body in bodies for inner in ast.walk(body)}
        early += [
            (file, call.lineno)
            for call in ast.walk(tree)
            if isinstance(call, ast.Call)
            and getattr(call.func, "id", "") in CALLS
            and id(call) not in later
        ]
    assert not early


WORDS = re.compile(r"[^\W\d_]{2,}[,:;]? [^\W\d_]{2,}|^[A-Z][a-z]{2,}$")
TAGS = re.compile(r"<style>.*?</style>|<[^>]*>?", re.DOTALL)
ROOMS = ("features", "widgets", "scene", "review", "jobs")
ELSEWHERE = re.compile(r"(command|files)\.py$|^jobs/executors\.py$|^features/(paper|report)/")
"""What files hold, reports among them, and what the terminal says: a cluster, papers recomputed."""
NO_WORDS = (
    "!important",  # looks: style sheets, classes, fonts
    "linear-gradient",
    "border-left",
    "sans-serif",
    "class=",
    "limb| |",
    "/labels/",  # nodes of the scene
    *("Pressed", "Pointer"),  # labels of boxes that nobody sees
    "Pointed at",
    "exact sections",  # facets of a machine, in errors that are the program's own
    "circles of orientations",
    "plane workspace",
    "another Bohemia",  # said at the terminal before there is a page
)
"""What strings contain that are like words and that no page shows."""


def _texts(tree: ast.Module) -> Iterator[str]:
    """The strings of a module but for docstrings and logs, with | for what is put into them."""
    skipped: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            skipped.add(id(node.value))
        elif isinstance(node, ast.JoinedStr):
            skipped |= {id(part) for part in node.values}
        elif isinstance(node, ast.Call) and ast.unparse(node.func).startswith("log."):
            skipped |= {id(inner) for inner in ast.walk(node)}
    for node in ast.walk(tree):
        parts = node.values if isinstance(node, ast.JoinedStr) else [node]
        if id(node) not in skipped and isinstance(node, (ast.JoinedStr, ast.Constant)):
            texts = [part.value if isinstance(part, ast.Constant) else "|" for part in parts]
            yield "".join(text for text in texts if isinstance(text, str))


def test_no_words_of_the_page_stand_outside_the_catalogue() -> None:
    found = [
        (text, file)
        for file, tree in _trees().items()
        if file.partition("/")[0] in ROOMS and not ELSEWHERE.search(file)
        for text in _texts(tree)
        if WORDS.search(TAGS.sub(" | ", text))
    ]
    assert [each for each in found if not any(known in each[0] for known in NO_WORDS)] == []
    assert all(any(known in text for text, _ in found) for known in NO_WORDS)  # none too many


@pytest.mark.parametrize("kind", mechanism_kinds())
def test_every_tab_says_what_it_shows_and_where_the_paper_has_it(kind: str) -> None:
    machine = kin.open(next(p.name for p in kin.presets() if p.mechanism == kind))
    served = [
        panel.__module__.split(".")[2] for panel in each("panel", Panel) if panel.serves(machine)
    ]
    in_paper = any("Fig" in text for text in about(kind, "move_paper"))
    assert in_paper or kind == "parallel"  # the one that no paper has
    for topic in {*served} - {"review", "compare", "marks"}:
        assert about(kind, topic), topic
        for paper in about(kind, f"{topic}_paper"):
            assert re.match(r"\*\*In the papers?\*\* ?(\(.* \d{4}\))?:", paper.replace("\n", " "))
        assert len(about(kind, f"{topic}_paper")) == 1 or not in_paper
        assert tr(f"{topic}.help").strip()


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where translations stand."""
    monkeypatch.setattr(language, "own_folder", lambda: tmp_path)
    monkeypatch.delenv(language.VARIABLE, raising=False)
    catalogue.cache_clear()
    yield tmp_path
    catalogue.cache_clear()


def test_a_page_in_another_language_shows_its_words(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = []
    for key, forms in ENGLISH.items():
        told = {name: f"«{text}»" for name, text in forms.items()}
        texts = ", ".join(f"{name} = {_quoted(text)}" for name, text in told.items())
        path = ".".join(map(_quoted, key.split(".")))
        one = _quoted(told["other"])
        lines.append(f"{path} = {{ {texts} }}" if len(told) > 1 else f"{path} = {one}")
    (folder / "made-up.toml").write_text("\n".join(lines), encoding="utf-8")
    monkeypatch.setenv(language.VARIABLE, "")  # is put back afterwards
    use("made-up")
    with seat("rpur-table1") as page:
        seen: set[str] = set()
        for name in ("rpur-table1", "spr-3", "sps-spr", "five-bar"):
            page.put("«Design»", name)
            assert all(title.startswith("«") for title in page.tabs)
            seen |= page.labels()
        assert "«Reachable»" in page.text()
    foreign = {label for label in seen if re.search(r"[A-Za-z]{3}", label)}
    english = {label for label in foreign if "«" not in label} - {
        "Pressed",
        "Pointer",
        "Pointed at",
    }
    assert {label for label in english if "following from" not in label} == set()  # kinematics'


def test_what_a_translation_leaves_out_is_english(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = '[move]\npose = "Lage"\nreaching = { 0 = "keiner von {of}", other = "{n} von {of}" }'
    (folder / "de.toml").write_text(text, encoding="utf-8")
    monkeypatch.setenv(language.VARIABLE, "")
    use("de")
    assert tr("move.pose") == "Lage"
    assert tr("move.actuators") == ENGLISH["move.actuators"]["other"]
    assert [tr("move.reaching", n=n, of=4) for n in (0, 1)] == ["keiner von 4", "1 von 4"]


@pytest.mark.parametrize(
    ("content", "wrong"),
    [
        ('[move]\nreaching = "{able} of {of}"', r"move.reaching: its fields are n, of"),
        ("[move", "not a file of texts"),
    ],
)
def test_a_translation_that_cannot_be_used_is_refused(
    folder: Path, content: str, wrong: str
) -> None:
    (folder / "xx.toml").write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=wrong):
        use("xx")


def test_a_language_that_is_not_there_is_refused_with_those_that_are(folder: Path) -> None:
    with pytest.raises(InputError, match="no language 'de'; known: en"):
        use("de")


def test_texts_with_a_count_a_hint_and_a_menu() -> None:
    assert tr("move.reaching", n=1, of=32) == "1 of 32 reaches this pose"
    assert tr("move.reaching", n=3, of=32) == "3 of 32 reach this pose"
    assert hint("move.typed") == tr("move.typed_hint")
    assert hint("move.actuators") is None
    assert menu("map.go") == {"Largest": "max", "Smallest": "min"}
