"""Pieces of the curves of parallel singularities, each in one working mode.

A loop (`curves`) is cut where a limb is stretched or folded, and at ends of joint ranges.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike

from kinematics.arrays import Array
from kinematics.mechanisms.five_bar.curves import Loop, leaps, loops
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import in_range, mode_of

_EQUAL = 1e-11  # of the size: lengths that differ by less are equal
_SAME = 1e-9  # rad: values of τ that are one
_SHORT = 1e-6  # rad of τ: a piece between two values of one double root is none
_ALWAYS = 1e-9  # a sine below which links are taken to be in line
_SAMPLES = 1440


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
        aside = 1e-8 if leaps(loop) else 0.0
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
    if leaps(loop):
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
    return np.asarray((e[..., 0] * b[..., 1] - e[..., 1] * b[..., 0]) / design.distal)


def _bend_of(loop: Loop, i: int, tau: Array) -> Array:
    """(N,): the same of limb i."""
    return np.asarray(_bend(loop, tau)[..., i])


def _past(loop: Loop, i: int, end: float, tau: Array) -> Array:
    """(N,): the sine of what joint i is past the end of its range, and continuous."""
    _, joints = loop.points(tau)
    return np.asarray(np.sin(joints[..., i] - end))


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
