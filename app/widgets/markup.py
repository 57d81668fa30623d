"""HTML in a panel that a person can press."""

from __future__ import annotations

from collections.abc import Callable

from app.widgets.desk import Client, Desk, answer, put_prop
from app.widgets.texts import aged


class Markup:
    """HTML whose elements with ``data-send`` tell the program that they were pressed.

    Args:
        act: is called with the text of ``data-send`` and who pressed.
        label: of the hidden box, by which the server knows it.
    """

    def __init__(
        self, desk: Desk, act: Callable[[str, Client], None], label: str = "Pressed"
    ) -> None:
        self._act = act
        self._html = desk.gui.add_html(_live(""))
        # Neighbours in the page: the style hides this box, and the script finds it there.
        answer(desk, desk.gui.add_text(label, ""), self._pressed)

    def say(self, content: str, stale: bool = False) -> None:
        """Bring it to what it is to show."""
        put_prop(self._html, "content", _live(aged(content, stale)))

    def _pressed(self, text: str, client: Client) -> None:
        word, _, _ = text.rpartition(" ")
        if word:
            self._act(word, client)


def _live(content: str) -> str:
    return f'<div class="bo-live">{content}</div>'
