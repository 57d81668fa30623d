"""The numbers in which designs differ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kinematics.mechanism import DesignField, Mechanism

Place = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Difference:
    """One number of a design that others have otherwise, or not at all.

    Attributes:
        path: where it stands in the design's file.
        label: as "Limb 2: base x".
        values: of each design, in ``unit``; None where it has no such number.
        unit: "mm", "rad" or "".
    """

    path: Place
    label: str
    values: tuple[float | None, ...]
    unit: str

    @property
    def field(self) -> str:
        """The path as text: "limb.1.base.0"."""
        return ".".join(map(str, self.path))


def differences(mechanisms: Sequence[Mechanism[Any]]) -> tuple[Difference, ...]:
    """Every number that is not the same in all designs, in the order of their files."""
    tables: list[dict[Place, DesignField]] = [
        {field.path: field for field in mechanism.design_fields()} for mechanism in mechanisms
    ]
    found = []
    for path in dict.fromkeys(path for table in tables for path in table):
        fields = [table.get(path) for table in tables]
        first = next(field for field in fields if field is not None)
        values = tuple(None if field is None else float(field.value) for field in fields)
        if any(value != values[0] for value in values):
            group = f"{first.group}: " if first.group else ""
            found.append(Difference(path, f"{group}{first.label}", values, first.unit))
    return tuple(found)
