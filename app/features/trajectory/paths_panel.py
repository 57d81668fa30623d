"""Where a trajectory runs: named, straight, through points, from a file, drawn by hand."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from app.features.trajectory import state
from app.features.trajectory.compute import Moved
from app.features.trajectory.files import LARGEST, read_points
from app.features.trajectory.html import ends_html
from app.features.trajectory.sketch import Sketch, sketch_figure, sketch_mark
from app.language import menu, tr
from app.review.state import Review
from app.review.view import mode_noun
from app.widgets.boxes import Typing, poses_box, typed_pose, units
from app.widgets.desk import Client, Group, Sheet
from app.widgets.markup import Markup
from app.widgets.texts import box, esc
from kinematics.arrays import Array
from kinematics.errors import InputError

BY_ITS_LAW = {"law": "", "duration": 0.0}
_ENDS = {"start": "from", "end": "to"}


class WayFolder(Group):
    """The choice of a way, and what each kind of it needs."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        self._axes = axes = review.machine.coordinates
        self._named = {each.name: each for each in review.machine.paths.named()}
        titles = {each.title: name for name, each in self._named.items()}
        titles |= menu("trajectory.ways")
        hint, symbols = units(axes), tuple(c.symbol for c in axes)
        with gui.add_folder(tr("trajectory.path")):
            self.choice("trajectory.way", titles, lambda r: r[state.Plan].way, _chosen)
            self._source = gui.add_html("")
            self._ends = Markup(desk, self._end)
            self._edits = menu("trajectory.edits")
            listed = gui.add_text(
                tr("trajectory.points"),
                "",
                multiline=True,
                hint=tr("trajectory.points_hint", units=hint),
            )
            self._points = poses_box(desk, listed, axes, tr("trajectory.point"))
            self._list = gui.add_button_group(tr("trajectory.edit"), tuple(self._edits))
            # A button for uploads does not hide itself; what it stands in does.
            self._files = gui.add_folder(tr("trajectory.file"), visible=False)
            with self._files:
                self.upload("trajectory.open", ".csv,text/csv", self._open)
            self._plane = [
                gui.add_dropdown(label, symbols)
                for label in (tr("trajectory.rightwards"), tr("trajectory.upwards"))
            ]
            self._sketch = Sketch(desk, self._stroked)
            plan, step = state.Plan, state.step_plan
            self._smooth = self.number("trajectory.smooth", plan, "smooth", step, min=0.0, step=0.5)
            self._through = self.menu(
                "trajectory.joined", menu("trajectory.through"), plan, "through", step
            )
            self._blend = self.number("trajectory.blend", plan, "blend", step, min=0.0, step=1.0)
            self._typing = Typing(desk)
        self._typing.watch(self._points, self._take_points)
        self.clicked(self._list, self._edit_list)
        for axis in self._plane:
            self.answer(axis, self._turn)

    # --- what a person does

    def _take_points(self, value: Any, client: Client) -> None:
        self.desk.send(state.step_plan("points", value), client)

    def _end(self, pressed: str, client: Client) -> None:
        """An end of the straight way is the present pose, has another number, or is a line."""
        end, _, typed = pressed.partition(" ")
        name, _, number = end.partition(".")
        pose: state.Pose = self.review.pose
        if number == "line":
            pose = typed_pose(typed, self._axes, tr(f"trajectory.{_ENDS[name]}"))
        elif typed:
            n, known = int(number), getattr(self.review[state.Plan], name) or pose
            pose = (*known[:n], self._axes[n].inner(float(typed)), *known[n + 1 :])
        self.desk.send(state.set_plan(name, pose), client)

    def _edit_list(self, client: Client) -> None:
        pose, points = self.review.pose, self.review[state.Plan].points
        edit = self._edits[self._list.value]
        if edit == "add":
            if points and points[-1] == pose:
                raise InputError(tr("trajectory.same_point"))
            points = (*points, pose)
        else:
            points = points[:-1] if edit == "remove" else ()
        self.desk.send(state.set_plan("points", points), client)

    def _open(self, file: Any, client: Client) -> None:
        if len(file.content) > LARGEST:
            raise InputError(tr("trajectory.too_large", file=file.name))
        try:
            text = file.content.decode("utf-8")
        except UnicodeDecodeError:
            raise InputError(tr("trajectory.not_text", file=file.name)) from None
        machine, mode = self.review.machine, self.review.mode
        points = read_points(text, self._axes, origin=file.name, dependent=machine.dependent)
        poses, left = points.poses, points.dependent
        if left is not None:
            poses = tuple(machine.complete_pose(pose, mode) for pose in poses)
        values: dict[str, Any] = {
            "way": state.FILE,
            "file": poses,
            "file_name": file.name[:200],
            "times": points.times or (),
            "file_open": "" if left is None else self._axes[left].key,
        }
        if points.times:
            values |= BY_ITS_LAW
        self.desk.send(state.SetPlan(tuple(values.items())), client)

    def _turn(self, _: str, client: Client) -> None:
        """Choose the plane of a stroke; of two equal coordinates the other gives way."""
        keys = {c.symbol: c.key for c in self._axes}
        chosen = tuple(keys[axis.value] for axis in self._plane)
        if chosen[0] == chosen[1]:
            first, second = state.plane_of(self.review[state.Plan], self._axes)
            chosen = self._axes[second].key, self._axes[first].key
        self.desk.send(state.set_plan("plane", chosen), client)

    def _stroked(self, stroke: Array, client: Client) -> None:
        poses = np.tile(np.asarray(self.review.pose), (len(stroke), 1))
        for n, values in zip(
            state.plane_of(self.review[state.Plan], self._axes), stroke.T, strict=True
        ):
            poses[:, n] = [self._axes[n].inner(v) for v in values.tolist()]
        made: list[state.Pose] = [tuple(pose) for pose in poses.tolist()]
        self.desk.send(state.set_plan("stroke", state.trimmed(made)), client)

    # --- what is drawn

    def draw(self, sheet: Sheet) -> None:
        super().draw(sheet)
        plan = self.review[state.Plan]
        self._typing.draw(self._points, plan.points)
        ends = (("start", plan.start), ("end", plan.end))
        straight = plan.way == state.STRAIGHT
        self._ends.say(ends_html(ends, self._axes) if straight else "")
        for axis, n in zip(self._plane, state.plane_of(plan, self._axes), strict=True):
            self.put(axis, self._axes[n].symbol)
        way = plan.way
        joined = way == state.POINTS or (way == state.FILE and not plan.times)
        for seen, handles in (
            (way == state.POINTS, (self._points.handle, self._list)),
            (way == state.FILE, (self._files,)),
            (way == state.STROKE and len(self._axes) > 2, self._plane),
            (way == state.STROKE, (self._smooth,)),
            (joined, (self._through,)),
            (joined and plan.through == "lines", (self._blend,)),
        ):
            self.see(seen, *handles)
        self.say(self._source, self._said())

    def _said(self) -> str:
        review = self.review
        plan, named = review[state.Plan], self._named.get(review[state.Plan].way)
        if named is not None:
            other, mode = "", f"{mode_noun(review.machine)} {named.mode}"
            if named.mode != review.mode:
                other = " " + esc(tr("trajectory.other_mode", mode=mode))
            return box(f"{esc(named.source)}.{other}") if named.source or other else ""
        if plan.way == state.FILE and plan.file:
            times = f", {plan.times[-1] - plan.times[0]:g} s" if plan.times else ""
            points = tr("trajectory.read", n=len(plan.file))
            return box(f"<b>{esc(plan.file_name)}</b>: {points}{times}")
        return ""

    def told(self, sheet: Sheet, news: Any) -> None:
        """The plane of a stroke, with what was drawn in it."""
        if not isinstance(news, Moved):
            return
        plan, reach = self.review[state.Plan], news.reach
        if plan.way != state.STROKE or reach is None:
            self._sketch.draw(None)
            return
        axes = [self._axes[n] for n in reach.plane]
        self._sketch.draw(reach, partial(sketch_figure, axes, reach))
        path = np.empty((0, len(self._axes)))
        if plan.stroke:
            path = np.array(plan.stroke)
            if news.computed is not None and not news.stale:
                path = news.computed.found.poses
        here = [self.review.pose[n] for n in reach.plane]
        drawn = path[:, list(reach.plane)]
        self._sketch.mark(lambda figure: sketch_mark(axes, figure.axes, drawn, here))


def _chosen(way: str) -> state.SetPlan:
    """Another way; one with a law of its own runs by that, until another is chosen."""
    return state.SetPlan(tuple(({"way": way} | ({} if way in state.OWN else BY_ITS_LAW)).items()))
