"""What leaves the page as a whole: pictures of it, and the session that is kept in a file."""

from __future__ import annotations

import time
from typing import Any

from app.features.review.files import ExportedFile, solid_name
from app.jobs.parts import Client, Part, Stage
from app.review import session
from app.review.state import Review
from kinematics.errors import InputError
from kinematics.mechanism import Design

SETTLED = 0.8  # s without a change before the session is saved


class ReviewPart(Part):
    """Saves what people ask for, and the session once a change has settled."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._saved: Review = stage.review
        self._seen: Review = stage.review
        self._changed_at = 0.0

    def follow(self) -> None:
        review = self.stage.review
        if review != self._seen:
            self._seen, self._changed_at = review, time.monotonic()

    def catch_up(self) -> None:
        if self._seen != self._saved and time.monotonic() - self._changed_at > SETTLED:
            self._save()

    def stop(self) -> None:
        self._save()

    def _save(self) -> None:
        review, file = self.stage.review, self.stage.session_file
        if file is None or review == self._saved:
            return
        self._saved = review
        try:
            session.save(review, file)
        except InputError as error:
            self.stage.complain(f"The session could not be saved: {error}")

    def picture(self, client: Client) -> None:
        """A picture of one browser's view."""

        def make(client: Any) -> ExportedFile:
            import imageio.v3 as iio

            camera = client.camera
            scale = max(1.0, 1600.0 / max(camera.image_width, 1))
            height, width = int(camera.image_height * scale), int(camera.image_width * scale)
            image = client.get_render(height, width, transport_format="png")
            name = f"{solid_name(self.stage.review.design, 'view', ())}.png"
            return ExportedFile(name, iio.imwrite("<bytes>", image, extension=".png"))

        missing = "a picture is taken of one browser's view; press the button there"
        self.save(client, make, client, missing)

    def scene_page(self, client: Client) -> None:
        """The scene as one file that anyone can open and turn."""

        def make(design: Design) -> ExportedFile:
            page = self.stage.server.scene.as_html()
            return ExportedFile(f"{solid_name(design, 'scene', ())}.html", page.encode())

        self.save(self.stage.review.design, make, client)
