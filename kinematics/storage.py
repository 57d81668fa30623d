"""Files in and out: only regular files are read, up to a limit; what is written is whole."""

from __future__ import annotations

import csv
import errno
import io
import os
import re
import secrets
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from kinematics.errors import InputError


def read_file(path: Path | str, limit: int, what: str) -> bytes:
    """The bytes of a regular file (or of a link to one) of at most ``limit`` bytes.

    Args:
        what: what the file should be, as "a design file"; for messages.

    Raises:
        InputError: it is no regular file, too long, or cannot be read.
    """
    place = Path(path)
    # Not to wait for whoever writes into a pipe; of a file it changes nothing.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        handle = os.open(place, flags)
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            os.close(handle)
            raise InputError(f"{place}: cannot be read (no regular file, so not {what})")
        with os.fdopen(handle, "rb") as file:
            data = file.read(limit + 1)
    except (OSError, ValueError) as error:
        raise InputError(f"{place}: cannot be read ({_reason(error)})") from None
    if len(data) > limit:
        size = f"{limit // 1024} kB" if limit < 1 << 20 else f"{limit >> 20} MB"
        raise InputError(f"{place}: longer than {size}, so not {what}")
    return data


def read_text(path: Path | str, limit: int, what: str) -> str:
    """The text of a regular file in UTF-8 (a byte order mark is left out), see `read_file`.

    Raises:
        InputError: as of `read_file`, or it is not text.
    """
    try:
        return read_file(path, limit, what).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path}: not text in UTF-8, so not {what}") from None


def write_file(path: Path | str, data: bytes) -> Path:
    """Write a file beside its place and move it there: a failure leaves what was there whole.

    Links are followed; owner and permissions of an existing file are kept, and obeyed. What is no
    regular file (a device, a pipe) is written to directly. Returns the path as given.

    Raises:
        InputError: it cannot be written.
    """
    place = Path(path)
    beside: Path | None = None
    try:
        target = Path(os.path.realpath(place))
        if target.is_symlink():
            raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
        known = target.stat() if target.exists() else None
        if known is not None and not stat.S_ISREG(known.st_mode):
            target.write_bytes(data)
            return place
        if known is not None and not os.access(target, os.W_OK):  # moving would not ask
            raise OSError(errno.EACCES, os.strerror(errno.EACCES))
        beside = target.with_name(f"{_beside(target)}{secrets.token_hex(4)}")
        flags = os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_BINARY", 0)
        with os.fdopen(os.open(beside, flags, 0o666), "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if known is not None:
            with suppress(OSError, AttributeError):  # only some may, and not on every system
                os.chown(beside, known.st_uid, known.st_gid)
            beside.chmod(stat.S_IMODE(known.st_mode))
        beside.replace(target)
    except (OSError, ValueError) as error:
        if beside is not None:
            with suppress(OSError):
                beside.unlink(missing_ok=True)
        raise InputError(f"cannot write {str(place)!r}: {_reason(error)}") from None
    return place


def exists(path: Path | str) -> bool:
    """Whether there is something; nothing has a name that cannot be one."""
    try:
        return Path(path).exists()
    except (OSError, ValueError):
        return False


def sweep(path: Path | str) -> None:
    """Remove what a writer of this file left beside it when it was killed.

    Only for who alone writes the file.
    """
    target = Path(os.path.realpath(path))
    begins = _beside(target)
    with suppress(OSError):
        for left in target.parent.iterdir():
            if left.name.startswith(begins) and _TOKEN.fullmatch(left.name[len(begins) :]):
                left.unlink()


_TOKEN = re.compile(r"[0-9a-f]{8}")


def _beside(target: Path) -> str:
    return f".{target.name[:100]}."


def _reason(error: Exception) -> str:
    said = getattr(error, "strerror", None) or str(error)
    return said[:1].lower() + said[1:]


def csv_text(rows: Iterable[Iterable[object]]) -> str:
    """Rows as CSV; the first one names the columns."""
    written = io.StringIO()
    csv.writer(written, lineterminator="\n").writerows(rows)
    return written.getvalue()
