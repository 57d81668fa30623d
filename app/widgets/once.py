"""What is drawn again only when something that it depends on has changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, ParamSpec

A = ParamSpec("A")


class Once(Generic[A]):
    """Calls ``draw`` with arguments that are others than the last time; they are all that it may
    depend on.
    """

    def __init__(self, draw: Callable[A, None]) -> None:
        self._draw = draw
        self._of: object = None

    def __call__(self, *of: A.args, **named: A.kwargs) -> None:
        if self._of != (of, named):
            self._of = of, named
            self._draw(*of, **named)
