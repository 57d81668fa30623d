"""The features, each a folder whose files bear the same names in all of them.

A feature may have: ``state`` (its slice of a review and its changes), ``compute`` (pure, run in a
process), ``part`` (on the page's loop), ``scene``, ``panel``, ``plot``, ``html``, ``files`` and
``command``. Slices, parts and panels are known by their classes.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from typing import TypeVar

FEATURES = (
    "move",
    "solutions",
    "workspace",
    "section",
    "singularities",
    "map",
    "trajectory",
    "design",
    "compare",
    "report",
    "together",
    "review",
    "marks",
)


T = TypeVar("T")


def each(file: str, kind: type[T]) -> Iterator[type[T]]:
    """The classes of a kind that the files of this name define, feature by feature."""
    for feature in FEATURES:
        name = f"app.features.{feature}.{file}"
        if find_spec(name) is not None:
            for found in vars(import_module(name)).values():
                own = isinstance(found, type) and found.__module__ == name
                if own and issubclass(found, kind):
                    yield found
