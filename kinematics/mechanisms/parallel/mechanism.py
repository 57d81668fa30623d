"""Any parallel mechanism of one platform behind the interface that every mechanism shares."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from itertools import product
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.bounds import Bound
from kinematics.answers.drawings import Drawing
from kinematics.answers.modes import Mode, noun
from kinematics.answers.motion import Wrenches
from kinematics.answers.solutions import Finding, Posture
from kinematics.arrays import Array, finite, largest
from kinematics.facets.inverse import posture
from kinematics.mechanism import Coordinate, Facets, Mechanism
from kinematics.mechanisms.parallel import drawing, files, findings, statics
from kinematics.mechanisms.parallel.assembly import Assembly, assembled
from kinematics.mechanisms.parallel.chart import placed
from kinematics.mechanisms.parallel.design import ParallelDesign
from kinematics.mechanisms.parallel.mobility import SYMBOLS
from kinematics.mechanisms.parallel.ranges import FOLLOWING, Ranges
from kinematics.screws.spatial import rigid

Modes = str | Sequence[str]


class Parallel(Mechanism[ParallelDesign]):
    """Limbs between a base and a platform, each with one actuator, described in a file."""

    kind = "parallel"
    title = "Parallel mechanism"
    schema = files.SCHEMA
    snap = 1e-9
    facets: ClassVar = Facets(
        __package__,
        following="following:Following",
        forward="forward.assembly:Forward",
        solids="solids:Solids",
    )

    def __init__(self, design: ParallelDesign) -> None:
        super().__init__(design)
        self.machine: Assembly = assembled(design)
        self.ranges = Ranges(self.machine)
        self.modes = _modes(self.machine)
        self.mode_noun = noun(self.modes)
        self.wrench_names = statics.names(self.machine)

    def facet(self, topic: str) -> Any:
        """No solids where nothing could be drawn."""
        return None if topic == "solids" and not self.machine.drawn else super().facet(topic)

    @property
    def bounds(self) -> tuple[Bound, ...]:
        return self.ranges.bounds

    def findings(self) -> tuple[Finding, ...]:
        return findings.findings(self)

    # --- coordinates

    def pose_coordinates(self) -> tuple[Coordinate, ...]:
        return self.ranges.poses()

    def joint_coordinates(self) -> tuple[Coordinate, ...]:
        return self.ranges.joints()

    def transform(self, poses: ArrayLike, mode: Modes) -> Array:
        p = finite(poses, name="a pose", last=len(self.machine.chart.free))
        return self.machine.chart.transform(p, _read(mode)[0])

    def placement(self, poses: ArrayLike, mode: Modes) -> Array:
        p = finite(poses, name="a pose", last=len(self.machine.chart.free))
        return self.machine.chart.placement(p, _read(mode)[0])

    def pose_from_transform(self, transform: ArrayLike, mode: str) -> tuple[float, ...]:
        r, place = rigid(transform)
        matrix = np.eye(4)
        left, _, right = np.linalg.svd(r)
        matrix[:3, :3], matrix[:3, 3] = left @ right, place
        return tuple(self.machine.chart.pose(matrix).tolist())

    def velocity_axes(self, poses: Array, mode: Modes) -> Array:
        return self.machine.chart.velocity_axes(poses, _read(mode)[0])

    @property
    def length(self) -> float:
        return self.machine.length

    # --- joints

    def joints(self, poses: Array, mode: Modes) -> Array:
        operation, signs = _read(mode)
        return self.machine.drives.joints(self.machine.chart.placement(poses, operation), signs)

    def joints_in(self, poses: Array, modes: Sequence[str]) -> Array:
        operations, signs = _read(tuple(modes))
        found = np.empty((*poses.shape[:-1], len(modes), len(self.machine.limbs)))
        count = signs.shape[-1]
        for operation in np.unique(operations).tolist():
            at = self.machine.chart.placement(poses, operation)
            both = [self.machine.drives.joints(at, np.full(count, s)) for s in (1.0, -1.0)]
            mine = np.flatnonzero(operations == operation)
            plus = signs[mine] > 0.0
            found[..., mine, :] = np.where(plus, both[0][..., None, :], both[1][..., None, :])
        return found

    def margins(self, poses: Array, mode: Modes, joints: Array) -> Array:
        operation, signs = _read(mode)
        full, room = self.machine.chart.full(poses, operation)
        at = np.asarray(placed(full))
        return self.ranges.margins(at, signs, joints, room)

    def residual(self, poses: Array, mode: Modes, joints: Array) -> Array:
        operation, signs = _read(mode)
        at = self.machine.chart.placement(poses, operation)
        off = self.machine.drives.residual(at, joints, signs)
        if self.machine.bonds.count:
            held = np.abs(np.asarray(self.machine.bonds.at(at).values))
            off = np.concatenate([off, held], axis=-1)
        return largest(off)

    def why_not(self, bound: Bound, pose: Array, mode: str, amount: float) -> str:
        if bound.end != "link":
            return ""
        if bound.joint == FOLLOWING:
            return (
                "no platform has these coordinates: the limbs' constraints cannot be met "
                f"({', '.join(self._following)} would have to follow)"
            )
        kind = self.machine.limbs[(bound.limb or 1) - 1].kind.name
        return f"limb {bound.limb} ({kind}) cannot close: it is short of {amount:.4g} mm"

    @cached_property
    def _following(self) -> tuple[str, ...]:
        return tuple(SYMBOLS[n] for n in self.machine.chart.following)

    def branch(self, placement: Array, joints: Array) -> Array:
        """(..., L) ±1 of configurations."""
        return self.machine.drives.branches(placement, joints)

    def modes_of(
        self, poses: Array, placements: Array, joints: Array
    ) -> tuple[tuple[Mode, ...], NDArray[np.bool_]]:
        """The modes that configurations (N, …) are in, and whether their poses tell them."""
        signs = self.branch(placements, joints)
        chart = self.machine.chart
        off = np.stack([self._off(poses, placements, k + 1) for k in range(chart.operations)])
        which = off.argmin(axis=0) + 1
        modes = tuple(
            Mode(k if chart.operations > 1 else "", _signs(row) if self.modes[0].signs else "")
            for k, row in zip(which.tolist(), signs, strict=True)
        )
        return modes, np.asarray(off.min(axis=0) < 1e-6)

    def _off(self, poses: Array, placements: Array, operation: int) -> Array:
        """(N,) how far poses in an operation mode are from placements."""
        apart = np.abs(self.machine.chart.transform(poses, operation) - placements)[..., :3, :]
        return np.asarray((apart / [1.0, 1.0, 1.0, self.length]).max(axis=(-1, -2)))

    # --- motion and forces

    def wrenches(self, placement: Array, mode: Modes) -> Wrenches:
        return statics.wrenches(self.machine, placement, _read(mode)[1])

    @cached_property
    def largest_gain(self) -> Array:
        return np.array(
            [limb.crank if limb.drive in ("crank", "elbow") else 1.0 for limb in self.machine.limbs]
        )

    # --- as people see it

    def home(self) -> Posture:
        return _home(self.design)

    def drawing(self, posture: Posture) -> Drawing:
        return drawing.drawing(self, posture)


@lru_cache(maxsize=64)
def _home(design: ParallelDesign) -> Posture:
    """The reference posture."""
    machine = assembled(design)
    pose = machine.chart.pose(machine.reference)
    exact = np.round(pose, 12)
    same = np.abs(machine.chart.transform(exact) - machine.reference).max() < 1e-10 * machine.length
    signs = _signs(machine.branch) if _modes(machine)[0].signs else ""
    mode = Mode("1" if machine.chart.operations > 1 else "", signs)
    return posture(design, (exact if same else pose) + 0.0, mode)


def _modes(machine: Assembly) -> tuple[Mode, ...]:
    """One sign a limb, + of those that have one branch, where some limb has two."""
    choices = ["+-" if limb.branches > 1 else "+" for limb in machine.limbs]
    signs = ["".join(each) for each in product(*choices)]
    if all(choice == "+" for choice in choices):
        signs = [""]
    operations = ("1", "2") if machine.chart.operations > 1 else ("",)
    return tuple(Mode(operation, each) for operation in operations for each in signs)


def _signs(row: Array) -> str:
    return "".join("-" if value < 0.0 else "+" for value in row)


@lru_cache(maxsize=4096)
def _read_one(mode: str) -> tuple[int, tuple[float, ...]]:
    read = Mode.read(mode)
    return int(read.operation or 1), read.sigma or (1.0,)


def _read(mode: Modes) -> tuple[NDArray[Any], Array]:
    """Operation modes and signs of a mode, or of one each."""
    if isinstance(mode, str):
        operation, signs = _read_one(str(mode))
        return np.array(operation), np.array(signs)
    each = [_read_one(str(one)) for one in mode]
    if not each:
        return np.ones(0, dtype=int), np.ones((0, 1))
    return np.array([one[0] for one in each]), np.array([one[1] for one in each])
