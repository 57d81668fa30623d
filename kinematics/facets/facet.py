"""One topic of what a machine answers, bound to its mechanism and design."""

from __future__ import annotations

from typing import ClassVar, Generic, TypeVar

from kinematics.errors import InputError
from kinematics.mechanism import D, Mechanism

F = TypeVar("F")


class Facet(Generic[D]):
    """What a machine answers about one topic; a kind's own facets inherit the topic's.

    Attributes:
        topic: its name among the facets of a machine, as "statics".
    """

    topic: ClassVar[str]

    def __init__(self, mechanism: Mechanism[D]) -> None:
        self.mechanism = mechanism
        self.design: D = mechanism.design

    def other(self, facet: type[F]) -> F:
        """Another facet of the same machine, by the class of its topic, as `StaticsFacet`.

        Raises:
            InputError: the machine has it not.
        """
        topic: str = getattr(facet, "topic", "")
        found: F | None = self.mechanism.facet(topic)
        return required(found, topic)


def required(facet: F | None, what: str) -> F:
    """A facet that a question cannot do without.

    Args:
        what: what the machine would need, as "sections".

    Raises:
        InputError: the machine has it not.
    """
    if facet is None:
        raise InputError(f"this mechanism has no {what}")
    return facet
