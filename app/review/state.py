"""The whole state of a review: one frozen value, and what makes it sound.

Lengths in mm and angles in rad; whoever reads a widget converts. Nothing here knows viser.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

from app.features.trajectory.state import NO_PLAN, Plan, fresh_plan
from app.review.modes import matching
from kinematics.answers.solutions import Posture
from kinematics.errors import InputError
from kinematics.facets.solids import SurfaceKind
from kinematics.machine import Machine, machine_of
from kinematics.mechanism import Coordinate, Design

ModeChoice = Literal["all", "current"]
Sort = Literal["distance", "condition", "height", "mode"]
SORTS: tuple[Sort, ...] = ("distance", "condition", "height", "mode")
SAME_MODE = "same"
FAR = 1e4  # mm; a plane may stand this far off, where it cuts nothing
MAX_RATIO, MAX_RATIOS = 100.0, 12  # of machines whose profiles are compared
LARGEST = 1e9  # of a rate or of a load; squares of it are numbers yet
MAX_CELLS = 91  # of a map along one axis


@dataclass(frozen=True, slots=True)
class Options:
    """What is drawn beside the solids, and how."""

    machine: bool = True
    labels: bool = False
    frames: bool = True
    axes: bool = False
    grid: bool = True
    handle: bool = True
    dark: bool = False


@dataclass(frozen=True, slots=True)
class Shown:
    """One solid that is on display."""

    key: str
    opacity: float


@dataclass(frozen=True, slots=True)
class Atlas:
    """How the solutions for the present actuators are shown.

    ``mixed`` asks for those of simplified designs in which the limbs of an arrangement stand in
    different working modes. ``modes`` filters the list: "" for all, `SAME_MODE` for the present
    working mode, else patterns that `app.review.modes.matching` understands.
    """

    ghosts: bool = False
    mixed: bool = False
    sort: Sort = "distance"
    within_stroke: bool = False
    modes: str = ""


@dataclass(frozen=True, slots=True)
class Cut:
    """The plane in which the workspace is cut: whether it is on display, and where, mm."""

    on: bool = False
    at: float = 0.0


@dataclass(frozen=True, slots=True)
class Span:
    """Evenly spaced values of one coordinate, both ends included; rad or mm."""

    low: float = -0.5 * math.pi
    high: float = 0.5 * math.pi
    count: int = 37


@dataclass(frozen=True, slots=True)
class Chart:
    """What a map shows (a key of the mechanism's `MapSpec`) and over which two spans."""

    quantity: str = "volume"
    first: Span = Span()
    second: Span = Span()


@dataclass(frozen=True, slots=True)
class Control:
    """What is shown of how well the platform is held.

    Attributes:
        wrenches: the lines along which the limbs push, and the constraints.
        clearances: the ways to whatever is nearest.
        locus: the singular surface, in the aspects' solid and in the section.
        chart: a key of the mechanism's `LocusSpec`s, whose curves are drawn; "" for none.
        shade: a key of the mechanism's `Measure`s, by which aspects and section are coloured.
        compare: the mechanism's counterpart stands beside it, with the same numbers.
        ratios: h₂/h₁ of further machines whose profile is drawn.
        load: [F, T] on the platform at O′, N and N·mm, base frame.
        forces: what the limbs push and pull under the load, drawn on them.
        arrow: the load's force as an arrow to drag.
        rates, accelerations: of the pose coordinates, mm/s and rad/s and their derivatives, whose
            motion is drawn; () for none.
    """

    wrenches: bool = False
    clearances: bool = False
    locus: bool = True
    chart: str = ""
    shade: str = ""
    compare: bool = False
    ratios: tuple[float, ...] = ()
    load: tuple[float, ...] = (0.0, 0.0, -100.0, 0.0, 0.0, 0.0)
    forces: bool = False
    arrow: bool = False
    rates: tuple[float, ...] = ()
    accelerations: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Flat:
    """Regions of a workspace that lies in a plane: whether they are on display, and which."""

    on: bool = True
    key: str = "workspace"
    locus: bool = True


@dataclass(frozen=True, slots=True)
class Review:
    """Everything a review consists of; equal reviews look the same.

    ``modes`` says which working modes the workspace is of: all, the current one, or a set;
    ``surface`` what its solid is made of. ``gives_way`` is the key of the pose coordinate that
    follows from the others, where a mechanism has such; "" leaves that to the mechanism.
    """

    design: Design
    pose: tuple[float, ...]
    mode: str
    modes: ModeChoice | tuple[str, ...] = "all"
    solids: tuple[Shown, ...] = (Shown("workspace", 0.35),)
    options: Options = Options()
    atlas: Atlas = Atlas()
    cut: Cut = Cut()
    chart: Chart = Chart()
    surface: SurfaceKind = "facets"
    control: Control = Control()
    gives_way: str = ""
    flat: Flat = Flat()
    plan: Plan = NO_PLAN

    @property
    def machine(self) -> Machine[Any]:
        return machine_of(self.design)

    @property
    def dependent(self) -> int | None:
        """The pose coordinate that gives way; None where that is left to the mechanism."""
        axes = self.machine.coordinates
        return next((n for n, c in enumerate(axes) if c.key == self.gives_way), None)

    @property
    def posture(self) -> Posture:
        return self.machine.inverse.posture(self.pose, self.mode)

    @property
    def solver_modes(self) -> tuple[str, ...] | None:
        """The working modes as solvers take them: None means all together."""
        if self.modes == "all":
            return None
        return (self.mode,) if self.modes == "current" else tuple(self.modes)

    def shown(self, key: str) -> Shown | None:
        return next((s for s in self.solids if s.key == key), None)


def new_review(design: Design) -> Review:
    """A review of ``design`` at its home posture."""
    home = machine_of(design).home
    review = Review(design, home.pose, home.mode)
    # A solid in another space than the machine's is shown when it is asked for.
    known = {spec.key for spec in review.machine.solid_specs if not spec.of_present_mode}
    return replace(
        review,
        solids=tuple(s for s in review.solids if s.key in known),
        cut=Cut(at=point_in_section(review)[0]),
        plan=fresh_plan(review),
        control=Control(load=usual_load(review)),
    )


def is_planar(review: Review) -> bool:
    """Whether the platform moves in a plane, x and y."""
    axes = review.machine.coordinates
    return all(axis.key in ("x", "y") for axis in axes)


def usual_load(review: Review) -> tuple[float, ...]:
    """100 N downwards, as the machine stands on the page: [F, T], N and N·mm."""
    return (0.0, -100.0, 0.0, 0.0, 0.0, 0.0) if is_planar(review) else Control().load


def point_in_section(review: Review) -> tuple[float, float, float]:
    """The platform's position (mm) in the frame of sections: along the normal, then in the plane.

    Zeros for a mechanism that has no sections.
    """
    machine = review.machine
    if machine.sections is None:
        return 0.0, 0.0, 0.0
    frame = machine.sections.frame(review.pose)
    position = machine.transform(review.pose, review.mode)[:3, 3]
    x, y, z = frame[:3, :3].T @ (position - frame[:3, 3])
    return float(x), float(y), float(z)


def within_reach(review: Review, at: float) -> tuple[float, str]:
    """A plane's place (mm), kept where something can be, and a sentence if it had to be kept.

    Raises:
        InputError: it is no finite number.
    """
    spec = review.machine.section_spec
    name = "the section" if spec is None else spec.normal
    sides = [max(abs(c.lower), abs(c.upper)) for c in review.machine.coordinates if c.unit == "mm"]
    far = max(FAR, float(math.ceil(math.hypot(*sides))))
    return within(Coordinate("at", name, "mm", -far, far), at)


def checked_chart(chart: Chart, review: Review) -> Chart:
    """The same, once it is known to be sound; its spans within the coordinates' ranges.

    Raises:
        InputError: the mechanism has no such map, or a span is none.
    """
    spec = review.machine.map_spec
    if spec is None:
        raise InputError("this mechanism has no map")
    known = [quantity.key for quantity in spec.quantities]
    if chart.quantity not in known:
        raise InputError(f"a map shows {', '.join(known)}, not {chart.quantity!r}")
    coordinates = review.machine.coordinates
    for index, span in zip(spec.axes, (chart.first, chart.second), strict=True):
        symbol = coordinates[index].symbol
        if not (math.isfinite(span.low) and math.isfinite(span.high)):
            raise InputError(f"the ends of {symbol} must be finite numbers")
        if span.low >= span.high:
            raise InputError(f"{symbol} must end above where it begins")
        if not 2 <= span.count <= MAX_CELLS:
            raise InputError(f"a map has from 2 to {MAX_CELLS} values of {symbol}")
        for end in (span.low, span.high):
            if beyond := within(coordinates[index], end)[1]:
                raise InputError(beyond.replace("is kept", "must stay"))
    return chart


def checked_control(control: Control, review: Review) -> Control:
    """The same, once it is known to be sound.

    Raises:
        InputError: the mechanism has no such measure or chart, or the load is not six finite
            numbers.
    """
    machine = review.machine
    measures = [measure.key for measure in machine.measures.specs]
    if control.shade and control.shade not in measures:
        raise InputError(f"colour shows {', '.join(measures)}, not {control.shade!r}")
    charts = [spec.key for spec in machine.singularities.loci]
    if control.chart and control.chart not in charts:
        raise InputError(f"a chart of loci is one of {', '.join(charts)}, not {control.chart!r}")
    if any(not (math.isfinite(r) and 0.0 < r <= MAX_RATIO) for r in control.ratios):
        raise InputError(f"a ratio is a positive number up to {MAX_RATIO:g}")
    if len(control.ratios) > MAX_RATIOS:
        raise InputError(f"at most {MAX_RATIOS} ratios can be compared")
    axes = machine.coordinates
    for name, values in (("rates", control.rates), ("accelerations", control.accelerations)):
        if values and (len(values) != len(axes) or not all(abs(v) <= LARGEST for v in values)):
            symbols = ", ".join(c.symbol for c in axes)
            raise InputError(f"{name} are {len(axes)} numbers within ±{LARGEST:.0e}, of {symbols}")
    if len(control.load) != 6 or not all(abs(v) <= LARGEST for v in control.load):
        raise InputError(
            f"a load is six numbers within ±{LARGEST:.0e}: three forces (N), three moments (N·mm)"
        )
    return control


def checked_way(key: str, review: Review) -> str:
    """The same, once it is known to be a coordinate that may give way, or "".

    Raises:
        InputError: it is none.
    """
    axes = review.machine.coordinates
    known = [axes[n].key for n in review.machine.dependent]
    if key and key not in known:
        raise InputError(f"what gives way is one of {', '.join(known)}, not {key!r}")
    return key


def checked_flat(flat: Flat, review: Review) -> Flat:
    """The same, once it is known to be sound.

    Raises:
        InputError: the mechanism has no such regions.
    """
    known = [spec.key for spec in review.machine.region_specs]
    if known and flat.key not in known:
        raise InputError(f"regions are {', '.join(known)}, not {flat.key!r}")
    return flat


def checked(atlas: Atlas, machine: Machine[Any]) -> Atlas:
    """The same, once it is known to be sound.

    Raises:
        InputError: there is no such order, or a filter that is no working mode.
    """
    if atlas.sort not in SORTS:
        raise InputError(f"solutions are sorted by {', '.join(SORTS)}, not by {atlas.sort!r}")
    if atlas.modes not in ("", SAME_MODE):
        matching(atlas.modes, machine.modes)
    return atlas


def within(coordinate: Coordinate, value: float) -> tuple[float, str]:
    """A typed number, kept finite and in the range that is offered."""
    if not math.isfinite(value):
        raise InputError(f"{coordinate.symbol} must be a finite number")
    kept = min(max(value, coordinate.lower), coordinate.upper)
    # A round trip through degrees may leave the range by an ulp; that is not worth a sentence.
    if abs(kept - value) <= 1e-9 * max(1.0, abs(value)):
        return kept, ""
    scale, unit = (1.0, "mm") if coordinate.unit == "mm" else (180.0 / math.pi, "°")
    return kept, (
        f"{coordinate.symbol} is kept within {coordinate.lower * scale:g} … ".replace("-", "−")
        + f"{coordinate.upper * scale:g} {unit}."
    )
