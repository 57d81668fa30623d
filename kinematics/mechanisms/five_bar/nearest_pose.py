"""The ways out of a pose of the five-bar that cannot be held. Lengths mm, angles rad."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from kinematics.answers.clearances import DesignChange, DesignChanges
from kinematics.answers.solutions import Posture, Reason
from kinematics.arrays import Array
from kinematics.facets.clearances import ClearancesFacet, Nearest
from kinematics.facets.inverse import posture as posture_at
from kinematics.mechanisms.five_bar import workspace
from kinematics.mechanisms.five_bar.design import SCHEMA, FiveBarDesign
from kinematics.mechanisms.five_bar.inverse import MODES
from kinematics.plane import arcs
from kinematics.plane.arcs import Edge

_IN = 1e-9  # of the size: how far inside the boundary the nearest posture is put


class NearestPose(ClearancesFacet[FiveBarDesign]):
    """Exact: the nearest arc of the workspace's boundary."""

    def nearest(self, posture: Posture, modes: tuple[str, ...]) -> tuple[Nearest | None, str]:
        found = None
        for mode in (posture.mode, *(other for other in MODES if other != posture.mode)):
            found = self._in_mode(posture, mode)
            if found is not None:
                break
        if found is None:
            text = "the limbs do not reach a common place, so no pose can be held"
        else:
            text = f"the nearest place that can be held is {found.distance:.1f} mm away"
            if found.posture.mode != posture.mode:
                text += f", in working mode {found.posture.mode.replace('-', '−')}"
        if changes := self.changes(posture):
            text += f"; or {' and '.join(change.text for change in changes[0])}"
        return found, text

    def _in_mode(self, posture: Posture, mode: str) -> Nearest | None:
        design, p = self.design, np.array(posture.pose)
        edges = [edge for loop in workspace.loops(design, (mode,)) for edge in loop]
        found = nearest_on(edges, p)
        inside = None if found is None else _into(design, found[0], found[1], mode)
        if inside is None:
            return None
        distance = float(np.hypot(*(np.array(inside.pose) - p)))
        return Nearest(inside, distance, 2e-6 * design.size)

    def changes(self, posture: Posture) -> DesignChanges:
        """For each limb every single number that would do; together they must allow the pose."""
        options = [list(_options(self.design, posture, reason)) for reason in posture.reasons]
        return self.allowing(
            posture,
            (
                tuple(_described(self.design, path, value) for path, value in together)
                for together in product(*options)
            ),
        )


def nearest_on(edges: list[Edge], p: Array) -> tuple[Edge, Array] | None:
    """The edge nearest to P, and the point on it; edges are single arcs."""
    if not edges:
        return None
    k, point = arcs.nearest(arcs.joined([edge.shown for edge in edges]), p)
    return edges[k], point


def _into(design: FiveBarDesign, edge: Edge, point: Array, mode: str) -> Posture | None:
    """A posture at a point of the boundary, or as little inside as rounding asks for."""
    centroid = np.mean([edge.first, edge.last], axis=0)
    ways = [point - edge.shown.center[0], edge.shown.center[0] - point, centroid - point]
    for part in (0.0, _IN, 1e3 * _IN):
        for way in ways:
            length = float(np.hypot(*way))
            if length > 0.0:
                aside = point + way * (part * design.size / length)
                tried = posture_at(design, (float(aside[0]), float(aside[1])), mode)
                if tried.reachable:
                    return tried
    return None


Path = tuple[str | int, ...]


def _options(design: FiveBarDesign, at: Posture, reason: Reason) -> Iterator[tuple[Path, float]]:
    """Numbers of the design that bring one limb within one bound, a breath further in."""
    i = reason.limb - 1
    p = np.array(at.pose)
    amount = reason.amount * (1.0 + 1e-9) + 1e-9 * design.size
    if reason.unit == "rad":
        end = int(reason.bound == "rho_max")
        limit = float(design.joint_range[i, end])
        yield ("joint_range_deg", i, end), limit + (amount if end else -amount)
        return
    limb = design.limbs[i]
    rho = float(np.hypot(*(p - design.base[i])))
    far = rho > limb.proximal + limb.distal
    if far:
        yield ("proximal", i), limb.proximal + amount
        yield ("distal", i), limb.distal + amount
    else:
        sign = 1.0 if limb.proximal > limb.distal else -1.0
        yield ("proximal", i), limb.proximal - sign * amount
        yield ("distal", i), limb.distal + sign * amount
    # |P − A_i| as wanted: x ± r_3 = ± sqrt(R² − y²).
    wanted = limb.proximal + limb.distal - 1e-9 * design.size
    wanted = wanted if far else abs(limb.proximal - limb.distal) + 1e-9 * design.size
    square = wanted**2 - float(p[1]) ** 2
    if square >= 0.0:
        side = -1.0 if i == 0 else 1.0
        for root in (square**0.5, -(square**0.5)):
            half = side * (float(p[0]) - root)
            if half > 0.0:
                yield ("half_base",), half


def _described(design: FiveBarDesign, path: Path, value: float) -> DesignChange:
    field = next(each for each in SCHEMA.fields(design) if each.path == path)
    where = "" if field.group == "Base" else f" of {field.group.lower()}"
    if field.unit == "rad":
        before, after = np.degrees([field.value, value])
        text = f"move {field.label} from {before:.1f}° to {after:.1f}°"
    else:
        text = f"change the {field.label}{where} from {field.value:.1f} to {value:.1f} mm"
    return DesignChange(path, field.label, field.value, value, text)
