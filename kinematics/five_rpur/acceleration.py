from types import ModuleType
import sys
from kinematics.five_rpur import kernel as _k
_done = False
NAMES = "heights bounds_of offset rise matters crossings root at_border mixed meet sweep primitives under run_moments measure".split()
def kernel(count):
    global _done
    if not _done:
        from numba import njit
        for n in NAMES:
            setattr(_k, n, njit(getattr(_k, n), error_model="numpy", cache=True))
        _done = True
    return _k
