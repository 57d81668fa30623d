"""How a machine is drawn: shapes with a role, no colours and no widgets. mm, base frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Role = Literal["base", "platform", "cylinder", "rod", "link", "joint", "rail", "stop", "gap"]
Frame = Literal["base", "platform"]


@dataclass(frozen=True, slots=True)
class Bar:
    """A round bar from ``start`` to ``end`` (base frame, mm).

    A "rail" runs along the whole stroke, a "stop" marks one end of it, and a "gap" is what a
    limb that cannot close is short of.
    """

    name: str
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    role: Role
    limb: int | None = None


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body: the hull of balls of ``radius`` about ``points``, fixed in ``frame``."""

    name: str
    points: tuple[tuple[float, float, float], ...]
    radius: float
    role: Role
    frame: Frame


@dataclass(frozen=True, slots=True)
class Mark:
    """A named point or axis to label on demand (base frame, mm)."""

    name: str
    text: str
    position: tuple[float, float, float]
    limb: int | None = None
    direction: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Drawing:
    """A machine at one posture; ``size`` is a typical length of it, mm."""

    bars: tuple[Bar, ...]
    bodies: tuple[Body, ...]
    points: tuple[Mark, ...]
    axes: tuple[Mark, ...]
    size: float
