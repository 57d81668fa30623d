"""The web server: how it starts and ends, and what stands between it and viser."""

from __future__ import annotations

import contextlib
import http
import inspect
import io
import logging
import signal
import threading
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import viser
import viser._messages
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.admission import LOOPBACK, OPEN, Keys, Place, arrived_at, place, policies, refused
from app.incoming import Sifted, bound_uploads, give_back
from app.loop import Page
from app.review.keeping import Keeper
from app.review.state import new_review
from kinematics.errors import ComputationError
from kinematics.mechanism import Design

log = logging.getLogger(__name__)
connections = logging.getLogger(f"{__name__}.connections")


def run(
    design: Design,
    *,
    host: str,
    port: int,
    session: Path | None,
    open_browser: bool,
    allowed: tuple[str, ...] = (),
) -> None:
    """Serve a review until it is interrupted; prints the address it really has.

    Args:
        allowed: names beside its own address under which the server answers.

    Raises:
        InputError: it cannot listen there, or the session cannot be kept.
        ComputationError: the last change could not be saved.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # until the page takes over
    where = place(host, port, allowed)
    keeper = None if session is None else Keeper(session)
    try:
        review = None if keeper is None else keeper.load()
        if review is None:
            review = new_review(design)
        if keeper is not None:
            keeper.begin(review)
        server = make_server(where.host, where.port, where)
        address, aside = (where.url(server.get_port(), looks_on=on) for on in (False, True))
        page = Page(server, review, address, keeper, aside)
        _stopped_by_signals(page)
        print(f"Bohemia is at {address} (stop it with Ctrl-C)", flush=True)
        print(f"Who opens {aside} looks on and changes nothing", flush=True)
        if open_browser:
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        page.run()
        server.stop()
    finally:
        failure = "" if keeper is None else keeper.close()
    if failure:
        raise ComputationError(f"the last changes of the session are lost: {failure}")


def _stopped_by_signals(page: Page) -> None:
    def stop(_signal: int, _frame: FrameType | None) -> None:
        page.stop()

    signal.signal(signal.SIGINT, stop)
    signal.signal(signal.SIGTERM, stop)
    hangup = getattr(signal, "SIGHUP", None)  # the terminal is closed
    if hangup is not None and signal.getsignal(hangup) is not signal.SIG_IGN:  # as by nohup
        signal.signal(hangup, stop)


def make_server(host: str, port: int, where: Place | None = None) -> viser.ViserServer:
    """A viser server that answers only its own page, has no share tunnel and bounds uploads.

    Args:
        where: whom it answers; this machine alone if not given.
    """
    names, keys = (LOOPBACK, OPEN) if where is None else (where.names, where.keys)
    made: list[viser.ViserServer] = []

    def find(uuid: str) -> Any:
        handles: dict[str, Any] = made[0].gui._gui_input_handle_from_uuid if made else {}
        return handles.get(uuid)

    def undo(connection: Any, handle: Any) -> None:
        give_back(made[0], connection, handle)

    # viser prints an address of its own, which is not always the one to open.
    framed = where is not None and where.framed
    with _guarded(names, keys, find, undo, framed), contextlib.redirect_stdout(io.StringIO()):
        server = viser.ViserServer(host=host, port=port, verbose=False, label="Bohemia")
    made.append(server)
    connection = server._websock_server
    connection.unregister_handler(viser._messages.ShareUrlRequest)
    connection.unregister_handler(viser._messages.ShareUrlDisconnect)
    bound_uploads(server)
    return server


class _Quiet(logging.Filter):
    """What strangers do wrong is no fault of this program: a line, and no traceback."""

    def filter(self, record: logging.LogRecord) -> bool:
        if record.exc_info:
            record.msg, record.args = f"{record.getMessage()}: {record.exc_info[1]}", ()
            record.exc_info = record.exc_text = None
        return not record.getMessage().startswith(("opening handshake failed", "connection rej"))


connections.addFilter(_Quiet())


NO_KEY = "This review is opened by its whole address, as it was printed when it was started."


@contextlib.contextmanager
def _guarded(
    names: frozenset[str], keys: Keys, find: Any, undo: Any, framed: bool
) -> Iterator[None]:
    """While inside, websocket servers are made to answer only where they are meant to be asked.

    See `app.admission` for who is answered, and `app.incoming` for what is taken of them.
    """
    original = websockets.asyncio.server.serve

    def serve(handler: Any, *arguments: Any, process_request: Any = None, **options: Any) -> Any:
        async def checked(connection: Any, request: Request) -> Response | None:
            own = names | {arrived_at(connection.local_address)}
            refusal = refused(request.headers, own)
            if refusal:
                log.warning("refused a request: %s", refusal)
                return _answer(http.HTTPStatus.FORBIDDEN, refusal, "")
            host, asked = request.headers["Host"], keys.read(request.path)
            if asked is None:
                return _answer(http.HTTPStatus.FORBIDDEN, NO_KEY, host)
            if process_request is None:
                return None
            try:
                answer = process_request(connection, Request(asked[1], request.headers))
                if inspect.isawaitable(answer):
                    answer = await answer
            except (OSError, ValueError, LookupError) as error:
                log.warning("a request that cannot be answered: %s", error)
                return _answer(http.HTTPStatus.BAD_REQUEST, "This cannot be answered.", host)
            result: Response | None = answer
            if result is not None:
                for name, what in policies(host, framed=framed).items():
                    result.headers[name] = what
            return result

        async def sifted(connection: Any) -> None:
            looks_on, _ = keys.read(connection.request.path) or (True, "")
            await handler(Sifted(connection, find, undo if looks_on else None))

        return original(sifted, *arguments, process_request=checked, logger=connections, **options)

    websockets.asyncio.server.serve = serve  # type: ignore[assignment,misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = original  # type: ignore[misc]


def _answer(status: http.HTTPStatus, text: str, host: str) -> Response:
    body = text.encode()
    headers = Headers(
        {"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))}
        | policies(host)
    )
    return Response(status.value, status.phrase, headers, body)
