"""What a map over (φ, θ) shows of the 5-RPUR (Tale Masouleh et al. 2011, Figs. 20 and 21)."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.sections import MapCells, MapSpec, Quantity

SPEC = MapSpec(
    axes=(3, 4),
    quantities=(
        Quantity("volume", "Volume", "mm³"),
        Quantity("pieces", "Number of pieces", ""),
        Quantity("largest_piece", "Largest piece", "mm³"),
        Quantity("sphere", "Largest inscribed sphere (radius)", "mm"),
        Quantity("stroke", "Share of the stroke used", "%"),
    ),
    figure="Figs. 20, 21",
)


def map_cells(
    design: FiveRPURDesign,
    poses: ArrayLike,
    modes: tuple[str, ...] | None,
    quantities: Sequence[str],
    *,
    relative: float = 1e-4,
) -> MapCells:
    """The quantities at orientations; x, y, z of ``poses`` (N, 5) do not matter."""
    raise NotImplementedError
