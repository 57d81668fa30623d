"""What leaves the page as a whole: pictures of it, and the session that is kept in a file."""

from __future__ import annotations

import json
from pathlib import Path

from app.features.review.files import ExportedFile, solid_name
from app.jobs.parts import Client, Part, Stage
from app.language import tr
from app.review.state import Options, Review
from kinematics.mechanism import Design

PICTURE = Path(__file__).with_name("picture.js")


class ReviewPart(Part):
    """Saves what people ask for, and hands each change to what keeps the session."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._seen: Review = stage.review
        if stage.keeper is not None:
            stage.keeper.tells(self._tell)

    def follow(self) -> None:
        review = self.stage.review
        if self.stage.keeper is not None and review != self._seen:
            self.stage.keeper.offer(review)
        self._seen = review

    def _tell(self, text: str) -> None:
        """Called in the thread that saves; whoever opens the page later reads it, too."""

        def told() -> bool:
            self.stage.complain(text)
            self.stage.note(text)
            return True

        self.stage.put(told)

    def picture(self, client: Client) -> None:
        """Have one browser save a picture of its view."""
        if client is None:
            self.stage.complain(tr("review.picture_of_one"))
            return
        review = self.stage.review
        given = {
            "WIDTH": 1600,
            "GROUND": "#141414" if review[Options].dark else "#FFFFFF",
            "NAME": f"{solid_name(review.design, 'view', ())}.png",
        }
        source = PICTURE.read_text(encoding="utf-8")
        for name, value in given.items():
            source = source.replace(name, json.dumps(value))
        self.stage.run_script(source, client)

    def scene_page(self, client: Client) -> None:
        """The scene as one file that anyone can open and turn."""

        def make(design: Design) -> ExportedFile:
            page = self.stage.server.scene.as_html()
            return ExportedFile(f"{solid_name(design, 'scene', ())}.html", page.encode())

        self.save(self.stage.review.design, make, client)
