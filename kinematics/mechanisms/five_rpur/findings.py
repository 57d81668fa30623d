"""What a designer should know of a 5-RPUR: its arrangements, what follows from them, warnings."""

from __future__ import annotations

from functools import lru_cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import Finding
from kinematics.arrays import Array
from kinematics.mechanisms.five_rpur.arrangements import (
    CLASSES,
    Arrangements,
    Group,
    arrangements,
    conditions,
    listed,
)
from kinematics.mechanisms.five_rpur.design import LIMBS, SUBSCRIPTS, TOLERANCE, FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import inside, signs
from kinematics.mechanisms.five_rpur.singularities.determinant import at_poses

_NEAR = 1e-2  # part of the size within which a condition is missed narrowly
_SINGULAR = 1e3  # of the rounding of a determinant: what vanishes
_SAMPLES = 24
_SEARCH = 4096, 48  # poses at a time, times, in the search for a reachable one


@lru_cache(maxsize=256)
def findings(design: FiveRPURDesign) -> tuple[Finding, ...]:
    """What a designer should know: arrangements, their consequences, warnings; in plain words."""
    found = arrangements(design)
    answer = [Finding("warning", "Architecturally singular", text) for text in found.reasons]
    if not found.reasons and len(modes := singular_modes(design)) > 0:
        answer.append(_modes_finding(modes, len(design.modes)))
    if not _reachable_somewhere(design):
        answer.append(
            Finding(
                "warning",
                "No reachable pose found",
                f"None of {_SEARCH[0] * _SEARCH[1]} sampled poses can be held within the "
                "strokes: the workspace is empty or very small. Bring the limbs closer together, "
                "or lengthen links and strokes.",
            )
        )
    answer += [_merged_finding(design, limbs) for limbs in design.merged_joints]
    answer += [_group_finding(design, group) for group in found.groups]
    answer += _class_findings(design, found)
    answer += _near_misses(design, found)
    return tuple(answer)


def singular_modes(design: FiveRPURDesign) -> tuple[str, ...]:
    """The working modes in which the six wrenches are dependent at every pose.

    Their determinant is sampled at poses of a fixed sequence, reachable or not: where a limb
    cannot close, h = sqrt(l² − Y²) is imaginary and the determinant complex, but if it vanishes
    identically it vanishes there too.
    """
    poses = _sample_poses(design)
    found = []
    for mode in design.modes:
        value, noise = at_poses(design, poses, signs(mode), imaginary=True)
        if (np.abs(value) <= _SINGULAR * noise).all():
            found.append(mode)
    return tuple(found)


def _sample_poses(design: FiveRPURDesign) -> Array:
    rng = np.random.default_rng(20110401)
    reach = design.size
    position = design.base.mean(axis=0) + rng.uniform(-reach, reach, (_SAMPLES, 3))
    return np.concatenate([position, rng.uniform(-np.pi, np.pi, (_SAMPLES, 2))], axis=1)


def _reachable_somewhere(design: FiveRPURDesign) -> bool:
    """Whether a reachable pose turns up, in any working modes.

    Positions are drawn only where, for the orientation drawn, every limb's box allows them.
    """
    rng = np.random.default_rng(20110401)
    count, rounds = _SEARCH
    for _ in range(rounds):
        phi, theta = rng.uniform(-np.pi, np.pi, (2, count, 1))
        c, s, cf, sf = np.cos(theta), np.sin(theta), np.cos(phi), np.sin(phi)
        rx, ry, rz = design.base.T
        sx, sy, sz = design.platform.T
        high = design.stroke[:, 1]
        centre = (rx * c - rz * s - sx, ry - cf * sy + sf * sz, rx * s + rz * c - sf * sy - cf * sz)
        reach = (high, design.link, high + design.link)
        low = np.stack([(m - r).max(axis=1) for m, r in zip(centre, reach, strict=True)])
        top = np.stack([(m + r).min(axis=1) for m, r in zip(centre, reach, strict=True)])
        ok: NDArray[np.bool_] = np.all(low < top, axis=0)
        x, y, z = low + (top - low) * rng.uniform(size=(3, count))
        c, s, phi, theta = c[:, 0], s[:, 0], phi[:, 0], theta[:, 0]
        poses = np.stack([x * c + z * s, y, z * c - x * s, phi, theta], axis=-1)[ok]
        if len(poses) and inside(design, poses).any():
            return True
    return False


def _modes_finding(modes: tuple[str, ...], existing: int) -> Finding:
    if len(modes) == existing:
        which = "in all working modes"
    elif len(modes) <= 4:
        which = f"in the working modes {', '.join(modes)}"
    else:
        which = f"in {len(modes)} of the {existing} working modes"
    return Finding(
        "warning",
        "Architecturally singular",
        f"The six wrenches are dependent at every pose {which}: the platform cannot be held.",
    )


_KIND_TEXT = {
    "A1": "their platform points coincide and their base points lie in one plane normal to e₁",
    "A2": "their base points coincide and their platform points are aligned with e₂",
    "A3": "their base points lie in one plane normal to e₁ and their platform points are aligned "
    "with e₂",
    "same": "their base points and their platform points coincide",
}


