"""Forward kinematics of the 5-RPUR: all assembly modes for given actuator lengths.

A set has what the inverse kinematics holds: all working modes of the design, which are 32 unless
limbs share a merged U joint. A simplified design whose arrangements are all merged is solved in
closed or univariate form (`forward.simplified`), every other one by a parameter homotopy
(`forward.general`). Both give all complex solutions, polished; only then are the real ones told
from the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.solutions import ForwardSolutions
from kinematics.arrays import Array, finite, frozen
from kinematics.homotopy.assembly_sets import (
    NONE_FOUND,
    NONE_REAL,
    described,
    grouped,
    not_closed,
    positive_lengths,
)
from kinematics.homotopy.solving import Roots
from kinematics.homotopy.tracking import relative_size
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import (
    JOINT_SYMBOLS,
    LIMBS,
    MODES,
    FiveRPURDesign,
    Ties,
)
from kinematics.mechanisms.five_rpur.forward import general, simplified
from kinematics.mechanisms.five_rpur.forward.coincidence import REAL, nearly_real, self_motions
from kinematics.mechanisms.five_rpur.forward.equations import (
    Complex,
    Frame,
    Parameters,
    Terms,
    conjugate,
    from_real,
    matrix,
    parameters,
    polish,
    real_part,
    regularity,
    terms,
    to_poses,
)
from kinematics.mechanisms.five_rpur.forward.families import Family, membership
from kinematics.mechanisms.five_rpur.inverse import STROKE_SLACK

MODE_SIGNS: dict[str, tuple[float, ...]] = {
    mode: tuple(1.0 if s == "+" else -1.0 for s in mode) for mode in MODES
}
"""σ_i of every working mode."""

_DOUBLE = 1e-5  # of the machine and the shortest length: closer solutions are one, seen twice
_CHUNK = 128  # length vectors at a time, so that the temporaries stay in the cache
_SORTED = 9  # decimals of angles that solutions are sorted by
_NEAR_LENGTHS = 0.1  # of the longest: the largest change over which solutions are tracked on
_REAL_ENOUGH = 1e-12  # relative size of the last correction of a root that is polished
_SINGULAR = 1e-12  # regularity below which a self-motion is looked for


@dataclass(frozen=True, slots=True)
class _Found:
    """What is known of the complex solutions at one length vector."""

    roots: Complex
    multiplicity: NDArray[np.intp]
    count: int
    expected: int | None
    complete: bool
    method: str
    notes: tuple[str, ...]


def forward(
    design: FiveRPURDesign, joints: ArrayLike, *, mixed_modes: bool = False
) -> tuple[ForwardSolutions, ...]:
    """All assembly modes for each of some vectors of actuator lengths.

    Args:
        joints: (5,) or (..., 5) mm, > 0.
        mixed_modes: as if no U joint was merged: also solutions in modes that the design has not.

    Returns:
        One set for each vector, in their order. No solution, or lengths beyond a stroke, are
        answers like others.

    Raises:
        InputError: not five finite positive lengths each.
    """
    rho = positive_lengths(joints, JOINT_SYMBOLS)
    quick = forward_is_quick(design, mixed_modes=mixed_modes)
    tied = _ties(design, mixed_modes)
    size = _CHUNK if quick else 1
    answers: list[ForwardSolutions] = []
    for part in (rho[k : k + size] for k in range(0, len(rho), size)):
        began = perf_counter()
        found = _by_stages(design, part) if quick else [_by_homotopy(design, part[0], tied)]
        answers += _answers(design, part, found, began, mixed_modes)
    return tuple(answers)


def forward_from(
    design: FiveRPURDesign, before: ForwardSolutions, joints: ArrayLike
) -> ForwardSolutions:
    """All assembly modes at lengths (5,), mm, tracked from those known if these are near."""
    rho = finite(joints, name="the joints", last=LIMBS).reshape(LIMBS)
    quick = forward_is_quick(design, mixed_modes=before.mixed_modes)
    known = before.roots.shape[1]
    near = np.abs(rho - before.joints).max() <= _NEAR_LENGTHS * float(np.abs(rho).max())
    if quick or not near or not before.complete or known != before.complex_count:
        return forward(design, rho, mixed_modes=before.mixed_modes)[0]
    began = perf_counter()
    roots = general.roots_from(design, before.roots, before.joints, rho)
    if not roots.complete:
        return forward(design, rho, mixed_modes=before.mixed_modes)[0]
    found = _by_homotopy(design, rho, _ties(design, before.mixed_modes), roots)
    return _answers(design, rho[None], [found], began, before.mixed_modes)[0]


def forward_is_quick(design: FiveRPURDesign, *, mixed_modes: bool = False) -> bool:
    """A few milliseconds a vector: all arrangements of a simplified design are merged."""
    tied = set(_ties(design, mixed_modes))
    merged = all(group.limbs in tied for group in arrangements(design).groups)
    return merged and bool(tied) and simplified.expected(design) is not None


def _ties(design: FiveRPURDesign, mixed_modes: bool) -> Ties:
    return () if mixed_modes else design.merged_joints


# --- by the one method and by the other ------------------------------------------------------


def _by_stages(design: FiveRPURDesign, rho: Array) -> list[_Found]:
    roots, owner = simplified.same_mode_roots(design, rho)
    expected = simplified.expected(design)
    name = arrangements(design).name
    bounds = np.searchsorted(owner, np.arange(len(rho) + 1))
    answer = []
    for k, one in enumerate(rho):
        own = roots[:, bounds[k] : bounds[k + 1]]
        count = own.shape[1]
        if count != expected:
            found = _by_homotopy(design, one, design.merged_joints)
            short = f"{count} of {expected} solutions were found."
            own_way = _Found(own, _once(count), count, expected, False, found.method, (short,))
            # Where the homotopy lost more than the stages did, theirs are what is known.
            answer.append(own_way if found.count < count <= (expected or 0) else found)
            continue
        answer.append(
            _Found(
                own,
                _once(count),
                count,
                expected,
                True,
                f"{name} solved in three stages (θ, free limbs, planar sextic)",
                (),
            )
        )
    return answer


def _once(count: int) -> NDArray[np.intp]:
    return np.ones(count, dtype=np.intp)


def _by_homotopy(
    design: FiveRPURDesign, rho: Array, tied: Ties, roots: Roots | None = None
) -> _Found:
    kept = general.has_own_start_set(design)
    family = membership(design).family
    found = general.roots_at(design, rho, tied) if roots is None else roots
    if roots is not None:
        method = f"{found.expected} paths tracked from the last lengths"
    elif kept or tied:
        method = f"{found.expected} paths tracked from the design's own start set"
    else:
        method = f"{family.count} paths tracked from the start set of {family.title}"
    if tied:
        method = f"{method}, merged limbs in one working mode"
    reasons = arrangements(design).reasons
    own = general.own_start_set(design)
    missing = 0 if tied or not own.complete else family.count - own.roots.shape[1]
    notes = _completeness(found, family, missing)
    if reasons:
        notes = (
            f"{reasons[0]} Solutions in the modes where that holds are not isolated: they lie on "
            "curves and are not among these.",
        )
    return _Found(
        found.values,
        found.multiplicity,
        found.count,
        found.expected if tied else family.count,
        found.complete and not reasons,
        method,
        notes,
    )


def _completeness(found: Roots, family: Family, missing: int) -> tuple[str, ...]:
    notes = []
    if missing > 0:
        notes.append(
            f"Of the {family.count} solutions of {family.title}, this design has "
            f"{family.count - missing}: along two ways to it the others ran off to infinity."
        )
    if found.complete and found.infinite:
        notes.append(
            f"{found.infinite} of {found.expected} solutions are at infinity for these lengths."
        )
    return (*notes, *found.doubts)


# --- from roots to answers -------------------------------------------------------------------


def _answers(
    design: FiveRPURDesign,
    rho: Array,
    found: Sequence[_Found],
    began: float,
    mixed_modes: bool,
) -> list[ForwardSolutions]:
    """The real solutions among the roots with all that is said of them; one pass for all."""
    frame, length = Frame.of(design), design.length
    numbers = np.repeat(np.arange(len(rho)), [f.roots.shape[1] for f in found])
    roots = np.concatenate([f.roots for f in found], axis=1)
    real = np.flatnonzero(relative_size(roots - conjugate(roots), roots) <= REAL)
    owner = numbers[real]
    g = parameters(design, rho[owner], frame)
    values, w = _made_real(g, roots[:, real])
    u = from_real(values, w)
    poses = to_poses(frame, values)
    t = terms(g, u)
    # Those of one angle, which rounding must not sort, stand by what comes next.
    phi, theta = np.round(poses[:, 3:], _SORTED).T
    order = np.lexsort((poses[:, 0], phi, theta, owner))
    table = _Table(
        poses=poses,
        u=u,
        mode=_mode_numbers(t),
        residual=_residual(frame, g, t),
        weight=np.concatenate([f.multiplicity for f in found])[real],
        **_conditioning(design, t, poses, length),
    ).take(order)
    bounds = np.searchsorted(owner[order], np.arange(len(rho) + 1))
    everywhere = parameters(design, rho[numbers], frame)
    singular = regularity(everywhere, roots) <= _SINGULAR
    pairs = np.bincount(numbers[nearly_real(frame, roots, length)], minlength=len(rho)) // 2
    reach = np.all(
        (rho >= design.stroke[:, 0] - STROKE_SLACK) & (rho <= design.stroke[:, 1] + STROKE_SLACK),
        axis=1,
    )
    seconds = (perf_counter() - began) / max(len(rho), 1)
    machine = replace(design, merged_joints=()) if mixed_modes else design
    answers = []
    for k, one in enumerate(found):
        shortest = min(length, float(rho[k].min()))  # with short limbs solutions are that near
        part = table.take(np.arange(bounds[k], bounds[k + 1]))
        part, gap = _merged(part, length, _DOUBLE * shortest)
        count = len(part.mode)
        modes = tuple(MODES[n] for n in part.mode)
        curved = roots[:, singular & (numbers == k)]
        free = self_motions(machine, rho[k], frame, curved)
        loose = not_closed(part.residual, design.size, rho[k])
        complete = one.complete and not loose
        about = described(part.weight, gap, int(pairs[k]))
        notes = (*one.notes, *loose, *about, *(m.text for m in free))
        answers.append(
            ForwardSolutions(
                joints=tuple(rho[k].tolist()),
                poses=frozen(part.poses),
                modes=modes,
                residual=frozen(part.residual),
                condition=frozen(part.condition),
                determinant=frozen(part.determinant),
                within_stroke=frozen(np.full(count, reach[k])),
                multiplicity=frozen(part.weight),
                gap=frozen(gap),
                identities=tuple(range(1, count + 1)),
                complex_count=one.count,
                expected_count=one.expected,
                complete=complete,
                method=one.method,
                seconds=seconds,
                notes=notes if count else (*notes, _none_text(design, complete)),
                self_motions=free,
                roots=one.roots,
                mixed_modes=mixed_modes,
            )
        )
    return answers


def _none_text(design: FiveRPURDesign, complete: bool) -> str:
    if arrangements(design).reasons:
        return "No isolated solution is real."
    return NONE_REAL if complete else NONE_FOUND


class _Table(NamedTuple):
    """Real solutions: a row each, but a column of u."""

    poses: Array
    u: Complex
    mode: NDArray[np.intp]
    residual: Array
    weight: NDArray[np.intp]
    condition: Array
    determinant: Array

    def take(self, rows: NDArray[np.intp]) -> _Table:
        return _Table(
            self.poses[rows],
            self.u[:, rows],
            self.mode[rows],
            self.residual[rows],
            self.weight[rows],
            self.condition[rows],
            self.determinant[rows],
        )


def _made_real(g: Parameters, u: Complex) -> tuple[Array, Array]:
    """The real configurations next to u, polished.

    Arrangements are exact where u was found, and but for rounding in the machine ``g``.
    """
    values, w = real_part(u)
    fine, error = polish(g, from_real(values, w), rounds=2)
    better = error <= _REAL_ENOUGH
    values[:, better], w[:, better] = real_part(fine[:, better])
    return values, w


def _residual(frame: Frame, g: Parameters, t: Terms) -> Array:
    """The largest violation of |A_i B_i| = ρ_i and |B_i C_i| = l_i, mm, (n,)."""
    first = np.hypot(t.big_p.real, t.p.real) - np.sqrt(g.rho2.real)
    second = np.hypot(t.big_y.real, t.q.real) - np.sqrt(g.link2.real)
    worst: Array = frame.unit * np.maximum(np.abs(first), np.abs(second)).max(axis=0, initial=0.0)
    return worst


def _mode_numbers(t: Terms) -> NDArray[np.intp]:
    """Where the working modes, sign q_i, stand in `MODES`."""
    numbers: NDArray[np.intp] = (2 ** np.arange(LIMBS)[::-1]) @ (t.q.real < 0.0)
    return numbers


def _conditioning(
    design: FiveRPURDesign, t: Terms, poses: Array, length: float
) -> dict[str, Array]:
    """Condition number of J5 and determinant of the unit wrenches, as in `screws.wrenches`.

    The rows of `equations.matrix` are −ρ_i l_i f_i and its moments in the turned frame, about
    the platform's centroid: what is left is to take them about O'.
    """
    unit = Frame.of(design).unit
    along_x, about_y, along_y, along_z, about_x = matrix(t).real.transpose(1, 2, 0)
    s = (design.platform.mean(axis=0) / unit)[:, None, None]
    cf, sf = np.cos(poses[:, 3])[:, None], np.sin(poses[:, 3])[:, None]
    my, mz = cf * s[1] - sf * s[2], sf * s[1] + cf * s[2]
    c, sn = np.cos(poses[:, 4]), np.sin(poses[:, 4])
    r = design.base.mean(axis=0)
    dx, dz = (poses[:, 0] - r[0]) / unit, (poses[:, 2] - r[2]) / unit
    x, z = (dx * c - dz * sn)[:, None], (dx * sn + dz * c)[:, None]
    scale = unit / length
    rows = np.stack(
        [
            along_x,
            along_y,
            along_z,
            scale * (about_x - mz * along_y + my * along_z),
            scale * (about_y - z * along_x + x * along_z),
        ],
        axis=-1,
    )
    force = np.sqrt((rows[..., :3] ** 2).sum(axis=-1))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        wrenches = np.where(force[..., None] > 0.0, rows / force[..., None], 0.0)
        lengths = np.sqrt(t.big_p.real**2 + t.p.real**2)
        jacobian: Array = rows / (t.q.real * lengths).T[..., None]
        regular = np.isfinite(jacobian.reshape(-1, LIMBS * LIMBS)).all(axis=1)
        jacobian[~regular] = np.eye(LIMBS)
        sizes = np.linalg.svd(jacobian, compute_uv=False)
        number = np.where(regular, sizes[:, 0] / sizes[:, -1], np.inf)
    return {"condition": number, "determinant": np.linalg.det(wrenches)}


def _merged(part: _Table, length: float, near: float) -> tuple[_Table, Array]:
    """Of solutions that coincide one stays, with their number; and the gaps between the rest."""
    count = len(part.mode)
    nearest, gap = _neighbours(part.poses, length)
    close = np.flatnonzero(gap <= near)
    if not close.size:
        return part, gap
    groups = grouped(count, np.column_stack([close, nearest[close]]))
    firsts = np.unique(groups, return_index=True)[1]
    part = part.take(firsts)._replace(weight=np.bincount(groups, part.weight).astype(np.intp))
    return part, _neighbours(part.poses, length)[1]


def pose_points(poses: Array, length: float) -> Array:
    """Poses (n, 5) as points (n, 7), whose distances are those of the poses, mm.

    Angles count as the chord of a circle with the characteristic length as its radius.
    """
    angles = poses[:, 3:]
    return np.hstack([poses[:, :3], length * np.cos(angles), length * np.sin(angles)])


def _neighbours(poses: Array, length: float) -> tuple[NDArray[np.intp], Array]:
    """The nearest other of each pose, and how far it is, mm."""
    count = len(poses)
    if count < 2:
        return np.zeros(count, dtype=np.intp), np.full(count, np.inf)
    points = pose_points(poses, length)
    points -= points.mean(axis=0)
    square = (points * points).sum(axis=1)
    apart = square[:, None] + square - 2.0 * (points @ points.T)  # good enough to choose by
    np.fill_diagonal(apart, np.inf)
    nearest = apart.argmin(axis=1)
    return nearest, np.sqrt(((points - points[nearest]) ** 2).sum(axis=1))
