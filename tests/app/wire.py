"""A served page without a browser: the process, and its websocket as viser's client speaks it."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import msgspec
import viser
import zstandard
from websockets.sync.client import ClientConnection, connect

from tests.conftest import command_environment

PATIENCE = 60.0  # s; only a hang is caught by it


class Served:
    """A running `bohemia serve`."""

    def __init__(self, process: subprocess.Popen[str], log: Path) -> None:
        self.process, self._log = process, log
        self.address = ""

    @property
    def log(self) -> str:
        return self._log.read_text(encoding="utf-8")

    @property
    def port(self) -> int:
        return int(str(urlsplit(self.address).port))

    @property
    def path(self) -> str:
        """With which what is asked of it begins: "/", or a key that is its own."""
        return urlsplit(self.address).path or "/"

    @property
    def aside(self) -> str:
        """The address of those who only look on."""
        found = re.search(r"Who opens (\S+)", self.log)
        assert found is not None, self.log
        return found[1]

    def stop(self, how: signal.Signals = signal.SIGTERM) -> int:
        self.process.send_signal(how)
        return self.process.wait(PATIENCE)


@contextmanager
def served(folder: Path, *arguments: str) -> Iterator[Served]:
    """`bohemia serve` with these arguments, until the block ends."""
    log = folder / f"serve{len([*folder.glob('serve*.log')])}.log"
    with log.open("w", encoding="utf-8") as output:
        process = subprocess.Popen(
            [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0", *arguments],
            cwd=folder,
            env=command_environment() | {"PYTHONUNBUFFERED": "1"},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            text=True,
        )
    one = Served(process, log)
    try:
        end = time.monotonic() + PATIENCE
        while (found := re.search(r"http://\S+", one.log)) is None:
            assert process.poll() is None, one.log
            assert time.monotonic() < end, one.log
            time.sleep(0.05)
        one.address = found[0]
        yield one
    finally:
        process.kill()
        process.wait()


CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [0.0, -900.0, 400.0],
    "fov": 0.8,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": [0.0, 0.0, 300.0],
    "up_direction": [0.0, 0.0, 1.0],
}


class Wire:
    """One browser's end of the websocket; widgets by their labels."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection
        self.widgets: dict[str, tuple[str, Any]] = {}
        self.told: list[str] = []
        self.nodes: dict[str, Any] = {}  # of the scene

    def send(self, **message: Any) -> None:
        self._connection.send(msgspec.msgpack.encode(message))

    def send_raw(self, data: bytes | str) -> None:
        self._connection.send(data)

    def put(self, label: str, value: Any) -> None:
        """A new value of a widget."""
        uuid, _ = self.widgets[label]
        self.send(type="GuiUpdateMessage", uuid=uuid, updates={"value": value})

    def listen(self, seconds: float) -> None:
        """Take in what comes."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            try:
                data = self._connection.recv(timeout=left)
            except TimeoutError:
                return
            assert isinstance(data, bytes)
            size = int.from_bytes(data[8:16], "little")
            content = msgspec.msgpack.decode(
                zstandard.ZstdDecompressor().decompress(data[16 : 16 + size])
            )
            for message in content["messages"]:
                props = message.get("props") or {}
                label = props.get("label")
                if "name" in message and props:
                    self.nodes[message["name"]] = props
                if message["type"].startswith("Gui") and isinstance(label, str):
                    self.widgets.setdefault(label, (message["uuid"], message.get("value")))
                if message["type"] == "NotificationShowMessage" or "body" in props:
                    self.told.append(str(props.get("body", "")))


@contextmanager
def browser(one: Served, address: str = "") -> Iterator[Wire]:
    """A browser that has opened the page, or another address of it."""
    asked = urlsplit(address or one.address)
    with connect(
        f"ws://{asked.netloc}{asked.path}",
        origin=f"http://{asked.netloc}",  # type: ignore[arg-type]
        subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
        max_size=None,
        compression=None,
    ) as connection:
        wire = Wire(connection)
        end = time.monotonic() + PATIENCE
        while "Fit the view" not in wire.widgets:  # of the last tab
            assert time.monotonic() < end
            wire.listen(0.1)
        wire.send(**CAMERA)
        wire.listen(0.5)
        yield wire


def pose_in(file: Path) -> dict[str, float]:
    """The pose that a session file holds, whatever else happens to it."""
    pose: dict[str, float] = json.loads(file.read_text(encoding="utf-8"))["pose"]
    return pose