def _merged_finding(design: FiveRPURDesign, limbs: tuple[int, ...]) -> Finding:
    text = (
        f"Limbs {listed(limbs)} share one U joint, so they always stand in the same working mode: "
        f"of the 32 modes the design has {len(design.modes)}."
    )
    return Finding("info", "Merged U joint", text, limbs)


def _group_finding(design: FiveRPURDesign, group: Group) -> Finding:
    limbs = listed(group.limbs)
    if not group.middle:
        text = (
            f"Limbs {limbs}: {_KIND_TEXT[group.kind]}, and their links are equal. In the same "
            "working mode their second links stay parallel, and the line through their U joints "
            "is parallel to e₂."
        )
        if group.kind == "A1" and group.limbs not in design.merged_joints:
            text += (
                " Nothing says that their U joints are one, so they may also stand in different "
                f"modes; if they are, add merged_joints = [{list(group.limbs)}] to the design file."
            )
        title = f"Arrangement {group.kind}" if group.kind != "same" else "Coincident pair"
        return Finding("info", title, text, group.limbs)
    pairs = ", ".join(f"{p.limbs[0]}-{p.limbs[1]} {p.kind}" for p in group.pairs)
    text = (
        f"Limbs {limbs} all satisfy the conditions with each other (pairs: {pairs}): in the same "
        "working mode all their second links stay parallel."
    )
    return Finding("info", "Mp set", text, group.limbs)


def _class_findings(design: FiveRPURDesign, found: Arrangements) -> list[Finding]:
    known = CLASSES.get(found.name)
    if known is None or found.reasons:
        if found.groups or found.reasons:
            return []
        text = (
            "No two limbs form a simplified arrangement: a general design, up to 1680 complex "
            "solutions of the forward kinematics."
        )
        return [Finding("info", "General design", text)]
    how = "in closed form" if known.closed_form else "from one polynomial in one unknown"
    limbs = tuple(i for group in found.groups for i in group.limbs)
    answer = [
        Finding(
            "info",
            f"Simplified design {found.name}",
            f"With the limbs of each arrangement in the same working mode, the forward "
            f"kinematics gives θ {how} ({known.angles} values) and up to {known.solutions} "
            "solutions.",
            limbs,
        )
    ]
    text = _self_motion(design, found)
    if text:
        answer.append(Finding("info", "Self-motion", text, limbs))
    return answer


def _self_motion(design: FiveRPURDesign, found: Arrangements) -> str:
    """The self-motions that the paper names for {A1A1} (after eq. 12) and {A1A2} (after 25)."""
    if found.name == "{A1A1}":
        one, two = found.groups
        offsets = [float(design.platform[group.limbs[0] - 1, 0]) for group in (one, two)]
        if abs(offsets[0] - offsets[1]) <= TOLERANCE * design.size:
            return (
                f"Both platform points have the same x′ ({offsets[0]:g} mm), so the U joints of "
                f"limbs {listed(one.limbs)} and of limbs {listed(two.limbs)} can come onto one "
                "line along e₁; there θ is free with all actuators locked."
            )
        return ""
    if found.name == "{A1A2}":
        merged = next(group for group in found.groups if group.kind == "A1").limbs
        shared = next(group for group in found.groups if group.kind == "A2").limbs
        s = float(design.platform[merged[0] - 1, 0])
        s1, s2 = (float(design.platform[i - 1, 0]) for i in shared)
        # X − a is fixed by ρ_j² − ρ_i² (eq. 22); with B_34 on the axis it has to be −s34.
        value = (s2 - s) ** 2 - (s1 - s) ** 2
        i, j = (SUBSCRIPTS[k - 1] for k in shared)
        return (
            f"Where the U joint of limbs {listed(merged)} comes onto the line along e₁ through "
            f"the base point of limbs {listed(shared)}, and ρ{j}² − ρ{i}² = {value:g} mm², θ is "
            "free with all actuators locked."
        )
    return ""


_CONDITION_TEXT = (
    "their base points differ by {:.3g} mm along e₁",
    "their links differ by {:.3g} mm",
    "their platform points are {:.3g} mm off a line along e₂",
)


def _near_misses(design: FiveRPURDesign, found: Arrangements) -> list[Finding]:
    """Pairs that satisfy two conditions and miss the third by little, as a slip would."""
    equal, near = TOLERANCE * design.size, _NEAR * design.size
    answer = []
    for i, j in combinations(range(LIMBS), 2):
        misses = conditions(design, i, j)
        off = [k for k in range(3) if misses[k] > equal]
        if len(off) == 1 and misses[off[0]] <= near:
            text = _CONDITION_TEXT[off[0]].format(misses[off[0]])
            answer.append(
                Finding(
                    "info",
                    "Nearly an arrangement",
                    f"Limbs {i + 1} and {j + 1} would form a simplified arrangement, but {text}.",
                    (i + 1, j + 1),
                )
            )
    return answer
