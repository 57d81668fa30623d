"""Forward displacement of the 4-SPS + 1-SPR: all assembly modes for given leg lengths."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kinematics.answers.solutions import ForwardSolutions, SelfMotion
from kinematics.arrays import Array
from kinematics.facets.forward import ForwardFacet, Found
from kinematics.homotopy.assembly_sets import NEAR, accounted
from kinematics.homotopy.forms import normal_form
from kinematics.homotopy.solving import Roots
from kinematics.homotopy.tracking import Complex
from kinematics.mechanism import mechanism_of
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.following import Following, state_of, unknowns_of
from kinematics.mechanisms.four_sps_spr.forward.equations import Frame, to_transforms
from kinematics.mechanisms.four_sps_spr.forward.roots import GENERAL_COUNT, own_start_set, roots_at
from kinematics.mechanisms.four_sps_spr.inverse import transform
from kinematics.mechanisms.four_sps_spr.states import State, pose_of, poses_of
from kinematics.mechanisms.four_sps_spr.statics import condition, wrenches

REAL = 1e-7
"""Largest imaginary part of a real solution, relative to its size; of a double one its root."""
_DOUBLE_REAL = 1e-4  # as REAL, of solutions where several coincide
_CURVES_FAR = 1e2  # units, of singular solutions that are looked at
_MOST = 16  # of these
_DEPENDENT_FROM = 1e6  # condition at any pose; of usual designs at most poses below 1e3
_DEPENDENT = (
    "The design is architecturally singular, or nearly: its wrenches are dependent in every pose. "
    "Its solutions are not single ones where there are any, and no set of them is complete."
)
_FAR = 500.0  # units: with longer legs the platform is a point to them, and digits are lost


class Forward(ForwardFacet[FourSPSSPRDesign]):
    """All assembly modes for given leg lengths."""

    noun = "leg lengths"
    chunk = 16
    double = 1e-5

    def solve(self, joints: Array, *, mixed_modes: bool) -> list[ForwardSolutions]:
        roots = roots_at(self.design, joints)
        return self.answers([_real(self.design, *each) for each in zip(joints, roots, strict=True)])


def _real(design: FourSPSSPRDesign, joints: Array, roots: Roots) -> Found:
    """The real solutions at one vector of lengths."""
    frame, own = Frame.of(design), own_start_set(design).roots.shape[1]
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
    table = np.array(poses).reshape(-1, 6)
    order = np.lexsort((table[:, 1], table[:, 0], -table[:, 2]))
    free = _self_motions(design, joints, roots.values[:, roots.regular :])
    missing = GENERAL_COUNT - own if own_start_set(design).complete else 0
    doubts: tuple[str, ...] = ()
    if len(kept) < len(real):
        doubts = (f"{len(real) - len(kept)} roots that seem real could not be closed.",)
    if joints.max() > _FAR * frame.unit:
        text = "The legs are so much longer than the machine that digits are lost."
        doubts = (*doubts, text)
    if _is_dependent(design):
        doubts = (*doubts, _DEPENDENT)
    family = "the general 4-SPS + 1-SPR"
    return Found(
        joints=joints,
        poses=table[order],
        modes=("",) * len(table),
        multiplicity=roots.multiplicity[real[kept]][order],
        roots=normal_form(roots.values),
        count=roots.count,
        expected=own,
        complete=roots.complete and not free and not doubts,
        method=f"{roots.expected} paths tracked from the design's own start set",
        notes=(*accounted(roots, family, GENERAL_COUNT, missing), *doubts),
        pairs=_nearly_real(design, frame, form, away, limit),
        self_motions=free,
    )


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


@lru_cache(maxsize=64)
def _is_dependent(design: FourSPSSPRDesign) -> bool:
    """Whether it is singular wherever it stands, or so nearly that roots cannot be told apart.

    Its own start set then lacks what is no single solution: limbs that are alike have no lengths
    in common but equal ones.
    """
    rng = np.random.default_rng(5)
    poses = np.hstack([rng.normal(size=(6, 3)) * design.length, rng.uniform(-1, 1, (6, 3))])
    rows = wrenches(design, transform(poses)).rows
    return bool((condition(rows, design.length) > _DEPENDENT_FROM).all())
