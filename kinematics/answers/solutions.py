"""What solvers answer with: postures, reasons, stops. Failure is a value with a human message.

Poses and joints are tuples in the mechanism's own coordinates (mm and rad, see
`kinematics.mechanism.Coordinate`), so every value here is frozen and hashable.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinematics.answers.bounds import Bound, Unit
from kinematics.answers.coordinates import Coordinate, Pose
from kinematics.answers.modes import Mode
from kinematics.arrays import Array, Frozen, brief


@dataclass(frozen=True, slots=True)
class Reason:
    """Why a pose cannot be held: one limb beyond one bound.

    ``limb`` counts from 1, 0 of what is of no limb; ``amount`` is how far beyond the bound it is,
    mm (or rad, see ``unit``), > 0.
    """

    limb: int
    bound: Bound
    amount: float
    text: str
    unit: Unit = "mm"


@dataclass(frozen=True, slots=True)
class Margin:
    """How far one limb is from one of its bounds, in ``unit``; negative beyond it."""

    limb: int
    bound: Bound
    amount: float
    unit: Unit = "mm"


@dataclass(frozen=True, slots=True)
class Posture:
    """The whole configuration of a machine at one pose in one working mode.

    Attributes:
        pose: the platform's coordinates, mm and rad.
        mode: one sign a limb, as "+-+++".
        joints: actuated lengths or angles; NaN where the limb cannot close at all.
        reasons: empty when the pose is reachable within the strokes.
        residual: the largest loop-closure error of the limbs that close, mm.
        margins: distance of every limb to every bound, mm.
    """

    pose: tuple[float, ...]
    mode: str
    joints: tuple[float, ...]
    reasons: tuple[Reason, ...]
    residual: float
    margins: tuple[Margin, ...]

    def __repr__(self) -> str:
        why = "reachable" if self.reachable else "; ".join(reason.text for reason in self.reasons)
        mode = f", {self.mode!s}" if self.mode else ""
        return f"<Posture at {brief(self.pose)}{mode}, joints {brief(self.joints)}: {why}>"

    @property
    def reachable(self) -> bool:
        """Every limb closes and lies within its stroke."""
        return not self.reasons

    @property
    def closes(self) -> bool:
        """Every limb can be assembled, within its stroke or not."""
        return all(np.isfinite(self.joints))

    @property
    def nearest(self) -> Margin | None:
        """The smallest margin: the limit that is met first; None where nothing limits."""
        # A machine has strokes of lengths or of angles, hardly of both; links are lengths.
        return min(self.margins, key=lambda m: m.amount, default=None)


@dataclass(frozen=True, eq=False, slots=True)
class InverseSolutions:
    """All working modes of a batch of poses; arrays are read-only.

    Attributes:
        modes: the M modes.
        joints: (..., M, J) actuated joints; NaN where a limb cannot close.
        within_stroke: (..., M) bool, the mode closes and every joint is within its stroke.
        residual: (...,) the largest loop-closure error, mm; NaN where no mode closes.
    """

    modes: tuple[Mode, ...]
    joints: Array
    within_stroke: np.ndarray
    residual: Array

    def __repr__(self) -> str:
        shape = self.joints.shape[:-2]
        poses = "one pose" if not shape else f"{' × '.join(map(str, shape))} poses"
        held = int(self.within_stroke.any(axis=-1).sum())
        return f"<Joints of {poses} in {len(self.modes)} modes; {held} within reach>"

    @property
    def within(self) -> np.ndarray:
        """(..., M) bool: `within_stroke`."""
        return self.within_stroke


Stop = Literal["target", "stroke", "singularity", "stalled"]


@dataclass(frozen=True, slots=True)
class Followed:
    """Where one assembly mode led when the actuated joints were moved.

    Attributes:
        posture: the posture reached, always one that the machine can hold together.
        stop: "target" when the wanted joints were reached, else what stopped the motion.
        text: one sentence for the user; empty when the target was reached without events.
        fraction: the part of the way that was covered, 0 to 1.
        limb: the limb at its stroke end, if that is what stopped it (from 1).
        warning: one phrase where the posture is near a singularity, as "about 2.3 mm from a
            parallel singularity"; else empty.
    """

    posture: Posture
    stop: Stop
    text: str
    fraction: float
    limb: int | None = None
    warning: str = ""


Severity = Literal["info", "warning"]


@dataclass(frozen=True, slots=True)
class Finding:
    """Something worth knowing about a design: an arrangement found, or a warning."""

    severity: Severity
    title: str
    text: str
    limbs: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Fold:
    """Where, on a straight line in joint space, an assembly mode merges with another and ends.

    Attributes:
        distance: from the start of the line, in joint space, mm.
        joints: there.
        pose: there; both assembly modes have it.
        mode: the working mode there.
        partner: the other assembly mode, with the joints at the start of the line; None where its
            branch does not reach back to them.
    """

    distance: float
    joints: tuple[float, ...]
    pose: tuple[float, ...]
    mode: str
    partner: Posture | None


@dataclass(frozen=True, slots=True)
class SelfMotion:
    """A motion that stays free with all actuators locked: a curve of solutions, not a point.

    Attributes:
        pose: one pose on it, among the solutions.
        mode: the working mode there.
        direction: d(pose) along it, mm and rad, of unit length with angles times the
            characteristic length.
        text: one sentence for the user.
    """

    pose: tuple[float, ...]
    mode: str
    direction: tuple[float, ...]
    text: str


@dataclass(frozen=True, slots=True)
class Solution:
    """One of `ForwardSolutions`.

    Attributes:
        pose: mm and rad.
        mode: the mode that it stands in.
        residual: the largest loop-closure error, mm.
        condition: condition number of the inverse Jacobian; infinite at a singularity.
        within_stroke: no joint is beyond its range.
        multiplicity: how many solutions coincide there to within rounding; 1 as a rule.
        gap: distance to the nearest other solution, mm, angles times the characteristic length.
        identity: a label that stays with it when it is followed to other joints.
    """

    pose: tuple[float, ...]
    mode: str
    residual: float
    condition: float
    within_stroke: bool
    multiplicity: int
    gap: float
    identity: int


@dataclass(frozen=True, eq=False)
class ForwardSolutions(Frozen):
    """All assembly modes for one vector of actuated joints; N real solutions, read-only arrays.

    Attributes:
        joints: (J,) as given.
        poses: (N, P) mm and rad.
        modes: N working modes.
        residual: (N,) the largest loop-closure error, mm.
        condition: (N,) condition number of the inverse Jacobian; infinite at a singularity.
        determinant: (N,) of the actuation and constraint wrenches, normalised to rows of length
            one; it changes its sign where assembly modes merge.
        within_stroke: (N,) bool.
        multiplicity: (N,) how many solutions coincide there to within rounding; 1 as a rule.
        gap: (N,) distance to the nearest other solution, mm, angles times the characteristic
            length; infinite for an only one.
        identities: N labels; a label stays with a solution that is followed to other joints.
        complex_count: finite complex solutions, counted with their multiplicity.
        expected_count: how many there are for almost every machine of this family.
        complete: all are found: count and closure under conjugation hold.
        method: how they were found, in words.
        seconds: how long that took.
        notes: sentences for the user: doubles, why something may be missing, why there are none.
        self_motions: what stays free with the actuators locked.
        roots: (K, M) every complex solution in the mechanism's own unknowns, to track on from.
        mixed_modes: also solutions outside of the design's closed form were asked for.
        axes: the coordinates of the poses.
    """

    joints: tuple[float, ...]
    poses: Array
    modes: tuple[str, ...]
    residual: Array
    condition: Array
    determinant: Array
    within_stroke: np.ndarray
    multiplicity: np.ndarray
    gap: Array
    identities: tuple[int, ...]
    complex_count: int
    expected_count: int | None
    complete: bool
    method: str
    seconds: float
    notes: tuple[str, ...]
    self_motions: tuple[SelfMotion, ...]
    roots: np.ndarray
    mixed_modes: bool = False
    axes: tuple[Coordinate, ...] = ()

    def __len__(self) -> int:
        return len(self.modes)

    def __getitem__(self, n: int) -> Solution:
        return Solution(
            pose=Pose(self.poses[n].tolist(), self.axes) if self.axes else tuple(self.poses[n]),
            mode=self.modes[n],
            residual=float(self.residual[n]),
            condition=float(self.condition[n]),
            within_stroke=bool(self.within_stroke[n]),
            multiplicity=int(self.multiplicity[n]),
            gap=float(self.gap[n]),
            identity=self.identities[n],
        )

    def __iter__(self) -> Iterator[Solution]:
        return map(self.__getitem__, range(len(self)))

    def __repr__(self) -> str:
        return (
            f"<{len(self)} assembly modes at joints {brief(self.joints)}, "
            f"{int(self.within_stroke.sum())} within the strokes: {self.evidence}>"
        )

    @property
    def evidence(self) -> str:
        """How it is known that they are all, or why one may be missing, in one sentence."""
        of = "" if self.expected_count is None else f" of {self.expected_count}"
        counted = f"{self.complex_count}{of} complex solutions"
        return f"{'complete' if self.complete else 'perhaps not all'}, {counted}; {self.method}"


@dataclass(frozen=True, slots=True)
class Merged:
    """A solution that ended on the way to the present joints, and where it was last.

    ``partner`` is who it merged with; None if that one had only appeared on the way.
    """

    identity: int
    partner: int | None
    pose: tuple[float, ...]
    mode: str


@dataclass(frozen=True, eq=False, slots=True)
class Refreshed:
    """The solutions after the joints moved, told apart from those before.

    Attributes:
        solutions: at the present joints; whoever was there before keeps its identity.
        appeared: identities of those that were not there before.
        merged: those that ended on the way.
    """

    solutions: ForwardSolutions
    appeared: tuple[int, ...]
    merged: tuple[Merged, ...]
