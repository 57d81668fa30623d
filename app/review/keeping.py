"""The session of a review: one file, kept by one server, saved beside the page's loop.

What was changed is in the file within `LATEST` seconds and the time that the disk takes, be it
that changes never cease; what cannot be written is tried again until it can.
"""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO

from app.language import tr
from app.review import session
from app.review.state import Review
from kinematics.errors import InputError
from kinematics.storage import exists, sweep

log = logging.getLogger(__name__)

SETTLED = 0.4  # s without a change before it is saved
LATEST = 1.0  # s after a change before it is saved, though others follow
RETRY = 2.0  # s before a file that could not be written is tried again


class Keeper:
    """Keeps a review in a file that no other server keeps.

    Raises:
        InputError: another one keeps it, or no file can stand there.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lock = _Lock(path)
        sweep(path)
        self._turn = threading.Condition()
        self._unsaved: Review | None = None
        self._first = self._last = self._not_before = 0.0
        self._closing = False
        self._failure = ""
        self._tell: Callable[[str], None] = lambda text: None
        self._thread = threading.Thread(target=self._run, name="session", daemon=True)

    def load(self) -> Review | None:
        """The review in the file, None where there is no file yet.

        Raises:
            InputError: it is no session file.
        """
        return session.load(self.path) if exists(self.path) else None

    def begin(self, review: Review) -> None:
        """Save a review at once, so that it is known that this can be done; and keep it from now.

        Raises:
            InputError: the file cannot be written.
        """
        session.save(review, self.path)
        self._thread.start()

    def tells(self, tell: Callable[[str], None]) -> None:
        """Call this with a sentence once the file cannot be written, and when it can again."""
        self._tell = tell

    def offer(self, review: Review) -> None:
        """The review is now this one."""
        with self._turn:
            now = time.monotonic()
            if self._unsaved is None:
                self._first = now
            self._unsaved, self._last = review, now
            self._turn.notify()

    def close(self) -> str:
        """Save what is not saved and let go of the file; why the last change is lost, "" if not."""
        with self._turn:
            self._closing = True
            self._turn.notify()
        if self._thread.ident is not None:
            self._thread.join()
        self._lock.release()
        return self._failure

    def _run(self) -> None:
        while (review := self._next()) is not None:
            failure = ""
            try:
                session.save(review, self.path)
            except InputError as error:
                failure = str(error)
            except Exception as error:
                log.exception("the session could not be saved")
                failure = str(error) or type(error).__name__
            with self._turn:
                before, self._failure = self._failure, failure
                self._not_before = time.monotonic() + RETRY if failure else 0.0
                if failure and self._unsaved is None and not self._closing:
                    self._unsaved = review
            if bool(failure) != bool(before):
                self._tell(
                    tr("session.tried_again", why=failure) if failure else tr("session.saved_again")
                )

    def _next(self) -> Review | None:
        """What is to be saved, once it is due; None once there is nothing left to do."""
        with self._turn:
            while True:
                now, due = time.monotonic(), None
                if self._unsaved is not None:
                    due = max(min(self._last + SETTLED, self._first + LATEST), self._not_before)
                if self._closing or (due is not None and due <= now):
                    review, self._unsaved = self._unsaved, None
                    return review
                self._turn.wait(None if due is None else due - now)


class _Lock:
    """A file beside another one, locked for as long as this process lives or until `release`."""

    def __init__(self, path: Path) -> None:
        while True:
            try:
                target = Path(os.path.realpath(path))
                self._path = target.with_name(f".{target.name[:100]}.lock")
                file = self._path.open("a+", encoding="ascii")
            except (OSError, ValueError) as error:
                why = getattr(error, "strerror", None) or error
                raise InputError(tr("session.cannot_keep", file=str(path), why=why)) from None
            if not _locks(file):
                file.seek(0)
                other = file.read(20).strip()
                file.close()
                who = f" (process {other})" if other.isdecimal() else ""
                raise InputError(
                    f"another Bohemia{who} keeps its review in {str(path)!r}; end it, or name "
                    "another file"
                )
            with suppress(OSError):  # whoever had it may just have removed it
                if os.path.samestat(os.fstat(file.fileno()), self._path.stat()):
                    break
            file.close()
        self._file = file
        with suppress(OSError):  # a full disk; who it is only goes into a sentence
            file.truncate(0)
            file.write(str(os.getpid()))
            file.flush()

    def release(self) -> None:
        if not self._file.closed:
            with suppress(OSError):
                self._path.unlink()
            with suppress(OSError):
                self._file.close()


def _locks(file: IO[str]) -> bool:
    """Lock an open file; False if another process has."""
    try:
        import fcntl
    except ImportError:  # Windows
        return _locks_windows(file)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks: as good as it gets
        return True
    return True


def _locks_windows(file: IO[str]) -> bool:
    import msvcrt

    lock = getattr(msvcrt, "locking")  # noqa: B009 (unknown to a checker elsewhere)
    file.seek(1 << 20)  # a byte that nobody reads
    try:
        lock(file.fileno(), getattr(msvcrt, "LK_NBLCK"), 1)  # noqa: B009
    except OSError:
        return False
    return True
