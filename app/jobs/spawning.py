"""Processes that leave Ctrl-C to the one that starts them, from their first moment on."""

from __future__ import annotations

import signal
from multiprocessing.context import SpawnContext, SpawnProcess


class _Quiet(SpawnProcess):
    def start(self) -> None:
        """A signal that is blocked here is blocked there as well: a process that is still starting
        would answer Ctrl-C with a traceback."""
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            super().start()
            return
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Spawning(SpawnContext):
    """As `multiprocessing.get_context("spawn")`."""

    Process = _Quiet
