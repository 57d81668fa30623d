"""Machines that move in a plane: three circles, six solutions.

In the plane |p + R b − e|² = l²; with d = R b − e two differences are linear in p, which one of the
equations turns into a trigonometric polynomial of degree three in the angle: a sextic in e^{iφ}
(Gosselin, Sefrioui and Richard, J. Mech. Des. 114 (1992) 587), here from its values at 64 angles.
"""

from __future__ import annotations

import numpy as np

from kinematics.arrays import Array
from kinematics.homotopy.tracking import Complex
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.closing import newton
from kinematics.mechanisms.parallel.forward.found import Assembled
from kinematics.mechanisms.parallel.limbs import turned

_SAMPLES = 64
_NONE = 1e-11  # of the largest coefficient: one that is rounding
_REAL = 1e-6  # |log |z|| of a real angle, but for rounding
_DOUBLE_REAL = 1e-3
_SAME = 1e-4
_METHOD = "a polynomial of degree six in the angle of the platform"


def solve(machine: Assembly, joints: Array) -> list[Assembled]:
    """For joints (B, 3)."""
    e, length = machine.drives.locked(joints)
    return [_one(machine, q, *each) for q, *each in zip(joints, e, length, strict=True)]


def _one(machine: Assembly, joints: Array, e: Array, length: Array) -> Assembled:
    normal = machine.bonds.each[0].limb.normal
    axes = np.linalg.svd(normal[None])[2][1:]
    if np.linalg.det(np.stack([*axes, normal])) < 0.0:
        axes = axes[::-1]
    origin, r = machine.reference[:3, 3], machine.reference[:3, :3]
    b = (machine.drives.b @ r.T) @ axes.T
    c = (e - origin) @ axes.T
    unit = max(float(np.abs(b).max()), float(np.abs(c).max()), float(length.max()))
    at = b[:, 0] + 1j * b[:, 1]
    centre, square = (c[:, 0] + 1j * c[:, 1]) / unit, (length / unit) ** 2
    at = at / unit
    z = np.exp(2j * np.pi * np.arange(_SAMPLES) / _SAMPLES)
    values = _eliminated(at, centre, square, z)[0]
    series = np.fft.fft(values) / _SAMPLES
    polynomial = np.concatenate([series[-3:], series[:4]])  # powers −3 … 3
    largest = float(np.abs(polynomial).max())
    if largest <= 1e-13:
        text = "The equations hold for every angle: the platform moves freely, or cannot be put."
        none = np.zeros((0, 4, 4))
        blank = np.zeros((2, 0), dtype=complex)
        times = np.zeros(0, dtype=np.intp)
        return Assembled(none, times, blank, 0, 6, False, _METHOD, (text,))
    kept = np.flatnonzero(np.abs(polynomial) > _NONE * largest)
    roots = np.roots(polynomial[kept[0] : kept[-1] + 1][::-1]).astype(complex)
    count = len(roots)
    p = _eliminated(at, centre, square, roots)[1]
    off = np.abs(np.log(np.abs(roots)))
    near = np.abs(roots[:, None] - roots[None]) < _SAME
    limit = np.where(near.sum(axis=1) > 1, _DOUBLE_REAL, _REAL)
    real = np.flatnonzero(off < limit)
    placements = np.tile(machine.reference, (len(real), 1, 1))
    for k, n in enumerate(real.tolist()):
        place = p[n] * unit
        placements[k, :3, :3] = turned(normal, float(np.angle(roots[n]))) @ r
        placements[k, :3, 3] = origin + place.real * axes[0] + place.imag * axes[1]
    closed = newton(machine, placements, joints)
    good = closed.off < 1e-7 * unit
    groups = near[np.ix_(real, real)].sum(axis=1)
    notes: tuple[str, ...] = ()
    if count < 6:
        notes = (f"{6 - count} of 6 solutions are at infinity for this design.",)
    # Of a triangle without area p is not told by the differences; Newton's method finds it.
    times = np.where(groups > 1, groups, 1).astype(np.intp)
    whole = bool(good.all())
    if not whole:
        notes = (*notes, f"{int((~good).sum())} roots that seem real could not be closed.")
    return Assembled(
        closed.placement[good],
        np.ones(int(good.sum()), dtype=np.intp) if times.max(initial=1) == 1 else times[good],
        np.stack([roots, p]),
        count,
        6,
        whole,
        _METHOD,
        notes,
        int(np.count_nonzero((off >= limit) & (off < 1e-3))) // 2,
    )


def _eliminated(at: Complex, centre: Complex, square: Array, z: Complex) -> tuple[Complex, Complex]:
    """The polynomial's values at z (n,) = e^{iφ}, and p as x + i y on real angles, (n,).

    Conjugates are taken as functions of 1/z, so that all is analytic.
    """
    d = z[:, None] * at - centre
    bar = at.conj() / z[:, None] - centre.conj()
    # |p|² + p d̄ + p̄ d + d d̄ = l²; with p and p̄ as unknowns of their own.
    rest = d * bar - square
    one, two = (d[:, n] - d[:, 0] for n in (1, 2))
    one_bar, two_bar = (bar[:, n] - bar[:, 0] for n in (1, 2))
    r1, r2 = (rest[:, 0] - rest[:, n] for n in (1, 2))
    area = one_bar * two - two_bar * one
    top, top_bar = r1 * two - r2 * one, one_bar * r2 - two_bar * r1
    value = top * top_bar + area * (top * bar[:, 0] + top_bar * d[:, 0]) + area**2 * rest[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        place = top / area
    return value, np.where(np.isfinite(place), place, 0.0)
