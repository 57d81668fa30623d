"""Sosa-López et al. (2017): trajectories, polynomials fitted to the joints, their true errors."""

from __future__ import annotations

from functools import cache

import numpy as np

from app.features.paper.items import Item
from app.features.paper.judging import (
    Outcome,
    Quantity,
    claimed,
    compared,
    drawn,
    identity,
    missing,
)
from app.features.paper.recomputed.five_bar import S, machine
from app.features.paper.registry import computes
from kinematics.answers.trajectories import Trajectory
from kinematics.arrays import Array
from kinematics.trajectories import Fits, fit

_UNITS = ("cm", "cm/s", "cm/s²")


@cache
def way(name: str, samples: int) -> Trajectory:
    """One of the paper's trajectories by the library: "line", "rest-to-rest"."""
    return machine().trajectory(name, samples=samples, distances=False)


@cache
def fitted(name: str, samples: int, degree: int) -> Fits:
    """Its joints as polynomials."""
    return fit(machine(), way(name, samples), degree)


def value(powers: Array, times: Array, order: int = 0) -> Array:
    """A polynomial, from t⁰ upwards, or a derivative of it."""
    polynomial = np.polynomial.polynomial
    return np.asarray(polynomial.polyval(times, polynomial.polyder(powers, order)))


def powers_of(item: Item) -> Array:
    """The printed coefficients, from t⁰ upwards."""
    return np.array([float(text) for text in item.data["powers"]])


# --- desired trajectories ------------------------------------------------------------------


@computes(S, "eq. 8")
def eq_8(item: Item) -> Outcome:
    found = way("line", 101)
    off = float(np.abs(found.poses[:, 0] / 10.0 - 10.0 * found.times).max()) / 10.0
    return identity(off, where="at 101 times from 0 to 1 s, beside the library's trajectory")


@computes(S, "eq. 9")
def eq_9(item: Item) -> Outcome:
    start = machine().forward(np.radians(item.data["start"]).tolist())
    y = float(start.poses[:, 1].max()) / 10.0
    low, high = 1.0, 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        at = (100.0 * middle, 738.644 + 100.0 * middle)
        inside = np.isfinite(machine().mechanism.joints(np.array([at]), "+-")).all()
        low, high = (middle, high) if inside else (low, middle)
    return compared(
        Quantity("y of P at θ = 108°, 72°", y, item.data["value"], "cm"),
        Quantity("t at which the line leaves the workspace", low, unit="s"),
    )


def _rest(item: Item, order: int) -> Outcome:
    """Eqs. 10 to 12: the printed sign of one term beside the library's trajectory."""
    found = way("rest-to-rest", 201)
    exact = (found.poses, found.pose_rates, found.pose_accelerations)[order][:, 0] / 10.0
    powers = powers_of(item)
    turned = powers.copy()
    turned[3 - order] *= -1.0
    size = float(np.abs(exact).max())
    off = [float(np.abs(value(p, found.times) - exact).max()) / size for p in (powers, turned)]
    where = "at 201 times from 0 to 2 s, beside the library's quintic from rest to rest"
    told = identity(off[0], off[1], where=where)
    end = Quantity(
        "value at t = 2 s as printed", float(value(powers, np.array(2.0))), unit=_UNITS[order]
    )
    right = Quantity(
        "with the sign turned", float(value(turned, np.array(2.0))), unit=_UNITS[order]
    )
    return Outcome(told.verdict, (*told.quantities, end, right), told.proof)


@computes(S, "eq. 10")
def eq_10(item: Item) -> Outcome:
    return _rest(item, 0)


@computes(S, "eq. 11")
def eq_11(item: Item) -> Outcome:
    return _rest(item, 1)


@computes(S, "eq. 12")
def eq_12(item: Item) -> Outcome:
    return _rest(item, 2)


def _quintic(order: int) -> Array:
    """Coefficients of y(t), cm, or of a derivative, of the library's trajectory."""
    found = way("rest-to-rest", 201)
    fitted = np.polynomial.Polynomial.fit(found.times, found.poses[:, 1] / 10.0, 5).convert().coef
    return np.asarray(np.polynomial.polynomial.polyder(fitted, order))


def _coefficients(item: Item, order: int) -> Outcome:
    """Eqs. 13 to 15: printed coefficients beside those of the library's trajectory."""
    exact = _quintic(order)
    pairs = [
        Quantity(f"coefficient of t{_power(n)}", float(exact[n]), text)
        for n, text in enumerate(item.data["powers"])
        if text != "0"
    ]
    powers = powers_of(item)
    end = np.array(2.0)
    return compared(
        *pairs,
        Quantity("value at t = 2 s as printed", float(value(powers, end)), unit=_UNITS[order]),
        Quantity("slope there", float(value(powers, end, 1)), unit=f"{_UNITS[order]} a second"),
    )


