"""Files and answers as JSON Schema: what is read fits, and what does not fit is not read."""

from __future__ import annotations

import csv
import json
import tomllib
from collections.abc import Callable, Iterator
from contextlib import suppress
from copy import deepcopy
from typing import Any

import jsonschema
import pytest

from app.cli import COMMANDS
from app.review.session import from_text, json_schema, to_text
from app.review.state import new_review
from app.terminal.options import preset_names
from kinematics.designs import files
from kinematics.designs.files import load_design, read_design, write_design
from kinematics.designs.json_schemas import design_schema, path_schema
from kinematics.errors import DesignError, InputError
from kinematics.machine import machine_of
from kinematics.mechanism import mechanism_class, mechanism_kinds
from kinematics.trajectories.points import read_points
from tests import schemas
from tests.conftest import ROOT, Finished, refused

ONE_EACH = {load_design(name).mechanism: name for name in preset_names()}
DESIGNS = jsonschema.Draft202012Validator(design_schema())


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads((ROOT / "assets" / "designs" / f"{name}.toml").read_text("utf-8"))


def test_schemas_are_schemas() -> None:
    kinds = {each["properties"]["mechanism"]["const"] for each in DESIGNS.schema["oneOf"]}
    assert kinds == set(mechanism_kinds())
    for schema in (DESIGNS.schema, json_schema(), path_schema()):
        jsonschema.Draft202012Validator.check_schema(schema)


@pytest.mark.parametrize("name", preset_names())
def test_presets_fit_as_they_stand_and_as_they_are_written(name: str) -> None:
    DESIGNS.validate(_table(name))
    DESIGNS.validate(tomllib.loads(write_design(load_design(name))))


WRONG: list[Any] = ["text", True, {}, [], 2e6, [[[]]], -1e-3]


def _places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Everything that stands in a table, by its path."""
    for key, one in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*path, key)
        if isinstance(one, dict | list):
            yield from _places(one, (*path, key))


def _changed(table: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The table with one thing gone, put in another's place or added."""
    yield "a key more", {**table, "speed": 1.0}
    for path in _places(table):
        if path[0] == "limb" and path[1:2] > (0,):  # the others are like the first
            continue
        for n in range(len(WRONG) + 1):
            copy = deepcopy(table)
            place: Any = copy
            for step in path[:-1]:
                place = place[step]
            if n < len(WRONG):
                place[path[-1]] = WRONG[n]
            else:
                del place[path[-1]]
            yield f"{path} = {WRONG[n] if n < len(WRONG) else 'gone'!r}", copy


@pytest.mark.parametrize("name", [*ONE_EACH.values(), "rus-6", "spherical-agile-eye"])
def test_what_does_not_fit_is_not_read(name: str) -> None:
    kind = load_design(name).mechanism
    own = jsonschema.Draft202012Validator(mechanism_class(kind).schema.json_schema(kind))
    unfit = [(what, t) for what, t in _changed(_table(name)) if not own.is_valid(t)]
    assert len(unfit) > 40
    read = []
    for what, table in unfit:
        with suppress(DesignError):
            files._from_table(table, origin="", name="")
            read.append(what)
    assert read == []


@pytest.mark.parametrize(
    "text",
    [
        'mechanism = "three_rps"\nbase_radius = 1.0\nplatform_radius = 1.0\nstroke = [1.0]',
        'mechanism = "three_rps"\nbase_radius = 0.0\nplatform_radius = 1.0\nstroke = [1.0, 2.0]',
        'mechanism = "four_rps"\nbase_radius = 1.0\nplatform_radius = 1.0\nstroke = [1.0, 2.0]',
        'mechanism = "five_bar"\nproximal = [1.0, 1.0, 1.0]\ndistal = 1.0\nhalf_base = 1.0',
        'mechanism = "parallel"\n[platform]\nposition = [0.0, 0.0]\n[[limb]]\ntype = "UPS"',
        'mechanism = "parallel"\n[platform]\nposition = [0.0, 0.0, 1.0]\n[[limb]]\ntype = "UPX"',
    ],
)
def test_broken_designs_do_not_fit(text: str) -> None:
    assert not DESIGNS.is_valid(tomllib.loads(text))
    with pytest.raises(DesignError):
        read_design(text, origin="")


