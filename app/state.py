"""The whole state of a review: one frozen value, and the pure function that changes it.

Lengths in mm and angles in rad; whoever reads a widget converts. Nothing here knows viser.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from app.modes import matching
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate, Design, Mechanism, SurfaceKind, mechanism
from kinematics.solutions import Posture

ModeChoice = Literal["all", "current"]
Sort = Literal["distance", "condition", "height", "mode"]
SORTS: tuple[Sort, ...] = ("distance", "condition", "height", "mode")
SAME_MODE = "same"
QUIET_GAP = 1.0  # s; a gesture that pauses longer than this becomes a step of its own in undo
MAX_HISTORY = 300
FAR = 1e4  # mm; a plane may stand this far off, where it cuts nothing
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
    working mode, else patterns that `app.modes.matching` understands.
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
class Review:
    """Everything a review consists of; equal reviews look the same.

    ``modes`` says which working modes the workspace is of: all, the current one, or a set;
    ``surface`` what its solid is made of.
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

    @property
    def mechanism(self) -> Mechanism:
        return mechanism(self.design.mechanism)

    @property
    def posture(self) -> Posture:
        return self.mechanism.posture(self.design, self.pose, self.mode)

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
    home = mechanism(design.mechanism).home(design)
    review = Review(design, home.pose, home.mode)
    return replace(review, cut=Cut(at=point_in_section(review)[0]))


def point_in_section(review: Review) -> tuple[float, float, float]:
    """The platform's position (mm) in the frame of sections: along the normal, then in the plane.

    Zeros for a mechanism that has no sections.
    """
    kind, design = review.mechanism, review.design
    if kind.section_spec(design) is None:
        return 0.0, 0.0, 0.0
    frame = kind.section_frame(design, review.pose)
    position = kind.transform(design, review.pose)[:3, 3]
    x, y, z = frame[:3, :3].T @ (position - frame[:3, 3])
    return float(x), float(y), float(z)


# --- changes: what a person can do. ``gesture`` joins the steps of one drag for undo --------


@dataclass(frozen=True, slots=True)
class Move:
    """Set one pose coordinate."""

    index: int
    value: float

    @property
    def gesture(self) -> str:
        return f"move {self.index}"


@dataclass(frozen=True, slots=True)
class Place:
    """Set the whole pose, as when the platform is dragged.

    ``held`` numbers the grips of a hand: one grip is one step of undo, however long it pauses.
    """

    pose: tuple[float, ...]
    gesture: str = "place"
    held: int = 0


@dataclass(frozen=True, slots=True)
class Drive:
    """Set one actuated joint; the platform follows along its assembly mode."""

    index: int
    value: float

    @property
    def gesture(self) -> str:
        return f"drive {self.index}"


@dataclass(frozen=True, slots=True)
class Flip:
    """Put the whole machine into a working mode, at the same pose."""

    mode: str
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class Visit:
    """Put the machine into another assembly mode: a pose and a working mode, taken as they are."""

    pose: tuple[float, ...]
    mode: str
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class GoHome:
    """Back to the design's home posture."""

    gesture: str = ""


@dataclass(frozen=True, slots=True)
class UseDesign:
    """Review another design, from its home posture."""

    design: Design
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class EditDesign:
    """Set some numbers of the design; the pose stays."""

    edits: tuple[tuple[tuple[str | int, ...], float], ...]

    @property
    def gesture(self) -> str:
        return f"edit {self.edits[0][0][:-1]}"


@dataclass(frozen=True, slots=True)
class Show:
    """Show or hide a solid."""

    key: str
    on: bool
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class Fade:
    """Set the opacity of solids, shown or not yet."""

    keys: tuple[str, ...]
    opacity: float

    @property
    def gesture(self) -> str:
        return f"fade {self.keys}"


@dataclass(frozen=True, slots=True)
class ChooseSurface:
    """What the workspace's solid is made of: facets, or the true surface."""

    surface: SurfaceKind
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class ChooseModes:
    """Which working modes the workspace is of."""

    modes: ModeChoice | tuple[str, ...]
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class SetOption:
    """Switch something that is drawn."""

    name: str
    on: bool
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class SetAtlas:
    """Set one thing about how solutions are shown; the value is of the kind that `Atlas` has."""

    name: str
    value: bool | str

    @property
    def gesture(self) -> str:
        return f"atlas {self.name}" if isinstance(self.value, str) else ""


@dataclass(frozen=True, slots=True)
class ShowCut:
    """Show or hide the section."""

    on: bool
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class MoveCut:
    """Set where the section's plane stands, mm; ``held`` as in `Place`."""

    at: float
    gesture: str = "cut"
    held: int = 0


