"""Where a server listens, whom it answers, and what its answers may do in a browser."""

from __future__ import annotations

import errno
import ipaddress
import os
import secrets
import socket
import threading
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

from websockets.datastructures import Headers

from kinematics.errors import InputError

LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})
LOCAL = ("localhost", "127.0.0.1")
PATIENCE = 8.0  # s for a name to be looked up
LAST = 65535  # port


@dataclass(frozen=True, slots=True)
class Place:
    """Where to listen.

    Attributes:
        host: as it was named.
        port: one that is free; 0 for any.
        names: under which the server is meant, beside the address at which a request arrives.
        keys: what an address must begin with.
        framed: whether pages of this machine, as a notebook, may hold the page in a frame.
    """

    host: str
    port: int
    names: frozenset[str]
    everywhere: bool
    keys: Keys
    framed: bool = False

    def url(self, port: int, *, looks_on: bool = False) -> str:
        """What to open on this machine, to steer or only to look on."""
        shown = self.host
        if self.everywhere:
            shown = "::1" if ":" in self.host else "127.0.0.1"
        shown = f"[{shown}]" if ":" in shown else shown
        key = self.keys.look if looks_on else self.keys.steer
        return f"http://{shown}:{port}" + (f"/{key}/" if key else "")


@dataclass(frozen=True, slots=True)
class Keys:
    """With which part the paths of addresses begin: to ``steer`` the review, or to ``look`` on.

    "" for none: on this machine alone everybody may steer who may ask at all.
    """

    steer: str
    look: str

    def read(self, path: str) -> tuple[bool, str] | None:
        """Whether who asks for a path only looks on, and the rest of the path; None without key."""
        first, slash, rest = path.removeprefix("/").partition("/")
        first, query, more = first.partition("?")
        rest = f"/{rest}" if slash else f"/{query}{more}"
        if _same(first, self.look):
            return True, rest
        if not self.steer:
            return False, path
        return (False, rest) if _same(first, self.steer) else None


OPEN = Keys("", "look")
"""Of a server that this machine alone reaches."""


def _same(given: str, key: str) -> bool:
    return secrets.compare_digest(given.encode(), key.encode())


def place(host: str, port: int, allowed: Iterable[str] = ()) -> Place:
    """Where to listen, known to be possible; the next free port where this one is taken.

    Args:
        allowed: further names under which the server is to answer.

    Raises:
        InputError: it is no address of this machine, the port may not be used, or a name is none.
    """
    if not host.strip():
        raise InputError(
            "--host needs an address to listen on, as 127.0.0.1, or 0.0.0.0 for all of this machine"
        )
    found = _looked_up(host)
    here = [ipaddress.ip_address(address.partition("%")[0]) for _, (address, *_) in found]
    everywhere = any(address.is_unspecified for address in here)
    names = {host.lower().rstrip("."), *(_name(each) for each in allowed)}
    if everywhere or any(address.is_loopback for address in here):
        names |= LOOPBACK
    alone = all(address.is_loopback for address in here)
    keys = OPEN if alone else Keys(secrets.token_urlsafe(16), secrets.token_urlsafe(16))
    return Place(host, _free(host, found, port), frozenset(names), everywhere, keys)


def _looked_up(host: str) -> list[tuple[socket.AddressFamily, tuple[Any, ...]]]:
    """The addresses of a name: families, and what `socket.bind` takes. In bounded time."""
    found: list[tuple[socket.AddressFamily, tuple[Any, ...]]] = []
    failure = [f"nobody knows it within {PATIENCE:.0f} s"]

    def look() -> None:
        try:
            known = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        except (OSError, ValueError) as error:  # a name that is none is a UnicodeError
            failure[0] = getattr(error, "strerror", None) or "it is no name"
        else:
            found.extend((family, address) for family, _, _, _, address in known)

    looking = threading.Thread(target=look, daemon=True)
    looking.start()
    looking.join(PATIENCE)
    if not found:
        raise InputError(f"--host: there is no address {host!r} ({failure[0]})")
    return found


