"""Who is at the review, and under which addresses others come to it."""

from __future__ import annotations

from typing import Any

from app.language import tr
from app.review.state import Review
from app.review.view import People, Person
from app.widgets.desk import Group, Sheet
from app.widgets.texts import box, chip, esc


class PeopleFolder(Group):
    """A row for each person, and the addresses to steer and to look on."""

    def build(self, review: Review) -> None:
        with self.folder("together.people"):
            self._people = self.gui.add_html("")
            for address, what in ((self.desk.address, "steers"), (self.desk.aside, "aside")):
                if address:
                    told = tr(f"together.{what}")
                    self.gui.add_html(box(f"{told}<br><b>{esc(address)}</b>"))

    def told(self, sheet: Sheet, news: Any) -> None:
        if isinstance(news, People):
            self.say(self._people, box("<br>".join(map(_row, news.every))))


def _row(person: Person) -> str:
    words = [person.name, *[tr("together.only_looks")] * person.looks_on, person.did]
    return f"{chip(person.color)}{esc(' · '.join(filter(None, words)))}"