@dataclass(frozen=True, slots=True)
class SetChart:
    """Set what a map shows and over which orientations."""

    chart: Chart
    gesture: str = "chart"


@dataclass(frozen=True, slots=True)
class Restore:
    """Open a saved review."""

    review: Review
    gesture: str = ""


Change = (
    Move
    | Place
    | Drive
    | Flip
    | Visit
    | GoHome
    | UseDesign
    | EditDesign
    | Show
    | Fade
    | ChooseModes
    | ChooseSurface
    | SetOption
    | SetAtlas
    | ShowCut
    | MoveCut
    | SetChart
    | Restore
)


def change(review: Review, what: Change) -> tuple[Review, str]:
    """The review after ``what``, and a sentence about it for the user ("" when all went well).

    Raises:
        InputError: the change cannot be taken; the review stays as it is.
    """
    match what:
        case Move(index, value):
            coordinate = review.mechanism.pose_coordinates(review.design)[index]
            value, note = _within(coordinate, value)
            pose = (*review.pose[:index], value, *review.pose[index + 1 :])
            return replace(review, pose=pose), note
        case Place(pose):
            coordinates = review.mechanism.pose_coordinates(review.design)
            taken = [_within(c, v) for c, v in zip(coordinates, pose, strict=True)]
            notes = " ".join(note for _, note in taken if note)
            return replace(review, pose=tuple(value for value, _ in taken)), notes
        case Drive(index, value):
            return _drive(review, index, value)
        case Flip(mode):
            if mode not in review.mechanism.modes:
                raise InputError(f"there is no working mode {mode!r}")
            return replace(review, mode=mode), ""
        case Visit(pose, mode):
            # Not kept within the sliders' range: a solution next to it would be none.
            if mode not in review.mechanism.modes or not all(map(math.isfinite, pose)):
                raise InputError("that is not a solution of this mechanism")
            return replace(review, pose=tuple(pose), mode=mode), ""
        case GoHome():
            home = review.mechanism.home(review.design)
            return replace(review, pose=home.pose, mode=home.mode), ""
        case UseDesign(design):
            return _use_design(review, design), ""
        case EditDesign(edits):
            return _edit(review, edits)
        case Show(key, on):
            return _show(review, key, on), ""
        case Fade(keys, opacity):
            if not 0.0 <= opacity <= 1.0:
                raise InputError("an opacity lies between 0 and 1")
            solids = tuple(Shown(s.key, opacity) if s.key in keys else s for s in review.solids)
            return replace(review, solids=solids), ""
        case ChooseModes(modes):
            return replace(review, modes=modes), ""
        case ChooseSurface(surface):
            return replace(review, surface=surface), ""
        case SetOption(name, on):
            return replace(review, options=replace(review.options, **{name: on})), ""
        case SetAtlas(name, value):
            wanted = replace(review.atlas, **{name: value})  # type: ignore[arg-type]
            return replace(review, atlas=checked(wanted, review.mechanism)), ""
        case ShowCut(on):
            return replace(review, cut=replace(review.cut, on=on)), ""
        case MoveCut(at):
            at, note = within_reach(review, at)
            return replace(review, cut=replace(review.cut, at=at)), note
        case SetChart(chart):
            return replace(review, chart=checked_chart(chart, review)), ""
        case Restore(saved):
            return saved, ""


def within_reach(review: Review, at: float) -> tuple[float, str]:
    """A plane's place (mm), kept where something can be, and a sentence if it had to be kept.

    Raises:
        InputError: it is no finite number.
    """
    spec = review.mechanism.section_spec(review.design)
    name = "the section" if spec is None else spec.normal
    sides = [
        max(abs(c.lower), abs(c.upper))
        for c in review.mechanism.pose_coordinates(review.design)
        if c.unit == "mm"
    ]
    far = max(FAR, float(math.ceil(math.hypot(*sides))))
    return _within(Coordinate("at", name, "mm", -far, far), at)


def checked_chart(chart: Chart, review: Review) -> Chart:
    """The same, once it is known to be sound; its spans within the coordinates' ranges.

    Raises:
        InputError: the mechanism has no such map, or a span is none.
    """
    spec = review.mechanism.map_spec(review.design)
    if spec is None:
        raise InputError("this mechanism has no map")
    known = [quantity.key for quantity in spec.quantities]
    if chart.quantity not in known:
        raise InputError(f"a map shows {', '.join(known)}, not {chart.quantity!r}")
    coordinates = review.mechanism.pose_coordinates(review.design)
    for index, span in zip(spec.axes, (chart.first, chart.second), strict=True):
        symbol = coordinates[index].symbol
        if not (math.isfinite(span.low) and math.isfinite(span.high)):
            raise InputError(f"the ends of {symbol} must be finite numbers")
        if span.low >= span.high:
            raise InputError(f"{symbol} must end above where it begins")
        if not 2 <= span.count <= MAX_CELLS:
            raise InputError(f"a map has from 2 to {MAX_CELLS} values of {symbol}")
        for end in (span.low, span.high):
            if beyond := _within(coordinates[index], end)[1]:
                raise InputError(beyond.replace("is kept", "must stay"))
    return chart


