"""Curves on which control of the platform is lost: plain results. Arrays are read-only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from kinematics.answers.singularities import SingularityKind
from kinematics.arrays import Array, Frozen, Ints


@dataclass(frozen=True, slots=True)
class LocusSpec:
    """A chart of singularity loci that a mechanism can draw: two coordinates, all else held.

    ``axes`` are symbols. A polar chart's are radius and azimuth (rad). The chart "section" is in
    the plane of `mechanism.SectionSpec` that stands at ``at``.
    """

    key: str
    title: str
    axes: tuple[str, str]
    units: tuple[Literal["mm", "rad"], Literal["mm", "rad"]]
    polar: bool = False
    figure: str = ""


class LocusCurve(NamedTuple):
    """One curve, see `LocusCurves`."""

    points: Array
    residual: Array
    kind: SingularityKind = "parallel"
    limb: int = 0


@dataclass(frozen=True, eq=False)
class LocusCurves(Frozen):
    """Curves of a `LocusSpec` chart, in its two coordinates.

    Attributes:
        points: (N, 2) mm or rad, all curves one after another.
        start: (C + 1,) curve c is points[start[c]:start[c + 1]]; closed if its ends are equal.
        kinds: of each curve.
        limb: (C,) whose serial singularity it is, from 1; 0 of others.
        residual: (N,) what the defining function leaves at each point, as a distance in the
            chart's first unit (|f| / |grad f|).
        bounds: (2, 2) lowest and highest of both coordinates that were searched.
        barriers: radii of a polar chart at which there is no posture at all.
    """

    points: Array
    start: Ints
    kinds: tuple[SingularityKind, ...]
    limb: Ints
    residual: Array
    bounds: Array
    barriers: tuple[float, ...] = ()

    @classmethod
    def of(
        cls, curves: Sequence[LocusCurve], bounds: Array, barriers: tuple[float, ...] = ()
    ) -> LocusCurves:
        """The curves of a chart."""
        return cls(
            points=np.concatenate([np.empty((0, 2)), *(curve.points for curve in curves)]),
            start=np.cumsum([0, *(len(curve.points) for curve in curves)]).astype(np.int64),
            kinds=tuple(curve.kind for curve in curves),
            limb=np.array([curve.limb for curve in curves], dtype=np.int64),
            residual=np.concatenate([np.empty(0), *(curve.residual for curve in curves)]),
            bounds=bounds,
            barriers=barriers,
        )

    def lost(self) -> list[Array]:
        """The curves (K, 2) each where the platform is not held: all but serial singularities."""
        return [
            self.points[self.start[c] : self.start[c + 1]]
            for c, kind in enumerate(self.kinds)
            if kind != "serial"
        ]
