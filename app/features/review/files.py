"""Files that leave Bohemia: pure functions from results to a file name and its bytes.

Solids leave in base coordinates. Lengths are mm; only 3MF states a unit that every reader honours,
so the names of the others end in ``_mm``; GLB is in metres, as it must be.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from math import degrees
from pathlib import PurePath
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from app.terminal import files
from app.terminal.tables import LOCUS
from kinematics.errors import ComputationError
from kinematics.facets.solids import SolidRequest, build_solid
from kinematics.mechanism import Coordinate, Design

if TYPE_CHECKING:  # manifold3d is loaded only where solids are built
    from kinematics.solids.csg import BuiltSolid, SolidMesh

FORMATS: tuple[str, ...] = ("stl", "3mf", "ply", "glb", "obj")
WITH_UNIT = frozenset({"3mf", "glb"})
MEDIA_TYPES = {
    "stl": "model/stl",
    "3mf": "model/3mf",
    "ply": "application/octet-stream",
    "glb": "model/gltf-binary",
    "obj": "model/obj",
    "toml": "application/toml",
    "json": "application/json",
    "html": "text/html",
    "csv": "text/csv",
    "svg": "image/svg+xml",
    "png": "image/png",
    "dxf": "image/vnd.dxf",
    "npz": "application/octet-stream",
}


@dataclass(frozen=True, slots=True)
class ExportedFile:
    """A file to save or to download."""

    name: str
    data: bytes


def format_of(path: PurePath) -> str:
    """The format that a file's ending asks for.

    Raises:
        InputError: no ending or one that Bohemia does not write.
    """
    return files.format_of(path, FORMATS, "a solid is")


def placed(mesh: SolidMesh, placement: ArrayLike) -> SolidMesh:
    """The mesh moved by a 4x4 rigid motion, from the frame it was built in to the base frame."""
    return mesh.moved(np.asarray(placement, dtype=float))


def solid_bytes(built: BuiltSolid, placement: ArrayLike, kind: str, unit: str = "mm") -> bytes:
    """A solid in base coordinates as the content of a file, its lengths of a unit where open.

    Raises:
        InputError: ``kind`` is not one of `FORMATS`.
        ComputationError: the solid is empty, or its mesh is not sound.
    """
    from kinematics.solids.files import encode

    files.format_known(kind, FORMATS, "a solid is")
    if built.triangles == 0:
        raise ComputationError("the solid is empty, so there is nothing to write")
    return encode(placed(built.mesh, placement), kind, unit=unit)


def mesh_bytes(
    mesh: SolidMesh, placement: ArrayLike, kind: str, *, is_open: bool = False, unit: str = "mm"
) -> bytes:
    """A mesh in base coordinates (mm) as the content of a file.

    Args:
        mesh: a closed surface, or one with a rim if ``is_open``.
        placement: 4x4 to the base frame.
        kind: one of `FORMATS`, or "csv": the vertices.

    Raises:
        InputError: there is no such format, or the mesh is empty.
        ComputationError: it is not sound.
    """
    from kinematics.solids.files import encode

    moved = placed(mesh, placement)
    if kind == "csv":
        rows = [",".join(f"{value:.9g}" for value in point) for point in moved.vertices.tolist()]
        return "\n".join(["x_mm,y_mm,z_mm", *rows, ""]).encode()
    return encode(moved, kind, is_open=is_open, unit=unit)


def solid_file(built: BuiltSolid, placement: ArrayLike, kind: str, *, name: str) -> ExportedFile:
    """A solid as a file to save; ``name`` comes from `solid_name`.

    Raises:
        InputError, ComputationError: as `solid_bytes`.
    """
    data = solid_bytes(built, placement, kind)
    unit = "" if kind in WITH_UNIT else "_mm"
    return ExportedFile(f"{name}{unit}.{kind}", data)


def build_file(
    request: SolidRequest, placement: ArrayLike, kind: str, name: str, part: str = ""
) -> ExportedFile:
    """Build a solid and make a file of it, in whatever process this is called.

    Args:
        part: "" for the whole; of a solid that was parted `LOCUS`, where it was, or the number of
            a piece, from 1.

    Raises:
        InputError, ComputationError: as `solid_bytes`.
    """
    built = build_solid(request)
    if not part:
        return solid_file(built, placement, kind, name=name)
    mesh = built.locus_mesh() if part == LOCUS else built.piece_mesh(int(part) - 1)
    data = mesh_bytes(mesh, placement, kind, is_open=part == LOCUS)
    unit = "" if kind in WITH_UNIT else "_mm"
    named = part if part == LOCUS else f"piece{part}"
    return ExportedFile(f"{name}_{named}{unit}.{kind}", data)


def solid_name(
    design: Design,
    key: str,
    orientation: tuple[tuple[Coordinate, float], ...],
    modes: tuple[str, ...] | None = None,
) -> str:
    """A file's stem: the design, the solid, its orientation (values in rad) and working modes.

    As "rpur-table1_workspace_phi0_theta-17.2" or "rpur-table1_limb1-H2_phi0_theta0".
    """
    angles = (f"{axis.key}{round(degrees(value), 4) + 0.0:.10g}" for axis, value in orientation)
    chosen = () if modes is None else (modes[0] if len(modes) == 1 else f"{len(modes)}modes",)
    return "_".join([sanitized(part) for part in (design.name, key, *angles, *chosen)])


def design_file(design: Design) -> ExportedFile:
    """A design as a design file (TOML) that reads back equal, but for what `as_written` changes."""
    from kinematics.designs.files import write_design
    from kinematics.designs.origins import as_written

    design = as_written(design)
    text = write_design(design)
    return ExportedFile(f"{sanitized(design.name)}.toml", text.encode())


def sanitized(text: str) -> str:
    """``text`` as a part of a file name on every system: letters, digits and ``. + -``."""
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()[:80]
    if not re.fullmatch(r"[+-]+", plain):  # a working mode: all its minus signs carry meaning
        plain = re.sub(r"[^A-Za-z0-9.+-]+", "-", plain).strip("-.")
    return plain or "unnamed"
