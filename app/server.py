"""The web server: host, port, whom it answers, how it starts and ends."""

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
from urllib.parse import urlsplit

import viser
import viser._messages
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.loop import Page
from app.review import session as sessions
from app.review.state import new_review
from kinematics.mechanism import Design

log = logging.getLogger(__name__)

MAX_UPLOAD = 16 << 20  # bytes; the largest file that has a use here is a path in CSV
LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})


def run(design: Design, *, host: str, port: int, session: Path | None, open_browser: bool) -> None:
    """Serve a review until it is interrupted; prints the address it really has."""
    if session is not None and session.exists():
        review = sessions.load(session)
    else:
        review = new_review(design)
    server = make_server(host, port)
    address = f"http://{_for_url(host)}:{server.get_port()}"
    page = Page(server, review, address, session)
    print(f"Bohemia is at {address} (stop it with Ctrl-C)", flush=True)
    if open_browser:
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()

    def stop(_signal: int, _frame: FrameType | None) -> None:
        page.stop()

    signal.signal(signal.SIGINT, stop)
    signal.signal(signal.SIGTERM, stop)
    page.run()
    server.stop()


def make_server(host: str, port: int) -> viser.ViserServer:
    """A viser server that answers only its own page, has no share tunnel and bounds uploads."""
    # viser prints an address of its own, which is not always the one to open.
    with _guarded(host), contextlib.redirect_stdout(io.StringIO()):
        server = viser.ViserServer(host=host, port=port, verbose=False, label="Bohemia")
    connection = server._websock_server
    connection.unregister_handler(viser._messages.ShareUrlRequest)
    connection.unregister_handler(viser._messages.ShareUrlDisconnect)
    _bound_uploads(server)
    return server


@contextlib.contextmanager
def _guarded(host: str) -> Iterator[None]:
    """While inside, websocket servers are made to refuse foreign origins and foreign hosts.

    Any page in the user's browser can open a websocket to localhost and would steer this server:
    so a request must come from the very address that it goes to, and while only this machine is
    served, that address must be this machine's (a foreign name that resolves to it is refused).
    """
    original = websockets.asyncio.server.serve

    def serve(*arguments: Any, process_request: Any = None, **options: Any) -> Any:
        async def checked(connection: Any, request: Request) -> Response | None:
            refusal = refused(request.headers, loopback_only=host in LOOPBACK)
            if refusal:
                log.warning("refused a request: %s", refusal)
                return Response(http.HTTPStatus.FORBIDDEN, "Forbidden", Headers(), refusal.encode())
            if process_request is None:
                return None
            answer = process_request(connection, request)
            if inspect.isawaitable(answer):
                answer = await answer
            result: Response | None = answer
            return result

        return original(*arguments, process_request=checked, **options)

    websockets.asyncio.server.serve = serve  # type: ignore[assignment,misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = original  # type: ignore[misc]


def refused(headers: Headers, *, loopback_only: bool) -> str:
    """Why a request is refused; "" when it may pass."""
    host = headers.get("Host", "")
    if loopback_only and (urlsplit(f"//{host}").hostname or "") not in LOOPBACK:
        return "this server answers only under the address of the machine it runs on"
    origin = headers.get("Origin")
    if origin is not None and urlsplit(origin).netloc != host:
        return "this page may not be steered from another site"
    return ""


def _bound_uploads(server: viser.ViserServer) -> None:
    """Refuse uploads that announce or send more than any file of use here has.

    How far an upload has come is told to whoever sends it: viser tells all browsers, and again
    those that come later. A refused one is told to have come, else its button waits for ever.
    """
    gui: Any = server.gui
    connection: Any = server._websock_server
    start, part = viser._messages.FileTransferStartUpload, viser._messages.FileTransferPart
    acknowledged = viser._messages.FileTransferPartAck
    senders: dict[str, int] = {}  # of transfers
    queue_message = connection.queue_message

    def queued(message: Any) -> None:
        if not isinstance(message, acknowledged):
            queue_message(message)
            return
        client = server.get_clients().get(senders.get(message.transfer_uuid, -1))
        if message.transferred_bytes >= message.total_bytes:
            senders.pop(message.transfer_uuid, None)
        if client is not None:
            client._websock_connection.queue_message(message)

    async def started(client_id: int, message: Any) -> None:
        senders[message.transfer_uuid] = client_id
        if message.size_bytes <= MAX_UPLOAD and message.part_count <= MAX_UPLOAD:
            gui._handle_file_transfer_start(client_id, message)
            return
        client = server.get_clients().get(client_id)
        if client is not None:
            client.add_notification(
                "Bohemia",
                f"{message.filename} is too large: a file to open is smaller than "
                f"{MAX_UPLOAD >> 20} MB.",
                color="red",
                auto_close_seconds=12.0,
            )
        give_up(message.source_component_uuid, message.transfer_uuid, message.size_bytes)

    async def came(client_id: int, message: Any) -> None:
        state = gui._current_file_upload_states.get(message.transfer_uuid)
        if state is None:
            return
        if state["transferred_bytes"] + len(message.content) > MAX_UPLOAD:
            gui._current_file_upload_states.pop(message.transfer_uuid, None)
            source = message.source_component_uuid
            give_up(source, message.transfer_uuid, state["total_bytes"])
            return
        gui._handle_file_transfer_part(client_id, message)

    def give_up(source: str | None, transfer: str, size: int) -> None:
        queued(acknowledged(source, transfer, transferred_bytes=size, total_bytes=size))

    connection.queue_message = queued
    connection.unregister_handler(start)
    connection.unregister_handler(part)
    connection.register_handler(start, started)
    connection.register_handler(part, came)


def _for_url(host: str) -> str:
    shown = "127.0.0.1" if host in {"0.0.0.0", "::", ""} else host
    return f"[{shown}]" if ":" in shown else shown
