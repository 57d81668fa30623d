"""What leaves the page as a whole: pictures of it, and the session that is kept in a file."""

from __future__ import annotations

from typing import Any

from app.features.review.files import ExportedFile, solid_name
from app.jobs.parts import Client, Part, Stage
from app.review.state import Review
from kinematics.mechanism import Design


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
