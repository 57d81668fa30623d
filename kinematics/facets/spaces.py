"""The workspace of a machine: what is held, in which modes, and all that can be asked of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinematics.answers.coordinates import Pose
from kinematics.answers.sections import Box, Region, Section, Sphere, Volume, together
from kinematics.arrays import Array, finite
from kinematics.errors import InputError
from kinematics.facets.facet import required
from kinematics.facets.faceted import Faceted
from kinematics.facets.solids import (
    RESOLUTIONS,
    Resolution,
    SolidsFacet,
    SolidSpec,
    SurfaceKind,
    build_solid,
)
from kinematics.mechanism import D
from kinematics.storage import write_file

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid, SolidMesh


class Space(Generic[D]):
    """The workspace of a machine with some coordinates held; made by `Machine.workspace`.

    Attributes:
        machine: of which it is.
        pose: the coordinates that are held; the others do not matter.
        modes: of which it is together, None: of all.
        follows: the coordinate that is not held but follows from the others, by its index.

    Example:
        >>> import kinematics as kin
        >>> space = kin.open("rpur-table1").workspace(phi=0.1, theta=0.0, modes="+++++")
        >>> round(space.volume(1e-4, pieces=False).value / 1e6, 2)
        5.98
    """

    def __init__(
        self,
        machine: Faceted[D],
        pose: Pose,
        modes: tuple[str, ...] | None,
        follows: int | None = None,
    ) -> None:
        self.machine, self.pose, self.modes, self.follows = machine, pose, modes, follows

    def __repr__(self) -> str:
        turned = ", ".join(
            f"{axis.symbol} follows" if n == self.follows else f"{axis.symbol} = {value:.6g}°"
            for n, (axis, value) in enumerate(
                zip(self.pose.axes, self.pose.degrees.values(), strict=True)
            )
            if axis.unit == "rad"
        )
        modes = "all modes" if self.modes is None else ", ".join(self.modes)
        what = ", ".join(filter(None, (turned, modes if self.machine.mode_noun else "")))
        return f"<Workspace of {self.machine.design.name or self.machine.title}: {what}>"

    # --- how large it is

    def volume(self, relative: float = 1e-6, *, pieces: bool = True) -> Volume:
        """Its volume with an error, of exact sections where the machine has them.

        Args:
            relative: how exact, as a fraction of it; of a solid that is a mesh the finest of
                `RESOLUTIONS` that it takes, and not finer than that.
            pieces: the volumes of its connected pieces, too; without them in a fifth of the time.

        Raises:
            InputError: the machine has no volume, as its workspace is plane: see `section`.
        """
        if self.machine.sections is not None:
            return self.machine.sections.volume(
                self.pose, self.modes, relative=relative, pieces=pieces
            )
        for resolution in RESOLUTIONS[1:]:
            built = self.solid(resolution).built
            if built.volume_error <= relative * built.volume:
                break
        shares = [(piece.volume, piece.centroid) for piece in built.pieces]
        weight = sum(volume for volume, _ in shares)
        middle = sum((v * np.array(c) for v, c in shares), np.zeros(3))
        nothing = np.empty(0)
        return Volume(
            value=built.volume,
            error=built.volume_error,
            centroid=middle / weight if weight else np.full(3, np.nan),
            pieces=tuple(v for v, _ in shares) if pieces else (),
            at=nothing,
            area=nothing,
            events=nothing,
            sections=0,
        )

    def solid(
        self,
        resolution: Resolution = "normal",
        *,
        key: str = "workspace",
        surface: SurfaceKind = "facets",
    ) -> ShownSolid:
        """It as a closed mesh, or another of the machine's solids.

        Args:
            resolution: "preview", "normal" or "fine".
            key: one of ``machine.solid_specs``.
            surface: "facets", right on the average, or "true": every vertex on the exact surfaces.

        Raises:
            InputError: the machine has no such solid.
        """
        facet, spec = self._solids(key)
        modes = self._present if spec.of_present_mode else self.modes
        request = facet.request(spec.key, self.pose, modes, resolution, surface)
        branch = facet.branch(spec.key, self.pose)
        return ShownSolid(
            spec,
            build_solid(request),
            facet.placement(spec.key, self.pose),
            None if branch is None else Pose(branch, self.pose.axes),
        )

    def section(self, at: float | None = None) -> ShownSection:
        """Its exact section by a plane, mm along the normal; of a plane workspace the whole of it.

        Raises:
            InputError: the machine has no exact sections, or ``at`` is missing.
        """
        sections, regions = self.machine.sections, self.machine.regions
        if sections is None and regions is not None:
            spec = next(spec for spec in regions.specs if spec.key == "workspace")
            found = [region.section for region in self.regions()]
            return ShownSection.of(together(found), spec.plane)
        facet = required(sections, "exact sections")
        if at is None:
            raise InputError(f"a section needs its place along {facet.spec.normal}, mm")
        return ShownSection.of(facet.at(self.pose, self.modes, float(at)), facet.spec)

    def regions(self, key: str = "workspace") -> tuple[Region, ...]:
        """Of a plane workspace its regions with exact boundaries, mm².

        Raises:
            InputError: the machine has no plane workspace, or no such regions.
        """
        facet = required(self.machine.regions, "plane workspace")
        return facet.of(key, self.pose, self.modes)

    # --- what is in it

    def aspects(self, resolution: Resolution = "normal") -> ShownSolid | tuple[Region, ...]:
        """Its parts without a singularity inside: a solid in pieces, or plane regions.

        Raises:
            InputError: the machine does not know them, or they are of one mode and it is of more.
        """
        if any(spec.key == "aspects" for spec in self.machine.solid_specs):
            return self.solid(resolution, key="aspects")
        return self.regions("aspects")

    def largest_ball(self, center: Sequence[float] | None = None) -> Sphere | None:
        """The largest ball inside, about ``center`` (3,) mm or wherever; None where none fits.

        Raises:
            InputError: the machine has no exact sections.
        """
        return required(self.machine.sections, "exact sections").ball(self.pose, self.modes, center)

    def largest_box(self, center: Sequence[float] | None = None) -> Box | None:
        """The largest box inside with edges along x, y, z; None where none fits.

        Raises:
            InputError: the machine has no exact sections.
        """
        return required(self.machine.sections, "exact sections").box(self.pose, self.modes, center)

    def singularity_free_ball(self, center: Sequence[float] | None = None) -> Sphere | None:
        """The largest ball inside without a parallel singularity in it, of one mode.

        Raises:
            InputError: the machine has no exact sections, or the workspace is of several modes.
        """
        facet = required(self.machine.sections, "exact sections")
        if self.modes is None or len(self.modes) != 1:
            raise InputError("a ball without singularities is of one mode; name it: modes=…")
        return facet.singularity_free_ball(self.pose, self.modes[0], center)

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which places (..., 3) mm, of a plane mechanism also (..., 2), it holds; (...) bool.

        Places as a solid of it is drawn: of O′ in the base frame, unless said otherwise.

        Raises:
            InputError: not finite numbers.
        """
        p = finite(points, name="the points")
        keys = [axis.key for axis in self.pose.axes]
        flat = p.reshape(-1, p.shape[-1] if p.ndim else 1)
        if "z" not in keys and flat.shape[1] == 2:
            flat = np.pad(flat, ((0, 0), (0, 1)))
        if flat.shape[1] != 3:
            raise InputError(f"a point has 3 coordinates, got {flat.shape[1]}")
        facet = self.machine.solids
        try:
            facet, spec = self._solids("workspace")
            poses = facet.poses(spec.key, self.pose, self._present[0], flat)
        except InputError:  # a plane workspace, or one whose orientation is all held
            if not {"x", "y"} <= set(keys):
                raise InputError(
                    f"where a {self.machine.title} is is not told by places alone; ask "
                    "machine.inverse.inside(poses)"
                ) from None
            poses = np.tile(np.asarray(self.pose), (len(flat), 1))
            for n, key in enumerate(keys):
                if key in ("x", "y", "z"):
                    poses[:, n] = flat[:, "xyz".index(key)]
        held = np.isfinite(poses).all(axis=1)
        if facet is None and "z" not in keys:
            held &= flat[:, 2] == 0.0
        chosen = self._present if self._of_one else self.modes
        inside = np.zeros(len(flat), dtype=bool)
        inside[held] = self.machine.inverse.inside(poses[held], chosen)
        return inside.reshape(p.shape[:-1])

    # --- inside

    @cached_property
    def _present(self) -> tuple[str, ...]:
        """One mode, where only one can be shown: the one chosen, or home's."""
        if self.modes is not None:
            return self.modes
        return (self.machine.home.mode,)

    @property
    def _of_one(self) -> bool:
        """Whether the workspace is of one mode at a time."""
        specs = self.machine.solid_specs
        return any(s.of_present_mode for s in specs if s.key.partition("/")[0] == "workspace")

    def _solids(self, key: str) -> tuple[SolidsFacet[D], SolidSpec]:
        facet = self.machine.solids
        if facet is None:
            raise InputError(
                f"the workspace of a {self.machine.title} is plane: ask for its section()"
            )
        following = [spec for spec in facet.specs if spec.follows is not None]
        if key == "workspace" and following:
            found = next((spec for spec in following if spec.follows == self.follows), None)
            if found is None:
                axes = self.machine.coordinates
                keys = " or ".join(f"{axes[spec.follows or 0].key}=None" for spec in following)
                raise InputError(
                    "with all angles held the workspace is plane, see section(); of a solid one "
                    f"of them follows from the constraint: workspace({keys})"
                )
            return facet, found
        return facet, facet.spec(key)


