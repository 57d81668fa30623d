"""The kernel, compiled where that pays: never does anyone wait for the compiler.

The kernel is the modules in `_MODULES`: plain Python that numba also compiles. Compiling takes some
twenty seconds, loading what was compiled before most of one. Until then numpy stands in for what
cuts many sections (`batches`), some ten times slower than the compiled kernel; a process that has
been at work for longer than loading takes loads what there is by then. `prepare` compiles, for
processes that nobody waits for. What is compiled is kept in the user's cache folder, by the
kernel's text, so that every installation and checkout of the same text has it.
"""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import logging
import os
import shutil
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import platformdirs

from kinematics.mechanisms.five_rpur.slicing import batches
from kinematics.mechanisms.five_rpur.slicing import boundary as _boundary
from kinematics.mechanisms.five_rpur.slicing import integral as _integral
from kinematics.mechanisms.five_rpur.slicing import measures as _measures
from kinematics.mechanisms.five_rpur.slicing import quadrature as _quadrature
from kinematics.mechanisms.five_rpur.slicing import sweep as _sweep

log = logging.getLogger(__name__)

_MODULES = (_sweep, _quadrature, _measures, _boundary, _integral)
_READY = "ready"
_LOADING = 0.8  # s that it takes to load what was compiled before
_LOOK = 0.25  # s between looks whether somebody else has compiled
_UNUSED = 7 * 86400.0  # s after which another build's kernel is forgotten
_KEPT = 4  # builds' kernels at most


class _Plain:
    """How long numpy and plain Python have been at work, and what has come in their place."""

    spent = 0.0
    begun = np.inf  # when the present work was
    looked = -np.inf
    compiled = False
    failed = False
    members: ClassVar[list[dict[str, Any]]] = []  # of each module, before they were compiled


class _Ready(Exception):  # not an error
    """The kernel was loaded in the midst of work without it, which it does again in less time."""


def call(name: str, *arguments: Any) -> Any:
    """A function of the kernel, compiled or not; what it gives is the same but for rounding."""
    while True:
        if _Plain.compiled or _changed():
            from numba import NumbaError

            try:
                return _function(name)(*arguments)
            except NumbaError as error:
                _give_up(error)
        _Plain.begun = time.perf_counter()
        try:
            return _STANDS_IN.get(name, _function(name))(*arguments)
        except _Ready:
            pass
        finally:
            _Plain.spent += time.perf_counter() - _Plain.begun
            _Plain.begun = np.inf


def _changed() -> bool:
    """Whether the kernel has just been loaded, since that pays by now."""
    now = time.perf_counter()
    spent = _Plain.spent + max(now - _Plain.begun, 0.0)
    if _Plain.compiled or spent < _LOADING or now - _Plain.looked < _LOOK or not _available():
        return False
    _Plain.looked = now
    return load()


def load() -> bool:
    """Load at once what was compiled before, for work that lasts longer than loading does.

    Different workers then give the same digits: numpy and the kernel round differently.
    """
    if not _Plain.compiled and _available():
        folder = _folder()
        if folder is not None and (folder / _READY).exists():
            _compile()
    return _Plain.compiled


def _watched(function: Callable[..., Any]) -> Callable[..., Any]:
    def call_it(*arguments: Any) -> Any:
        result = function(*arguments)
        if _changed():
            raise _Ready
        return result

    return call_it


_STANDS_IN = {"measure": batches.measure, "runs_of": batches.runs_of}
vars(_integral)["measure"] = _watched(batches.measure)


def is_compiled() -> bool:
    """Whether the kernel is compiled in this process."""
    return _Plain.compiled


def _function(name: str) -> Any:
    return next(vars(module)[name] for module in _MODULES if name in vars(module))


def prepare(exercise: Callable[[], None], *, here: bool = True) -> bool:
    """Compile all of the kernel, or load it if that was done before; whether it is compiled now.

    Args:
        exercise: calls every function for the arguments that it will be called with.
        here: else it is for other processes, and nothing is loaded that was compiled before.
    """
    if not _available():
        return False
    folder = _folder()
    if not here and folder is not None and (folder / _READY).exists():
        _tidy(folder)
        return _Plain.compiled
    _compile()
    if _Plain.compiled:
        exercise()
    if _Plain.compiled and folder is not None:
        (folder / _READY).touch()
    return _Plain.compiled


