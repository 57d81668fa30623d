"""Files that are whole or not there: written beside their place, then moved into it."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import NamedTemporaryFile

from kinematics.errors import InputError


def save(path: Path, data: bytes) -> Path:
    """Write a file; what stood there before stays whole until the new one is.

    Raises:
        InputError: it cannot be written, and why.
    """
    beside = None
    try:
        if path.exists() and not path.is_file():  # a pipe or a device: nothing to keep
            path.write_bytes(data)
            return path
        target = path.resolve()
        with NamedTemporaryFile(dir=target.parent, prefix=f".{path.name}.", delete=False) as file:
            beside = Path(file.name)
            file.write(data)
        mode = target.stat().st_mode & 0o777 if target.exists() else 0o666 & ~_umask()
        beside.chmod(mode)
        beside.replace(target)
    except OSError as error:
        if beside is not None:
            beside.unlink(missing_ok=True)
        why = error.strerror or str(error)
        raise InputError(f"cannot write {str(path)!r}: {why}") from None
    return path


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
