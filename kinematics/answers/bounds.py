"""What bounds a machine, as values with the machine's own symbols, and how amounts are written."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10
from typing import Literal

Unit = Literal["mm", "rad"]
SUBSCRIPTS = "₁₂₃₄₅₆₇₈₉"
_TEXT = {"min": "rho_min", "max": "rho_max"}


class Bound(str):
    """One bound of a machine: an end of a joint's range, or where a limb can no longer close.

    As text it is what files and JSON call it: "rho_min" and "rho_max", whatever the joint; the name
    of its end otherwise ("link").

    Attributes:
        joint: the symbol of what is bounded, as "θ₁".
        end: "min" and "max" of a joint's range; "link" where the limb's branches meet, and what
            else a machine is bounded by.
        name: what the machine calls it, as "θ₁ max" or "ρ min".
        unit: of amounts up to it.
        limb: from 1; None of what is of no limb.
    """

    __slots__ = ("end", "joint", "limb", "name", "unit")
    joint: str
    end: str
    name: str
    unit: Unit
    limb: int | None

    def __new__(
        cls, joint: str, end: str, name: str = "", unit: Unit = "mm", limb: int | None = None
    ) -> Bound:
        made = super().__new__(cls, _TEXT.get(end, end))
        made.joint, made.end, made.unit, made.limb = joint, end, unit, limb
        made.name = name or f"{joint} {end}"
        return made

    def __getnewargs__(self) -> tuple[str, str, str, Unit, int | None]:  # type: ignore[override]
        return self.joint, self.end, self.name, self.unit, self.limb

    @property
    def place(self) -> str:
        """ "limb 3, ρ min"."""
        return self.name if self.limb is None else f"limb {self.limb}, {self.name}"


def limb_bounds(
    joints: Sequence[str], unit: Unit = "mm", links: Sequence[str] = (), link: str = "link"
) -> tuple[Bound, ...]:
    """The bounds of limbs with one actuator each: of limb i its link, if any, and its joint's ends.

    Args:
        joints: symbols of the actuators; the ends of a length are called by its letter alone.
        links: symbols of what lets the limbs close.
        link: what the bound is called up to which they do.
    """
    found: list[Bound] = []
    for limb, joint in enumerate(joints, 1):
        name = joint.rstrip(SUBSCRIPTS) if unit == "mm" else joint
        found += [Bound(symbol, "link", link, limb=limb) for symbol in links[limb - 1 : limb]]
        found += [Bound(joint, end, f"{name} {end}", unit, limb) for end in ("min", "max")]
    return tuple(found)


def bound_of(bounds: Sequence[Bound], limb: int, text: str) -> Bound:
    """The bound of a limb (from 1) that is written so, as "link"."""
    return next(bound for bound in bounds if bound == text and bound.limb == limb)


def range_of(bounds: Sequence[Bound], limb: int) -> tuple[Bound, Bound]:
    """Both ends of the range of a limb's joint."""
    return bound_of(bounds, limb, "rho_min"), bound_of(bounds, limb, "rho_max")


def named(bound: str) -> str:
    """What a bound is called: its own name, or the text itself."""
    return bound.name if isinstance(bound, Bound) else bound


def shared_names(bounds: Sequence[Bound]) -> dict[str, str]:
    """What each end is called of all limbs together, as "rho_max": "ρ max" or "θ max"."""
    names: dict[str, str] = {}
    for bound in bounds:
        letter = bound.joint.rstrip(SUBSCRIPTS)
        names.setdefault(bound, bound.name.replace(bound.joint, letter))
    return names


def decimals(amount: float) -> int:
    """Decimals that show an amount ≥ 0: one, and more for less than 0.1."""
    return 1 if amount >= 0.1 or amount < 1e-12 else min(12, 1 - floor(log10(amount)))
