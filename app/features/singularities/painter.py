"""Coats of solids on display, and the values of a measure that they ask for."""

from __future__ import annotations

from collections import OrderedDict

from app.features.singularities import compute
from app.features.singularities.compute import Place
from app.features.singularities.state import Control
from app.features.workspace.compute import SolidWish
from app.jobs.lane import Job
from app.jobs.worker import Built
from app.review.state import Review
from app.scene import painting, palette
from app.scene.painting import Coat, Scale
from kinematics.arrays import Array


class Painter:
    """Coats of solids, kept as long as nothing of them changes; asks for the measure's values."""

    def __init__(self) -> None:
        self._coats: dict[str, tuple[object, tuple[Coat, ...]]] = {}
        self._fields: OrderedDict[object, Array] = OrderedDict()
        self._solids: dict[str, tuple[Built, Array]] = {}  # those to paint, and their vertices
        self._scale: tuple[object, Scale] | None = None
        self.wants = False

    def jobs(self, review: Review, spot: Place) -> list[Job]:
        """The values that are not known yet."""
        self.wants = False
        jobs = []
        for key, (built, points) in self._solids.items():
            what = _field_key(review, key, built)
            if what not in self._fields:
                arguments = spot, review[Control].shade, key, points
                jobs.append(Job(what, "the colours", compute.field, arguments, 0.0))
        return jobs

    def take(self, key: object, values: Array) -> None:
        self._fields[key] = values
        while len(self._fields) > 6:
            self._fields.popitem(last=False)

    def scale(self, review: Review) -> Scale | None:
        """The steps of the measure that is on display."""
        if self._scale is None or not review[Control].shade:
            return None
        return self._scale[1] if self._scale[0] == review[Control].shade else None

    def coats(self, review: Review, wish: SolidWish, built: Built) -> tuple[Coat, ...]:
        key, solid, control = wish.spec.key, built.solid, review[Control]
        shade = control.shade if wish.spec.limb is None else ""
        values: Array | None = None
        if shade and solid.triangles:
            what = _field_key(review, key, built)
            values = self._fields.get(what)
            if values is None:
                points = solid.shaded.vertices @ wish.placement[:3, :3].T + wish.placement[:3, 3]
                self._solids[key] = built, points.astype(float)
                self.wants = True
        made_of = solid, None if values is None else id(values), control.locus
        known = self._coats.get(key)
        if known is not None and known[0] == made_of:
            return known[1]
        coats = self._made(review, wish, built, shade, values)
        self._coats[key] = made_of, coats
        return coats

    def _made(
        self, review: Review, wish: SolidWish, built: Built, shade: str, values: Array | None
    ) -> tuple[Coat, ...]:
        solid = built.solid
        if not solid.triangles:
            return ()
        color = palette.solid_color(wish.spec)
        if values is not None:
            measure = next(m for m in review.machine.measures.specs if m.key == shade)
            steps = painting.scale(values, high=measure.better == "high", limits=measure.limits)
            if steps is not None:
                self._scale = shade, steps
                return painting.shaded(solid, values, steps, color)
        if solid.piece_of is not None and len(solid.pieces):
            return painting.pieces(solid, locus=review[Control].locus)
        return painting.plain(solid, color)


def _field_key(review: Review, key: str, built: Built) -> tuple[object, ...]:
    load = next(
        (
            review[Control].load
            for m in review.machine.measures.specs
            if m.key == review[Control].shade and m.needs_load
        ),
        None,
    )
    return "field", key, built.solid, review.design, review.mode, review[Control].shade, load