def _power(n: int) -> str:
    return "".join("⁰¹²³⁴⁵⁶⁷⁸⁹"[int(digit)] for digit in str(n))


@computes(S, "eq. 13")
def eq_13(item: Item) -> Outcome:
    return _coefficients(item, 0)


@computes(S, "eq. 14")
def eq_14(item: Item) -> Outcome:
    return _coefficients(item, 1)


@computes(S, "eq. 15")
def eq_15(item: Item) -> Outcome:
    return _coefficients(item, 2)


@computes(S, "Fig. 3", "Fig. 4")
def fig_3(item: Item) -> Outcome:
    found = way(item.data["trajectory"], 201)
    ends = [", ".join(f"{v / 10.0:.4f}" for v in found.poses[n]) for n in (0, -1)]
    slip = np.abs(np.gradient(found.poses, found.times, axis=0) - found.pose_rates)[1:-1].max()
    return drawn(
        bool(found.sound and slip < 2e-3 * np.abs(found.pose_rates).max()),
        Quantity("start", ends[0], unit="cm"),
        Quantity("end", ends[1], unit="cm"),
        Quantity("duration", found.duration, unit="s"),
        proof="the library runs it within the workspace and without a singularity",
    )


@computes(S, "C3")
def c_3(item: Item) -> Outcome:
    from app.features.paper.items import paper

    found = way("rest-to-rest", 201)
    ends = [
        float(np.abs(values[[0, -1]]).max()) / 10.0
        for values in (found.pose_rates, found.pose_accelerations)
    ]
    known = {order: paper(S).item(f"eq. {10 + order}") for order in (1, 2)}
    printed = [abs(float(value(powers_of(known[order]), np.array(2.0)))) for order in (1, 2)]
    return claimed(
        max(printed) < 1e-6,
        Quantity("largest velocity at both ends, signs corrected", ends[0], unit="cm/s"),
        Quantity("largest acceleration there", ends[1], unit="cm/s²"),
        Quantity("|ẋ| at 2 s as printed", printed[0], "0", "cm/s"),
        Quantity("|ẍ| at 2 s as printed", printed[1], "0", "cm/s²"),
        proof=f"as printed ẋ(2 s) is {printed[0]:.0f} cm/s, with the signs corrected "
        f"{ends[0]:.0e} cm/s",
    )


# --- fits ----------------------------------------------------------------------------------


def _of(item: Item) -> tuple[str, int, int]:
    return item.data["trajectory"], item.data["samples"], item.data["degree"]


@computes(S, "eq. 16", "eq. 17", "eq. 18", "eq. 19")
def eq_16(item: Item) -> Outcome:
    found = fitted(*_of(item))
    own = found.coefficients[item.data["joint"] - 1]
    pairs = [
        Quantity(f"coefficient of t{_power(n)}", float(own[n]), text)
        for n, text in enumerate(item.data["powers"])
    ]
    off = printed_errors(item.data["trajectory"])
    return compared(
        *pairs,
        Quantity(
            "σ of x and y, machine driven by the digits that are printed",
            f"{off.std(axis=0, ddof=1)[0]:.2g}, {off.std(axis=0, ddof=1)[1]:.2g}",
            unit="cm",
        ),
        Quantity(
            "largest error so",
            f"{np.abs(off).max(axis=0)[0]:.2g}, {np.abs(off).max(axis=0)[1]:.2g}",
            unit="cm",
        ),
        Quantity(
            "σ with full digits",
            f"{found.deviation[0][0] / 10:.3g}, {found.deviation[0][1] / 10:.3g}",
            unit="cm",
        ),
    )


@cache
def printed_errors(name: str) -> Array:
    """(N, 2) cm: P of the machine that is driven by eqs. 16, 17 (18, 19) less the trajectory."""
    from app.features.paper.items import paper

    numbers, samples = (
        (("eq. 16", "eq. 17"), 101) if name == "line" else (("eq. 18", "eq. 19"), 201)
    )
    found = way(name, samples)
    joints = np.stack(
        [value(powers_of(paper(S).item(each)), found.times) for each in numbers], axis=-1
    )
    off = []
    for one, wanted in zip(machine().forward(joints), found.poses, strict=True):
        near = np.hypot(*(one.poses - wanted).T).argmin()
        off.append((one.poses[near] - wanted) / 10.0)
    return np.array(off)