def _free(
    host: str, found: Collection[tuple[socket.AddressFamily, tuple[Any, ...]]], port: int
) -> int:
    """The first free port from this one on; 0 stays."""
    for number in range(port, LAST + 1):
        taken = False
        for family, (address, _, *more) in found:
            with socket.socket(family, socket.SOCK_STREAM) as probe:
                if family == socket.AF_INET6:
                    probe.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
                if os.name == "posix":  # as asyncio does
                    probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                try:
                    probe.bind((address, number, *more))
                    probe.listen(1)
                except OSError as error:
                    if error.errno == errno.EADDRINUSE:
                        taken = True
                        continue
                    if error.errno == errno.EACCES:
                        raise InputError(
                            f"--port {number} may not be listened on by you; name one above 1023"
                        ) from None
                    raise InputError(
                        f"--host: {host!r} is no address of this machine ({error.strerror})"
                    ) from None
        if not taken:
            return number
    raise InputError(f"--port: none is free from {port} on")


def _name(text: str) -> str:
    """A name that --allow-host gives."""
    name = text.strip().lower().rstrip(".")
    bare = name.removeprefix("[").removesuffix("]")
    try:
        return str(ipaddress.ip_address(bare))
    except ValueError:
        pass
    if not name or len(name) > 253 or not all(c.isalnum() or c in "-._" for c in name):
        raise InputError(
            f"--allow-host: {text!r} is no name of a machine, as lab-pc or bohemia.example.org"
        )
    return name


def refused(headers: Headers, names: Collection[str]) -> str:
    """Why a request is refused; "" when it may pass.

    Any page in a person's browser can open a websocket to this server, and would steer it: so a
    request must come from the very address that it goes to. And a foreign name may resolve to this
    machine: so that address must be one of the server's own.
    """
    hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
    host = hosts[0] if len(hosts) == 1 else ""
    if _host_of(host) not in names:
        return (
            "This server answers only under its own address; to have it answer under another name, "
            "start it with --allow-host NAME."
        )
    if len(origins) > 1 or any(origin.partition("://")[2] != host for origin in origins):
        return "This page may not be steered from another site."
    return ""


def arrived_at(address: Any) -> str:
    """The address of this machine that a connection came to, as a browser names it."""
    try:
        known = ipaddress.ip_address(str(address[0]).partition("%")[0])
    except (ValueError, TypeError, IndexError):
        return ""
    mapped = getattr(known, "ipv4_mapped", None)
    return str(mapped or known)


def _host_of(header: str) -> str:
    """The name or address in a Host header, "" where there is none that can be understood."""
    if not header or any(c in "@/\\?#%" or c <= " " for c in header):
        return ""
    try:
        parted = urlsplit(f"//{header}")
        name, _ = parted.hostname or "", parted.port
    except ValueError:
        return ""
    try:
        return str(ipaddress.ip_address(name))
    except ValueError:
        return name.rstrip(".")


FRAMES = " ".join(f"{scheme}://{name}:*" for scheme in ("http", "https") for name in LOCAL)
"""Who may hold a page that is meant for a notebook."""


def policies(host: str, *, framed: bool = False) -> dict[str, str]:
    """What a browser is told with each answer: no frames, nothing from elsewhere.

    Args:
        host: that of the request, once it is known to be the server's own.
        framed: pages of this machine may hold it in a frame.
    """
    # The page is one file: its programs stand in it and are unpacked by it, as are its workers.
    # What drives a browser, as for tests, evaluates text in it.
    own = f"'self' ws://{host} wss://{host}" if host else "'self'"
    content = {
        "default-src": "'self'",
        "script-src": "'self' 'unsafe-inline' 'unsafe-eval' blob:",
        "style-src": "'self' 'unsafe-inline'",
        "img-src": "'self' data: blob:",
        "font-src": "'self' data:",
        "connect-src": f"{own} data: blob:",
        "worker-src": "'self' blob:",
        "object-src": "'none'",
        "base-uri": "'none'",
        "form-action": "'none'",
        "frame-ancestors": FRAMES if framed else "'none'",
    }
    return {
        "Content-Security-Policy": "; ".join(f"{name} {what}" for name, what in content.items()),
        **({} if framed else {"X-Frame-Options": "DENY"}),
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Opener-Policy": "same-origin",
        "Cross-Origin-Resource-Policy": "same-origin",
    }
