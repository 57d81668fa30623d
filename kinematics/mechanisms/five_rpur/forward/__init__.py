"""Forward kinematics of the 5-RPUR: all assembly modes for given actuator lengths.

equations       the constraints over the complex numbers, for many configurations at a time
simplified      the nine simplified designs, by `linkage` (θ, X, w), `stages` (free limbs and the
                planar sextic), with `polynomial` and `columns` for many small systems at once
general         every design by a parameter homotopy, from the start sets of `families`, which
                `monodromy` makes
assembly        the real solutions of either with all that is said of them; `coincidence`: those
                that are double, nearly so, or on a curve
refreshing      who is who while the actuators move
"""
