"""A machine: one design bound to its mechanism, with everything that can be asked of it.

`Machine` is what people hold. What it can answer stands in its facets, one a topic; a facet that a
machine has not is None.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from importlib import import_module
from math import nan
from os import PathLike
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from kinematics.answers.coordinates import Pose
from kinematics.answers.modes import matching
from kinematics.answers.solutions import Followed, Posture
from kinematics.arrays import Array, finite, number, read_only
from kinematics.errors import InputError
from kinematics.facets.facet import required
from kinematics.facets.faceted import Faceted
from kinematics.mechanism import D, Design, DesignField

if TYPE_CHECKING:  # loaded when they are asked for
    from kinematics.answers.trajectories import Limits, Path, Trajectory
    from kinematics.facets.comparison import Comparison
    from kinematics.facets.configurations import Configuration
    from kinematics.facets.spaces import Space

__all__ = ["Machine", "machine_of", "required", "spaces"]


class Machine(Faceted[D]):
    """One design of one mechanism.

    Attributes:
        design: the design, frozen.
        mechanism: the primitives of its kind.
        inverse, forward, following, motion, statics, measures, singularities, clearances, paths:
            facets that every machine has.
        solids, sections, regions, maps, circles: facets that a machine may lack; None then.

    Example:
        >>> import kinematics as kin
        >>> machine = kin.open("five-bar")
        >>> machine
        <Five-bar (planar 5R) five-bar: x, y by θ₁, θ₂>
        >>> machine.inverse([0, 700]).joints.shape  # in each of the four working modes
        (4, 2)
        >>> machine.sections is None
        True
    """

    def __repr__(self) -> str:
        name = f" {self.design.name}" if self.design.name else ""
        moved = ", ".join(axis.symbol for axis in self.coordinates)
        return f"<{self.title}{name}: {moved} by {', '.join(a.symbol for a in self.joints)}>"

    # --- its design

    @property
    def table(self) -> dict[str, Any]:
        """What the design's file says, as plain values."""
        return self.mechanism.design_table()

    @property
    def fields(self) -> tuple[DesignField, ...]:
        """Every number of the design that may be edited."""
        return self.mechanism.design_fields()

    def edited(self, path: str | Sequence[str | int], value: float) -> Machine[D]:
        """The machine with one number changed and everything checked again.

        Args:
            path: a `DesignField.path`, as ``("limb", 2, "base", 0)``, or the same with dots:
                ``"limb.2.base.0"``. As in Python the third limb is 2.
            value: in the field's unit, mm or rad.

        Raises:
            InputError: the design has no such number.
            DesignError: the design would not be valid with it.

        Example:
            >>> import kinematics as kin
            >>> machine = kin.open("rpur-table1")
            >>> longer = machine.edited("limb.2.link", 170.0)
            >>> machine.design.limbs[2].link, longer.design.limbs[2].link
            (150.0, 170.0)
        """
        given: Any = value  # what is infinite is told with its label
        value = given if isinstance(given, int | float) else number(given, "the new value")
        if isinstance(path, str):
            path = tuple(int(step) if step.isdigit() else step for step in path.split("."))
        return Machine(self.mechanism.edited(path, value))

    # --- poses

    def pose(self, mode: str | None = None, **named: float | None) -> Pose:
        """A pose by its coordinates' names, mm and rad; what is not named is home's.

        An angle may be given in degrees by the name that it has in files, as ``phi_deg=5``. Where a
        machine has a coordinate that follows from the others, one that is None, or else one that is
        not named, is made to follow, in a mode (None: home's).

        Raises:
            InputError: there is no such coordinate, or no such pose.

        Example:
            >>> import kinematics as kin
            >>> kin.open("rpur-table1").pose(x=90, y=110, z=430, phi_deg=5, theta=0)
            Pose(x = 90 mm, y = 110 mm, z = 430 mm, φ = 5°, θ = 0°)
        """
        axes, given = self.coordinates, self._named(named, number)
        start = self.home.pose if len(given) < len(axes) else (0.0,) * len(axes)
        values = [float(given.get(n, v)) for n, v in enumerate(start)]
        free = [n for n, value in enumerate(values) if value != value]
        for n in free if free else [n for n in self.dependent if n not in given]:
            if len(given) == len(free):
                break  # home itself
            try:
                open_one = [nan if k == n else v for k, v in enumerate(values)]
                return Pose(self.complete_pose(open_one, mode or self.home.mode), axes)
            except InputError:
                if free:
                    raise
        return Pose(values, axes)

    def poses(self, values: ArrayLike | None = None, **named: ArrayLike) -> Array:
        """A batch of poses (..., P), mm and rad: an array as it is, or arrays by name.

        Arrays by name broadcast with each other; what is not named is home's.

        Raises:
            InputError: not finite numbers, not P of them, or no such coordinate.

        Example:
            >>> import kinematics as kin, numpy as np
            >>> kin.open("rpur-table1").poses(x=np.linspace(0, 100, 11), phi=0.1).shape
            (11, 5)
        """
        if values is not None:
            return read_only(finite(values, name="a pose", last=len(self.coordinates)))
        given = self._named(named, lambda value, key: finite(value, name=key))
        parts = [np.asarray(given.get(n, v)) for n, v in enumerate(self.home.pose)]
        made = np.stack(np.broadcast_arrays(*parts), axis=-1)
        return read_only(finite(made, name="a pose"))

    def at(
        self, pose: Sequence[float] | Posture | None = None, mode: str | None = None
    ) -> Configuration[D]:
        """The machine at a pose in a mode: what most questions are asked of.

        Args:
            pose: mm and rad, or a posture; None: home's.
            mode: None: home's.

        Raises:
            InputError: not P finite numbers, or no such mode.

        Example:
            >>> import kinematics as kin
            >>> kin.open("rps-3").at((200, 0, 0), "2").joints
            Joints(ρ₁ = 223.6067977 mm, ρ₂ = 223.6067977 mm, ρ₃ = 223.6067977 mm)
        """
        from kinematics.facets.configurations import Configuration

        if isinstance(pose, Posture):
            return Configuration(self, pose)
        wanted = self.home.mode if mode is None else mode
        return Configuration(self, self.posture(self.home.pose if pose is None else pose, wanted))

    # --- where it can be

    def workspace(self, modes: str | Sequence[str] | None = None, **held: float | None) -> Space[D]:
        """The workspace with some coordinates held, in one mode, several or all together.

        Args:
            modes: None or "all"; modes or patterns as "+-?++"; or several of them.
            held: coordinates by name, mm and rad (or degrees, ``phi_deg``); angles that are not
                named are home's. None: the one that follows from the others, where one does.

        Raises:
            InputError: there is no such coordinate or mode.

        Example:
            >>> import kinematics as kin
            >>> kin.open("five-bar").workspace("+-").section().area > 0
            True
        """
        from kinematics.facets.spaces import Space

        given = self._named(held, number)
        follows = next((n for n, value in given.items() if value != value), None)
        if follows is not None and follows not in self.dependent:
            raise InputError(f"{self.coordinates[follows].symbol} follows from no other")
        values = [float(given.get(n, v)) for n, v in enumerate(self.home.pose)]
        values = [0.0 if v != v else v for v in values]
        chosen = modes if isinstance(modes, str) or modes is None else ",".join(modes)
        found = None if chosen is None or chosen == "all" else matching(chosen, self.modes)
        if found is not None and len(found) == len(self.modes):
            found = None
        return Space(self, Pose(values, self.coordinates), found, follows)

    def compare(
        self,
        *others: Machine[Any],
        modes: str | Sequence[str] | None = None,
        relative: float = 1e-6,
        **held: float | None,
    ) -> Comparison:
        """Its workspace and those of one to three others over one another, at one orientation.

        Args:
            others: whose base frames are put on its own.
            modes, held: see `spaces`.
            relative: how exact, as a fraction of each volume, where sections are exact.

        Raises:
            InputError: the workspaces are of different coordinates, or a machine has no such mode.

        Example:
            >>> import kinematics as kin
            >>> found = kin.open("five-bar").compare(kin.open("five-bar"), modes="+-")
            >>> abs(found.common.value - found.sizes[0].value) < 1e-6, found.only[0].value
            (True, 0.0)
        """
        from kinematics.facets.comparison import Comparison

        return Comparison(spaces((self, *others), modes, **held), relative)

    # --- on its way

    def follow(
        self, start: Posture | Configuration[D], joints: Sequence[float] | Mapping[str, float]
    ) -> Followed:
        """Along an assembly mode to other joints (J,), mm or rad: where it leads and what stops it.

        Raises:
            InputError: not J finite numbers.

        Example:
            >>> import kinematics as kin
            >>> machine = kin.open("rps-3")
            >>> machine.follow(machine.home, [290, 300, 310]).stop
            'target'
        """
        here = self.at(start) if isinstance(start, Posture) else start
        return here.followed(joints)

    def trajectory(
        self,
        way: str | PathLike[str] | Path | ArrayLike,
        *,
        mode: str | None = None,
        law: str | None = None,
        duration: float | None = None,
        samples: int = 101,
        load: Sequence[float] | None = None,
        limits: Limits | None = None,
        straight: bool = True,
        blend: float = 0.0,
        distances: bool = True,
    ) -> Trajectory:
        """Joints, rates, accelerations and forces along a path, and what is wrong with it.

        Args:
            way: the name of one of ``machine.paths.named()``; a CSV file, see
                `kinematics.trajectories.points`; points (N, P), mm and rad; or a path of
                `kinematics.trajectories`.
            mode: None: the named path's own, or home's.
            law: one of `kinematics.trajectories.LAWS`; None: the named path's own, or quintic.
            duration: s; None: the path's own, or so long that it runs at 100 mm/s.
            samples: at even times.
            load: [F, T] (6,) N and N·mm at O′, base frame; None: no forces.
            limits: of the actuators.
            straight: points are joined by straight lines, and not by a spline.
            blend: mm by which corners between straight lines are rounded; 0: sharp.
            distances: ask for the distance to singularities at every sample.

        Raises:
            InputError: there is no such path, mode or law, or the points make no path.

        Example:
            >>> import kinematics as kin
            >>> found = kin.open("five-bar").trajectory([[0, 700], [100, 650]], duration=1.0)
            >>> found.joints.shape, found.sound
            ((101, 2), True)
        """
        from kinematics import trajectories
        from kinematics.trajectories import points

        scale = [self.length if axis.unit == "rad" else 1.0 for axis in self.coordinates]
        known = {each.name: each for each in self.paths.named()}
        named = known.get(way) if isinstance(way, str) else None
        if named is not None:
            path, own, mode = named.path, named.law, mode or named.mode
        elif hasattr(way, "at") and hasattr(way, "knots"):
            path = cast("Path", way)
            own = trajectories.law("quintic", max(1.0, path.length / points.PACE))
        else:
            poses: object = way
            times: tuple[float, ...] = ()
            if isinstance(way, str | PathLike):
                if not FilePath(way).exists():
                    names = f"its paths by name are {', '.join(known) or 'none'}"
                    raise InputError(f"there is no file {str(way)!r}, and {names}")
                said = points.read_file(FilePath(way), self.coordinates, dependent=self.dependent)
                poses, times = said.poses, said.times or ()
                if said.dependent is not None:
                    at = mode or self.home.mode
                    poses = [self.complete_pose(pose, at) for pose in said.poses]
            path, own = points.through(
                cast(ArrayLike, poses), scale, times, straight=straight, blend=blend
            )
        if law is not None or duration is not None:
            own = trajectories.law(law or own.kind, duration or own.duration)
        mode = self.home.mode if mode is None else mode
        return trajectories.trajectory(
            self,
            path,
            own,
            self.mechanism.mode(mode),
            samples=samples,
            load=load,
            limits=limits,
            distances=distances,
        )

    # --- to be looked at

    def show(
        self,
        start: Sequence[float] | Posture | Configuration[D] | None = None,
        mode: str | None = None,
        *,
        port: int = 0,
    ) -> Any:
        """The page with this machine, served by this process until it is closed.

        In a notebook the page stands in the cell; elsewhere the browser opens it. What is done
        there changes nothing here.

        Args:
            start: the pose that it shows at first; None: home's.
            mode: None: that of ``start``, or home's.
            port: to listen on at 127.0.0.1, or the next free one; 0: any.

        Returns:
            An `app.shown.Shown`: its ``url``, and ``close()``.

        Raises:
            InputError: there is no such pose or mode.
        """
        begun = start if isinstance(start, Posture) else getattr(start, "posture", None)
        posture = begun or self.at(cast("Sequence[float] | None", start), mode).posture
        page = import_module("app.shown")  # by name: the library does without a page
        return page.show(self.design, tuple(posture.pose), mode or posture.mode, port=port)

    # --- inside

    def _named(
        self, given: Mapping[str, Any], numbers: Callable[[Any, str], Any]
    ) -> dict[int, Any]:
        """Values by the index of their coordinate, mm and rad; NaN for None."""
        known = {axis.key: n for n, axis in enumerate(self.coordinates)}
        turned = {axis.json_key: n for n, axis in enumerate(self.coordinates)}
        found: dict[int, Any] = {}
        for key, value in given.items():
            if key not in known and key not in turned:
                raise InputError(
                    f"a {self.title} has no coordinate {key!r}; it has {', '.join(known)}"
                )
            degrees = key not in known
            value = nan if value is None else numbers(value, key)
            found[turned[key] if degrees else known[key]] = np.radians(value) if degrees else value
        return found


