"""Colours that mean one thing everywhere: scene, tables, plots, legend.

Limbs in five Okabe–Ito colours that colour-blind people can tell apart; red-orange for singular
and for beyond a limit, nothing else; the workspace a quiet blue-grey.
"""

from __future__ import annotations

from kinematics.answers.drawings import Bar
from kinematics.facets.solids import SolidSpec

Rgb = tuple[int, int, int]


def rgb(code: str) -> Rgb:
    """ "#0072B2" as three bytes."""
    return int(code[1:3], 16), int(code[3:5], 16), int(code[5:7], 16)


def linear(code: str) -> Rgb:
    """The same colour for a batched mesh, whose colours the browser takes as linear light."""
    r, g, b = (
        round(255 * (c / 255 / 12.92 if c <= 10 else ((c / 255 + 0.055) / 1.055) ** 2.4))
        for c in rgb(code)
    )
    return r, g, b


LIMBS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9")
BEYOND = "#D55E00"  # singular, or beyond a limit
NEAR = "#F0E442"  # close to the end of a stroke
WORKSPACE = "#8397AD"
STEEL = "#C3C9D1"
JOINT = "#4B525C"
BASE = "#B9BFC8"
PLATFORM = "#5D6B7E"
GHOST, GHOST_DARK = "#3A4450", "#C3CBD5"  # the platform in another assembly mode
WORKSPACE_DEEP = "#3F5B7C"  # a machine's curves in a plot
COUNTERPART = "#8C7355"  # and those of the machine it is compared with
LOAD = "#2E343C"  # what acts on the platform
VELOCITY, ACCELERATION = "#3F5B7C", "#8C7355"
FREE = "#A9B7C6"  # a ball without a singularity
INK = "#2E343C"
INK_DARK = "#D8DEE6"  # ink on a dark page

# Aspects: cool where the determinant of the wrenches is positive, warm where it is negative, the
# largest first; too grey to be taken for limbs.
ASPECTS = {
    1: ("#6E87A3", "#8FA3B8", "#57708C", "#AEBDCC", "#455C75"),
    -1: ("#A3937B", "#B8AB97", "#8A7A62", "#CCC2B2", "#71634E"),
    0: ("#8B9097", "#A4A9AF", "#747A82", "#BDC1C6", "#5F656D"),
}

# Parts of one limb's vertex space: its colour mixed with white (> 0) or black (< 0).
_PART_TINT = {"body": 0.45, "plus": 0.2, "minus": -0.25, "H1": 0.3, "H2": -0.35, "H3": -0.15}


def limb_color(limb: int) -> str:
    """The colour of a limb, counted from 1; of none (0) that of what is singular."""
    return BEYOND if limb == 0 else LIMBS[(limb - 1) % len(LIMBS)]


def bar_color(bar: Bar, level: str) -> str:
    """A bar's colour; ``level`` is how its limb stands ("good", "near", "bad")."""
    limb = limb_color(bar.limb) if bar.limb else STEEL
    match bar.role:
        case "cylinder":
            return limb
        case "link":
            return mixed(limb, 0.35)
        case "rail":
            return mixed(limb, 0.55)
        case "rod":
            return {"bad": BEYOND, "near": NEAR}.get(level, STEEL)
        case "gap":
            return BEYOND
        case "joint" | "stop":
            return JOINT
        case "platform":
            return PLATFORM
        case "base":
            return BASE


def solid_color(spec: SolidSpec) -> str:
    """The colour of a solid: its limb's, shaded by the part it is."""
    if spec.limb is None:
        return WORKSPACE
    return mixed(limb_color(spec.limb), _PART_TINT.get(spec.key.partition("/")[2], 0.0))


def aspect_color(sign: int, rank: int) -> str:
    """The colour of an aspect: the sign of its determinant, and which one of those it is."""
    shades = ASPECTS[sign]
    return shades[rank % len(shades)]


def mixed(code: str, tint: float) -> str:
    """A colour mixed with white (tint up to 1) or black (down to −1)."""
    target = 255 if tint > 0 else 0
    parts = (round(c + (target - c) * abs(tint)) for c in rgb(code))
    return "#" + "".join(f"{p:02X}" for p in parts)


# From little to much: ten steps of cividis, the same to every kind of colour sight and in grey.
_RAMP = (
    *("#00224E", "#123570", "#3B496C", "#575D6D", "#707173"),
    *("#8A8678", "#A59C74", "#C3B369", "#E1CC55", "#FEE838"),
)


def ramp_color(share: float) -> str:
    """The colour of a quantity from 0 (blue) to 1 (yellow), as in the files of maps."""
    place = min(max(share, 0.0), 1.0) * (len(_RAMP) - 1)
    n = min(int(place), len(_RAMP) - 2)
    low, high = rgb(_RAMP[n]), rgb(_RAMP[n + 1])
    parts = (round(a + (b - a) * (place - n)) for a, b in zip(low, high, strict=True))
    return "#" + "".join(f"{p:02X}" for p in parts)
