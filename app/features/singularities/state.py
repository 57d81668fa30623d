"""What is shown of how well the platform is held, and under which load and motion."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Self

from app.language import tr
from app.review import content as session
from app.review.changes import SetOne
from app.review.state import Review, Slice, is_planar
from kinematics.errors import InputError
from kinematics.machine import Machine

MAX_RATIO, MAX_RATIOS = 100.0, 12  # of machines whose profiles are compared
LARGEST = 1e9  # of a rate or of a load; squares of it are numbers yet


@dataclass(frozen=True)
class Control(Slice):
    """What is shown of how well the platform is held.

    Attributes:
        wrenches: the lines along which the limbs push, and the constraints.
        clearances: the ways to whatever is nearest.
        locus: the singular surface, in the aspects' solid and in the section.
        chart: a key of the mechanism's `LocusSpec`s, whose curves are drawn; "" for none.
        shade: a key of the mechanism's `Measure`s, by which aspects and section are coloured.
        compare: the mechanism's counterpart stands beside it, with the same numbers.
        ratios: h₂/h₁ of further machines whose profile is drawn.
        load: [F, T] on the platform at O′, N and N·mm, base frame.
        forces: what the limbs push and pull under the load, drawn on them.
        arrow: the load's force as an arrow to drag.
        rates, accelerations: of the pose coordinates, mm/s and rad/s and their derivatives, whose
            motion is drawn; () for none.
    """

    filed_as: ClassVar[str] = "control"
    LOOKS: ClassVar[frozenset[str]] = frozenset(
        ("wrenches", "clearances", "locus", "chart", "shade", "compare", "forces", "arrow")
    )
    wrenches: bool = False
    clearances: bool = False
    locus: bool = True
    chart: str = ""
    shade: str = ""
    compare: bool = False
    ratios: tuple[float, ...] = ()
    load: tuple[float, ...] = (0.0, 0.0, -100.0, 0.0, 0.0, 0.0)
    forces: bool = False
    arrow: bool = False
    rates: tuple[float, ...] = ()
    accelerations: tuple[float, ...] = ()

    @classmethod
    def fresh(cls, review: Review) -> Self:
        return cls(load=usual_load(review.machine))

    @classmethod
    def gesture(cls, name: str, value: Any) -> str:
        return f"control {name}" if isinstance(value, tuple) else ""

    def checked(self, review: Review) -> Self:
        machine = review.machine
        session.listed(
            self.shade, ("", *(m.key for m in machine.measures.specs)), tr("singularities.shades")
        )
        charts = ("", *(spec.key for spec in machine.singularities.loci))
        session.listed(self.chart, charts, tr("singularities.charts"))
        if any(not (math.isfinite(r) and 0.0 < r <= MAX_RATIO) for r in self.ratios):
            raise InputError(tr("singularities.ratio_is", most=MAX_RATIO))
        if len(self.ratios) > MAX_RATIOS:
            raise InputError(tr("singularities.too_many_ratios", most=MAX_RATIOS))
        axes = machine.coordinates
        for name, values in (("rates", self.rates), ("accelerations", self.accelerations)):
            if values and (len(values) != len(axes) or not all(abs(v) <= LARGEST for v in values)):
                raise InputError(
                    tr(
                        "singularities.rates_are",
                        what=name,
                        count=len(axes),
                        most=LARGEST,
                        axes=", ".join(c.symbol for c in axes),
                    )
                )
        if len(self.load) != 6 or not all(abs(v) <= LARGEST for v in self.load):
            raise InputError(tr("singularities.load_is", most=LARGEST))
        return self

    def carried(self, before: Review, review: Review) -> Self:
        """Without the measure, the chart or the rates that the other mechanism has not."""
        usual = self.load == usual_load(before.machine)
        kept = replace(self, load=usual_load(review.machine)) if usual else self
        return Slice.carried(kept, before, review)


SetControl = partial(SetOne, Control)
"""Set one thing of what is shown of control."""


def usual_load(machine: Machine[Any]) -> tuple[float, ...]:
    """100 N downwards, as the machine stands on the page: [F, T], N and N·mm."""
    return (0.0, -100.0, 0.0, 0.0, 0.0, 0.0) if is_planar(machine) else Control.load
