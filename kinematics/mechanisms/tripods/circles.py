"""The largest circle of orientations about any one at a fixed altitude, for each kind of limit.

The orientations of an operation mode are a sphere of unit vectors x (`posing`), on which the angle
by which the platform turns is twice the distance. A circle about the home is one on this
sphere; about θ = 0 it is a circle of the paper's polar chart as well. Along it P and the limb
lengths are smooth and periodic, so their least values over it are found to rounding, and as the
circle grows the first zero of that. About θ = 0 the exact MICR is taken (`micr`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kinematics.answers.bounds import Bound, named, range_of
from kinematics.answers.circles import OrientationCircle, Profile, ProfileCurve
from kinematics.arrays import Array
from kinematics.errors import InputError
from kinematics.facets.circles import CirclesFacet
from kinematics.mechanisms.tripods import polynomial
from kinematics.mechanisms.tripods.design import LIMBS, TripodDesign, mode_sign
from kinematics.mechanisms.tripods.inverse import LIMITS
from kinematics.mechanisms.tripods.limbs import limb_lengths
from kinematics.mechanisms.tripods.micr import RING, contact_azimuths, micr, table

_RADII = 241  # circles looked at, 0.75° apart
_TURNS = 120  # points of each
_ZOOMS = 6  # of a least value between two points, each ten times as sharp
_ERROR = 1e-8  # rad, of a radius that was searched for
_EXACT = 1e-12
_SHALLOW = 0.05  # part of the room at the centre below which a dip is looked into
_SAME = 1e-7  # rad by which circles meet a limit together
_LOWEST, _HIGHEST, _COUNT = 0.02, 4.0, 200  # of Z / h1, as in the paper's figures
_MOST = 12  # ratios h2 / h1 side by side

_Contacts = tuple[tuple[float, float], ...]


class Circles(CirclesFacet[TripodDesign]):
    """Of the tripods also MICR against the altitude (Nayak et al. 2017, Figs. 4, 5)."""

    def about(self, pose: Sequence[float], mode: str) -> tuple[OrientationCircle, ...]:
        return circles(self.design, tuple(pose), mode)

    def profile(self, pose: Sequence[float], ratios: Sequence[float] = ()) -> Profile:
        """Curves of MICR over Z / h1, both operation modes of every ratio h2 / h1.

        Args:
            pose: its altitude is marked.
            ratios: further h2 / h1; the machine's own comes first.

        Raises:
            InputError: a ratio is not a positive number, or there are too many of them.
        """
        if len(ratios) > _MOST:
            raise InputError(f"at most {_MOST} ratios h2 / h1 can be compared, got {len(ratios)}")
        if not all(np.isfinite(r) and r > 0.0 for r in ratios):
            raise InputError("a ratio h2 / h1 must be a positive number")
        design, place = self.design, self.profile_place(pose)
        own = design.platform_radius / design.base_radius
        at = np.linspace(_LOWEST, max(_HIGHEST, place), _COUNT)
        wanted = [own, *(r for r in dict.fromkeys(ratios) if r != own)]
        found = table(design.mechanism, np.ones((len(wanted), 1)), np.array(wanted)[:, None], at)
        # Where no tilt is singular the whole half turn is free.
        radius = np.where(np.isnan(found.radius), np.pi, found.radius)
        curves = tuple(
            ProfileCurve(f"h₂/h₁ = {ratio:g}", mode, n == 0, radius[m, n])
            for n, ratio in enumerate(wanted)
            for m, mode in enumerate(found.modes)
        )
        title = "MICR over the altitude"
        return Profile(title, "Z / h₁", "MICR", at, curves, place, "Figs. 4 and 5")

    def profile_place(self, pose: Sequence[float]) -> float:
        return abs(float(pose[0])) / self.design.base_radius

    micr = staticmethod(table)


def circles(
    design: TripodDesign, pose: tuple[float, ...], mode: str
) -> tuple[OrientationCircle, ...]:
    """About the pose's orientation, at its altitude: for parallel and constraint singularities and
    for the strokes. A radius of 0 where the pose itself is beyond a limit."""
    z, tilt, azimuth = (float(v) for v in pose)
    home = Home(design, mode, z, tilt, azimuth)
    return (_parallel(home), _constraint(home), _strokes(home))


@dataclass(frozen=True, slots=True)
class Home:
    """The centre of a circle: a machine in a mode at an altitude and an orientation."""

    design: TripodDesign
    mode: str
    z: float
    tilt: float
    azimuth: float

    @property
    def k(self) -> float:
        return mode_sign(self.mode) * self.design.platform_radius

    def polynomial_at(self, x: Array) -> Array:
        """P at unit vectors x (..., 3); odd in x, and smooth where the tilt passes π."""
        x0, x1, x2 = x[..., 0], x[..., 1], x[..., 2]
        a0, a1, a2, a3 = polynomial.terms(
            self.design.mechanism, self.design.base_radius, self.k, self.z, x1 * x1 + x2 * x2
        )
        cube = 3.0 * x1 * x1 * x2 - x2**3
        value: Array = x0 * a0 + cube * (a1 + x0 * cube * (a2 + x0 * cube * a3))
        return value

    def lengths_at(self, x: Array) -> Array:
        """Limb lengths (..., 3), mm; NaN where there is no position."""
        chart = _chart(x)
        pose = np.concatenate([np.full((*chart.shape[:-1], 1), self.z), chart], axis=-1)
        return limb_lengths(self.design, pose, self.mode)


# --- for each limit ------------------------------------------------------------------------


def _parallel(home: Home) -> OrientationCircle:
    design, z = home.design, home.z
    if home.tilt == 0.0 and z != 0.0:
        found = micr(design.mechanism, design.base_radius, design.platform_radius, z, home.mode)
        radius, w = float(found.radius), float(found.contact) * np.sign(z)
        if not np.isfinite(radius):
            return _circle(home, "parallel", np.pi, (), _EXACT)
        contacts = tuple((radius, a) for a in contact_azimuths(w))
        return _circle(home, "parallel", radius, contacts, _EXACT)
    frame = _frame(home.tilt, home.azimuth)
    side = np.sign(home.polynomial_at(frame[0]))
    if side == 0.0:
        return _circle(home, "parallel", 0.0, ((home.tilt, home.azimuth),), _EXACT)
    sampled = side * home.polynomial_at(_grid(frame))
    radius, contacts = _first_zero(frame, lambda x: side * home.polynomial_at(x), sampled)
    return _circle(home, "parallel", radius, contacts, _ERROR)


def _constraint(home: Home) -> OrientationCircle:
    radius = abs(np.pi - home.tilt)
    return _circle(home, "constraint", radius, ((np.pi, home.azimuth),), _EXACT)


def _strokes(home: Home) -> OrientationCircle:
    frame = _frame(home.tilt, home.azimuth)
    now = home.lengths_at(frame[0])
    best: tuple[float, _Contacts, int, Bound] | None = None
    sampled = home.lengths_at(_grid(frame))
    for i in range(LIMBS):
        for bound, end in zip(range_of(LIMITS, i + 1), home.design.stroke, strict=True):
            side = 1.0 if bound == "rho_min" else -1.0
            radius: float = 0.0
            contacts: _Contacts = ((home.tilt, home.azimuth),)
            if side * (now[i] - end) > 0.0:  # not so where there is no position
                radius, contacts = _first_zero(
                    frame, _limb_room(home, i, side, end), _room(sampled[..., i], side, end)
                )
            if best is None or radius < best[0] - _SAME:
                best = radius, contacts, i, bound
            elif abs(radius - best[0]) <= _SAME and radius < np.pi:
                best = best[0], (*best[1], *contacts), best[2], best[3]
    assert best is not None
    radius, contacts, i, bound = best
    if radius >= np.pi:
        return _circle(home, "stroke", np.pi, (), _ERROR)
    return _circle(home, "stroke", radius, contacts, _ERROR, i + 1, bound)


def _limb_room(home: Home, i: int, side: float, end: float) -> Callable[[Array], Array]:
    return lambda x: _room(home.lengths_at(x)[..., i], side, end)


def _room(length: Array, side: float, end: float) -> Array:
    """How far a limb is from an end of its stroke, relative; endless where there is no position."""
    with np.errstate(invalid="ignore"):
        value = side * (length - end) / (length + end)
    return np.where(np.isfinite(value), value, side)


def _circle(
    home: Home,
    limit: Literal["parallel", "constraint", "stroke"],
    radius: float,
    contacts: tuple[tuple[float, float], ...],
    error: float,
    limb: int | None = None,
    bound: str = "",
) -> OrientationCircle:
    barred = not home.design.revolute_on_base and abs(home.tilt - RING) < radius
    what = {
        "parallel": "a parallel singularity",
        "constraint": "the constraint singularity",
        "stroke": f"the end of limb {limb}'s stroke ({named(bound)})",
    }[limit]
    if radius >= np.pi and limit != "constraint":
        text = f"No orientation at this altitude meets {what.partition(' (')[0]}."
        text = text.replace("the end of limb None's stroke", "the end of a stroke")
    else:
        text = (
            f"The platform can turn by {np.degrees(radius):.3f}° in every direction until {what}."
        )
    if barred:
        text += (
            " The circle crosses the ring at a tilt of 90°, which no position at this altitude has."
        )
    return OrientationCircle(
        limit, float(radius), contacts, text, limb, bound, barred, 0.0 if radius == 0.0 else error
    )


# --- on the sphere -------------------------------------------------------------------------


def _frame(tilt: float, azimuth: float) -> Array:
    """x of an orientation and two unit vectors normal to it, (3, 3) as rows."""
    c, s = np.cos(0.5 * tilt), np.sin(0.5 * tilt)
    a, b = np.cos(azimuth), np.sin(azimuth)
    return np.array([[c, s * a, s * b], [-s, c * a, c * b], [0.0, -b, a]])


def _on_circle(frame: Array, radius: Array, turn: Array) -> Array:
    """x (..., 3) of the orientations that are turned by ``radius`` from the frame's."""
    half = 0.5 * radius
    aside = np.cos(turn)[..., None] * frame[1] + np.sin(turn)[..., None] * frame[2]
    found: Array = np.cos(half)[..., None] * frame[0] + np.sin(half)[..., None] * aside
    return found


