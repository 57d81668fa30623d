"""Boxes that people type into, and what becomes of what cannot be used."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from app.language import tr
from app.review.changes import Change
from app.review.units import minus, number, page_unit, sentence
from app.widgets.desk import DIGITS, TYPED, Client, Desk, Group, answer, close, put, put_prop
from app.widgets.texts import red
from kinematics.answers.modes import matching
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate


class Slider:
    """A slider with its number box; a value outside its range stands at its end. If it is ``free``
    such a value can be typed, and the slider reaches as far from then on.
    """

    def __init__(
        self,
        desk: Desk,
        label: str,
        low: float,
        high: float,
        step: float,
        value: float,
        act: Callable[[float, Client], None],
        digits: int = DIGITS,
        free: bool = False,
    ) -> None:
        self._desk = desk
        self._digits = digits
        self._free = free
        self._range = self._reach = low, high
        value = round(min(max(value, low), high), digits)
        self._handle = desk.gui.add_slider(label, low, high, step, value)
        put_prop(self._handle, "precision", max(digits, TYPED))
        answer(desk, self._handle, act)

    @property
    def reach(self) -> tuple[float, float]:
        """From where to where it reaches."""
        return self._reach

    def draw(self, low: float, high: float, value: float) -> None:
        if (low, high) != self._range:
            self._range = self._reach = low, high
        if self._free and math.isfinite(value):
            self._reach = min(self._reach[0], value), max(self._reach[1], value)
        low, high = self._reach
        put_prop(self._handle, "min", low)
        put_prop(self._handle, "max", high)
        if not math.isfinite(value):
            return
        value = min(max(value, low), high)
        # What was typed stays as it was typed; what was computed shows the digits that fit.
        if not close(self._handle.value, value):
            put(self._desk, self._handle, round(value, self._digits))


class Typed:
    """A text box for numbers: what is typed and means the same is left alone.

    Args:
        read: what a text means, in mm and rad; raises an InputError where it cannot be used.
        write: how a value can be typed.
    """

    def __init__(
        self, desk: Desk, handle: Any, read: Callable[[str], Any], write: Callable[[Any], str]
    ) -> None:
        self._desk, self.handle = desk, handle
        self._read, self._write = read, write

    def read(self) -> Any:
        """What stands in the box.

        Raises:
            InputError: it cannot be used.
        """
        return self._read(self.handle.value)

    def draw(self, value: Any) -> None:
        """Show a value."""
        try:
            same = self.read() == value or self._write(self.read()) == self._write(value)
        except InputError:
            same = False
        if not same:
            put(self._desk, self.handle, self._write(value))


def pose_box(desk: Desk, handle: Any, axes: Sequence[Coordinate], what: str) -> Typed:
    """A pose; empty for none."""
    read = partial(typed_pose, axes=axes, what=what)
    return Typed(desk, handle, read, partial(shown_pose, axes=axes))


def rates_box(desk: Desk, handle: Any, axes: Sequence[Coordinate], what: str) -> Typed:
    """As many numbers as a pose has, by a power of the second; empty for none."""

    def read(text: str) -> tuple[float, ...]:
        try:
            return typed_pose(text, axes, what)
        except InputError:
            count = len(axes)
            raise InputError(tr("typing.rates", what=what, count=count)) from None

    return Typed(desk, handle, read, partial(shown_pose, axes=axes))


def poses_box(desk: Desk, handle: Any, axes: Sequence[Coordinate], what: str) -> Typed:
    """Poses, one a line."""

    def read(text: str) -> tuple[tuple[float, ...], ...]:
        lines = [line for line in text.splitlines() if line.strip()]
        return tuple(typed_pose(line, axes, f"{what} {n}") for n, line in enumerate(lines, 1))

    return Typed(
        desk, handle, read, lambda poses: "\n".join(shown_pose(pose, axes) for pose in poses)
    )


def limits_box(
    desk: Desk, handle: Any, joints: Sequence[Coordinate], what: str, *, turning: bool
) -> Typed:
    """A positive number for each joint, or one for all; empty for none. If they are ``turning``
    they count angles where a joint turns.
    """
    scales = [joint.inner(1.0) if turning else 1.0 for joint in joints]

    def read(text: str) -> tuple[float, ...]:
        values = typed_numbers(text, what)
        if len(values) == 1:
            values *= len(joints)
        if values and len(values) != len(joints):
            raise InputError(tr("typing.limits", what=what, count=len(joints)))
        if any(value <= 0.0 for value in values):
            raise InputError(tr("typing.positive", what=what))
        return tuple(v * scale for v, scale in zip(values, scales, strict=False))

    def write(value: Any) -> str:
        shown = [number(v / scale) for v, scale in zip(value, scales, strict=False)]
        return shown[0] if len(set(shown)) == 1 else ", ".join(shown)

    return Typed(desk, handle, read, write)


def shown_pose(pose: Sequence[float], axes: Sequence[Coordinate]) -> str:
    """ "90, 110, 430, 5, −3"."""
    return ", ".join(number(round(c.outer(v), TYPED)) for c, v in zip(axes, pose, strict=False))


def typed_pose(text: str, axes: Sequence[Coordinate], what: str) -> tuple[float, ...]:
    """A pose as it was typed, () where there is nothing.

    Raises:
        InputError: not as many finite numbers as a pose has.
    """
    values = typed_numbers(text, what)
    if values and len(values) != len(axes):
        raise InputError(tr("typing.pose", what=what, count=len(axes), units=units(axes)))
    return tuple(c.inner(v) for c, v in zip(axes, values, strict=False))


def typed_numbers(text: str, what: str) -> tuple[float, ...]:
    """Numbers with commas, semicolons or spaces between them.

    Raises:
        InputError: something else stands there.
    """
    words = re.split(r"[\s,;]+", text.strip().replace("−", "-"))
    try:
        values = tuple(float(word) for word in words if word)
    except ValueError:
        raise InputError(tr("typing.numbers", what=what)) from None
    if not all(map(math.isfinite, values)):
        raise InputError(tr("typing.finite", what=what))
    return values


def units(axes: Sequence[Coordinate]) -> str:
    """ "x, y, z (mm), φ, θ (°)"."""
    groups: list[tuple[str, list[str]]] = []
    for c in axes:
        if not groups or groups[-1][0] != page_unit(c):
            groups.append((page_unit(c), []))
        groups[-1][1].append(c.symbol)
    return ", ".join(f"{', '.join(names)} ({unit})" for unit, names in groups)


class Typing:
    """Boxes whose text is taken as soon as it can be used; until then it is said what is wrong.

    ``together``: they can be used only all at once.
    """

    def __init__(self, desk: Desk, *, together: bool = False) -> None:
        self._desk = desk
        self._together = together
        self._wrong: dict[int, str] = {}
        self.note = desk.gui.add_html("", visible=False)

    @property
    def wrong(self) -> bool:
        """Something that was typed cannot be used; it stays until it can."""
        return bool(self._wrong)

    def holds(self, typed: Typed) -> bool:
        """What stands in this box cannot be used."""
        return id(typed) in self._wrong

    def watch(self, typed: Typed, take: Callable[[Any, Client], None]) -> None:
        """Call ``take`` with what was typed into a box; what it refuses is told, too."""

        def changed(_: str, client: Client) -> None:
            self._wrong = {
                known: text
                for known, text in self._wrong.items()
                if known != id(typed) and not self._together
            }
            try:
                take(typed.read(), client)
            except InputError as error:
                self._wrong[id(typed)] = str(error)
            text = next(iter(self._wrong.values()), "")
            put_prop(self.note, "content", red(sentence(text)) if text else "")
            put_prop(self.note, "visible", bool(text))

        answer(self._desk, typed.handle, changed)

    def draw(self, typed: Typed, value: Any) -> None:
        """Show a value in a box, unless what stands there cannot be used yet."""
        if not self.holds(typed):
            typed.draw(value)


class ModesMenu:
    """Which modes something is of: a menu of choices that have a name, and one that is typed.

    Args:
        titles: of the named choices, what each stands for.
        own: the key of the title of the choice that is typed, and of the label of its box.
        change: to a choice, or to what was typed.
    """

    def __init__(
        self,
        group: Group,
        titles: Mapping[str, str],
        own: str,
        change: Callable[[str], Change],
        **look: Any,
    ) -> None:
        self._group, self._titles, self._change = group, titles, change
        self._own = tr(own)
        self._menu = group.gui.add_dropdown(tr("modes.of"), (*titles, self._own), **look)
        label, mode, beside = tr(f"{own}_label"), minus(group.review.mode), tr("modes.signs")
        self._typed = group.gui.add_text(label, mode, hint=beside, visible=False)
        group.answer(self._menu, self._choose)
        group.answer(self._typed, self._type)

    def draw(self, chosen: str | tuple[str, ...]) -> None:
        """Show a choice, or modes, or patterns of them."""
        known = (title for title, choice in self._titles.items() if choice == chosen)
        title = next(known, self._own)
        self._group.put(self._menu, title)
        self._group.see(self._menu.value == self._own, self._typed)
        if title == self._own:
            text = chosen if isinstance(chosen, str) else ", ".join(chosen)
            self._group.put(self._typed, minus(text))

    def _choose(self, title: str, client: Client) -> None:
        self._typed.visible = title == self._own
        if title == self._own:
            self._type(self._typed.value, client)
        else:
            self._group.desk.send(self._change(self._titles[title]), client)

    def _type(self, text: str, client: Client) -> None:
        words, limbs = re.split(r"[,;\s]+", text.strip()), len(self._group.review.mode)
        signs = set("".join(words)) <= set("+-−–?")
        if signs and any(len(word) < limbs for word in words):
            return  # a person is still typing
        matching(text, self._group.review.machine.modes)  # raises, and they read what is wrong
        self._group.desk.send(self._change(text), client)
