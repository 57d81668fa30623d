"""A machine: one design bound to its mechanism, with everything that can be asked of it.

`Machine` is what people hold. What it can answer stands in its facets, one a topic; a facet that a
machine has not is None.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from kinematics.facets.facet import required
from kinematics.facets.faceted import Faceted
from kinematics.mechanism import D, Design, DesignField

__all__ = ["Machine", "machine_of", "required"]


class Machine(Faceted[D]):
    """One design of one mechanism.

    Attributes:
        design: the design, frozen.
        mechanism: the primitives of its kind.
        inverse, forward, following, motion, statics, measures, singularities, clearances, paths:
            facets that every machine has.
        solids, sections, regions, maps, circles: facets that a machine may lack; None then.
    """

    # --- its design

    @property
    def table(self) -> dict[str, Any]:
        """What the design's file says, as plain values."""
        return self.mechanism.design_table()

    @property
    def fields(self) -> tuple[DesignField, ...]:
        """Every number of the design that may be edited."""
        return self.mechanism.design_fields()

    def edited(self, path: Sequence[str | int], value: float) -> Machine[D]:
        """The machine with one number changed and everything checked again.

        Args:
            path: a `DesignField.path`, as ``("limb", 2, "base", 0)``.

        Raises:
            InputError: the design has no such number.
            DesignError: the design would not be valid with it.
        """
        return Machine(self.mechanism.edited(path, value))


@lru_cache(maxsize=64)
def machine_of(design: Design) -> Machine[Any]:
    """The machine of a design, kept while it is used."""
    return Machine(design)
