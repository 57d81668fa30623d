"""Forward displacement of the 4-SPS + 1-SPR: all assembly modes for given leg lengths.

`equations` has the closure equations and their path homotopy, `start_set` the stored solutions that
paths begin from (made by `monodromy`), `roots` every complex solution of a machine, `assembly` the
real ones with all that is said of them, `self_motion` curves of solutions, and `refreshing` keeps
their identities while the legs move.
"""
