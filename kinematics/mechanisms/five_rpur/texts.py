"""What a page says of the 5-RPUR: Markdown by topic, with the paper's figures and equations."""

from __future__ import annotations

ABOUT = {
    "mode": "On: the second link stands on the +z′ side of its U joint",
    "move": """
The **5-RPUR** moves its platform by three translations and two rotations, Q = R_y(θ) R_x(φ)
(eq. 1): five limbs, each a prismatic actuator ρᵢ = |AᵢBᵢ| on a revolute joint and a link lᵢ from
the U joint Bᵢ to the platform. Its **working mode** is the side of each U joint on which the second
link stands (the sign σᵢ of C − B along z′). Tale Masouleh et al. 2011, Figs. 1 and 2.
""",
    "solutions": """
All assembly modes, in all working modes that the design has. Limbs whose U joints are merged into
one (`merged_joints` in the design file) stand in the same working mode; limbs of an arrangement
that are not merged may stand in different ones. Tale Masouleh et al. 2011, section 3.
""",
    "workspace": """
The **constant-orientation workspace**: every place the platform's origin O′ can reach while φ and θ
stay as they are. It is the intersection of the five limbs' **vertex spaces**, Bohemian domes given
thickness by the actuators' strokes and offset by −sᵢ (Figs. 9 to 15 of Tale Masouleh et al. 2011).
Each vertex space is its main body (Fig. 12) less the holes H₁, H₂ and H₃ (Figs. 9 to 11), or the
union of its two halves, one for each side of the U joint.
""",
    "section": """
The **exact section** of the constant-orientation workspace by the plane x′ = const, in the frame
x′y′z′ that θ turns about the y axis (Fig. 17 and eqs. 26 to 43 of Tale Masouleh et al. 2011). Every
limb bounds it by circles of radius lᵢ and by lines |y′| = lᵢ.
""",
    "map": """
The **map** shows a measure of the constant-orientation workspace over the orientations (φ, θ), as
Figs. 20 and 21 of Tale Masouleh et al. 2011 show its volume.
""",
    "singularities": """
Limb i, its actuator locked, pushes the platform along a line through Bᵢ with the direction
(uᵢ × e₁) × (vᵢ × e₂); all limbs together impose one couple along e₁ × e₂. A **parallel** (type 2)
singularity is where these six wrenches are dependent: the platform can move although all actuators
are locked. A **serial** (type 1) one is where a second link stands along e₁ and two working modes
meet. At a fixed orientation and working mode the parallel ones form a surface, of degree two in x′
and four in z′ in every plane y′ = const. Tale Masouleh and Gosselin 2009; Tale Masouleh et al.
2011, section 3 for the self-motions.
""",
    "trajectory": """
A **trajectory** is a path of (x, y, z, φ, θ) and a time law. Rates and accelerations of the
actuators follow from the limbs' closure equations, differentiated twice; the forces that hold the
load grow beyond all bounds at a parallel singularity, where the rates are as usual. At a serial one
it is the rates that grow. Tale Masouleh and Gosselin 2009.
""",
    "design": """
A **design** is five limbs: base point rᵢ, platform point s′ᵢ, link length lᵢ and stroke
ρ min … ρ max. Pairs of limbs whose base points share y, whose platform points lie on a line along
e₂ and whose links are equal form the arrangements A₁, A₂, A₃ (and M_p for a third limb) of the
paper's section 3; designs made of them have simpler forward kinematics, and some combinations
cannot be controlled at all. The U joints of an A₁ may be one: the design file says so,
`merged_joints = [[1, 2]]`, and what these limbs have in common is one number.
""",
}
