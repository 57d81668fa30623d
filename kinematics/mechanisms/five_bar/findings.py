"""What is worth knowing about a design of a five-bar before it is moved."""

from __future__ import annotations

import numpy as np

from kinematics.answers.solutions import Finding
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.curves import loops
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.mechanisms.five_bar.loci import base_points


def findings(design: FiveBarDesign) -> tuple[Finding, ...]:
    """Warnings first: limbs that do not meet; then limbs that fold onto their base, and cranks that
    turn through."""
    found: list[Finding] = []
    if not workspace.loops(design):
        text = "the limbs reach no common place: make links longer or the base narrower"
        found.append(Finding("warning", "Empty workspace", text, (1, 2)))
    found += [
        Finding(
            "info",
            f"Limb {i + 1} folds onto its base",
            f"its links are equal, so that P can stand on A{'₁₂'[i]}, where the limb turns freely",
            (i + 1,),
        )
        for i in base_points(design)
    ]
    if any(loop.kind == "parallelogram" for loop in loops(design)):
        text = "the distal links in line are as long as the base, and the proximal links are equal"
        found.append(Finding("info", "Parallelogram", f"{text}: change points", (1, 2)))
    if abs(float(np.diff(design.distal)[0])) <= 1e-9 * design.size:
        text = "B₁ and B₂ can coincide; P then turns freely about them"
        w = 2.0 * design.half_base
        meets = abs(float(np.diff(design.proximal)[0])) <= w <= float(design.proximal.sum())
        if meets:
            found.append(Finding("info", "Equal distal links", text, (1, 2)))
    return tuple(found)
