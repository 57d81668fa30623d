"""The aspects of one working mode, cut at one orientation: pieces of the workspace as solids.

The workspace of the mode is parted where the wrenches are dependent (`determinant`). On every
piece the determinant keeps its sign, so that the platform may move all over it, at this
orientation, without losing control. The pieces are slices of the aspects, which live in five
dimensions: two of them may be joined through other orientations. Frame x'y'z'; lengths mm.
"""

from __future__ import annotations

import numpy as np

from kinematics.errors import ComputationError
from kinematics.five_rpur.design import FiveRPURDesign
from kinematics.five_rpur.singular.determinant import Determinant
from kinematics.five_rpur.workspace import coarseness, raw_workspace, thinnest, volume_error
from kinematics.isosurfaces import positive_part
from kinematics.mechanism import Resolution
from kinematics.partition import partition
from kinematics.solids import BuiltSolid, Solid, TracedMesh
from kinematics.spatial import Array

_CELLS: dict[Resolution, int] = {"preview": 14, "normal": 30, "fine": 60}
"""Along each side of the workspace's box, were it a cube."""

_INNER = 1e-9
"""Part of the span of y' that is left out at its ends: there limbs are in serial singularities,
and where two of them are at once the determinant is zero whatever x' and z'."""


def aspects(
    design: FiveRPURDesign,
    phi: float,
    theta: float,
    mode: str,
    resolution: Resolution = "normal",
) -> BuiltSolid:
    """The singularity-free pieces of the workspace in x'y'z' (turn it by R_y(θ) for the base).

    Args:
        design: the machine.
        phi: φ, rad.
        theta: θ, rad.
        mode: the working mode, as "+-+++".
        resolution: "preview", "normal" or "fine".

    Returns:
        All pieces as one `BuiltSolid`; a piece's sign is that of the determinant of
        `velocity.wrench_matrix`. Volumes add up to that of the workspace of the mode.

    Raises:
        InputError: an angle that is not finite, or a mode that is not five signs.
        ComputationError: every pose is singular, or manifold3d gave up.
    """
    determinant = Determinant.at(design, phi, theta, mode)
    whole = raw_workspace(design, phi, theta, (mode,), resolution)
    coarsest = coarseness(design, resolution)

    def error(mesh: TracedMesh, volume: float) -> float:
        return volume_error(mesh, volume, coarsest)

    field = _Field(determinant)
    cells = _Cells.of(determinant, design, whole, _CELLS[resolution], coarsest)
    thin = thinnest(design, resolution)
    if cells is None:
        return partition(whole, None, 1, field, error, thinnest=thin)
    known = cells.values[np.isfinite(cells.values)]
    if cells.vanish(determinant):
        raise ComputationError(
            f"every pose at this orientation in mode {mode} is a parallel singularity: the "
            "wrenches of the limbs are dependent everywhere, so there are no aspects"
        )
    if not ((known > 0.0).any() and (known < 0.0).any()):
        return partition(whole, None, 1 if known.max() > 0.0 else -1, field, error, thinnest=thin)
    # Of the two sides the smaller one is the cheaper tool.
    sign = 1 if (known > 0.0).sum() <= (known < 0.0).sum() else -1
    cutter = positive_part(cells.axes, sign * cells.values, _Field(determinant, sign))
    return partition(whole, cutter, sign, field, error, thinnest=thin, reach=2.0 * coarsest)


class _Field:
    """±F and its gradient; within the span, and constant beyond it."""

    def __init__(self, determinant: Determinant, sign: int = 1) -> None:
        low, high = determinant.span
        inner = _INNER * (high - low)
        self._determinant, self._sign = determinant, sign
        self.span = low + inner, high - inner

    def __call__(self, points: Array) -> tuple[Array, Array]:
        held = points.copy()
        held[:, 1] = np.clip(held[:, 1], *self.span)
        value, gradient = self._determinant.value_and_gradient(held)
        gradient[held[:, 1] != points[:, 1], 1] = 0.0
        return self._sign * value, self._sign * gradient


class _Cells:
    """A grid about the workspace; nodes of cells that have nothing of it are NaN."""

    def __init__(self, axes: tuple[Array, Array, Array], values: Array) -> None:
        self.axes, self.values = axes, values

    @classmethod
    def of(
        cls,
        determinant: Determinant,
        design: FiveRPURDesign,
        whole: Solid,
        count: int,
        margin: float,
    ) -> _Cells | None:
        """None where the workspace is empty."""
        bounds = whole.bounds
        if bounds is None or not determinant.closes:
            return None
        low, high = np.array(bounds)
        side = float(np.prod(np.maximum(high - low, 1e-12))) ** (1.0 / 3.0) / count
        counts = np.clip(np.round((high - low) / side), 4, 4 * count).astype(int)
        step = (high - low) / counts
        x, z = (np.linspace(low[k] - step[k], high[k] + step[k], counts[k] + 3) for k in (0, 2))
        y = _stations(determinant, low[1] - 0.5 * step[1], high[1] + 0.5 * step[1], counts[1] + 2)
        values = determinant.on_grid(x, np.clip(y, *_Field(determinant).span), z)
        _mask(values, determinant, design.stroke, (x, y, z), margin)
        return cls((x, y, z), values)

    def vanish(self, determinant: Determinant) -> bool:
        """Whether F is no more than rounding at all nodes that count."""
        index = np.argwhere(np.isfinite(self.values))
        points = np.stack([a[index[:, k]] for k, a in enumerate(self.axes)], axis=-1)
        points[:, 1] = np.clip(points[:, 1], *_Field(determinant).span)
        some = points[:: max(1, len(points) // 4096)]
        return bool((np.abs(determinant.value(some)) <= determinant.roundoff(some)).all())


def _stations(determinant: Determinant, low: float, high: float, count: int) -> Array:
    """Nodes along y', crowded towards ends of the span, and one beyond each end."""
    ends = _Field(determinant).span
    middle, half = 0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])
    turn = np.arccos(np.clip((middle - np.array([low, high])) / half, -1.0, 1.0))
    y = middle - half * np.cos(np.linspace(turn[0], turn[1], count))
    step = (high - low) / count
    return np.concatenate([[min(low, y[0] - step)], y, [max(high, y[-1] + step)]])


def _mask(
    values: Array,
    determinant: Determinant,
    stroke: Array,
    axes: tuple[Array, Array, Array],
    margin: float,
) -> None:
    """Sets NaN at nodes farther than a cell from where all limbs are within their strokes."""
    x, y, z = axes
    cell = [float(np.diff(a).max()) for a in (x, z)]
    held = np.clip(y, *_Field(determinant).span)
    for (wx, wy, wz), link, sign, (low, high) in zip(
        determinant.offset, determinant.link, determinant.sign, stroke, strict=True
    ):
        h = np.sqrt(np.maximum((link - (held - wy)) * (link + (held - wy)), 0.0))
        jump = np.abs(np.diff(h))
        # h is not monotonic where y' passes w'_y.
        top = (held[:-1] < wy) & (held[1:] > wy)
        jump[top] = np.maximum(link - h[:-1], link - h[1:])[top]
        jump = np.maximum(np.append(jump, 0.0), np.append(0.0, jump))
        slack = np.hypot(cell[0], cell[1] + jump) + margin
        across = (x - wx)[:, None, None] ** 2 + (z - wz - sign * h[:, None]) ** 2
        far = across > ((high + slack) ** 2)[:, None]
        near = across < (np.maximum(low - slack, 0.0) ** 2)[:, None]
        values[far | near] = np.nan
