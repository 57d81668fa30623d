"""`bohemia serve` as a process: what it keeps, whom it answers, and how it ends."""

from __future__ import annotations

import random
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from math import inf, nan
from pathlib import Path

import pytest

from app.review import session
from app.review.state import new_review
from kinematics.designs.files import load_design
from tests.app.wire import CAMERA, Wire, browser, pose_in, served
from tests.conftest import Finished, command_environment, rarely

Bohemia = Callable[..., Finished]
LOST = 3.0  # s of edits that may be lost at most


def _edit(wire: Wire, seconds: float, every: float = 0.1) -> dict[float, float]:
    """Edit without a pause; when each value of x was sent."""
    sent: dict[float, float] = {}
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        x = float(300 + len(sent) % 50) + round(len(sent) / 1000, 3)
        sent[x] = time.monotonic()
        wire.put("x (mm)", x)
        wire.listen(every)
    return sent


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.slow
def test_a_kill_under_constant_editing_loses_at_most_three_seconds(
    tmp_path: Path, seed: int
) -> None:
    file = tmp_path / "review.json"
    with served(tmp_path, "--session", str(file)) as one, browser(one) as wire:
        sent = _edit(wire, random.Random(seed).uniform(3.5, 6.0))
        one.stop(signal.SIGKILL)
        killed = time.monotonic()
    kept = pose_in(file)["x"]
    assert killed - sent[kept] < LOST
    with served(tmp_path, "--session", str(file)) as again:
        assert again.stop() == 0
    assert pose_in(file)["x"] == kept
    assert {p.name for p in tmp_path.iterdir() if "log" not in p.name} == {"review.json"}


@pytest.mark.parametrize("how", ["SIGTERM", *map(rarely, ("SIGINT", "SIGHUP"))])
def test_an_end_on_request_loses_nothing(tmp_path: Path, how: str) -> None:
    file = tmp_path / "review.json"
    with served(tmp_path, "--session", str(file)) as one, browser(one) as wire:
        wire.put("x (mm)", 321.5)
        wire.listen(0.3)
        assert one.stop(signal.Signals[how]) == 0
    assert pose_in(file)["x"] == 321.5
    assert {p.name for p in tmp_path.iterdir() if "log" not in p.name} == {"review.json"}


linux = pytest.mark.skipif(sys.platform != "linux", reason="limits of another process")


@linux
@pytest.mark.slow
def test_a_disk_that_is_full_is_tried_again_until_it_is_not(tmp_path: Path) -> None:
    import resource

    file = tmp_path / "review.json"
    with served(tmp_path, "--session", str(file)) as one, browser(one) as wire:
        before = file.read_bytes()
        _, most = resource.prlimit(one.process.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(one.process.pid, resource.RLIMIT_FSIZE, (len(before) // 2, most))
        wire.put("x (mm)", 321.5)
        wire.listen(4.0)
        assert file.read_bytes() == before
        assert len([text for text in wire.told if "could not be saved" in text]) == 1
        resource.prlimit(one.process.pid, resource.RLIMIT_FSIZE, (most, most))
        wire.listen(3.0)
        assert pose_in(file)["x"] == 321.5
        assert "The session is saved again." in wire.told
        resource.prlimit(one.process.pid, resource.RLIMIT_FSIZE, (len(before) // 2, most))
        wire.put("x (mm)", 322.5)
        wire.listen(0.3)
        assert one.stop() == 1
        assert "bohemia: the last changes of the session are lost" in one.log
        assert "Traceback" not in one.log
    assert pose_in(file)["x"] == 321.5
    assert {p.name for p in tmp_path.iterdir() if "log" not in p.name} == {"review.json"}


def test_a_second_server_on_the_same_session_is_refused(tmp_path: Path, bohemia: Bohemia) -> None:
    file, link = tmp_path / "review.json", tmp_path / "link.json"
    link.symlink_to(file)
    with served(tmp_path, "--session", str(file)) as one:
        for name in (file, link):
            second = bohemia("serve", "--no-browser", "--port", "0", "--session", str(name))
            assert second.code == 2
            assert f"another Bohemia (process {one.process.pid}) keeps" in second.stderr
        assert one.process.poll() is None


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--host", "nonsense.invalid"), "there is no address 'nonsense.invalid'"),
        (("--host", ""), "--host needs an address"),
        (("--host", "192.0.2.7"), "no address of this machine"),
        (("--session", "/nonexistent/review.json"), "cannot keep a session"),
        (("--session", "/"), "session"),
        (("--allow-host", "*"), "no name of a machine"),
    ],
)
def test_what_cannot_be_is_refused_at_the_start(
    here: Bohemia, arguments: tuple[str, ...], said: str
) -> None:
    done = here("serve", "--no-browser", "--port", "0", *arguments)
    assert done.code == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_session_that_is_none_is_refused_at_the_start(tmp_path: Path, bohemia: Bohemia) -> None:
    file = tmp_path / "mine.txt"
    file.write_text("my notes", encoding="utf-8")
    done = bohemia("serve", "--no-browser", "--port", "0", "--session", str(file))
    assert (done.code, file.read_text(encoding="utf-8")) == (2, "my notes")
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]


# --- whom it answers -----------------------------------------------------------------------


def _asked(port: int, request: bytes, address: str = "127.0.0.1") -> tuple[int, str]:
    """The status of an answer and its head."""
    with socket.create_connection((address, port), timeout=20) as line:
        line.sendall(request)
        head = b""
        while b"\r\n\r\n" not in head and (more := line.recv(65536)):
            head += more
    text = head.partition(b"\r\n\r\n")[0].decode("latin-1")
    found = re.match(r"HTTP/1.1 (\d+)", text)
    return int(found[1]) if found else 0, text


def _get(port: int, host: str, path: str = "/", more: str = "") -> tuple[int, str]:
    return _asked(port, f"GET {path} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n".encode("latin-1"))


@pytest.fixture(scope="module")
def everywhere(tmp_path_factory: pytest.TempPathFactory):  # type: ignore[no-untyped-def]
    folder = tmp_path_factory.mktemp("everywhere")
    with served(folder, "--host", "0.0.0.0", "--allow-host", "lab-pc") as one:
        yield one


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("127.0.0.1:{port}", 200),
        ("localhost", 200),
        ("lab-pc:{port}", 200),
        ("evil.com", 403),
        ("evil.com:{port}", 403),
        ("192.0.2.7", 403),
        ("[", 403),
        ("]:80", 403),
        ("[::1", 403),
        ("", 403),
        ("lab-pc@evil.com", 403),
        ("127.0.0.1:http", 403),
    ],
)
def test_listening_everywhere_answers_only_to_its_own_names(
    everywhere,  # type: ignore[no-untyped-def]
    host: str,
    status: int,
) -> None:
    asked = _get(everywhere.port, host.format(port=everywhere.port), everywhere.path)
    assert asked[0] == status


