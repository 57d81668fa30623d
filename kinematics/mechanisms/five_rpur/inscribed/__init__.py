"""The usable workspace of the 5-RPUR: the largest ball and box inside.

inscribed       the ball and the box
growing         how they grow until contacts hold them from all sides
clearance       the contacts: how far the workspace reaches around a point or a box, exactly
"""