def checked(atlas: Atlas, kind: Mechanism) -> Atlas:
    """The same, once it is known to be sound.

    Raises:
        InputError: there is no such order, or a filter that is no working mode.
    """
    if atlas.sort not in SORTS:
        raise InputError(f"solutions are sorted by {', '.join(SORTS)}, not by {atlas.sort!r}")
    if atlas.modes not in ("", SAME_MODE):
        matching(atlas.modes, kind.modes)
    return atlas


def _within(coordinate: Coordinate, value: float) -> tuple[float, str]:
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


def _drive(review: Review, index: int, value: float) -> tuple[Review, str]:
    coordinate = review.mechanism.joint_coordinates(review.design)[index]
    value, note = _within(coordinate, value)
    posture = review.posture
    if not posture.closes:
        open_limb = next(r.limb for r in posture.reasons if r.bound == "link")
        raise InputError(
            f"the actuators cannot move a machine that is not assembled: limb {open_limb} cannot "
            f"close here; bring the platform back within its reach first"
        )
    joints = list(posture.joints)
    joints[index] = value
    followed = review.mechanism.follow(review.design, posture, joints)
    reached = replace(review, pose=followed.posture.pose, mode=followed.posture.mode)
    return reached, followed.text or note


def _use_design(review: Review, design: Design) -> Review:
    fresh = new_review(design)
    known = {spec.key for spec in fresh.mechanism.solids(design)}
    modes = review.modes
    if isinstance(modes, tuple) and not set(modes) <= set(fresh.mechanism.modes):
        modes = "all"
    return replace(
        fresh,
        modes=modes,
        solids=tuple(s for s in review.solids if s.key in known),
        options=review.options,
        atlas=_atlas_for(fresh.mechanism, review.atlas),
        cut=replace(fresh.cut, on=review.cut.on),
        chart=_chart_for(fresh, review.chart),
        surface=review.surface,
    )


def _atlas_for(kind: Mechanism, atlas: Atlas) -> Atlas:
    try:
        return checked(atlas, kind)
    except InputError:  # a filter in another mechanism's working modes
        return replace(atlas, modes="")


def _chart_for(review: Review, chart: Chart) -> Chart:
    try:
        return checked_chart(chart, review)
    except InputError:
        return review.chart


def _edit(
    review: Review, edits: tuple[tuple[tuple[str | int, ...], float], ...]
) -> tuple[Review, str]:
    design = review.design
    for path, value in edits:
        design = review.mechanism.with_field(design, path, value)
    coordinates = review.mechanism.pose_coordinates(design)
    pose = tuple(_within(c, v)[0] for c, v in zip(coordinates, review.pose, strict=True))
    return replace(review, design=design, pose=pose), ""


def _show(review: Review, key: str, on: bool) -> Review:
    specs = {spec.key: n for n, spec in enumerate(review.mechanism.solids(review.design))}
    if key not in specs:
        raise InputError(f"there is no solid {key!r}")
    kept = [s for s in review.solids if s.key != key]
    if on:
        kept.append(review.shown(key) or Shown(key, 0.35 if key == "workspace" else 0.25))
    return replace(review, solids=tuple(sorted(kept, key=lambda s: specs[s.key])))


# --- undo and redo ------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class History:
    """A review with its past and its undone future."""

    present: Review
    past: tuple[Review, ...] = ()
    future: tuple[Review, ...] = ()
    gesture: str = ""
    changed_at: float = -math.inf
    held: int = 0

    def apply(self, what: Change, now: float) -> tuple[History, str]:
        """The history after a change; the steps of one drag become one step of undo."""
        present, note = change(self.present, what)
        if present == self.present:
            return self, note
        held = what.held if isinstance(what, Place | MoveCut) else 0
        joined = (
            bool(what.gesture)
            and what.gesture == self.gesture
            and (now - self.changed_at < QUIET_GAP or 0 != held == self.held)
            and not self.future
        )
        past = self.past if joined else (*self.past, self.present)[-MAX_HISTORY:]
        return History(present, past, (), what.gesture, now, held), note

    def undo(self) -> History:
        if not self.past:
            return self
        return History(self.past[-1], self.past[:-1], (self.present, *self.future))

    def redo(self) -> History:
        if not self.future:
            return self
        return History(self.future[0], (*self.past, self.present), self.future[1:])