@computes(S, "Fig. 5", "Fig. 6")
def fig_5(item: Item) -> Outcome:
    found = fitted(*_of(item))
    sigma = found.deviation[0] / 10.0
    most = found.largest[0] / 10.0
    return drawn(
        not found.trouble and bool(most.max() < 0.1),
        Quantity("σ of x", float(sigma[0]), unit="cm"),
        Quantity("σ of y", float(sigma[1]), unit="cm"),
        Quantity("largest error", float(most.max()), unit="cm"),
        proof="the machine that is driven by the fits comes through and stays within a mm",
    )


@computes(S, "Fig. 2")
def fig_2(item: Item) -> Outcome:
    # Inverse and forward kinematics undo each other; what is left are the fits' errors.
    found = way("rest-to-rest", 201)
    closed = max(
        float(np.hypot(*(one.poses - pose).T).min()) / 10.0
        for one, pose in zip(machine().forward(found.joints), found.poses, strict=True)
    )
    fits = fitted("rest-to-rest", 201, 8)
    return drawn(
        closed < 1e-10,
        Quantity("largest |FK(IK(p)) − p|", closed, unit="cm"),
        Quantity("largest |FK(fit(IK(p))) − p|", float(fits.largest[0].max()) / 10.0, unit="cm"),
        proof="without fits the algorithm closes to rounding",
    )


@computes(S, "Fig. 10", "Fig. 11", "Fig. 13")
def fig_10(item: Item) -> Outcome:
    found = way("rest-to-rest", 201)
    joints = np.gradient(found.joints, found.times, axis=0)[5:-5]
    slip = float(np.abs(joints - found.joint_rates[5:-5]).max() / np.abs(found.joint_rates).max())
    back = machine().motion.forward(
        found.poses, found.mode, found.joint_rates, found.joint_accelerations
    )
    if item.name == "Fig. 10":
        told = [
            Quantity(
                f"largest |θ̇_{n + 1}|", float(np.abs(found.joint_rates[:, n]).max()), unit="rad/s"
            )
            for n in (0, 1)
        ]
    else:
        values = found.pose_rates if item.name == "Fig. 11" else found.pose_accelerations
        unit = "cm/s" if item.name == "Fig. 11" else "cm/s²"
        dots = "̇" if item.name == "Fig. 11" else "̈"
        told = [
            Quantity(f"largest |{axis}{dots}|", float(np.abs(values[:, n]).max()) / 10.0, unit=unit)
            for n, axis in enumerate("xy")
        ]
    closed = max(
        float(np.abs(back.pose_rates - found.pose_rates).max() / np.abs(found.pose_rates).max()),
        float(
            np.abs(back.pose_accelerations - found.pose_accelerations).max()
            / np.abs(found.pose_accelerations).max()
        ),
    )
    return drawn(
        slip < 1e-2 and closed < 1e-9,
        *told,
        Quantity("forward after inverse, relative error", closed),
        proof="inverse and forward differential kinematics undo each other, and rates are those of "
        "the joints' curves",
    )


# --- the comparison tables -----------------------------------------------------------------


@computes(S, "Table II", "Table III", "Table IV")
def tables(item: Item) -> Outcome:
    order = item.data["order"]
    quantities = []
    for n, (x, y, total) in enumerate(item.data["rows"], start=1):
        root = float(np.hypot(float(x), float(y)))
        quantities.append(
            Quantity(f"row {n}: root of the sum of squares", root, total, _UNITS[order])
        )
    for name, samples, degree in (("line", 101, 3), ("rest-to-rest", 201, 8)):
        if order == 0 or name == "rest-to-rest":
            found = fitted(name, samples, degree).deviation[order] / 10.0
            quantities.append(
                Quantity(
                    f"true σ of x and y of the fits, {name}",
                    f"{found[0]:.3g}, {found[1]:.3g}",
                    unit=_UNITS[order],
                )
            )
    return missing(*quantities)


@computes(S, "C5")
def c_5(item: Item) -> Outcome:
    told = []
    for name, samples, degree in (("line", 101, 3), ("rest-to-rest", 201, 8)):
        for order, sigma in enumerate(fitted(name, samples, degree).deviation):
            if order == 0 or name == "rest-to-rest":
                text = ", ".join(f"{v / 10.0:.3g}" for v in sigma)
                told.append(
                    Quantity(
                        f"true σ of x and y, {name}, degree {degree}", text, unit=_UNITS[order]
                    )
                )
    return missing(*told)
