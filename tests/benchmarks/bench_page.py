"""From a slider's event, of φ and of θ, to the new solid on the wire; memory over many updates; the
first solid.

Run apart (`make bench`). Times are this machine's; what is compared is measured in one run.
"""

from __future__ import annotations

import os
import queue
import re
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path

import viser
from websockets.sync.client import connect

from app.features.move.state import Move
from app.features.workspace.compute import Built, Solids
from app.features.workspace.part import SolidsPart
from app.features.workspace.state import ChooseModes
from app.loop import Page
from app.review.state import new_review
from app.review.view import View
from app.server import make_server
from kinematics.designs.files import load_design

MOVES = 200
UPDATES = 2000


class Watched(Page):
    """A page that notes when a solid of which orientation had been handed to the wire."""

    def __init__(self, server: viser.ViserServer, name: str) -> None:
        super().__init__(server, new_review(load_design(name)), "bench", None)
        self.sent: queue.Queue[tuple[Built, str, float]] = queue.Queue()
        self.handed: dict[tuple[float, ...], float] = {}  # when the machine was taken for sending

    def _hand_over(self) -> None:
        super()._hand_over()
        self.handed.setdefault(self.view.review.pose[3:], time.perf_counter())

    def tell(self, news: object, view: View | None = None) -> None:
        super().tell(news, view)
        if isinstance(news, Solids):
            now = time.perf_counter()
            for built in news.built.values():
                self.sent.put((built, built.resolution, now))

    def wait(self, resolution: str, angle: float, axis: int = 3) -> tuple[float, Built]:
        """When the solid at this φ (or θ, axis 4) and of this resolution was sent."""
        while True:
            built, got, when = self.sent.get(timeout=60)
            if got == resolution and built.wish.what[axis - 1] == angle:
                return when, built


def figures(label: str, times: list[float]) -> None:
    """Median, 95 % and worst, in ms."""
    ordered = sorted(1e3 * t for t in times)
    print(
        f"{label:<42} median {statistics.median(ordered):7.1f} ms   95 % "
        f"{ordered[int(0.95 * (len(ordered) - 1))]:7.1f} ms   worst {ordered[-1]:7.1f} ms"
    )


def memory(pid: int) -> float:
    """Resident memory of a process, MB."""
    text = Path(f"/proc/{pid}/status").read_text()
    found = re.search(r"VmRSS:\s+(\d+) kB", text)
    return int(found[1]) / 1024 if found else float("nan")


def first_solid() -> None:
    """From the command to the first solid that a browser could draw."""
    begun = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "serve", "--no-browser", "--port", "0"],
        stdout=subprocess.PIPE,
        encoding="utf-8",
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    assert process.stdout is not None
    address = None
    while address is None:
        address = re.search(r"http://([\w.:]+)", process.stdout.readline())
    at_address = time.perf_counter() - begun
    protocol = [f"viser-v{viser.__version__}"]
    with connect(f"ws://{address[1]}", subprotocols=protocol, max_size=None) as socket:  # type: ignore[arg-type]
        size = 0
        while size < 15_000:  # the machine's parts are small; the solid's arrays are not
            size = len(socket.recv(timeout=60))
    print(
        f"{'from `bohemia` to its address':<42} {at_address:7.2f} s\n"
        f"{'from `bohemia` to the first solid':<42} {time.perf_counter() - begun:7.2f} s"
    )
    process.terminate()
    process.wait()


def stalls(page: Watched, seconds: float) -> list[float]:
    """How late a heartbeat on the event loop, which serves every client, comes."""
    loop = page.server.get_event_loop()
    late: list[float] = []
    done = threading.Event()
    end = time.perf_counter() + seconds

    def beat(due: float) -> None:
        now = time.perf_counter()
        late.append(now - due)
        if now > end:
            done.set()
        else:
            loop.call_later(0.005, beat, now + 0.005)

    loop.call_soon_threadsafe(beat, time.perf_counter())
    n = 0
    while not done.is_set():
        n += 1
        page.send(Move(3, 0.4 + 1e-3 * (n % 300)))
        time.sleep(0.05 if n % 40 else 1.2)  # drags with rests, so that fine solids come too
    return late


def main() -> None:
    """Print everything."""
    first_solid()
    for name in sys.argv[1:] or ("rpur-table1", "rpur-table2"):
        page = Watched(make_server("127.0.0.1", 0), name)
        thread = threading.Thread(target=page.run)
        thread.start()
        page.wait("fine", page._history.present.pose[3])
        for modes, off in (("current", 1e-7), ("all", 2e-7)):
            page.send(ChooseModes(modes))
            for axis, symbol in ((3, "φ"), (4, "θ")):
                machine, preview = [], []
                for n in range(MOVES):
                    angle = -0.2 + 0.002 * n + off
                    begun = time.perf_counter()
                    page.send(Move(axis, angle))
                    preview.append(page.wait("preview", angle, axis)[0] - begun)
                    machine.append(page.handed[page.review.pose[3:]] - begun)
                figures(f"{name}, {modes}, {symbol}: event to machine", machine)
                figures(f"{name}, {modes}, {symbol}: to preview solid", preview)
            page.send(Move(4, 0.0))
        for resolution, delay in (("normal", 0.15), ("fine", 0.7)):
            times = []
            for n in range(20 if resolution == "normal" else 10):
                phi = 0.011 * n + (0.5 if resolution == "normal" else 0.7)
                begun = time.perf_counter()
                page.send(Move(3, phi))
                times.append(page.wait(resolution, phi)[0] - begun - delay)
            figures(f"{name}: {resolution} solid, after the rest", times)
        late = stalls(page, 12.0)
        figures(f"{name}: lateness of the event loop", late)
        if name == "rpur-table1":
            lanes = page.part(SolidsPart).lanes.values()
            pids = [os.getpid(), *(lane.pid for lane in lanes if lane.pid)]
            for n in range(UPDATES + 1):
                page.send(Move(3, 1e-4 * n))
                time.sleep(0.012)
                if n in (UPDATES // 4, UPDATES):
                    shown = ", ".join(f"{memory(pid):.0f}" for pid in pids)
                    print(f"memory after {n:>4} updates, server and lanes    {shown} MB")
        page.stop()
        thread.join()
        page.server.stop()


if __name__ == "__main__":
    main()