def spaces(
    machines: Sequence[Machine[Any]],
    modes: str | Sequence[str] | None = None,
    **held: float | None,
) -> tuple[Space[Any], ...]:
    """The workspaces of several machines, asked for the same.

    Args:
        modes: as of `Machine.workspace`, of all machines of the first one's kind. Where a workspace
            is of one mode at a time, None is the home mode of the first.
        held: likewise; what a machine has not is left out. Where one angle follows from the others
            and none is None, the last one does.

    Raises:
        InputError: the first machine has no such coordinate, or a machine has no such mode.
    """
    first = machines[0]
    if modes is None and any(spec.of_present_mode for spec in first.solid_specs[:1]):
        modes = first.home.mode
    made = []
    for machine in machines:
        known = {name for axis in machine.coordinates for name in (axis.key, axis.json_key)}
        own = {key: value for key, value in held.items() if key in known or machine is first}
        last = machine.dependent and machine.coordinates[machine.dependent[-1]].key
        if last and None not in own.values():
            own = {key: value for key, value in own.items() if key.partition("_")[0] != last}
            own[last] = None
        made.append(machine.workspace(modes if machine.kind == first.kind else None, **own))
    return tuple(made)


def machine_of(design: D) -> Machine[D]:
    """The machine of a design, kept while it is used."""
    found: Machine[D] = _machine_of(design)
    return found


@lru_cache(maxsize=64)
def _machine_of(design: Design) -> Machine[Any]:
    return Machine(design)
