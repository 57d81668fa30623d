"""What a trajectory asks of the actuators between its samples.

A path and a law are made of smooth pieces: knots and corners of the path, ends of the law's phases.
Within a piece every quantity is followed closely enough that no maximum is passed over which could
be the largest, or beyond a limit; then each of those is closed in on. Across a break a quantity may
leap: both sides count.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.trajectories import JUMP, Close, Limits
from kinematics.arrays import Array
from kinematics.trajectories.along import Along

STEPS = 64  # of the duration: steps are never longer than one of these
INNER = 3  # times that are looked at within each piece; 1 where there are many pieces
_MANY = 256  # pieces
_SIDE = 1e-10  # of the duration: how far beside a break its sides are looked at
_CLOSE = 0.01  # of the largest value: what a step may bulge between its ends
_HALVED = 6  # times at most
_MOST = 64  # maxima of one quantity that are closed in on
_ENDLESS = 1e100  # stands for what has no end
_PARTS = np.arange(1, 5) / 4.0  # of each half of a bracket about a maximum
_ROUNDS = 16
_NOTHING = 1e-11  # of the path's mean speed: a rate that is rounding
_FLAT = 1e-3  # relative: what falls off by less beside a maximum is a parabola
_SHOWN = 1e-6  # likewise, of one that is not the largest
_STILL = 1e-11  # relative: a maximum that would grow by less is found
_IDLE = 2  # rounds without gain after which the end of a piece is a maximum
_GROWS = 4.0  # in the last three rounds: a maximum that still grows so much has no end


def close(along: Along, times: Array, load: Sequence[float] | None, limits: Limits) -> Close:
    """Rates, accelerations and forces at the samples' times (N,) and at as many as it takes."""
    duration = along.law.duration
    breaks = _breaks(along)
    at = _first_times(duration, breaks, times)
    values, widths = _asked(along, at, load)
    bounds = _bounds(limits, widths)
    at, values = _followed(along, load, breaks, at, values, bounds)
    at, values = _climbed(along, load, breaks, at, values, bounds)
    rates, accelerations, forces = np.split(values, np.cumsum(widths)[:2], axis=1)
    corners, jumps = _corners(duration, breaks, at, rates, accelerations)
    return Close(at, rates, accelerations, forces, corners, jumps)


def crossings(
    along: Along,
    load: Sequence[float] | None,
    columns: NDArray[np.intp],
    limits: Array,
    inside: Array,
    outside: Array,
) -> Array:
    """Times (K,) at which sizes of quantities pass limits, in several brackets at once.

    Where there is nothing outside, at the end of what there is.

    Args:
        columns: (K,) of rates, accelerations and forces side by side.
        limits: (K,) of each.
        inside, outside: (K,) s, where it is beyond the limit and where it is not, or is none.
    """
    from scipy.optimize.elementwise import find_root  # slow to import

    def excess(times: Array, column: NDArray[np.intp], limit: Array) -> Array:
        size = np.abs(_asked(along, times, load)[0][np.arange(len(times)), column])
        return np.where(np.isnan(size), -limit, np.minimum(size, _ENDLESS) - limit)

    found = find_root(
        excess,
        (np.minimum(inside, outside), np.maximum(inside, outside)),
        args=(columns, limits),
        tolerances={"xatol": 4.0 * _SIDE * along.law.duration, "fatol": _STILL * limits.min()},
    )
    return np.where(found.success, found.x, 0.5 * (inside + outside))


def _asked(
    along: Along, times: Array, load: Sequence[float] | None
) -> tuple[Array, tuple[int, int, int]]:
    """Rates, accelerations and forces side by side (N, Q), and how many there are of each."""
    a, b, c = along.asked(times, load)
    return np.concatenate([a, b, c], axis=1), (a.shape[1], b.shape[1], c.shape[1])


def _bounds(limits: Limits, widths: Sequence[int]) -> Array:
    """(Q,) the limits side by side, inf where there is none."""
    given = (limits.rates, limits.accelerations, limits.forces)
    rows = []
    for values, width in zip(given, widths, strict=True):
        row = np.full(width, np.inf)
        if values is not None:
            row[: len(values)] = values[:width]
        rows.append(row)
    return np.concatenate(rows)


# --- times ---------------------------------------------------------------------------------


