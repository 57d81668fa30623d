"""Where the joints are when the platform is at a pose, in every mode, and what stops it there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import degrees, inf, isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.bounds import Bound, decimals
from kinematics.answers.modes import Mode
from kinematics.answers.solutions import InverseSolutions, Margin, Posture, Reason
from kinematics.arrays import Array, finite, frozen
from kinematics.errors import InputError
from kinematics.facets.facet import Facet
from kinematics.mechanism import D, Design, mechanism_of

SLACK = 1e-9
"""mm or rad by which rounding may carry a joint over an end of its range."""
_CHUNK = 65536  # poses at a time


class InverseFacet(Facet[D]):
    """Inverse kinematics, postures and their reasons from joints, margins and residuals."""

    topic = "inverse"

    def __call__(self, poses: ArrayLike) -> InverseSolutions:
        """Joints and reasons of poses (..., P), mm and rad, in all modes.

        Raises:
            InputError: not finite numbers, or not P of them.
        """
        p, modes, mechanism = self._poses(poses), self.mechanism.modes, self.mechanism
        joints = mechanism.joints_in(p, modes)
        residual, within = np.full(p.shape[:-1], np.nan), []
        for n, mode in enumerate(modes):
            q = joints[..., n, :]
            within.append(self._within(p, mode, q))
            closes = np.isfinite(q).all(axis=-1)
            off = np.where(closes, mechanism.residual(p, mode, q), np.nan)
            residual = np.fmax(residual, off)
        return InverseSolutions(
            modes, frozen(joints), frozen(np.stack(within, axis=-1)), frozen(residual)
        )

    def inside(self, poses: ArrayLike, modes: Iterable[str] | None = None) -> NDArray[np.bool_]:
        """Whether poses (..., P) can be held within all bounds in one of ``modes``; (...) bool.

        Args:
            modes: None for any mode.

        Raises:
            InputError: not finite numbers, not P of them, or no such mode.
        """
        p, mechanism = self._poses(poses), self.mechanism
        chosen = mechanism.modes if modes is None else tuple(map(mechanism.mode, modes))
        flat = p.reshape(-1, p.shape[-1])
        answer = np.zeros(len(flat), dtype=bool)
        for k in range(0, len(flat), _CHUNK):
            part = flat[k : k + _CHUNK]
            joints = mechanism.joints_in(part, chosen)
            for n, mode in enumerate(chosen):
                answer[k : k + _CHUNK] |= self._within(part, mode, joints[:, n])
        return frozen(answer.reshape(p.shape[:-1]))

    def posture(
        self, pose: Sequence[float] | ArrayLike, mode: str, *, known: ArrayLike | None = None
    ) -> Posture:
        """The whole configuration at one pose in one mode, reachable or not, with its reasons.

        A limb that cannot close has NaN as its joint, and of its margins only how far it is from
        closing.

        Args:
            known: joints (J,) for which the pose was solved; where the pose gives them back but for
                rounding (`Mechanism.snap`), the posture has exactly these, its residual is theirs.

        Raises:
            InputError: not P finite numbers, or no such mode.
        """
        mechanism = self.mechanism
        p = self._poses(pose)
        if p.ndim != 1:
            symbols = ", ".join(c.symbol for c in mechanism.coordinates)
            raise InputError(f"a posture takes one pose of {len(p.T)} numbers ({symbols})")
        mode = mechanism.mode(mode)
        joints = mechanism.joints(p, mode)
        if known is not None:
            lengths = all(c.unit == "mm" for c in mechanism.actuators)
            what = "the known lengths" if lengths else "the known joints"
            wanted = finite(known, name=what, last=joints.shape[-1])
            turns = np.round((joints - wanted) / (2.0 * np.pi))
            turned = np.array([c.unit == "rad" for c in mechanism.actuators])
            wanted = np.where(turned, wanted + 2.0 * np.pi * turns, wanted)
            joints = np.where(np.abs(joints - wanted) <= mechanism.snap, wanted, joints)
        values = joints.tolist()
        at = {c.limb: v for c, v in zip(mechanism.actuators, values, strict=True)}
        placed = {c.limb for c in mechanism.actuators if c.signed}
        margins: list[Margin] = []
        reasons: list[Reason] = []
        amounts = mechanism.margins(p, mode, joints).tolist()
        for bound, amount in zip(mechanism.bounds, amounts, strict=True):
            if amount != amount or amount == inf:
                continue
            limb, joint = bound.limb or 0, at.get(bound.limb, np.nan)
            margins.append(Margin(limb, bound, amount, bound.unit))
            if amount < 0.0 and (not isfinite(joint) if bound.end == "link" else amount < -SLACK):
                text = mechanism.why_not(bound, p, mode, -amount)
                text = text or _beyond_text(bound, -amount, joint, bound.limb in placed)
                reasons.append(Reason(limb, bound, -amount, text, bound.unit))
        return Posture(
            pose=tuple(p.tolist()),
            mode=mode,
            joints=tuple(values),
            reasons=tuple(reasons),
            residual=float(mechanism.residual(p, mode, joints)),
            margins=tuple(margins),
        )

    def _within(self, poses: Array, mode: Mode, joints: Array) -> NDArray[np.bool_]:
        """(...) whether all limbs close and nothing is beyond its bound."""
        amounts = self.mechanism.margins(poses, mode, joints)
        ranged = [bound.end != "link" for bound in self.mechanism.bounds]
        with np.errstate(invalid="ignore"):
            beyond = np.asarray((amounts[..., ranged] < -SLACK).any(axis=-1))
        return np.asarray(np.isfinite(joints).all(axis=-1) & ~beyond)

    def _poses(self, poses: object) -> Array:
        return finite(poses, name="a pose", last=len(self.mechanism.coordinates))


def inverse(design: Design, poses: ArrayLike) -> InverseSolutions:
    """Joints of a design at poses (..., P) in all modes, see `InverseFacet`."""
    facet: InverseFacet[Design] = mechanism_of(design).facet(InverseFacet.topic)
    return facet(poses)


def posture(
    design: Design,
    pose: Sequence[float] | ArrayLike,
    mode: str = "",
    *,
    known: ArrayLike | None = None,
) -> Posture:
    """A posture of a design, see `InverseFacet.posture`."""
    facet: InverseFacet[Design] = mechanism_of(design).facet(InverseFacet.topic)
    return facet.posture(pose, mode, known=known)


def inside(
    design: Design, poses: ArrayLike, modes: Iterable[str] | None = None
) -> NDArray[np.bool_]:
    """Whether poses of a design can be held, see `InverseFacet.inside`."""
    facet: InverseFacet[Design] = mechanism_of(design).facet(InverseFacet.topic)
    return facet.inside(poses, modes)


def _beyond_text(bound: Bound, amount: float, joint: float, placed: bool) -> str:
    """How far a joint, or what else is bounded, is beyond a bound; ``placed``: it has no length."""
    low = bound.end == "min"
    end = joint + amount if low else joint - amount
    turned = bound.unit == "rad"
    shown, joint, end = (degrees(v) if turned else v for v in (amount, joint, end))
    digits, unit = decimals(shown), "°" if turned else " mm"
    if bound.end not in ("min", "max"):
        return f"{bound.place} is exceeded by {shown:.{digits}f}{unit}"
    if turned or placed:
        return (
            f"{bound.joint} is {shown:.{digits}f}{unit} {'below' if low else 'beyond'} its range "
            f"({joint:.{digits}f}{unit}, the end is {end:g}{unit})"
        )
    return (
        f"limb {bound.limb} is {shown:.{digits}f} mm too {'short' if low else 'long'} "
        f"({bound.joint} = {joint:.{digits}f} mm, {bound.name} = {end:g} mm)"
    )
