"""What a page says of mechanisms that a file describes: Markdown by topic."""

from __future__ import annotations

ABOUT = {
    "move": """
A **parallel mechanism** described by its limbs: each has one actuator, ρ a leg's length, s a
slider's place, q a crank's angle. A pose is told by as many of x, y, z, φ, θ, ψ as the platform has
freedoms, R = R_z(ψ) R_y(θ) R_x(φ); what else changes follows (**parasitic motion**), in one of two
**operation modes** where there are such.
""",
    "mode": """
the larger of a crank's two angles or a slider's two places for the same pose
""",
    "solutions": """
All **assembly modes** for given joints. With spheres and planes as constraints a pose is a point of
Study's quadric, and every path from a generic machine of the same limbs is followed; machines that
move in a plane, translate or turn about a point have their own closed systems. How many complex
solutions there are, and whether they are known to be all, is told with them.
""",
    "workspace": """
Where three coordinates of the pose can be while the others stay: places first, then angles drawn
as lengths, one radian as long as the characteristic length. Every margin of a limb (an end of a
range, its reach, a cone) bounds it by a surface of its own.
""",
    "singularities": """
With its actuator locked each limb exerts a wrench, mostly a force along its rod, and some limbs a
constraint wrench whatever their actuator does. **Parallel** singularities are where all six are
dependent, **constraint** ones where the constraints alone are, **serial** ones where an actuator
does not move the platform.
""",
    "trajectory": """
Velocities, accelerations and forces by the screws of the limbs.
""",
    "design": """
A **design** is the platform's reference pose and the limbs: short forms as UPS, RUS, PRS or delta
with their points, axes and lengths, or chains of joints. Copies are turned about an axis of the
base. A rough reference pose is closed.
""",
}
