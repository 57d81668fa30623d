"""The way from one posture to another as pictures of it: for the eye only, no posture of it holds.

Whatever is fixed to the platform moves with it as a rigid body, everything else on straight lines,
so that what is joined at both ends stays joined on the way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from app.review.view import View
from app.scene.nodes import triple
from kinematics.answers.drawings import Drawing
from kinematics.arrays import Array

DURATION = 0.4  # s
RIGID = 1e-6  # mm


@dataclass(frozen=True, eq=False, slots=True)
class Morph:
    """From what was shown to what is, begun at a time (s)."""

    before: View
    after: View
    begun: float

    def over(self, now: float) -> bool:
        return now - self.begun >= DURATION

    def at(self, now: float) -> View:
        """What to draw now: the view that it ends at, with an earlier picture."""
        share = min(max((now - self.begun) / DURATION, 0.0), 1.0)
        drawing, platform = between(self.before, self.after, share * share * (3.0 - 2.0 * share))
        return replace(self.after, drawing=drawing, platform=platform)


def between(before: View, after: View, share: float) -> tuple[Drawing, Array]:
    """The drawing and the platform's 4x4 at a share of the way; 0 and 1 are the ends."""
    platform = np.eye(4)
    ends = np.stack([before.platform, after.platform])
    platform[:3, :3] = Slerp([0.0, 1.0], Rotation.from_matrix(ends[:, :3, :3]))(share).as_matrix()
    platform[:3, 3] = (1.0 - share) * ends[0, :3, 3] + share * ends[1, :3, 3]
    earlier = {bar.name: bar for bar in before.drawing.bars}
    bars = [bar for bar in after.drawing.bars if bar.name in earlier]
    pairs = np.array(
        [[[earlier[bar.name].start, bar.start], [earlier[bar.name].end, bar.end]] for bar in bars]
    ).reshape(-1, 2, 2, 3)
    points = _between(pairs, ends, platform, share)
    moved = tuple(
        replace(bar, start=triple(start), end=triple(end))
        for bar, (start, end) in zip(bars, points, strict=True)
    )
    return replace(after.drawing, bars=moved), platform


def _between(pairs: Array, ends: Array, platform: Array, share: float) -> Array:
    """Points (..., 3) between pairs (..., 2, 3) of them."""
    rotation, origin = ends[:, :3, :3], ends[:, :3, 3]
    local = np.einsum("...kj,kji->...ki", pairs - origin, rotation)  # in the platform's frame
    rigid = np.abs(local[..., 1, :] - local[..., 0, :]).max(axis=-1) < RIGID
    carried = local[..., 1, :] @ platform[:3, :3].T + platform[:3, 3]
    straight = (1.0 - share) * pairs[..., 0, :] + share * pairs[..., 1, :]
    placed: Array = np.where(rigid[..., None], carried, straight)
    return placed
