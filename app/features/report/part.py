"""The report on the page: made beside the loop, of the review as it stood when it was asked for."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from typing import Any

from app.features.map.compute import MAP, of
from app.features.map.part import MapPart
from app.features.report.beside import beside_of, compared
from app.features.report.compute import Depth, gather
from app.features.report.make import Paper, report_of, written
from app.features.review.files import ExportedFile, solid_name
from app.jobs.answers import Asked, Question
from app.jobs.parts import Client, Part, Stage
from app.review.state import Review
from app.review.view import View
from kinematics.facets.map_sweeps import Map


def make(review: Review, kind: str, paper: Paper, at: datetime, chart: Map | None) -> ExportedFile:
    """The report of a review as a file; called in the process."""
    reviews, depth = beside_of(review), Depth(cells=0)
    found = [gather(each, depth, chart=chart if each is review else None) for each in reviews]
    beside = compared(reviews, depth.resolution) if len(reviews) > 1 else None
    data = written(report_of(found, at, beside), kind, paper).data
    return ExportedFile(f"{solid_name(review.design, 'report', ())}.{kind}", data)


REPORT = Question("work.report", "report", make, slow=True, urgent=True, kept=0)


class ReportPart(Part):
    """Makes one report at a time, for who asked for it."""

    LANES = ("report",)

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self._wanted: Asked[ExportedFile] | None = None
        self._client: Client = None

    def wished(self, view: View) -> Iterable[Asked[Any]]:
        if self._wanted is not None:
            yield self._wanted

    def report(self, kind: str, paper: Paper, client: Client) -> None:
        """Make a report of the review as it stands now, with the map that is there of it."""
        review = self.stage.review
        known = self.stage.part(MapPart).answers[MAP].now
        chart = None
        if known is not None and of(known.request, review) and known.done.any():
            chart = known.map()
        at = datetime.now().astimezone()
        self._wanted = REPORT((review, kind, paper, at), review, kind, paper, at, chart)
        self._client = client
        self.follow()

    def came(self, asked: Asked[Any], answer: Any) -> bool:
        self._wanted = None
        self.stage.download(answer, self._client)
        return False

    def lost(self, asked: Asked[Any]) -> None:
        self._wanted = None
