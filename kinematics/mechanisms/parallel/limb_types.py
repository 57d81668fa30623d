"""The short forms of limbs: what each is, and which keys its table has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Form = Literal["point", "direction", "number", "pair", "mode", "choice"]
"""Vectors of three; a number; [low, high] or two lengths; "+" or "-"; one of a few numbers."""


@dataclass(frozen=True, slots=True)
class LimbKey:
    """One key of a limb's table.

    Attributes:
        form: what it holds; any but a choice may be a list of them, one for each limb.
        unit: of its numbers; angles are degrees in files.
        frame: of a vector: copies turn it there.
        needed: it may not be left out.
        check: "positive" or "ordered" numbers.
    """

    name: str
    form: Form
    unit: Literal["mm", "rad", ""] = "mm"
    frame: Literal["base", "platform", ""] = ""
    needed: bool = True
    check: Literal["positive", "ordered", "span", ""] = ""


@dataclass(frozen=True, slots=True)
class LimbType:
    """A short form.

    Attributes:
        drive: what its actuator does, see `limbs.Drive`.
        bond: what the limb takes from the platform, see `limbs.Bond`.
        branches: how many postures it has for a pose: 1 or 2.
        taken: what the bond is, in words.
    """

    name: str
    keys: tuple[LimbKey, ...]
    drive: str
    bond: str
    branches: int
    taken: str


_BASE = LimbKey("base", "point", frame="base")
_PLATFORM = LimbKey("platform", "point", frame="platform")
_STROKE = LimbKey("stroke", "pair", check="ordered")
_TRAVEL = LimbKey("range", "pair", check="span", needed=False)
_TURN = LimbKey("range", "pair", "rad", check="span", needed=False)
_AXIS = LimbKey("axis", "direction", "", "base")
_ZERO = LimbKey("zero", "direction", "", "base", needed=False)
_SLIDE = LimbKey("slide", "direction", "", "base")
_BASE_AXIS = LimbKey("base_axis", "direction", "", "base")
_PLATFORM_AXIS = LimbKey("platform_axis", "direction", "", "platform")
_CRANK = LimbKey("crank", "number", check="positive")
_ROD = LimbKey("rod", "number", check="positive")
_LINK = LimbKey("link", "number", check="positive")
_LINKS = LimbKey("links", "pair", check="positive")
_MODE = LimbKey("mode", "mode", "", needed=False)
_BASE_CONE = LimbKey("base_cone", "number", "rad", needed=False)
_PLATFORM_CONE = LimbKey("platform_cone", "number", "rad", needed=False)

NONE = "nothing"
_PLANE = "a force along its revolute axis"
_FLAT = "a force normal to its plane and two couples in it"
_LEG = (_BASE, _PLATFORM, _STROKE, _BASE_CONE, _PLATFORM_CONE)
_RUS = (_BASE, _AXIS, _ZERO, _PLATFORM, _CRANK, _ROD, _MODE, _TURN, _PLATFORM_CONE)
_PUS = (_BASE, _SLIDE, _PLATFORM, _ROD, _MODE, _TRAVEL, _PLATFORM_CONE)

_ALL = (
    LimbType("UPS", _LEG, "leg", "free", 1, NONE),
    LimbType("SPS", _LEG, "leg", "free", 1, NONE),
    LimbType("RUS", _RUS, "crank", "free", 2, NONE),
    LimbType("RSS", _RUS, "crank", "free", 2, NONE),
    LimbType("PUS", _PUS, "slider", "free", 2, NONE),
    LimbType("PSS", _PUS, "slider", "free", 2, NONE),
    LimbType(
        "delta",
        (*_RUS[:-1], LimbKey("parallelogram", "number", "rad", needed=False)),
        "crank",
        "parallelogram",
        2,
        "two couples normal to its crank's axis",
    ),
    LimbType("RPR", (_BASE, _PLATFORM, _STROKE), "leg", "planar", 1, _FLAT),
    LimbType(
        "RRR",
        (_BASE, _PLATFORM, _LINKS, _ZERO, _MODE, _TURN, LimbKey("actuated", "choice", "")),
        "crank",
        "planar",
        2,
        _FLAT,
    ),
    LimbType(
        "PRR", (_BASE, _SLIDE, _PLATFORM, _LINK, _MODE, _TRAVEL), "slider", "planar", 2, _FLAT
    ),
    LimbType(
        "PRS",
        (_BASE, _SLIDE, _AXIS, _PLATFORM, _ROD, _MODE, _TRAVEL),
        "slider",
        "base plane",
        2,
        _PLANE,
    ),
    LimbType(
        "RRS",
        (_BASE, _AXIS, _ZERO, _PLATFORM, _LINKS, _MODE, _TURN),
        "crank",
        "base plane",
        2,
        _PLANE,
    ),
    LimbType("RPS", (_BASE, _AXIS, _PLATFORM, _STROKE), "leg", "base plane", 1, _PLANE),
    LimbType(
        "SPR", (_BASE, _PLATFORM, _PLATFORM_AXIS, _STROKE), "leg", "platform plane", 1, _PLANE
    ),
    LimbType(
        "UPU",
        (_BASE, _PLATFORM, _BASE_AXIS, _PLATFORM_AXIS, _STROKE),
        "leg",
        "universal",
        1,
        "a wrench normal to its outer axes, a couple where these are parallel",
    ),
    LimbType(
        "RPUR",
        (_BASE, _PLATFORM, _BASE_AXIS, _PLATFORM_AXIS, _LINK, _MODE, _STROKE),
        "offset leg",
        "normal axes",
        2,
        "a couple normal to its outer axes",
    ),
)

TYPES: Mapping[str, LimbType] = {each.name: each for each in _ALL}
"""The short forms by their names in files."""

SPHERICAL = LimbType(
    "spherical RRR", (), "direction", "point", 2, "three forces through the centre of its axes"
)
"""Only as a chain: three revolute axes through one point."""