def _chart(x: Array) -> Array:
    """(tilt, azimuth) of unit vectors (..., 3), of which x and −x are one orientation."""
    sign = np.where(x[..., 0] < 0.0, -1.0, 1.0)
    s = np.hypot(x[..., 1], x[..., 2])
    azimuth = np.arctan2(sign * x[..., 2], sign * x[..., 1])
    return np.stack([2.0 * np.arctan2(s, sign * x[..., 0]), np.where(s > 0.0, azimuth, 0.0)], -1)


def _grid(frame: Array) -> Array:
    """x (radii, turns, 3) all over the orientations about the frame's."""
    return _on_circle(frame, _radii()[:, None], _turns()[None, :])


def _radii() -> Array:
    return np.linspace(0.0, np.pi, _RADII)


def _turns() -> Array:
    return np.linspace(0.0, 2.0 * np.pi, _TURNS, endpoint=False)


def _first_zero(
    frame: Array, room: Callable[[Array], Array], sampled: Array
) -> tuple[float, tuple[tuple[float, float], ...]]:
    """The smallest radius on whose circle ``room``, positive at the centre, is zero somewhere,
    and where; π where it is positive throughout. ``sampled`` is ``room`` on `_grid`."""
    from scipy.optimize import minimize_scalar

    radii, turns = _radii(), _turns()
    lowest = sampled.min(axis=1)

    def least(radius: float) -> tuple[float, float]:
        values = room(_on_circle(frame, np.array(radius), turns))
        at, step = turns[_dips(values)], turns[1]
        fine = np.linspace(-1.0, 1.0, 21)
        for _ in range(_ZOOMS):
            around = at[:, None] + step * fine
            values = room(_on_circle(frame, np.array(radius), around))
            at = np.take_along_axis(around, values.argmin(axis=1)[:, None], axis=1)[:, 0]
            step = 0.1 * step
        best = values.min(axis=1)
        n = int(best.argmin())
        return float(best[n]), float(at[n])

    below = np.flatnonzero(lowest <= 0.0)
    top = int(below[0]) if len(below) else len(radii) - 1
    for n in range(1, top):  # a dip between two circles
        dip = lowest[n] <= lowest[n - 1] and lowest[n] <= lowest[n + 1]
        if dip and lowest[n] < _SHALLOW * lowest[0]:
            found = minimize_scalar(
                lambda r: least(float(r))[0],
                bounds=(radii[n - 1], radii[n + 1]),
                method="bounded",
                options={"xatol": 1e-9},
            )
            if found.fun <= 0.0:
                return _settled(frame, least, float(radii[n - 1]), float(found.x))
    if not len(below):
        return np.pi, ()
    low = top - 1
    while low > 0 and least(float(radii[low]))[0] <= 0.0:  # a dip between two points of a circle
        low -= 1
    return _settled(frame, least, float(radii[low]), float(radii[low + 1]))


def _settled(
    frame: Array, least: Callable[[float], tuple[float, float]], low: float, high: float
) -> tuple[float, tuple[tuple[float, float], ...]]:
    from scipy.optimize import brentq

    radius = float(brentq(lambda r: least(float(r))[0], low, high, xtol=1e-13, rtol=1e-14))
    _, where = least(radius)
    tilt, azimuth = _chart(_on_circle(frame, np.array(radius), np.array(where))).tolist()
    return radius, ((float(tilt), float(azimuth)),)


def _dips(values: Array) -> NDArray[np.intp]:
    """Where periodic values are not above both neighbours, the four lowest of these."""
    dips = np.flatnonzero((values <= np.roll(values, 1)) & (values <= np.roll(values, -1)))
    return dips[np.argsort(values[dips])[:4]]
