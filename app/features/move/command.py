"""`bohemia velocity` and `bohemia statics`: how the platform is moved and held at a pose."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from math import degrees, isfinite
from typing import TYPE_CHECKING

from app.terminal import common, tables
from app.terminal.place import Place
from kinematics.errors import InputError

if TYPE_CHECKING:
    from kinematics.answers.motion import Motion
    from kinematics.answers.solutions import Posture
    from kinematics.arrays import Array
    from kinematics.mechanism import Coordinate

LOAD = ("Fx", "Fy", "Fz", "Tx", "Ty", "Tz")


def register(command: common.AddCommand) -> None:
    velocity = command("velocity", _velocity, "Rates and accelerations, either way round.")
    common.add_design(velocity)
    common.add_pose(velocity)
    common.add_mode(velocity, "that of the home posture")
    for name, what, other in (
        (
            "rates",
            "d(pose)/dt, mm/s and degrees/s, - for one that the constraint gives",
            "joint rates are computed",
        ),
        ("joint-rates", "actuator rates, mm/s (angles: degrees/s)", "the platform's are computed"),
    ):
        velocity.add_argument(f"--{name}", metavar="v1,...", help=f"{what}; {other}")
    for name, what in (("accelerations", "rates"), ("joint-accelerations", "joint-rates")):
        velocity.add_argument(
            f"--{name}", metavar="a1,...", help=f"goes with --{what}, /s² (default 0)"
        )
    velocity.epilog = (
        "The twist is the platform's angular velocity and the velocity of its origin, base frame. "
        "JSON has null where a rate does not exist or is not determined, and says why in reasons; "
        "next to a singularity numbers come with a warning."
    )
    common.add_json(velocity)

    statics = command("statics", _statics, "Actuator forces and constraint wrenches for a load.")
    common.add_design(statics)
    common.add_pose(statics)
    common.add_mode(statics, "that of the home posture")
    statics.add_argument(
        "--load",
        required=True,
        metavar="Fx,Fy,Fz,Tx,Ty,Tz",
        help="force (N) and moment (N·mm) on the platform at its origin, base frame",
    )
    statics.epilog = "A positive actuator force pushes the platform; a rotary one acts along +q."
    common.add_json(statics)


# --- velocity ------------------------------------------------------------------------------


def _velocity(arguments: argparse.Namespace) -> None:
    forward = arguments.joint_rates is not None
    if forward == (arguments.rates is not None):
        raise InputError("give either --rates or --joint-rates (see bohemia velocity --help)")
    wrong = arguments.accelerations if forward else arguments.joint_accelerations
    if wrong is not None:
        raise InputError(
            "--accelerations goes with --rates, --joint-accelerations with --joint-rates"
        )
    place = Place.of(arguments)
    machine, at = place.machine, (place.pose, place.mode)
    if forward:
        rates = _inner("--joint-rates", arguments.joint_rates, place.joints)
        second = _optional("--joint-accelerations", arguments.joint_accelerations, place.joints)
        found = machine.motion.forward(*at, rates, second)
    else:
        rates = _inner("--rates", arguments.rates, place.axes)
        second = _optional("--accelerations", arguments.accelerations, place.axes)
        found = machine.motion.inverse(*at, rates, second)
    posture = place.posture()
    reasons, warnings = _judged(place, posture, _numbers(found), serial=not forward)
    _warn(place, warnings)
    if not arguments.json:
        place.head()
        print("\n".join(_motion_lines(place, found, reasons)))
        return
    common.print_json(
        {
            **place.entries(),
            "joints": [common.finite(v) for v in tables.outer(posture.joints, place.joints)],
            "within_stroke": posture.reachable,
            "rates": _named(found.pose_rates, place.axes),
            "accelerations": _named(found.pose_accelerations, place.axes),
            "joint_rates": _listed(found.joint_rates, place.joints),
            "joint_accelerations": _listed(found.joint_accelerations, place.joints),
            "twist": _twist(found.twist, "omega", "v"),
            "twist_rate": _twist(found.twist_rate, "alpha", "a"),
            "reasons": reasons,
            "warnings": warnings,
        }
    )


def _optional(option: str, text: str | None, axes: Sequence[Coordinate]) -> list[float] | None:
    return None if text is None else _inner(option, text, axes)


def _inner(option: str, text: str, axes: Sequence[Coordinate]) -> list[float]:
    """Rates or accelerations as typed, in mm and rad."""
    typed = common.open_numbers(option, text, axes)
    return [tables.inner(value, axis) for value, axis in zip(typed, axes, strict=True)]


def _numbers(found: Motion) -> list[float]:
    return [*found.pose_accelerations.tolist(), *found.joint_accelerations.tolist()]


def _judged(
    place: Place, posture: Posture, numbers: Sequence[float], *, serial: bool
) -> tuple[list[str], list[str]]:
    """Why some of the numbers do not exist, and what speaks against those that do.

    ``serial``: serial singularities leave them open, else all the other ones.
    """
    if not posture.closes:
        return [reason.text for reason in posture.reasons], []
    lost = place.machine.singularities.at(posture)
    if not all(map(isfinite, numbers)):
        return [each.text for each in lost] or ["The posture is singular to within rounding."], []
    return [], [
        f"the pose is a {each.kind} singularity to within {each.measure:.1g}, so that the last "
        "digits typed decide what is given here"
        for each in lost
        if (each.kind == "serial") == serial
    ]


def _warn(place: Place, warnings: Sequence[str]) -> None:
    common.warn(place.machine)
    for text in warnings:
        print(f"bohemia: warning: {text}", file=sys.stderr)


def _named(values: Array, axes: Sequence[Coordinate]) -> dict[str, float | None]:
    return dict(zip(map(tables.key, axes), _listed(values, axes), strict=True))


def _listed(values: Array, axes: Sequence[Coordinate]) -> list[float | None]:
    return [common.finite(value) for value in tables.outer(values.tolist(), axes)]


def _twist(values: Array, turning: str, moving: str) -> dict[str, list[float | None]]:
    return {
        f"{turning}_deg": [common.finite(degrees(v)) for v in values[:3].tolist()],
        moving: [common.finite(v) for v in values[3:].tolist()],
    }


def _motion_lines(place: Place, found: Motion, reasons: list[str]) -> list[str]:
    rows = []
    for axes, rates, second in (
        (place.axes, found.pose_rates, found.pose_accelerations),
        (place.joints, found.joint_rates, found.joint_accelerations),
    ):
        for axis, rate, acceleration in zip(
            axes,
            tables.outer(rates.tolist(), axes),
            tables.outer(second.tolist(), axes),
            strict=True,
        ):
            mark = "°" if axis.unit == "rad" else "mm"
            rows.append(
                (
                    f"{axis.symbol} ({mark})",
                    tables.number_text(rate),
                    tables.number_text(acceleration),
                )
            )
    turn, move = (found.twist[:3].tolist(), found.twist[3:].tolist())
    lines = [
        "",
        tables.table(("", "rate /s", "acceleration /s²"), rows),
        "",
        f"twist  ω = ({', '.join(tables.number_text(degrees(v)) for v in turn)}) °/s, "
        f"v = ({', '.join(tables.number_text(v) for v in move)}) mm/s",
    ]
    return [*lines, *reasons]


# --- statics -------------------------------------------------------------------------------


def _statics(arguments: argparse.Namespace) -> None:
    place = Place.of(arguments)
    load = load_numbers(arguments.load)
    found = place.machine.statics.forces(place.pose, place.mode, load)
    system = place.machine.statics.wrenches(place.pose, place.mode)
    forces = found.forces.tolist()
    posture = place.posture()
    reasons, warnings = _judged(place, posture, forces, serial=False)
    _warn(place, warnings)
    turning = {joint.limb: joint.unit == "rad" for joint in place.joints}
    units = [
        "N mm"
        if (turning.get(name.limb, False) if name.kind == "actuation" else not row[:3].any())
        else "N"
        for name, row in zip(found.names, system.rows, strict=True)
    ]
    if not arguments.json:
        place.head()
        rows = [
            (name.symbol, name.kind, tables.number_text(force), unit.replace(" ", "\u00b7"))
            for name, force, unit in zip(found.names, forces, units, strict=True)
        ]
        print("", tables.table(("wrench", "", "force", ""), rows), *reasons, sep="\n")
        return
    common.print_json(
        {
            **place.entries(),
            "load": {"force_N": load[:3], "moment_Nmm": load[3:]},
            "within_stroke": posture.reachable,
            "forces": [
                {
                    "symbol": name.symbol,
                    "kind": name.kind,
                    "limb": name.limb,
                    "value": common.finite(force),
                    "unit": unit,
                }
                for name, force, unit in zip(found.names, forces, units, strict=True)
            ],
            "residual": common.finite(float(found.residual)),
            "reasons": reasons,
            "warnings": warnings,
        }
    )


def load_numbers(text: str) -> list[float]:
    words = text.split(",")
    if len(words) != len(LOAD):
        raise InputError(
            f"--load needs 6 numbers with commas between them, {', '.join(LOAD)} "
            f"(N and N·mm); got {len(words)}"
        )
    return [common.number(w, f"--load: {name}") for w, name in zip(words, LOAD, strict=True)]
