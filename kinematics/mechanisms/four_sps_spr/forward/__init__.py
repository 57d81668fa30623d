"""Forward displacement of the 4-SPS + 1-SPR: all assembly modes for given leg lengths.

`equations` has the closure equations and their path homotopy, `roots` every complex solution of a
machine, from a stored start set (made by `monodromy`), `assembly` the real ones.
"""
