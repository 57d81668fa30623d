"""Which workspaces are on display, of which modes, and how: solids and regions of a plane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Literal, Self

from app.language import tr
from app.review import content as session
from app.review.changes import Change, SetOne, Taken
from app.review.state import Review, Slice
from kinematics.errors import InputError
from kinematics.facets.solids import SURFACES, SurfaceKind

ModeChoice = Literal["all", "current"]
KEY = "workspace"
"""The key of the workspace's solid, and of its region."""
ASPECTS = "aspects"
"""The key of the solid that is parted by singular surfaces."""
_OPACITY = {"workspace": 0.35, ASPECTS: 0.5}
LIMB_OPACITY = 0.25


@dataclass(frozen=True, slots=True)
class Shown:
    """One solid that is on display."""

    key: str
    opacity: float


def usual_opacity(key: str) -> float:
    """How opaque a solid is at first."""
    return _OPACITY.get(key, LIMB_OPACITY)


@dataclass(frozen=True)
class Workspace(Slice):
    """The solids on display.

    ``modes`` says which working modes the workspace is of: all, the current one, or a set;
    ``surface`` what its solid is made of.
    """

    filed_as: ClassVar[str] = "workspace"
    LOOKS: ClassVar[frozenset[str]] = frozenset(("solids",))
    modes: ModeChoice | tuple[str, ...] = "all"
    solids: tuple[Shown, ...] = (Shown("workspace", _OPACITY["workspace"]),)
    surface: SurfaceKind = SURFACES[0]

    @classmethod
    def fresh(cls, review: Review) -> Self:
        # A solid in another space than the machine's is shown when it is asked for.
        known = {spec.key for spec in review.machine.solid_specs if spec.places}
        # A machine cannot change its mode on the way: what it can reach is that of its own.
        return cls("current", tuple(s for s in cls.solids if s.key in known))

    def checked(self, review: Review) -> Self:
        machine = review.machine
        if isinstance(self.modes, tuple) and not set(self.modes) <= set(machine.modes):
            raise InputError(tr("workspace.no_modes"))
        return self

    def carried(self, before: Review, review: Review) -> Self:
        machine = review.machine
        known = {spec.key for spec in machine.solid_specs}
        solids = review[type(self)].solids
        if review.design.mechanism == before.design.mechanism:
            solids = tuple(s for s in self.solids if s.key in known)
        # Another kind of machine is shown as it is at first.
        lost = isinstance(self.modes, tuple) and not set(self.modes) <= set(machine.modes)
        return replace(self, solids=solids, modes="all" if lost else self.modes)

    def shown(self, key: str) -> Shown | None:
        """How a solid is shown; None if it is not."""
        return next((s for s in self.solids if s.key == key), None)

    def written(self, review: Review) -> dict[str, Any]:
        return {
            "workspace_modes": self.modes,
            "workspace_surface": self.surface,
            "solids": {s.key: s.opacity for s in self.solids},
        }

    @classmethod
    def read(cls, content: dict[str, Any], review: Review, origin: str) -> Self:
        machine = review.machine
        modes = content.get("workspace_modes", "all")
        if isinstance(modes, list):
            modes = tuple(modes)
            session.checked_modes(modes, machine, origin)
        elif modes not in ("all", "current"):
            raise InputError(tr("session.modes", what=f"{origin}: workspace_modes"))
        known = {spec.key for spec in machine.solid_specs}
        solids = tuple(
            Shown(key, min(max(session.number(value, f"{origin}: solids: {key}"), 0.0), 1.0))
            for key, value in session.typed(content, "solids", dict, origin).items()
            if key in known
        )
        surface = content.get("workspace_surface", cls.surface)
        if surface not in SURFACES:
            known_as = ", ".join(map(repr, SURFACES))
            what = f"{origin}: workspace_surface"
            raise InputError(tr("session.one_of", what=what, known=known_as))
        return cls(modes, solids, surface)


@dataclass(frozen=True)
class Flat(Slice):
    """Regions of a workspace that lies in a plane: whether they are on display, and which."""

    filed_as: ClassVar[str] = "regions"
    LOOKS: ClassVar[frozenset[str]] = frozenset(("on", "key", "locus"))
    on: bool = True
    key: str = "workspace"
    locus: bool = True

    def checked(self, review: Review) -> Self:
        known = [spec.key for spec in review.machine.region_specs]
        if known:
            session.listed(self.key, known, tr("workspace.regions_are"))
        return self


def solver_modes(review: Review) -> tuple[str, ...] | None:
    """The modes that the workspace is of, as solvers take them: None means all together."""
    modes = review[Workspace].modes
    if modes == "all":
        return None
    return (review.mode,) if modes == "current" else tuple(modes)


def modes_text(review: Review) -> str:
    """Which modes the workspace is of, in a few words."""
    modes, machine = review[Workspace].modes, review.machine
    if len(machine.modes) == 1:
        return tr("workspace.it")
    if modes == "all":
        return tr("workspace.every_mode")
    return tr("workspace.this_mode" if modes == "current" else "workspace.some", n=len(modes))


def colour_text(review: Review) -> str:
    """What the workspace's colour stands for."""
    name = tr("workspace.legend")
    return name if len(review.machine.modes) == 1 else f"{name}, {modes_text(review)}"


@dataclass(frozen=True)
class Show(Change):
    """Show or hide a solid."""

    key: str
    on: bool

    def title(self, before: Review, after: Review) -> str:
        spec = next(spec for spec in after.machine.solid_specs if spec.key == self.key)
        return tr("workspace.shown" if self.on else "workspace.hidden", what=spec.title)

    def apply(self, review: Review) -> Taken:
        specs = {spec.key: n for n, spec in enumerate(review.machine.solid_specs)}
        if self.key not in specs:
            raise InputError(tr("workspace.no_such", key=self.key))
        before = review[Workspace]
        kept = [s for s in before.solids if s.key != self.key]
        if self.on:
            kept.append(before.shown(self.key) or Shown(self.key, usual_opacity(self.key)))
        solids = tuple(sorted(kept, key=lambda s: specs[s.key]))
        return review.having(replace(before, solids=solids)), ""


@dataclass(frozen=True)
class Fade(Change):
    """Set the opacity of solids, shown or not yet."""

    keys: tuple[str, ...]
    opacity: float

    @property
    def gesture(self) -> str:
        return f"fade {self.keys}"

    def title(self, before: Review, after: Review) -> str:
        return tr("workspace.faded", opacity=self.opacity)

    def apply(self, review: Review) -> Taken:
        if not 0.0 <= self.opacity <= 1.0:
            raise InputError(tr("workspace.opacity_is"))
        before = review[Workspace]
        solids = tuple(
            Shown(s.key, self.opacity) if s.key in self.keys else s for s in before.solids
        )
        return review.having(replace(before, solids=solids)), ""


ChooseModes = partial(SetOne, Workspace, "modes")
"""Which working modes the workspace is of."""
ChooseSurface = partial(SetOne, Workspace, "surface")
"""What the workspace's solid is made of: facets, or the true surface."""
SetFlat = partial(SetOne, Flat)
"""Set one thing of how plane regions are shown."""
