"""What browsers send: nothing but what a widget can have comes through."""

from __future__ import annotations

import asyncio
import logging
from math import inf, nan
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.incoming import REASONS, Sifted, fault
from tests.app.wire import CAMERA

WIDGETS = {
    "number": SimpleNamespace(label="φ (°)", value=1.5),
    "count": SimpleNamespace(label="n", value=3),
    "switch": SimpleNamespace(label="Ghosts", value=False),
    "text": SimpleNamespace(label="Name", value="a"),
    "menu": SimpleNamespace(label="Sort by", value="a", options=("a", "b")),
    "span": SimpleNamespace(label="From, to", value=(0.0, 1.0)),
    "upload": SimpleNamespace(label="Open", value=SimpleNamespace(name="", content=b"")),
}


def _widget(uuid: str, updates: Any) -> bytes:
    message = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": updates}
    return msgspec.msgpack.encode(message)


@pytest.mark.parametrize(
    ("uuid", "value"),
    [
        ("number", 2),
        ("number", -1e9),
        ("count", 4),
        ("count", 4.0),
        ("switch", True),
        ("text", "anything"),
        ("menu", "b"),
        ("span", [0, 2.5]),
        ("gone", "whatever"),
    ],
)
def test_what_a_widget_can_have_comes_through(uuid: str, value: Any) -> None:
    assert fault(_widget(uuid, {"value": value}), WIDGETS.get) == ""


BAD = [nan, inf, -inf, 1e301, "nan", "3", "", None, [], [1.0], {}, {"a": 1}, b"1"]


@pytest.mark.parametrize("value", [*BAD, True, 10**18 * 10])
@pytest.mark.parametrize("uuid", ["number", "count"])
def test_no_number_is_made_of_anything_else(uuid: str, value: Any) -> None:
    told = fault(_widget(uuid, {"value": value}), WIDGETS.get)
    assert told or value == 10**19


@pytest.mark.parametrize(
    ("uuid", "value"),
    [
        *(("switch", value) for value in (*BAD, 1, 0)),
        *(("text", value) for value in (nan, 3, None, ["a"], True)),
        *(("menu", value) for value in ("c", "", 3, None, ["a"], nan)),
        *(("span", value) for value in ([nan, 1.0], [1.0], [1, 2, 3], "ab", ["a", "b"], 3.0)),
        *(("upload", value) for value in ("a", {"name": "a", "content": b""}, None)),
    ],
)
def test_nor_any_other_value(uuid: str, value: Any) -> None:
    assert fault(_widget(uuid, {"value": value}), WIDGETS.get)


@pytest.mark.parametrize(
    "updates",
    [{}, {"update_cb": 3}, {"removed": True}, {"value": 1.0, "props": 3}, [], "value", None],
)
def test_nothing_but_the_value_of_a_widget_is_set(updates: Any) -> None:
    assert fault(_widget("number", updates), WIDGETS.get)


@pytest.mark.parametrize(
    "data",
    [
        "text",
        b"",
        b"\xff\xff",
        b"\xc1",
        msgspec.msgpack.encode(3),
        msgspec.msgpack.encode([]),
        msgspec.msgpack.encode({}),
        msgspec.msgpack.encode({"type": 3}),
        msgspec.msgpack.encode({"type": ["a"]}),
        msgspec.msgpack.encode({"type": "Nothing"}),
        msgspec.msgpack.encode({"type": "GuiUpdateMessage"}),
        msgspec.msgpack.encode({"type": "GuiUpdateMessage", "uuid": 3, "updates": {}}),
        msgspec.msgpack.encode(CAMERA | {"fov": nan}),
        msgspec.msgpack.encode(CAMERA | {"position": [1.0, 2.0]}),
        msgspec.msgpack.encode(CAMERA | {"position": ["1", 2.0, 3.0]}),
        msgspec.msgpack.encode(CAMERA | {"mood": "good"}),
        b"\x91" * 5000 + b"\x01",
    ],
)
def test_what_is_no_message_is_dropped(data: Any) -> None:
    assert fault(data, WIDGETS.get)


DRAG = {"type": "TransformControlsUpdateMessage", "name": "/a", "position": [1, 2, 3], "owner": ""}


@pytest.mark.parametrize(
    ("change", "passes"),
    [
        ({}, True),
        ({"wxyz": [0.6, 0.8, 0.0, 0.0]}, True),
        ({"wxyz": [0.0, 0.0, 0.0, 0.0]}, False),
        ({"wxyz": [1e200, 0.0, 0.0, 0.0]}, False),
        ({"wxyz": [3.0, 0.0, 0.0, 0.0]}, False),
        ({"wxyz": [1.0, 0.0, 0.0]}, False),
        ({"position": [1e13, 0.0, 0.0]}, False),
        ({"position": [1e9, 0.0, 0.0]}, True),
    ],
)
def test_a_handle_in_the_scene_is_somewhere_and_turned_somehow(change: Any, passes: bool) -> None:
    sent = DRAG | {"wxyz": [1.0, 0.0, 0.0, 0.0]} | change
    assert (fault(msgspec.msgpack.encode(sent), WIDGETS.get) == "") is passes


def test_a_camera_comes_through() -> None:
    assert fault(msgspec.msgpack.encode(CAMERA), WIDGETS.get) == ""


plain = st.none() | st.booleans() | st.floats() | st.integers(-(2**63), 2**63) | st.text(max_size=5)
nested = st.recursive(
    plain, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner)
)


@given(st.sampled_from(sorted(WIDGETS)), nested)
def test_no_value_is_too_strange_to_be_judged(uuid: str, value: Any) -> None:
    fault(_widget(uuid, {"value": value}), WIDGETS.get)
    fault(msgspec.msgpack.encode(value), WIDGETS.get)


class _Line:
    def __init__(self, *sent: Any) -> None:
        self.sent = [*sent]

    async def recv(self) -> Any:
        return self.sent.pop(0)


def test_each_reason_is_one_line_in_the_log(caplog: pytest.LogCaptureFixture) -> None:
    good = _widget("number", {"value": 2.0})
    bad = [_widget("number", {"value": value}) for value in (nan, inf, -inf) * 100]
    odd = [_widget("number", {"value": "x"})] * 100
    line = Sifted(_Line(*bad, *odd, good), WIDGETS.get)
    with caplog.at_level(logging.WARNING):
        assert asyncio.run(line.recv()) == good
    assert len(caplog.records) == 2
    assert all("\n" not in record.getMessage() for record in caplog.records)


def test_the_log_is_not_filled_by_whoever_likes_to(caplog: pytest.LogCaptureFixture) -> None:
    handles = {str(n): SimpleNamespace(label=f"w{n}", value=1.0) for n in range(200)}
    sent = [_widget(uuid, {"value": "x"}) for uuid in handles]
    line = Sifted(_Line(*sent, b"\x01", _widget("?", {"value": 1})), handles.get)
    with caplog.at_level(logging.WARNING):
        asyncio.run(line.recv())
    assert len(caplog.records) == REASONS
