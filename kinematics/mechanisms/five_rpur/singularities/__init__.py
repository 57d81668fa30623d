"""Where the 5-RPUR loses control, and why.

kinds           which singularities a posture is in, and their causes by line geometry
determinant     the function whose zeros are the parallel ones, in closed form
nearest         the zero that is nearest to a pose
cells           the function on a grid about a workspace
aspects         the workspace of a mode parted by the zeros, as solids
ball            the largest ball in it without zeros
curves          the zeros in a section, and over orientations
"""
