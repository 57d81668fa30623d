"""The page inside another program, as a notebook: served by threads of it, until it is closed."""

from __future__ import annotations

import atexit
import contextlib
import io
import sys
import threading
import webbrowser
from dataclasses import replace
from html import escape

from app.admission import place
from app.loop import Page
from app.review.state import new_review
from app.server import make_server
from kinematics.mechanism import Design

HOST = "127.0.0.1"
HEIGHT = 720  # px of the frame in a notebook
PATIENCE = 60.0  # s for what is under way when it is closed


class Shown:
    """A page that is served.

    Attributes:
        url: where.
    """

    def __init__(self, page: Page) -> None:
        self.url = page.address
        self._page = page
        self._closed = False
        self._thread = threading.Thread(target=page.run, name=f"page at {self.url}", daemon=True)
        self._thread.start()
        atexit.register(self.close)

    def __repr__(self) -> str:
        return "<The page, closed>" if self._closed else f"<The page at {self.url}>"

    def _repr_html_(self) -> str:
        if self._closed:
            return "<p>The page is closed.</p>"
        look = f"width:100%;height:{HEIGHT}px;border:1px solid #888"
        return f'<iframe src="{escape(self.url)}" style="{look}" title="Bohemia"></iframe>'

    def close(self) -> None:
        """Serve it no longer."""
        if not self._closed:
            self._closed = True
            atexit.unregister(self.close)
            self._page.stop()
            self._thread.join(PATIENCE)
            with contextlib.redirect_stdout(io.StringIO()):  # viser tells what nobody asked
                self._page.server.stop()


def show(design: Design, pose: tuple[float, ...], mode: str, *, port: int = 0) -> Shown:
    """The page with a design at a pose; opened in the browser unless a notebook shows it.

    Raises:
        InputError: the port may not be used.
    """
    where = replace(place(HOST, port), framed=True)
    server = make_server(where.host, where.port, where)
    review = replace(new_review(design), pose=pose, mode=mode)
    address, aside = (where.url(server.get_port(), looks_on=on) for on in (False, True))
    shown = Shown(Page(server, review, address, None, aside))
    if "ipykernel" not in sys.modules:
        threading.Thread(target=webbrowser.open, args=(shown.url,), daemon=True).start()
    return shown
