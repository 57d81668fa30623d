"""Where the 5-RPUR loses control, as geometry: the locus of its parallel singularities.

`determinant` is the function whose zeros they are, in closed form; `nearest` finds the zero that
is nearest to a pose.
"""
