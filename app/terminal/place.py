"""A machine at a pose in one mode, as the commands about one posture ask for it."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from math import isnan
from typing import TYPE_CHECKING, Any

from app.terminal import common, tables

if TYPE_CHECKING:
    from kinematics.answers.solutions import Posture
    from kinematics.machine import Machine
    from kinematics.mechanism import Coordinate


@dataclass(frozen=True, slots=True)
class Place:
    """``pose`` in mm and rad, ``shown`` as typed and completed, mm and degrees."""

    machine: Machine[Any]
    axes: tuple[Coordinate, ...]
    joints: tuple[Coordinate, ...]
    pose: tuple[float, ...]
    shown: list[float]
    mode: str

    @staticmethod
    def of(arguments: argparse.Namespace) -> Place:
        machine = common.load(arguments.design)
        axes = machine.coordinates
        shown = common.open_numbers("--pose", arguments.pose, axes)
        mode = common.chosen_mode(arguments.mode, machine)
        pose = tuple(tables.inner(value, axis) for value, axis in zip(shown, axes, strict=True))
        if any(isnan(value) for value in pose):
            pose = machine.complete_pose(pose, mode)
            shown = tables.outer(pose, axes)
        joints = machine.joints
        return Place(machine, axes, joints, pose, shown, mode)

    def posture(self) -> Posture:
        return self.machine.inverse.posture(self.pose, self.mode)

    def head(self) -> None:
        where = tables.with_units(self.shown, self.axes)
        common.print_head(
            self.machine.design, f"Pose {where}{common.mode_text(self.machine, self.mode)}"
        )

    def entries(self) -> dict[str, Any]:
        keys = map(tables.key, self.axes)
        return {
            "design": self.machine.design.name,
            "mechanism": self.machine.design.mechanism,
            "pose": dict(zip(keys, self.shown, strict=True)),
            **common.mode_entry(self.machine, self.mode),
        }
