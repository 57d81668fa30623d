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

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import in_range, mode_of, normal_angles

_EQUAL = 1e-11  # of the size: lengths that differ by less are equal
_FLAT = 1e-14  # of the size: sums of lengths that differ by less are equal
_SAME = 1e-9  # rad: values of τ that are one
_SHORT = 1e-6  # rad of τ: a piece between two values of one double root is none
_ALWAYS = 1e-9  # a sine below which links are taken to be in line
_SAMPLES = 1440

LoopKind = Literal["turning", "swinging", "circle", "parallelogram"]
LoopEnds = Literal["", "far", "near", "both"]


@dataclass(frozen=True)
class Loop:
    """One closed curve of parallel singularities.

    Attributes:
        design: the machine.
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


@dataclass(frozen=True)
class Piece:
    """A part of a loop, from τ = ``start`` to ``end``, in one working mode.

    Its ends are serial singularities, where the working mode changes, or ends of joint ranges;
    ``whole``: it is all of the loop; ``serial``: a limb is stretched or folded all along.
    """

    loop: Loop
    start: float
    end: float
    mode: str
    whole: bool
    serial: bool

    def tau(self, share: ArrayLike) -> Array:
        """τ at a share of the way, 0 to 1."""
        return self.start + (self.end - self.start) * np.asarray(share, dtype=float)


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


def _leaps(loop: Loop) -> bool:
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


# --- pieces in one working mode ------------------------------------------------------------


@lru_cache(maxsize=64)
def pieces(design: FiveBarDesign) -> tuple[Piece, ...]:
    """All loops, cut where the working mode changes, within the joint ranges."""
    found: list[Piece] = []
    for loop in loops(design):
        cuts = _cuts(loop)
        whole = not cuts
        cuts = cuts or [0.0]
        ends = [*cuts[1:], cuts[0] + 2 * np.pi]
        middles = 0.5 * (np.array(cuts) + np.array(ends))
        point, joints = loop.points(middles)
        ok = np.atleast_1d(in_range(design, joints).all(axis=-1))
        modes = mode_of(design, point, joints)
        # Where θ_1 leaps (see _cuts), a piece ends beside the leap, a few nm before the point.
        aside = 1e-8 if _leaps(loop) else 0.0
        serial = np.atleast_1d((np.abs(_bend(loop, middles)) < _ALWAYS).any(axis=-1))
        found += [
            Piece(loop, a + aside, b - aside, mode, whole, bool(flat))
            for a, b, mode, held, flat in zip(cuts, ends, modes, ok, serial, strict=True)
            if held and b - a > _SHORT
        ]
    return tuple(found)


def _cuts(loop: Loop) -> list[float]:
    """τ in [0, 2π) at which a limb is stretched or folded, or a joint at the end of its range."""
    tau = np.linspace(0.0, 2 * np.pi, _SAMPLES + 1)
    design = loop.design
    found = [_roots(partial(_bend_of, loop, i), tau) for i in range(2)]
    found += [
        _at_end(loop, i, end, _roots(partial(_past, loop, i, end), tau))
        for i, limb in enumerate(design.limbs)
        if limb.joint_range_deg is not None
        for end in design.joint_range[i].tolist()
    ]
    if _leaps(loop):
        # Here θ_1 leaps: the four-bar lies flat and goes on as a parallelogram.
        flat = 0.0 if design.distal[0] + loop.side * design.distal[1] > 0.0 else np.pi
        found.append(np.array([flat] if loop.kind == "turning" else [0.0, np.pi]))
    every = np.sort(np.concatenate([*found, *_in_line(loop)]) % (2 * np.pi))
    if not len(every):
        return []
    kept = every[np.concatenate([[True], np.diff(every) > _SAME])]
    if len(kept) > 1 and kept[0] + 2 * np.pi - kept[-1] <= _SAME:
        kept = kept[:-1]
    values: list[float] = kept.tolist()
    return values


def _bend(loop: Loop, tau: Array) -> Array:
    """(N, 2): the sine of the angle from each proximal to its distal link."""
    point, joints = loop.points(tau)
    design = loop.design
    e = np.stack([np.cos(joints), np.sin(joints)], axis=-1)
    b = point[..., None, :] - design.base - design.proximal[:, None] * e
    sine: Array = (e[..., 0] * b[..., 1] - e[..., 1] * b[..., 0]) / design.distal
    return sine


def _bend_of(loop: Loop, i: int, tau: Array) -> Array:
    """(N,): the same of limb i."""
    bend: Array = _bend(loop, tau)[..., i]
    return bend


def _past(loop: Loop, i: int, end: float, tau: Array) -> Array:
    """(N,): the sine of what joint i is past the end of its range, and continuous."""
    _, joints = loop.points(tau)
    sine: Array = np.sin(joints[..., i] - end)
    return sine


def _at_end(loop: Loop, i: int, end: float, tau: Array) -> Array:
    """Of values of τ those at which joint i is at ``end``, and not half a turn away."""
    _, joints = loop.points(tau)
    return tau[np.cos(joints[..., i] - end) > 0.0]


def _roots(function: Callable[[Array], Array], tau: Array) -> Array:
    """Where a function of τ changes its sign, by bisection, all at once."""
    value = function(tau)
    if np.abs(value).max() < _ALWAYS:
        return np.zeros(0)  # zero all along the loop, but for rounding
    at = np.flatnonzero((value[:-1] < 0.0) != (value[1:] < 0.0))
    low, high = tau[at].copy(), tau[at + 1].copy()
    rising = value[at + 1] > value[at]
    for _ in range(60):
        half = 0.5 * (low + high)
        above = (function(half) >= 0.0) == rising
        high, low = np.where(above, half, high), np.where(above, low, half)
    return 0.5 * (low + high)


def _in_line(loop: Loop) -> list[Array]:
    """τ at which a limb is in line with the coupler, from the triangle that is left then.

    Two such places may be so close to one another that no sample lies in between.
    """
    d = loop.design
    if loop.kind == "circle":
        _, joints = loop.points(np.zeros(1))
        return [np.concatenate([joints[0], joints[0] + np.pi])]
    if loop.kind == "parallelogram":
        return [np.array([0.0, np.pi])]
    (r1, r1b), (r2, r2b), w = d.proximal, d.distal, 2.0 * d.half_base
    k = float(r2 + loop.side * r2b)
    found: list[Array] = []
    for turn in (1.0, -1.0):
        along = k + turn * r1  # from A_1 to B_2, where e(θ_1) = ± u
        if abs(along) > _EQUAL * d.size:
            found += _taus(loop, (along**2 + w * w - r1b**2) / (2.0 * w * along))
        along = k - turn * r1b  # from B_1 to A_2, where e(θ_2) = ± u
        if abs(along) > _EQUAL * d.size:
            found += _taus(loop, (along**2 + w * w - r1**2) / (2.0 * w * along))
    return found


def _taus(loop: Loop, cosine: float) -> list[Array]:
    """τ at which cos γ has a value and a limb is in line with the coupler."""
    if abs(cosine) > 1.0 + 1e-12:
        return []
    angle = float(np.arccos(np.clip(cosine, -1.0, 1.0)))
    candidates: list[float] = []
    for gamma in (angle, -angle):
        if loop.kind == "turning":
            candidates.append(gamma)
            continue
        for turns in (-2, -1, 0, 1, 2):
            share = (gamma + 2 * np.pi * turns - loop.middle) / loop.half
            if abs(share) <= 1.0 + 1e-12:
                tau = float(np.arcsin(np.clip(share, -1.0, 1.0)))
                candidates += [tau, np.pi - tau]
    if not candidates:
        return []
    taus = np.array(candidates)
    return [taus[(np.abs(_bend(loop, taus)) < 1e-7).any(axis=-1)]]


# --- the implicit equation -----------------------------------------------------------------


def sextic(design: FiveBarDesign, points: ArrayLike, side: int) -> tuple[Array, Array]:
    """The sextic's value (...) mm⁴/mm² and gradient (..., 2), made dimensionless but for mm².

    Zero where P (..., 2) mm can stand in a parallel singularity of this side, in some working mode.
    """
    p = np.asarray(points, dtype=float)
    x, y = p[..., 0], p[..., 1]
    w = 2.0 * design.half_base
    away = p[..., None, :] - design.base
    r1, r2 = design.proximal, design.distal
    n = ((away**2).sum(axis=-1) + r2**2 - r1**2) / (2.0 * r2)
    dn = away / r2[:, None]
    u = (n[..., 0] + side * n[..., 1]) / w
    du = (dn[..., 0, :] + side * dn[..., 1, :]) / w
    m = n[..., 0] - away[..., 0, 0] * u
    dm = dn[..., 0, :] - away[..., 0, 0, None] * du
    dm = dm - np.stack([u, np.zeros_like(u)], axis=-1)
    value = m**2 - y**2 * (1.0 - u**2)
    gradient = 2.0 * m[..., None] * dm + (2.0 * y**2 * u)[..., None] * du
    gradient = gradient - np.stack([np.zeros_like(x), 2.0 * y * (1.0 - u**2)], axis=-1)
    return value, gradient


def closure(design: FiveBarDesign, points: Array, joints: Array, side: int) -> Array:
    """How far configurations (N, 2), (N, 2) are from a parallel singularity of this side, mm.

    The largest of | |P − B_i| − r_2 | and | |B_1 B_2| − |r_2 + s r_2'| |.
    """
    e = np.stack([np.cos(joints), np.sin(joints)], axis=-1)
    b = design.base + design.proximal[:, None] * e
    off = np.abs(np.linalg.norm(points[:, None, :] - b, axis=-1) - design.distal).max(axis=-1)
    between = np.linalg.norm(b[:, 1] - b[:, 0], axis=-1)
    wanted = abs(float(design.distal[0] + side * design.distal[1]))
    result: Array = np.maximum(off, np.abs(between - wanted))
    return result


def sampled(piece: Piece, step: float) -> tuple[Array, Array]:
    """Points (N, 2) mm and joints (N, 2) rad along a piece, both ends included, denser where P
    moves faster than ``step`` mm from one to the next.
    """
    share = np.linspace(0.0, 1.0, 65)
    for _ in range(12):
        point, joints = piece.loop.points(piece.tau(share))
        gap = np.hypot(*np.diff(point, axis=0).T)
        wide = gap > step
        if not wide.any():
            break
        share = np.sort(np.concatenate([share, 0.5 * (share[:-1] + share[1:])[wide]]))
    return point, joints
