"""The section on the page: cut while the plane moves, measured when the workspace rests."""

from __future__ import annotations

import threading
from collections import OrderedDict
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from app.features.move.state import Visit
from app.features.review.files import ExportedFile, solid_name
from app.features.section import compute
from app.features.section.compute import Drawn, Region, Wish
from app.features.section.files import section_bytes
from app.features.section.inscribed_scene import Inside
from app.features.section.scene import Plane
from app.features.section.state import Cut, MoveCut
from app.jobs.lane import Done, Job, Lane, Lost
from app.jobs.parts import Stage
from app.jobs.worker import LaneName, Process, give_way
from app.review.changes import Change
from app.review.requests import Forget, GoToBall, Inscribe, SaveSection
from app.review.state import Review
from app.review.view import reaching_mode
from app.widgets.desk import DIGITS, Sections
from kinematics.answers.sections import Box, Sphere, Volume
from kinematics.errors import BohemiaError
from kinematics.machine import machine_of, required

if TYPE_CHECKING:
    import viser

REST = 0.15  # s for which a workspace must stay before it is measured
CACHE = 64  # volumes kept
PREPARING = 15  # how much that process gives way to all others (nice)
MEDIA_TYPES = {"svg": "image/svg+xml", "dxf": "image/vnd.dxf", "csv": "text/csv"}
NAMES = {"ball": "the largest ball", "box": "the largest box"}


@dataclass(frozen=True, slots=True)
class Dragged:
    """A hand holds the plane in the scene, or lets it go."""

    phase: str
    client_id: int | None
    at: float


