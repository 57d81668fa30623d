"""What is computed of workspaces in processes of their own: solids, and regions of a plane."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from app.features.section.compute import edges, filled, segments
from app.features.singularities.compute import field
from app.features.singularities.state import Control
from app.features.workspace.state import (
    ASPECTS,
    KEY,
    Flat,
    Workspace,
    colour_text,
    solver_modes,
)
from app.jobs.answers import Asked, Question
from app.language import tr
from app.review.state import Options, Review
from app.scene import painting, palette
from app.scene.painting import Scale
from app.scene.palette import LIGHT, Scheme
from app.terminal.tables import outer, with_units
from kinematics.answers.loci import LocusCurves
from kinematics.answers.sections import Region, RegionSpec
from kinematics.arrays import Array
from kinematics.facets.solids import RESOLUTIONS, Resolution, SolidRequest, SolidSpec
from kinematics.machine import machine_of, required
from kinematics.mechanism import Design

if TYPE_CHECKING:
    from kinematics.solids.csg import BuiltSolid

STEP = 4.0  # mm, the longest chord of an arc in the scene


@dataclass(frozen=True, slots=True)
class Wish:
    """Regions to show: of what, in which modes, and whether with the singular curves."""

    design: Design
    pose: tuple[float, ...]
    modes: tuple[str, ...] | None
    mode: str
    key: str
    locus: bool


@dataclass(frozen=True, eq=False, slots=True)
class Fill:
    """A region as triangles: ``vertices`` (V, 3) mm in the base frame, ``faces`` (F, 3)."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]


@dataclass(frozen=True, eq=False, slots=True)
class Laid:
    """Regions as the page shows them; lines (S, 2, 3) mm in the base frame.

    Attributes:
        fills, lines: of the regions of one mode, the present one if it has any; those of others
            would lie over them. Of a region that is not drawn the fill is empty.
        lines, line_limb: the edges, and whose each is, from 1.
        locus: where control is lost.
    """

    wish: Wish
    spec: RegionSpec
    frame: Array
    regions: tuple[Region, ...]
    fills: tuple[Fill, ...]
    lines: Array
    line_limb: NDArray[np.int64]
    locus: Array


@dataclass(frozen=True, eq=False, slots=True)
class SolidWish:
    """One solid to show: what to compute for it, where to put it, how to draw it.

    ``branch``: a pose that tells it from others which one might mean; "" where there are none.
    """

    spec: SolidSpec
    requests: dict[Resolution, SolidRequest]
    placement: Array
    branch: str
    opacity: float

    @property
    def what(self) -> tuple[object, ...]:
        """Equal while the same solid is wished, at whatever resolution."""
        return self.requests["preview"].arguments


@dataclass(frozen=True, eq=False, slots=True)
class Built:
    """A solid that was wished for, ready to be shown."""

    wish: SolidWish
    resolution: Resolution
    solid: BuiltSolid


@dataclass(frozen=True, eq=False, slots=True)
class Solids:
    """The solids as panels draw them.

    Attributes:
        wishes: what is on display.
        built: of those what is there.
        old: what is shown instead of others, of before.
        scale: the steps of the measure that colours show.
    """

    wishes: tuple[SolidWish, ...]
    built: Mapping[str, Built]
    old: Mapping[str, Built]
    scale: Scale | None


@dataclass(frozen=True, eq=False, slots=True)
class Laying:
    """The plane regions as panels draw them; ``stale`` while others are laid out, ``trouble`` says
    why there are none.
    """

    laid: Laid | None
    stale: bool
    trouble: str


def build(request: SolidRequest) -> BuiltSolid:
    """Build a solid, with its edges: they would take the page's loop longer than a frame."""
    from kinematics.facets.solids import build_solid

    solid = build_solid(request)
    if solid.triangles:
        _ = solid.edges
    return solid


REST_NORMAL = 0.15  # s for which a hand must rest before the normal solid is begun
REST_FINE = 0.7  # s before the fine one
_Solid = Question["BuiltSolid"]
# Coarse first, finer when the hand rests; the coarse lane is always free for the next preview, and
# too quick to be worth a bar.
SOLIDS: dict[Resolution, _Solid] = {
    "preview": Question("", "coarse", build, tries=2, urgent=True, kept=24),
    "normal": Question("", "fine", build, REST_NORMAL, tries=2, urgent=True, kept=24),
    "fine": Question("", "fine", build, REST_FINE, tries=2, urgent=True, kept=24),
}
OTHERS: _Solid = Question("", "fine", build, REST_NORMAL, tries=2, kept=8)
FIELD = Question("work.colours", "colours", field, kept=4)


def solid_asked(
    wish: SolidWish, resolution: Resolution, *, idle: bool = False
) -> Asked[BuiltSolid]:
    """The question about a solid."""
    title = "" if resolution == "preview" else f"{wish.spec.title}, {resolution}"
    return SOLIDS[resolution](wish.requests[resolution], title=title, idle=idle)


def wishes(review: Review) -> tuple[SolidWish, ...]:
    """The solids on display with what each depends on."""
    machine = review.machine
    if machine.solids is None:
        return ()
    solids, axes = machine.solids, machine.coordinates
    specs = {spec.key: spec for spec in solids.specs}
    return tuple(
        SolidWish(
            specs[s.key],
            {
                r: solids.request(
                    s.key, review.pose, modes_of(review, specs[s.key]), r, review[Workspace].surface
                )
                for r in RESOLUTIONS
            },
            solids.placement(s.key, review.pose),
            "" if at is None else with_units(outer(at, axes), axes),
            s.opacity,
        )
        for s in review[Workspace].solids
        for at in [solids.branch(s.key, review.pose)]
    )


