"""Several people at one review: keys of addresses, looking on, and where others point."""

from __future__ import annotations

import time
from pathlib import Path
from types import SimpleNamespace

import msgspec
import pytest

from app.admission import OPEN, Keys, place
from app.incoming import Sifted
from app.scene.pointer import POINTER, PRESSED
from tests.app.wire import PATIENCE, Wire, browser, pose_in, served

KEYS = Keys("steering", "looking")


@pytest.mark.parametrize(
    ("keys", "path", "read"),
    [
        (OPEN, "/", (False, "/")),
        (OPEN, "/some/file.js?x=1", (False, "/some/file.js?x=1")),
        (OPEN, "/look", (True, "/")),
        (OPEN, "/look/", (True, "/")),
        (OPEN, "/look?x=1", (True, "/?x=1")),
        (OPEN, "/look/a/b", (True, "/a/b")),
        (OPEN, "/lookout", (False, "/lookout")),
        (KEYS, "/steering", (False, "/")),
        (KEYS, "/steering/a?b", (False, "/a?b")),
        (KEYS, "/looking/", (True, "/")),
        (KEYS, "/", None),
        (KEYS, "/look/", None),
        (KEYS, "/steerin", None),
        (KEYS, "/steering2/", None),
        (KEYS, "//steering/", None),
        (KEYS, "/stéering/", None),
    ],
)
def test_keys_are_read_from_paths(keys: Keys, path: str, read: tuple[bool, str] | None) -> None:
    assert keys.read(path) == read


def test_only_a_network_needs_a_key_and_each_start_has_its_own() -> None:
    assert place("127.0.0.1", 0).keys == OPEN
    one, other = (place("0.0.0.0", 0) for _ in range(2))
    every = {one.keys.steer, one.keys.look, other.keys.steer, other.keys.look}
    assert len(every) == 4
    assert min(map(len, every)) >= 20
    assert one.url(80) == f"http://127.0.0.1:80/{one.keys.steer}/"
    assert one.url(80, looks_on=True) == f"http://127.0.0.1:80/{one.keys.look}/"


def _wait(wire: Wire, what: object) -> None:
    end = time.monotonic() + PATIENCE
    while not what():  # type: ignore[operator]
        assert time.monotonic() < end
        wire.listen(0.1)


def test_who_looks_on_points_and_does_not_click() -> None:
    undone: list[object] = []
    sifted = Sifted(None, lambda _: SimpleNamespace(label=POINTER, value=""))
    for text, passes in (("0 400 300 12.5", True), (f"0 400 300 {PRESSED} 12.5", False)):
        content = {"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": text}}
        data = msgspec.msgpack.encode(content)
        assert sifted._harmless(data, lambda *of: undone.append(of)) == passes
    assert not undone


def test_who_looks_on_changes_nothing_and_is_seen(tmp_path: Path) -> None:
    file = tmp_path / "review.json"
    with (
        served(tmp_path, "--session", str(file)) as one,
        browser(one) as steers,
        browser(one, one.aside) as looks,
    ):
        looks.put("φ (°)", 20.0)
        looks.put("x (mm)", 99.0)
        looks.send(
            type="GuiUpdateMessage", uuid=looks.widgets["Dark page"][0], updates={"value": True}
        )
        looks.put("Pointer", "0 400 300 1")
        _wait(steers, lambda: "/people/2/name" in steers.nodes)
        assert steers.nodes["/people/2/name"]["text"] == "Person 2"
        assert "/people/1/name" not in steers.nodes
        steers.put("θ (°)", 5.0)
        steers.put("Pointer", "0 500 300 2")
        _wait(looks, lambda: "/people/1/name" in looks.nodes)
        steers.listen(0.5)
    pose = pose_in(file)
    assert (pose["phi_deg"], pose["theta_deg"]) == pytest.approx((0.0, 5.0), abs=1e-9)
    assert pose["x"] != pytest.approx(99.0)
    assert '"dark": true' not in file.read_text(encoding="utf-8")
    assert "dropped" not in one.log