class Slicing:
    """Keeps section, volume, ball and box true to the workspace."""

    lanes: tuple[LaneName, ...] = ("sections", "measures")

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._cuts = Lane("sections", stage.put)
        # Apart, so that a section is never behind a volume, let alone behind the first one of all,
        # for which code is compiled.
        self._measures = Lane("measures", stage.put)
        self._plane = Plane(stage.scene, self._moved)
        self._inside = Inside(stage.scene)
        self._dragging: set[int] = set()
        self._grips = 0
        self._late = False
        self._region: Region | None = None
        self._wish: Wish | None = None
        self._drawn: Drawn | None = None
        self._volumes: OrderedDict[Region, Volume] = OrderedDict()
        self._measured: Region | None = None  # of the newest volume
        self._asked: dict[str, Job] = {}
        self._found: dict[str, Sphere | Box | None] = {}
        self._going: tuple[viser.ClientHandle | None] | None = None
        self._trouble = ""
        self._preparing: Process | None = None

    @property
    def late(self) -> bool:
        return self._late

    def start(self) -> None:
        self._cuts.start()
        self._measures.start()

    def stop(self) -> None:
        self._cuts.stop()
        self._measures.stop()
        if self._preparing is not None:
            self._preparing.kill()

    def _make_ready(self, kind: str) -> None:
        """What takes long the first time on a machine, where it is in nobody's way."""
        self._preparing = Process("prepare", partial(give_way, PREPARING))
        with suppress(BohemiaError, EOFError, OSError):  # it is only slower without
            self._preparing.run(None, compute.prepare, kind)
        self._preparing.kill()

    def cancel(self, lane: LaneName) -> None:
        (self._cuts if lane == "sections" else self._measures).cancel()

    def prepare(self) -> None:
        kind = self._stage.view.review.design.mechanism
        threading.Thread(target=self._make_ready, args=(kind,), daemon=True).start()
        self._plane.prepare(self._stage.view.drawing.size)
        self._inside.prepare()
        self._drawn = None

    # --- what is wanted

    def follow(self) -> None:
        review = self._stage.view.review
        spec = review.machine.section_spec
        if spec is None:
            self._region = None
            return
        region = compute.region(review)
        if region != self._region:
            self._region = region
            self._asked.clear()
            self._found.clear()
            self._going = None
            if region in self._volumes:
                self._measured = region
            self._measure()
        wish = compute.wish(review) if review[Cut].on else None
        if wish != self._wish:
            self._wish = wish
            job = None if wish is None else Job(wish, "the section", compute.draw, (wish,))
            self._cuts.want(() if job is None else (job,))
        self._place()
        self._late = True

    def _measure(self) -> None:
        """Ask for what is to be known of the present workspace."""
        jobs = list(self._asked.values())
        region = self._region
        if region is not None and region not in self._volumes:
            jobs.insert(0, Job(region, "the exact volume", compute.measure, (region,), REST))
        self._measures.want(jobs)

    def _place(self) -> None:
        view = self._stage.view
        review = view.review
        self._plane.place(
            required(review.machine.sections, "exact sections").frame(review.pose),
            review[Cut].at,
            None if self._drawn is None else self._drawn.extent,
            on=review[Cut].on,
            dragging=bool(self._dragging),
        )

    def applied(self, change: Change, before: Review, note: str) -> None:
        pass

    # --- what comes

    def take(self, item: object) -> bool:
        match item:
            case Done(_, Drawn() as drawn):  # perhaps not the newest wish, but the newest there is
                self._drawn, self._trouble, self._late = drawn, "", True
            case Done(Job(Region() as region), Volume() as volume):
                self._keep(region, volume)
            case Done(job, result):
                return self._inscribed_came(job, result)
            case Lost(job, text):
                self._lost(job, text)
            case Dragged(phase, client_id, at):
                return self._drag(phase, client_id, at)
            case Inscribe(what, here):
                self._inscribe(what, here)
            case Forget():
                self._asked.clear()
                self._found.clear()
                self._measure()
                self._late = True
            case GoToBall(client):
                self._going = (client,)
                if "ball" in self._found:
                    return self._go()
                self._inscribe("ball", here=False)
            case SaveSection(kind, client):
                self._save(kind, client)
        return False

    def _keep(self, region: Region, volume: Volume) -> None:
        self._measured, self._trouble, self._late = region, "", True
        self._volumes[region] = volume
        while len(self._volumes) > CACHE:
            self._volumes.popitem(last=False)

    def _lost(self, job: Job, text: str) -> None:
        if job.key in (self._wish, self._region):
            self._trouble, self._late = text, True
        elif job in self._asked.values():
            self._late = True
            self._asked = {what: asked for what, asked in self._asked.items() if asked is not job}
            self._going = None
            if text:
                self._stage.complain(text)

    def _moved(self, phase: str, client_id: int | None, at: float) -> None:
        """Called on the event loop."""
        self._stage.put(Dragged(phase, client_id, at))

    def _drag(self, phase: str, client_id: int | None, at: float) -> bool:
        who = -1 if client_id is None else client_id
        if phase == "end":
            self._dragging.discard(who)
            self._place()
            return False
        if not self._dragging:
            self._grips += 1
        self._dragging.add(who)
        return self._stage.apply(MoveCut(round(at, DIGITS), held=self._grips), None)

    # --- ball and box

    def _inscribe(self, what: str, here: bool) -> None:
        region = self._region
        if region is None:
            return
        position = self._stage.view.platform[:3, 3]
        center = tuple(float(v) for v in position) if here else None
        function = compute.sphere if what == "ball" else compute.box
        self._found.pop(what, None)
        self._asked[what] = Job(
            (what, region, center), NAMES[what], function, (region, center), slow=True
        )
        self._measure()
        self._late = True

    def _inscribed_came(self, job: Job, result: Sphere | Box | None) -> bool:
        what = next((name for name, asked in self._asked.items() if asked is job), None)
        if what is None:
            return False
        self._found[what] = result
        self._late = True
        if result is None:
            self._stage.complain(
                f"There is no {'ball' if what == 'ball' else 'box'}: nothing of the workspace is "
                f"there."
            )
        return self._go() if what == "ball" and self._going is not None else False

    def _go(self) -> bool:
        """Put the platform where a person asked to go, once the ball is there."""
        ball = self._found.get("ball")
        going, self._going = self._going, None
        if not isinstance(ball, Sphere) or going is None:
            return False
        review = self._stage.view.review
        transform = self._stage.view.platform.copy()
        transform[:3, 3] = ball.center
        pose = review.machine.pose_from_transform(transform, review.mode)
        # The ball is of all the chosen working modes; the machine's own may not get there.
        mode = reaching_mode(review, pose) or review.mode
        return self._stage.apply(Visit(pose, mode), going[0])

    # --- what is shown

    def catch_up(self) -> None:
        if not self._late:
            return
        self._late = False
        if self._region is None:
            return
        sheet = self._stage.sheet()
        found = self._sections()
        with self._stage.server.atomic():
            if self._drawn is not None and sheet.view.review[Cut].on:
                self._plane.fill(self._drawn)
            self._place()
            self._inside.show(found.ball, found.box)
            for panel in self._stage.panels:
                panel.draw_sections(sheet, found)
        self._stage.server.flush()

    def _sections(self) -> Sections:
        assert self._region is not None
        ball, box = self._found.get("ball"), self._found.get("box")
        return Sections(
            self._region,
            self._drawn,
            None if self._measured is None else self._volumes.get(self._measured),
            self._measured,
            ball if isinstance(ball, Sphere) else None,
            box if isinstance(box, Box) else None,
            self._trouble,
        )

    def _save(self, kind: str, client: viser.ClientHandle | None) -> None:
        drawn = self._drawn
        if drawn is None or drawn.wish.region != self._region:
            self._stage.complain("There is no section to save; show it first.", client)
            return
        self._stage.apart(client, lambda: self._stage.download(section_file(drawn, kind), client))


def section_file(drawn: Drawn, kind: str) -> ExportedFile:
    """A section as a file."""
    of = drawn.wish.region
    kinematics = machine_of(of.design)
    spec = kinematics.section_spec
    assert spec is not None
    angles = tuple(
        (c, v) for c, v in zip(kinematics.coordinates, of.pose, strict=True) if c.unit == "rad"
    )
    name = f"{solid_name(of.design, 'section', angles, of.modes)}_at{drawn.section.at:.6g}"
    title = of.design.title or of.design.name
    data = section_bytes(drawn.section, spec, kind, title=title)
    return ExportedFile(f"{name}.{kind}", data, MEDIA_TYPES[kind])