def test_the_address_that_is_asked_is_answered(everywhere) -> None:  # type: ignore[no-untyped-def]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.7", 9))  # nothing is sent
        except OSError:
            pytest.skip("this machine is in no network")
        own = probe.getsockname()[0]
    request = f"GET {everywhere.path} HTTP/1.1\r\nHost: {own}\r\n\r\n".encode()
    assert _asked(everywhere.port, request, own)[0] == 200


@pytest.mark.parametrize("path", ["/", "/nothing", "/..%2f..%2fetc/passwd", "/%00", "/a?b=c"])
@pytest.mark.parametrize("host", ["127.0.0.1", "evil.com"])
def test_every_answer_says_what_it_may_do(everywhere, path: str, host: str) -> None:  # type: ignore[no-untyped-def]
    status, head = _get(everywhere.port, host, everywhere.path + path.removeprefix("/"))
    assert status in (200, 403, 404)
    assert "X-Frame-Options: DENY" in head
    assert "frame-ancestors 'none'" in head
    assert "X-Content-Type-Options: nosniff" in head


@pytest.mark.parametrize(
    "more",
    [
        "Upgrade: websocket\r\nUpgrade: websocket\r\n",
        "Origin: http://[\r\n",
        "Origin: http://127.0.0.1\r\nOrigin: http://127.0.0.1\r\n",
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: x\r\n",
        "Accept-Encoding: gzip\r\nAccept-Encoding: br\r\n",
    ],
)
def test_no_request_is_too_strange_to_be_answered(everywhere, more: str) -> None:  # type: ignore[no-untyped-def]
    assert _get(everywhere.port, "127.0.0.1", more=more)[0] in (200, 400, 403, 426)
    assert _get(everywhere.port, "127.0.0.1", "/" + "a" * 5000)[0] in (400, 403)
    assert _get(everywhere.port, "127.0.0.1", everywhere.path)[0] == 200
    assert "Traceback" not in everywhere.log


def test_what_is_no_request_leaves_no_traceback(everywhere) -> None:  # type: ignore[no-untyped-def]
    for junk in (b"\x16\x03\x01\x02\x00\x01\x00", b"hello\r\n\r\n", b"GET / HTTP/9\r\n\r\n", b""):
        with socket.create_connection(("127.0.0.1", everywhere.port), timeout=20) as line:
            line.sendall(junk)
    assert _get(everywhere.port, "127.0.0.1", everywhere.path)[0] == 200
    time.sleep(0.3)
    assert "Traceback" not in everywhere.log


