"""Why a pose cannot be held and the ways out of it, for the 5-RPUR.

facet           what is asked: the nearest posture, the changes of the design, in words
projection      the nearest place of one mode's workspace at one orientation, proven
redesign        the smallest changes of single numbers that give a limb back to the pose
"""
