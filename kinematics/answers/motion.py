"""First and second order motion and statics: plain results that every mechanism shares.

Twists are [ω, v]: the platform's angular velocity (rad/s) and the velocity of its origin O′ (mm/s),
both in the base frame. Wrenches and loads are [F, T]: a force (N) and its moment about O′ (N·mm),
in the base frame. Lengths mm, angles rad, time s. Arrays are read-only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from kinematics.arrays import Array, Frozen

WrenchKind = Literal["actuation", "constraint"]


@dataclass(frozen=True, eq=False)
class Motion(Frozen):
    """Rates of a machine at a batch of postures, platform and actuators together.

    Accelerations that were not given are zero: inverse motion at constant pose rates, forward
    motion at constant joint rates. NaN where the posture does not close, or where a singularity
    leaves the answer undetermined.

    Attributes:
        pose_rates: (..., P) d(pose)/dt, mm/s and rad/s.
        pose_accelerations: (..., P) mm/s² and rad/s².
        twist: (..., 6) of the platform.
        twist_rate: (..., 6) its derivative by time: [α, a].
        joint_rates: (..., J) mm/s or rad/s.
        joint_accelerations: (..., J) mm/s² or rad/s².
    """

    pose_rates: Array
    pose_accelerations: Array
    twist: Array
    twist_rate: Array
    joint_rates: Array
    joint_accelerations: Array


@dataclass(frozen=True, slots=True)
class WrenchName:
    """One wrench of a system: what it is, and of which limb (from 1; None: of all together)."""

    kind: WrenchKind
    limb: int | None
    symbol: str


class Wrenches(NamedTuple):
    """Six wrenches at a batch of placements, as a mechanism supplies them (`Mechanism.wrenches`).

    Attributes:
        rows: (..., 6, 6) [F, T about O′], those of the J actuators first; unit forces, or unit
            couples where the force vanishes. row · [v, ω] is gain · joint rate of an actuator, 0 of
            a constraint.
        gain: (..., J) 1, or mm per rad; 0 in a serial singularity.
        point: (..., 6, 3) mm, a point on each wrench's line; O′ for couples.
    """

    rows: Array
    gain: Array
    point: Array


@dataclass(frozen=True, eq=False)
class WrenchSystem(Frozen):
    """The wrenches that a machine can exert on its platform at a batch of postures.

    Attributes:
        names: R names, actuators first.
        rows: (..., R, 6) [F, T about O′]; unit forces, or unit couples where the force vanishes.
        point: (..., R, 3) mm, a point on each wrench's line, base frame; O′ for couples.
        determinant: (...,) of the rows, moments of forces divided by a characteristic length and
            couples as units (`wrenches.determinant`); zero exactly at parallel and constraint
            singularities.
        gain: (..., J) power per joint rate and unit of the actuator's wrench, see `Wrenches`.
    """

    names: tuple[WrenchName, ...]
    rows: Array
    point: Array
    determinant: Array
    gain: Array


@dataclass(frozen=True, eq=False)
class Statics(Frozen):
    """What actuators and constraints do to hold a load; equilibrium: wrenches + load = 0.

    NaN where the posture does not close; infinite is never returned: at a singularity the answer
    is NaN too.

    Attributes:
        names: R names, actuators first; the same order as in ``forces``.
        forces: (..., R). An actuator's is positive where it pushes the platform (a rotary one's
            torque acts along +q), N or N·mm; a constraint's multiplies its unit wrench.
        residual: (...,) the largest component of the wrench that is left over, relative to the
            load's size (moments by the characteristic length).
    """

    names: tuple[WrenchName, ...]
    forces: Array
    residual: Array
