"""The constant-orientation workspace of the 4-SPS + 1-SPR: an exact region of a plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.answers.sections import Region, RegionSpec
from kinematics.arrays import Array
from kinematics.facets.regions import RegionsFacet
from kinematics.mechanisms.four_sps_spr.design import FourSPSSPRDesign
from kinematics.mechanisms.four_sps_spr.plane import plane, rings
from kinematics.plane.annuli import rings_section, roomiest
from kinematics.screws.spatial import homogeneous


class Regions(RegionsFacet[FourSPSSPRDesign]):
    """One region, which may have several pieces."""

    specs = (
        RegionSpec(
            "workspace",
            "Constant-orientation workspace, in the plane m = R n₆",
            ("u", "v"),
            joint="l",
        ),
    )

    def frame(self, pose: Sequence[float]) -> Array:
        here = plane(self.design, tuple(pose[3:]))
        m, u, v = here.frame
        return homogeneous(np.stack([u, v, m], axis=1), here.at * m)

    def found(
        self, key: str, pose: Sequence[float], modes: tuple[str, ...] | None
    ) -> tuple[Region, ...]:
        here = plane(self.design, tuple(pose[3:]))
        found = rings(self.design, here)
        region = rings_section(found, here.at)
        return (Region("workspace", region, 0.0, "", 0, 0, roomiest(found, region)),)