def _breaks(along: Along) -> Array:
    """Times (B,) between which everything is smooth, s."""
    duration = along.law.duration
    found = np.concatenate([along.law.breaks, along.law.times_of(along.path.knots)])
    room = 4.0 * _SIDE * duration
    found = np.sort(found[(found > room) & (found < duration - room)])
    if len(found):
        found = found[np.diff(found, prepend=-np.inf) > room]
    return found


def _first_times(duration: float, breaks: Array, samples: Array) -> Array:
    side = _SIDE * duration
    lows = np.concatenate([[0.0], breaks + side])
    highs = np.concatenate([breaks - side, [duration]])
    inner = INNER if len(lows) <= _MANY else 1
    within = lows + np.linspace(0.0, 1.0, inner + 2)[:, None] * (highs - lows)
    even = samples
    if len(samples) <= STEPS:
        even = np.union1d(samples, np.linspace(0.0, duration, STEPS + 1))
    # What stands on a break is one of its sides already.
    fence = np.concatenate([[-np.inf], breaks, [np.inf]])
    after = np.searchsorted(breaks, even)
    even = even[np.minimum(even - fence[after], fence[after + 1] - even) > side]
    return np.union1d(within.ravel(), even)


def _pieces(breaks: Array, at: Array) -> NDArray[np.intp]:
    """Which piece each time belongs to."""
    return np.searchsorted(breaks, at)


# --- maxima --------------------------------------------------------------------------------


def _followed(
    along: Along,
    load: Sequence[float] | None,
    breaks: Array,
    at: Array,
    values: Array,
    bounds: Array,
) -> tuple[Array, Array]:
    """Halve every step that may hide more than its ends show, and matters."""
    same = _pieces(breaks, at[:-1]) == _pieces(breaks, at[1:])
    low, high = at[:-1][same], at[1:][same]
    first, last = values[:-1][same], values[1:][same]
    for _ in range(_HALVED):
        if not len(low):
            break
        middle = 0.5 * (low + high)
        found, _ = _asked(along, middle, load)
        at, values = np.concatenate([at, middle]), np.concatenate([values, found])
        with np.errstate(invalid="ignore"):
            bulge = np.abs(found - 0.5 * (first + last))
            size = np.maximum(np.abs(found), np.maximum(np.abs(first), np.abs(last)))
            most = np.minimum(_largest(values), bounds)
            more = ((bulge > _CLOSE * most) & (size + 2.0 * bulge > most)).any(axis=1)
        half, own = middle[more], found[more]
        low, high = np.concatenate([low[more], half]), np.concatenate([half, high[more]])
        first, last = np.concatenate([first[more], own]), np.concatenate([own, last[more]])
    order = np.argsort(at, kind="stable")
    return at[order], values[order]


def _largest(values: Array) -> Array:
    """(Q,) of the sizes; 0 where there are none."""
    sizes = np.where(np.isfinite(values), np.abs(values), 0.0)
    return np.asarray(sizes.max(axis=0, initial=0.0))


