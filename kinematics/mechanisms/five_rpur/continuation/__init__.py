"""Continuation of one assembly mode of the 5-RPUR while its actuators move.

following       what is asked: polish a guess, follow the actuators, see the fold ahead
tracing         pieces of the curve, one after another, and searches within one
certificate     the proof that a piece is one curve and no other is near
curve           the equations along a line in joint space, one Newton correction
"""
