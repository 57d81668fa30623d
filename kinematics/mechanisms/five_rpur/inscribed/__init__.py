"""The usable workspace of the 5-RPUR: the largest ball and box inside.

largest         the ball and the box
balls, boxes    how they grow until contacts hold them from all sides; `growing` is common to both
contacts        how far the workspace reaches around a point or a box, exactly
region          the workspace at an orientation: the sets that make it, the surfaces that bound it
"""