@dataclass(frozen=True, eq=False)
class ShownSolid:
    """A solid of a machine, where it stands.

    Attributes:
        spec: which.
        built: mesh, volume and pieces in the solid's own frame.
        placement: (4, 4) from there to the base frame, mm.
        branch: a pose that tells it from others which one might mean, see `SolidsFacet.branch`.
    """

    spec: SolidSpec
    built: BuiltSolid
    placement: Array
    branch: Pose | None = None

    def __repr__(self) -> str:
        b = self.built
        return (
            f"<{self.spec.title}: {b.volume:.6g} ± {b.volume_error:.2g} mm³, "
            f"{len(b.pieces)} pieces, {b.triangles} triangles>"
        )

    @property
    def volume(self) -> float:
        """Of the mesh, mm³; ``built.volume_error`` says how far from the true one."""
        return self.built.volume

    @property
    def mesh(self) -> SolidMesh:
        """Its surface in the base frame, mm."""
        return self.built.mesh.moved(self.placement)

    def save(self, path: str | PathLike[str]) -> Path:
        """Write it as .stl, .3mf, .ply, .glb or .obj, in base coordinates, mm.

        Raises:
            InputError: another ending, or the file cannot be written.
        """
        from kinematics.solids.files import encode

        to = Path(path)
        return write_file(to, encode(self.mesh, to.suffix.removeprefix(".").lower()))

    def to_dict(self) -> dict[str, Any]:
        """As the command line's JSON has it."""
        b = self.built
        return {
            "volume_mm3": b.volume,
            "volume_error_mm3": b.volume_error,
            "pieces": len(b.pieces),
            "piece_volumes_mm3": [piece.volume for piece in b.pieces],
            "triangles": b.triangles,
            "watertight": b.watertight,
            "note": b.note,
            **({} if self.branch is None else {"branch": self.branch.to_dict()}),
        }


class ShownSection(Section):
    """A section that knows what its plane and axes are called: it can be saved."""

    plane: Any

    @classmethod
    def of(cls, section: Section, plane: Any) -> ShownSection:
        """The section with the names of its plane."""
        made = object.__new__(cls)
        made.__dict__.update(vars(section), plane=plane)
        return made

    def save(self, path: str | PathLike[str]) -> Path:
        """Write it as .dxf with true arcs, or as a table .csv, mm.

        Raises:
            InputError: another ending, or the file cannot be written.
        """
        from kinematics.plane.files import section_bytes

        to = Path(path)
        kind = to.suffix.removeprefix(".").lower()
        return write_file(to, section_bytes(self, self.plane, kind))
