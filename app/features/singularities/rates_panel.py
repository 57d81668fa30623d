"""Velocity and acceleration in the Singularities tab: typed for the pose, told of the actuators."""

from __future__ import annotations

import numpy as np
import viser

from app.features.singularities.state import Control, SetControl
from app.review.units import from_page_units, in_page_units, page_unit
from app.scene import palette
from app.widgets.desk import Controlled, Desk, Sheet, answer, box, chip, esc, put, put_prop
from kinematics.answers.motion import Motion
from kinematics.errors import InputError
from kinematics.mechanism import Coordinate


class MotionFolder:
    """Rates and accelerations of the pose coordinates, and what they ask of the actuators."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._axes = review.machine.coordinates
        self._asked: tuple[float, ...] = review[Control].rates
        self._joints = review.machine.joints
        units = ", ".join(f"{c.symbol} ({page_unit(c)}/s)" for c in self._axes)
        with gui.add_folder("Velocity and acceleration", expand_by_default=False):
            self._rates = gui.add_text(
                "Rates", _shown(self._axes, review[Control].rates), hint=f"{units}, with commas"
            )
            answer(desk, self._rates, lambda text, client: self._set("rates", text, client))
            self._accelerations = gui.add_text(
                "Accelerations",
                _shown(self._axes, review[Control].accelerations),
                hint="Likewise, by s²; empty for none",
            )
            answer(
                desk,
                self._accelerations,
                lambda text, client: self._set("accelerations", text, client),
            )
            self._told = gui.add_html("")

    def draw(self, sheet: Sheet) -> None:
        control = sheet.view.review[Control]
        self._asked = control.rates
        for handle, values in (
            (self._rates, control.rates),
            (self._accelerations, control.accelerations),
        ):
            if _read(self._axes, handle.value) != values:
                put(self._desk, handle, _shown(self._axes, values))

    def draw_control(self, controlled: Controlled) -> None:
        motion = None if controlled.here is None else controlled.here.motion
        told = "" if motion is None else _html(self._joints, motion) + self._followed(motion)
        put_prop(self._told, "content", told)

    def _followed(self, motion: Motion) -> str:
        """Which rate is not the one that was typed, as it follows from the others."""
        rates = np.asarray(motion.pose_rates)
        texts = [
            f"{c.symbol} follows: {_number(in_page_units(c, float(v)))} {page_unit(c)}/s"
            for c, v, typed in zip(self._axes, rates, self._asked, strict=False)
            if abs(float(v) - typed) > 1e-9 * max(1.0, abs(typed))
        ]
        return box(f'<span style="opacity:.75">{esc("; ".join(texts))}</span>') if texts else ""

    def _set(self, name: str, text: str, client: viser.ClientHandle | None) -> None:
        values = _read(self._axes, text)
        if values is None:
            raise InputError(f"{name} are {len(self._axes)} numbers with commas between them")
        self._desk.send(SetControl(name, values), client)


def _read(axes: tuple[Coordinate, ...], text: str) -> tuple[float, ...] | None:
    words = [word for word in text.replace(";", ",").split(",") if word.strip()]
    if not words:
        return ()
    try:
        values = [float(word.replace("−", "-")) for word in words]
    except ValueError:
        return None
    if len(values) != len(axes):
        return None
    return tuple(from_page_units(c, v) for c, v in zip(axes, values, strict=True))


def _shown(axes: tuple[Coordinate, ...], values: tuple[float, ...]) -> str:
    if not values:
        return ""
    return ", ".join(f"{in_page_units(c, v):.6g}" for c, v in zip(axes, values, strict=True))


def _html(joints: tuple[Coordinate, ...], motion: Motion) -> str:
    rates, accelerations = np.asarray(motion.joint_rates), np.asarray(motion.joint_accelerations)
    rows = "".join(
        f"<tr><td>{chip(palette.limb_color(c.limb or n + 1))}{esc(c.symbol)}</td>"
        f"<td {_RIGHT}>{_number(in_page_units(c, float(v)))} {page_unit(c)}/s</td>"
        f"<td {_RIGHT}>{_number(in_page_units(c, float(a)))} {page_unit(c)}/s²</td></tr>"
        for n, (c, v, a) in enumerate(zip(joints, rates, accelerations, strict=True))
    )
    speed, gain = (np.asarray(t) for t in (motion.twist, motion.twist_rate))
    of_o = (
        f"<tr><td>{chip(palette.VELOCITY)}O′</td>"
        f"<td {_RIGHT}>{_number(float(np.linalg.norm(speed[3:])))} mm/s</td>"
        f"<td {_RIGHT}>{_number(float(np.linalg.norm(gain[3:])))} mm/s²</td></tr>"
    )
    return box(f'<table style="width:100%">{rows}{of_o}</table>')


_RIGHT = 'style="text-align:right;font-variant-numeric:tabular-nums"'


def _number(value: float) -> str:
    return "none" if not np.isfinite(value) else f"{value:.4g}".replace("-", "−")
