"""Whom the server answers: its own page and nobody else's."""

from __future__ import annotations

import http.client
from collections.abc import Iterator
from types import SimpleNamespace

import pytest
import viser
import viser._messages as messages
from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from app.admission import LOOPBACK, refused
from app.incoming import MAX_UPLOAD
from app.server import make_server


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    served = make_server("127.0.0.1", 0)
    yield served
    served.stop()


def _protocol() -> list[str]:
    return [f"viser-v{viser.__version__}"]


def _get(server: viser.ViserServer, headers: dict[str, str]) -> int:
    connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=10)
    connection.request("GET", "/", headers=headers)
    status = connection.getresponse().status
    connection.close()
    return status


def test_it_listens_on_this_machine_only(server: viser.ViserServer) -> None:
    sockets = server._websock_server._port
    assert sockets == server.get_port()
    assert server.get_host() == "127.0.0.1"


def test_the_page_is_served_under_this_machines_names(server: viser.ViserServer) -> None:
    port = server.get_port()
    assert _get(server, {"Host": f"127.0.0.1:{port}"}) == 200
    assert _get(server, {"Host": f"localhost:{port}"}) == 200
    assert _get(server, {"Host": f"[::1]:{port}"}) == 200


def test_a_foreign_name_that_resolves_here_is_refused(server: viser.ViserServer) -> None:
    assert _get(server, {"Host": "evil.example"}) == 403
    assert _get(server, {"Host": f"127.0.0.1.evil.example:{server.get_port()}"}) == 403


def test_a_foreign_page_cannot_open_the_websocket(server: viser.ViserServer) -> None:
    address = f"ws://127.0.0.1:{server.get_port()}"
    for origin in ("https://evil.example", "null", f"http://localhost:{server.get_port() + 1}"):
        with pytest.raises(InvalidStatus) as caught:
            connect(address, origin=origin, subprotocols=_protocol())  # type: ignore[arg-type]
        assert caught.value.response.status_code == 403
    own = f"http://127.0.0.1:{server.get_port()}"
    with connect(address, origin=own, subprotocols=_protocol()):  # type: ignore[arg-type]
        pass


def test_there_is_no_share_tunnel(server: viser.ViserServer) -> None:
    handlers = server._websock_server._incoming_handlers
    assert messages.ShareUrlRequest not in handlers
    assert messages.ShareUrlDisconnect not in handlers


@pytest.mark.parametrize(
    ("host", "origin", "loopback", "passes"),
    [
        ("localhost:8080", None, True, True),
        ("localhost:8080", "http://localhost:8080", True, True),
        ("localhost:8080", "http://127.0.0.1:8080", True, False),
        ("lab.example:8080", "http://lab.example:8080", True, False),
        ("lab.example:8080", "http://lab.example:8080", False, True),
        ("lab.example:8080", "http://evil.example", False, False),
        ("", None, True, False),
        ("localhost:8080", "null", True, False),
    ],
)
def test_who_is_refused(host: str, origin: str | None, loopback: bool, passes: bool) -> None:
    headers = Headers()
    if host:
        headers["Host"] = host
    if origin is not None:
        headers["Origin"] = origin
    names = LOOPBACK if loopback else {"lab.example"}
    assert (refused(headers, names) == "") is passes


def test_large_uploads_are_not_even_begun(
    server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    gui = server.gui
    button = gui.add_upload_button("file")
    start = server._websock_server._incoming_handlers[messages.FileTransferStartUpload]
    part = server._websock_server._incoming_handlers[messages.FileTransferPart]
    assert len(start) == len(part) == 1

    def begin(uuid: str, size: int, parts: int) -> None:
        announced = messages.FileTransferStartUpload(
            source_component_uuid=button._impl.uuid,
            transfer_uuid=uuid,
            filename="a.toml",
            mime_type="text/plain",
            part_count=parts,
            size_bytes=size,
        )
        _finish(start[0](0, announced))  # type: ignore[arg-type]

    def send(uuid: str, index: int, content: bytes) -> None:
        piece = messages.FileTransferPart(
            source_component_uuid=button._impl.uuid,
            transfer_uuid=uuid,
            part_index=index,
            content=content,
        )
        _finish(part[0](0, piece))  # type: ignore[arg-type]

    told: list[messages.FileTransferPartAck] = []
    browser = SimpleNamespace(
        add_notification=lambda *_, **__: None,
        _websock_connection=SimpleNamespace(queue_message=told.append),
    )
    monkeypatch.setattr(server, "get_clients", lambda: {0: browser})
    begin("honest", MAX_UPLOAD, 2)
    begin("large", MAX_UPLOAD + 1, 2)
    begin("many", 10, MAX_UPLOAD + 1)
    assert list(gui._current_file_upload_states) == ["honest"]
    # One that sends more than it announces is dropped on the way.
    send("honest", 0, b"x" * MAX_UPLOAD)
    send("honest", 1, b"x")
    assert "honest" not in gui._current_file_upload_states
    # Whoever sent it is told that it is over, else its button would wait for ever; nobody else is.
    done = [ack.transfer_uuid for ack in told if ack.transferred_bytes == ack.total_bytes]
    assert done == ["large", "many", "honest"]
    buffer = server._websock_server.get_message_buffer()
    kept = buffer.message_from_id.values()
    assert not any(isinstance(message, messages.FileTransferPartAck) for message in kept)


def _finish(coroutine: object) -> None:
    try:
        coroutine.send(None)  # type: ignore[attr-defined]
    except StopIteration:
        return
    raise AssertionError("the handler waited for something")
