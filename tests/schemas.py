"""The forms of JSON answers: checked by every test that asks for one, and found from what is asked.

    python -m tests.schemas       (make schemas)

asks every command about every preset and writes what all answers have in common to
`assets/schemas`. A key that is gone, or of another kind, is to be seen there in the difference, and
raises the number of the command's schema. Whatever stands under a key may be null: there is none.
"""

from __future__ import annotations

import contextlib
import json
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema

from tests.examples import ROOT, run

FOLDER = ROOT / "assets" / "schemas"
COORDINATES = {"x", "y", "z", "phi", "theta", "psi", "alpha", "beta", "gamma", "tilt", "azimuth"}
DIALECT = "https://json-schema.org/draft/2020-12/schema"


@cache
def validator(command: str) -> jsonschema.Draft202012Validator:
    schema = json.loads((FOLDER / f"{command}.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def check(answer: dict[str, Any]) -> None:
    """Raise a ValidationError if an answer is not of the form that its ``schema`` names."""
    validator(answer["schema"].split("/")[1]).validate(answer)


class Shape:
    """What values that were seen in one place have in common."""

    def __init__(self) -> None:
        self.types: set[str] = set()
        self.objects: list[set[str]] = []
        self.keys: dict[str, Shape] = {}
        self.items: Shape | None = None

    def see(self, value: Any) -> None:
        if isinstance(value, dict):
            self.types.add("object")
            self.objects.append(set(value))
            for key, one in value.items():
                self.keys.setdefault(key, Shape()).see(one)
        elif isinstance(value, list):
            self.types.add("array")
            self.items = self.items or Shape()
            for one in value:
                self.items.see(one)
        else:
            kinds = {bool: "boolean", int: "integer", float: "number", str: "string"}
            self.types.add("null" if value is None else kinds[type(value)])

    def schema(self) -> dict[str, Any]:
        types = set(self.types)
        if "number" in types:
            types = types - {"integer"} | {"null"}
        said: dict[str, Any] = {"type": sorted(types) if len(types) != 1 else next(iter(types))}
        if types <= {"null"}:  # what there was none of may be anything
            return {}
        if self.items is not None:
            said["items"] = self.items.schema()
        if self.objects:
            every = set.intersection(*self.objects)
            known = {key: _or_null(shape.schema()) for key, shape in self.keys.items()}
            alike = [s for n, s in enumerate(known.values()) if s not in list(known.values())[:n]]
            named = not every or {key.partition("_")[0] for key in known} <= COORDINATES
            if len(alike) == 1 and named:  # keys are names: of coordinates, joints, measures
                return said | {"additionalProperties": alike[0]}
            said["properties"] = known
            said["required"] = [key for key in known if key in every]
        return said


def _or_null(schema: dict[str, Any]) -> dict[str, Any]:
    """What stands under a key is null where there is none of it."""
    if "type" not in schema:
        return schema
    types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    return schema | {"type": sorted({*types, "null"})}


def found(answers: Iterator[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """The schema of each command whose answers are seen."""
    shapes: dict[str, Shape] = {}
    for answer in answers:
        shapes.setdefault(answer["schema"], Shape()).see(answer)
    made = {}
    for name, shape in shapes.items():
        command = name.split("/")[1]
        schema = {"$schema": DIALECT, "title": f"bohemia {command} --json", **shape.schema()}
        schema["properties"]["schema"] = {"const": name}
        made[command] = schema
    return made


def answers() -> Iterator[dict[str, Any]]:
    """What every command answers to whatever the tests of the command line ask, and to `MORE`."""
    from app.terminal.options import preset_names
    from tests.app.test_cli_answers import questions

    asked = [*MORE, *(question for preset in preset_names() for question in questions(preset))]
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name, text in FILES.items():
            Path(name).write_text(text, encoding="utf-8")
        for question in asked:
            words = question.split() if isinstance(question, str) else question
            said = run([*words, "--json"])
            if said.code == 0:
                yield json.loads(said.out)
            elif question in MORE:
                raise AssertionError(f"{question}: {said.err}")


FILES = {
    "p.csv": "x,y,z,alpha,beta\n0,0,569,0,0\n10,5,575,3,2\n",
    "down.csv": "x,y\n0,600\n0,300\n0,900\n",
    "out.csv": "x,y,z,phi,theta\n326,73,211,0,0\n900,73,211,0,0\n",
}
MORE = (
    "designs",
    "micr three_spr --base 100 --platform 200 --altitude 100",
    "micr three_rps --curves --ratios 1,2 --heights 1:2:3",
    "ik rpur-table1 --pose 300,0,500,0,0",
    "ik rps-3 --pose 283,5,0",
    "fk rpur-a1a1 --joints 340,330,330,320,330 --mixed-modes",
    "fk rpur-table1 --joints 320,360,345,305,375 --within-stroke",
    "trajectory sps-spr p.csv --samples 5 --load 0,9,-9,0,0,0",
    "trajectory five-bar down.csv --samples 5 --mode +- --max-rates 1 --max-accelerations 1",
    "trajectory rpur-table1 out.csv --samples 5 --load 0,0,-9,0,0,0 --max-forces 1",
    "workspace rpur-table1 --resolution preview -o solid.stl --units cm",
    "workspace rpur-table1 --modes all --resolution preview",
    "volume rpur-table1 --tolerance 0.01",
    "volume rpur-table1 --tolerance 0.01 --no-pieces",
    "volume rpur-table1 --theta 90 --phi 90 --modes +++++",
    "section rpur-table1 --x 900",
    "map rpur-table1 --phi 0:10:2 --theta 0",
    "singularity rpur-table1 --pose 900,0,0,0,0 --mode +++++",
    "workspace five-bar --regions aspects -o plane.dxf",
    "singularity rpur-table1 --mode +++++ --resolution preview --what 1 -o piece.stl",
    "singularity five-bar --pose 0,415.692193816531 --mode +-",
    "compare rpur-table1 rpur-table2 --phi 5",
    "compare five-bar five-bar",
    "compare rps-3 spr-3",
    "compare gough delta",
    "paper five-bar-2017",
    "report five-bar -o review.html",
)


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    for command, schema in found(answers()).items():
        text = json.dumps(schema, indent=1, ensure_ascii=False) + "\n"
        (FOLDER / f"{command}.json").write_text(text, encoding="utf-8")
        print(command, len(text))


if __name__ == "__main__":
    main()
