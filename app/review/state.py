"""The whole state of a review as one frozen value: where the machine stands, and a slice for each
feature.

Lengths in mm and angles in rad; whoever reads a widget converts. Nothing here knows viser, nor any
feature: their slices are found in the files `state` of their folders.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any, ClassVar, Self, TypeVar

from app.features import each
from app.language import tr
from app.review import content as session
from kinematics.answers.solutions import Posture
from kinematics.errors import InputError
from kinematics.machine import Machine, machine_of
from kinematics.mechanism import Design


@dataclass(frozen=True)
class Slice:
    """What one feature keeps of a review: a frozen value in which every field has a default.

    Attributes:
        filed_as: what it is called in a session file.
        LOOKS: the names of those fields that only say how something is shown.
    """

    filed_as: ClassVar[str]
    LOOKS: ClassVar[frozenset[str]] = frozenset()

    @classmethod
    def fresh(cls, review: Review) -> Self:
        """That of a machine which nobody has touched; the review has no slice of this kind yet."""
        return cls()

    @classmethod
    def gesture(cls, name: str, value: Any) -> str:
        """What joins the steps of one drag that sets a field, for undo; "" for nothing."""
        return ""

    def checked(self, review: Review) -> Self:
        """The same, once it is known to be sound.

        Raises:
            InputError: it cannot be of this review's machine.
        """
        return self

    def carried(self, before: Review, review: Review) -> Self:
        """What of it serves another machine; the review has that one's fresh slice."""
        kept = review[type(self)]
        for f in fields(self):
            with suppress(InputError):
                kept = replace(kept, **{f.name: getattr(self, f.name)}).checked(review)
        return kept

    # --- in a session file

    def written(self, review: Review) -> dict[str, Any]:
        """What `read` reads, by its keys in the file."""
        return {self.filed_as: {f.name: self.write(f.name, review) for f in fields(self)}}

    @classmethod
    def read(cls, content: dict[str, Any], review: Review, origin: str) -> Self:
        """That of a file; what an older one does not have is as in ``review``, a fresh one.

        Raises:
            InputError: something in it cannot be used; one sentence.
        """
        given = session.table(content, cls.filed_as, origin)
        values = {}
        for f in fields(cls):
            if f.name not in given:
                continue
            what = f"{origin}: {cls.filed_as}: {f.name}"
            value = values[f.name] = cls.taken(f.name, given[f.name], review, what)
            # A bool is an int to Python, and not to whoever writes a file.
            if type(value) is not type(f.default):
                raise InputError(tr("session.wrong_kind", what=what))
        try:
            return replace(review[cls], **values).checked(review)
        except InputError as error:
            raise InputError(f"{origin}: {cls.filed_as}: {error}") from None

    def write(self, name: str, review: Review) -> Any:
        """A field as it stands in the file."""
        return getattr(self, name)

    @classmethod
    def taken(cls, name: str, value: Any, review: Review, what: str) -> Any:
        """A field as it was found in the file.

        Raises:
            InputError: it cannot be used; the sentence begins with ``what``.
        """
        if isinstance(value, list):
            return tuple(session.number(v, what) for v in value)
        usual = next(f.default for f in fields(cls) if f.name == name)
        return session.number(value, what) if isinstance(usual, float) else value


S = TypeVar("S", bound=Slice)


@dataclass(frozen=True)
class Options(Slice):
    """What is drawn beside the solids, and how."""

    filed_as: ClassVar[str] = "options"
    LOOKS: ClassVar[frozenset[str]] = frozenset(
        (
            *("machine", "labels", "frames", "axes", "grid", "scale", "parallel", "handle"),
            *("legend", "dark"),
        )
    )
    machine: bool = True
    labels: bool = False
    frames: bool = True
    axes: bool = False
    grid: bool = True
    scale: bool = False
    parallel: bool = False
    handle: bool = True
    legend: bool = True
    dark: bool = False


@dataclass(frozen=True)
class Review:
    """Everything a review consists of; equal reviews look the same.

    ``gives_way`` is the key of the pose coordinate that follows from the others, where a mechanism
    has such; "" leaves that to the mechanism.
    """

    design: Design
    pose: tuple[float, ...]
    mode: str
    gives_way: str = ""
    slices: tuple[Slice, ...] = ()

    def __getitem__(self, kind: type[S]) -> S:
        """The slice of this kind."""
        for piece in self.slices:
            if isinstance(piece, kind):
                return piece
        raise KeyError(kind)

    def having(self, *pieces: Slice) -> Review:
        """The same with these slices instead of those of their kinds."""
        others = {type(piece): piece for piece in pieces}
        return replace(self, slices=tuple(others.get(type(s), s) for s in self.slices))

    def shown_as(self, other: Review) -> Review:
        """The same, shown as the other review shows it; as it is where that has another kind of
        machine.
        """
        if other.design.mechanism != self.design.mechanism:
            return self
        pieces = [
            replace(piece, **{name: getattr(other[type(piece)], name) for name in piece.LOOKS})
            for piece in self.slices
        ]
        return replace(self, slices=tuple(pieces))

    @property
    def machine(self) -> Machine[Any]:
        return machine_of(self.design)

    @property
    def dependent(self) -> int | None:
        """The pose coordinate that gives way; None where that is left to the mechanism."""
        axes = self.machine.coordinates
        return next((n for n, c in enumerate(axes) if c.key == self.gives_way), None)

    def giving_way(self, key: str) -> Review:
        """The same with another coordinate that follows from the others.

        Raises:
            InputError: it is none that may.
        """
        known = [self.machine.coordinates[n].key for n in self.machine.dependent]
        if key and key not in known:
            raise InputError(tr("typing.gives_way", known=", ".join(known), key=key))
        return replace(self, gives_way=key)

    @property
    def posture(self) -> Posture:
        return self.machine.inverse.posture(self.pose, self.mode)


@cache
def kinds() -> tuple[type[Slice], ...]:
    """The kinds of slices that a review has, one a feature that keeps anything."""
    return (Options, *each("state", Slice))


def new_review(design: Design) -> Review:
    """A review of ``design`` at its home posture."""
    home = machine_of(design).home
    review = Review(design, home.pose, home.mode)
    return replace(review, slices=tuple(kind.fresh(review) for kind in kinds()))


def is_planar(machine: Machine[Any]) -> bool:
    """Whether the platform moves in a plane, x and y."""
    return all(axis.key in ("x", "y") for axis in machine.coordinates)
