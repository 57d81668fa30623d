"""Every kind of mechanism that is found, and every preset: no kind is named here or beside."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest

import kinematics as kin
from kinematics.answers.solutions import Posture
from kinematics.arrays import Array
from kinematics.mechanism import MAIN, mechanism_kinds

OFTEN = 2
"""So many presets of a kind are always tested, and as many at the end of the main kind's; those
between are left to `make check-all`."""


def _presets() -> Iterator[Any]:
    seen: Counter[str] = Counter()
    last = [preset.name for preset in kin.presets() if preset.mechanism == MAIN][-OFTEN:]
    for preset in kin.presets():
        seen[preset.mechanism] += 1
        rare = preset.name not in last and seen[preset.mechanism] > OFTEN
        yield pytest.param(preset.name, marks=pytest.mark.slow) if rare else preset.name


PRESETS = tuple(_presets())
FIRST = {preset.mechanism: preset.name for preset in reversed(kin.presets())}
ONE_EACH = tuple(FIRST[kind] for kind in mechanism_kinds())
"""A preset of every kind; a kind without one fails here."""

STEP = 1e-3  # mm, and as much at the characteristic length: small, and far from rounding


@cache
def machine(name: str) -> kin.Machine[Any]:
    return kin.open(name)


def sizes(m: kin.Machine[Any]) -> Array:
    """(P,) what 1 mm is in each coordinate."""
    return np.array([1.0 / m.length if axis.unit == "rad" else 1.0 for axis in m.coordinates])


@cache
def held(name: str, count: int = 6, spread: float = 25.0) -> tuple[Posture, ...]:
    """Postures about home that can be held, home first; the same ones in every run."""
    m = machine(name)
    rng = np.random.default_rng(7)
    found = [m.home]
    for _ in range(400):
        if len(found) == count:
            break
        wanted = np.array(m.home.pose) + spread * sizes(m) * rng.uniform(-1, 1, len(m.coordinates))
        try:
            pose = m.complete_pose(tuple(wanted.tolist()), m.home.mode, dependent=_last(m))
        except kin.InputError:
            continue
        posture = m.posture(pose, m.home.mode)
        if posture.reachable and not m.singularities.at(posture, 1e-3):
            found.append(posture)
    assert len(found) == count, f"{name}: home is no place to start from"
    return tuple(found)


def _last(m: kin.Machine[Any]) -> int | None:
    return m.dependent[-1] if m.dependent else None


def apart(m: kin.Machine[Any], pose: Sequence[float], mode: str, other: Posture) -> float:
    """How far the platform is from where it is in another posture, mm, turns by their length."""
    off = m.transform(pose, mode) - m.transform(other.pose, other.mode)
    return float(np.linalg.norm(off[:3, 3]) + m.length * np.linalg.norm(off[:3, :3]))
