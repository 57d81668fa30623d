"""Where a trajectory runs: named, straight, through points, from a file, drawn by hand."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from app.features.trajectory import state
from app.features.trajectory.compute import Moved
from app.features.trajectory.files import LARGEST, read_points
from app.features.trajectory.sketch import Sketch, sketch_figure, sketch_mark
from app.review.state import Review
from app.widgets.boxes import Typing, pose_box, poses_box, units
from app.widgets.desk import Client, Group, Sheet
from app.widgets.texts import box, esc
from kinematics.arrays import Array
from kinematics.errors import InputError

OWN_TITLES = {
    "Straight from pose to pose": state.STRAIGHT,
    "Through way points": state.POINTS,
    "Points from a CSV file": state.FILE,
    "Drawn with the mouse": state.STROKE,
}
THROUGH = {"Smooth curve": "spline", "Straight lines": "lines"}
ENDS = ("From here", "To here")
LIST = ("Add here", "Remove last", "Clear")
BY_ITS_LAW = {"law": "", "duration": 0.0}


class WayFolder(Group):
    """The choice of a way, and what each kind of it needs."""

    def build(self, review: Review) -> None:
        gui, desk = self.gui, self.desk
        self._axes = axes = review.machine.coordinates
        self._named = {each.name: each for each in review.machine.paths.named()}
        titles = {each.title: name for name, each in self._named.items()} | OWN_TITLES
        hint, symbols = units(axes), tuple(c.symbol for c in axes)
        with gui.add_folder("Path"):
            self.choice("It runs", titles, lambda r: r[state.Plan].way, _chosen)
            self._source = gui.add_html("")
            self._start = pose_box(desk, gui.add_text("From", "", hint=hint), axes, "From")
            self._end = pose_box(desk, gui.add_text("To", "", hint=hint), axes, "To")
            self._ends = gui.add_button_group("Take it", ENDS, hint="The machine's present pose")
            listed = gui.add_text("Way points", "", multiline=True, hint=f"One a line: {hint}")
            self._points = poses_box(desk, listed, axes, "Way point")
            self._list = gui.add_button_group("Present pose", LIST)
            # A button for uploads does not hide itself; what it stands in does.
            self._files = gui.add_folder("File", visible=False)
            with self._files:
                hint = "Its first line names the pose coordinates, and t if points have times"
                self.upload("Open a CSV file", ".csv,text/csv", self._open, hint)
            self._plane = [gui.add_dropdown(t, symbols) for t in ("To the right", "Upwards")]
            self._sketch = Sketch(desk, self._stroked)
            plan, step = state.Plan, state.step_plan
            self._smooth = self.number("Smoothing (mm)", plan, "smooth", step, min=0.0, step=0.5)
            self._through = self.menu("Joined by", THROUGH, plan, "through", step)
            look: dict[str, Any] = {"min": 0.0, "step": 1.0, "hint": "From this far on"}
            self._blend = self.number("Rounded corners (mm)", plan, "blend", step, **look)
            self._typing = Typing(desk)
        self._typed = {"start": self._start, "end": self._end, "points": self._points}
        for name, typed in self._typed.items():
            self._typing.watch(typed, partial(self._take, name))
        self.clicked(self._ends, self._take_end)
        self.clicked(self._list, self._edit_list)
        for menu in self._plane:
            self.answer(menu, self._turn)

    # --- what a person does

    def _take(self, name: str, value: Any, client: Client) -> None:
        self.desk.send(state.step_plan(name, value), client)

    def _take_end(self, client: Client) -> None:
        name = "start" if self._ends.value == ENDS[0] else "end"
        self.desk.send(state.set_plan(name, self.review.pose), client)

    def _edit_list(self, client: Client) -> None:
        pose, points = self.review.pose, self.review[state.Plan].points
        if self._list.value == LIST[0]:
            if points and points[-1] == pose:
                raise InputError("this pose is the last way point already; move the machine on")
            points = (*points, pose)
        else:
            points = points[:-1] if self._list.value == LIST[1] else ()
        self.desk.send(state.set_plan("points", points), client)

    def _open(self, file: Any, client: Client) -> None:
        if len(file.content) > LARGEST:
            raise InputError(f"{file.name}: longer than 16 MB, which no path is")
        try:
            text = file.content.decode("utf-8")
        except UnicodeDecodeError:
            raise InputError(
                f"{file.name}: not a text file in UTF-8, so not a list of points"
            ) from None
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
        chosen = tuple(keys[menu.value] for menu in self._plane)
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
        for name, typed in self._typed.items():
            self._typing.draw(typed, getattr(plan, name))
        for menu, n in zip(self._plane, state.plane_of(plan, self._axes), strict=True):
            self.put(menu, self._axes[n].symbol)
        way = plan.way
        joined = way == state.POINTS or (way == state.FILE and not plan.times)
        for seen, handles in (
            (way == state.STRAIGHT, (self._start.handle, self._end.handle, self._ends)),
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
            other = (
                f" Given for {review.machine.mode_noun} {esc(named.mode)}; it runs in the present "
                "one."
                if named.mode != review.mode
                else ""
            )
            return box(f"{esc(named.source)}.{other}") if named.source or other else ""
        if plan.way == state.FILE and plan.file:
            times = f", {plan.times[-1] - plan.times[0]:g} s" if plan.times else ""
            return box(f"<b>{esc(plan.file_name)}</b>: {len(plan.file)} points{times}")
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
