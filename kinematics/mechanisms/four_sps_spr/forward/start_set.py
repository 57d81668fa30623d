"""Where the paths begin: all 40 solutions of one random complex 4-SPS + 1-SPR, a stored file.

The general machine has 40 complex solutions, and so has a general one whose base and platform
points lie in planes. Where a machine is special some of them are at infinity, as 8 for two regular
pentagons; paths to them run off when the design's own set is made (`roots.own_start_set`).
"""

from __future__ import annotations

from functools import cache

import numpy as np

from kinematics.designs.assets import asset_folder
from kinematics.errors import ComputationError
from kinematics.homotopy import solving
from kinematics.mechanisms.four_sps_spr.forward.equations import Parameters

GENERAL_COUNT = 40
FILE = "four_sps_spr-general.npz"


StartSet = solving.StartSet[Parameters]


@cache
def general_set() -> StartSet:
    """The stored set.

    Raises:
        ComputationError: the file cannot be read.
    """
    path = asset_folder("start_solutions") / FILE
    try:
        with np.load(path) as file:
            found = Parameters(file["base"], file["platform"], file["axis"], file["squares"])
            roots = file["roots"]
    except (OSError, ValueError, KeyError) as error:
        raise ComputationError(
            f"the start solutions {path.name} cannot be read ({error}); reinstall Bohemia, or make "
            "them again with 'make start-solutions'"
        ) from None
    return StartSet(found, np.ascontiguousarray(roots, dtype=complex))
