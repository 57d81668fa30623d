"""Motions of the 4-SPS + 1-SPR that stay free with all legs locked: curves of solutions."""

from __future__ import annotations

import numpy as np

from kinematics.answers.solutions import SelfMotion
from kinematics.arrays import Array
from kinematics.homotopy.tracking import Complex
from kinematics.mechanisms.four_sps_spr.closure import Closure, State, pose_of
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.forward.equations import Frame, normal_form, to_transforms

_FAR = 1e2  # units
_MOST = 16  # singular solutions looked at
_SINGULAR = 1e-4  # smallest singular value of the equations, relative to the largest
_TRIES = (0.05, 0.2)  # how far along a free direction solutions must exist


def self_motions(
    design: FourSPSSPRDesign, joints: Array, frame: Frame, singular: Complex
) -> tuple[SelfMotion, ...]:
    """One motion, if there is any, from the singular solutions (8, n).

    A path that ends on a curve of solutions ends anywhere on it, as a rule not at a real point;
    that is sought next to its real part. Then solutions are sought a finite way along each free
    direction there: at a fold there are none, on a self-motion they exist on both sides.
    """
    if not singular.size:
        return ()
    form = normal_form(singular)
    form = form[:, np.abs(form).max(axis=0) < _FAR]
    closure = Closure(design, float(joints.max()))
    for n in np.argsort(np.abs(form.imag).max(axis=0))[:_MOST]:
        (r,), (p,) = to_transforms(frame, form[:, [n]])
        here = _closed(closure, State(r, p), joints)
        if here is None:
            continue
        at = closure.linear(here, joints)
        _, sizes, vectors = np.linalg.svd(at.by_state)
        free = vectors[sizes <= _SINGULAR * sizes[0]]
        for direction in _directions(free):
            if all(
                _reaches(closure, here, joints, sign * step * direction)
                for step in _TRIES
                for sign in (1.0, -1.0)
            ):
                return (_motion(closure, here, direction),)
    return ()


def _directions(free: Array) -> list[Array]:
    """The free directions, and between two of them some more."""
    if len(free) < 2:
        return list(free)
    angles = np.linspace(0.0, np.pi, 12, endpoint=False)
    return [np.cos(a) * free[-1] + np.sin(a) * free[-2] for a in angles]


def _motion(closure: Closure, here: State, direction: Array) -> SelfMotion:
    length = closure.design.length
    pose = pose_of(here)
    ahead = np.array(pose_of(closure.moved(here, 1e-6 * direction), pose))
    d = ahead - np.array(pose)
    d[3:] = np.mod(d[3:] + np.pi, 2.0 * np.pi) - np.pi
    parts = np.abs(d) * np.array([1.0, 1.0, 1.0, length, length, length])
    d = d / np.sqrt((parts**2).sum())
    names = ("x", "y", "z", "α", "β", "γ")
    free = [name for name, part in zip(names, parts, strict=True) if part > 0.05 * parts.max()]
    text = (
        f"Self-motion: the platform moves freely ({', '.join(free)}) with all legs locked; "
        "infinitely many solutions belong to it."
    )
    return SelfMotion(pose, "", tuple(d.tolist()), text)


def _reaches(closure: Closure, here: State, joints: Array, step: Array) -> bool:
    """There is a solution about ``step`` away."""
    there = _closed(closure, closure.moved(here, step), joints)
    if there is None:
        return False
    length = closure.design.length
    spin = 0.5 * (there.r @ here.r.T - here.r @ there.r.T)
    moved = np.array([*((there.p - here.p) / length), spin[2, 1], spin[0, 2], spin[1, 0]])
    size = float(np.linalg.norm(step))
    return bool(moved @ step > 0.5 * size * size and np.linalg.norm(moved) < 3.0 * size)


def _closed(closure: Closure, guess: State, joints: Array) -> State | None:
    """The nearest solution by Gauss-Newton steps of least length; None if there is none."""
    state = guess
    for _ in range(40):
        at = closure.linear(state, joints)
        if at.error <= 10.0 * closure.tolerance:
            return state
        step = np.asarray(np.linalg.lstsq(at.by_state, -at.residual, rcond=1e-9)[0], dtype=float)
        size = float(np.abs(step).max())
        state = closure.moved(state, step * min(1.0, 0.2 / max(size, 1e-300)))
    return None
