"""What a map shows, and over which orientations."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar, Self

from app.language import tr
from app.review import content as session
from app.review.changes import Change, Taken
from app.review.state import Review, Slice
from app.review.units import ends_text, within
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate

MAX_CELLS = 91  # of a map along one axis


@dataclass(frozen=True, slots=True)
class Span:
    """Evenly spaced values of one coordinate, both ends included; rad or mm."""

    low: float = -0.5 * math.pi
    high: float = 0.5 * math.pi
    count: int = 37


@dataclass(frozen=True, slots=True)
class Colours:
    """How the values of a map are drawn, in their own units.

    Attributes:
        low, high: of the colours; None: the least and the largest value.
        contours: lines of equal value are drawn.
        step: from line to line; 0 for a round one.
    """

    low: float | None = None
    high: float | None = None
    contours: bool = True
    step: float = 0.0


@dataclass(frozen=True)
class Chart(Slice):
    """What a map shows (a key of the mechanism's `MapSpec`), over which two spans, and how."""

    filed_as: ClassVar[str] = "map"
    LOOKS: ClassVar[frozenset[str]] = frozenset(("colours",))
    quantity: str = "volume"
    first: Span = Span()
    second: Span = Span()
    colours: Colours = Colours()

    @property
    def spans(self) -> tuple[Span, Span]:
        """Those of the two coordinates."""
        return self.first, self.second

    def checked(self, review: Review) -> Self:
        spec = review.machine.map_spec
        if spec is None:
            raise InputError(tr("map.no_map"))
        session.listed(self.quantity, [q.key for q in spec.quantities], tr("map.shows"))
        for axis, span in zip(map_axes(review), self.spans, strict=True):
            if not (math.isfinite(span.low) and math.isfinite(span.high)):
                raise InputError(tr("map.ends_finite", axis=axis.symbol))
            if span.low >= span.high:
                raise InputError(tr("map.ends_order", axis=axis.symbol))
            if not 2 <= span.count <= MAX_CELLS:
                raise InputError(tr("map.counts", most=MAX_CELLS, axis=axis.symbol))
            for end in (span.low, span.high):
                if within(axis, end)[1]:
                    ends = ends_text(axis)
                    raise InputError(tr("map.must_stay", axis=axis.symbol, ends=ends))
        _check(self.colours)
        return self

    def written(self, review: Review) -> dict[str, Any]:
        axes = map_axes(review)
        if not axes:
            return {}
        spans = {
            session.key_of(c): [c.outer(s.low), c.outer(s.high), s.count]
            for c, s in zip(axes, self.spans, strict=True)
        }
        drawn = {"colours": asdict(self.colours)} if self.colours != Colours() else {}
        return {self.filed_as: {"quantity": self.quantity} | spans | drawn}

    @classmethod
    def read(cls, content: dict[str, Any], review: Review, origin: str) -> Self:
        given, usual = session.table(content, cls.filed_as, origin), review[cls]
        axes = map_axes(review)
        if not axes or not given:
            return usual
        spans = []
        for c, span in zip(axes, usual.spans, strict=True):
            key = session.key_of(c)
            values = given.get(key)
            if values is not None:
                what = f"{origin}: map: {key}"
                if not isinstance(values, list) or len(values) != 3 or type(values[2]) is not int:
                    raise InputError(tr("session.span", what=what))
                low, high = (c.inner(session.number(v, what)) for v in values[:2])
                span = Span(low, high, values[2])
            spans.append(span)
        drawn = session.table(given, "colours", f"{origin}: map")
        colours = _colours(drawn, f"{origin}: {cls.filed_as}: colours")
        try:
            quantity = given.get("quantity", usual.quantity)
            return cls(quantity, spans[0], spans[1], colours).checked(review)
        except InputError as error:
            raise InputError(f"{origin}: map: {error}") from None


def _colours(given: dict[str, Any], what: str) -> Colours:
    ends = [given.get(name) for name in ("low", "high")]
    low, high = (None if end is None else session.number(end, what) for end in ends)
    contours, step = given.get("contours", True), session.number(given.get("step", 0.0), what)
    if not isinstance(contours, bool):
        raise InputError(tr("session.contours", what=what))
    return Colours(low, high, contours, step)


def _check(colours: Colours) -> None:
    low, high = colours.low, colours.high
    if not all(math.isfinite(v) for v in (low, high, colours.step) if v is not None):
        raise InputError(tr("map.colours_finite"))
    if low is not None and high is not None and low >= high:
        raise InputError(tr("map.colours_order"))
    if colours.step < 0.0:
        raise InputError(tr("map.step_positive"))


@dataclass(frozen=True)
class SetChart(Change):
    """Set what a map shows and over which orientations."""

    chart: Chart
    gesture: str = "chart"

    def apply(self, review: Review) -> Taken:
        return review.having(self.chart.checked(review)), ""


def refined(chart: Chart, at: tuple[float, float]) -> Chart:
    """A chart of as many values about a place, mm or rad, two of its steps either way."""
    spans = []
    for span, middle in zip(chart.spans, at, strict=True):
        step = (span.high - span.low) / (span.count - 1)
        spans.append(Span(middle - 2.0 * step, middle + 2.0 * step, max(span.count, 9)))
    return replace(chart, first=spans[0], second=spans[1])


def map_axes(review: Review) -> tuple[Coordinate, ...]:
    """The two coordinates over which maps run; none where there are no maps."""
    spec = review.machine.map_spec
    return () if spec is None else tuple(review.machine.coordinates[n] for n in spec.axes)
