"""Colours that mean one thing everywhere: scene, tables, plots, legend.

Limbs in five Okabe–Ito colours and a sixth that colour-blind people can tell apart; red-orange for
singular and for beyond a limit, nothing else; the workspace a quiet blue-grey.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

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


LIMBS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#900CE9")
NEAR = "#F0E442"  # close to the end of a stroke


@dataclass(frozen=True, slots=True)
class Scheme:
    """The colours of a page that is light or dark; those of limbs are the same on both.

    Attributes:
        panel: what text stands on.
        ink, quiet: text, and text of less weight.
        good, near, bad: text about how something stands.
        beyond: singular, or beyond a limit: surfaces, curves, bands.
        workspace, edge: solids of workspaces, and their edges.
        others: edges of the workspace of other modes.
        cut: the cap of a solid that is cut.
        ghost, dot: the platform in another assembly mode, and one that is far.
        aspects: by the sign of the determinant, the largest first: cool where it is positive, warm
            where it is negative.
        silhouette: around the bodies of the machine.
        cell, section: the lines of the ground, and every fifth.
        below: the light from the ground.
        counterpart: a machine that is compared with; ``beside`` are further ones.
        focus: what is being chosen.
    """

    panel: str
    ink: str
    quiet: str
    good: str
    near: str
    bad: str
    beyond: str
    workspace: str
    edge: str
    others: str
    cut: str
    ghost: str
    dot: str
    aspects: Mapping[int, tuple[str, ...]]
    steel: str
    joint: str
    base: str
    platform: str
    silhouette: str
    cell: str
    section: str
    below: str
    counterpart: str
    beside: tuple[str, str]
    focus: str


LIGHT = Scheme(
    panel="#FBFCFD",
    ink="#1F2933",
    quiet="#5B6672",
    good="#00724F",
    near="#7A5C00",
    bad="#B04A00",
    beyond="#D55E00",
    workspace="#54677C",
    edge="#6C7F94",
    others="#C3CDD8",
    cut="#A9B8C9",
    ghost="#3A4450",
    dot="#8A94A1",
    aspects={
        1: ("#C9D2DC", "#B5C1CE", "#DCE3EA"),
        -1: ("#5F5240", "#4A4033", "#6A5940"),
        0: ("#8B9097", "#A4A9AF", "#747A82"),
    },
    steel="#C4CAD2",
    joint="#39414B",
    base="#D3D8DF",
    platform="#46525F",
    silhouette="#39414B",
    cell="#E4E7EC",
    section="#D0D5DC",
    below="#BEC4CE",
    counterpart="#A0522D",
    beside=("#5B3E96", "#00695C"),
    focus="#2563A8",
)
DARK = Scheme(
    panel="#1B1F24",
    ink="#E4E9EF",
    quiet="#9DA8B5",
    good="#4CC39A",
    near="#E3C44A",
    bad="#F0803C",
    beyond="#F0803C",
    workspace="#8FA9C6",
    edge="#8299B2",
    others="#3F4B58",
    cut="#5C6E82",
    ghost="#C3CBD5",
    dot="#8A94A1",
    aspects={
        1: ("#8FA9C6", "#B5C1CE", "#5F7388"),
        -1: ("#D2BE98", "#E6D9BF", "#BFA878"),
        0: ("#8B9097", "#A4A9AF", "#747A82"),
    },
    steel="#B8C0CA",
    joint="#AEB7C2",
    base="#59626D",
    platform="#9AA7B6",
    silhouette="#20252B",
    cell="#262B32",
    section="#383F48",
    below="#59626D",
    counterpart="#D98A5F",
    beside=("#B79CF0", "#5CC8B4"),
    focus="#7FB2E8",
)


def scheme(dark: bool) -> Scheme:
    """The colours of a page."""
    return DARK if dark else LIGHT


# Of what is drawn on a light ground whatever the page: files, pictures, plots.
BEYOND, WORKSPACE, STEEL, PLATFORM = LIGHT.beyond, LIGHT.workspace, LIGHT.steel, LIGHT.platform
INK, COUNTERPART, ASPECTS, BASE = LIGHT.ink, LIGHT.counterpart, LIGHT.aspects, LIGHT.base
INK_DARK = DARK.ink
LOAD = "#2E343C"  # what acts on the platform
VELOCITY, ACCELERATION = "#3F5B7C", "#8C7355"
FREE = "#A9B7C6"  # a ball without a singularity

# Parts of one limb's vertex space: its colour mixed with white (> 0) or black (< 0).
_PART_TINT = {"body": 0.45, "plus": 0.2, "minus": -0.25, "H1": 0.3, "H2": -0.45}


def limb_color(limb: int) -> str:
    """The colour of a limb, counted from 1; of none (0) that of what is singular."""
    return BEYOND if limb == 0 else LIMBS[(limb - 1) % len(LIMBS)]


def bar_color(bar: Bar, level: str, of: Scheme = LIGHT) -> str:
    """A bar's colour; ``level`` is how its limb stands ("good", "near", "bad")."""
    limb = limb_color(bar.limb) if bar.limb else of.steel
    match bar.role:
        case "cylinder":
            return limb
        case "link":
            return mixed(limb, 0.25)
        case "rail":
            return mixed(limb, 0.5)
        case "rod":
            return {"bad": of.beyond, "near": NEAR}.get(level, of.steel)
        case "gap":
            return of.beyond
        case "joint" | "stop":
            return of.joint
        case "platform":
            return of.platform
        case "base":
            return of.base


def solid_color(spec: SolidSpec, of: Scheme = LIGHT) -> str:
    """The colour of a solid: its limb's, shaded by the part it is."""
    if spec.limb is None:
        return of.workspace
    return mixed(limb_color(spec.limb), _PART_TINT.get(spec.key.partition("/")[2], 0.0))


def aspect_color(sign: int, rank: int, of: Scheme = LIGHT) -> str:
    """The colour of an aspect: the sign of its determinant, and which one of those it is."""
    shades = of.aspects[sign]
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