# --- what browsers send --------------------------------------------------------------------


@pytest.mark.slow
def test_values_that_no_widget_can_have_are_dropped_in_few_lines(tmp_path: Path) -> None:
    file = tmp_path / "review.json"
    with served(tmp_path, "--session", str(file)) as one, browser(one) as wire:
        for label, (uuid, _) in [*wire.widgets.items()]:
            for value in (nan, inf, -inf, "NaN", "", None, [], [nan], {}, b"x", 1e308, ["a"]):
                wire.put(label, value)
            wire.send(type="GuiUpdateMessage", uuid=uuid, updates={"removed": True})
        for _ in range(100):
            wire.put("x (mm)", nan)
        wire.send(**(CAMERA | {"position": [nan, 0.0, 0.0]}))
        wire.send(type="TransformControlsUpdateMessage", name="/", wxyz=[nan] * 4, position=[0] * 3)
        for far in (1e13, 1e200):
            wire.send(
                type="TransformControlsUpdateMessage",
                name="/target",
                wxyz=[far, 0.0, 0.0, 0.0],
                position=[far, 0.0, 0.0],
                owner="",
            )
        wire.send_raw("text")
        wire.send_raw(b"\xc1")
        wire.listen(1.0)
        wire.put("x (mm)", 321.5)
        wire.listen(3.0)
        assert pose_in(file)["x"] == 321.5
        assert one.stop() == 0
        assert "Traceback" not in one.log
        lines = one.log.splitlines()
        assert 2 < len(lines) < 60
        assert all(re.match(r"dropped what|Bohemia is|\(viser\)", line) for line in lines)


@pytest.mark.slow
def test_a_long_file_that_is_read_holds_up_nobody(tmp_path: Path) -> None:
    rows = "".join(f"{n % 7},{n % 11},{300 + n % 13},0,0\n" for n in range(500_000))
    content = f"x,y,z,phi,theta\n{rows}end\n".encode()
    with served(tmp_path) as one, browser(one) as wire:
        uuid, _ = wire.widgets["Open a CSV file"]
        about = {"source_component_uuid": uuid, "transfer_uuid": "long"}
        wire.send(
            type="FileTransferStartUpload",
            filename="long.csv",
            mime_type="text/csv",
            part_count=1,
            size_bytes=len(content),
            **about,
        )
        wire.send(type="FileTransferPart", part_index=0, content=content, **about)
        longest, end = 0.0, time.monotonic() + 60.0
        while not any("long.csv, line" in text for text in wire.told):
            began = time.monotonic()
            assert began < end
            assert _get(one.port, f"127.0.0.1:{one.port}")[0] == 200
            longest = max(longest, time.monotonic() - began)
            wire.listen(0.05)
        assert longest < 1.5


# --- signals and streams -------------------------------------------------------------------

posix = pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")


@posix
@pytest.mark.parametrize(
    "where", [*map(rarely, (">&-", "2>&-", ">/dev/full", "2>/dev/full")), ">/dev/full 2>&1"]
)
def test_a_server_that_cannot_speak_ends_or_serves_without_a_traceback(
    tmp_path: Path, where: str
) -> None:
    if "full" in where and not Path("/dev/full").exists():
        pytest.skip("needs a device that is always full")
    file = tmp_path / "review.json"
    words = f"-m app serve rps-3 --no-browser --port 0 --session {file}"
    process = subprocess.Popen(
        ["sh", "-c", f'exec "{sys.executable}" {words} {where}'],
        cwd=tmp_path,
        env=command_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    # One that has nowhere to say its address ends by itself.
    threading.Timer(50.0 if where.startswith(">") else 8.0, process.terminate).start()
    out, err = process.communicate(timeout=60)
    assert "Traceback" not in out + err
    assert process.returncode == (1 if where.startswith(">") else 0)
    assert not [p for p in tmp_path.iterdir() if p.name != "review.json"]


@pytest.mark.slow
def test_a_session_of_before_is_opened_and_saved_with_its_rights(tmp_path: Path) -> None:
    real, link = tmp_path / "real.json", tmp_path / "link.json"
    session.save(new_review(load_design("rpur-table2")), real)
    real.chmod(0o664)
    link.symlink_to(real)
    with served(tmp_path, "--session", str(link)) as one, browser(one) as wire:
        wire.put("x (mm)", 12.5)
        wire.listen(0.3)
        assert one.stop() == 0
    assert link.is_symlink()
    assert real.stat().st_mode & 0o777 == 0o664
    assert pose_in(real)["x"] == 12.5
