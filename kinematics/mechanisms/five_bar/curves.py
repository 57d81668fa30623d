"""The parallel singularities of the five-bar as curves with exact points.

B_1, P and B_2 are in line: with u the direction from B_1 to P, B_2 = P + s r_2' u with s = 1
(extended) or s = −1 (folded), so A_1 B_1 B_2 A_2 is a four-bar linkage whose coupler has the length
k = r_2 + s r_2', and P is a point of it. In the plane, for any five lengths,

    [n_1 − (x + r_3) u_x]² = y² (1 − u_x²),  u_x = (n_1 + s n_2) / (2 r_3),
    n_i = (ρ_i² + r_2,i² − r_1,i²) / (2 r_2,i),  ρ_i = |P − A_i|:

a sextic for each s. Where the distal links are equal, the folded one is B_1 = B_2 with P anywhere
on a circle about it. Sosa-López et al. 2017, eq. 25; the four-bar's loops follow from Grashof.

A loop is given by an angle τ of period 2π: the direction γ of u follows from it, swinging to and
fro where the linkage cannot turn through, and then θ_1 with one of two signs. Every point so has
its configuration, and none is iterated for. Lengths mm, angles rad.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import normal_angles

_EQUAL = 1e-11  # of the size: lengths that differ by less are equal
_FLAT = 1e-14  # of the size: sums of lengths that differ by less are equal

LoopKind = Literal["turning", "swinging", "circle", "parallelogram"]
LoopEnds = Literal["", "far", "near", "both"]


@dataclass(frozen=True)
class Loop:
    """One closed curve of parallel singularities.

    Attributes:
        side: s, 1 extended or −1 folded.
        kind: "turning": γ = τ; "swinging": γ = middle + half sin τ; "circle": B_1 = B_2 stands
            still; "parallelogram": the coupler stays parallel to the base.
        sign: which of the two ways in which the four-bar closes; a swinging one has both.
        middle, half: rad, of a swinging one.
        offset: rad, ``middle`` from the direction in which v is least.
        ends: at which of its limits a swinging one turns back: v greatest, least, or both.
    """

    design: FiveBarDesign
    side: int
    kind: LoopKind
    sign: float = 1.0
    middle: float = 0.0
    half: float = 0.0
    offset: float = 0.0
    ends: LoopEnds = ""

    def points(self, tau: ArrayLike) -> tuple[Array, Array]:
        """P (..., 2) mm and θ (..., 2) rad at τ (...)."""
        t = np.asarray(tau, dtype=float)
        d = self.design
        (r1, r1b), (r2, r2b), w = d.proximal, d.distal, 2.0 * d.half_base
        k = 0.0 if self.kind == "circle" else float(r2 + self.side * r2b)
        size, way = abs(k), 1.0 if k >= 0.0 else -1.0
        if self.kind == "parallelogram":
            delta = np.zeros_like(t)
            theta1 = t
        else:
            delta, far, near = self._room(t, w, k)
            sign = np.where(np.cos(t) >= 0.0, 1.0, -1.0) if self.kind == "swinging" else self.sign
            # |v + r_1 e(θ_1)| = r_1', v from A_2 to A_1 and on by the coupler. Of the triangle
            # (v, r_1, r_1') the squares far and near say how much is left to where it is flat.
            v = np.sqrt((size - w) ** 2 + 4.0 * w * size * np.sin(0.5 * delta) ** 2)
            long, short = v + (r1 + r1b), v + abs(r1 - r1b)
            if r1 >= r1b:
                half = np.arctan2(np.sqrt(far * near), long * short)
            else:
                half = np.arctan2(np.sqrt(far) * short, long * np.sqrt(near))
            vx, vy = (size - w) - 2.0 * size * np.sin(0.5 * delta) ** 2, size * np.sin(delta)
            theta1 = np.arctan2(-vy, -vx) + sign * 2.0 * half
        b1 = d.base[0] + r1 * np.stack([np.cos(theta1), np.sin(theta1)], axis=-1)
        u = way * np.stack([np.cos(delta), np.sin(delta)], axis=-1)
        arm = b1 + k * u - d.base[1]
        theta2 = np.arctan2(arm[..., 1], arm[..., 0])
        theta1 = theta1 + 0.0 * theta2
        return b1 + r2 * u, normal_angles(d, np.stack([theta1, theta2], axis=-1))

    def _room(self, t: Array, w: float, k: float) -> tuple[Array, Array, Array]:
        """δ = γ − its value where v is least, (r_1 + r_1')² − v², and v² − (r_1 − r_1')², (...).

        As products, or sums of what is not negative, which keep their digits to the turning points.
        """
        size = abs(k)
        sweep = self.half * np.sin(t)
        delta = self.offset + sweep if self.kind == "swinging" else t - _base(k)
        scale = 4.0 * w * size
        # Halves of what γ lacks to the ends of its swing.
        upper = self.half * np.sin(0.25 * np.pi - 0.5 * t) ** 2
        lower = self.half * np.sin(0.25 * np.pi + 0.5 * t) ** 2
        if self.ends == "both":
            up = self.offset > 0.0
            mid = abs(self.offset)
            beyond = 2.0 * mid + (sweep if up else -sweep)
            far = scale * np.sin(0.5 * (beyond + self.half)) * np.sin(upper if up else lower)
            near = scale * np.sin(0.5 * (beyond - self.half)) * np.sin(lower if up else upper)
            return delta, np.maximum(far, 0.0), np.maximum(near, 0.0)
        within = scale * np.sin(upper) * np.sin(lower)
        far_gap, near_gap = _gaps(self.design, k)
        far = far_gap + scale * np.cos(0.5 * delta) ** 2
        near = near_gap + scale * np.sin(0.5 * delta) ** 2
        far = within if self.ends == "far" else far
        near = within if self.ends == "near" else near
        return delta, np.maximum(far, 0.0), np.maximum(near, 0.0)


@lru_cache(maxsize=64)
def loops(design: FiveBarDesign) -> tuple[Loop, ...]:
    """All closed curves of parallel singularities, joint ranges left aside."""
    found: list[Loop] = []
    (r1, r1b), (r2, r2b), w = design.proximal, design.distal, 2.0 * design.half_base
    tiny = _EQUAL * design.size
    for side in (1, -1):
        k = float(r2 + side * r2b)
        if abs(k) <= tiny:
            if abs(r1 - r1b) - tiny <= w <= r1 + r1b + tiny:
                # Stretched over the base, or folded, the cranks have but one place for B_1 = B_2.
                flat = abs(w - r1 - r1b) <= tiny or abs(w - abs(r1 - r1b)) <= tiny
                signs = (1.0,) if flat else (1.0, -1.0)
                found += [Loop(design, side, "circle", sign) for sign in signs]
            continue
        if _parallelogram(design, side):
            found.append(Loop(design, side, "parallelogram"))
        found += _coupler_loops(design, side, k)
    return tuple(found)


def _parallelogram(design: FiveBarDesign, side: int) -> bool:
    """Whether the four-bar has equal cranks and a coupler as long as its base."""
    tiny = _EQUAL * design.size
    coupler = abs(float(design.distal[0] + side * design.distal[1]))
    equal = abs(float(design.proximal[0] - design.proximal[1])) <= tiny
    return equal and abs(coupler - 2.0 * design.half_base) <= tiny


def leaps(loop: Loop) -> bool:
    """Whether θ_1 leaps where γ is that of the base."""
    return loop.kind in ("turning", "swinging") and _parallelogram(loop.design, loop.side)


def _coupler_loops(design: FiveBarDesign, side: int, k: float) -> list[Loop]:
    """The loops of one four-bar: two that turn or swing by themselves, or one that has it all."""
    r1, r1b = design.proximal.tolist()
    w = 2.0 * design.half_base
    tiny = _EQUAL * design.size**2
    # v² = k² + w² − 2 k w cos γ has to lie between (r_1 − r_1')² and (r_1 + r_1')².
    least = (k * k + w * w - (r1 + r1b) ** 2) / (2.0 * w)
    most = (k * k + w * w - (r1 - r1b) ** 2) / (2.0 * w)
    size = abs(k)
    # Where only one configuration closes, flat, there is a point and no curve.
    if least > size - tiny / w or most < -size + tiny / w:
        return []
    base = _base(k)
    far_gap, near_gap = _gaps(design, k)
    near = near_gap < 0.0  # cannot pass γ = base
    far = far_gap < 0.0  # cannot pass the opposite direction
    # 2 w (|k| − |k| cos γ) and 2 w (|k| + |k| cos γ) where v is least, and greatest.
    whole = 4.0 * size * w
    low = 2.0 * float(np.arctan2(np.sqrt(-near_gap), np.sqrt(whole + near_gap))) if near else 0.0
    high = 2.0 * float(np.arctan2(np.sqrt(whole + far_gap), np.sqrt(-far_gap))) if far else np.pi
    if near and far:
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        return [_swinging(design, side, base, way * middle, half, "both") for way in (1.0, -1.0)]
    if far:
        return [_swinging(design, side, base, 0.0, high, "far")]
    if near:
        return [_swinging(design, side, base, np.pi, np.pi - low, "near")]
    return [Loop(design, side, "turning", sign) for sign in (1.0, -1.0)]


def _swinging(
    design: FiveBarDesign, side: int, base: float, offset: float, half: float, ends: LoopEnds
) -> Loop:
    return Loop(design, side, "swinging", middle=base + offset, half=half, offset=offset, ends=ends)


def _base(k: float) -> float:
    """γ where v, from A_2 to A_1 and on by the coupler k, is least."""
    return 0.0 if k >= 0.0 else np.pi


def _gaps(design: FiveBarDesign, k: float) -> tuple[float, float]:
    """(r_1 + r_1')² − v² where v is greatest, and v² − (r_1 − r_1')² where it is least, mm².

    Zero where that is all rounding: there the four-bar passes a position in which it lies flat.
    """
    r1, r1b = design.proximal.tolist()
    w, size = 2.0 * design.half_base, abs(k)
    slack = _FLAT * design.size
    most, least, longest, shortest = r1 + r1b, abs(r1 - r1b), size + w, abs(size - w)
    far, near = most - longest, shortest - least
    if abs(far) <= slack:
        far = 0.0
    if abs(near) <= slack or max(shortest, least) <= _EQUAL * design.size:
        near = 0.0
    return far * (most + longest), near * (shortest + least)


def closure(design: FiveBarDesign, points: Array, joints: Array, side: int) -> Array:
    """How far configurations (N, 2), (N, 2) are from a parallel singularity of this side, mm.

    The largest of | |P − B_i| − r_2 | and | |B_1 B_2| − |r_2 + s r_2'| |.
    """
    e = np.stack([np.cos(joints), np.sin(joints)], axis=-1)
    b = design.base + design.proximal[:, None] * e
    off = np.abs(np.linalg.norm(points[:, None, :] - b, axis=-1) - design.distal).max(axis=-1)
    between = np.linalg.norm(b[:, 1] - b[:, 0], axis=-1)
    wanted = abs(float(design.distal[0] + side * design.distal[1]))
    return np.asarray(np.maximum(off, np.abs(between - wanted)))
