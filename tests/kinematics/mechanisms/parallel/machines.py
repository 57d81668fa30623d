"""Machines that the tests of parallel mechanisms share, written as files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

import kinematics as kin
from tests.kinematics.references import read

Numbers = Sequence[Any]


def case(name: str) -> Any:
    """A reference case, with its source."""
    return read(f"any/{name}.json")


def text(limbs: Sequence[Mapping[str, object]], position: Numbers, **more: object) -> str:
    """A design file; ``rotation`` or ``turn`` belong to the platform."""
    platform = {"position": list(position)}
    platform |= {key: more.pop(key) for key in ("rotation", "turn") if key in more}  # type: ignore[misc]
    lines = ['mechanism = "parallel"', *(f"{k} = {value(v)}" for k, v in more.items())]
    lines += ["[platform]", *(f"{k} = {value(v)}" for k, v in platform.items())]
    for limb in limbs:
        lines += ["[[limb]]", *(f"{k} = {value(v)}" for k, v in limb.items())]
    return "\n".join(lines)


def value(one: object) -> str:
    if isinstance(one, bool):
        return "true" if one else "false"
    if isinstance(one, str):
        return f'"{one}"'
    if isinstance(one, Mapping):
        return "{ " + ", ".join(f"{k} = {value(v)}" for k, v in one.items()) + " }"
    if isinstance(one, np.ndarray):
        return value(one.tolist())
    if isinstance(one, Sequence):
        return "[" + ", ".join(map(value, one)) + "]"
    return repr(float(one)) if isinstance(one, float) else str(one)


def machine(limbs: Sequence[Mapping[str, object]], position: Numbers, **more: object) -> Any:
    return kin.read(text(limbs, position, **more), origin="the test")


def placements(found: Any, m: kin.Machine[Any]) -> np.ndarray:
    """(N, 4, 4) of a set of solutions."""
    both = zip(found.poses, found.modes, strict=True)
    return np.array([m.transform(pose, mode) for pose, mode in both]).reshape(-1, 4, 4)


def wanted(poses: Sequence[Mapping[str, Any]]) -> np.ndarray:
    """(N, 4, 4) of poses as reference cases have them."""
    found = np.tile(np.eye(4), (len(poses), 1, 1))
    for one, pose in zip(found, poses, strict=True):
        one[:3, :3] = pose["rotation"]
        one[:3, 3] = pose.get("position", (0.0, 0.0, 0.0))
    return found


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """The largest distance of a placement of ``other`` from the nearest of ``one``."""
    return float(np.abs(one[:, None] - other[None]).max(axis=(2, 3)).min(axis=0).max())
