"""Forward kinematics of the 5-RPUR: all assembly modes for given actuator lengths.

A set has what the inverse kinematics holds: all working modes of the design, which are 32 unless
limbs share a merged U joint. A simplified design whose arrangements are all merged is solved in
closed or univariate form (`forward.simplified`), every other one by a parameter homotopy
(`forward.general`). Both give all complex solutions, polished; only then are the real ones told
from the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.solutions import ForwardSolutions
from kinematics.arrays import Array, finite
from kinematics.facets.forward import ForwardFacet
from kinematics.homotopy.assembly_sets import (
    NONE_FOUND,
    NONE_REAL,
    described,
    grouped,
    not_closed,
)
from kinematics.homotopy.solving import Roots
from kinematics.homotopy.tracking import relative_size
from kinematics.mechanisms.five_rpur.arrangements import arrangements
from kinematics.mechanisms.five_rpur.design import (
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
from kinematics.mechanisms.five_rpur.forward.found import Found, by_homotopy, by_stages
from kinematics.mechanisms.five_rpur.inverse import STROKE_SLACK

MODE_SIGNS: dict[str, tuple[float, ...]] = {
    mode: tuple(1.0 if s == "+" else -1.0 for s in mode) for mode in MODES
}
"""σ_i of every working mode."""

_DOUBLE = 1e-5  # of the machine and the shortest length: closer solutions are one, seen twice
_SORTED = 9  # decimals of angles that solutions are sorted by
_NEAR_LENGTHS = 0.1  # of the longest: the largest change over which solutions are tracked on
_REAL_ENOUGH = 1e-12  # relative size of the last correction of a root that is polished
_SINGULAR = 1e-12  # regularity below which a self-motion is looked for


class Solving(ForwardFacet[FiveRPURDesign]):
    """All assembly modes for given actuator lengths."""

    chunk = 128  # so that the temporaries stay in the cache

    def solve(self, joints: Array, *, mixed_modes: bool) -> list[ForwardSolutions]:
        if self.is_quick(mixed_modes=mixed_modes):
            return _answers(self.design, joints, by_stages(self.design, joints), mixed_modes)
        return [self._by_paths(one, mixed_modes) for one in joints]

    def is_quick(self, *, mixed_modes: bool = False) -> bool:
        """A few milliseconds a vector: all arrangements of a simplified design are merged."""
        tied = set(self._ties(mixed_modes))
        merged = all(group.limbs in tied for group in arrangements(self.design).groups)
        return merged and bool(tied) and simplified.expected(self.design) is not None

    def tracked_on(self, before: ForwardSolutions, joints: Sequence[float]) -> ForwardSolutions:
        """All assembly modes at lengths (5,), mm, tracked from those known if these are near."""
        rho = finite(joints, name="the joints", last=LIMBS).reshape(LIMBS)
        known, mixed = before.roots.shape[1], before.mixed_modes
        near = np.abs(rho - before.joints).max() <= _NEAR_LENGTHS * float(np.abs(rho).max())
        sound = before.complete and known == before.complex_count
        if near and sound and not self.is_quick(mixed_modes=mixed):
            began = perf_counter()
            roots = general.roots_from(self.design, before.roots, before.joints, rho)
            if roots.complete:
                found = self._by_paths(rho, mixed, roots)
                return self.finished(found, perf_counter() - began)
        (now,) = self([rho], mixed_modes=mixed)
        return now

    def _by_paths(
        self, rho: Array, mixed_modes: bool, roots: Roots | None = None
    ) -> ForwardSolutions:
        began = perf_counter()
        found = by_homotopy(self.design, rho, self._ties(mixed_modes), roots)
        (answer,) = _answers(self.design, rho[None], [found], mixed_modes)
        return replace(answer, seconds=perf_counter() - began)

    def _ties(self, mixed_modes: bool) -> Ties:
        return () if mixed_modes else self.design.merged_joints


def _answers(
    design: FiveRPURDesign,
    rho: Array,
    found: Sequence[Found],
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
                poses=part.poses,
                modes=modes,
                residual=part.residual,
                condition=part.condition,
                determinant=part.determinant,
                within_stroke=np.full(count, reach[k]),
                multiplicity=part.weight,
                gap=gap,
                identities=tuple(range(1, count + 1)),
                complex_count=one.count,
                expected_count=one.expected,
                complete=complete,
                method=one.method,
                seconds=0.0,
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


def pose_distances(design: FiveRPURDesign, one: Array, other: Array) -> Array:
    """Between poses (n, 5) and (m, 5), (n, m) mm, see `pose_points`."""
    a, b = (pose_points(poses, design.length) for poses in (one, other))
    d = a[:, None, :] - b[None, :, :]
    return np.asarray(np.sqrt((d * d).sum(axis=-1)))


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
