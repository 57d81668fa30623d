from __future__ import annotations

from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.sections import Section


def section_range(
    design: FiveRPURDesign, phi: float, theta: float, modes: tuple[str, ...] | None = None
) -> tuple[float, float] | None:
    raise NotImplementedError


def section(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    at: float,
    modes: tuple[str, ...] | None = None,
) -> Section:
    raise NotImplementedError
