"""Forward kinematics: all assembly modes for given joints, by the group of the platform's motion.

`study` follows paths in Study's coordinates, `rotations` in quaternions; `planar` and `translation`
have closed forms; `searching` is for what is left. `assembly` tells the real solutions.
"""
