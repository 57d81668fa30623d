"""Which function recomputes which item, and all items of a paper recomputed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module

from app.features.paper.items import Item, Paper
from app.features.paper.judging import Outcome, Verdict, missing
from kinematics.errors import ComputationError

Recompute = Callable[[Item], Outcome]

_RPUR = (
    "rpur_model",
    "rpur_forward",
    "rpur_designs",
    "rpur_counts",
    "rpur_sections",
    "rpur_figure",
    "rpur_space",
)
_ROOMS = {
    "meccanica-2011": _RPUR,
    "icee-2010": _RPUR,
    "sps-spr-2017": ("sps_spr", "sps_spr_ranges"),
    "rps-spr-2017": ("tripods_algebra", "tripods_modes", "tripods_circles"),
    "five-bar-2017": ("five_bar", "five_bar_places", "five_bar_ways"),
}
_known: dict[tuple[str, str], Recompute] = {}


@dataclass(frozen=True, slots=True)
class Recomputed:
    """An item with what became of it."""

    item: Item
    outcome: Outcome

    @property
    def verdict(self) -> Verdict:
        return self.outcome.verdict

    @property
    def computed(self) -> str | None:
        """What was computed, in one line; None where nothing could be."""
        told = (f"{q.what}: {q.shown}" for q in self.outcome.quantities)
        return "; ".join(told) or None

    @property
    def why(self) -> str:
        """Why the verdict is what it is."""
        item = self.item
        proof = self.outcome.proof
        parts = [f"{proof[:1].upper()}{proof[1:]}." if proof else ""]
        if self.verdict == "corrected":
            parts.insert(0, item.correction)
        if self.verdict == "impossible":
            parts.insert(0, f"Missing: {item.missing}.")
        return " ".join(part for part in (*parts, item.remark) if part)


def computes(paper: str, *names: str) -> Callable[[Recompute], Recompute]:
    """Makes a function the one that recomputes these items of a paper."""

    def known(function: Recompute) -> Recompute:
        for name in names:
            _known[paper, name] = function
        return function

    return known


def recompute(item: Item) -> Recomputed:
    """An item, recomputed now.

    Raises:
        ComputationError: there is no verdict, as nothing recomputes it and nothing is missing, or
            what was computed contradicts itself; or a correction is found that nobody has told.
    """
    for room in _ROOMS[item.paper]:
        import_module(f"app.features.paper.recomputed.{room}")
    function = _known.get((item.paper, item.name))
    if function is None and not item.missing:
        raise ComputationError(f"{item.paper}, {item.name}: nothing recomputes it")
    try:
        outcome = missing() if function is None else function(item)
    except ComputationError as error:
        raise ComputationError(f"{item.paper}, {item.name}: {error}") from None
    told = {"corrected": item.correction, "impossible": item.missing}
    if not told.get(outcome.verdict, "-"):
        raise ComputationError(f"{item.paper}, {item.name}: {outcome.proof}, and nobody says why")
    return Recomputed(item, outcome)


def recomputed(paper: Paper) -> Iterator[Recomputed]:
    """All items of a paper, one after another."""
    return map(recompute, paper.items)
