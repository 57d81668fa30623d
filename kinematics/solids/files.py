"""Files of surfaces, written by trimesh; the only module that imports it."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from typing import Any

import numpy as np

from kinematics.errors import ComputationError, InputError
from kinematics.lengths import from_mm
from kinematics.solids.csg import Solid
from kinematics.solids.meshes import SolidMesh

KINDS = ("stl", "3mf", "ply", "glb", "obj")


def encode(mesh: SolidMesh, kind: str, *, is_open: bool = False, unit: str = "mm") -> bytes:
    """The bytes of a file of ``kind``, one of `KINDS`; a surface ``is_open`` if it has a rim.

    Coordinates are mm, or of another ``unit``, with z upwards, but in GLB metres with y upwards, as
    glTF demands. 3MF states its unit, STL in its header, PLY and OBJ in a comment.

    Raises:
        InputError: there is no such kind, or the mesh has no faces.
        ComputationError: the mesh is not a closed surface (unless open) of finite numbers.
    """
    if kind not in KINDS:
        raise InputError(f"there is no export as {kind!r}; use one of {', '.join(KINDS)}")
    if not len(mesh.faces):
        raise InputError("the solid is empty, there is nothing to export")
    if is_open:
        if not np.isfinite(mesh.vertices).all():
            raise ComputationError("a vertex is NaN or infinite")
    else:
        Solid.from_mesh(mesh.vertices, mesh.faces)  # raises on NaN and on an open surface
    import trimesh  # slow to import, and only exports need it

    unit = "mm" if kind == "glb" else unit
    scale = 1.0 if unit == "mm" else from_mm(1.0, unit)
    surface = trimesh.Trimesh(mesh.vertices * scale, mesh.faces, process=False)
    return _ENCODERS[kind](surface, unit)


def _stl(surface: Any, unit: str) -> bytes:
    data: bytes = surface.export(file_type="stl")
    return f"Bohemia: binary STL, unit {unit}".encode().ljust(80) + data[80:]


def _3mf(surface: Any, unit: str) -> bytes:
    """trimesh says that it is in millimetres, whatever it is in."""
    data: bytes = surface.export(file_type="3mf")
    if unit == "mm":
        return data
    written = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(data)) as old,
        zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for name in old.namelist():
            content = old.read(name)
            if name.endswith(".model"):
                content = content.replace(
                    b'unit="millimeter"', f'unit="{_3MF_UNITS[unit]}"'.encode(), 1
                )
            new.writestr(name, content)
    return written.getvalue()


_3MF_UNITS = {"cm": "centimeter", "m": "meter", "inch": "inch"}


def _ply(surface: Any, unit: str) -> bytes:
    data: bytes = surface.export(file_type="ply")
    first, rest = data.split(b"\n", 2)[:2], data.split(b"\n", 2)[2]
    return b"\n".join([*first, f"comment Bohemia, unit {unit}".encode(), rest])


def _glb(surface: Any, unit: str) -> bytes:
    """In metres with y upwards, as glTF demands: (x, y, z) mm becomes (x, z, −y) m."""

    def stated(tree: dict[str, Any]) -> None:
        tree["asset"]["extras"] = {"unit": "m", "up": "y", "written_by": "Bohemia"}

    x, y, z = 1e-3 * surface.vertices.T
    turned = type(surface)(np.stack([x, z, -y], axis=-1), surface.faces, process=False)
    data: bytes = turned.scene().export(file_type="glb", tree_postprocessor=stated)
    return data


def _obj(surface: Any, unit: str) -> bytes:
    text: str = surface.export(file_type="obj", header=f"Bohemia, unit {unit}", digits=12)
    return text.encode()


_ENCODERS: dict[str, Callable[[Any, str], bytes]] = {
    "stl": _stl,
    "3mf": _3mf,
    "ply": _ply,
    "glb": _glb,
    "obj": _obj,
}
