"""Design files and path files as JSON Schema (2020-12), for editors and other programs.

Both follow from what reads the files. What JSON Schema cannot say is only found on reading: that
ρ_min < ρ_max, that limbs close, that points of one path differ.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from kinematics.answers.coordinates import Coordinate
from kinematics.mechanism import mechanism_class, mechanism_kinds

MOST = 1e9
"""No length (mm), angle (degrees) or time (s) of a path is larger."""
DIALECT = "https://json-schema.org/draft/2020-12/schema"


def design_schema() -> dict[str, Any]:
    """Of a design file of any kind, as parsed TOML."""
    return {
        "$schema": DIALECT,
        "title": "A design file of Bohemia",
        "type": "object",
        "required": ["mechanism"],
        "oneOf": [mechanism_class(kind).schema.json_schema(kind) for kind in mechanism_kinds()],
    }


def path_schema(
    coordinates: Sequence[Coordinate] = (), dependent: Sequence[int] = ()
) -> dict[str, Any]:
    """Of the rows of a path file with plain keys in its first line: mm, degrees, s.

    Args:
        coordinates: of the machine that runs along it; none: of any machine.
        dependent: those, by index, of which one may be left out.
    """
    keys = [axis.key for axis in coordinates]
    number = {"type": "number", "minimum": -MOST, "maximum": MOST}
    rows: dict[str, Any] = {"type": "object", "properties": {"t": number}}
    if not keys:
        rows |= {"additionalProperties": number, "minProperties": 2}
    rows["properties"] |= dict.fromkeys(keys, number)
    ways = [keys, *([k for k in keys if k != keys[n]] for n in dependent)]
    rows["anyOf"] = [{"required": way} for way in ways]
    title = "The rows of a path file of Bohemia"
    return {"$schema": DIALECT, "title": title, "type": "array", "items": rows, "minItems": 2}