def others_asked(review: Review) -> Asked[BuiltSolid] | None:
    """The question about the workspace of all modes, of which the edges stand pale beside that of
    the present one; None where they do not.
    """
    solids, wanted = review.machine.solids, review[Workspace]
    if solids is None or wanted.shown(KEY) is None or wanted.modes != "current":
        return None
    if len(review.machine.modes) < 2 or not solids.spec(KEY).uses_modes:
        return None
    return OTHERS(solids.request(KEY, review.pose, None, "preview"))


def modes_of(review: Review, spec: SolidSpec) -> tuple[str, ...] | None:
    """The modes that a solid is of: None for all of them, or where they do not matter."""
    if spec.of_present_mode:
        return (review.mode,)
    return solver_modes(review) if spec.uses_modes else None


def inside(review: Review) -> bool:
    """Whether the present position is in the workspace, of whichever of its modes."""
    return bool(review.machine.inverse.inside(review.pose, solver_modes(review)))


def piece_here(review: Review, built: Built) -> int | None:
    """Which piece of a solid that is parted holds the machine, from 0; None where none does."""
    return None if built.solid.piece_of is None else piece_around(review, built)


def piece_around(review: Review, built: Built) -> int | None:
    """The same of any solid."""
    solids = required(review.machine.solids, "solids")
    at = solids.point(built.wish.spec.key, review.pose, review.mode)
    rotation, offset = built.wish.placement[:3, :3], built.wish.placement[:3, 3]
    return _piece_at(built.solid, tuple((rotation.T @ (at - offset)).tolist()))


@lru_cache(maxsize=8)  # several ask for it at each event
def _piece_at(solid: BuiltSolid, point: tuple[float, ...]) -> int | None:
    return solid.piece_at(point)


def colour_key(
    review: Review, shown: Mapping[str, BuiltSolid], *, others: bool = False
) -> tuple[tuple[str, str], ...]:
    """The colours of the solids on display that no limb has, and what each stands for; with those
    of ``others``, the edges of other modes.
    """
    of = palette.scheme(review[Options].dark)
    entries = [(of.workspace, colour_text(review))] if KEY in shown else []
    if others:
        entries.append((of.others, tr("workspace.other_modes")))
    parted = shown.get(ASPECTS)
    if parted is not None and not review[Control].shade:
        signs = {piece.sign for piece in parted.pieces}
        texts = {1: "det > 0", -1: "det < 0"}
        entries += [(palette.aspect_color(s, 0, of), t) for s, t in texts.items() if s in signs]
        if review[Control].locus and len(signs) > 1:
            entries.append((of.beyond, tr("workspace.locus")))
    return tuple(entries)


def wish(review: Review) -> Wish | None:
    """The regions that a review shows; None where there are none to show.

    The position does not count, as the regions are of all positions.
    """
    machine, design, flat = review.machine, review.design, review[Flat]
    if not flat.on or not machine.region_specs:
        return None
    axes = machine.coordinates
    pose = tuple(0.0 if c.unit == "mm" else v for c, v in zip(axes, review.pose, strict=True))
    return Wish(design, pose, solver_modes(review), review.mode, flat.key, flat.locus)


def lay(wanted: Wish) -> Laid:
    """The regions, filled, with their edges and singular curves."""
    machine = machine_of(wanted.design)
    spec = next(s for s in machine.region_specs if s.key == wanted.key)
    modes = wanted.modes if spec.uses_modes else None
    found = required(machine.regions, "plane workspace").of(spec.key, wanted.pose, modes)
    frame = required(machine.regions, "plane workspace").frame(wanted.pose)
    fills, lines, limbs = [], [], []
    known = [region.mode for region in found]
    drawn = wanted.mode if wanted.mode in known else next(iter(known), "")
    for region in found:
        if region.mode not in ("", drawn):
            fills.append(Fill(np.empty((0, 3), np.float32), np.empty((0, 3), np.uint32)))
            continue
        section = region.section
        points, faces = filled(section, STEP)
        fills.append(Fill(in_space(points, frame).astype(np.float32), faces.astype(np.uint32)))
        flat, limb = edges(section, STEP)
        lines.append(in_space(flat, frame))
        limbs.append(limb)
    return Laid(
        wanted,
        spec,
        frame,
        found,
        tuple(fills),
        np.concatenate([*lines, np.empty((0, 2, 3))]),
        np.concatenate([*limbs, np.empty(0)]).astype(np.int64),
        _locus(wanted, spec, frame),
    )


def region_colors(found: tuple[Region, ...], of: Scheme = LIGHT) -> tuple[str, ...]:
    """A colour for each region: the workspace's for an only one, else as aspects have them."""
    if len(found) == 1:
        return (of.workspace,)
    return painting.piece_colors([region.sign for region in found], of)


def _locus(wanted: Wish, spec: RegionSpec, frame: Array) -> Array:
    machine = machine_of(wanted.design)
    chart = next((s for s in machine.singularities.loci if s.axes == spec.axes), None)
    if not wanted.locus or chart is None:
        return np.empty((0, 2, 3))
    found: LocusCurves = machine.singularities.locus(chart.key, wanted.pose, wanted.mode)
    return in_space(segments(found.lost()), frame)


def in_space(flat: Array, frame: Array) -> Array:
    """Points (..., 2) of the plane as points (..., 3) of the base frame."""
    raised: Array = flat @ frame[:3, :2].T + frame[:3, 3]
    return raised


REGIONS = Question("work.regions", "regions", lay)
