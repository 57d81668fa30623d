"""One topic of what a machine answers, bound to its mechanism and design."""

from __future__ import annotations

from typing import Generic

from kinematics.mechanism import D, Mechanism


class Facet(Generic[D]):
    """What a machine answers about one topic; a kind's own facets inherit the topic's."""

    def __init__(self, mechanism: Mechanism[D]) -> None:
        self.mechanism = mechanism
        self.design: D = mechanism.design
