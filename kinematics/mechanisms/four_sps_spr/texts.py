"""What a page says of the 4-SPS + 1-SPR: Markdown by topic, with the paper's equations."""

from __future__ import annotations

ABOUT = {
    "move": """
The **4-SPS + 1-SPR** moves its platform with five legs; the fifth one's revolute joint on the
platform, with the axis n₆, leaves it five degrees of freedom. Orientation is R = R_z(α) R_y(β)
R_x(γ). The leg can only stand normal to its axis, (A₅ − p)·R n₆ = b₅·n₆, so of the six coordinates
one follows from the others: choose which. Wang et al. 2017, eqs. 2 to 5.
""",
    "solutions": """
A general machine has 40 complex solutions for given leg lengths, and so has one whose base and
platform points lie in planes; two regular pentagons have 32. Each is a point of Study's quadric,
and all are found by following every path of a homotopy. Where base, platform and axis are planar,
every solution has a mirror image below the base.
""",
    "workspace": """
At a **constant orientation** the constraint leaves p a plane, and each leg's stroke a ring in it:
the workspace is a plane region bounded by arcs, known exactly. Let one angle follow from the
constraint instead, and it is a solid.
""",
    "section": """
The **constant-orientation workspace** is plane: its frame is m = R n₆, u and v, v as upright as it
can be. Arcs are the ends of the strokes, in the colours of their limbs.
""",
    "singularities": """
Each leg pushes along its line, and the SPR limb also along its revolute axis, through A₅. A
**parallel** singularity is where these six forces are dependent, det G = 0 (Wang et al. 2017, eq.
10): the platform can move although all legs are locked. There is no constraint singularity proper,
as a single constraint force never vanishes. At a constant orientation the singular places are a
cubic curve in the plane of the constraint.
""",
    "map": """
The **map** shows the exact area of the constant-orientation workspace over two of the angles, the
third as it is now.
""",
    "trajectory": """
Velocity and acceleration by the matrix G and the Hessians H of eqs. 10 and 13 to 15 (the lower
right block of the first matrix of Hᵢ is −r̂ᵢ², printed without its sign); forces by virtual work,
−G⁻ᵀ (F; T), eq. 16.
""",
    "design": """
A **design** is five base points Aᵢ, five platform points bᵢ, five strokes and the revolute axis n₆
of the fifth limb, in the platform frame. Two regular pentagons make a bad machine: the matrix G has
rank 4 at most whenever the platform is parallel to the base.
""",
}
