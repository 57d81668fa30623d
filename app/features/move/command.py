"""`bohemia velocity` and `bohemia statics`: how the platform is moved and held at a pose."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import degrees, isfinite
from typing import TYPE_CHECKING, Any

from app.terminal import tables, values
from app.terminal.command import Answer, command
from app.terminal.options import DESIGN, MODE, POSE, option
from kinematics.errors import InputError

if TYPE_CHECKING:
    from app.terminal.poses import Given, Place
    from kinematics.answers.motion import WrenchSystem
    from kinematics.arrays import Array
    from kinematics.machine import Machine

Numbers = list[float] | None


@command("velocity")
def velocity(
    machine: Machine[Any] = DESIGN,
    pose: Given = POSE,
    mode: str = MODE,
    rates: Numbers = option(
        "v1,v2,...",
        "d(pose)/dt, /s, - for one that the constraint gives; joint rates are computed",
        values.of_pose,
    ),
    joint_rates: Numbers = option(
        "v1,v2,...", "actuator rates, /s; the platform's are computed", values.of_joints
    ),
    accelerations: Numbers = option(
        "a1,a2,...", "goes with --rates, /s² (default 0)", values.of_pose
    ),
    joint_accelerations: Numbers = option(
        "a1,a2,...", "goes with --joint-rates, /s² (default 0)", values.of_joints
    ),
) -> Answer:
    """Rates and accelerations, either way round.

    The twist is the platform's angular velocity and the velocity of its origin, base frame. JSON
    has null where a rate does not exist or is not determined, and says why in reasons; next to a
    singularity numbers come with a warning. rates, accelerations, joint_rates and
    joint_accelerations are a second or second squared of what is typed; pose_rates, actuator_rates
    and their like name the whole unit.
    """
    if (rates is None) == (joint_rates is None):
        raise InputError("give either --rates or --joint-rates (see bohemia velocity --help)")
    if (joint_accelerations if joint_rates is None else accelerations) is not None:
        raise InputError(
            "--accelerations goes with --rates, --joint-accelerations with --joint-rates"
        )
    place, axes, joints = pose.place(mode), machine.coordinates, machine.joints
    turned, ask = (axes, machine.motion.inverse) if rates else (joints, machine.motion.forward)
    first = tables.inner(rates or joint_rates or [], turned)
    second = accelerations or joint_accelerations
    found = ask(place.pose, mode, first, second and tables.inner(second, turned))
    moved = (found.pose_rates, found.pose_accelerations)
    driven = (found.joint_rates, found.joint_accelerations)
    numbers = [*moved[1].tolist(), *driven[1].tolist()]
    reasons, warnings = _judged(place, numbers, serial=bool(rates))
    data = {
        **place.entries,
        "joints": tables.listed(place.posture.joints, joints),
        "within_stroke": place.posture.reachable,
        "twist": _twist(found.twist, "omega", "v", "s"),
        "twist_rate": _twist(found.twist_rate, "alpha", "a", "s2"),
        "reasons": reasons,
        "warnings": warnings,
    }
    rows: list[tuple[str, ...]] = []
    for per, what in enumerate(("rates", "accelerations"), start=1):
        data |= {
            what: tables.named(moved[per - 1], axes),
            f"joint_{what}": tables.listed(driven[per - 1], joints),
            f"pose_{what}": tables.named(moved[per - 1], axes, per),
            f"actuator_{what}": tables.named(driven[per - 1], joints, per),
        }
    for own, both in ((axes, moved), (joints, driven)):
        shown = (map(tables.number_text, tables.listed(each, own)) for each in both)
        rows += zip(tables.headings(own, "°"), *shown, strict=True)
    turn = ", ".join(map(tables.number_text, data["twist"]["omega_deg"]))
    move = ", ".join(map(tables.number_text, data["twist"]["v"]))
    table = tables.table(("", "rate /s", "acceleration /s²"), rows)
    twist = f"twist  ω = ({turn}) °/s, v = ({move}) mm/s"
    return Answer(
        data, [*_head(place, reasons), *(["", table, "", twist] if _any(numbers) else [])]
    )


def _judged(place: Place, numbers: Iterable[float], *, serial: bool) -> tuple[list[str], list[str]]:
    """Why some of the numbers do not exist, and what speaks against those that do.

    ``serial``: serial singularities leave them open, else all the other ones.
    """
    posture = place.posture
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


def _head(place: Place, reasons: Sequence[str]) -> list[str]:
    """The pose, and before any number what is wrong with it."""
    posture = place.posture
    beyond = [] if posture.reachable else [reason.text for reason in posture.reasons]
    told = [
        *(["Not reachable:"] if beyond else []),
        *(f"  {text}" for text in beyond),
        *(r for r in reasons if r not in beyond),
    ]
    return [place.where, *([""] if told else []), *told]


def _any(numbers: Iterable[float]) -> bool:
    return any(map(isfinite, numbers))


def _twist(twist: Array, turning: str, moving: str, per: str) -> dict[str, list[float | None]]:
    """Angular and linear; the keys without a time came first and are kept."""
    turn, move = tables.plain(twist[:3], degrees(1.0)), tables.plain(twist[3:])
    whole = {f"{turning}_deg_per_{per}": turn, f"{moving}_mm_per_{per}": move}
    return {**whole, f"{turning}_deg": turn, moving: move}


@command("statics")
def statics(
    machine: Machine[Any] = DESIGN,
    pose: Given = POSE,
    mode: str = MODE,
    load: list[float] = option(
        "Fx,Fy,Fz,Tx,Ty,Tz",
        "force (N) and moment (N·mm) on the platform at its origin, base frame",
        values.load,
        required=True,
    ),
) -> Answer:
    """Actuator forces and constraint wrenches for a load.

    A positive actuator force pushes the platform; a rotary one acts along +q. In JSON each wrench
    has its direction and, unless it is a couple, a point of its line, mm, base frame.
    """
    place = pose.place(mode)
    found = machine.statics.forces(place.pose, mode, load)
    reasons, warnings = _judged(place, found.forces.tolist(), serial=False)
    system = machine.statics.wrenches(place.pose, mode)
    forces = [
        {**wrench, "value": force, "force_N" if wrench["unit"] == "N" else "torque_Nmm": force}
        for wrench, force in zip(
            wrench_entries(machine, system), tables.plain(found.forces), strict=True
        )
    ]
    data = {
        **place.entries,
        "load": {"force_N": load[:3], "moment_Nmm": load[3:]},
        "within_stroke": place.posture.reachable,
        "forces": forces,
        "residual": tables.finite(float(found.residual)),
        "reasons": reasons,
        "warnings": warnings,
    }
    unit = ("", "unit", {"N": "N", "N mm": "N·mm"})
    columns = (("wrench", "symbol"), ("", "kind"), ("force", "value"), unit)
    known = ["", tables.records(forces, *columns)] if _any(found.forces.tolist()) else []
    return Answer(data, [*_head(place, reasons), *known])


def wrench_entries(machine: Machine[Any], system: WrenchSystem) -> list[dict[str, Any]]:
    """What each wrench of a system is: the unit of its size, and its line, base frame: direction
    and point (..., 3), mm; a couple has none."""
    import numpy as np

    turning = {joint.limb for joint in machine.joints if joint.unit == "rad"}
    entries = []
    for n, name in enumerate(system.names):
        force, moment = system.rows[..., n, :3], system.rows[..., n, 3:]
        couple = not force.any()
        along = moment if couple else force
        size = np.linalg.norm(along, axis=-1, keepdims=True)
        torque = name.limb in turning if name.kind == "actuation" else couple
        entries.append(
            {
                **tables.record(name, "symbol", "kind", "limb"),
                "unit": "N mm" if torque else "N",
                "direction": tables.plain(along / np.where(size > 0.0, size, np.nan)),
                "point_mm": None if couple else tables.plain(system.point[..., n, :]),
            }
        )
    return entries
