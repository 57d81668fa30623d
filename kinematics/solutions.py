"""What solvers answer with: postures, reasons, stops. Failure is a value with a human message.

Poses and joints are tuples in the mechanism's own coordinates (mm and rad, see
`kinematics.mechanism.Coordinate`), so every value here is frozen and hashable.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinematics.spatial import Array

Bound = Literal["rho_min", "rho_max", "link"]


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a pose cannot be held: one limb beyond one bound.

    ``limb`` counts from 1; ``amount`` is how far beyond the bound it is, mm, > 0.
    """

    limb: int
    bound: Bound
    amount: float
    text: str


@dataclass(frozen=True, slots=True)
class Margin:
    """How far one limb is from one of its bounds, mm; negative beyond it."""

    limb: int
    bound: Bound
    amount: float


@dataclass(frozen=True, slots=True)
class Posture:
    """The whole configuration of a machine at one pose in one working mode.

    Attributes:
        pose: the platform's coordinates, mm and rad.
        mode: one sign a limb, as "+-+++".
        joints: actuated lengths or angles; NaN where the limb cannot close at all.
        reasons: empty when the pose is reachable within the strokes.
        residual: the largest loop-closure error of the limbs that close, mm.
        margins: distance of every limb to every bound, mm.
    """

    pose: tuple[float, ...]
    mode: str
    joints: tuple[float, ...]
    reasons: tuple[Reason, ...]
    residual: float
    margins: tuple[Margin, ...]

    @property
    def reachable(self) -> bool:
        """Every limb closes and lies within its stroke."""
        return not self.reasons

    @property
    def closes(self) -> bool:
        """Every limb can be assembled, within its stroke or not."""
        return all(np.isfinite(self.joints))

    @property
    def nearest(self) -> Margin:
        """The smallest margin: the limit that is met first."""
        return min(self.margins, key=lambda m: m.amount)


@dataclass(frozen=True, slots=True)
class InverseSolutions:
    """All working modes of a batch of poses; arrays are read-only.

    Attributes:
        modes: the M working modes, one sign a limb.
        joints: (..., M, J) actuated joints; NaN where a limb cannot close.
        within_stroke: (..., M) bool, the mode closes and every joint is within its stroke.
        residual: (...,) the largest loop-closure error, mm; NaN where no mode closes.
    """

    modes: tuple[str, ...]
    joints: Array
    within_stroke: np.ndarray
    residual: Array


Stop = Literal["target", "stroke", "singularity", "stalled"]


@dataclass(frozen=True, slots=True)
class Followed:
    """Where one assembly mode led when the actuated joints were moved.

    Attributes:
        posture: the posture reached, always one that the machine can hold together.
        stop: "target" when the wanted joints were reached, else what stopped the motion.
        text: one sentence for the user; empty when the target was reached without events.
        fraction: the part of the way that was covered, 0 to 1.
        limb: the limb at its stroke end, if that is what stopped it (from 1).
    """

    posture: Posture
    stop: Stop
    text: str
    fraction: float
    limb: int | None = None


@dataclass(frozen=True, slots=True)
class Finding:
    """Something worth knowing about a design: an arrangement found, or a warning."""

    severity: Literal["info", "warning"]
    title: str
    text: str
    limbs: tuple[int, ...] = ()
