"""How far a posture is from what ends its motion, and the ways back in."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import ceil, floor, inf, isfinite
from typing import NamedTuple

import numpy as np

from kinematics.answers.bounds import Bound, decimals
from kinematics.answers.clearances import Clearance, DesignChange, DesignChanges, Remedy
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.errors import BohemiaError
from kinematics.facets.facet import Facet
from kinematics.facets.forward import placed_apart
from kinematics.facets.inverse import InverseFacet
from kinematics.facets.inverse import posture as posture_at
from kinematics.mechanism import D, DesignField
from kinematics.screws.spatial import wrap_angle

Path = tuple[str | int, ...]
Way = tuple[DesignChange, ...]
_SHORT = 1e9  # mm; what cannot be held is worse than anything that can


class Nearest(NamedTuple):
    """A posture that can be held, how far it is, mm, and by how much another may be nearer:
    infinite where it was searched for and not proven."""

    posture: Posture
    distance: float
    error: float


class ClearancesFacet(Facet[D]):
    """Distances to bounds and singularities; the nearest pose in reach."""

    topic = "clearances"

    def of(self, posture: Posture, *, singular: bool = True) -> tuple[Clearance, ...]:
        """What is nearest of each kind, the nearest first.

        Where a bound is passed already its distance is negative: the way back to it.

        Args:
            singular: also singularities, which take longer to find.
        """
        found = list(self.to_bounds(posture))
        if singular:
            found += self.to_singularities(posture)
        # Of what is equally far, but for rounding, the order is that in which it was found.
        found.sort(key=lambda clearance: float(f"{clearance.distance:.9g}"))
        distances = np.maximum.accumulate([clearance.distance for clearance in found]).tolist()
        return tuple(replace(one, distance=d) for one, d in zip(found, distances, strict=True))

    def nearest_pose(self, posture: Posture) -> Remedy:
        """The ways out of a pose that cannot be held: another pose, other modes, another design."""
        if posture.reachable:
            return Remedy(posture, 0.0, (), "this pose can be held")
        inverse = self.other(InverseFacet)(posture.pose)
        held = zip(inverse.modes, inverse.within_stroke, strict=True)
        modes = tuple(mode for mode, within in held if within)
        changes = self.changes(posture)
        found, text = self.nearest(posture, modes)
        if found is None:
            return Remedy(None, inf, changes, text, modes, inf)
        return Remedy(found.posture, found.distance, changes, text, modes, found.error)

    def searched(
        self, posture: Posture, modes: Sequence[str], free: Sequence[int] | None = None
    ) -> Posture | None:
        """A posture that can be held in one of some modes, as near as a search finds one.

        By differential evolution (Storn and Price, J. Global Optim. 11 (1997) 341), the same each
        time: over what the machine lacks to its bounds, and where it lacks nothing over the
        distance, angles counted by the characteristic length. That none is nearer is not proven.

        Args:
            free: the coordinates that may change; None: all.
        """
        from scipy.optimize import differential_evolution  # slow to import

        mechanism, target = self.mechanism, np.array(posture.pose)
        here = mechanism.transform(target, posture.mode)[None]
        axes = mechanism.coordinates
        moving = list(range(len(axes))) if free is None else list(free)
        low, high = np.array([(axis.lower, axis.upper) for axis in axes]).T
        turns = np.array([axis.unit == "rad" for axis in axes]) & (high - low > 6.28)
        low = np.where(turns, target - np.pi, np.minimum(low, target))
        high = np.where(turns, target + np.pi, np.maximum(high, target))

        def scores(tried: Array) -> Array:
            """(modes, N) of free coordinates (F, N)."""
            poses = np.tile(target, (tried.shape[1], 1))
            poses[:, moving] = tried.T
            found = np.empty((len(modes), len(poses)))
            for n, mode in enumerate(modes):
                joints = mechanism.joints(poses, mode)
                margins = mechanism.margins(poses, mode, joints)
                short = np.minimum(-np.fmin.reduce(margins, axis=1), _SHORT)
                short += np.where(np.isfinite(joints).all(axis=1), 0.0, _SHORT)
                placed = mechanism.transform(poses, mode)
                away = placed_apart(placed, here, mechanism.length)[:, 0]
                found[n] = np.where(short > 0.0, _SHORT + short, away)
            return found

        best = differential_evolution(
            lambda tried: scores(tried).min(axis=0),
            list(zip(low[moving], high[moving], strict=True)),
            vectorized=True,
            updating="deferred",
            init="sobol",
            popsize=20,
            maxiter=200,
            tol=1e-6,
            polish=False,
            seed=0,
        )
        if best.fun >= _SHORT:
            return None
        pose = target.copy()
        pose[moving] = best.x
        mode = modes[int(scores(best.x[:, None])[:, 0].argmin())]
        pose = np.where(turns, wrap_angle(pose), pose)
        return self.other(InverseFacet).posture(pose, mode)

    # --- what a mechanism knows

    def to_bounds(self, posture: Posture) -> Iterable[Clearance]:
        """To the ends of ranges, changes of the working mode, the workspace's boundary."""
        return ()

    def to_singularities(self, posture: Posture) -> Iterable[Clearance]:
        """To the nearest parallel and constraint singularities."""
        return ()

    def nearest(self, posture: Posture, modes: tuple[str, ...]) -> tuple[Nearest | None, str]:
        """The nearest posture that can be held, and a sentence about the ways out.

        Args:
            modes: other modes in which the very pose can be held.
        """
        mode = posture.mode
        found = self.searched(posture, [mode]) or self.searched(posture, self.mechanism.modes)
        if found is None:
            return None, "no pose that this machine can hold was found"
        here, there = (self.mechanism.transform(p.pose, p.mode)[None] for p in (posture, found))
        away = float(placed_apart(here, there, self.mechanism.length)[0, 0])
        return Nearest(found, away, inf), f"the nearest pose that a search found is {mm(away)} away"

    def changes(self, posture: Posture) -> DesignChanges:
        """For each way, the smallest changes of the design that together would allow the pose.

        Of itself one way: strokes, of each limb or of all, that the joints' lengths are within.
        """
        fields = {field.path: field for field in self.mechanism.design_fields()}
        wanted: dict[Path, float] = {}
        for reason in posture.reasons:
            low, i = reason.bound.end == "min", reason.limb - 1
            paths: tuple[Path, ...] = (("limb", i, "stroke", 1 - low), ("stroke", 1 - low))
            path = next((path for path in paths if path in fields), None)
            if path is None or reason.bound.end not in ("min", "max"):
                return ()
            if not isfinite(posture.joints[i]):  # no stroke is long enough
                return ()
            both = wanted.get(path, posture.joints[i]), posture.joints[i]
            wanted[path] = min(both) if low else max(both)
        way = tuple(change(fields[path], after) for path, after in wanted.items())
        return self.allowing(posture, [way])

    def allowing(self, posture: Posture, ways: Iterable[Way]) -> DesignChanges:
        """Those ways, each told once, that do allow a pose; the smallest sum of changes first."""

        def amount(way: Way) -> float:
            return sum(abs(change.after - change.before) for change in way)

        good = [way for way in dict.fromkeys(ways) if way and self._allows(posture, way)]
        return tuple(sorted(good, key=lambda way: (amount(way), [c.label for c in way])))

    def _allows(self, posture: Posture, way: Way) -> bool:
        design = self.design
        try:
            for each in way:
                design = self.mechanism.schema.changed(design, each.path, each.after)
        except BohemiaError:
            return False
        return posture_at(design, posture.pose, posture.mode).reachable


