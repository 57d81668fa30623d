"""Trajectories of any mechanism: a path in pose space, a time law, and what they ask for."""

from kinematics.answers.trajectories import (
    Close,
    Event,
    Limits,
    NamedTrajectory,
    Path,
    TimeLaw,
    Trajectory,
)
from kinematics.trajectories.constrained import Constrained, constrained, giving_way
from kinematics.trajectories.fits import Fits, fit
from kinematics.trajectories.laws import LAWS, Law, law, trapezoidal
from kinematics.trajectories.paths import (
    Drawn,
    Line,
    Polyline,
    Spline,
    drawn,
    line,
    polyline,
    spline,
)
from kinematics.trajectories.sampling import duration_within, trajectory

__all__ = [
    "LAWS",
    "Close",
    "Constrained",
    "Drawn",
    "Event",
    "Fits",
    "Law",
    "Limits",
    "Line",
    "NamedTrajectory",
    "Path",
    "Polyline",
    "Spline",
    "TimeLaw",
    "Trajectory",
    "constrained",
    "drawn",
    "duration_within",
    "fit",
    "giving_way",
    "law",
    "line",
    "polyline",
    "spline",
    "trajectory",
    "trapezoidal",
]
