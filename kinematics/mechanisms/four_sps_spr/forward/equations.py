"""The closure equations of the 4-SPS + 1-SPR in Study's coordinates, see `homotopy.study`.

|p + R b_i − A_i|² = l_i² for i = 1 … 5, and (A_5 − p)·R n = b_5·n: with Study's quadric and a patch
eight equations in eight unknowns. Everything is in units of the machine, the origins in the
centroids of base and platform points. Arrays of unknowns are (8, paths).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.arrays import Array
from kinematics.homotopy.forms import Deformation, FormEquations
from kinematics.homotopy.study import FORMS, QUADRIC, Limbs, Plane, StudyEquations, real_poses
from kinematics.homotopy.tracking import Complex, Index
from kinematics.mechanisms.four_sps_spr.design import LIMBS, FourSPSSPRDesign


class Parameters(NamedTuple):
    """A machine and its lengths, any of them complex; (..., 5, 3), (..., 5, 3), (..., 3), (..., 5).

    Leading axes are machines; there may be one for each path.
    """

    base: NDArray[Any]
    platform: NDArray[Any]
    axis: NDArray[Any]
    squares: NDArray[Any]  # l_i²


@dataclass(frozen=True, eq=False, slots=True)
class Frame:
    """Where the equations' origins and unit stand in the design's own frames, mm."""

    base: Array
    platform: Array
    unit: float

    @classmethod
    def of(cls, design: FourSPSSPRDesign) -> Frame:
        base, platform = design.base.mean(axis=0), design.platform.mean(axis=0)
        spread = max(
            float(np.abs(design.base - base).max()),
            float(np.abs(design.platform - platform).max()),
            0.25 * float(design.stroke[:, 1].max()),
        )
        return cls(base, platform, spread)


def parameters(
    design: FourSPSSPRDesign, joints: ArrayLike, frame: Frame | None = None
) -> Parameters:
    """The parameters of a design at lengths (..., 5), mm."""
    f = Frame.of(design) if frame is None else frame
    lengths = np.asarray(joints, dtype=float) / f.unit
    return Parameters(
        (design.base - f.base) / f.unit,
        (design.platform - f.platform) / f.unit,
        design.axis,
        lengths * lengths,
    )


# --- the closure ---------------------------------------------------------------------------


class Equations(FormEquations[Parameters]):
    """Five spheres, and the plane of the platform in which limb 5 moves."""

    def __init__(self) -> None:
        self._study = StudyEquations(_PLANES)
        super().__init__(FORMS, QUADRIC)

    def coefficients(self, g: Parameters) -> Complex:
        axis = np.asarray(g.axis)[..., None, :]
        return self._study.coefficients(
            Limbs(g.base, g.platform, axis.repeat(LIMBS, -2), g.squares)
        )

    def of(self, g: Parameters, columns: Index) -> Parameters:
        """The machine of some targets, which differ in their lengths, for columns (n,) of them."""
        return g._replace(squares=np.atleast_2d(g.squares)[columns])

    def placed(self, u: Complex) -> Complex:
        """R and p of each, (12, n)."""
        return self._study.placed(u)

    def between(
        self, start: Parameters, end: Parameters, around: float = 0.0
    ) -> Deformation[Parameters]:
        middle = Parameters(*(0.5 * (a + b) for a, b in zip(start, end, strict=True)))
        return Deformation(self, start, middle, end, around)


_PLANES: tuple[Plane, ...] = ("", "", "", "", "platform")
CLOSURE = Equations()


def to_transforms(frame: Frame, u: Complex) -> tuple[Array, Array]:
    """R (n, 3, 3) and p (n, 3) mm of real solutions, in the design's own frames."""
    r, p = real_poses(u)
    return r, frame.base + frame.unit * p - r @ frame.platform