def change(field: DesignField, after: float, name: str = "") -> DesignChange:
    """A change of one length of the design; ``name``: what it is called instead of its label."""
    of = f" of {field.group.lower()}" if field.path[0] == "limb" else ""
    label = f"{name or field.label}{of}"
    text = f"{label} from {field.value:g} to {outwards(field.value, after)} mm"
    return DesignChange(field.path, label, field.value, after, text)


def to_range_end(bound: Bound, amount: float, point: Array, error: float) -> Clearance:
    """The clearance to the end of a limb's stroke, at a point (3,)."""
    text = f"{far(amount)} the end of limb {bound.limb}'s stroke ({bound.name})"
    return Clearance("stroke", amount, place(point), text, bound.limb, bound, error)


def to_parallel(amount: float, point: Array, error: float) -> Clearance:
    """The clearance to a parallel singularity, at a point (3,)."""
    text = f"{far(amount)} a parallel singularity"
    return Clearance("parallel", amount, place(point), text, error=error)


def far(amount: float) -> str:
    """ "1.2 mm to", or "1.2 mm beyond" of negative amounts."""
    return f"{mm(abs(amount))} {'to' if amount >= 0.0 else 'beyond'}"


def mm(distance: float) -> str:
    """ "1.2 mm"."""
    return f"{distance:.{decimals(distance)}f} mm"


def place(point: Array) -> tuple[float, float, float]:
    """A point (3,) as it is told."""
    x, y, z = point.tolist()
    return x, y, z


def outwards(before: float, after: float) -> str:
    """A new value with few decimals, rounded away from the old one so that it still does."""
    digits = decimals(abs(after - before))
    scale = 10.0**digits
    rounded = ceil(after * scale) if after > before else floor(after * scale)
    return f"{rounded / scale:.{digits}f}"
