"""`bohemia compare`: its text, its JSON, its folder, and what it says when it cannot."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import ezdxf
import pytest
import trimesh

from tests.conftest import answered, refused


@pytest.mark.slow
def test_two_designs_in_json_and_as_a_folder(bohemia: Any, tmp_path: Path) -> None:
    command = ("compare", "rpur-table1", "rpur-table2", "--phi", "5", "--modes", "+-+-+")
    data = answered(bohemia(*command, "--json", "-o", str(tmp_path / "review")))
    assert data["schema"] == "bohemia/compare/1"
    one, other = data["designs"]
    for design, only in zip((one, other), data["only"], strict=True):
        assert only["design"] == design["name"]
        error = design["error_mm3"] + data["common_error_mm3"] + only["error_mm3"]
        assert abs(data["common_mm3"] + only["volume_mm3"] - design["volume_mm3"]) <= error
    alone = answered(bohemia("volume", "rpur-table2", "--phi", "5", "--modes", "+-+-+", "--json"))
    assert other["volume_mm3"] == pytest.approx(alone["volume_mm3"], rel=1e-9)
    assert other["at_pose"]["reasons"]
    assert one["at_pose"]["reachable"]
    fields = {each["field"]: each for each in data["differences"]}
    assert fields["limb.0.base.0"]["values"] == [-55.0, 0.0]
    assert "limb.0.link" not in fields
    best = {row["key"]: row["best"] for row in data["measures"]}
    assert best["volume"] == [max((one, other), key=lambda d: d["volume_mm3"])["name"]]
    folder = Path(data["file"])
    names = {path.name for path in folder.iterdir()}
    stems = {"common.stl", "only-A_rpur-table1.stl", "only-B_rpur-table2.stl"}
    assert names == stems | {"sizes.csv", "measures.csv", "differences.csv", "areas.csv"}
    solid = trimesh.load(folder / "common.stl")
    assert solid.is_watertight
    assert solid.volume == pytest.approx(data["common_mm3"], rel=0.01)
    rows = list(csv.DictReader((folder / "sizes.csv").read_text().splitlines()))
    assert float(rows[2]["size_mm3"]) == data["common_mm3"]


def test_plane_workspaces_have_areas(bohemia: Any, tmp_path: Path) -> None:
    shorter = tmp_path / "shorter.toml"
    answer = bohemia("compare", "five-bar", "five-bar", "--json")
    data = answered(answer)
    assert data["common_mm2"] == pytest.approx(data["designs"][0]["area_mm2"], rel=1e-12)
    assert [only["area_mm2"] for only in data["only"]] == [0.0, 0.0]
    shorter.write_text(
        'mechanism = "five_bar"\nproximal = 400.0\ndistal = 480.0\nhalf_base = 150.0\n'
    )
    folder = tmp_path / "out"
    text = bohemia("compare", "five-bar", str(shorter), "-o", str(folder))
    assert text.code == 0
    assert "only B" in text.stdout
    assert "proximal" in text.stdout
    assert ezdxf.readfile(folder / "common.dxf").units == 4


@pytest.mark.slow
def test_designs_of_different_coordinates_still_have_numbers(bohemia: Any) -> None:
    data = answered(bohemia("compare", "five-bar", "rps-3", "--json"))
    assert data["common_mm3"] is None
    assert data["only"] == []
    assert "plane workspace" in data["why_not"]
    assert data["designs"][1]["at_pose"]["reachable"] is None


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("rpur-table1",), "two to 4 designs"),
        (("rpur-table1", "no-such-design"), "no-such-design"),
        (("rpur-table1", "rpur-a1a1", "--modes", "+-+-+"), "mode"),
        (("rpur-table1", "rpur-table2", "-o", "/no/such/folder"), "folder"),
        (("rpur-table1", "rpur-table2", "--gamma", "3"), "--gamma"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(
    bohemia: Any, words: tuple[str, ...], told: str
) -> None:
    assert told in refused(bohemia("compare", *words))
