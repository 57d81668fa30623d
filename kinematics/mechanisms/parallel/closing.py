"""Closing the loops with the actuators locked: how far placements are, and Newton's method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinematics.arrays import Array
from kinematics.mechanisms.parallel.assembly import Assembly
from kinematics.mechanisms.parallel.bonds import moved
from kinematics.mechanisms.parallel.drives import dot, size


class Closed(NamedTuple):
    """Placements (N, 4, 4) that Newton's method reached.

    Attributes:
        off: (N,) mm, what is left.
        regular: (N,) the smallest singular value of the loops' rows, of unit size.
    """

    placement: Array
    off: Array
    regular: Array


def loops(machine: Assembly, placement: Array, joints: Array, signs: Array) -> tuple[Array, Array]:
    """Values (N, E) of the loops' equations, mm, and their rows (N, E, 6) for [v, ω L].

    Args:
        placement: (N, 4, 4).
        joints: (N, L) or (L,) mm or rad.
        signs: (N, L) ±1, of limbs whose Q or direction is not given by the joint alone.
    """
    drives, length = machine.drives, machine.length
    at = np.asarray(drives.points(placement))
    e, far = drives.locked(joints)
    d = at - e
    count = len(machine.limbs)
    shape = d.shape[:-2]
    values = np.empty((*shape, count))
    force, couple = np.zeros((*shape, count, 3)), np.zeros((*shape, count, 3))
    arm = at - placement[..., None, :3, 3]
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.asarray(size(d))
        values[...] = away - far
        force[...] = d / away[..., None]
    couple[...] = np.cross(arm, force)
    for drive, g in drives.groups.items():
        if drive == "direction":
            one, two = e[..., g, :], at[..., g, :]
            values[..., g] = length * (np.asarray(dot(one, two)) - far[..., g])
            force[..., g, :] = 0.0
            couple[..., g, :] = length * np.cross(two, one)
        elif drive == "offset leg":
            push = drives.pushes(placement, signs)
            q = drives.joints(placement, signs)
            gain = np.asarray(push.gain)[..., g]
            values[..., g] = (q - joints)[..., g] * gain
            force[..., g, :] = np.asarray(push.force)[..., g, :]
            couple[..., g, :] = np.asarray(push.couple)[..., g, :]
    rows = np.concatenate([force, couple], axis=-1)
    if machine.bonds.count:
        held = machine.bonds.at(placement)
        rest = np.concatenate([np.asarray(held.force), np.asarray(held.couple)], axis=-1)
        by = np.where(np.abs(rest[..., :3]).max(axis=-1) > 0.0, 1.0, length)
        values = np.concatenate([values, np.asarray(held.values) * by], axis=-1)
        rows = np.concatenate([rows, rest * by[..., None]], axis=-2)
    return values, rows / np.array([1.0, 1.0, 1.0, length, length, length])


def newton(
    machine: Assembly,
    placement: Array,
    joints: Array,
    signs: Array | None = None,
    rounds: int = 30,
    most: float = 0.5,
) -> Closed:
    """Placements (N, 4, 4) with joints (N, L) that Gauss-Newton steps reach.

    Args:
        most: the longest step, in characteristic lengths and rad.
    """
    length = machine.length
    t = placement.copy()
    if signs is None:
        signs = machine.drives.branches(
            t, np.broadcast_to(joints, (*t.shape[:-2], joints.shape[-1]))
        )
    scale = np.array([1.0, 1.0, 1.0, length, length, length])
    regular = np.zeros(t.shape[:-2])
    for k in range(rounds + 1):
        values, rows = loops(machine, t, joints, signs)
        whole = np.isfinite(rows).all(axis=(-1, -2)) & np.isfinite(values).all(axis=-1)
        good = np.asarray(whole)
        if k == rounds:
            break
        left, sizes, right = np.linalg.svd(
            np.where(good[..., None, None], rows, 0.0), full_matrices=False
        )
        least = sizes[..., 5:6] if sizes.shape[-1] > 5 else 0.0 * sizes[..., :1]
        regular = least[..., 0]
        inverse = np.where(
            sizes > 1e-12 * np.maximum(sizes[..., :1], 1e-300), 1.0 / np.maximum(sizes, 1e-300), 0.0
        )
        turned = (left.swapaxes(-1, -2) @ -values[..., None])[..., 0] * inverse
        step = (right.swapaxes(-1, -2) @ turned[..., None])[..., 0]
        far = np.linalg.norm(step, axis=-1, keepdims=True)
        step = step * np.minimum(1.0, most * length / np.maximum(far, 1e-300))
        t = moved(t, np.where(good[..., None], step, np.nan) / scale)
        if not np.nanmax(np.where(good, far[..., 0], 0.0), initial=0.0) > 1e-14 * length:
            values, rows = loops(machine, t, joints, signs)
            break
    off = np.abs(values).max(axis=-1)
    return Closed(t, np.where(np.isnan(off), np.inf, off), regular)