def _climbed(
    along: Along,
    load: Sequence[float] | None,
    breaks: Array,
    at: Array,
    values: Array,
    bounds: Array,
) -> tuple[Array, Array]:
    """Close in on all maxima that count; one that has no end is infinite."""
    low, best, high, column = _summits(along, breaks, at, values, bounds)
    if not len(best):
        return at, values
    left, place, right = at[low], at[best], at[high]
    row, size = values[best].copy(), np.abs(values[best, column])
    history = [size.copy()]
    edge = np.zeros(len(best), dtype=bool)  # beside the best one there is nothing
    idle = np.zeros(len(best), dtype=int)  # rounds without gain
    active = np.arange(len(best))
    # The largest one and what is at a limit have to be known, of others a few digits are shown.
    largest = size >= (1.0 - 2.0 * _CLOSE) * _largest(values)[column]
    at_limit = np.abs(size - bounds[column]) <= 2.0 * _CLOSE * bounds[column]
    still = np.where(largest | at_limit, _STILL, _SHOWN)
    for _ in range(_ROUNDS):
        now = place[active, None]
        inner = (now + _PARTS * (side[active, None] - now) for side in (left, right))
        times = np.sort(np.column_stack([now, *inner]), axis=1)
        found = _asked(along, times.ravel(), load)[0].reshape(*times.shape, -1)
        each = np.arange(len(active))
        sizes = np.abs(found[each, :, column[active]])
        none = ~np.isfinite(sizes)
        sizes[none] = -1.0
        top = sizes.argmax(axis=1)
        most, spot = sizes[each, top], times[each, top]
        # Next to the best one on both sides, or itself where a piece ends.
        before = np.where(times < spot[:, None], times, -np.inf).argmax(axis=1)
        after = np.where(times > spot[:, None], times, np.inf).argmin(axis=1)
        before = np.where(times[:, 0] < spot, before, top)
        after = np.where(times[:, -1] > spot, after, top)
        left[active], right[active] = times[each, before], times[each, after]
        edge[active] = none[each, before] | none[each, after]
        better = most > size[active]
        change = active[better]
        place[change], size[change] = spot[better], most[better]
        row[change] = found[each, top][better]
        history.append(size.copy())
        idle[active] = np.where(better, 0, idle[active] + 1)
        ended = ~edge[active] & ((before == top) | (after == top))
        a, b = most - sizes[each, before], most - sizes[each, after]
        gain = (a - b) ** 2 / (8.0 * (a + b) + 1e-300)  # to the top of a parabola through three
        flat = (np.maximum(a, b) <= _FLAT * most) & (gain <= still[active] * most)
        active = active[np.where(ended, idle[active] < _IDLE, edge[active] | ~flat)]
        if not len(active):
            break
    endless = edge & (size > _GROWS**2 * history[0])
    if len(active):  # the rounds are over and it still grows
        endless[active] |= size[active] > _GROWS * history[-4][active]
    row[endless, column[endless]] = np.inf
    at, values = np.concatenate([at, place]), np.concatenate([values, row])
    order = np.argsort(at, kind="stable")
    return at[order], values[order]


def _summits(
    along: Along, breaks: Array, at: Array, values: Array, bounds: Array
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Maxima of all quantities that count: indices before, at and after each, and the quantity."""
    sizes = np.where(np.isfinite(values), np.abs(values), -1.0)
    same = _pieces(breaks, at[:-1]) == _pieces(breaks, at[1:])
    nothing = np.full((1, sizes.shape[1]), -1.0)
    left = np.concatenate([nothing, np.where(same[:, None], sizes[:-1], -1.0)])
    right = np.concatenate([np.where(same[:, None], sizes[1:], -1.0), nothing])
    most = _largest(values)
    counts = (1.0 - 2.0 * _CLOSE) * np.minimum(most, bounds)
    summit = (sizes > left) & (sizes >= right) & (sizes >= counts)
    summit &= (sizes > 0.0) & (most > _noise(along, values.shape[1]))
    rows, columns = [], []
    for k in range(sizes.shape[1]):
        own = np.flatnonzero(summit[:, k])
        own = own[np.argsort(-sizes[own, k], kind="stable")[:_MOST]]
        rows.append(own)
        columns.append(np.full(len(own), k))
    n, column = np.concatenate(rows), np.concatenate(columns)
    before = np.where(np.concatenate([[False], same])[n], n - 1, n)
    after = np.where(np.concatenate([same, [False]])[n], n + 1, n)
    return before, n, after, column


def _noise(along: Along, count: int) -> Array:
    """(Q,) a quantity that is nowhere larger is rounding."""
    joints = along.machine.joints
    length = along.machine.length
    pace = _NOTHING * along.path.length / along.law.duration
    rates = np.array([pace / length if c.unit == "rad" else pace for c in joints])
    forces = np.zeros(count - 2 * len(joints))
    return np.concatenate([rates, rates / along.law.duration, forces])


# --- corners -------------------------------------------------------------------------------


def _corners(
    duration: float, breaks: Array, at: Array, rates: Array, accelerations: Array
) -> tuple[Array, Array]:
    """Breaks (C,) across which rates leap, and by how much (C, J)."""
    after = np.searchsorted(at, breaks)
    leap = rates[after] - rates[after - 1]
    with np.errstate(invalid="ignore"):
        leap = leap - _SIDE * duration * (accelerations[after] + accelerations[after - 1])
        sharp = np.abs(leap).max(axis=1, initial=0.0) > JUMP * _largest(rates).max(initial=0.0)
    return breaks[sharp], leap[sharp]
