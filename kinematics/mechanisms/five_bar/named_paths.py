"""The paper's two trajectories, placed on any five-bar that they fit.

Sosa-López et al. 2017, eqs. 8 and 9: (0, 738.644) mm to (100, 838.644) mm in 1 s at constant
velocity; eqs. 10 to 15 with their signs corrected: (0, 738.644) to (240, 450) mm in 2 s, a quintic
from rest to rest. The paper's unit is the cm.
"""

from __future__ import annotations

import numpy as np

from kinematics.answers.trajectories import NamedTrajectory
from kinematics.facets.paths import PathsFacet
from kinematics.mechanisms.five_bar.design import FiveBarDesign
from kinematics.trajectories.laws import law
from kinematics.trajectories.paths import Line

START = (0.0, 738.644)
_SOURCE = "Sosa-López et al. 2017"
_UNIT = (1.0, 1.0)
_PAPER = np.array([480.0, 480.0, 480.0, 480.0, 240.0])


class NamedPaths(PathsFacet[FiveBarDesign]):
    """The paper's paths."""

    def named(self) -> tuple[NamedTrajectory, ...]:
        """ "line" and "rest-to-rest"; on a machine of another size by the mean of its lengths."""
        design = self.design
        lengths = np.array([*design.proximal, *design.distal, design.half_base])
        size = float(lengths.mean() / _PAPER.mean())
        size = 1.0 if (lengths == _PAPER).all() else size

        def line(end: tuple[float, float]) -> Line:
            start = (size * START[0], size * START[1])
            return Line(start, (size * end[0], size * end[1]), _UNIT)

        mode = self.mechanism.home().mode
        return (
            NamedTrajectory(
                "line",
                "Straight line at constant velocity",
                line((100.0, 838.644)),
                law("linear", 1.0),
                mode,
                f"{_SOURCE}, eqs. 8 and 9",
            ),
            NamedTrajectory(
                "rest-to-rest",
                "Straight line from rest to rest, quintic",
                line((240.0, 450.0)),
                law("quintic", 2.0),
                mode,
                f"{_SOURCE}, eqs. 10 to 15, signs corrected",
            ),
        )
