"""What browsers send, looked at before viser sees it: what cannot be used is dropped.

viser takes a widget's value as it comes, casts it by force and prints a traceback where that fails;
and it lets whoever sends it set other attributes of a widget than its value.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterable
from typing import Any

import msgspec
import viser
import viser._messages as messages

from app.scene.pointer import POINTER, PRESSED

log = logging.getLogger(__name__)

MAX_UPLOAD = 16 << 20  # bytes; the largest file that has a use here is a path in CSV
REASONS = 50  # that are logged of one browser
FARTHEST = 1e12  # mm, of anything in the scene

Find = Callable[[str], Any]
"""From a widget's uuid to its handle, None where there is none (any more)."""
Undo = Callable[[Any, Any], None]
"""Gives a connection back what a widget, by its handle, has."""
SEEN = (messages.ViewerCameraMessage, messages.GetRenderResponseMessage)
"""What even those send who only look on; beside where their pointer is."""


class Sifted:
    """A websocket connection that hands on only what can be used; one line is logged of the rest.

    Each reason is logged once for a browser: what repeats says nothing new.

    Args:
        undo: of a browser that only looks on: what it has changed in itself is undone there.
    """

    def __init__(self, connection: Any, find: Find, undo: Undo | None = None) -> None:
        self._connection, self._find, self._undo = connection, find, undo
        self.looks_on = undo is not None
        self._said: set[str] = set()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)

    async def recv(self) -> bytes:
        """The next message that viser can take."""
        while True:
            data = await self._connection.recv()
            problem = fault(data, self._find)
            if not problem and (self._undo is None or self._harmless(data, self._undo)):
                return bytes(data)
            if not problem:
                continue
            if problem not in self._said and len(self._said) < REASONS:
                self._said.add(problem)
                log.warning("dropped what a browser sent: %s", problem)

    def _harmless(self, data: bytes, undo: Undo) -> bool:
        """Whether it changes nothing but what its sender sees."""
        content = msgspec.msgpack.decode(data)
        kind = messages.Message._subclass_from_type_string()[content["type"]]
        if kind is not messages.GuiUpdateMessage:
            return issubclass(kind, SEEN)
        handle = self._find(content["uuid"])
        if getattr(handle, "label", "") == POINTER:  # a click does something
            return PRESSED not in str(content["updates"].get("value"))
        if handle is not None:
            undo(self, handle)
        return False


def looks_on(server: viser.ViserServer, client_id: int) -> bool:
    """Whether a browser only looks on."""
    live = server._websock_server._live_connections.get(client_id)
    return bool(getattr(live, "looks_on", False))


def give_back(server: viser.ViserServer, connection: Any, handle: Any) -> None:
    """Have a browser show again what a widget has."""
    connections = server._websock_server._live_connections
    who = next((n for n, live in connections.items() if live is connection), None)
    client = None if who is None else server.get_clients().get(who)
    if client is not None:
        again = messages.GuiUpdateMessage(handle._impl.uuid, {"value": handle.value})
        client._websock_connection.queue_message(again)


def fault(data: object, find: Find) -> str:
    """Why a message cannot be used, "" where it can."""
    if not isinstance(data, bytes):
        return "text where a message should be"
    try:
        content = msgspec.msgpack.decode(data)
    except (msgspec.DecodeError, ValueError, RecursionError):
        return "bytes that are no message"
    kind = content.pop("type", None) if isinstance(content, dict) else None
    known = messages.Message._subclass_from_type_string()
    shape = known.get(kind) if isinstance(kind, str) else None
    if shape is None:
        return "a message of no known kind"
    try:
        message: Any = msgspec.convert(content, shape)
    except (msgspec.ValidationError, TypeError, ValueError, RecursionError):
        return f"a {shape.__name__} that is none"
    if any(name not in shape.__dataclass_fields__ for name in content):
        return f"a {shape.__name__} that is none"
    if not all(map(math.isfinite, _numbers(content.values()))):
        return f"a {shape.__name__} with a number that is not finite"
    if isinstance(message, messages.GuiUpdateMessage):
        return _widget_fault(message.updates, find(message.uuid))
    if not all(abs(number) <= FARTHEST for number in _numbers(content.values())):
        return f"a {shape.__name__} with a number that is no place"
    if not 0.5 < math.hypot(*getattr(message, "wxyz", (1.0,))) < 2.0:
        return f"a {shape.__name__} with an orientation that is none"
    return ""


def _numbers(values: Iterable[Any]) -> Iterable[float]:
    """The numbers in what was decoded; it nests no deeper than msgspec decodes."""
    left = [*values]
    while left:
        value = left.pop()
        if isinstance(value, float):
            yield value
        elif isinstance(value, list):
            left.extend(value)
        elif isinstance(value, dict):
            left.extend(value.values())


def _widget_fault(updates: dict[str, Any], handle: Any) -> str:
    """What is wrong with the new value of a widget; of one that is gone viser takes none."""
    if handle is None:
        return ""
    name = getattr(handle, "label", "") or type(handle).__name__
    if [*updates] != ["value"]:
        return f"something else than a value for {name!r}"
    if not _fits(updates["value"], handle.value):
        return f"a value that {name!r} cannot have"
    options = getattr(handle, "options", None)
    if options is not None and updates["value"] not in options:
        return f"a choice that {name!r} does not have"
    return ""


def _fits(value: Any, present: Any) -> bool:
    """Whether a value can be had where another one stands."""
    if isinstance(present, bool):
        return isinstance(value, bool)
    if isinstance(present, int | float):  # the browser has one kind of number
        return _is_number(value)
    if isinstance(present, str):
        return isinstance(value, str) and len(value) <= MAX_UPLOAD
    if isinstance(present, tuple):
        return (
            isinstance(value, list)
            and len(value) == len(present)
            and all(_fits(one, other) for one, other in zip(value, present, strict=True))
        )
    return False


def _is_number(value: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) < 1e300


def bound_uploads(server: viser.ViserServer) -> None:
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
