"""Forward displacement of the 4-SPS + 1-SPR: all assembly modes for given leg lengths."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import ForwardSolutions, SelfMotion
from kinematics.arrays import Array
from kinematics.facets.forward import ForwardFacet
from kinematics.homotopy.assembly_sets import (
    NEAR,
    NONE_FOUND,
    NONE_REAL,
    described,
    grouped,
    not_closed,
)
from kinematics.homotopy.solving import Roots
from kinematics.homotopy.tracking import Complex
from kinematics.mechanism import mechanism_of
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.following import Following, state_of, unknowns_of
from kinematics.mechanisms.four_sps_spr.forward.equations import Frame, normal_form, to_transforms
from kinematics.mechanisms.four_sps_spr.forward.roots import own_start_set, roots_at
from kinematics.mechanisms.four_sps_spr.forward.start_set import GENERAL_COUNT, StartSet
from kinematics.mechanisms.four_sps_spr.inverse import (
    STROKE_SLACK,
    leg_lengths,
    rotation,
    violation,
)
from kinematics.mechanisms.four_sps_spr.motion import placement
from kinematics.mechanisms.four_sps_spr.states import State, pose_of, poses_of
from kinematics.mechanisms.four_sps_spr.statics import condition, wrenches
from kinematics.screws.wrenches import determinant

REAL = 1e-7
"""Largest imaginary part of a real solution, relative to its size; of a double one its root."""
_DOUBLE_REAL = 1e-4  # as REAL, of solutions where several coincide
_DOUBLE = 1e-5  # of the machine and the shortest leg: closer solutions are one, seen twice
_CURVES_FAR = 1e2  # units, of singular solutions that are looked at
_MOST = 16  # of these
_FAR = 500.0  # units: with longer legs the platform is a point to them, and digits are lost


class Solving(ForwardFacet[FourSPSSPRDesign]):
    """All assembly modes for given leg lengths."""

    noun = "leg lengths"
    chunk = 16

    def solve(self, joints: Array, *, mixed_modes: bool) -> list[ForwardSolutions]:
        found = roots_at(self.design, joints)
        return [
            _answer(self.design, one, roots, _real_ones(self.design, one, roots))
            for one, roots in zip(joints, found, strict=True)
        ]


class _Real:
    """The real solutions at one vector of lengths: poses (n, 6), and how many each stands for.

    Also how many complex pairs are nearly real, and how many roots that seem real were not closed.
    """

    def __init__(self, poses: Array, weights: NDArray[np.intp], pairs: int, open_: int) -> None:
        self.poses, self.weights, self.pairs, self.open = poses, weights, pairs, open_


def _real_ones(design: FourSPSSPRDesign, joints: Array, roots: Roots) -> _Real:
    frame = Frame.of(design)
    form = normal_form(roots.values)
    away = np.abs(form.imag).max(axis=0, initial=0.0) / np.maximum(
        np.abs(form).max(axis=0, initial=0.0), 1.0
    )
    limit = np.where(roots.multiplicity > 1, _DOUBLE_REAL, REAL)
    limit[roots.regular :] = _DOUBLE_REAL
    real = np.flatnonzero(away <= limit)
    r, p = to_transforms(frame, roots.values[:, real])
    following: Following = mechanism_of(design).facet("following")
    kept, poses = [], []
    for n, (turn, place) in enumerate(zip(r, p, strict=True)):
        state = State(turn, place)
        sharp = following.solved(unknowns_of(design, state), "", joints, rounds=6)
        if sharp is not None or real[n] >= roots.regular:  # as good as a singular one gets
            kept.append(n)
            poses.append(pose_of(state if sharp is None else state_of(design, sharp)))
    weights = roots.multiplicity[real[kept]] if kept else np.zeros(0, dtype=np.intp)
    table = np.array(poses).reshape(-1, 6)
    order = np.lexsort((table[:, 1], table[:, 0], -table[:, 2]))
    pairs = _nearly_real(design, frame, form, away, limit)
    return _Real(table[order], weights[order], pairs, len(real) - len(kept))


def _self_motions(
    design: FourSPSSPRDesign, joints: Array, singular: Complex
) -> tuple[SelfMotion, ...]:
    """One motion, if there is any, from the singular solutions (8, n).

    A path that ends on a curve of solutions ends anywhere on it, as a rule not at a real point;
    that is sought next to its real part.
    """
    form = normal_form(singular)
    form = form[:, np.abs(form).max(axis=0, initial=0.0) < _CURVES_FAR]
    nearest = np.argsort(np.abs(form.imag).max(axis=0, initial=0.0))[:_MOST]
    poses = poses_of(*to_transforms(Frame.of(design), form[:, nearest]))
    following: Following = mechanism_of(design).facet("following")
    return following.self_motions(poses, [""] * len(poses), joints)


def _nearly_real(
    design: FourSPSSPRDesign, frame: Frame, form: Complex, away: Array, limit: Array
) -> int:
    """Complex pairs that are less than `NEAR` from their conjugates, and not real."""
    # |Δp| is about 4 |Im y| units, a rotation turns by 4 |Im x|.
    apart = np.hypot(
        4.0 * frame.unit * np.sqrt((form[4:].imag ** 2).sum(axis=0)),
        4.0 * design.length * np.sqrt((form[:4].imag ** 2).sum(axis=0)),
    )
    return int(np.count_nonzero((apart < NEAR) & (away > limit))) // 2


def _answer(design: FourSPSSPRDesign, joints: Array, roots: Roots, real: _Real) -> ForwardSolutions:
    poses, weights, gap = _merged(design, joints, real)
    count = len(poses)
    own = own_start_set(design)
    low, high = design.stroke[:, 0] - STROKE_SLACK, design.stroke[:, 1] + STROKE_SLACK
    reach = bool(((joints >= low) & (joints <= high)).all())
    free = _self_motions(design, joints, roots.values[:, roots.regular :])
    far = bool(joints.max() > _FAR * Frame.of(design).unit)
    residual = np.zeros(count)
    if count:
        error = np.abs(leg_lengths(design, poses) - joints).max(axis=-1)
        residual = np.maximum(error, np.abs(violation(design, poses)))
    loose = not_closed(residual, design.size, joints)
    if real.open:
        loose = (*loose, f"{real.open} roots that seem real could not be closed.")
    if far:
        loose = (*loose, "The legs are so much longer than the machine that digits are lost.")
    complete = roots.complete and not free and not loose
    notes = (*_completeness(roots, own), *described(weights, gap, real.pairs), *loose)
    notes = (*notes, *(motion.text for motion in free))
    if not count:
        notes = (*notes, NONE_REAL if complete else NONE_FOUND)
    rows = wrenches(design, placement(design, poses)).rows
    return ForwardSolutions(
        joints=tuple(joints.tolist()),
        poses=poses,
        modes=("",) * count,
        residual=residual,
        condition=condition(rows, design.length),
        determinant=determinant(rows, design.length),
        within_stroke=np.full(count, reach),
        multiplicity=weights,
        gap=gap,
        identities=tuple(range(1, count + 1)),
        complex_count=roots.count,
        expected_count=own.roots.shape[1],
        complete=complete,
        method=f"{roots.expected} paths tracked from the design's own start set",
        seconds=0.0,
        notes=notes,
        self_motions=free,
        roots=normal_form(roots.values),
    )


def _merged(
    design: FourSPSSPRDesign, joints: Array, real: _Real
) -> tuple[Array, NDArray[np.intp], Array]:
    """Of solutions that coincide one stays, with their number; and the gaps between the rest."""
    poses, weights = real.poses, real.weights
    apart = pose_distances(design, poses, poses)
    np.fill_diagonal(apart, np.inf)
    near = _DOUBLE * min(design.length, float(joints.min()))
    close = np.argwhere(np.triu(apart <= near, 1))
    if close.size:
        groups = grouped(len(poses), close)
        firsts = np.unique(groups, return_index=True)[1]
        poses, weights = poses[firsts], np.bincount(groups, weights).astype(np.intp)
        apart = pose_distances(design, poses, poses)
        np.fill_diagonal(apart, np.inf)
    return poses, weights, apart.min(axis=1, initial=np.inf)


def pose_distances(design: FourSPSSPRDesign, one: Array, other: Array) -> Array:
    """Between poses (n, 6) and (m, 6), (n, m) mm; rotations count as chords of the circle with the
    characteristic length as its radius."""
    a, b = (_points(design, poses) for poses in (one, other))
    d = a[:, None, :] - b[None, :, :]
    distances: Array = np.sqrt((d * d).sum(axis=-1))
    return distances


def _points(design: FourSPSSPRDesign, poses: Array) -> Array:
    turns = rotation(poses).reshape(-1, 9) * (design.length / np.sqrt(2.0))
    return np.hstack([poses[:, :3], turns])


def _completeness(found: Roots, own: StartSet) -> tuple[str, ...]:
    notes, generic = [], own.roots.shape[1]
    if own.complete and generic < GENERAL_COUNT:
        notes.append(
            f"Of the {GENERAL_COUNT} solutions of the general 4-SPS + 1-SPR this design has "
            f"{generic}: along two ways to it the others ran off to infinity."
        )
    if found.complete and found.infinite:
        notes.append(f"{found.infinite} of {generic} solutions are at infinity for these lengths.")
    return (*notes, *found.doubts)
