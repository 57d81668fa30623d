"""What a page says of the 3-RPS and 3-SPR: Markdown by topic, with the paper's figures."""

from __future__ import annotations

from kinematics.mechanisms.tripods.design import Kind

_MACHINE: dict[Kind, str] = {
    "three_rps": """
The **3-RPS** stands on three revolute joints on the base (circumradius h₁); each carries a
prismatic limb ρᵢ that ends in a spherical joint of the platform (h₂). Fig. 2 of Nayak et al. 2017.
""",
    "three_spr": """
The **3-SPR** is the 3-RPS upside down: spherical joints on the base (circumradius h₁), revolute
ones on the platform (h₂). Its poses are the inverses of those of a 3-RPS with h₁ and h₂ exchanged.
Fig. 1 of Nayak et al. 2017.
""",
}
_SHARED = {
    "move": """
The platform has an altitude Z, a tilt θ and the azimuth φ of the axis of tilt; X and Y follow
(parasitic motions), and the torsion is 0 in **operation mode** 2 and π in mode 1. The modes meet in
the constraint singularity at a tilt of 180° and nowhere else: only there can the machine change
from one to the other.
""",
    "solutions": """
For given limbs there are 16 complex solutions, 8 in each operation mode, in pairs mirrored by the
plane of the revolute joints. They are found in closed form, as the common points of two conics.
""",
    "workspace": """
Every orientation and altitude that the strokes allow in the present operation mode, drawn as
(θ cos φ, θ sin φ) at the height Z, one radian as long as the platform's circumradius.
""",
    "singularities": """
With the actuators locked the limbs hold the platform by six forces: along each limb, and through
each spherical joint along the axis of the limb's revolute joint. They are dependent where P(Z, θ,
sin 3φ) = 0 (**actuation** singularities, Fig. 3) and at a tilt of 180° (**constraint**
singularity). The **MICR** is the tilt up to which no azimuth is singular (Figs. 4 and 5). The paper
prints 25.22° and 30.38° for its example (3-SPR, h₁ = 1, h₂ = 2, Z = 1), which is 25.1803° and 30°
exactly: a grid of 0.01 rad, rounded up, and π taken as 3.14 give the printed values.
""",
    "trajectory": """
A **trajectory** is a path of (Z, θ, φ) and a time law; X and Y follow, and are part of the path of
O′ that is drawn. At a tilt of 0 the azimuth φ turns without moving the platform. The limbs' rates
come from the velocity equations along and across each limb, their forces from the same six lines.
""",
    "design": """
A **design** is the circumradii h₁ of the base and h₂ of the platform and the stroke ρ min … ρ max
that the three limbs share.
""",
}
OF = {
    kind: {
        **_SHARED,
        "move": machine + _SHARED["move"],
        "design": machine + _SHARED["design"],
    }
    for kind, machine in _MACHINE.items()
}
"""By kind and topic."""
