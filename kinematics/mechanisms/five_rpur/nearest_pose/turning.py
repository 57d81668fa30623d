"""A posture at another orientation, where none at the wanted one can be held: by search.

Poses are compared by hypot(distance of O', characteristic length times the change of angles). A
lattice of poses is tried, orientations near the wanted one first, then clouds about the best of it
that become ever smaller. What is found can be held; that nothing is nearer is not proven.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.facets.clearances import Nearest
from kinematics.mechanisms.five_rpur.design import FiveRPURDesign
from kinematics.mechanisms.five_rpur.inverse import inside, limb_lengths
from kinematics.mechanisms.five_rpur.nearest_pose.projection import nearest
from kinematics.mechanisms.five_rpur.offsets import offset_points
from kinematics.screws.spatial import rotation_y, wrap_angle

_STEPS = 12  # from an angle to half a turn away
_PLACES = 8  # along each axis of what all limbs may reach at an orientation
_STARTS = 5
_CLOUD = 200
_ROUNDS = 50
_SHRINK = 0.75
_BATCH = 40  # orientations at a time
_SHORT = 1e9  # mm; what cannot be held is worse than anything that can, the less the nearer it is


def turned(design: FiveRPURDesign, wanted: Posture) -> Nearest | None:
    """The nearest posture found in the wanted mode, else in any; None where none is found."""
    search = _Search(design, np.array(wanted.pose), (wanted.mode, None))
    for which, starts in enumerate(search.lattice()):
        found = search.from_starts(starts, which)
        if found is not None:
            return found
    return None


@dataclass(frozen=True, eq=False)
class _Search:
    """A search for poses near a target, in each of some modes (None: in any)."""

    design: FiveRPURDesign
    target: Array
    modes: tuple[str | None, ...]

    @property
    def metric(self) -> Array:
        unit = self.design.length
        return np.array([1.0, 1.0, 1.0, unit, unit])

    def scores(self, poses: Array) -> Array:
        """(modes, ...) the distance of poses that can be held, what others lack beyond `_SHORT`."""
        away = np.linalg.norm((poses - self.target) * self.metric, axis=-1)
        both = _shortfalls(self.design, poses)
        return np.stack(
            [
                np.where(short > 0.0, _SHORT + short, away)
                for short in (_of(both, m) for m in self.modes)
            ]
        )

    def lattice(self) -> list[Array]:
        """The best poses (n, 5) of a lattice, for each of the modes."""
        steps = np.pi / _STEPS * np.arange(-_STEPS, _STEPS)
        turns = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
        turns = turns[np.argsort(np.linalg.norm(turns, axis=1), kind="stable")]
        parts = (np.arange(_PLACES) + 0.5) / _PLACES
        share = np.stack(np.meshgrid(parts, parts, parts, indexing="ij"), axis=-1).reshape(-1, 3)
        best = [np.empty((0, 5)) for _ in self.modes]
        values = [np.empty(0) for _ in self.modes]
        for k in range(0, len(turns), _BATCH):
            batch = turns[k : k + _BATCH]
            worst = max(v.max(initial=-np.inf) for v in values)
            if k and np.linalg.norm(batch[0]) * self.metric[3] > worst:
                break  # all that follow are farther
            poses = self._reachable(self.target[3:] + batch, share)
            scores = self.scores(poses)
            rows = np.arange(len(poses))
            for n in range(len(self.modes)):
                at = scores[n].argmin(axis=1)  # one an orientation: the starts are to differ
                best[n] = np.concatenate([best[n], poses[rows, at]])
                values[n] = np.concatenate([values[n], scores[n][rows, at]])
                order = np.argsort(values[n], kind="stable")[:_STARTS]
                best[n], values[n] = best[n][order], values[n][order]
        return best

    def _reachable(self, angles: Array, share: Array) -> Array:
        """Poses (n, N, 5) in the boxes that all limbs may reach, and at the target's position.

        Of orientations (n, 2) at which those are not empty.
        """
        design = self.design
        offset = offset_points(design, angles[:, 0], angles[:, 1])
        length, link = design.stroke[:, 1], design.link
        reach = np.stack([length, link, length + link], axis=-1)
        low, high = (offset - reach).max(axis=1), (offset + reach).min(axis=1)
        some = (low <= high).all(axis=1)
        low, high, angles = low[some], high[some], angles[some]
        places = low[:, None] + share * (high - low)[:, None]
        poses = np.empty((len(angles), len(share) + 1, 5))
        poses[:, :-1, :3] = np.einsum("nij,nkj->nki", rotation_y(angles[:, 1]), places)
        poses[:, -1, :3] = self.target[:3]
        poses[..., 3:] = angles[:, None]
        return poses

    def from_starts(self, starts: Array, which: int) -> Nearest | None:
        """The best of clouds about starts that shrink, then the nearest of all at its angles."""
        design, target, mode = self.design, self.target, self.modes[which]
        if not len(starts):
            return None
        steps = np.random.default_rng(0).normal(size=(_CLOUD, 5))
        part = np.linspace(0.0, 1.0, 16)[1:, None]
        size = float((design.link + design.stroke[:, 1]).max())
        spread = np.array([*[size / _PLACES] * 3, *[np.pi / _STEPS] * 2])
        values = self.scores(starts)[which]
        for _ in range(_ROUNDS):
            here = starts[:, None]
            tried = np.concatenate([here + steps * spread, here + part * (target - here)], axis=1)
            scores = self.scores(tried)[which]
            at = scores.argmin(axis=1)
            rows = np.arange(len(starts))
            better = scores[rows, at] < values
            starts = np.where(better[:, None], tried[rows, at], starts)
            values = np.where(better, scores[rows, at], values)
            spread = _SHRINK * spread
            steps = steps[:, [1, 2, 3, 4, 0]]  # other directions
        best = int(values.argmin())
        if values[best] >= _SHORT:
            return None
        phi, theta = wrap_angle(starts[best, 3:]).tolist()
        x, y, z = target[:3].tolist()
        found = None
        for each in design.modes if mode is None else (mode,):
            if inside(design, starts[best], [each]):
                within = np.inf if found is None else found.distance
                found = nearest(design, (x, y, z, phi, theta), each, within) or found
        return None if found is None else found._replace(error=float("inf"))


def _shortfalls(design: FiveRPURDesign, poses: Array) -> Array:
    """How far each limb is beyond its bounds in each mode, (..., 5, 2) mm; ≤ 0 within them."""
    lengths = limb_lengths(design, poses)
    c, s = np.cos(poses[..., 3:4]), np.sin(poses[..., 3:4])
    turned = c * design.platform[:, 1] - s * design.platform[:, 2]
    across = np.abs(poses[..., 1:2] + turned - design.base[:, 1]) - design.link
    stroke = np.maximum(design.stroke[:, :1] - lengths, lengths - design.stroke[:, 1:])
    # A limb that cannot close is worse than one that is only beyond its stroke.
    far = design.link[:, None] + design.stroke[:, 1:] + across[..., None]
    short: Array = np.where(np.isfinite(stroke), stroke, far)
    for limbs in design.merged_joints:  # in one mode: as short as the worst of them
        together = [i - 1 for i in limbs]
        short[..., together, :] = short[..., together, :].max(axis=-2, keepdims=True)
    return short


def _of(shortfalls: Array, mode: str | None) -> Array:
    """The worst limb's, in a mode or in whichever is best, (...)."""
    if mode is None:
        return np.asarray(shortfalls.min(axis=-1).max(axis=-1))
    column = [0 if sign == "+" else 1 for sign in mode]
    return np.asarray(shortfalls[..., range(len(column)), column].max(axis=-1))
