"""Where a server may listen and whom it answers, of many names and headers."""

from __future__ import annotations

import socket
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.datastructures import Headers

from app import admission
from app.admission import LOOPBACK, arrived_at, place, policies, refused
from kinematics.errors import InputError


@pytest.mark.parametrize(
    ("host", "said"),
    [
        ("nonsense.invalid", "there is no address"),
        ("", "needs an address"),
        ("  ", "needs an address"),
        ("a..b", "there is no address"),
        ("x" * 300, "there is no address"),
        ("a\0b", "there is no address"),
        ("[::1]", "there is no address"),
        ("http://127.0.0.1", "there is no address"),
        ("192.0.2.7", "no address of this machine"),
    ],
)
def test_what_is_no_address_of_this_machine_is_refused_before_listening(
    host: str, said: str
) -> None:
    with pytest.raises(InputError, match=said) as caught:
        place(host, 0)
    assert "\n" not in str(caught.value)


def test_a_name_that_nobody_resolves_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    given_up = threading.Event()

    def slow(*_: object, **__: object) -> None:
        given_up.wait(30.0)
        raise OSError

    monkeypatch.setattr(socket, "getaddrinfo", slow)
    monkeypatch.setattr(admission, "PATIENCE", 0.05)
    with pytest.raises(InputError, match="nobody knows it"):
        place("slow.example", 0)
    given_up.set()


def test_a_port_that_is_taken_gives_way_to_the_next() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert place("127.0.0.1", port).port > port
        assert place("127.0.0.1", 0).port == 0


def test_no_port_is_left_behind_the_last(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        monkeypatch.setattr(admission, "LAST", port)
        with pytest.raises(InputError, match="none is free"):
            place("127.0.0.1", port)


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "127.1"])
def test_of_this_machine_alone_its_own_names_are_answered(host: str) -> None:
    assert place(host, 0).names >= LOOPBACK


@pytest.mark.parametrize("host", ["0.0.0.0", "0"])
def test_listening_everywhere_opens_no_name_but_those_allowed(host: str) -> None:
    there = place(host, 0, ["Lab-PC.example.", "[FD00::1]", "10.0.0.9"])
    assert there.everywhere
    assert there.url(80) == f"http://127.0.0.1:80/{there.keys.steer}/"
    assert there.names == {host, *LOOPBACK, "lab-pc.example", "fd00::1", "10.0.0.9"}


@pytest.mark.parametrize("name", ["", "*", "http://a", "a/b", "a:80", "a b", "a" * 300])
def test_what_is_no_name_cannot_be_allowed(name: str) -> None:
    with pytest.raises(InputError, match="--allow-host"):
        place("127.0.0.1", 0, [name])


def _headers(*pairs: tuple[str, str]) -> Headers:
    headers = Headers()
    for name, value in pairs:
        headers[name] = value
    return headers


@pytest.mark.parametrize(
    ("host", "passes"),
    [
        ("lab-pc", True),
        ("LAB-PC:8080", True),
        ("lab-pc.:8080", True),
        ("10.0.0.9:1", True),
        ("[::1]:8080", True),
        ("[0:0:0:0:0:0:0:1]", True),
        ("evil.com", False),
        ("lab-pc.evil.com", False),
        ("evil.com@lab-pc", False),
        ("lab-pc@evil.com", False),
        ("lab-pc/evil.com", False),
        ("lab-pc#", False),
        ("lab-pc:port", False),
        ("lab-pc:99999", False),
        ("[", False),
        ("]", False),
        ("[::1", False),
        ("[zz]", False),
        ("", False),
    ],
)
def test_a_host_must_be_one_of_the_names(host: str, passes: bool) -> None:
    names = {"lab-pc", "10.0.0.9", "::1"}
    assert (refused(_headers(("Host", host)), names) == "") is passes


PRINTED = st.characters(codec="latin-1", exclude_categories=["Cc"])


@given(st.text(PRINTED, max_size=12) | st.text("a.:@[]/9 ", max_size=8))
def test_no_header_is_too_strange_to_be_judged(text: str) -> None:
    if not refused(_headers(("Host", text)), {"a"}):
        assert text.lower().partition(":")[0].rstrip(".") == "a"
    if not refused(_headers(("Host", "a"), ("Origin", text)), {"a"}):
        assert text.endswith("://a")


def test_two_of_what_there_is_one_of_are_refused() -> None:
    twice = _headers(("Host", "a"), ("Host", "a"))
    assert refused(twice, {"a"})
    origins = _headers(("Host", "a"), ("Origin", "http://a"), ("Origin", "http://evil"))
    assert refused(origins, {"a"})


def test_the_address_at_which_a_request_arrives_is_a_name() -> None:
    assert arrived_at(("192.168.1.5", 80)) == "192.168.1.5"
    assert arrived_at(("::ffff:192.168.1.5", 80, 0, 0)) == "192.168.1.5"
    assert arrived_at(("fe80::1%eth0", 80, 0, 2)) == "fe80::1"
    assert arrived_at(None) == arrived_at("") == ""


def test_a_page_for_a_notebook_may_be_held_by_pages_of_this_machine() -> None:
    said = policies("127.0.0.1:8080", framed=True)
    assert "X-Frame-Options" not in said
    content = dict(part.split(" ", 1) for part in said["Content-Security-Policy"].split("; "))
    held = content["frame-ancestors"].split()
    assert {"http://localhost:*", "http://127.0.0.1:*"} <= set(held)
    assert all(each.partition("://")[2] in ("localhost:*", "127.0.0.1:*") for each in held)


def test_no_frame_may_hold_the_page() -> None:
    said = policies("127.0.0.1:8080")
    assert said["X-Frame-Options"] == "DENY"
    content = dict(part.split(" ", 1) for part in said["Content-Security-Policy"].split("; "))
    assert content["frame-ancestors"] == content["object-src"] == "'none'"
    assert content["default-src"] == "'self'"
    assert "ws://127.0.0.1:8080" in content["connect-src"]
    assert not any("*" in part or "http" in part for part in content.values())
