"""Kinematics of parallel mechanisms: one import, one object, and a dot shows the way.

    >>> import kinematics as kin
    >>> machine = kin.open("rpur-table1")               # a preset, or the path of a design file
    >>> machine.workspace(phi=0.1, theta=0).volume(1e-4, pieces=False).value > 0
    True

`presets` tells what comes with Bohemia; `open` and `read` make a `Machine`. What it can answer
stands in its facets, ``machine.inverse``, ``machine.forward``, …, in ``machine.at(pose, mode)`` and
in ``machine.workspace(…)``. Lengths are mm, angles rad, forces N, moments N·mm, times s; arrays go
in and results that do not change come out. An unreachable pose is a normal answer with its reasons;
wrong input is an `InputError`, whose message says what would be right.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kinematics.errors import BohemiaError, ComputationError, DesignError, InputError

if TYPE_CHECKING:  # loaded when they are first asked for
    from os import PathLike

    from kinematics.answers.bounds import Bound
    from kinematics.answers.coordinates import Joints, Pose
    from kinematics.answers.modes import Mode
    from kinematics.designs.files import PresetInfo
    from kinematics.machine import Machine
    from kinematics.mechanism import Design

__all__ = [
    "BohemiaError",
    "Bound",
    "ComputationError",
    "DesignError",
    "InputError",
    "Joints",
    "Machine",
    "Mode",
    "Pose",
    "open",
    "presets",
    "read",
    "write",
]

_PLACES = {
    "Bound": "kinematics.answers.bounds",
    "Joints": "kinematics.answers.coordinates",
    "Machine": "kinematics.machine",
    "Mode": "kinematics.answers.modes",
    "Pose": "kinematics.answers.coordinates",
}


def open(name_or_path: str | PathLike[str]) -> Machine[Design]:
    """The machine of a preset, or of a design file (TOML).

    Raises:
        DesignError: there is neither, it cannot be read, or it is broken; the message names the
            line, the key and the remedy.

    Example:
        >>> import kinematics as kin
        >>> kin.open("rpur-table1").joints[0].symbol
        'ρ₁'
    """
    from kinematics.designs.files import load_design
    from kinematics.machine import machine_of

    return machine_of(load_design(str(name_or_path)))


def presets() -> tuple[PresetInfo, ...]:
    """The designs that come with Bohemia: names, kinds, titles, sources.

    Example:
        >>> import kinematics as kin
        >>> [preset.name for preset in kin.presets() if preset.mechanism == "five_bar"]
        ['five-bar']
    """
    from kinematics.designs import files

    return files.presets()


def read(text: str, *, origin: str = "the text", name: str = "") -> Machine[Design]:
    """The machine of a design that is written in ``text`` (TOML), as in a design file.

    Args:
        origin: what messages call the text.
        name: the design's short name.

    Raises:
        DesignError: it is broken; the message names the line, the key and the remedy.

    Example:
        >>> import kinematics as kin
        >>> kin.read(kin.write(kin.open("rps-3"))).kind
        'three_rps'
    """
    from kinematics.designs.files import read_design
    from kinematics.machine import machine_of

    return machine_of(read_design(text, origin=origin, name=name))


def write(machine: Machine[Any]) -> str:
    """The design of a machine as TOML text, which `read` reads back equal.

    Only that a preset with other numbers no longer says that it is the preset, but edited from it.
    """
    from kinematics.designs.files import write_design
    from kinematics.designs.origins import as_written

    return write_design(as_written(machine.design))


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
