"""Where the 5-RPUR loses control, as geometry: the locus of its parallel singularities.

determinant     the function whose zeros they are, in closed form: values, slopes, polynomials
nearest         the zero that is nearest to a pose
cells           the function on a grid about a workspace
aspects         the workspace of a mode parted by the zeros, as solids
ball            the largest ball in it without zeros
curves          the zeros in a section, and over orientations
"""
