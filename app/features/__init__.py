"""The features, each a folder whose files bear the same names in all of them.

A feature may have: ``state`` (its slice of a review and its changes), ``compute`` (pure, run in a
process), ``part`` (on the page's loop), ``scene``, ``panel``, ``plot``, ``html``, ``files`` and
``command``.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

FEATURES = (
    "move",
    "solutions",
    "workspace",
    "section",
    "singularities",
    "map",
    "trajectory",
    "design",
    "review",
)


def each(file: str) -> Iterator[ModuleType]:
    """The files of this name, of each feature that has one."""
    for feature in FEATURES:
        name = f"app.features.{feature}.{file}"
        if find_spec(name) is not None:
            yield import_module(name)
