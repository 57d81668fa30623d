"""What is worth knowing about a parallel mechanism before it moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kinematics.answers.solutions import Finding
from kinematics.mechanisms.parallel.mobility import SYMBOLS
from kinematics.screws.wrenches import singular_values

if TYPE_CHECKING:
    from kinematics.mechanisms.parallel.mechanism import Parallel

_SINGULAR = 1e-6
_CLOSED = 1e-6  # mm or degrees: a reference pose that is moved by more was a rough one


def findings(mechanism: Parallel) -> tuple[Finding, ...]:
    """How it moves, what follows, how far the reference was moved, and warnings."""
    machine = mechanism.machine
    found, chart = machine.mobility, machine.chart
    answer = []
    types = " and ".join(_types(mechanism))
    moved = ", ".join(SYMBOLS[n] for n in chart.free)
    text = f"{types}: {found.words}; a pose is told by {moved}"
    if chart.following:
        text += f", and {', '.join(SYMBOLS[n] for n in chart.following)} follow (parasitic motion)"
    if found.redundant:
        text += (
            f". {found.redundant} of the limbs' constraints say what others say (overconstrained)"
        )
    answer.append(Finding("info", f"{found.free} degrees of freedom", text + "."))
    off = float(np.abs(machine.reference[:3, 3] - machine.start[:3, 3]).max())
    turn = machine.reference[:3, :3] @ machine.start[:3, :3].T
    angle = float(np.degrees(np.linalg.norm(turn - np.eye(3)) / np.sqrt(2.0)))
    if off > _CLOSED or angle > _CLOSED:
        answer.append(
            Finding(
                "info",
                "Reference pose closed",
                f"The file's reference pose cannot be assembled exactly; it was moved by {off:.3g} "
                f"mm and turned by {angle:.3g}°.",
            )
        )
    if found.instantaneous > found.free:
        answer.append(
            Finding(
                "warning",
                "Constraint singularity at the reference",
                f"At the reference pose alone the platform has {found.instantaneous} instantaneous "
                f"freedoms instead of {found.free}.",
            )
        )
    home = mechanism.home()
    if not home.reachable:
        answer.append(
            Finding(
                "warning",
                "Out of reach",
                "The reference pose is beyond a bound: "
                + "; ".join(reason.text for reason in home.reasons)
                + ".",
                tuple(reason.limb for reason in home.reasons if reason.limb),
            )
        )
    else:
        rows = mechanism.wrenches(machine.reference, home.mode).rows
        if singular_values(rows, machine.length)[-1] < _SINGULAR:
            answer.append(
                Finding(
                    "warning",
                    "Singular at the reference",
                    "The actuators and constraints do not hold the platform at the reference pose; "
                    "give another one, or other limbs.",
                )
            )
    return tuple(answer)


def _types(mechanism: Parallel) -> list[str]:
    """ "6 UPS", "3 RPS"."""
    counts: dict[str, int] = {}
    for limb in mechanism.machine.limbs:
        counts[limb.kind.name] = counts.get(limb.kind.name, 0) + 1
    return [f"{count}-{name}" for name, count in counts.items()]
