"""Where a trajectory runs: named, straight, through points, from a file, drawn by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from app.features.trajectory.files import LARGEST, read_points
from app.features.trajectory.state import (
    FILE,
    OWN,
    POINTS,
    STRAIGHT,
    STROKE,
    Plan,
    Pose,
    SetPlan,
    plane_of,
    trimmed,
)
from app.widgets.desk import (
    QUIET,
    Desk,
    Moved,
    Sheet,
    answer,
    box,
    clicked,
    esc,
    put,
    put_prop,
    red,
    safely,
)
from app.widgets.pose_boxes import PoseBox, PosesBox, units
from app.widgets.sketch import Sketch, sketch_figure, sketch_mark
from kinematics.arrays import Array
from kinematics.errors import InputError

OWN_TITLES = {
    STRAIGHT: "Straight from pose to pose",
    POINTS: "Through way points",
    FILE: "Points from a CSV file",
    STROKE: "Drawn with the mouse",
}
THROUGH = {"Smooth curve": "spline", "Straight lines": "lines"}
ENDS = ("From here", "To here")
LIST = ("Add here", "Remove last", "Clear")


class WayFolder:
    """The choice of a way, and what each kind of it needs."""

    def __init__(self, desk: Desk, sheet: Sheet) -> None:
        gui, review = desk.gui, sheet.view.review
        self._desk = desk
        self._sheet = sheet
        self._axes = axes = review.machine.coordinates
        named = review.machine.paths.named()
        self._named = {each.name: each for each in named}
        self._titles = {**{t.title: name for name, t in self._named.items()}} | {
            title: way for way, title in OWN_TITLES.items()
        }
        plan, hint = review[Plan], units(axes)
        with gui.add_folder("Path"):
            self._way = gui.add_dropdown(
                "It runs", tuple(self._titles), initial_value=self._title(plan.way)
            )
            answer(desk, self._way, self._choose)
            self._source = gui.add_html("")
            self._start = PoseBox(desk, gui.add_text("From", "", hint=hint), axes, "From")
            self._end = PoseBox(desk, gui.add_text("To", "", hint=hint), axes, "To")
            self._ends = gui.add_button_group("Take it", ENDS, hint="The machine's present pose")
            listed = gui.add_text("Way points", "", multiline=True, hint=f"One a line: {hint}")
            self._points = PosesBox(desk, listed, axes, "Way point")
            self._list = gui.add_button_group("Present pose", LIST)
            # A button for uploads does not hide itself; what it stands in does.
            self._files = gui.add_folder("File", visible=False)
            with self._files:
                self._file = gui.add_upload_button(
                    "Open a CSV file",
                    mime_type=".csv,text/csv",
                    color=QUIET,
                    icon=viser.Icon.UPLOAD,
                    hint="Its first line names the pose coordinates, and t if points have times",
                )
            self._file.on_upload(self._uploaded)
            symbols = tuple(c.symbol for c in axes)
            self._across = gui.add_dropdown("To the right", symbols)
            self._up = gui.add_dropdown("Upwards", symbols)
            self._sketch = Sketch(desk, self._stroked)
            self._smooth = gui.add_number("Smoothing (mm)", plan.smooth, min=0.0, step=0.5)
            self._through = gui.add_dropdown("Joined by", tuple(THROUGH))
            self._blend = gui.add_number(
                "Rounded corners (mm)", plan.blend, min=0.0, step=1.0, hint="From this far on"
            )
            self._wrong = gui.add_html("")
        for typed, name in ((self._start, "start"), (self._end, "end"), (self._points, "points")):
            answer(desk, typed.handle, self._typing(typed, name))
        clicked(desk, self._ends, self._take_end)
        clicked(desk, self._list, self._edit_list)
        for plane in (self._across, self._up):
            answer(desk, plane, self._turn)
        answer(desk, self._smooth, lambda v, client: self._set(client, smooth=float(v)))
        answer(desk, self._blend, lambda v, client: self._set(client, blend=float(v)))
        answer(desk, self._through, lambda v, client: self._set(client, through=THROUGH[v]))
        self._sketched: object = None
        self._trouble = ""

    def _title(self, way: str) -> str:
        return next(title for title, known in self._titles.items() if known == way)

    def _set(self, client: viser.ClientHandle | None, **values: Any) -> None:
        self._desk.send(SetPlan(tuple(values.items()), gesture=f"plan {[*values]}"), client)

    def _do(self, client: viser.ClientHandle | None, **values: Any) -> None:
        """A step of its own for undo."""
        self._desk.send(SetPlan(tuple(values.items())), client)

    # --- what a person does

    def _choose(self, title: str, client: viser.ClientHandle | None) -> None:
        way = self._titles[title]
        # A way with a law of its own runs by that one, until another is chosen.
        own = {} if way in OWN else {"law": "", "duration": 0.0}
        self._do(client, way=way, **own)

    def _typing(self, typed: PoseBox | PosesBox, name: str) -> Any:
        """Take what is typed as soon as it can be used; until then say what is wrong with it."""

        def changed(_: str, client: viser.ClientHandle | None) -> None:
            try:
                value = typed.read()
            except InputError as error:
                self._trouble = str(error)
            else:
                self._trouble = ""
                self._set(client, **{name: value})
            put_prop(self._wrong, "content", red(self._trouble) if self._trouble else "")

        return changed

    def _take_end(self, client: viser.ClientHandle | None) -> None:
        pose = self._sheet.view.review.pose
        self._do(client, **{"start" if self._ends.value == ENDS[0] else "end": pose})

    def _edit_list(self, client: viser.ClientHandle | None) -> None:
        review = self._sheet.view.review
        points = review[Plan].points
        if self._list.value == LIST[0]:
            if points and points[-1] == review.pose:
                raise InputError("this pose is the last way point already; move the machine on")
            points = (*points, review.pose)
        else:
            points = points[:-1] if self._list.value == LIST[1] else ()
        self._do(client, points=points)

    async def _uploaded(self, event: viser.GuiEvent[Any]) -> None:
        file = event.target.value

        def take() -> None:
            if len(file.content) > LARGEST:
                raise InputError(f"{file.name}: longer than 16 MB, which no path is")
            try:
                text = file.content.decode("utf-8")
            except UnicodeDecodeError:
                raise InputError(
                    f"{file.name}: not a text file in UTF-8, so not a list of points"
                ) from None
            review = self._sheet.view.review
            machine = review.machine
            points = read_points(
                text,
                self._axes,
                origin=file.name,
                dependent=machine.dependent,
            )
            poses, left = points.poses, points.dependent
            if left is not None:
                poses = tuple(machine.complete_pose(pose, review.mode) for pose in poses)
            self._do(
                event.client,
                way=FILE,
                file=poses,
                file_name=file.name[:200],
                times=points.times or (),
                **({"law": "", "duration": 0.0} if points.times else {}),
                file_open="" if left is None else self._axes[left].key,
            )

        safely(self._desk, event.client, take)

    def _turn(self, _: str, client: viser.ClientHandle | None) -> None:
        """Choose the plane of a stroke; of two equal coordinates the other gives way."""
        keys = {c.symbol: c.key for c in self._axes}
        chosen = keys[self._across.value], keys[self._up.value]
        if chosen[0] == chosen[1]:
            plan = self._sheet.view.review[Plan]
            before = [self._axes[n].key for n in plane_of(plan, self._axes)]
            chosen = (before[1], before[0])
        self._do(client, plane=chosen)

    def _stroked(self, stroke: Array, client: viser.ClientHandle | None) -> None:
        review = self._sheet.view.review
        plane = plane_of(review[Plan], self._axes)
        poses = np.tile(np.asarray(review.pose), (len(stroke), 1))
        for n, values in zip(plane, stroke.T, strict=True):
            turn = np.pi / 180.0 if self._axes[n].unit == "rad" else 1.0
            poses[:, n] = values * turn
        made: list[Pose] = [tuple(pose) for pose in poses.tolist()]
        self._do(client, stroke=trimmed(made))

    # --- what is drawn

    def draw(self, sheet: Sheet) -> None:
        """Bring the widgets to the review."""
        self._sheet = sheet
        desk, plan = self._desk, sheet.view.review[Plan]
        put(desk, self._way, self._title(plan.way))
        if not self._trouble:  # what is being typed stays until it can be used
            self._start.draw(plan.start)
            self._end.draw(plan.end)
            self._points.draw(plan.points)
        first, second = plane_of(plan, self._axes)
        put(desk, self._across, self._axes[first].symbol)
        put(desk, self._up, self._axes[second].symbol)
        put(desk, self._smooth, plan.smooth)
        put(desk, self._blend, plan.blend)
        put(desk, self._through, next(t for t, way in THROUGH.items() if way == plan.through))
        way = plan.way
        joined = way == POINTS or (way == FILE and not plan.times)
        for handle, seen in (
            (self._start.handle, way == STRAIGHT),
            (self._end.handle, way == STRAIGHT),
            (self._ends, way == STRAIGHT),
            (self._points.handle, way == POINTS),
            (self._list, way == POINTS),
            (self._files, way == FILE),
            (self._across, way == STROKE and len(self._axes) > 2),
            (self._up, way == STROKE and len(self._axes) > 2),
            (self._smooth, way == STROKE),
            (self._through, joined),
            (self._blend, joined and plan.through == "lines"),
        ):
            put_prop(handle, "visible", seen)
        put_prop(self._source, "content", self._said())
        if way != STROKE:
            self._sketched = None
            self._sketch.draw(None)
            self._sketch.mark("")

    def _said(self) -> str:
        plan = self._sheet.view.review[Plan]
        named = self._named.get(plan.way)
        if named is not None:
            mode = self._sheet.view.review.mode
            other = (
                f" Given for {self._sheet.view.review.machine.mode_noun} {esc(named.mode)}; "
                "it runs in the present one."
                if named.mode != mode
                else ""
            )
            return box(f"{esc(named.source)}.{other}") if named.source or other else ""
        if plan.way == FILE and plan.file:
            times = f", {plan.times[-1] - plan.times[0]:g} s" if plan.times else ""
            return box(f"<b>{esc(plan.file_name)}</b>: {len(plan.file)} points{times}")
        return ""

    def draw_trajectory(self, moved: Moved) -> None:
        """The plane of a stroke, with what was drawn in it."""
        review = self._sheet.view.review
        plan, reach = review[Plan], moved.reach
        if plan.way != STROKE or reach is None:
            return
        axes = [self._axes[n] for n in reach.plane]
        if self._sketched is not reach:
            self._sketched = reach
            self._sketch.draw(sketch_figure(axes, reach))
        figure = self._sketch.figure
        assert figure is not None
        path = np.empty((0, len(self._axes)))
        if plan.stroke:
            path = np.array(plan.stroke)
            if moved.computed is not None and not moved.stale:
                path = moved.computed.found.poses
        here = [review.pose[n] for n in reach.plane]
        self._sketch.mark(sketch_mark(axes, figure.axes, path[:, list(reach.plane)], here))
