"""What a move of the 5-RPUR's pose in one working mode passes, and how near control is to be lost.

passing         what a straight way passes: the events, in order
paths           following a polyline of poses, up to what stops it
nearness        a warning next to singularities
way             the straight way: the limbs and the wrenches' determinant along it
pieces          zeros and extremes of smooth functions, by Chebyshev polynomials
"""
