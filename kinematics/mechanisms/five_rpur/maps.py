"""What a map over (φ, θ) shows of the 5-RPUR (Tale Masouleh et al. 2011, Figs. 20 and 21)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from kinematics.answers.sections import MapCells, MapSpec, Quantity
from kinematics.facets.maps import MapsFacet
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inscribed.largest import sphere
from kinematics.mechanisms.five_rpur.sections import Integral, integrate, pieces_of
from kinematics.mechanisms.five_rpur.slicing import acceleration
from kinematics.mechanisms.five_rpur.slicing.cutter import Cutter

SPEC = MapSpec(
    axes=(3, 4),
    quantities=(
        Quantity("volume", "Volume", "mm³"),
        Quantity("pieces", "Number of pieces", ""),
        Quantity("largest_piece", "Largest piece", "mm³"),
        Quantity("sphere", "Largest inscribed sphere, radius", "mm"),
        Quantity("stroke", "Share of the stroke used, least of the limbs", "%"),
    ),
    figure="Figs. 20, 21",
)

_STROKE_SECTIONS = 48
_BY_VOLUME = {"volume", "pieces", "largest_piece", "stroke"}


class Maps(MapsFacet[FiveRPURDesign]):
    """Only φ and θ of the poses matter."""

    spec = SPEC

    def cells(self, *arguments: Any, **options: Any) -> MapCells:
        acceleration.load()
        return super().cells(*arguments, **options)

    def measures(
        self,
        pose: Sequence[float],
        modes: tuple[str, ...] | None,
        quantities: Sequence[str],
        relative: float,
    ) -> dict[str, tuple[float, float]]:
        design, phi, theta = self.design, float(pose[3]), float(pose[4])
        result: dict[str, tuple[float, float]] = {}
        if _BY_VOLUME & set(quantities):
            cutter = Cutter(design, phi, theta, modes)
            found = integrate(cutter, relative)
            volume = float(found.moments[0])
            result["volume"] = volume, found.error
            if {"pieces", "largest_piece"} & set(quantities):
                parts = pieces_of(cutter, found)
                # What is smaller than the volume's error may be more or fewer, or part of another.
                small = [part for part in parts if part <= found.error]
                result["pieces"] = float(len(parts)), float(len(small))
                result["largest_piece"] = (parts[0] if parts else 0.0), found.error + sum(small)
            if "stroke" in quantities:
                result["stroke"] = _stroke_share(design, cutter, found)
        if "sphere" in quantities:
            ball = sphere(design, phi, theta, modes)
            result["sphere"] = (0.0, 0.0) if ball is None else (ball.radius, ball.error)
        return result


def _stroke_share(design: FiveRPURDesign, cutter: Cutter, found: Integral) -> tuple[float, float]:
    """The part of its stroke that a limb uses, %, least of the limbs: what points of some sections'
    boundaries need of it. The error is what half as many points on edges would have missed."""
    inside = found.at[found.marks != 0]
    if not inside.size:
        return 0.0, 0.0
    chosen = np.unique(np.linspace(0, inside.size - 1, _STROKE_SECTIONS).astype(int))
    span = design.stroke[:, 1] - design.stroke[:, 0]
    shares = []
    for samples in (9, 5):
        low, high = cutter.strokes(inside[chosen], samples)
        low, high = np.maximum(low, design.stroke[:, 0]), np.minimum(high, design.stroke[:, 1])
        shares.append(100.0 * float(np.min(np.maximum(high - low, 0.0) / span)))
    return shares[0], shares[0] - shares[1] + 0.1