# --- sessions ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ONE_EACH.values())
def test_sessions_fit(name: str) -> None:
    written = json.loads(to_text(new_review(load_design(name))))
    jsonschema.validate(written, json_schema())


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("bohemia_session", 2),
        ("design", None),
        ("design_name", 3),
        ("pose", {"x": "far"}),
        ("pose", []),
        ("working_mode", 1),
        ("gives_way", 1),
        ("solids", []),
        ("options", {"machine": "yes"}),
    ],
)
def test_broken_sessions_do_not_fit_and_are_not_opened(key: str, value: Any) -> None:
    written = json.loads(to_text(new_review(load_design("rpur-table1")))) | {key: value}
    assert not jsonschema.Draft202012Validator(json_schema()).is_valid(written)
    with pytest.raises(InputError):
        from_text(json.dumps(written), origin="it")


# --- paths ---------------------------------------------------------------------------------

PATHS = {
    "x,y\n0,700\n10,650\n": True,
    "t,x,y,note\n0,0,700,1\n1,10,650,2\n": True,
    "x,z\n0,700\n10,650\n": False,
    "x,y\n0,700\n": False,
    "x,y\n0,far\n10,650\n": False,
}


@pytest.mark.parametrize(("text", "good"), PATHS.items())
def test_rows_of_a_path_fit_if_they_are_read(text: str, good: bool) -> None:
    machine = machine_of(load_design("five-bar"))
    rows = [{k: _number(v) for k, v in row.items()} for row in csv.DictReader(text.splitlines())]
    for axes in ((), (machine.coordinates, machine.dependent)):
        fits = jsonschema.Draft202012Validator(path_schema(*axes)).is_valid(rows)
        assert fits is good or (not axes and fits)
    if good:
        read_points(text, machine.coordinates, origin="it")
        return
    with pytest.raises(InputError):
        read_points(text, machine.coordinates, origin="it")


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def test_the_coordinate_that_follows_may_be_left_out() -> None:
    machine = machine_of(load_design("sps-spr"))
    known = jsonschema.Draft202012Validator(path_schema(machine.coordinates, machine.dependent))
    row = {axis.key: 0.0 for axis in machine.coordinates}
    assert known.is_valid([row, row])
    assert known.is_valid([row, {k: v for k, v in row.items() if k != "gamma"}])
    assert not known.is_valid([row, {"x": 0.0, "y": 0.0}])


# --- the command, and answers --------------------------------------------------------------


def test_every_command_that_answers_has_a_schema(here: Callable[..., Finished]) -> None:
    silent = {"serve", "schema"}
    known = {path.stem for path in schemas.FOLDER.glob("*.json")}
    assert known == set(COMMANDS) - silent
    for name in ("design", "path", "session", *known):
        printed = json.loads(here("schema", name).stdout)
        jsonschema.Draft202012Validator.check_schema(printed)
    printed = json.loads(here("schema", "path", "--of", "five-bar").stdout)
    assert printed["items"]["anyOf"] == [{"required": ["x", "y"]}]
    assert "design, path, session" in refused(here("schema", "nothing"))
    assert "only a path" in refused(here("schema", "ik", "--of", "five-bar"))


def test_an_answer_of_another_form_is_found(here: Callable[..., Finished]) -> None:
    answer = here("ik", "five-bar", "--pose", "0,700", "--json").json
    for broken in (
        {k: v for k, v in answer.items() if k != "solutions"},
        {**answer, "solutions": [{"joints": "none"}]},
        {**answer, "schema": "bohemia/ik/0"},
    ):
        with pytest.raises(jsonschema.ValidationError):
            schemas.check(broken)
