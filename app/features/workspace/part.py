"""Workspaces that lie in a plane, on the page: laid out beside its loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from app.features.review.files import ExportedFile, sanitized
from app.features.section.files import section_bytes
from app.features.section.part import MEDIA_TYPES
from app.features.workspace import compute
from app.features.workspace.compute import Laid, Wish
from app.jobs.lane import Done, Job, Lane, Lost
from app.jobs.parts import Stage
from app.jobs.worker import LaneName
from app.review.changes import Change
from app.review.requests import SaveRegions
from app.review.state import Review
from app.scene import palette
from app.scene.edges import Edges
from app.scene.machine import Scene
from app.widgets.desk import Laying
from kinematics.answers.sections import Region, together
from kinematics.arrays import Array

if TYPE_CHECKING:
    import viser

MOST = 12  # regions with a mesh of their own
OPACITY = 0.55
_NOTHING = np.zeros((3, 3), dtype=np.float32)
_ONE_FACE = np.array([[0, 1, 2]], dtype=np.uint32)


class Regioning:
    """Keeps the plane regions true to the design, its modes and its orientation."""

    lanes: tuple[LaneName, ...] = ("regions",)

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._lane = Lane("regions", stage.put)
        self._nodes = _Nodes(stage.scene)
        self._wish: Wish | None = None
        self._laid: Laid | None = None
        self._trouble = ""
        self._late = False

    @property
    def late(self) -> bool:
        return self._late

    def start(self) -> None:
        self._lane.start()

    def stop(self) -> None:
        self._lane.stop()

    def cancel(self, lane: LaneName) -> None:
        self._lane.cancel()

    def prepare(self) -> None:
        review = self._stage.view.review
        self._nodes.prepare(bool(review.machine.region_specs))
        self._laid = None

    def applied(self, change: Change, before: Review, note: str) -> None:
        pass

    def follow(self) -> None:
        wish = compute.wish(self._stage.view.review)
        if wish == self._wish:
            return
        self._wish = wish
        job = Job(wish, "the regions of the workspace", compute.lay, (wish,))
        self._lane.want(() if wish is None else (job,))
        self._late = True

    def take(self, item: object) -> bool:
        match item:
            case Done(_, Laid() as laid) if self._wish and laid.wish.design == self._wish.design:
                first = self._laid is None
                self._laid, self._trouble, self._late = laid, "", True
                if first:
                    self._stage.put("fit")
            case Lost(job, text) if job.key == self._wish:
                self._trouble, self._late = text, True
            case SaveRegions(kind, client):
                self._save(kind, client)
        return False

    @property
    def bounds(self) -> tuple[Array, Array] | None:
        """The box around the regions on display, mm; None where there are none."""
        if self._laid is None or self._wish is None or not len(self._laid.lines):
            return None
        points = self._laid.lines.reshape(-1, 3)
        return points.min(axis=0), points.max(axis=0)

    def catch_up(self) -> None:
        if not self._late:
            return
        self._late = False
        laid = self._laid if self._wish is not None else None
        sheet = self._stage.sheet()
        with self._stage.server.atomic():
            self._nodes.show(laid)
            for panel in self._stage.panels:
                panel.draw_regions(sheet, Laying(laid, self._trouble))
        self._stage.server.flush()

    def _save(self, kind: str, client: viser.ClientHandle | None) -> None:
        laid = self._laid
        if laid is None or laid.wish != self._wish:
            self._stage.complain("There are no regions to save yet; show them first.", client)
            return
        self._stage.apart(client, lambda: self._stage.download(regions_file(laid, kind), client))


class _Nodes:
    """Scene nodes of regions, made once for a mechanism."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._fills: list[Any] = []
        self._edges: Edges | None = None

    def prepare(self, offered: bool) -> None:
        """Make them, with nothing to see; none where the mechanism has no regions."""
        scene = self._scene.server.scene
        self._fills, self._edges = [], None
        if not offered:
            return
        self._fills = [
            scene.add_mesh_simple(
                f"/regions/fill{n}",
                _NOTHING,
                _ONE_FACE,
                color=palette.rgb(palette.WORKSPACE),
                opacity=OPACITY,
                side="double",
                flat_shading=True,
                cast_shadow=False,
                receive_shadow=False,
                visible=False,
            )
            for n in range(MOST)
        ]
        self._edges = Edges(self._scene, "/regions", 2.5)

    def show(self, laid: Laid | None) -> None:
        """Bring them to these regions; None hides them."""
        colors = () if laid is None else region_colors(laid.regions)
        fills = () if laid is None else laid.fills
        for n, node in enumerate(self._fills):
            seen = n < len(fills) and len(fills[n].faces) > 0
            if seen:
                node.vertices, node.faces = fills[n].vertices, fills[n].faces
                node.color = palette.rgb(colors[n])
            if node.visible != seen:
                node.visible = seen
        if self._edges is None:
            return
        if laid is None:
            self._edges.hide()
        else:
            self._edges.show(laid.lines, laid.line_limb)
            self._edges.show_locus(laid.locus)


def region_colors(found: tuple[Region, ...]) -> tuple[str, ...]:
    """A colour for each region: the workspace's for an only one, else as aspects have them."""
    if len(found) == 1:
        return (palette.WORKSPACE,)
    seen: dict[int, int] = {}
    colors = []
    for region in found:
        seen[region.sign] = seen.get(region.sign, -1) + 1
        colors.append(palette.aspect_color(region.sign, seen[region.sign]))
    return tuple(colors)


def regions_file(laid: Laid, kind: str) -> ExportedFile:
    """The regions as a file."""
    design = laid.wish.design
    plane = laid.spec.plane
    whole = together([region.section for region in laid.regions])
    data = section_bytes(whole, plane, kind, title=design.title or design.name)
    name = f"{sanitized(design.name)}_{sanitized(laid.spec.key)}"
    return ExportedFile(f"{name}.{kind}", data, MEDIA_TYPES[kind])
