"""Workspaces on the page: solids, coarse first and finer when the hand rests, and plane regions."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from app.features.compare.state import Beside
from app.features.review.files import build_file, solid_name
from app.features.section.state import clipping
from app.features.workspace import compute
from app.features.workspace.files import regions_file
from app.features.workspace.painter import Painter
from app.features.workspace.scene import Flats
from app.features.workspace.state import ASPECTS, KEY, colour_text, modes_text, usual_opacity
from app.jobs.answers import Asked
from app.jobs.lane import Lane
from app.jobs.parts import Client, Part, Stage
from app.jobs.process import apart, load_coarse_solids, load_finer_solids
from app.language import tr
from app.review.state import Options, Review
from app.review.units import area_text, plural, volume_text
from app.review.view import Fact, Legend, Size, View
from app.scene import palette
from app.scene import solids as drawing
from app.scene.painting import Coat
from app.widgets.desk import Sheet
from kinematics.arrays import Array
from kinematics.facets.solids import RESOLUTIONS, Resolution
from kinematics.machine import required

if TYPE_CHECKING:
    from kinematics.mechanism import Design
    from kinematics.solids.csg import BuiltSolid

FAINT = 0.4  # of its opacity has a solid that is of before


class SolidsPart(Part):
    """Keeps the solids true to the review."""

    LANES = ("coarse", "fine", "colours")
    DRAWN_LAST = True
    ASKS_FIRST = True

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._painter = Painter()
        self._wishes: tuple[compute.SolidWish, ...] = ()
        self._others: Asked[BuiltSolid] | None = None
        self._shown: dict[str, tuple[compute.Built, tuple[Coat, ...]]] = {}
        self._design: Design | None = None  # which has been seen whole

    def lane(self, name: str) -> Lane:
        if name == "colours":
            return super().lane(name)
        prepare = load_coarse_solids if name == "coarse" else load_finer_solids
        return Lane(name, self.stage.put, prepare=prepare, warm=True)

    def prepare(self) -> None:
        self._painter = Painter()  # the last machine's solids are none of this one's
        self._shown.clear()
        specs = self.stage.view.review.machine.solid_specs
        self._scene = drawing.Solids(self.stage.scene, specs)

    # --- what is wanted

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        self._wishes = compute.wishes(view.review)
        self._others = compute.others_asked(view.review)
        for resolution in RESOLUTIONS:
            for each in self._wishes:
                yield compute.solid_asked(each, resolution, idle=not self._begins(each, resolution))
            if resolution == "normal" and self._others is not None:
                yield self._others
        for built in self._built().values():
            field = self._painter.asked(view.review, built.wish, built.solid)
            if field is not None:
                yield field

    def _begins(self, each: compute.SolidWish, resolution: Resolution) -> bool:
        """Whether a solid is worth building at a resolution now."""
        best = self._best(each)
        if resolution == "preview":
            return best is None
        # The preview first: two cores are not many.
        if best is None:
            return self.answers.given_up(compute.solid_asked(each, "preview"))
        return RESOLUTIONS.index(best) < RESOLUTIONS.index(resolution)

    def _best(self, each: compute.SolidWish) -> Resolution | None:
        """The finest of a solid that is there."""
        return next(
            (r for r in reversed(RESOLUTIONS) if self.answers.kept(compute.solid_asked(each, r))),
            None,
        )

    def _built(self) -> dict[str, compute.Built]:
        """Those that are there."""
        built = {}
        for each in self._wishes:
            best = self._best(each)
            solid = None if best is None else self.answers.kept(compute.solid_asked(each, best))
            if best is not None and solid is not None:
                built[each.spec.key] = compute.Built(each, best, solid)
        return built

    # --- what is shown

    def show(self, sheet: Sheet) -> None:
        review, built, old = sheet.view.review, self._built(), {}
        cut = clipping(review)
        limbs = {w.spec.limb for w in self._wishes} - {None}
        others = bool(limbs) or ASPECTS in built or bool(review[Beside].over)
        for each in self._wishes:
            key, faint = each.spec.key, 1.0
            if key in built:
                self._shown[key] = built[key], self._coats(review, built[key])
            elif key in self._shown and not self.answers.given_up(
                compute.solid_asked(each, "preview")
            ):
                # The new one is on its way; until then the one before stays where it was.
                old[key] = self._shown[key][0]
                if self.aged(self.answers.of(compute.SOLIDS["preview"], each.requests["preview"])):
                    faint = FAINT
            else:
                self._shown.pop(key, None)
            if key in self._shown:
                last, coats = self._shown[key]
                look = drawing.Look(
                    _power(each),
                    faint,
                    outlined=len(limbs) > 1 and each.spec.limb is not None,
                    # A workspace's faces lie in those of the others, and would flicker there.
                    bare=others and each.spec.limb is None and key != ASPECTS,
                    here=compute.piece_here(review, last) if key in built else None,
                )
                self._scene.show(key, last.solid, last.wish.placement, coats, look, cut)
        wished = {each.spec.key for each in self._wishes}
        for spec in review.machine.solid_specs:
            if spec.key not in wished:
                self._shown.pop(spec.key, None)
            if spec.key not in self._shown:
                self._scene.hide(spec.key)
        beside = self._show_others(review, bare=others or cut is not None)
        placed = {k: (last.solid, last.wish.placement) for k, (last, _) in self._shown.items()}
        self._scene.name(placed)
        self.stage.scene.ground("solids", self.points)
        if self._design != review.design and (built or not wished):
            if self._design is not None or built:
                self.stage.fit_view()  # solids are larger than the machine
            self._design = review.design
        scales = (self._painter.scale(key) for key in built)
        scale = next((steps for steps in scales if steps is not None), None)
        self.stage.tell(compute.Solids(self._wishes, built, old, scale))
        self._tell_size(review, built.get(KEY), old.get(KEY))
        solids = {key: last.solid for key, (last, _) in self._shown.items()}
        self.stage.tell(Legend("workspace", compute.colour_key(review, solids, others=beside)))

    def _show_others(self, review: Review, *, bare: bool) -> bool:
        """The edges of the workspace of all modes, once a hand rests and nothing else is shown;
        whether they are.
        """
        solid = None if self._others is None or bare else self.answers.kept(self._others)
        if solid is None:
            self._scene.beside(None, np.eye(4))
        else:
            place = required(review.machine.solids, "solids").placement(KEY, review.pose)
            self._scene.beside(solid, place)
        return solid is not None

    def _tell_size(
        self, review: Review, built: compute.Built | None, old: compute.Built | None
    ) -> None:
        """How large the workspace is, where no exact section tells it."""
        if review.machine.section_spec is not None or review.machine.region_specs:
            return
        known = built or old
        fact = None
        if known is not None:
            what = f"{modes_text(review)}, {plural(len(known.solid.pieces), 'piece')}"
            fact = Fact(volume_text(known.solid.volume), what)
        self.stage.tell(Size(fact, stale=built is None))

    def _coats(self, review: Review, built: compute.Built) -> tuple[Coat, ...]:
        asked = self._painter.asked(review, built.wish, built.solid)
        values = None if asked is None else self.answers.of(asked.question, asked.request).now
        return self._painter.coats(review, built.wish, built.solid, values)

    @property
    def points(self) -> Array | None:
        """The vertices of the solids on display, mm."""
        placed = [
            last.solid.mesh.vertices @ last.wish.placement[:3, :3].T + last.wish.placement[:3, 3]
            for last, _ in self._shown.values()
            if last.solid.triangles
        ]
        return np.concatenate(placed) if placed else None

    @property
    def corners(self) -> Array:
        """Where (N, 3) mm edges of the solids on display meet."""
        found = [np.empty((0, 3))]
        for last, _ in self._shown.values():
            place = last.wish.placement
            found.append(corners_of(last.solid) @ place[:3, :3].T + place[:3, 3])
        return np.concatenate(found)

    # --- files

    def save_solid(self, key: str, kind: str, resolution: str, part: str, client: Client) -> None:
        """Save a solid on display, or one part of it."""
        review = self.stage.review
        each = next((w for w in compute.wishes(review) if w.spec.key == key), None)
        if each is None:
            self.stage.complain(tr("workspace.not_shown"), client)
            return
        axes = zip(review.machine.coordinates, review.pose, strict=True)
        angles = tuple((c, v) for c, v in axes if c.unit == "rad")
        name = solid_name(review.design, key, angles, compute.modes_of(review, each.spec))
        named = kind, name, part
        request = next(made for r, made in each.requests.items() if r == resolution)
        self.save(each, lambda each: apart(build_file, request, each.placement, *named), client)


@lru_cache(maxsize=8)
def corners_of(solid: BuiltSolid) -> Array:
    """Where (N, 3) sharp edges of a solid meet or end, mm, in its own frame; two of them in a row
    are one edge.
    """
    places, count = np.unique(solid.edges.reshape(-1, 3), axis=0, return_counts=True)
    return np.asarray(places[count != 2], dtype=float)


def _power(wish: compute.SolidWish) -> float:
    """Of the usual opacities: 1 where the opacity is the usual one, 0 where it is 1."""
    usual = usual_opacity(wish.spec.key)
    return math.log(max(wish.opacity, 1e-6)) / math.log(usual)


class RegionsPart(Part):
    """Keeps the plane regions true to the design, its modes and its orientation."""

    LANES = ("regions",)

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._scene: Flats | None = None  # where the mechanism has no regions
        self._fitted = False

    def prepare(self) -> None:
        offered = self.stage.view.review.machine.region_specs
        self._scene = Flats(self.stage.scene) if offered else None
        self._fitted = False

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        wanted = compute.wish(view.review)
        return () if wanted is None else (compute.REGIONS(wanted),)

    def show(self, sheet: Sheet) -> None:
        told = self.answers[compute.REGIONS]
        if self._scene is not None:
            self._scene.show(told.shown, faint=self.aged(told))
            self.stage.scene.ground("regions", self.points)
        self.stage.tell(compute.Laying(told.shown, told.stale, told.trouble))
        if self._scene is not None:
            regions = () if told.shown is None else told.shown.regions
            modes = modes_text(sheet.view.review)
            area = sum(region.section.area for region in regions)
            fact = Fact(area_text(area), modes) if regions else None
            self.stage.tell(Size(fact, told.stale))
            of = palette.scheme(sheet.view.review[Options].dark)
            entries = ((of.workspace, colour_text(sheet.view.review)),) if regions else ()
            self.stage.tell(Legend("regions", entries))
        if told.now is not None and not self._fitted:
            self._fitted = True
            self.stage.fit_view()

    @property
    def points(self) -> Array | None:
        """The outlines of the regions on display, mm."""
        laid = self.answers[compute.REGIONS].shown
        return None if laid is None or not len(laid.lines) else laid.lines.reshape(-1, 3)

    def save_regions(self, kind: str, client: Client) -> None:
        """Save the plane regions on display as a file of this kind."""
        missing = tr("workspace.no_regions")
        laid = self.answers[compute.REGIONS].now
        self.save(laid, lambda laid: regions_file(laid, kind), client, missing)
