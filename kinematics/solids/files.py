"""Files of surfaces, written by trimesh; the only module that imports it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from kinematics.errors import ComputationError, InputError
from kinematics.solids.csg import Solid
from kinematics.solids.meshes import SolidMesh

KINDS = ("stl", "3mf", "ply", "glb", "obj")


def encode(mesh: SolidMesh, kind: str, *, is_open: bool = False) -> bytes:
    """The bytes of a file of ``kind``, one of `KINDS`; a surface ``is_open`` if it has a rim.

    Coordinates are mm with z upwards, but in GLB metres with y upwards, as glTF demands. 3MF states
    its unit, STL in its header, PLY and OBJ in a comment.

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

    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    return _ENCODERS[kind](surface)


def _stl(surface: Any) -> bytes:
    data: bytes = surface.export(file_type="stl")
    return b"Bohemia: binary STL, unit mm".ljust(80) + data[80:]


def _3mf(surface: Any) -> bytes:
    surface.units = "mm"
    data: bytes = surface.export(file_type="3mf")
    return data


def _ply(surface: Any) -> bytes:
    data: bytes = surface.export(file_type="ply")
    first, rest = data.split(b"\n", 2)[:2], data.split(b"\n", 2)[2]
    return b"\n".join([*first, b"comment Bohemia, unit mm", rest])


def _glb(surface: Any) -> bytes:
    """In metres with y upwards, as glTF demands: (x, y, z) mm becomes (x, z, −y) m."""

    def stated(tree: dict[str, Any]) -> None:
        tree["asset"]["extras"] = {"unit": "m", "up": "y", "written_by": "Bohemia"}

    x, y, z = 1e-3 * surface.vertices.T
    turned = type(surface)(np.stack([x, z, -y], axis=-1), surface.faces, process=False)
    data: bytes = turned.scene().export(file_type="glb", tree_postprocessor=stated)
    return data


def _obj(surface: Any) -> bytes:
    text: str = surface.export(file_type="obj", header="Bohemia, unit mm", digits=9)
    return text.encode()


_ENCODERS: dict[str, Callable[[Any], bytes]] = {
    "stl": _stl,
    "3mf": _3mf,
    "ply": _ply,
    "glb": _glb,
    "obj": _obj,
}
