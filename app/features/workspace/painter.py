"""How solids on display are painted: plainly, by their pieces, or by a measure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from app.features.singularities.compute import spot_of
from app.features.singularities.state import Control
from app.features.workspace.compute import FIELD, SolidWish
from app.jobs.answers import Asked
from app.review.state import Options, Review
from app.scene import painting, palette
from app.scene.painting import Coat, Scale
from kinematics.answers.singularities import Measure
from kinematics.arrays import Array

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid


class Painter:
    """Coats of solids, kept as long as nothing of them changes."""

    def __init__(self) -> None:
        self._coats: dict[str, tuple[object, tuple[Coat, ...], Scale | None]] = {}

    def asked(self, review: Review, wish: SolidWish, solid: BuiltSolid) -> Asked[Array] | None:
        """The question about the measure that a solid is coloured by; None where it is not."""
        measure = _measure(review)
        if measure is None or wish.spec.limb is not None or not solid.triangles:
            return None
        load = review[Control].load if measure.needs_load else None
        request = (solid, review.design, review.mode, measure.key, load)
        points = solid.shaded.vertices @ wish.placement[:3, :3].T + wish.placement[:3, 3]
        return FIELD(request, spot_of(review), measure.key, wish.spec.key, points.astype(float))

    def scale(self, key: str) -> Scale | None:
        """The steps of the measure that a solid was painted by last."""
        return self._coats[key][2] if key in self._coats else None

    def coats(
        self, review: Review, wish: SolidWish, solid: BuiltSolid, values: Array | None
    ) -> tuple[Coat, ...]:
        """How to paint a solid; ``values`` of the measure, once they are known."""
        dark, locus = review[Options].dark, review[Control].locus
        made_of = solid, None if values is None else id(values), locus, dark
        known = self._coats.get(wish.spec.key)
        if known is None or known[0] != made_of:
            steps = _steps(review, values)
            known = made_of, _made(review, wish, solid, values, steps), steps
            self._coats[wish.spec.key] = known
        return known[1]


def _made(
    review: Review, wish: SolidWish, solid: BuiltSolid, values: Array | None, steps: Scale | None
) -> tuple[Coat, ...]:
    if not solid.triangles:
        return ()
    of = palette.scheme(review[Options].dark)
    color = palette.solid_color(wish.spec, of)
    if values is not None and steps is not None:
        return painting.shaded(solid, values, steps, color)
    if solid.piece_of is not None and len(solid.pieces):
        return painting.pieces(solid, locus=review[Control].locus, of=of)
    shells = painting.PLAIN if wish.spec.limb is None else painting.LIMB
    return painting.plain(solid, color, shells)


def _steps(review: Review, values: Array | None) -> Scale | None:
    measure = _measure(review)
    if values is None or measure is None:
        return None
    return painting.scale(values, high=measure.better == "high", limits=measure.limits)


def _measure(review: Review) -> Measure | None:
    """The one that colours show."""
    specs = review.machine.measures.specs
    return next((m for m in specs if m.key == review[Control].shade), None)
