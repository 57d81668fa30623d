from __future__ import annotations

from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.sections import Volume


def volume(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: tuple[str, ...] | None = None,
    *,
    relative: float = 1e-6,
) -> Volume:
    raise NotImplementedError