def _compile() -> None:
    """Have functions compiled, or loaded, when they are first called."""
    from numba import NumbaError, config

    if _Plain.compiled:
        return
    folder = _folder()
    _Plain.members = [dict(vars(module)) for module in _MODULES]
    before = config.CACHE_DIR, getattr(config, "CACHE_LOCATOR_CLASSES", "")
    if folder is not None:
        config.CACHE_DIR = str(folder)
        config.CACHE_LOCATOR_CLASSES = f"{__name__}.Kept" if _by_text() else ""
        _tidy(folder)
    try:
        vars(_integral)["measure"] = _measures.measure
        _replace(keep=folder is not None)
        _Plain.compiled = True
    except NumbaError as error:
        _give_up(error)
    finally:
        config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES = before


def _give_up(error: Exception) -> None:
    """A numba that cannot: plain Python is slower, not wrong."""
    log.warning("sections stay slow, numba could not compile them: %s", error)
    for module, members in zip(_MODULES, _Plain.members, strict=True):
        vars(module).update(members)
    _Plain.compiled = False
    _Plain.failed = True


def _replace(*, keep: bool) -> None:
    """Put numba's dispatchers in the place of the kernel's functions, wherever these are named."""
    from numba import njit

    for module in _MODULES:
        for name, function in inspect.getmembers(module, inspect.isfunction):
            if function.__module__ == module.__name__:
                compiled = njit(function, error_model="numpy", cache=keep)
                for each in _MODULES:
                    if getattr(each, name, None) is function:
                        setattr(each, name, compiled)


def _available() -> bool:
    return not _Plain.failed and _installed()


@cache
def _installed() -> bool:
    return importlib.util.find_spec("numba") is not None and os.environ.get(
        "NUMBA_DISABLE_JIT", "0"
    ) in ("", "0")


class Kept:
    """Where numba keeps a function of the kernel: in its folder, for any place of the text."""

    def __init__(self, line: int) -> None:
        self._line = line

    @classmethod
    def from_function(cls, function: Any, file: str) -> Kept:
        return cls(function.__code__.co_firstlineno)

    def ensure_cache_path(self) -> None:
        Path(self.get_cache_path()).mkdir(parents=True, exist_ok=True)

    def get_cache_path(self) -> str:
        return str(_folder())

    def get_source_stamp(self) -> str:
        return Path(self.get_cache_path()).name

    def get_disambiguator(self) -> str:
        return str(self._line)


@cache
def _by_text() -> bool:
    """Whether this numba lets others say where it keeps what it compiles, as of 0.62."""
    from importlib.metadata import version

    return tuple(map(int, version("numba").split(".")[:2])) >= (0, 62)


@cache
def _folder() -> Path | None:
    """Where this kernel is kept, compiled by this numba for this Python; None if nowhere."""
    from importlib.metadata import version

    digest = hashlib.sha256()
    for module in _MODULES:
        file = Path(str(module.__file__))
        digest.update(file.read_bytes())
        if not _by_text():  # numba goes by a file's place and date then
            digest.update(f"{file} {file.stat().st_mtime_ns}".encode())
    digest.update(f"{sys.version} {version('numba')} {version('numpy')}".encode())
    folder = platformdirs.user_cache_path("bohemia", appauthor=False) / "kernel"
    folder /= digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        log.debug("no cache for compiled code: %s", error)
        return None
    return folder if os.access(folder, os.W_OK) else None


def _tidy(folder: Path) -> None:
    """Note that this kernel is in use, and forget those of other builds that are not."""

    def used(other: Path) -> float:
        ready = other / _READY
        return (ready if ready.exists() else other).stat().st_mtime

    try:
        if (folder / _READY).exists():
            (folder / _READY).touch()
        others = sorted((o for o in folder.parent.iterdir() if o != folder), key=used)
        last = time.time() - _UNUSED
        for n, other in enumerate(others):
            if used(other) < last or n < len(others) - _KEPT + 1:
                shutil.rmtree(other, ignore_errors=True)
    except OSError as error:  # somebody else tidies as well
        log.debug("the cache was not tidied: %s", error)
