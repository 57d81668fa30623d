"""The section on the page: cut while the plane moves, measured when the workspace rests."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from contextlib import suppress
from functools import partial
from typing import Any

from app.features.move.state import Visit
from app.features.review.files import ExportedFile, solid_name
from app.features.section import compute
from app.features.section.files import section_bytes
from app.features.section.scene import Inside, Plane
from app.features.section.state import DRAWN, Cut, MoveCut
from app.features.workspace.state import modes_text
from app.jobs.answers import Asked
from app.jobs.parts import Client, Grip, Part, Stage
from app.jobs.process import Process, give_way
from app.language import tr
from app.review.changes import Change
from app.review.state import Review
from app.review.units import minus, volume_text
from app.review.view import Fact, Size, View, reaching_mode
from app.widgets.desk import DIGITS, Sheet
from kinematics.errors import BohemiaError
from kinematics.machine import machine_of, required

PREPARING = 19  # how much that process gives way to all others (nice)
QUESTIONS: dict[str, Any] = {"ball": compute.BALL, "box": compute.BOX}


class SectionPart(Part):
    """Keeps section, volume, ball and box true to the workspace."""

    LANES = ("sections", "measures")

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._grip = Grip()
        self._region: compute.Region | None = None
        self._asked: dict[str, compute.Inside] = {}  # balls and boxes in that workspace
        self._going: tuple[Client] | None = None
        self._preparing: Process | None = None

    def stop(self) -> None:
        super().stop()
        if self._preparing is not None:
            self._preparing.kill()

    def prepare(self) -> None:
        kind = self.stage.view.review.design.mechanism
        threading.Thread(target=self._make_ready, args=(kind,), daemon=True).start()
        self._plane = Plane(self.stage.scene, lambda *what: self.stage.ask(self.drag, *what))
        self._inside = Inside(self.stage.scene)

    def _make_ready(self, kind: str) -> None:
        """What takes long the first time on a machine, where it is in nobody's way."""
        self._preparing = Process("prepare", partial(give_way, PREPARING))
        with suppress(BohemiaError, EOFError, OSError):  # it is only slower without
            self._preparing.run(None, compute.prepare, kind)
        self._preparing.kill()

    @property
    def covered_left(self) -> float:
        return DRAWN if _drawn(self.stage.view.review) else 0.0

    def applied(self, change: Change, before: Review, note: str, client: Client) -> None:
        if _drawn(self.stage.review) != _drawn(before):
            self.stage.fit_view()  # another part of the scene is free then

    # --- what is wanted

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        review = view.review
        has = review.machine.section_spec is not None
        region = compute.region(review) if has else None
        if region != self._region:
            self._region = region
            self._going = None
        if region is None:
            self._asked.clear()
            return
        of = region, compute.region(review, "present"), compute.region(review, "all")
        self._asked = {what: asked for what, asked in self._asked.items() if asked[0] in of}
        if review[Cut].on:
            yield compute.SECTION(compute.wish(review))
        yield compute.VOLUME(region)
        for what, request in self._asked.items():
            yield QUESTIONS[what](request, *request)

    def follow(self) -> None:
        super().follow()
        self._place()

    def _place(self) -> None:
        """Put the plane where it belongs, and what is drawn of a workspace before where it did."""
        view = self.stage.view
        review, drawn = view.review, self.answers[compute.SECTION].shown
        if self._region is None:
            self._plane.hide()
            return
        of = self._region if drawn is None else drawn.wish.region
        frame = required(machine_of(of.design).sections, "exact sections").frame(of.pose)
        extent = None if drawn is None else drawn.extent
        on, held = review[Cut].on, self._grip.held
        spec, at = review.machine.section_spec, review[Cut].at
        text = "" if spec is None else f"{spec.normal} = {minus(f'{at:.{DIGITS}f}')} mm"
        self._plane.place(frame, at, extent, text, on=on, dragging=held)

    # --- what a person asks for

    def drag(self, phase: str, client_id: int | None, at: float) -> bool:
        """A hand holds the plane in the scene, or lets it go."""
        if not self._grip.take(phase, client_id):
            self._place()
            return False
        return self.stage.apply(MoveCut(round(at, DIGITS), held=self._grip.number), None)

    def inscribe(self, what: str, here: bool, together: bool = False) -> None:
        """Find the largest ball or box in the workspace, about the platform or anywhere.

        In that of the present mode, which a machine cannot change on the way; or in that of all
        modes ``together``.
        """
        if self._region is None:
            return
        position = self.stage.view.platform[:3, 3]
        center = tuple(float(v) for v in position) if here else None
        self.answers.forget(QUESTIONS[what])
        region = compute.region(self.stage.review, "all" if together else "present")
        self._asked[what] = region, center
        self.follow()

    def forget_inscribed(self) -> None:
        """Take the ball and the box off display."""
        self._asked.clear()
        self.follow()

    def go_to_ball(self, client: Client = None) -> bool:
        """Put the platform into the middle of the largest ball, at its present orientation.

        The working mode changes if the present one does not get there.
        """
        self._going = (client,)
        if self.answers[compute.BALL].now is not None:
            return self._go()
        self.inscribe("ball", here=False, together=True)
        return False

    def _go(self) -> bool:
        balls, going, self._going = self.answers[compute.BALL].now, self._going, None
        if not balls or going is None:
            return False
        review = self.stage.review
        transform = self.stage.view.platform.copy()
        transform[:3, 3] = balls[0].center
        pose = review.machine.pose_from_transform(transform, review.mode)
        # The ball is of all the chosen working modes; the machine's own may not get there.
        mode = reaching_mode(review, pose) or review.mode
        return self.stage.apply(Visit(pose, mode), going[0])

    # --- what comes

    def came(self, asked: Asked[Any], answer: Any) -> bool:
        for what, question in QUESTIONS.items():
            if asked.question is question and not answer:
                self.stage.complain(tr("section.nothing_inside", what=tr(f"section.{what}")))
        return asked.question is compute.BALL and self._going is not None and self._go()

    def lost(self, asked: Asked[Any]) -> None:
        lost = [what for what, question in QUESTIONS.items() if question is asked.question]
        for what in lost:
            self._asked.pop(what, None)
            self._going = None

    # --- what is shown

    def show(self, sheet: Sheet) -> None:
        section, volume = self.answers[compute.SECTION], self.answers[compute.VOLUME]
        found = compute.Sections(
            section.shown,
            section.stale,
            volume.now,
            volume.old,
            self._found("ball"),
            self._found("box"),
            section.trouble or volume.trouble,
        )
        if found.drawn is not None:
            self._plane.fill(found.drawn)
        self._place()
        self._inside.show(found.ball and found.ball[0], found.box and found.box[0])
        if self._region is not None:
            self.stage.tell(found)
            self._tell_size(sheet.view.review, found)

    def _tell_size(self, review: Review, found: compute.Sections) -> None:
        """How large the workspace is."""
        known = found.volume or found.old_volume
        fact = None
        if known is not None:
            pieces = f", {tr('page.pieces', n=len(known.pieces))}" if known.pieces else ""
            fact = Fact(volume_text(known.value), f"{modes_text(review)}{pieces}")
        self.stage.tell(Size(fact, stale=found.volume is None))

    def _found(self, what: str) -> Any:
        """The largest ball or box with the modes that it is of."""
        found = self.answers[QUESTIONS[what]].now
        return (found[0], self._asked[what][0].modes) if found and what in self._asked else None

    def save_section(self, kind: str, client: Client) -> None:
        """Save the section as a file of this kind."""
        missing = tr("section.none_to_save")
        drawn = self.answers[compute.SECTION].now
        self.save(drawn, lambda drawn: section_file(drawn, kind), client, missing)


def section_file(drawn: compute.Drawn, kind: str) -> ExportedFile:
    """A section as a file."""
    of = drawn.wish.region
    machine = machine_of(of.design)
    spec = machine.section_spec
    assert spec is not None
    axes = zip(machine.coordinates, of.pose, strict=True)
    angles = tuple((c, v) for c, v in axes if c.unit == "rad")
    name = f"{solid_name(of.design, 'section', angles, of.modes)}_at{drawn.section.at:.6g}"
    title = of.design.title or of.design.name
    data = section_bytes(drawn.section, spec, kind, title=title)
    return ExportedFile(f"{name}.{kind}", data)


def _drawn(review: Review) -> bool:
    """Whether the section's drawing lies over the scene."""
    return review[Cut].on and review.machine.section_spec is not None
