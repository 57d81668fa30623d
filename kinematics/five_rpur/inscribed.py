"""The usable workspace: the largest ball and box inside it."""

from __future__ import annotations

from collections.abc import Sequence

from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.sections import Box, Sphere


def sphere(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: tuple[str, ...] | None = None,
    center: Sequence[float] | None = None,
) -> Sphere | None:
    """The largest ball about ``center`` (3,) mm of the base frame, or anywhere."""
    raise NotImplementedError


def box(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    modes: tuple[str, ...] | None = None,
    center: Sequence[float] | None = None,
) -> Box | None:
    """The largest box along x, y, z centred at ``center``, or anywhere."""
    raise NotImplementedError
