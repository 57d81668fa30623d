"""What a person can do to a review: plain values, and the pure function that takes them.

Lengths in mm and angles in rad; whoever reads a widget converts. Nothing here knows viser.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from app.features.trajectory.state import checked_plan, plan_for
from app.review.state import (
    Atlas,
    Chart,
    Control,
    Flat,
    ModeChoice,
    Review,
    Shown,
    checked,
    checked_chart,
    checked_control,
    checked_flat,
    checked_way,
    new_review,
    usual_load,
    within,
    within_reach,
)
from kinematics.errors import InputError
from kinematics.facets.solids import SurfaceKind
from kinematics.machine import Machine
from kinematics.mechanism import Coordinate, Design

# --- ``gesture`` joins the steps of one drag for undo


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
class SetControl:
    """Set one thing of what is shown of control; the value is of the kind that `Control` has."""

    name: str
    value: bool | str | tuple[float, ...]

    @property
    def gesture(self) -> str:
        return f"control {self.name}" if isinstance(self.value, tuple) else ""


@dataclass(frozen=True, slots=True)
class SetFlat:
    """Set one thing of how plane regions are shown."""

    name: str
    value: bool | str
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class SetPlan:
    """Set some things of the trajectory, by name; values are of the kinds that `Plan` has."""

    values: tuple[tuple[str, Any], ...]
    gesture: str = ""


@dataclass(frozen=True, slots=True)
class GiveWay:
    """Which pose coordinate follows from the others; "" leaves that to the mechanism."""

    key: str
    gesture: str = ""


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
    | SetControl
    | GiveWay
    | SetFlat
    | SetPlan
    | Restore
)


def change(review: Review, what: Change) -> tuple[Review, str]:
    """The review after ``what``, and a sentence about it for the user ("" when all went well).

    Raises:
        InputError: the change cannot be taken; the review stays as it is.
    """
    match what:
        case Move(index, value):
            coordinate = _nth(review.machine.coordinates, index)
            value, note = within(coordinate, value)
            pose = (*review.pose[:index], value, *review.pose[index + 1 :])
            return replace(review, pose=_completed(review, pose, index)), note
        case Place(pose):
            coordinates = review.machine.coordinates
            if len(pose) != len(coordinates):
                raise InputError(f"a pose of this mechanism has {len(coordinates)} numbers")
            taken = [within(c, v) for c, v in zip(coordinates, pose, strict=True)]
            notes = " ".join(note for _, note in taken if note)
            pose = _completed(review, tuple(value for value, _ in taken))
            return replace(review, pose=pose), notes
        case Drive(index, value):
            return _drive(review, index, value)
        case Flip(mode):
            return _flip(review, mode), ""
        case Visit(pose, mode):
            # Not kept within the sliders' range: a solution next to it would be none.
            known = mode in review.machine.modes and len(pose) == len(review.pose)
            if not known or not all(map(math.isfinite, pose)):
                raise InputError("that is not a solution of this mechanism")
            return replace(review, pose=tuple(pose), mode=mode), ""
        case GoHome():
            home = review.machine.home
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
            if isinstance(modes, tuple) and not set(modes) <= set(review.machine.modes):
                raise InputError(f"these are no {review.machine.mode_noun}s of this mechanism")
            return replace(review, modes=modes), ""
        case ChooseSurface(surface):
            return replace(review, surface=surface), ""
        case SetOption(name, on):
            return replace(review, options=replace(review.options, **{name: on})), ""
        case SetAtlas(name, value):
            wanted = replace(review.atlas, **{name: value})  # type: ignore[arg-type]
            return replace(review, atlas=checked(wanted, review.machine)), ""
        case ShowCut(on):
            return replace(review, cut=replace(review.cut, on=on)), ""
        case MoveCut(at):
            at, note = within_reach(review, at)
            return replace(review, cut=replace(review.cut, at=at)), note
        case SetChart(chart):
            return replace(review, chart=checked_chart(chart, review)), ""
        case SetControl(name, value):
            control = replace(review.control, **{name: value})  # type: ignore[arg-type]
            return replace(review, control=checked_control(control, review)), ""
        case SetFlat(name, value):
            flat = replace(review.flat, **{name: value})  # type: ignore[arg-type]
            return replace(review, flat=checked_flat(flat, review)), ""
        case SetPlan(values):
            plan = replace(review.plan, **dict(values))
            return replace(review, plan=checked_plan(plan, review)), ""
        case GiveWay(key):
            return replace(review, gives_way=checked_way(key, review)), ""
        case Restore(saved):
            return saved, ""


def _nth(coordinates: tuple[Coordinate, ...], index: int) -> Coordinate:
    """The coordinate that a slider moves; another design may have come in between."""
    if not 0 <= index < len(coordinates):
        raise InputError(f"this mechanism has {len(coordinates)} such coordinates only")
    return coordinates[index]


def _completed(
    review: Review, pose: tuple[float, ...], moved: int | None = None
) -> tuple[float, ...]:
    machine = review.machine
    return machine.complete_pose(pose, review.mode, moved, review.dependent)


def _flip(review: Review, mode: str) -> Review:
    """In another mode: at once where limbs can be put over, else where the modes meet."""
    machine = review.machine
    if mode not in machine.modes:
        raise InputError(f"there is no {machine.mode_noun} {mode!r}")
    way = machine.singularities.mode_change(review.posture, mode)
    if way is None or mode == review.mode:
        return replace(review, mode=mode)
    if not way.here:
        raise InputError(way.text)
    return replace(review, pose=way.other.pose, mode=way.other.mode)


def _drive(review: Review, index: int, value: float) -> tuple[Review, str]:
    coordinate = _nth(review.machine.joints, index)
    value, note = within(coordinate, value)
    posture = review.posture
    if not posture.closes:
        limbs = [r.limb for r in posture.reasons if r.bound == "link"]
        what = f"limb {limbs[0]} cannot close here" if limbs else "it cannot close here"
        raise InputError(
            f"the actuators cannot move a machine that is not assembled: {what}; bring the "
            f"platform back within its reach first"
        )
    joints = list(posture.joints)
    joints[index] = value
    followed = review.machine.following.follow(posture, joints)
    reached = replace(review, pose=followed.posture.pose, mode=followed.posture.mode)
    return reached, followed.text or followed.warning or note


def _use_design(review: Review, design: Design) -> Review:
    fresh = new_review(design)
    known = {spec.key for spec in fresh.machine.solid_specs}
    modes = review.modes
    if isinstance(modes, tuple) and not set(modes) <= set(fresh.machine.modes):
        modes = "all"
    return replace(
        fresh,
        modes=modes,
        # Another kind of machine is shown as it is at first.
        solids=tuple(s for s in review.solids if s.key in known)
        if design.mechanism == review.design.mechanism
        else fresh.solids,
        options=review.options,
        atlas=_atlas_for(fresh.machine, review.atlas),
        cut=replace(fresh.cut, on=review.cut.on),
        chart=_chart_for(fresh, review.chart),
        surface=review.surface,
        control=_control_for(fresh, review),
        flat=_flat_for(fresh, review.flat),
        gives_way=_way_for(fresh, review.gives_way),
        plan=plan_for(fresh, review.plan),
    )


def _atlas_for(machine: Machine[Any], atlas: Atlas) -> Atlas:
    try:
        return checked(atlas, machine)
    except InputError:  # a filter in another mechanism's working modes
        return replace(atlas, modes="")


def _chart_for(review: Review, chart: Chart) -> Chart:
    try:
        return checked_chart(chart, review)
    except InputError:
        return review.chart


def _control_for(review: Review, before: Review) -> Control:
    """Without the measure, the chart or the rates that the other mechanism has not."""
    control = before.control
    if control.load == usual_load(before):
        control = replace(control, load=usual_load(review))
    for name, nothing in (("shade", ""), ("chart", ""), ("rates", ()), ("accelerations", ())):
        try:
            checked_control(replace(Control(), **{name: getattr(control, name)}), review)
        except InputError:
            control = replace(control, **{name: nothing})  # type: ignore[arg-type]
    return control


def _flat_for(review: Review, flat: Flat) -> Flat:
    try:
        return checked_flat(flat, review)
    except InputError:
        return replace(flat, key=review.flat.key)


def _way_for(review: Review, key: str) -> str:
    try:
        return checked_way(key, review)
    except InputError:
        return ""


def _edit(
    review: Review, edits: tuple[tuple[tuple[str | int, ...], float], ...]
) -> tuple[Review, str]:
    machine = review.machine
    for path, value in edits:
        machine = machine.edited(path, value)
    coordinates = review.machine.coordinates
    pose = tuple(within(c, v)[0] for c, v in zip(coordinates, review.pose, strict=True))
    edited = replace(review, design=machine.design, pose=pose)
    try:
        return replace(edited, pose=_completed(edited, pose)), ""
    except InputError:  # what the new numbers ask of the pose nothing can give; that is told there
        return edited, ""


_OPACITY = {"workspace": 0.35, "aspects": 0.5}  # a limb's parts are fainter


def _show(review: Review, key: str, on: bool) -> Review:
    specs = {spec.key: n for n, spec in enumerate(review.machine.solid_specs)}
    if key not in specs:
        raise InputError(f"there is no solid {key!r}")
    kept = [s for s in review.solids if s.key != key]
    if on:
        kept.append(review.shown(key) or Shown(key, _OPACITY.get(key, 0.25)))
    return replace(review, solids=tuple(sorted(kept, key=lambda s: specs[s.key])))
