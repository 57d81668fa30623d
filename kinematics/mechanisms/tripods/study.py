"""Study parameters (x0 … x3, y0 … y3) of a displacement, in and out (Nayak et al. 2017, eq. 2).

The x are the quaternion of the rotation, normed to length one, and Σ x_i y_i = 0 (eqs. 3 and 8).
Arrays may be complex: a rotation is then complex too. Lengths mm.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Values = NDArray[Any]
"""Real or complex numbers."""


def rotation(x: Values) -> Values:
    """The rotational part of eq. 2: x (..., 4), of length one → (..., 3, 3)."""
    x0, x1, x2, x3 = (x[..., n] for n in range(4))
    rows = [
        [x0 * x0 + x1 * x1 - x2 * x2 - x3 * x3, 2 * (x1 * x2 - x0 * x3), 2 * (x0 * x2 + x1 * x3)],
        [2 * (x0 * x3 + x1 * x2), x0 * x0 - x1 * x1 + x2 * x2 - x3 * x3, 2 * (x2 * x3 - x0 * x1)],
        [2 * (x1 * x3 - x0 * x2), 2 * (x0 * x1 + x2 * x3), x0 * x0 - x1 * x1 - x2 * x2 + x3 * x3],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def translation(study: Values) -> Values:
    """The translational part of eq. 2: (..., 8) → (..., 3)."""
    x, y = study[..., :4], study[..., 4:]
    # 2 E(x) y of `with_translation`, whose rows are orthogonal.
    return np.stack([2.0 * (row * y).sum(axis=-1) for row in _rows(x)], axis=-1)


def with_translation(x: Values, position: Values) -> Values:
    """The Study parameters of a rotation x (..., 4) and a translation (..., 3): (..., 8).

    Eq. 2 and eq. 3 are four equations in y whose rows are orthogonal, of length 2 and 1.
    """
    one, two, three = _rows(x)
    y = 0.5 * (position[..., 0:1] * one + position[..., 1:2] * two + position[..., 2:3] * three)
    return np.concatenate(np.broadcast_arrays(x, y), axis=-1)


def _rows(x: Values) -> tuple[Values, Values, Values]:
    x0, x1, x2, x3 = (x[..., n] for n in range(4))
    return (
        np.stack([x1, -x0, x3, -x2], axis=-1),
        np.stack([x2, -x3, -x0, x1], axis=-1),
        np.stack([x3, x2, -x1, -x0], axis=-1),
    )


def inverse(study: Values) -> Values:
    """The inverse displacement: the conjugate of the dual quaternion, (..., 8) → (..., 8)."""
    return np.asarray(study * np.array([1.0, -1.0, -1.0, -1.0] * 2))
