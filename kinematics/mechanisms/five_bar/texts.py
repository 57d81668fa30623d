"""What a page says of the five-bar: Markdown by topic, with the paper's figures and equations."""

from __future__ import annotations

ABOUT = {
    "mode": "On: the elbow Bᵢ stands to the left of the way from Aᵢ to P",
    "move": """
The **planar five-bar (5R)** moves its point P = (x, y) by two driven angles θ₁ and θ₂ (eqs. 1 to
5): two proximal links r₁ turn about A₁ and A₂, two distal links r₂ join them in P. The plane of the
paper lies flat, z = 0 of the base frame. Its **working mode** says on which side each elbow stands,
the sign in eq. 7. Sosa-López, Arias-Montiel and Lugo-González 2017, Fig. 1.
""",
    "solutions": """
For two angles there are two **assembly modes**, P on either side of the line B₁B₂: the two points
in which the circles of the distal links meet. They merge at a parallel singularity.
""",
    "workspace": """
The **workspace** is where the rings that both limbs reach overlap, bounded by arcs (Fig. 9). Each
working mode reaches all of it unless a joint has a range. The curves of parallel singularities
divide it into **aspects**, each without a singularity inside; aspects of one colour join through
serial singularities, without crossing a parallel one.
""",
    "singularities": """
**Serial** (type 1): a limb is stretched or folded, det A = 0; the workspace ends there and two
working modes meet (eq. 24, which is misprinted). **Parallel** (type 2): B₁, P and B₂ in line,
det B = 0 (eq. 25), extended or with the distal links folded together: P can move with both
actuators locked. With equal distal links the folded ones are circles, the extended ones a sextic.
""",
    "trajectory": """
A **trajectory** is a path and a time law. The paper's are a straight line at constant velocity
(eqs. 8 and 9) and one from rest to rest (eqs. 10 to 15, signs corrected); their joint curves are
fitted by polynomials (eqs. 16 to 19), whose true error is shown. Tables II to IV of the paper
compare two programs that are not part of it and cannot be reproduced.
""",
    "design": """
A **design** is the lengths of two proximal and two distal links and half the distance of the base
joints, r₃; joints may have a range. Table I of the paper: 480, 480 and 240 mm.
""",
}
