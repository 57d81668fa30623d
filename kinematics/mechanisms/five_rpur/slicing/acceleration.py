"""The kernel, compiled where that pays: never does anyone wait for the compiler.

The kernel is the modules in `_MODULES`: plain Python that numba also compiles. Compiling takes as
long as some thousand sections in plain Python, loading what was compiled before as long as some
dozens. So plain Python works until it would have taken as long as the other way: at worst that
doubles the time, once. `prepare` compiles everything, for processes that nobody waits for; else
only what is used is. What is compiled is kept in the user's cache folder, by the kernel's text and
place.
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

from kinematics.mechanisms.five_rpur.slicing import boundary as _boundary
from kinematics.mechanisms.five_rpur.slicing import integral as _integral
from kinematics.mechanisms.five_rpur.slicing import measures as _measures
from kinematics.mechanisms.five_rpur.slicing import quadrature as _quadrature
from kinematics.mechanisms.five_rpur.slicing import sweep as _sweep
from kinematics.mechanisms.five_rpur.slicing import tracing as _tracing

log = logging.getLogger(__name__)

_MODULES = (_sweep, _quadrature, _measures, _boundary, _tracing, _integral)
_READY = "ready"
_LOADING = 0.8  # s that it takes to load what was compiled before
_COMPILING = 10.0  # s that it takes to compile one use of sections
_LOOK = 0.25  # s between looks whether somebody else has compiled


class _Plain:
    """How long plain Python has been at work, and what has come in its place."""

    spent = 0.0
    looked = -np.inf
    compiled = False
    failed = False
    members: ClassVar[list[dict[str, Any]]] = []  # of each module, before they were compiled


def call(name: str, sections: int, *arguments: Any) -> Any:
    """A function of the kernel, compiled or not, that computes so many sections.

    Where numba cannot compile it, plain Python computes them: no result depends on which.
    """
    if not _Plain.compiled and _pays(sections):
        _compile()
    if _Plain.compiled:
        from numba import NumbaError

        try:
            return _function(name)(*arguments)
        except NumbaError as error:
            _give_up(error)
    begun = time.perf_counter()
    result = _function(name)(*arguments)
    _Plain.spent += time.perf_counter() - begun
    return result


def is_compiled() -> bool:
    """Whether the kernel is compiled in this process."""
    return _Plain.compiled


def _function(name: str) -> Any:
    return next(vars(module)[name] for module in _MODULES if name in vars(module))


_PER_SECTION = 0.008  # s of plain Python for one section


def _pays(sections: int) -> bool:
    ahead = _Plain.spent + _PER_SECTION * sections
    if ahead < _LOADING or not _available():
        return False
    if ahead >= _COMPILING:
        return True
    now = time.monotonic()
    if now - _Plain.looked < _LOOK:
        return False
    _Plain.looked = now
    folder = _folder()
    return folder is not None and (folder / _READY).exists()


def prepare(exercise: Callable[[], None] | None = None) -> bool:
    """Compile all of the kernel, or load it if that was done before; whether it is compiled now.

    Args:
        exercise: calls every function for the arguments that it will be called with; None: each
            is compiled when it is first called.
    """
    if not _available():
        return False
    folder = _compile()
    if _Plain.compiled and exercise is not None:
        exercise()
    if _Plain.compiled and folder is not None and exercise is not None:
        (folder / _READY).touch()
        _tidy(folder)
    return _Plain.compiled


def _compile() -> Path | None:
    """Have functions compiled when they are first called; returns where they are kept."""
    from numba import NumbaError, config

    folder = _folder()
    if _Plain.compiled:
        return folder
    _Plain.members = [dict(vars(module)) for module in _MODULES]
    before = config.CACHE_DIR
    if folder is not None:
        config.CACHE_DIR = str(folder)
    try:
        _replace(keep=folder is not None)
        _Plain.compiled = True
    except NumbaError as error:
        _give_up(error)
    finally:
        config.CACHE_DIR = before
    return folder


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


@cache
def _folder() -> Path | None:
    """Where this kernel is kept, compiled by this numba for this Python; None if nowhere."""
    from importlib.metadata import version

    digest = hashlib.sha256()
    for module in _MODULES:  # numba goes by a file's place and date as well
        file = Path(str(module.__file__))
        digest.update(file.read_bytes())
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
    """Forget what earlier versions have compiled, if nobody has asked for it in a month."""
    for other in folder.parent.iterdir():
        ready = other / _READY
        if other != folder and ready.exists() and time.time() - ready.stat().st_mtime > 30 * 86400:
            shutil.rmtree(other, ignore_errors=True)
