"""The papers recomputed: every row has a verdict, and each verdict can turn out otherwise."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.features.paper.figures import drawn
from app.features.paper.items import PAPERS, Item, paper
from app.features.paper.judging import (
    Quantity,
    agreement,
    claimed,
    compared,
    identity,
)
from app.features.paper.judging import drawn as is_drawn
from app.features.paper.registry import Recomputed, recompute
from kinematics.errors import ComputationError, InputError
from tests.conftest import Finished

# Counted by hand in the papers: tables, figures (those in panels panel by panel), equations, and
# claims of the text; one formula without a number and one thing that a paper leaves out besides.
COUNTS = {
    "meccanica-2011": (2, 21, 43, 21, 0),
    "icee-2010": (1, 11, 16, 9, 0),
    "sps-spr-2017": (0, 8, 16, 8, 2),
    "rps-spr-2017": (0, 8, 15, 15, 0),
    "five-bar-2017": (4, 14, 30, 5, 0),
}
QUICK = ("sps-spr-2017", "rps-spr-2017", "five-bar-2017")
WRONG = {  # what is known to be misprinted, or claimed wrongly, by independent computations
    "meccanica-2011": {
        *("Table 1", "Fig. 19", "eq. 10", "eq. 12", "eq. 13", "eq. 19", "eq. 22", "eq. 23"),
        *("eq. 24", "eq. 25", "eq. 29", "eq. 40", "eq. 41", "eq. 43"),
        *("C10", "C11", "C12", "C18", "C19", "C20", "C21"),
    },
    "icee-2010": {
        *("Table I", "eq. 6", "eq. 8", "eq. 9", "eq. 10", "eq. 12", "eq. 14", "C2", "C4"),
    },
    "sps-spr-2017": {"R after eq. 3", "eq. 9", "eq. 13"},
    "rps-spr-2017": {
        *("Fig. 5(a)", "Fig. 5(b)", "eq. 1", "eq. 5", "eq. 7", "eq. 15", "C5", "C7", "C8", "C9"),
        *("C11", "C12", "C13", "C14"),
    },
    "five-bar-2017": {
        *("eq. 7", "eq. 10", "eq. 11", "eq. 12", "eq. 14", "eq. 15", "eq. 24", "eq. 27", "C3"),
    },
}


def _all(name: str) -> dict[str, Recomputed]:
    return {item.name: recompute(item) for item in paper(name).items}


def _number(found: Recomputed, what: str) -> float:
    """A computed value by the beginning of its name."""
    values = [q.computed for q in found.outcome.quantities if q.what.startswith(what)]
    assert len(values) == 1
    assert isinstance(values[0], float | int)
    return float(values[0])


# --- the lists -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", PAPERS)
def test_every_row_of_a_paper_is_an_item(name: str) -> None:
    items = paper(name).items
    names = [item.name for item in items]
    assert len(set(names)) == len(names)
    kinds = [sum(n.startswith(begin) for n in names) for begin in ("Table", "Fig.", "eq.")]
    claims = sum(n[0] == "C" and n[1:].isdigit() for n in names)
    tables, figures, equations, texts, more = COUNTS[name]
    assert (*kinds, claims) == (tables, figures, equations, texts)
    assert len(names) - sum(kinds) - claims == more
    for item in items:
        assert item.what
        assert not item.missing.endswith(".")
        assert item.printed or item.picture or not item.is_figure


def test_there_is_no_other_paper() -> None:
    with pytest.raises(InputError, match="known are meccanica-2011"):
        paper("meccanica")


def _check(name: str) -> dict[str, Recomputed]:
    found = _all(name)
    assert {n for n, each in found.items() if each.verdict == "corrected"} == WRONG[name]
    for each in found.values():
        assert each.why
        if each.verdict != "impossible":
            assert each.computed
            told = [q for q in each.outcome.quantities if q.printed is not None]
            if each.verdict == "reproduced":
                assert all(q.agrees for q in told)
    return found


@pytest.mark.parametrize("name", QUICK)
def test_a_whole_paper(name: str) -> None:
    _check(name)


@pytest.mark.slow
def test_all_papers_by_the_command(bohemia: Callable[..., Finished]) -> None:
    answer = json.loads(bohemia("paper", "--json").stdout)
    assert answer["schema"] == "bohemia/paper/1"
    assert answer["counts"]["items"] == sum(map(sum, COUNTS.values())) >= 238
    beside = [e for e in answer["items"] if e["computed"] and (e["printed"] or e["picture"])]
    assert len(beside) >= 140
    for name in PAPERS:
        wrong = {
            e["item"] for e in answer["items"] if e["paper"] == name and e["verdict"] == "corrected"
        }
        assert wrong == WRONG[name]


# --- values that others have computed ------------------------------------------------------


def test_the_five_bars_numbers() -> None:
    found = {n: recompute(paper("five-bar-2017").item(n)) for n in ("Fig. 9", "Fig. 6", "eq. 18")}
    assert _number(found["Fig. 9"], "area") == pytest.approx(19833.838618, abs=1e-6)
    assert _number(found["Fig. 6"], "σ of y") == pytest.approx(7.95e-3, abs=5e-6)
    assert all(q.agrees for q in found["eq. 18"].outcome.quantities)


def test_the_tripods_circles() -> None:
    found = recompute(paper("rps-spr-2017").item("C5"))
    assert _number(found, "MICR, mode 1") == pytest.approx(25.180332377705, abs=1e-9)
    assert _number(found, "MICR, mode 2") == pytest.approx(30.0, abs=1e-9)
    found = recompute(paper("rps-spr-2017").item("C6"))
    assert _number(found, "3-RPS, mode 2") == pytest.approx(39.219478757478, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "verdict"),
    [
        ("eq. 1", "reproduced"),
        ("eq. 12", "corrected"),
        ("eq. 25", "corrected"),
        ("eq. 27", "reproduced"),
        ("eq. 35", "reproduced"),
        ("eq. 43", "corrected"),
        ("Fig. 13", "reproduced"),
        ("C7", "reproduced"),
        ("C11", "corrected"),
    ],
)
@pytest.mark.slow
def test_some_of_the_journal_paper(name: str, verdict: str) -> None:
    assert recompute(paper("meccanica-2011").item(name)).verdict == verdict


def test_the_vertex_spaces_volume() -> None:
    from app.features.paper.recomputed.rpur_space import by_quadrature

    exact = by_quadrature()
    assert exact["whole"] == pytest.approx(159_552_169, abs=1)
    # B is the union of B⁺ and B⁻, whose volume has a closed form.
    half = 2 * 150 * np.pi * (400**2 - 250**2)
    assert half < exact["whole"] < 2 * half
    # The main body is a dome's shape: 2l · (area between) in both directions.
    assert exact["body"] == pytest.approx(2 * np.pi * 400 * 150 * (400 + 150), rel=1e-9)


# --- verdicts can turn out otherwise -------------------------------------------------------


def _with(name: str, item: str, **data: object) -> Item:
    known = paper(name).item(item)
    return replace(known, data={**known.data, **data})


def test_another_printed_number_is_another_verdict() -> None:
    powers = ["1.885", "-0.313", "0.00275", "-0.0484"]
    changed = replace(_with("five-bar-2017", "eq. 16", powers=powers), correction="a slip")
    found = recompute(changed)
    assert found.verdict == "corrected"
    assert "printed -0.0484" in found.why
    with pytest.raises(ComputationError, match="nobody says why"):
        recompute(_with("five-bar-2017", "eq. 16", powers=powers))


def test_a_right_number_is_not_corrected() -> None:
    changed = _with("rps-spr-2017", "C5", values=["25.18", "30.00"])
    assert recompute(changed).verdict == "reproduced"


def test_another_load_is_held_otherwise() -> None:
    item = _with("sps-spr-2017", "C7", load=[0, 0, -100, 0, 0, 0])
    forces = [q.computed for q in recompute(item).outcome.quantities]
    own = [q.computed for q in recompute(paper("sps-spr-2017").item("C7")).outcome.quantities]
    assert forces != own


@pytest.mark.parametrize(
    ("printed", "computed", "agree"),
    [
        ("25.22", 25.2229, (4, 4)),
        ("25.22", 25.1803, (2, 4)),
        ("4.8900e-06", 4.89e-6, (5, 5)),
        ("-0.0483", -0.048346, (3, 3)),
        ("−36.080", -36.0805, (5, 5)),
        ("0", 0.2, (1, 1)),
        ("96", 96.0, (2, 2)),
        ("48", 96.0, (0, 2)),
        ("7", -7.0, (0, 1)),
    ],
)
def test_digits_that_agree(printed: str, computed: float, agree: tuple[int, int]) -> None:
    assert agreement(printed, computed) == agree


def test_verdicts() -> None:
    assert identity(1e-13, where="here").verdict == "reproduced"
    assert identity(0.3, 1e-13, where="here").verdict == "corrected"
    for printed, corrected in ((0.3, None), (0.3, 0.2), (1e-6, 1e-13), (float("nan"), 1e-13)):
        with pytest.raises(ComputationError, match="neither form"):
            identity(printed, corrected, where="here")
    assert compared(Quantity("q", 2.0, "2")).verdict == "reproduced"
    assert compared(Quantity("q", 2.0, "2"), Quantity("r", 3.0, "4")).verdict == "corrected"
    assert claimed(False, proof="").verdict == "corrected"
    with pytest.raises(ComputationError, match="nothing printed"):
        compared(Quantity("q", 2.0))
    with pytest.raises(ComputationError, match="do not agree"):
        is_drawn(False, proof="")
    with pytest.raises(ComputationError, match="not a number"):
        agreement("about 3", 3.0)


# --- the command and its folder ------------------------------------------------------------


@pytest.mark.slow
def test_the_folder(bohemia: Callable[..., Finished], tmp_path: Path) -> None:
    to = tmp_path / "made" / "here"
    done = bohemia("paper", "rps-spr-2017", "-o", str(to), "--json")
    assert done.code == 0
    answer = json.loads(done.stdout)
    assert answer["folder"] == str(to)
    there = {str(path.relative_to(to)) for path in to.rglob("*") if path.is_file()}
    assert there == {*answer["files"]}
    for name in (
        "index.html",
        "rps-spr-2017.csv",
        "rps-spr-2017/fig-3a.svg",
        "rps-spr-2017/fig-5b.png",
        "rps-spr-2017/fig-4a.csv",
    ):
        assert name in there
        assert (to / name).stat().st_size > 200
    page = (to / "index.html").read_text(encoding="utf-8")
    for entry in answer["items"]:
        assert f'data-verdict="{entry["verdict"]}"' in page
        assert f'>{entry["item"]} <span class="what">' in page
    assert page.count("<article") == len(answer["items"])
    rows = (to / "rps-spr-2017" / "fig-4a.csv").read_text().splitlines()
    assert len(rows) == 1 + 8 * 80


def test_what_is_typed_wrong(bohemia: Callable[..., Finished], tmp_path: Path) -> None:
    done = bohemia("paper", "nature-1999")
    assert done.code == 2
    assert "there is no paper 'nature-1999'; known are meccanica-2011" in done.stderr
    file = tmp_path / "file"
    file.write_text("")
    done = bohemia("paper", "five-bar-2017", "-o", str(file))
    assert done.code == 2
    assert "cannot make the folder" in done.stderr


@pytest.mark.slow
def test_solids_of_the_journal_paper() -> None:
    files = drawn(paper("meccanica-2011").item("Fig. 13"))
    assert {*files} == {f"fig-13.{kind}" for kind in ("svg", "png", "stl", "glb")}
    triangles = int(np.frombuffer(files["fig-13.stl"][80:84], dtype="<u4")[0])
    assert len(files["fig-13.stl"]) == 84 + 50 * triangles
    assert triangles > 2000
